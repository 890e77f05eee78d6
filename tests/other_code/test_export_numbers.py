"""What stands in each column, place and side of the exported files, against numbers that are worked out here."""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import trimesh

from hpsop_core import evaluate
from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Ok
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.export import tables
from hpsop_core.export.lines import write_dxf
from hpsop_core.export.meshes import write_glb
from hpsop_core.export.offsets import half_breadths
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller

CASE = case_from_toml(
    """
[initial]
length = 300.0
breadth = 43.0
draft = 13.0
diameter = 8.0
blade_count = 4
expanded_area_ratio = 0.7
[bounds]
length_to_breadth = [6.4, 7.6]
breadth_to_draft = [3.0, 4.2]
draft = [12.5, 13.5]
diameter = [7.4, 8.2]
blade_count = [3, 6]
pitch_ratio = [0.9, 1.1]
[constants]
wave_calibration = "none"
""",
    "exported.toml",
)
DESIGN: DesignVariables = CASE.initial.variables.replaced({"pitch_ratio": 1.05})


@pytest.fixture(scope="module")
def case() -> Case:
    return CASE


@pytest.fixture(scope="module")
def hull() -> Hull:
    return design_hull(CASE, DESIGN)


@pytest.fixture(scope="module")
def propeller() -> Propeller:
    own = design_propeller(CASE, DESIGN)
    # P4119 has neither skew nor rake: a table that has both, each another function of the radius.
    table = own.table
    inward = table.radius_ratio - table.radius_ratio[0]
    return dataclasses.replace(own, table=dataclasses.replace(table, skew=0.6 * inward**2, rake_ratio=0.05 * inward))


@pytest.fixture(scope="module")
def reference() -> Reference:
    return reference_for(CASE, 1)


@pytest.fixture(scope="module")
def result(reference: Reference) -> Ok:
    found = evaluate(CASE, DESIGN, 1, reference)
    assert found.ok
    return found


def columns(text: str) -> dict[str, np.ndarray]:
    """Columns by their own names."""
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def comments(text: str) -> dict[str, float]:
    """Numbers of the lines "# name: number"."""
    return {name: float(value) for name, value in re.findall(r"^# (.+): ([-+.\de]+)$", text, re.M)}


def test_resistance_columns_are_what_their_names_say(case: Case, result: Ok, reference: Reference) -> None:
    text = tables.resistance_table(case, result, reference)
    assert text.splitlines()[0].startswith("# level 1;")
    found = columns(text)
    speed = found["froude_number"] * np.sqrt(9.80665 * result.hull.length)
    assert found["speed_m_s"] == pytest.approx(speed, rel=1e-8)
    line = 0.075 / (np.log10(speed * result.hull.length / 1.188e-6) - 2.0) ** 2
    assert found["friction_coefficient"] == pytest.approx(line, rel=1e-8)
    dynamic = 0.5 * 1025.0 * speed**2 * result.hull.wetted_surface
    assert found["friction_resistance_N"] == pytest.approx(line * dynamic, rel=1e-7)
    assert found["wave_coefficient"] == pytest.approx(found["wave_resistance_N"] / dynamic, rel=1e-7)
    assert found["form_resistance_N"] == pytest.approx(0.094 * found["friction_resistance_N"], rel=1e-7)
    parts = sum(values for name, values in found.items() if name.endswith("_resistance_N") and "total" not in name)
    assert found["total_resistance_N"] == pytest.approx(parts, rel=1e-7)
    at_two = dataclasses.replace(result, level=2)
    # The curve itself would be level 2's: the name in the head is asked here, by the open-water table.
    assert tables.open_water_table(at_two).startswith("# full scale, level 2\n")


def test_open_water_columns_are_what_their_names_say(result: Ok) -> None:
    found = columns(tables.open_water_table(result))
    j, kt, kq = (found[name] for name in ("advance_coefficient", "thrust_coefficient", "torque_coefficient"))
    assert j == pytest.approx(np.arange(0.25, 1.151, 0.05), rel=1e-9)
    eta = np.where(kt > 0.0, j * kt / (2.0 * math.pi * kq), 0.0)
    assert found["open_water_efficiency"] == pytest.approx(eta, rel=1e-7)
    # A propeller's KQ is a fifth to a tenth of its KT where it works.
    assert np.all(kq[:10] < 0.3 * kt[:10])
    condition = result.conditions[0]
    at = condition.advance_coefficient
    assert np.interp(at, j, kt) == pytest.approx(condition.thrust_coefficient, rel=5e-3)
    assert np.interp(at, j, kq) == pytest.approx(condition.torque_coefficient, rel=5e-3)


def test_propeller_columns_are_in_the_units_of_their_names(propeller: Propeller) -> None:
    found = columns(tables.propeller_table(propeller))
    table = propeller.table
    inward = found["r_R"] - found["r_R"][0]
    assert found["skew_deg"] == pytest.approx(np.degrees(0.6 * inward**2), abs=1e-7)
    assert found["rake_D"] == pytest.approx(0.05 * inward, abs=1e-9)
    assert found["f_c"] == pytest.approx(table.camber_ratio, rel=1e-8)
    assert found["t_c"] == pytest.approx(table.thickness_ratio, rel=1e-8)
    # P4119 as published (Jessup 1989), at 0.7 R: P/D 1.0839 and f/c 0.02003.
    assert np.interp(0.7, found["r_R"], found["P_D"]) == pytest.approx(1.05 * 1.0839, rel=2e-3)
    assert np.interp(0.7, found["r_R"], found["f_c"]) == pytest.approx(0.02003, rel=1e-3)


