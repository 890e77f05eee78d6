"""What `hpsop export` writes, read again by openNURBS, ezdxf and trimesh, and by hpsop as a user's own files."""

from __future__ import annotations

import json
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import rhino3dm
import trimesh

from hpsop_core import optimize
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.export.design_files import export_design
from hpsop_core.export.slivers import least_angles
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.foreign.rhino import points_at
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.input import parent_hull_from_offsets
from hpsop_core.geometry.propeller.input import radial_table_from_csv
from hpsop_core.geometry.propeller.nurbs import propeller_surfaces
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.runs.reader import RunReader
from tests.two_speeds import stated_case


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    case = stated_case()
    file = tmp_path_factory.mktemp("run") / "small.hpsop"
    return optimize(case, file, generations=1, level1_generations=1, population=6, seed=2, workers=1)


@pytest.fixture(scope="module")
def design(run: RunReader) -> int:
    """A design whose form was shifted and whose propeller is not the parent's."""
    for point in run.archive():
        evaluation = run.design(point.id).evaluation
        if evaluation.ok and evaluation.variables.blade_count != 3 and evaluation.variables.displacement_ratio != 1.0:
            return point.id
    raise AssertionError("the sample holds no such design")


@pytest.fixture(scope="module")
def hull(run: RunReader, design: int) -> Hull:
    return design_hull(run.case, run.design(design).evaluation.variables)


@pytest.fixture(scope="module")
def propeller(run: RunReader, design: int) -> Propeller:
    return design_propeller(run.case, run.design(design).evaluation.variables)


