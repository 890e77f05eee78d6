"""NURBS evaluation against geomdl, which implements the algorithms of The NURBS Book."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.nurbs import NurbsSurface, clamped_knots, rising_spline_inverse


def rational_surface() -> NurbsSurface:
    random = np.random.default_rng(5)
    points = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij"), axis=-1)
    points = np.concatenate([points, random.normal(size=(6, 5, 1))], axis=2)
    weights = random.uniform(0.5, 2.0, size=(6, 5))
    return NurbsSurface(3, 2, clamped_knots([0.3, 0.6], 3), clamped_knots([0.2, 0.7], 2), points, weights)


def test_points_equal_geomdl() -> None:
    surface = rational_surface()
    oracle = surface.to_geomdl()
    u, v = np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 9)
    got = surface.evaluate(u, v)
    expected = np.array([[oracle.evaluate_single((a, b)) for b in v] for a in u])
    # Two evaluations of the same formula: rounding only.
    assert got == pytest.approx(expected, abs=1e-12)
    diagonal = np.array([oracle.evaluate_single((a, a)) for a in u])
    assert surface.evaluate_pairs(u, u) == pytest.approx(diagonal, abs=1e-12)


def test_derivatives_equal_geomdl() -> None:
    surface = rational_surface()
    oracle = surface.to_geomdl()
    u, v = np.array([0.0, 0.25, 0.61, 0.99]), np.array([0.1, 0.5, 0.95])
    _, along, across = surface.derivatives(u, v)
    for i, a in enumerate(u):
        for j, b in enumerate(v):
            expected = oracle.derivatives(a, b, order=1)
            assert along[i, j] == pytest.approx(np.array(expected[1][0]), abs=1e-10)
            assert across[i, j] == pytest.approx(np.array(expected[0][1]), abs=1e-10)


def test_shipped_hull_equals_geomdl() -> None:
    surface = load_parent_hull().underwater["skeg"]
    oracle = surface.to_geomdl()
    at = np.array([0.0, 0.37, 1.0])
    expected = np.array([[oracle.evaluate_single((a, b)) for b in at] for a in at])
    assert surface.evaluate(at, at) == pytest.approx(expected, abs=1e-9)


def test_knot_insertion_keeps_the_surface() -> None:
    surface = rational_surface()
    finer = surface.with_knots_u(np.array([0.15, 0.45, 0.8]))
    grid = np.linspace(0.0, 1.0, 31)
    assert finer.control_points.shape[0] == surface.control_points.shape[0] + 3
    assert finer.evaluate(grid, grid) == pytest.approx(surface.evaluate(grid, grid), abs=1e-12)


def test_round_trips() -> None:
    surface = rational_surface()
    grid = np.linspace(0.0, 1.0, 5)
    for other in (NurbsSurface.from_dict(surface.to_dict()), NurbsSurface.from_geomdl(surface.to_geomdl())):
        assert other.evaluate(grid, grid) == pytest.approx(surface.evaluate(grid, grid), abs=1e-13)


def test_rational_quadratic_makes_an_exact_quarter_cylinder() -> None:
    half = np.sqrt(0.5)
    arc = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    points = np.stack([np.column_stack([np.full(3, x), arc]) for x in (0.0, 2.0)])
    weights = np.tile([1.0, half, 1.0], (2, 1))
    surface = NurbsSurface(1, 2, clamped_knots([], 1), clamped_knots([], 2), points, weights)
    got = surface.evaluate(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 50))
    assert np.hypot(got[..., 1], got[..., 2]) == pytest.approx(np.ones((3, 50)), abs=1e-14)


def test_inverse_of_a_rising_spline() -> None:
    surface = load_parent_hull().underwater["bulb"]
    control = surface.control_points[:, 0, 0]
    x = np.linspace(control[0], control[-1], 301)
    u = rising_spline_inverse(surface.knots_u, 3, control, x)
    assert surface.evaluate_pairs(u, np.zeros_like(u))[:, 0] == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("change", [{"weights": -np.ones((6, 5))}, {"knots_u": np.linspace(0, 1, 10)}, {"degree_v": 3}])
def test_what_is_no_surface_is_refused(change: dict[str, object]) -> None:
    surface = rational_surface()
    data = {
        name: getattr(surface, name)
        for name in ("degree_u", "degree_v", "knots_u", "knots_v", "control_points", "weights")
    } | change
    with pytest.raises(InputError):
        NurbsSurface(**data)  # type: ignore[arg-type]