def test_hydrostatics_are_integrals_of_the_offsets(hull: Hull) -> None:
    text = tables.hydrostatics_table(hull)
    said = comments(text)
    # Half-breadths at 201 heights along the length, and trapezoids: a second integration.
    x = np.linspace(-0.02, 1.04, 241) * hull.length
    z = np.linspace(0.0, hull.draft, 121)
    half = half_breadths(hull, x, z)
    area = 2.0 * np.trapezoid(half, x, axis=0)
    volume = float(np.trapezoid(area, z))
    height = float(np.trapezoid(area * z, z)) / volume
    radius = 2.0 / 3.0 * float(np.trapezoid(half[:, -1] ** 3, x)) / volume
    forward = 2.0 * float(np.trapezoid(np.trapezoid(half, z, axis=1) * x, x)) / volume
    # The step of the table at the ends and at the bilge leaves less than a per cent.
    assert said["displaced volume [m3]"] == pytest.approx(volume, rel=5e-3)
    assert said["KB [m]"] == pytest.approx(height, rel=1e-2)
    assert said["BMt [m]"] == pytest.approx(radius, rel=1e-2)
    assert said["LCB from AP [m]"] == pytest.approx(forward, rel=5e-3)
    assert said["waterplane area [m2]"] == pytest.approx(area[-1], rel=1e-2)
    box = hull.length * hull.breadth * hull.draft
    assert said["CB"] == pytest.approx(said["displaced volume [m3]"] / box, rel=1e-5)
    assert said["CWP"] == pytest.approx(said["waterplane area [m2]"] / (hull.length * hull.breadth), rel=1e-5)
    assert said["CP"] == pytest.approx(said["CB"] / said["CM"], rel=1e-5)
    curve = columns(text)
    middle = np.interp(0.5 * hull.length, curve["station_x_m"], curve["sectional_area_m2"])
    assert middle == pytest.approx(said["CM"] * hull.breadth * hull.draft, rel=2e-3)


def test_lines_stand_where_a_draughtsman_puts_them(hull: Hull, propeller: Propeller, tmp_path: Path) -> None:
    path = tmp_path / "lines.dxf"
    write_dxf(path, hull, propeller)
    found: dict[str, list[np.ndarray]] = {}
    for item in ezdxf.readfile(path).modelspace():
        points = np.array([vertex.dxf.location.xyz for vertex in item.vertices])
        found.setdefault(item.dxf.layer, []).append(points)
    # Ten stations between the perpendiculars, quarters at the ends and halves between, and sections beyond.
    stations = {round(10.0 * float(line[0, 0]) / hull.length, 3) for line in found["STATIONS"]}
    within = {station for station in stations if 0.0 <= station <= 10.0}
    assert within == {*np.arange(0.0, 1.0, 0.25), *np.arange(1.0, 9.0, 0.5), *np.arange(9.0, 10.01, 0.25)}
    for line in found["STATIONS"]:
        assert np.ptp(line[:, 0]) < 1e-6 * hull.length
    # Buttocks: tenths of the breadth from the centreplane, and each as high as its stations say.
    places = {round(float(np.median(line[:, 1])) / hull.breadth, 3) for line in found["BUTTOCKS"]}
    assert places == {0.1, 0.2, 0.3, 0.4}
    for line in found["BUTTOCKS"]:
        assert np.ptp(line[:, 1]) < 1e-5 * hull.length
    heights = {round(float(np.median(line[:, 2])) / hull.draft, 3) for line in found["WATERLINES"]}
    assert {round(0.1 * step, 3) for step in range(1, 10)} <= heights and 1.2 in heights and 1.0 not in heights
    assert {round(float(np.median(line[:, 2])) / hull.draft, 3) for line in found["DESIGN_WATERLINE"]} == {1.0}
    # Nine sections on each of the four blades, each at its own radius.
    middle = np.array([0.0, 0.0, hull.shaft_height])
    radii = [np.hypot(*(line - middle)[:, 1:].T) / (0.5 * propeller.diameter) for line in found["BLADE_SECTIONS"]]
    assert sorted({round(float(np.median(radius)), 2) for radius in radii}) == [
        0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95,
    ]  # fmt: skip
    assert len(radii) >= 9 * 4


def test_the_viewers_file_is_no_mirror_image(hull: Hull, propeller: Propeller, tmp_path: Path) -> None:
    path = tmp_path / "design.glb"
    write_glb(path, hull, propeller)
    scene = trimesh.load(path)
    low, high = scene.bounds
    # x forward with the propeller at its after end, y up; the keel is low.
    blades = next(part for part in scene.dump() if part.metadata.get("name") == "propeller")
    assert blades.centroid[0] < 0.1 * hull.length < high[0] and low[1] == pytest.approx(0.0, abs=0.05)
    # Right-handed: seen from astern, looking forward along +x with y up and so starboard, +z, to the right, the blade
    # that goes clockwise has its leading edge forward. A mirror image would have it aft.
    shaft = hull.shaft_height
    up, right = blades.vertices[:, 1] - shaft, blades.vertices[:, 2]
    radius = np.hypot(up, right)
    ring = np.abs(radius - 0.35 * propeller.diameter) < 0.02 * propeller.diameter
    clockwise = np.arctan2(right[ring], up[ring])
    around = np.exp(1j * propeller.blade_count * clockwise)
    ahead = np.angle(around / np.mean(around))
    assert np.corrcoef(blades.vertices[ring, 0], ahead)[0, 1] > 0.7
    # glTF's faces are counter-clockwise from outside: the solid has a positive volume.
    assert blades.volume > 0.0
