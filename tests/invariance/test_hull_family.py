"""What must hold for every hull of the family, whatever its numbers."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull import hydrostatics
from hpsop_core.geometry.hull.form import LEAST_STRETCH
from hpsop_core.geometry.hull.hull import Hull, ParentHull, load_parent_hull
from hpsop_core.hydro.michell import wave_coefficients

LENGTH, BREADTH, DRAFT = 355.0, 51.0, 14.5
BOX = LENGTH * BREADTH * DRAFT


@pytest.fixture(scope="module")
def parent() -> ParentHull:
    return load_parent_hull()


@pytest.mark.parametrize("block", [0.60, 0.63, 0.66, 0.70, 0.75])
def test_block_coefficients_at_the_parents_centre(parent: ParentHull, block: float) -> None:
    hull = parent.transform(LENGTH, BREADTH, DRAFT, block * BOX)
    hydro = hull.hydrostatics
    assert not hull.clipped and not hull.warnings
    assert hull.shift.least_stretch() > LEAST_STRETCH
    # The solver ends at rounding.
    assert hydro.displaced_volume == pytest.approx(block * BOX, rel=1e-9)
    assert hydro.longitudinal_centre_of_buoyancy == pytest.approx(
        parent.hydrostatics.longitudinal_centre_of_buoyancy, abs=1e-6
    )


@pytest.mark.parametrize("fraction", [-0.01, -0.004, 0.006, 0.01])
def test_centre_of_buoyancy_alone(parent: ParentHull, fraction: float) -> None:
    own = parent.hydrostatics
    hull = parent.transform(LENGTH, BREADTH, DRAFT, own.displaced_volume, fraction * LENGTH)
    assert not hull.clipped
    assert hull.hydrostatics.displaced_volume == pytest.approx(own.displaced_volume, rel=1e-9)
    moved = hull.hydrostatics.longitudinal_centre_of_buoyancy - own.longitudinal_centre_of_buoyancy
    assert moved == pytest.approx(fraction * LENGTH, abs=1e-6)
    # Without a volume the shift holds the parent's block coefficient.
    same = parent.transform(LENGTH, BREADTH, DRAFT, None, fraction * LENGTH)
    assert same.hydrostatics.displaced_volume == pytest.approx(own.displaced_volume, rel=1e-9)


def test_centre_shift_in_metres_of_the_new_ship(parent: ParentHull) -> None:
    scaled = parent.transform(300.0, 45.0, 13.0)
    moved = parent.transform(300.0, 45.0, 13.0, None, 2.4)
    shift = moved.hydrostatics.longitudinal_centre_of_buoyancy - scaled.hydrostatics.longitudinal_centre_of_buoyancy
    assert shift == pytest.approx(2.4, abs=1e-6)


@pytest.mark.parametrize(("block", "fraction"), [(0.50, 0.0), (0.80, 0.0), (0.75, -0.01), (0.66, 0.08), (0.66, -0.08)])
def test_beyond_the_range_the_form_is_clipped_and_says_so(parent: ParentHull, block: float, fraction: float) -> None:
    hull = parent.transform(LENGTH, BREADTH, DRAFT, block * BOX, fraction * LENGTH)
    assert hull.clipped
    assert hull.shift.least_stretch() > LEAST_STRETCH
    assert len(hull.warnings) == 1 and "clipped" in hull.warnings[0] and "\n" not in hull.warnings[0]
    # What was missed stands in the line, and only that.
    hydro, own = hull.hydrostatics, parent.hydrostatics.longitudinal_centre_of_buoyancy
    missed = abs(hydro.longitudinal_centre_of_buoyancy - own - fraction * LENGTH) > 0.01
    assert ("centre of buoyancy" in hull.warnings[0]) == missed
    assert ("block coefficient" in hull.warnings[0]) == (abs(hydro.block_coefficient - block) > 1e-5)
    # The volume in the hydrostatics is the one of the geometry, not the asked one.
    assert abs(hull.hydrostatics.block_coefficient - block) > 1e-3 or abs(fraction) > 0.01


def test_clipping_is_continuous(parent: ParentHull) -> None:
    """Over the edge of the range the displacement stays where it stopped: no jump for the optimiser to find."""
    blocks = np.linspace(0.755, 0.785, 61)
    reached = [parent.transform(LENGTH, BREADTH, DRAFT, b * BOX).hydrostatics.block_coefficient for b in blocks]
    steps = np.diff(reached)
    assert np.all(steps > -1e-5)
    # A step of the sweep is 0.0005; the table behind the clipped point is good to 1e-5.
    assert float(np.max(steps)) < 5e-4 + 2e-5


def _residual(values: list[float], at: np.ndarray) -> float:
    fit = np.polynomial.Polynomial.fit(at, values, 5)
    return float(np.max(np.abs(np.array(values) / fit(at) - 1.0)))


def test_no_kink_at_the_parent(parent: ParentHull) -> None:
    ratios = np.linspace(0.98, 1.02, 41)
    own = parent.hydrostatics.displaced_volume
    volume, surface, waves = [], [], []
    for ratio in ratios:
        hull = parent.transform(LENGTH, BREADTH, DRAFT, own * ratio)
        table = hull.offset_table()
        surface.append(hull.hydrostatics.wetted_surface)
        volume.append(hull.hydrostatics.displaced_volume)
        waves.append(float(wave_coefficients(table.x, table.z, table.y, LENGTH, surface[-1], [0.22])[0]))
    # The displacement changes by 4 %: a kink a fortieth as high would be a false optimum at the parent.
    assert _residual(volume, ratios) < 1e-3
    assert _residual(surface, ratios) < 1e-3
    assert _residual(waves, ratios) < 1e-3
    # And the parent itself lies on that curve.
    table = parent.transform(LENGTH, BREADTH, DRAFT).offset_table()
    at_parent = float(wave_coefficients(table.x, table.z, table.y, LENGTH, surface[20], [0.22])[0])
    assert waves[20] == pytest.approx(at_parent, rel=1e-6)


def test_affine_scaling_is_exact(parent: ParentHull) -> None:
    own = parent.hydrostatics
    hull = parent.transform(2.0 * LENGTH, 0.9 * BREADTH, 1.1 * DRAFT)
    assert hull.hydrostatics.displaced_volume == pytest.approx(own.displaced_volume * 2.0 * 0.9 * 1.1, rel=1e-12)
    assert hull.hydrostatics.block_coefficient == pytest.approx(own.block_coefficient, rel=1e-12)
    similar = parent.transform(0.1 * LENGTH, 0.1 * BREADTH, 0.1 * DRAFT).hydrostatics
    assert similar.wetted_surface == pytest.approx(0.01 * own.wetted_surface, rel=1e-12)
    assert similar.transverse_metacentric_radius == pytest.approx(0.1 * own.transverse_metacentric_radius, rel=1e-12)


def test_ends_stay_where_the_propeller_needs_them(parent: ParentHull) -> None:
    scaled = parent.transform(370.0, 50.0, 14.0)
    fuller = parent.transform(370.0, 50.0, 14.0, 0.72 * 370.0 * 50.0 * 14.0, 1.5)
    grid = np.linspace(0.0, 1.0, 21)
    for name in ("counter", "skeg", "bulb", "topsides_stern", "topsides_bow"):
        assert np.array_equal(fuller.patch_points(name, grid, grid), scaled.patch_points(name, grid, grid))
    assert fuller.boss_end_x == scaled.boss_end_x == pytest.approx(9.2 * 370.0 / 355.0)
    assert fuller.shaft_height == pytest.approx(5.0 * 14.0 / 14.5)


@pytest.mark.parametrize("ratio", [0.93, 1.0, 1.09])
def test_exchange_surfaces_hold_the_volume(parent: ParentHull, ratio: float) -> None:
    hull = parent.transform(360.0, 50.0, 14.4, ratio * 360.0 * 50.0 * 14.4 * 0.66)
    volume = 0.0
    nodes, weights = np.polynomial.legendre.leggauss(6)
    for name in parent.underwater:
        surface, deviation = hull.nurbs_patch(name)
        assert deviation <= 1e-5 * hull.length
        grids = []
        for knots in (surface.knots_u, surface.knots_v):
            breaks = np.unique(knots)
            half = 0.5 * np.diff(breaks)[:, None]
            grids.append(((0.5 * (breaks[1:] + breaks[:-1]))[:, None] + half * nodes, half * weights))
        (u, wu), (v, wv) = ((a.ravel(), b.ravel()) for a, b in grids)
        points, along, across = surface.derivatives(u, v)
        volume += float(wu @ (2.0 * points[..., 1] * across[..., 2] * along[..., 0]) @ wv)
    # x(u) is refitted to 1e-5 of the length at most.
    assert volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=1e-4)


def test_hydrostatics_are_converged_in_the_grid(parent: ParentHull, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half the span and more points a span change nothing that four printed digits could show."""
    asked = (LENGTH, BREADTH, DRAFT, 0.74 * BOX, 1.0)
    own = parent.transform(*asked).hydrostatics
    for name, value in (("GAUSS_POINTS", 7), ("SURFACE_POINTS_U", 4), ("SURFACE_POINTS_V", 6)):
        monkeypatch.setattr(hydrostatics, name, value)
    monkeypatch.setattr(hydrostatics, "LONGEST_SPAN", 0.5 * hydrostatics.LONGEST_SPAN)
    finer = replace(parent, _points={}).transform(*asked).hydrostatics
    for field in fields(own):
        value = getattr(own, field.name)
        if isinstance(value, float):
            # Half a unit of the fourth digit; what comes out is below 1e-5.
            assert getattr(finer, field.name) == pytest.approx(value, rel=5e-5), field.name


