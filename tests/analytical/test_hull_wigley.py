"""A user's own hull with closed-form values: the parabolic Wigley hull given as a table of offsets.

y = B/2 (1 - (2x/L)^2) (1 - (z/T)^2): CB = 4/9, CWP = 2/3, CM = 2/3; S = 0.14879 L^2 for L/B 10, B/T 1.6.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.hull.input import parent_hull_from_offsets
from hpsop_core.geometry.hull.mesh import hull_mesh, underwater_mesh
from hpsop_core.hydro.michell import wave_coefficients

LENGTH, BREADTH, DRAFT = 100.0, 10.0, 6.25


def write_wigley(path: Path, stations: int = 81, waterlines: int = 21) -> Path:
    lines = ["# Wigley hull", "station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, LENGTH, stations):
        for z in np.linspace(0.0, DRAFT, waterlines):
            along, down = 2.0 * (x - LENGTH / 2) / LENGTH, (DRAFT - z) / DRAFT
            lines.append(f"{x:.6f},{z:.6f},{BREADTH / 2 * (1 - along**2) * (1 - down**2):.6f}")
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def wigley(tmp_path_factory: pytest.TempPathFactory) -> ParentHull:
    return parent_hull_from_offsets(write_wigley(tmp_path_factory.mktemp("wigley") / "wigley.csv"), LENGTH, DRAFT)


def test_form_coefficients(wigley: ParentHull) -> None:
    hydro = wigley.hydrostatics
    # A bicubic surface holds the section's parabola up to its parametrisation: 0.01 % is the fit, not rounding.
    assert hydro.displaced_volume == pytest.approx(4.0 / 9.0 * LENGTH * BREADTH * DRAFT, rel=1e-4)
    assert hydro.waterplane_coefficient == pytest.approx(2.0 / 3.0, rel=1e-4)
    assert hydro.midship_coefficient == pytest.approx(2.0 / 3.0, rel=1e-4)
    assert hydro.longitudinal_centre_of_buoyancy == pytest.approx(LENGTH / 2, abs=1e-4 * LENGTH)
    # Centroid of the area under 1 - s^2 is 3/8 T below the waterline.
    assert hydro.vertical_centre_of_buoyancy == pytest.approx(DRAFT * 5.0 / 8.0, rel=1e-4)
    # BM = I/V with I = 2/3 int y^3 dx = 2/3 (B/2)^3 L 16/35.
    inertia = 2.0 / 3.0 * (BREADTH / 2) ** 3 * LENGTH * 16.0 / 35.0
    assert hydro.transverse_metacentric_radius == pytest.approx(inertia / (4 / 9 * LENGTH * BREADTH * DRAFT), rel=3e-4)


def test_a_scaled_hull_has_the_closed_forms_of_its_own_dimensions(wigley: ParentHull) -> None:
    length, breadth, draft = 1.4 * LENGTH, 1.3 * BREADTH, 0.8 * DRAFT
    hydro = wigley.transform(length, breadth, draft).hydrostatics
    inertia = 2.0 / 3.0 * (breadth / 2) ** 3 * length * 16.0 / 35.0
    # as above
    assert hydro.transverse_metacentric_radius == pytest.approx(inertia / (4 / 9 * length * breadth * draft), rel=3e-4)
    assert hydro.vertical_centre_of_buoyancy == pytest.approx(draft * 5.0 / 8.0, rel=1e-4)
    assert hydro.longitudinal_centre_of_buoyancy == pytest.approx(length / 2, abs=1e-4 * length)
    assert hydro.displaced_volume == pytest.approx(4.0 / 9.0 * length * breadth * draft, rel=1e-4)


def test_wetted_surface(wigley: ParentHull) -> None:
    # The published value has five digits.
    assert wigley.hydrostatics.wetted_surface == pytest.approx(0.14879 * LENGTH**2, rel=1e-4)


def test_sharp_ends_and_keel_stay_sharp(wigley: ParentHull) -> None:
    surface = wigley.underwater["main"]
    ends = surface.evaluate(np.array([0.0, 1.0]), np.linspace(0.0, 1.0, 21))
    assert np.all(ends[..., 1] == 0.0)
    keel = surface.evaluate(np.linspace(0.0, 1.0, 41), np.array([0.0]))
    assert np.all(keel[..., 1] == 0.0)
    # Entrance half angle at the waterline: dy/dx = 2 B/L; within 1 % over the first half per cent of the length.
    hull = wigley.transform(LENGTH, BREADTH, DRAFT)
    u = hull.patch_parameter("main", np.array([0.005 * LENGTH]))
    y = float(hull.patch_points("main", u, np.array([1.0]))[0, 0, 1])
    assert y / (0.005 * LENGTH) == pytest.approx(2.0 * BREADTH / LENGTH * (1 - 0.005), rel=0.01)


def test_michell_on_the_fitted_hull(wigley: ParentHull) -> None:
    hull = wigley.transform(LENGTH, BREADTH, DRAFT)
    table = hull.offset_table()
    froude = [0.266, 0.313, 0.316, 0.408]
    got = wave_coefficients(table.x, table.z, table.y, LENGTH, 0.14879 * LENGTH**2, froude)
    # References from the exact half-breadths on a 681 x 195 table; half a per cent is left to the fit through 81 x 21.
    assert got == pytest.approx(np.array([0.944, 1.918, 1.832, 3.030]) * 1e-3, rel=5e-3)


def test_deviation_report(wigley: ParentHull) -> None:
    report = wigley.fit_report
    assert report is not None
    # Half-breadths of metres on a smooth hull: a fit worse than 2 mm has lost the shape.
    assert report.patches[0].max_m < 2e-3
    text = str(report)
    assert "wigley.csv" in text and "rms" in text and "displaced volume" in text


def test_meshes_are_closed_at_this_scale(wigley: ParentHull) -> None:
    hull = wigley.transform(LENGTH, BREADTH, DRAFT)
    assert hull_mesh(hull, "view").is_volume
    under = underwater_mesh(hull, "view")
    assert under.is_volume
    assert under.volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=2e-3)


@pytest.mark.parametrize("block", [0.42, 0.444, 0.47])
def test_form_moves_on_a_hull_without_parallel_body(wigley: ParentHull, block: float) -> None:
    hull = wigley.transform(LENGTH, BREADTH, DRAFT, block * LENGTH * BREADTH * DRAFT)
    assert not hull.clipped
    assert hull.hydrostatics.block_coefficient == pytest.approx(block, rel=1e-9)
    assert hull.hydrostatics.longitudinal_centre_of_buoyancy == pytest.approx(LENGTH / 2, abs=1e-4 * LENGTH)


def test_volume_converges_with_the_table(tmp_path: Path) -> None:
    exact = 4.0 / 9.0 * LENGTH * BREADTH * DRAFT
    errors = []
    for stations, waterlines in ((11, 6), (41, 11)):
        path = write_wigley(tmp_path / f"w{stations}.csv", stations, waterlines)
        parent = parent_hull_from_offsets(path, LENGTH, DRAFT)
        errors.append(abs(parent.hydrostatics.displaced_volume / exact - 1.0))
    # The surface passes near the points; between coarse points it may be off by their second differences.
    assert errors[0] < 0.01
    assert errors[1] < 1e-3
