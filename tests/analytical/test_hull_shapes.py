"""Users' hulls of simple shapes, volumes in closed form: box, ellipsoid, immersed transom, cruiser stern."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.hull.input import parent_hull_from_offsets
from hpsop_core.geometry.hull.mesh import hull_mesh, underwater_mesh

LENGTH = 60.0


def fitted(
    folder: Path, stations: np.ndarray, heights: np.ndarray, shape: Callable[[float, float], float], draft: float
) -> ParentHull:
    rows = [f"{x:.6f},{z:.6f},{max(shape(x, z), 0.0):.6f}" for x in stations for z in heights]
    path = folder / "shape.csv"
    path.write_text("station_x_m,waterline_z_m,half_breadth_m\n" + "\n".join(rows) + "\n")
    return parent_hull_from_offsets(path, LENGTH, draft)


def test_box_barge_keeps_flat_ends_and_chines(tmp_path: Path) -> None:
    parent = fitted(tmp_path, np.linspace(0.0, LENGTH, 21), np.linspace(0.0, 5.0, 11), lambda x, z: 6.0, 3.0)
    hydro = parent.hydrostatics
    # The chine is rounded by the bicubic section by a few centimetres: 0.1 % of the section.
    assert hydro.displaced_volume == pytest.approx(60.0 * 12.0 * 3.0, rel=1e-3)
    assert hydro.transverse_metacentric_radius == pytest.approx(12.0**2 / (12.0 * 3.0), rel=3e-3)
    assert {("main", "first"), ("main", "last")} <= set(parent.caps)
    hull = parent.transform(LENGTH, parent.breadth, 3.0)
    assert hull_mesh(hull, "view").is_volume and underwater_mesh(hull, "view").is_volume
    # A box has nothing to shift: it stays as it is and says so.
    fuller = parent.transform(LENGTH, parent.breadth, 3.0, 1.05 * hydro.displaced_volume)
    assert fuller.clipped and "form clipped" in fuller.warnings[0]
    # Thin-ship theory gives a box no waves at all; whoever reads a resistance must be told.
    flat = [line for line in hull.warnings if "flat face of 36 m2" in line and "level 1" in line]
    assert len(flat) == 2 and set(flat) <= set(fuller.warnings)
    assert fuller.hydrostatics.displaced_volume == pytest.approx(hydro.displaced_volume, rel=1e-3)


def test_ellipsoid_closes_between_stations(tmp_path: Path) -> None:
    def half_breadth(x: float, z: float) -> float:
        rest = 1.0 - (2.0 * x / LENGTH - 1.0) ** 2 - ((4.0 - z) / 4.0) ** 2
        return 6.0 * float(np.sqrt(rest)) if rest > 0.0 else 0.0

    parent = fitted(tmp_path, np.linspace(-0.5, LENGTH + 0.5, 62), np.linspace(0.0, 5.0, 26), half_breadth, 4.0)
    # Half an ellipsoid; keel and ends lie between rows of the table, so half a cell is open: 0.5 %.
    assert parent.hydrostatics.displaced_volume == pytest.approx(np.pi / 6.0 * 60.0 * 12.0 * 8.0 / 2.0, rel=5e-3)
    assert parent.hydrostatics.longitudinal_centre_of_buoyancy == pytest.approx(30.0, abs=0.05)
    assert parent.hydrostatics.vertical_centre_of_buoyancy == pytest.approx(4.0 - 3.0 / 8.0 * 4.0, abs=0.03)


def test_immersed_transom_gives_the_centre_up(tmp_path: Path) -> None:
    """The aft body is prismatic up to its transom: it has no volume to give, so the centre cannot be held."""

    def half_breadth(x: float, z: float) -> float:
        along = x / LENGTH
        keel = 2.5 * max(0.0, (along - 0.75) / 0.25) ** 2
        beam = 6.0 * (1.0 - max(0.0, (along - 0.4) / 0.6) ** 2.5)
        return min(beam, (z - keel) * beam / 1.5) if z > keel else 0.0

    parent = fitted(tmp_path, np.linspace(0.0, LENGTH, 31), np.linspace(0.0, 5.0, 21), half_breadth, 2.83)
    assert ("main", "first") in parent.caps
    own = parent.hydrostatics.displaced_volume
    for ratio in (0.96, 1.04):
        hull = parent.transform(LENGTH, parent.breadth, 2.83, ratio * own)
        assert not hull.clipped
        assert hull.hydrostatics.displaced_volume == pytest.approx(ratio * own, rel=1e-9)
        assert "cannot hold its centre" in hull.warnings[0]
    same = parent.transform(LENGTH, parent.breadth, 2.83, own)
    assert same.hydrostatics.displaced_volume == pytest.approx(own, rel=1e-9)
    assert len(same.warnings) == 1 and "flat face" in same.warnings[0]  # nothing about its centre


def test_cruiser_stern_above_a_post(tmp_path: Path) -> None:
    """Series-60-like: a vertical stern post at AP up to three quarters of the draft, a counter out to x = -2 m above.

    One patch through both would swing metres above the water between the stations; the post has to be an edge.
    """

    def half_breadth(x: float, z: float) -> float:
        aft = -2.0 * max(0.0, z - 3.0)  # the profile leaves the post at z = 3 m and passes the draft, 4 m, at x = -2 m
        part = (x - 30.0) / (30.0 if x >= 30.0 else 30.0 - aft)
        section = 1.0 - (1.0 - min(z / 4.0, 1.0)) ** 3
        return 6.0 * max(0.0, 1.0 - part**2) * section

    stations = np.concatenate([[-4.0, 0.0, 0.75, 1.5], np.linspace(3.0, 57.0, 19), [58.5, 60.0]])
    parent = fitted(tmp_path, stations, np.linspace(0.0, 5.5, 16), half_breadth, 4.0)
    assert set(parent.underwater) == {"main", "counter"}
    assert parent.extent("main")[0] == 0.0
    assert parent.extent("counter")[0] == pytest.approx(-2.0, abs=0.1)
    for surface in parent.underwater.values():
        heights = surface.evaluate(np.linspace(0.0, 1.0, 201), np.linspace(0.0, 1.0, 41))[..., 2]
        # Nothing above the waterline; 2 % of the draft for the rounding of the keel's ends.
        assert float(heights.max()) <= 4.0 + 1e-9 and float(heights.min()) > -0.08
    x, z = np.linspace(-2.0, 60.0, 2001), np.linspace(0.0, 4.0, 801)
    table = np.array([[half_breadth(a, b) for b in z] for a in x])
    exact = 2.0 * float(np.trapezoid(np.trapezoid(table, z, axis=1), x))
    # A table of 25 x 16 readings with a blunt keel: the parabola between two stations 3 m apart is 0.25 % of the whole.
    assert parent.hydrostatics.displaced_volume == pytest.approx(exact, rel=1e-2)
    hull = parent.transform(LENGTH, parent.breadth, 4.0, 1.04 * parent.hydrostatics.displaced_volume)
    assert not hull.clipped
    assert hull_mesh(hull, "view").is_volume and underwater_mesh(hull, "view").is_volume


def test_pram_ends_where_its_run_leaves_the_water(tmp_path: Path) -> None:
    """A straight run that passes the draft at x = 0, between two waterlines of the table and two of its stations."""

    def half_breadth(x: float, z: float) -> float:
        run = max(0.0, 3.0 - 0.15 * x) if x < 30.0 else 0.0
        beam = 6.0 * (1.0 - max(0.0, (x - 30.0) / 30.0) ** 2)
        return min(beam, 3.0 * max(0.0, z - run + (0.3 if run == 0.0 else 0.0)))

    stations = np.concatenate([np.arange(-3.3, 12.0, 0.6), np.linspace(13.0, 60.0, 30)])
    parent = fitted(tmp_path, stations, np.linspace(0.0, 5.0, 21) - 0.1 * np.sin(np.linspace(0.0, np.pi, 21)),
                    half_breadth, 3.0)  # fmt: skip
    # A waterline from the cubic through the readings would begin 1.0 m further aft, in a sliver that is not there.
    assert parent.extent("main")[0] == pytest.approx(0.0, abs=0.1)


def test_draft_between_waterlines(tmp_path: Path) -> None:
    """A wedge-sided prism with pointed ends: volume to any draft in closed form."""

    def half_breadth(x: float, z: float) -> float:
        return (3.0 + z) * (1.0 - (2.0 * x / LENGTH - 1.0) ** 2)

    parent = fitted(tmp_path, np.linspace(0.0, LENGTH, 31), np.linspace(0.0, 5.0, 11), half_breadth, 3.3)
    exact = 2.0 * (3.0 * 3.3 + 3.3**2 / 2.0) * LENGTH * 2.0 / 3.0
    assert parent.breadth == pytest.approx(2.0 * 6.3, rel=1e-6)  # at the draft, not at the last waterline below it
    # The corner between flat bottom and side is rounded a little by the fit.
    assert parent.hydrostatics.displaced_volume == pytest.approx(exact, rel=2e-3)


def test_a_chine_stays_sharp(tmp_path: Path) -> None:
    """Straight sections with a chine at 1.6 m: the surface turns there as the readings do, and nowhere else."""
    x, z = np.linspace(0.0, 60.0, 31), np.linspace(0.0, 4.0, 11)
    half = 7.0 * np.clip(1.0 - np.abs(x / 30.0 - 1.0) ** 2.5, 0.0, None)[:, None]
    y = half * np.where(z < 1.6, 0.85 * z / 1.6, 0.85 + 0.15 * (z - 1.6) / 2.4)
    rows = [f"{a:.6g},{b:.6g},{c:.6g}" for a, row in zip(x, y, strict=True) for b, c in zip(z, row, strict=True)]
    path = tmp_path / "chine.csv"
    path.write_text("station_x_m,waterline_z_m,half_breadth_m\n" + "\n".join(rows) + "\n")
    parent = parent_hull_from_offsets(path, 60.0, 4.0)
    section = parent.surface("main").evaluate(parent.parameter("main", np.array([30.0])), np.linspace(0.0, 1.0, 401))[0]
    angle = np.degrees(np.arctan2(np.diff(section[:, 2]), np.diff(section[:, 1])))
    at_chine = np.abs(section[1:, 2] - 1.6) < 0.15
    below, above = angle[(section[1:, 2] > 0.4) & (section[1:, 2] < 1.2)], angle[section[1:, 2] > 2.2]
    flat, steep = np.degrees(np.arctan2(1.6, 0.85 * 7.0)), np.degrees(np.arctan2(2.4, 0.15 * 7.0))
    assert below == pytest.approx(flat, abs=1.5) and above == pytest.approx(steep, abs=1.5)
    # Between two of 400 points along the girth: nearly all of the turn of 51 degrees.
    assert float(np.max(np.diff(angle[at_chine]))) > 0.8 * (steep - flat)
    # The trapezoid is exact for straight sections; along the ship stations are 2 m apart.
    exact = 2.0 * 7.0 * 60.0 * (1.0 - 1.0 / 3.5) * (0.5 * 0.85 * 1.6 + 0.5 * (0.85 + 1.0) * 2.4)
    assert parent.hydrostatics.displaced_volume == pytest.approx(exact, rel=2e-3)
