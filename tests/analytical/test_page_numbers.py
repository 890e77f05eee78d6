"""What the page shows of a number, a design or a generation, without a browser: the right one, in the right unit."""

from __future__ import annotations

import dataclasses
import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hand_calculation import BASE

from explorer.charts.pareto import ParetoOptions, automatic_limits, drawn_designs, front_order, pick
from explorer.scene.colours import PRESSURE, SEA, pressure_legend, sea_legend
from explorer.scene.geometry import scene_geometry
from explorer.scene.pressure import PressureMap, blade_map
from explorer.scene.waves import wave_surface
from explorer.services import designs as designs_module
from explorer.services.designs import Designs
from explorer.state.run_picture import GenerationPicture, RunPicture
from explorer.state.shown import Shown
from explorer.views import scene_view
from explorer.views.pareto.chart import nothing_feasible
from explorer.views.tables import comparison_table, design_card
from hpsop_core import evaluate
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.propulsion import open_water_chart
from hpsop_core.evaluation.fields import WaveField, blade_pressure, waves
from hpsop_core.evaluation.result import Ok
from hpsop_core.markup import Markup
from hpsop_core.quantities import condition_names, condition_quantities, quantities_of_case

CASE = BASE


@pytest.fixture(scope="module")
def initial() -> Ok:
    result = evaluate(CASE)
    assert result.ok
    return result


@pytest.fixture(scope="module")
def other() -> Ok:
    result = evaluate(CASE, CASE.initial.variables.replaced({"diameter": 9.1, "pitch_ratio": 1.05}))
    assert result.ok
    return result


# ---- numbers ---------------------------------------------------------------------------------------------------------
def test_units_of_the_pages_numbers(initial: Ok) -> None:
    quantities = {item.key: item for item in condition_quantities(condition_names(CASE))}
    for index, condition in enumerate(initial.conditions, 1):
        power = 2.0 * math.pi * condition.rotation_rate_rpm / 60.0 * condition.torque
        for name, unit, value in (
            ("speed", "kn", condition.speed * 3600.0 / 1852.0),
            ("total_resistance", "kN", condition.total_resistance / 1000.0),
            ("thrust", "kN", condition.thrust / 1000.0),
            ("torque_coefficient", "", 10.0 * condition.torque_coefficient),
            ("delivered_power", "MW", power / 1e6),
            ("brake_power", "MW", power / 1e6),
            ("effective_power", "MW", condition.total_resistance * condition.speed / 1e6),
        ):
            quantity = quantities[f"{name}_{index}"]
            assert quantity.unit == unit
            assert quantity.value(initial) == pytest.approx(value, rel=1e-9), name
    assert quantities["torque_coefficient_1"].symbol.startswith("10K")
    # A ship of 0.2 sqrt(g 340 m) makes 22.45 kn.
    assert condition_names(CASE)[0] == "22.45 kn"
    # Half a metre a second is no knot: 1852 m in an hour.
    assert condition_names(CASE.replaced("conditions", speeds_knots=[20.0, 25.0])) == ("20 kn", "25 kn")


def test_the_table_has_each_design_in_its_own_column(initial: Ok, other: Ok) -> None:
    table = comparison_table(Shown("Initial design", initial, kind="initial"), Shown("Design 7", other),
                             quantities_of_case(CASE))  # fmt: skip
    row = re.search(r'<tr data-quantity="propeller_diameter">(.*?)</tr>', table)
    assert row
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", row.group(1))
    assert cells[-3:] == ["8.80", "9.10", "+3.4 %"]
    card = design_card(Shown("Design 7", other))
    assert ">9.10" in card and ">8.80" not in card