def test_neighbours_meet(parent: ParentHull) -> None:
    """Shared edges agree to the rounding of the stored control points, far below the 20 mm that an eye could see."""
    v = np.linspace(0.0, 1.0, 101)
    ends = {"first": np.array([0.0]), "last": np.array([1.0])}
    pairs = [("counter", "last", "main", "first"), ("skeg", "last", "main", "first"), ("bulb", "first", "main", "last"),
             ("topsides_aft", "last", "topsides_mid", "first"), ("topsides_stern", "last", "topsides_aft", "first"),
             ("topsides_bow", "first", "topsides_mid", "last")]  # fmt: skip
    for name, end, other, other_end in pairs:
        base, start, stop = parent.girth[name]
        same = parent.girth[other]
        assert base == same[0]
        there = parent.surface(other).evaluate(ends[other_end], start + (stop - start) * v)[0]
        here = parent.surface(name).evaluate(ends[end], v)[0]
        assert float(np.max(np.linalg.norm(here - there, axis=1))) < 1e-4
    for name, below in parent.along.items():
        u = np.linspace(0.0, 1.0, 301)
        sides = parent.surface(name).evaluate(u, np.array([0.0]))[:, 0]
        water = parent.surface(below).evaluate(u, np.array([1.0]))[:, 0]
        assert float(np.max(np.linalg.norm(sides - water, axis=1))) < 1e-4
        assert np.all(np.abs(water[:, 2] - parent.draft) < 1e-9)


