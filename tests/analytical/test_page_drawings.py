"""What the page draws, against closed forms and against the numbers it is drawn from."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from numpy.typing import NDArray

from explorer.scene.camera import CLOSE_UPS, PRESETS, preset
from explorer.scene.colours import PRESSURE, SEA, around_zero, painted, ramp
from explorer.scene.transfer import transferred
from explorer.services.answers import Answers
from explorer.state.shown import Shown
from explorer.views.tables import design_card, many_table
from hpsop_core.case.case import KNOT, Case
from hpsop_core.evaluation.result import Evaluation, Failed
from hpsop_core.quantities import all_quantities, change_text, number_text
from tests.two_speeds import stated_case

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def case() -> Case:
    """The recommended case with stated wave coefficients, so that level 1 needs no level 2."""
    return stated_case()


@pytest.fixture(scope="module")
def answers() -> Answers:
    return Answers()


@pytest.fixture(scope="module")
def initial(case: Case, answers: Answers) -> Evaluation:
    return answers.initial(case, 1)


# ---- charts ----------------------------------------------------------------------------------------------------------
def test_the_conditions_lie_on_the_resistance_and_thrust_curves(case: Case, answers: Answers):
    variables = dataclasses.replace(case.initial.variables, length_to_breadth=7.6, blade_count=4, pitch_ratio=0.97)
    evaluation = answers.evaluate(case, variables, 1)
    curves = answers.curves(case, evaluation)
    for index, condition in enumerate(evaluation.conditions):
        at = int(np.argmin(np.abs(curves.thrust.froude_number - condition.froude_number)))
        point = curves.points[at]
        assert abs(point.froude_number - condition.froude_number) < 1e-9
        assert point.total_resistance == pytest.approx(condition.total_resistance, rel=1e-6)
        assert point.wave_resistance == pytest.approx(condition.wave_resistance, rel=1e-6)
        assert curves.thrust.required[at] == pytest.approx(condition.thrust, rel=1e-6)
        # a spline through KT every 0.05 of J, against the solver's own polynomial
        assert curves.thrust.available[index][at] == pytest.approx(condition.thrust, rel=2e-4)


def test_numbers_and_changes_for_people():
    assert number_text(173391.6, 0) == "173 392"
    assert number_text(-0.00001, 3) == "0.000"
    assert number_text(float("nan"), 2) == "–"
    assert change_text(3435.0, 3221.0, 0) == "−6.2 %"
    assert change_text(3.0, 4.0, 0, relative=False) == "+1"
    assert change_text(1.0, 1.00001, 4) == "0.0 %"


def test_the_body_plan_encloses_the_sectional_areas(case: Case, answers: Answers):
    lines = answers.lines(case, case.initial.variables)
    assert {station for station, _ in lines.sections} >= {0.0, 10.0, 20.0}
    for station, parts in lines.sections:
        if not 3.0 <= station <= 18.0:
            continue  # towards the ends a section is made of several parts
        half = np.concatenate(parts)
        half = half[np.argsort(half[:, 1], kind="stable")]
        under = half[half[:, 1] <= lines.draft + 1e-9]
        area = 2.0 * float(np.trapezoid(under[:, 0], under[:, 1]))
        wanted = float(np.interp(station / 20.0, lines.area_station, lines.area))
        # 29 points a section: a bilge of 29 points keeps its area within 1 %
        assert abs(area - wanted) < 0.01 * wanted, station


def test_each_pinned_design_is_compared_at_its_own_level(initial: Evaluation):
    other = dataclasses.replace(initial, level=2, objectives={**initial.objectives, "f1": 0.5})
    base = dataclasses.replace(initial, level=2, objectives={**initial.objectives, "f1": 0.4})
    table = many_table(
        {1: Shown("Initial design", initial), 2: Shown("Initial design", base)},
        [Shown("Design 7", initial), Shown("Design 8", other)],
        all_quantities(("Fn 0.22", "Fn 0.27")),
    )
    row = re.search(r'<tr data-compare="f1">(.*?)</tr>', table)
    assert row
    assert re.findall(r"[+−]?[\d.]+ %", row.group(1)) == ["0.0 %", "+25.0 %"]


def test_the_card_of_many_conditions_has_a_column_each(initial: Evaluation):
    assert initial.ok
    first = initial.conditions[0]
    conditions = tuple(dataclasses.replace(first, speed=knots * KNOT) for knots in (16, 18, 20, 22, 24, 25))
    card = design_card(Shown("Design 7", dataclasses.replace(initial, conditions=conditions)))
    assert re.findall(r"<th>([^<]+)</th>", card) == ["16 kn", "18 kn", "20 kn", "22 kn", "24 kn", "25 kn"]
    row = re.search(r"<tr><td>R<sub>T</sub></td>(.*?)</tr>", card)
    assert row
    assert len(re.findall("<td>", row.group(1))) == 6
    assert "Condition 1: 25.23 kn" in design_card(Shown("Design 7", initial))
    assert "failed" in design_card(Shown("Design 8", Failed("case", 1, initial.variables, "hull", "no form")))


# ---- the 3D view -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", [name for name in PRESETS if name not in CLOSE_UPS])
@pytest.mark.parametrize("aspect", [0.5, 0.7, 1.0, 1.6, 2.4])
def test_no_preset_cuts_the_ship(name: str, aspect: float):
    length, breadth, draft = 355.0, 51.0, 14.5
    pose = preset(name, length, breadth, draft, (7.5, 5.0), 9.0, aspect)
    # from ahead, where nothing stands before it, the house over the deck belongs to the ship
    top = 60.0 if name == "body" else 34.0
    corners = np.array([(x, y, z) for x in (-5.0, 362.0) for y in (-25.5, 25.5) for z in (0.0, top)])
    across, up = _seen(pose, corners, aspect)
    assert np.abs(across).max() < 1.0 and np.abs(up).max() < 1.0
    # and it is as large as the view allows: it fills one of the directions
    assert max(np.ptp(across), np.ptp(up)) > 1.7


@pytest.mark.parametrize("name", ["perspective", "plan", "body", "below"])
def test_a_ship_abeam_is_in_the_picture_too(name: str):
    pose = preset(name, 355.0, 51.0, 14.5, (7.5, 5.0), 9.0, 0.7, 76.5)
    corners = np.array([(x, y, z) for x in (-5.0, 362.0) for y in (-25.5, 102.0) for z in (0.0, 34.0)])
    across, up = _seen(pose, corners, 0.7)
    assert np.abs(across).max() < 1.0 and np.abs(up).max() < 1.0


@pytest.mark.parametrize("name", CLOSE_UPS)
@pytest.mark.parametrize("aspect", [0.5, 0.7, 1.6])
def test_the_close_up_shows_the_whole_propeller(name: str, aspect: float):
    pose = preset(name, 355.0, 51.0, 14.5, (7.5, 5.0), 9.0, aspect)
    turn = np.linspace(0.0, 2.0 * np.pi, 40)
    tips = np.column_stack([np.full(40, 7.5), 4.5 * np.cos(turn), 5.0 + 4.5 * np.sin(turn)])
    across, up = _seen(pose, tips, aspect)
    assert np.abs(across).max() < 0.9 and np.abs(up).max() < 0.75
    assert np.ptp(up) > 0.35


def _seen(pose, points: Array, aspect: float) -> tuple[Array, Array]:
    """Where points stand in the picture, from -1 to 1."""
    backward = np.array(pose.position) - np.array(pose.look_at)
    backward /= np.linalg.norm(backward)
    right = np.cross(pose.up, backward)
    right /= np.linalg.norm(right)
    local = points - np.array(pose.position)
    depth = -(local @ backward)
    assert depth.min() > 0.0
    half = np.tan(pose.field_of_view / 2.0)
    return local @ right / depth / half / aspect, local @ np.cross(backward, right) / depth / half


def test_a_painted_vertex_has_its_colour_on_the_scale():
    values = np.array([-2.0, -0.5, 0.0, 0.3, 1.0, 9.0])
    vertices = np.column_stack([values, values**2, np.zeros(6)])
    mesh = painted(vertices, np.array([[0, 1, 2], [3, 4, 5]]), values, (-1.0, 0.0, 2.0), PRESSURE)
    texture = np.asarray(mesh.visual.material.baseColorTexture)
    height, width = texture.shape[:2]
    column = np.round(mesh.visual.uv[:, 0] * width - 0.5).astype(int)
    row = height - 1 - np.round(mesh.visual.uv[:, 1] * height - 0.5).astype(int)
    shown = texture[row, column, :3].astype(int)
    wanted = ramp(PRESSURE, 2001)[np.round(2000 * np.interp(values, (-1.0, 0.0, 2.0), (0.0, 0.5, 1.0))).astype(int)]
    # half a texel of 256 along the steepest stretch of the scale
    assert np.abs(shown - wanted).max() <= 3
    assert (texture[row, column, 3] == 255).all()
    assert len({tuple(colour) for colour in ramp(SEA, 5)}) == 5


def test_limits_leave_out_spikes_and_keep_zero_in_the_middle():
    values = np.concatenate([np.linspace(-0.2, 0.1, 1000), [50.0]])
    low, middle, high = around_zero(values, np.ones(1001))
    assert -0.2 <= low < -0.19 and middle == 0.0 and 0.09 < high <= 0.1


def test_a_field_moves_to_a_finer_surface_and_stays_on_its_side():
    # two plates 1 mm apart that face away from each other carry different linear fields
    def plate(cells: int, z: float, up: bool) -> tuple[Array, NDArray[np.int64]]:
        x, y = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1), indexing="ij")
        index = np.arange(x.size).reshape(x.shape)
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
        return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z)]), faces if up else faces[:, ::-1]

    def both(cells: int) -> tuple[Array, NDArray[np.int64], Array]:
        (upper, first), (lower, second) = plate(cells, 0.001, True), plate(cells, 0.0, False)
        vertices = np.concatenate([upper, lower])
        values = np.where(vertices[:, 2] > 0.0, 1.0 + vertices[:, 0], -1.0 - vertices[:, 1])
        return vertices, np.concatenate([first, second + len(upper)]), values

    vertices, faces, values = both(4)
    onto, onto_faces, wanted = both(13)
    assert np.abs(transferred(vertices, faces, values, onto, onto_faces) - wanted).max() < 1e-9