# ---- a run -----------------------------------------------------------------------------------------------------------
def run_picture() -> RunPicture:
    """Nine designs over three generations; the last is of level 2. The seventh is infeasible, the eighth is by hand."""
    ids = np.arange(11, 20)
    objectives = np.array(
        [(0.90, 1.00), (0.95, 0.95), (1.00, 0.90), (0.88, 0.99), (0.93, 0.93), (0.98, 0.88), (0.80, 0.80),
         (0.92, 0.97), (0.91, 0.94)]
    )  # fmt: skip
    return RunPicture(
        name="a",
        case=CASE,
        ids=ids,
        level=np.array([1, 1, 1, 1, 1, 1, 1, 1, 2]),
        generation=np.array([1, 1, 1, 2, 2, 2, 2, 2, 3]),
        objectives=objectives,
        feasible=ids != 17,
        failed=np.zeros(9, dtype=bool),
        by_hand=ids == 18,
        table=np.linspace(1.0, 9.0, 9)[:, None],
        columns=("propeller_diameter",),
        generations=(
            GenerationPicture(1, 1, (11, 12, 13), (11, 12, 13), 0.1),
            GenerationPicture(2, 1, (14, 15, 16), (14, 15, 16), 0.2),
            GenerationPicture(3, 2, (19,), (19,), 0.3),
        ),
        compromise=19,
        knee=19,
    )


def test_a_scrubbed_generation_is_that_generation() -> None:
    picture = run_picture()
    for number, front in ((1, [11, 12, 13]), (2, [14, 15, 16]), (3, [19])):
        found = picture.generation_at(number)
        assert found is not None and found.number == number
        assert sorted(front_order(picture, number)) == front
        drawn = drawn_designs(picture, ParetoOptions(generation=number))
        shown = {int(value) for value in picture.ids[drawn.rows]}
        # All that was found up to then, that generation's own designs too, and nothing later.
        assert shown == {11, 12, 13} | ({14, 15, 16, 18} if number > 1 else set()) | ({19} if number > 2 else set())
        fronts = {int(value) for value in picture.ids[drawn.rows[drawn.front]]}
        newest_of_level_1 = [11, 12, 13] if number == 1 else [14, 15, 16]
        assert fronts == {*newest_of_level_1, *front}
    assert picture.generation_at(None).number == 3
    infeasible = drawn_designs(picture, ParetoOptions(infeasible=True))
    assert 17 in picture.ids[infeasible.rows] and 17 not in picture.ids[drawn_designs(picture, ParetoOptions()).rows]


def test_a_run_without_a_feasible_design_says_which_limits_are_in_the_way() -> None:
    picture = run_picture()
    assert nothing_feasible(picture) == ""
    broken = dataclasses.replace(
        picture,
        feasible=np.zeros(9, dtype=bool),
        table=np.array([[0.2, -1.0, 0.1]] * 7 + [[0.2, -1.0, -0.1]] * 2),
        columns=("g_length", "g_breadth", "g_cavitation"),
    )
    said = nothing_feasible(broken)
    assert said.startswith("None of 9 designs keeps all constraints")
    assert "length / greatest by 9, cavitation (blade area) by 7 of them" in said and "breadth" not in said


def test_front_order_goes_along_the_first_objective() -> None:
    assert front_order(run_picture(), 1) == [11, 12, 13]
    assert front_order(run_picture(), 2) == [14, 15, 16]


def test_a_range_has_both_its_ends() -> None:
    picture = run_picture()
    assert picture.ids[picture.inside({"f1": (0.90, 0.93)})].tolist() == [11, 15, 18, 19]
    assert picture.ids[picture.inside({"propeller_diameter": (2.5, 4.5)})].tolist() == [13, 14]
    both = picture.inside({"f1": (0.90, 0.95), "f2": (0.94, 0.96)})
    assert picture.ids[both].tolist() == [12, 19]


