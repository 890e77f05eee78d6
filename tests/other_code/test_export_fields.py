"""What `hpsop export` writes of waves, pressures, panels and blade sections, read again by VTK or plainly as text."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from hpsop_core import evaluate, load_case, pressures, waves
from hpsop_core.cli.main import main
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.export.vtp import write_vtp
from hpsop_core.geometry.propeller.surface import section_points

CASE = "dtc-p4119-paper"


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As the command writes them of a case, without a run."""
    folder = tmp_path_factory.mktemp("export") / "design"
    assert main(["export", CASE, "--to", str(folder), "--formats", "vtk,pff,gdf,json"]) == 0
    return folder


def test_a_case_is_exported_at_level_2_without_a_run(files: Path) -> None:
    names = {file.name for file in files.iterdir()}
    assert {"waves_1.vtp", "pressure_hull_1.vtp", "pressure_blades_2.vtp", "hull.gdf", "propeller.pff"} <= names
    assert all(name in (files / "README.txt").read_text() for name in names - {"README.txt"})
    assert '"level": 2' in (files / "design.json").read_text()


def polygons(path: Path) -> tuple[np.ndarray, list[np.ndarray], dict[str, np.ndarray]]:
    """Points, the polygons' corners and every array of a VTP in text."""
    root = ElementTree.parse(path).getroot()
    arrays = {
        item.get("Name"): np.array((item.text or "").split(), dtype=np.float64) for item in root.iter("DataArray")
    }
    ends = arrays["offsets"].astype(int)
    return arrays["Points"].reshape(-1, 3), np.split(arrays["connectivity"].astype(int), ends[:-1]), arrays