def test_offset_table_holds_the_hull(parent: ParentHull) -> None:
    for hull in (parent.transform(LENGTH, BREADTH, DRAFT), parent.transform(340.0, 52.0, 14.0, 0.72 * 340 * 52 * 14)):
        table = hull.offset_table()
        assert np.all(np.diff(table.x) > 0.0) and np.all(np.diff(table.z) > 0.0)
        assert table.z[0] == 0.0 and table.z[-1] == hull.draft
        assert np.all(table.y >= 0.0) and np.all(np.isfinite(table.y))
        areas = 2.0 * np.trapezoid(table.y, table.z, axis=1)
        volume = float(np.trapezoid(areas, table.x))
        # The trapezoidal rule on this grid, with the jump at the boss's flat end.
        assert volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=3e-3)
        curve = hull.hydrostatics
        assert float(np.trapezoid(curve.sectional_area, curve.sectional_area_x)) == pytest.approx(
            curve.displaced_volume, rel=2e-3
        )


def test_waterline_closes_and_rises(parent: ParentHull) -> None:
    hull: Hull = parent.transform(LENGTH, BREADTH, DRAFT, 0.7 * BOX)
    line = hull.waterline(301)
    assert np.all(np.diff(line[:, 0]) > 0.0)
    assert line[0, 1] == pytest.approx(0.0, abs=1e-9) and line[-1, 1] == pytest.approx(0.0, abs=1e-9)
    plane = 2.0 * float(np.trapezoid(line[:, 1], line[:, 0]))
    assert plane == pytest.approx(hull.hydrostatics.waterplane_area, rel=2e-3)


def test_patch_parameter_inverts_the_stations(parent: ParentHull) -> None:
    hull = parent.transform(340.0, 50.0, 14.0, 0.70 * 340.0 * 50.0 * 14.0)
    x = np.linspace(20.0, 335.0, 60)
    u = hull.patch_parameter("main", x)
    assert hull.patch_points("main", u, np.array([0.5]))[:, 0, 0] == pytest.approx(x, abs=1e-6)


def test_derivatives_are_those_of_the_points(parent: ParentHull) -> None:
    hull = parent.transform(340.0, 50.0, 14.0, 0.70 * 340.0 * 50.0 * 14.0)
    patch = next(p for p in hull.patches if p.name == "main")
    u, v, step = np.array([0.2, 0.43, 0.71]), np.array([0.3, 0.8]), 1e-6
    _, along, across = patch.derivatives(u, v)
    # Central differences: rounding 1e-9/step, so 1e-3 m per unit parameter of hundreds of metres.
    assert along == pytest.approx((patch.evaluate(u + step, v) - patch.evaluate(u - step, v)) / (2 * step), abs=2e-3)
    assert across == pytest.approx((patch.evaluate(u, v + step) - patch.evaluate(u, v - step)) / (2 * step), abs=2e-3)


@pytest.mark.parametrize("bad", [(0.0, 51.0, 14.5), (355.0, -1.0, 14.5), (355.0, 51.0, float("nan"))])
def test_senseless_dimensions_are_refused(parent: ParentHull, bad: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="positive number"):
        parent.transform(*bad)
    with pytest.raises(InputError):
        parent.transform(355.0, 51.0, 14.5, -3.0)


def test_same_input_same_bits(parent: ParentHull) -> None:
    first, second = (parent.transform(351.3, 50.2, 14.1, 171_234.5, 0.7) for _ in range(2))
    assert first.shift == second.shift
    assert first.hydrostatics.wetted_surface == second.hydrostatics.wetted_surface
    assert np.array_equal(first.offset_table().y, second.offset_table().y)