@pytest.fixture(scope="module")
def files(run: RunReader, design: int, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export") / "design"
    export_design(run, design, folder)
    return folder


def rhino_points(surface, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    points = [[surface.PointAt(float(a), float(b)) for b in v] for a in u]
    return np.array([[(p.X, p.Y, p.Z) for p in row] for row in points])


def test_opennurbs_reads_the_same_surfaces(files: Path, hull: Hull, propeller: Propeller) -> None:
    model = rhino3dm.File3dm.Read(str(files / "design.3dm"))
    assert model.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Meters
    parts = {item.Attributes.Name: item.Geometry for item in model.Objects}
    assert all(part.IsValid for part in parts.values())
    u, v = np.linspace(0.0, 1.0, 23), np.linspace(0.0, 1.0, 11)
    for patch in hull.patches:
        ours = patch.evaluate(u, v)
        port = rhino_points(parts[f"{patch.name} port"], u, v)
        # The longitudinal shift is refitted for exchange: 1e-5 of the length at most, in x alone.
        assert np.max(np.abs(port[..., 0] - ours[..., 0])) < 1.1e-5 * hull.length
        assert np.allclose(port[..., 1:], ours[..., 1:], atol=1e-8)
        starboard = rhino_points(parts[f"{patch.name} starboard"], u, v)
        assert np.allclose(starboard, port * [1.0, -1.0, 1.0], atol=1e-12)
    ours = propeller_surfaces(propeller, propeller_placement(hull, propeller))
    for name, surface in ours.items():
        assert np.allclose(rhino_points(parts[name], u, v), surface.evaluate(u, v), atol=1e-9)
    # A circle only where the weights arrived as they should: the hub's cylinder about the shaft.
    hub = rhino_points(parts["hub"], np.array([0.4]), np.linspace(0.0, 1.0, 37))[0]
    radius = np.hypot(hub[:, 1], hub[:, 2] - hull.shaft_height)
    assert np.allclose(radius, 0.5 * propeller.diameter * propeller.hub_ratio, rtol=1e-9)
    layers = [layer.Name for layer in model.Layers]
    on = {item.Attributes.Name: layers[item.Attributes.LayerIndex] for item in model.Objects}
    assert on["main port"] == "hull underwater" and on["blade 1 back"] == "propeller"
    assert on["topsides_mid deck port"] == "hull flat ends"


def test_solids_are_closed_and_displace_what_hydrostatics_say(files: Path, hull: Hull, propeller: Propeller) -> None:
    scenes = [trimesh.load_scene(files / name) for name in ("hull.stl", "propeller.stl")]
    assert [set(scene.geometry) for scene in scenes] == [{"hull", "deck", "transom"}, {"blades", "hub"}]
    for part in ("deck", "transom"):
        normals = np.abs(scenes[0].geometry[part].face_normals)
        assert np.all(normals[:, 2 if part == "deck" else 0] > 0.7), part
    ship, screw = (scene.to_mesh() for scene in scenes)
    for solid, least in ((ship, 1.0), (screw, 0.5)):
        solid.merge_vertices()
        assert solid.is_watertight and solid.volume > 0.0
        # Half a degree at the foot of the trailing edge, which is a thousandth of the diameter wide.
        assert np.degrees(np.min(least_angles(solid.vertices, solid.faces))) > least
    # Volume below the waterplane by Gauss's theorem with the field (0, 0, z - d), which is nought on the lid.
    # The mesh has vertices on the waterline: no triangle crosses it by more than STL's single precision.
    heights = ship.triangles[:, :, 2] - hull.draft
    wet = np.max(heights, axis=1) < 1e-4
    assert np.min(heights[~wet]) > -1e-4
    volume = float(np.sum(heights[wet].mean(axis=1) * ship.area_faces[wet] * ship.face_normals[wet, 2]))
    # Flat facets cut 0.06 % off the round bilge and bulb; more than 0.2 % would be a hole.
    assert volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=2e-3)
    centre = 0.5 * (screw.bounds[0] + screw.bounds[1])
    assert abs(centre[1]) < 0.1 * propeller.diameter
    assert screw.bounds[1, 2] <= hull.shaft_height + 0.501 * propeller.diameter
    assert screw.bounds[1, 0] == pytest.approx(hull.boss_end_x, abs=1e-6 * hull.length)


def test_viewers_find_named_parts_with_y_up(files: Path, hull: Hull) -> None:
    scene = trimesh.load(files / "design.glb")
    assert set(scene.geometry) == {"underwater", "topsides", "propeller"}
    low, high = scene.bounds
    assert high[1] == pytest.approx(hull.parent.deck_height * hull.draft / hull.parent.draft, rel=1e-4)
    # The fitted topsides leave the published offsets by up to 0.1 m (docs/geometry-hull.md).
    assert -low[2] == pytest.approx(high[2], rel=1e-4) and high[2] == pytest.approx(0.5 * hull.breadth, rel=5e-3)
    assert scene.geometry["underwater"].bounds[1, 2] <= hull.draft * (1.0 + 1e-5)


def test_lines_lie_on_the_hull(files: Path, hull: Hull) -> None:
    drawing = ezdxf.readfile(files / "lines.dxf")
    assert drawing.units == ezdxf.units.M and not drawing.audit().errors
    lines: dict[str, list[np.ndarray]] = {}
    for item in drawing.modelspace():
        points = np.array([vertex.dxf.location.xyz for vertex in item.vertices])
        lines.setdefault(item.dxf.layer, []).append(points)
    wanted = {"STATIONS", "WATERLINES", "DESIGN_WATERLINE", "BUTTOCKS", "PROFILE", "BLADE_SECTIONS"}
    assert set(lines) == wanted
    amidships = [line for line in lines["STATIONS"] if abs(line[0, 0] - 0.5 * hull.length) < 1e-6 * hull.length]
    area = 0.0
    for line in amidships:
        below = line[line[:, 2] <= hull.draft * (1.0 + 1e-9)]
        area += 2.0 * float(np.trapezoid(below[:, 1], below[:, 2]))
    h = hull.hydrostatics
    expected = np.interp(0.5 * hull.length, h.sectional_area_x, h.sectional_area)
    # 101 points along the girth by the trapezoidal rule.
    assert area == pytest.approx(float(expected), rel=2e-3)
    waterline = np.concatenate(lines["DESIGN_WATERLINE"])
    # Cut 1e-6 of the length above the draft, where the mesh has its vertices.
    assert np.allclose(waterline[:, 2], hull.draft, atol=2e-6 * hull.length)
    exact = hull.waterline(801)
    inside = (waterline[:, 0] > exact[0, 0] + 1.0) & (waterline[:, 0] < exact[-1, 0] - 1.0) & (waterline[:, 1] > 0.05)
    off = np.abs(waterline[inside, 1] - np.interp(waterline[inside, 0], exact[:, 0], exact[:, 1]))
    assert np.count_nonzero(inside) > 200 and float(np.max(off)) < 0.05
    for layer in wanted - {"BLADE_SECTIONS"}:
        assert all(line[:, 1].min() > -1e-6 for line in lines[layer])


def test_tables_come_back_as_a_users_own(files: Path, run: RunReader, design: int, hull: Hull) -> None:
    again = parent_hull_from_offsets(files / "offsets.csv", hull.length, hull.draft)
    # As the limits of the fit to the published table: 0.3 % in volume, 0.7 % in wetted surface.
    assert again.hydrostatics.displaced_volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=3e-3)
    assert again.hydrostatics.wetted_surface == pytest.approx(hull.hydrostatics.wetted_surface, rel=7e-3)
    propeller = design_propeller(run.case, run.design(design).evaluation.variables)
    table = radial_table_from_csv(files / "propeller.csv", propeller.blade_count)
    assert np.allclose(table.chord_ratio, propeller.table.chord_ratio, rtol=1e-8)
    assert np.allclose(table.pitch_ratio, propeller.table.pitch_ratio, rtol=1e-8)
    assert table.expanded_area_ratio_per_blade * table.blade_count == pytest.approx(
        propeller.expanded_area_ratio, rel=1e-7
    )