def test_a_click_means_the_nearest_design_and_shows_that_one(initial: Ok) -> None:
    picture, options, size = run_picture(), ParetoOptions(), (400.0, 300.0)
    limits = automatic_limits(picture, options)
    (x0, x1), (y0, y1) = limits
    drawn = [int(value) for value in picture.ids[drawn_designs(picture, options).rows]]
    for design in drawn:
        x, y = picture.objectives[picture.row(design)]
        aside = 2.0 / size[0] * (x1 - x0), -2.0 / size[1] * (y1 - y0)
        # Two pixels beside it, and nothing else so near.
        assert pick(picture, options, x + aside[0], y + aside[1], limits, size)[0] == design
    assert pick(picture, options, x0 + 0.02 * (x1 - x0), y0 + 0.02 * (y1 - y0), limits, size) == []

    class Source:
        opening = 0

        def evaluation(self, design_id: int) -> Ok:
            return dataclasses.replace(initial, objectives={"f1": float(design_id), "f2": 0.0})

        def initial(self, level: int) -> Ok:
            return dataclasses.replace(initial, level=level)

    designs = Designs(SimpleNamespace(picture=picture))  # type: ignore[arg-type]
    designs.read_from(Source())
    for design in drawn:
        shown = designs.shown(design)
        assert shown is not None and shown.design_id == design
        assert shown.evaluation.objectives["f1"] == design
        assert shown.generation == picture.generation[picture.row(design)]
        assert ("by hand" in shown.label) == (design == 18)
    # The initial design is seen at the level that the run has reached.
    assert designs.first().evaluation.level == 2
    first = dataclasses.replace(picture, generations=picture.generations[:2])
    early = Designs(SimpleNamespace(picture=first))  # type: ignore[arg-type]
    early.read_from(Source())
    assert early.first().evaluation.level == 1


# ---- charts ----------------------------------------------------------------------------------------------------------
def test_the_required_thrust_is_a_parabola_through_the_operating_point(initial: Ok) -> None:
    plot = open_water_chart([(Look("initial", "initial"), initial)], Sheet(420.0, 300.0))
    svg = str(plot.svg("open-water", ""))
    for number, condition in enumerate(initial.conditions, 1):
        lines = [
            line
            for line in re.findall(r"<path[^>]*>(?:<title>[^<]*</title>)?", svg)
            if f"required KT, condition {number}" in line
        ]
        assert len(lines) == 1
        numbers = [float(word) for word in re.findall(r"[-\d.]+", re.search(r' d="([^"]+)"', lines[0]).group(1))]
        points = np.array(numbers).reshape(-1, 2)
        # Back from pixels to J and KT by the plot's own axes; drawn to a tenth of a pixel.
        j = np.interp(points[:, 0], *_scale(plot.px, 0.0, 1.2))
        kt = np.interp(points[:, 1], *_scale(plot.py, 1.4, 0.0))
        wanted = condition.thrust_coefficient * (j / condition.advance_coefficient) ** 2
        assert np.abs(kt - wanted).max() < 6e-3
        assert np.abs(kt - np.interp(j, (0.0, j.max()), (0.0, wanted.max()))).max() > 0.03