def area_vector(points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    corners = points[polygon] - points[polygon[0]]
    return 0.5 * np.sum(np.cross(corners[1:-1], corners[2:]), axis=0)


def test_waves_are_the_solvers_on_both_sides(files: Path) -> None:
    case = load_case(CASE)
    field = waves(case, evaluate(case, level=2))
    points, quads, arrays = polygons(files / "waves_1.vtp")
    assert arrays["elevation"][: field.elevation.size] == pytest.approx(field.elevation.ravel(), rel=1e-8, abs=1e-9)
    # Points stand where the water is: the static waterline and the elevation above it.
    assert points[:, 2] - design_hull(case, case.initial.variables).draft == pytest.approx(
        arrays["elevation"], abs=1e-6
    )
    assert points[:, 1].min() == pytest.approx(-points[:, 1].max())
    assert all(area_vector(points, quad)[2] > 0.0 for quad in quads)


def test_pressures_are_the_solvers_and_normals_point_to_the_water(files: Path) -> None:
    case = load_case(CASE)
    field = pressures(case, evaluate(case, level=2)).hull
    points, quads, arrays = polygons(files / "pressure_hull_1.vtp")
    whole = len(quads) == len(field.quads)
    if whole:
        assert arrays["pressure"] == pytest.approx(field.pressure, rel=1e-8, abs=1e-3)
    assert len(arrays["pressure"]) == len(quads)
    # Closed by the waterplane alone, a surface's area vectors add up to that plane's, pointing down.
    total = np.sum([area_vector(points, quad) for quad in quads], axis=0)
    area = design_hull(case, case.initial.variables).hydrostatics.waterplane_area
    # Flat panels and a truncated transom: a hundredth.
    assert -total[2] == pytest.approx(area, rel=0.02) and abs(total[1]) < 1e-6 * area


def test_pressures_are_in_pascals_and_push_the_way_they_should(files: Path) -> None:
    """Without VTK: the stagnation pressure of the condition's speed lies between both arrays, at every condition."""
    case = load_case(CASE)
    constants = case.constants
    for number, condition in enumerate(evaluate(case, level=2).conditions, start=1):
        points, quads, arrays = polygons(files / f"pressure_hull_{number}.vtp")
        stagnation = 0.5 * constants.density * condition.speed**2
        assert arrays["pressure"] == pytest.approx(stagnation * arrays["pressure_coefficient"], rel=1e-6, abs=1e-3)
        # no more than at rest, but for what the waves add, which are shallower than a tenth of the draft
        assert np.max(arrays["pressure_coefficient"]) < 1.5
        areas = np.array([area_vector(points, quad) for quad in quads])
        force = -arrays["pressure"] @ areas
        # Both sides: nothing sideways; the ship sinks in its own flow: its dynamic pressures pull it down.
        assert abs(force[1]) < 1e-6 * np.abs(arrays["pressure"]) @ np.linalg.norm(areas, axis=1)
        assert condition.sinkage is not None and np.sign(-force[2]) == np.sign(condition.sinkage)
        # What sinks it is carried by the waterplane, rho g A dz, but for what trim lifts about a point that is not the
        # waterplane's centre, and the flat panels: 3 and 4 % here.
        area = design_hull(case, case.initial.variables).hydrostatics.waterplane_area
        lifted = constants.density * constants.gravity * area * condition.sinkage
        assert -force[2] == pytest.approx(lifted, rel=0.05)


def test_vtk_reads_them(files: Path) -> None:
    pyvista = pytest.importorskip("pyvista", reason="VTK is no dependency: pip install pyvista")
    for file in files.glob("*.vtp"):
        mesh = pyvista.read(file)
        points, quads, _ = polygons(file)
        assert mesh.n_points == len(points) and mesh.n_cells == len(quads)
        assert np.allclose(mesh.points, points)
        names = {"elevation"} if "waves" in file.name else {"pressure", "pressure_coefficient", "blade"}
        assert names <= {*mesh.point_data, *mesh.cell_data}
        assert np.all(np.isfinite(mesh.compute_cell_sizes().cell_data["Area"]))


def test_a_corner_given_twice_makes_a_triangle(tmp_path: Path) -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    quads = np.array([[0, 1, 2, 3], [0, 1, 2, 2], [0, 0, 1, 1]])
    write_vtp(tmp_path / "a.vtp", points, quads, cell_data={"number": np.arange(3)})
    _, found, arrays = polygons(tmp_path / "a.vtp")
    assert [list(polygon) for polygon in found] == [[0, 1, 2, 3], [0, 1, 2]]
    assert list(arrays["number"]) == [0, 1]


def test_gdf_panels_enclose_the_displacement(files: Path) -> None:
    lines = (files / "hull.gdf").read_text().splitlines()
    assert lines[1].split()[:2] == ["1.0", "9.80665"] and lines[2].split()[:2] == ["0", "1"]
    quads = np.array([line.split() for line in lines[4:]], dtype=np.float64).reshape(-1, 4, 3)
    assert len(quads) == int(lines[3]) and quads[..., 1].min() >= 0.0 and quads[..., 2].max() == 0.0
    diagonal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    # Divergence of (0, 0, z): the waterplane adds nothing there. Both sides.
    volume = -2.0 * np.sum(0.5 * diagonal[:, 2] * quads[..., 2].mean(axis=1)) * -1.0
    case = load_case(CASE)
    expected = design_hull(case, case.initial.variables).hydrostatics.displaced_volume
    # Flat panels of 2 to 3 % of the length lie inside a convex hull: half a per cent.
    assert volume == pytest.approx(expected, rel=5e-3)


def test_pff_holds_the_blades_own_sections(files: Path) -> None:
    lines = (files / "propeller.pff").read_text().splitlines()
    case = load_case(CASE)
    propeller = design_propeller(case, case.initial.variables)
    assert float(lines[4].split()[0]) == pytest.approx(1000.0 * propeller.diameter)
    blades, _, radii, stations, clockwise = lines[8].split()
    assert int(blades) == propeller.blade_count and clockwise == "1"
    starts = [place for place, line in enumerate(lines) if line.startswith("* r/R")]
    assert len(starts) == int(radii)
    for start in starts:
        ratio, radius, chord = (float(word) for word in lines[start + 1].split())
        pitch = float(lines[start + 3].split()[0])
        own = propeller.table.at(np.array([ratio]))
        assert radius == pytest.approx(500.0 * propeller.diameter * ratio, abs=5e-3)
        assert (chord, pitch) == pytest.approx(
            (1000.0 * propeller.diameter * own.chord_ratio[0], 1000.0 * propeller.diameter * own.pitch_ratio[0]),
            rel=1e-4,
        )
        rows = np.array([line.split() for line in lines[start + 5 : start + 5 + int(stations)]], dtype=np.float64)
        _, back = section_points(own, rows[:, 0], True)
        _, face = section_points(own, rows[:, 0], False)
        expected = 500.0 * propeller.diameter * np.stack([back[0], face[0]])
        assert np.allclose(rows[:, 1:].T, expected, rtol=1e-3, atol=0.1)  # stations of six digits, at the nose
        assert np.all(rows[:, 1] >= rows[:, 2]) and (rows[0, 0], rows[-1, 0]) == (0.0, 1.0)