def test_numbers_are_those_of_the_run(files: Path, run: RunReader, design: int) -> None:
    evaluation = run.design(design).evaluation
    assert json.loads((files / "design.json").read_text()) == json.loads(json.dumps(run.design(design).as_dict()))
    rows = np.genfromtxt(files / "resistance.csv", delimiter=",", skip_header=2)
    for condition in evaluation.conditions:
        row = rows[np.argmin(np.abs(rows[:, 0] - condition.froude_number))]
        assert row[6] == pytest.approx(condition.total_resistance, rel=1e-8)
    curve = np.genfromtxt(files / "open_water.csv", delimiter=",", skip_header=2)
    assert curve[:, 1] == pytest.approx(np.array(evaluation.open_water.thrust_coefficient), rel=1e-8)
    areas = np.genfromtxt(files / "hydrostatics.csv", delimiter=",", comments="#", skip_header=14)
    assert float(np.trapezoid(areas[:, 1], areas[:, 0])) == pytest.approx(evaluation.hull.displaced_volume, rel=2e-3)
    text = (files / "README.txt").read_text()
    assert all(file.name in text for file in files.iterdir() if file.name != "README.txt")


def test_points_of_a_rhino_surface_are_those_that_rhino_gives() -> None:
    floating = rhino3dm.NurbsSurface.Create(3, False, 4, 3, 6, 5)
    for knots in (floating.KnotsU, floating.KnotsV):
        for k in range(len(knots)):
            knots[k] = 0.5 * k  # not clamped: openNURBS' own closed surfaces are not
    for i in range(6):
        for j in range(5):
            floating.Points[(i, j)] = rhino3dm.Point4d(i, j, i * j % 3, 1.0 + 0.2 * ((i + j) % 2))
    sphere = rhino3dm.Sphere(rhino3dm.Point3d(50.0, 0.0, 0.0), 20.0).ToNurbsSurface()
    for surface in (floating, sphere):
        u, v = (np.linspace(d.T0, d.T1, count) for d, count in ((surface.Domain(0), 9), (surface.Domain(1), 7)))
        given = [surface.PointAt(float(a), float(b)) for a in u for b in v]
        np.testing.assert_allclose(points_at(surface, u, v), [[p.X, p.Y, p.Z] for p in given], rtol=0.0, atol=1e-12)
