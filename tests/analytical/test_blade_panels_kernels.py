"""Dipole and source kernels of the blade panels against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.hydro.blade_panels.grid import bilinear_points, grid_quadrilaterals
from hpsop_core.hydro.blade_panels.potential import SurfaceGradient, tangential
from hpsop_core.hydro.singularities.dipole_panels import FAR_DIAGONALS, body_influence, panel_set, strip_influence

ALWAYS_NEAR = 1.0e9


def unit_square() -> np.ndarray:
    return np.array([[[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]]])


def sphere_corners(along: int, round_: int) -> np.ndarray:
    """Corner grid whose (d/dj) x (d/di) points outwards."""
    t, p = np.linspace(0.0, np.pi, along + 1)[:, None], np.linspace(0.0, 2.0 * np.pi, round_ + 1)
    return np.stack([-np.cos(t) * np.ones_like(p), np.sin(t) * np.cos(p), np.sin(t) * np.sin(p)], axis=-1)


def twisted_panel() -> np.ndarray:
    return np.array([[[-0.5, -0.3, 0.05], [0.6, -0.4, -0.05], [0.5, 0.4, 0.05], [-0.45, 0.3, -0.05]]])


def test_square_on_its_axis() -> None:
    height = np.array([0.0, 0.5, 1.0, 2.0])
    points = np.stack([0.0 * height, 0.0 * height, height], axis=1)
    dipole, source = body_influence(points, panel_set(unit_square()), far=ALWAYS_NEAR)
    # the references are given to eight digits
    np.testing.assert_allclose(source[:, 0], [3.5254943, 1.5867183, 0.9285978, 0.4900145], atol=1e-7)
    expected = 4.0 * np.arctan(0.25 / (height[1:] * np.sqrt(0.5 + height[1:] ** 2)))
    np.testing.assert_allclose(dipole[1:, 0], expected, rtol=1e-12)
    # the principal value on the panel itself: flat, so zero; its centre lies on the triangles' common diagonal
    own, _ = body_influence(points[:1], panel_set(unit_square()), own_panel=np.array([0]))
    assert abs(own[0, 0]) < 1e-5


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("place", [(0.1, 0.1, 0.1), (0.7, 0.0, 0.03), (0.0, 0.0, 0.03), (0.4, 0.2, 0.08)])
def test_twisted_panel_against_quadrature(place: tuple[float, float, float], side: float) -> None:
    """The dipoles lie on the bilinear surface itself, so a fine midpoint rule on it is the reference."""
    corners = twisted_panel()
    point = np.array(place) * [1.0, 1.0, side]
    fraction = (np.arange(400) + 0.5) / 400
    u, v = (a[..., None] for a in np.meshgrid(fraction, fraction, indexing="ij"))
    a, b, c, d = corners[0]
    surface = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    normal = np.cross((1 - v) * (b - a) + v * (c - d), (1 - u) * (d - a) + u * (c - b)) / 400**2
    reach = point - surface
    exact = np.sum(np.sum(normal * reach, axis=2) / np.linalg.norm(reach, axis=2) ** 3)
    dipole, _ = body_influence(point[None], panel_set(corners), far=ALWAYS_NEAR)
    # the midpoint rule at a distance of ten of its cells is good to 1e-4
    assert dipole[0, 0] == pytest.approx(exact, abs=5e-4)


def test_far_field_matches_the_exact_kernel() -> None:
    """Second moments: the error at the switch is of the fourth power of size over distance, 1/(2 x 3)^4 < 1e-3."""
    panels = panel_set(twisted_panel())
    direction = np.random.default_rng(0).normal(size=(300, 3))
    points = direction / np.linalg.norm(direction, axis=1, keepdims=True) * FAR_DIAGONALS * panels.moments[0, 4]
    near = body_influence(points, panels, far=ALWAYS_NEAR)
    far = body_influence(points, panels, far=0.5)
    for exact, expansion in zip(near, far, strict=True):
        assert np.max(np.abs(exact - expansion)) < 1e-3 * np.max(np.abs(exact))


def test_closed_surface_inside_outside_and_on_it() -> None:
    """Gauss: -4 pi inside, 0 outside, -2 pi on the surface, for any polyhedron of bilinear faces."""
    corners = sphere_corners(10, 16)
    # a twisted, squashed body: no panel is flat
    corners = corners * [1.0, 0.3, 0.2]
    turn = 0.8 * corners[..., 0]
    y, z = corners[..., 1].copy(), corners[..., 2].copy()
    corners[..., 1], corners[..., 2] = y * np.cos(turn) - z * np.sin(turn), y * np.sin(turn) + z * np.cos(turn)
    panels = panel_set(grid_quadrilaterals(corners))
    points = np.array([[0.1, 0.02, 0.01], [-0.5, 0.0, 0.03], [1.5, 0.0, 0.0], [0.0, 0.5, 0.4]])
    dipole, _ = body_influence(points, panels, far=ALWAYS_NEAR)
    np.testing.assert_allclose(dipole.sum(axis=1), [-4.0 * np.pi, -4.0 * np.pi, 0.0, 0.0], atol=1e-8)
    own, _ = bilinear_points(corners, np.full(16, 0.5))
    dipole, _ = body_influence(own.reshape(-1, 3), panels, own_panel=np.arange(panels.count), far=ALWAYS_NEAR)
    # the principal value is taken a millionth of the panel's size off the panel
    np.testing.assert_allclose(dipole.sum(axis=1), -2.0 * np.pi, atol=1e-4)


def test_sphere_added_mass_and_speed() -> None:
    """k = 1/2; q = 3/2 U sin(theta)."""
    corners = sphere_corners(24, 48)
    panels = panel_set(grid_quadrilaterals(corners))
    points, normal = bilinear_points(corners, np.full(48, 0.5))
    flat, out = points.reshape(-1, 3), normal.reshape(-1, 3)
    dipole, source = body_influence(flat, panels, own_panel=np.arange(panels.count))
    onset = np.zeros_like(flat)
    onset[:, 0] = 1.0
    matrix = 2.0 * np.pi * np.eye(panels.count) - dipole
    potential = np.linalg.solve(matrix, source @ np.sum(onset * out, axis=1))
    added_mass = -np.sum(potential * out[:, 0] * panels.moments[:, 0]) / (4.0 * np.pi / 3.0)
    # the polyhedron has 0.7 % less volume than the sphere
    assert abs(added_mass) == pytest.approx(0.5, rel=0.012)
    shape = points.shape[:2]
    velocity = tangential(onset.reshape(*shape, 3, 1), normal) + SurfaceGradient.on(points).of(
        potential.reshape(*shape, 1)
    )
    speed = np.linalg.norm(velocity[..., 0], axis=2)
    radius = np.linalg.norm(points, axis=2)
    sine = np.hypot(points[..., 1], points[..., 2]) / radius
    away = (sine > 0.3) & (np.arange(shape[1])[None, :] > 0) & (np.arange(shape[1])[None, :] < shape[1] - 1)
    # 1 % away from the poles, where the grid of panels is singular
    np.testing.assert_allclose(speed[away], 1.5 * sine[away], rtol=0.01)


def test_images_are_rotations() -> None:
    """Three images in one call are three calls with turned points, and a strip sums its panels."""
    shift = np.array([0.2, 1.0, 0.3])
    panels = panel_set(np.concatenate([twisted_panel() + shift, unit_square() + shift]))
    points = np.array([[0.5, 0.2, 1.4], [-0.3, -0.9, 0.2]])
    dipole, source = body_influence(points, panels, 3)
    parts = []
    for angle in 2.0 * np.pi * np.arange(3) / 3.0:
        c, s = np.cos(angle), np.sin(angle)
        parts.append(body_influence(points @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), panels))
    np.testing.assert_allclose(dipole, sum(p[0] for p in parts), rtol=1e-10)
    np.testing.assert_allclose(source, sum(p[1] for p in parts), rtol=1e-10)
    strips = strip_influence(points, panels, np.array([0, 0]), 1, 3)
    np.testing.assert_allclose(strips[:, 0], dipole.sum(axis=1), rtol=1e-10)