def _scale(to_pixels: Any, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    values = np.linspace(low, high, 200)
    pixels = np.array([float(to_pixels(value)) for value in values])
    order = np.argsort(pixels)
    return pixels[order], values[order]


# ---- the 3D view -----------------------------------------------------------------------------------------------------
def test_legends_go_from_low_to_high_as_the_surfaces_do() -> None:
    pressure = pressure_legend(Markup("Cp"), (-1.25, 0.0, 0.75), Markup(""))
    sea = sea_legend(0.62, Markup(""))
    for legend, stops, ticks in (
        (pressure, PRESSURE, ["−1.25", "0.00", "0.75"]),
        (sea, SEA, ["−0.62", "0.00", "0.62"]),
    ):
        colours = [tuple(map(int, found)) for found in re.findall(r"rgb\((\d+),(\d+),(\d+)\)", legend)]
        assert colours == list(stops) and "linear-gradient(90deg" in legend
        assert re.findall(r"<span>([^<]*)</span>", legend) == ticks
    # Suction is blue and stagnation red; troughs are dark and crests light.
    assert PRESSURE[0][2] > PRESSURE[0][0] and PRESSURE[-1][0] > PRESSURE[-1][2]
    assert sum(SEA[0]) < sum(SEA[2]) < sum(SEA[-1])


@pytest.fixture(scope="module")
def blades(initial: Ok) -> PressureMap:
    return blade_map(blade_pressure(CASE, initial), scene_geometry(CASE, initial.variables))


def test_blade_pressures_are_on_the_speed_that_the_legend_names(initial: Ok, blades: PressureMap) -> None:
    condition = initial.conditions[0]
    rate, diameter = condition.rotation_rate_rpm / 60.0, initial.propeller.diameter
    advance = condition.advance_coefficient * rate * diameter
    reference = 0.5 * 1025.0 * (advance**2 + (0.7 * math.pi * rate * diameter) ** 2)
    # The thrust of the pressures alone: the force along the shaft of all blades, which the hub's share and the
    # sections' drag change by some per cent, and half the speed would make four times too small.
    corners = blades.vertices[blades.faces]
    areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    pressure = blades.coefficient[blades.faces].mean(axis=1) * reference
    thrust = -float(np.sum(pressure * areas[:, 0]))
    assert thrust == pytest.approx(condition.thrust, rel=0.15)


def test_blade_pressures_are_remembered_by_design(initial: Ok, other: Ok, monkeypatch: pytest.MonkeyPatch) -> None:
    picture = RunPicture("", CASE)
    seen: list[float] = []

    def computed(case: object, evaluation: Ok, *, condition: int) -> Ok:
        seen.append(evaluation.variables.diameter)
        return evaluation

    for name in ("blade_pressure", "hull_pressure", "waves"):
        monkeypatch.setattr(designs_module, name, computed)
    for name in ("blade_map", "hull_map"):
        monkeypatch.setattr(designs_module, name, lambda field, geometry: field)
    designs = Designs(SimpleNamespace(picture=picture))  # type: ignore[arg-type]
    # Equal in J and Froude number, and other designs all the same.
    same = dataclasses.replace(other, conditions=initial.conditions)
    for ask in (designs.blade_pressure, designs.hull_pressure, designs.waves):
        seen.clear()
        assert ask(initial, 0) is initial and ask(same, 0) is same and ask(initial, 0) is initial
        assert seen == [8.8, 9.1]
        # Another condition is another map.
        assert ask(initial, 1) is initial and len(seen) == 3


def test_waves_are_by_the_designs_own_level_and_calibration(initial: Ok) -> None:
    first = waves(CASE, initial)
    assert first.level == 1 and first.spectrum is not None
    condition = initial.conditions[0]
    assert first.wave_calibration == pytest.approx(condition.wave_calibration) != pytest.approx(1.0, abs=0.05)
    plain_case = CASE.changed({"constants": {"wave_calibration": "none", "stated_wave_coefficients": ()}})
    plain = waves(plain_case, evaluate(plain_case))
    # The resistance goes with the square of the height.
    root = math.sqrt(condition.wave_calibration)
    assert first.elevation == pytest.approx(root * plain.elevation, rel=1e-6, abs=1e-9)
    assert f"√{condition.wave_calibration:.3g}" in wave_surface(first).note and "√" not in wave_surface(plain).note
    second = evaluate(CASE, None, 2)
    assert second.ok
    found: WaveField = waves(CASE, second)
    assert found.level == 2 and found.spectrum is None and found.solver.lower().startswith("rankine")
    assert "Rankine" in wave_surface(found).note


def test_the_propeller_turns_ahead(initial: Ok, monkeypatch: pytest.MonkeyPatch) -> None:
    turns: list[tuple[float, float, float, float]] = []

    class Frame:
        def __setattr__(self, name: str, value: tuple[float, float, float, float]) -> None:
            assert name == "wxyz"
            turns.append(value)

    view: Any = object.__new__(scene_view.SceneView)
    view._session = SimpleNamespace(
        selected=Shown("Design 7", initial), options=SimpleNamespace(condition=1, spin=True)
    )
    view._nodes = {"/ship/propeller": Frame()}
    running = iter([True] * 4 + [False])
    view._spinning = SimpleNamespace(is_set=lambda: next(running))
    clock = iter(0.05 * step for step in range(20))
    monkeypatch.setattr(scene_view, "time", SimpleNamespace(monotonic=lambda: next(clock), sleep=lambda seconds: None))
    view._turn()
    assert len(turns) == 4
    angles = []
    for w, x, y, z in turns:
        assert y == z == 0.0 and math.hypot(w, x) == pytest.approx(1.0)
        angles.append(2.0 * math.atan2(x, w))
    # By growing angles about +x, a quarter as fast as the second condition's rate: as the blades are shaped to go.
    step = 2.0 * math.pi * initial.conditions[1].rotation_rate_rpm / 60.0 * 0.25 * 0.05
    assert np.diff(angles) == pytest.approx([step] * 3, rel=1e-9)
