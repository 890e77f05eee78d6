"""Power over speed against the conditions' own equilibria and the definition of the powers."""

from __future__ import annotations

import csv
import dataclasses
import io
from itertools import pairwise

import numpy as np
import pytest

from hpsop_core.case.case import KNOT, Case, load_case
from hpsop_core.charts.engine import engine_chart
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.powering import power_chart
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation import curves as speed_curves
from hpsop_core.evaluation.curves import resistance_points
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.hull_answer import HullVariables, WaveAnswer, wave_answers
from hpsop_core.evaluation.power_curves import PowerCurves, power_curves
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Ok
from hpsop_core.machinery.engine import Engine
from tests.two_speeds import TWO_SPEEDS

SHEET = Sheet(480.0, 300.0)
MARGIN = 0.15


@pytest.fixture(scope="module")
def case() -> Case:
    """Stated wave coefficients, so that level 1 needs no level 2; a sea margin and a shaft that takes its part."""
    return load_case(TWO_SPEEDS).replaced(
        "constants",
        wave_calibration="stated",
        stated_wave_coefficients=(2.8e-4, 6.6e-4),
        sea_margin=MARGIN,
        shaft_efficiency=0.98,
    )


@pytest.fixture(scope="module")
def designs(case: Case) -> list[tuple[Look, PowerCurves, Ok]]:
    reference = reference_for(case, 1)
    slender = dataclasses.replace(case.initial.variables, length_to_breadth=7.6)
    made = []
    for look, variables in (
        (Look("initial", "initial"), case.initial.variables),
        (Look("slender", "selected"), slender),
    ):
        evaluation = evaluate(case, variables, 1, reference)
        assert isinstance(evaluation, Ok)
        points = resistance_points(case, evaluation, reference, step=0.02)
        made.append((look, power_curves(case, evaluation, points), evaluation))
    return made


def test_every_condition_lies_on_its_design_s_curves(designs: list[tuple[Look, PowerCurves, Ok]]):
    for _, curves, evaluation in designs:
        for condition in evaluation.conditions:
            at = int(np.argmin(np.abs(curves.speed - condition.speed)))
            assert curves.speed[at] == pytest.approx(condition.speed, rel=1e-9)
            # a spline through KT and KQ every 0.05 of J, against the solver's own polynomial
            assert curves.rotation_rate_rpm[at] == pytest.approx(condition.rotation_rate_rpm, rel=3e-4)
            assert curves.delivered[at] == pytest.approx(condition.delivered_power, rel=5e-4)
            assert curves.service[at] == pytest.approx(condition.brake_power, rel=5e-4)


def test_brake_power_is_delivered_power_over_the_shaft_and_service_takes_the_margin_more(
    designs: list[tuple[Look, PowerCurves, Ok]],
):
    for _, curves, _ in designs:
        assert np.allclose(curves.calm, curves.delivered / 0.98, rtol=1e-12)
        assert np.allclose(curves.service, (1.0 + MARGIN) * curves.calm, rtol=1e-12)
        # a ship that goes faster takes more power and more revolutions
        assert all(b > a for a, b in pairwise(curves.service))
        assert all(b > a for a, b in pairwise(curves.rotation_rate_rpm))


def test_a_speed_that_the_propeller_cannot_give_is_left_out(case: Case, designs: list[tuple[Look, PowerCurves, Ok]]):
    _, _, evaluation = designs[0]
    points = resistance_points(case, evaluation, reference_for(case, 1), step=0.05)
    heavy = [dataclasses.replace(point, total_resistance=1e3 * point.total_resistance) for point in points]
    assert np.isnan(power_curves(case, evaluation, heavy).service).all()


def test_slow_speeds_that_a_level_cannot_give_are_left_out_of_the_curve(
    case: Case, designs: list[tuple[Look, PowerCurves, Ok]], monkeypatch: pytest.MonkeyPatch
):
    """A tanker's condition at Fn 0.18 can be solved by level 2, its waves at 0.15 are too short for the grid."""
    _, _, evaluation = designs[0]
    reference = reference_for(case, 1)
    whole = resistance_points(case, evaluation, reference)
    conditions = [condition.froude_number for condition in evaluation.conditions]

    def none_beyond(low: float, high: float) -> None:
        def given(variables: HullVariables, level: int, numbers: tuple[float, ...]) -> tuple[WaveAnswer, ...]:
            if min(numbers) < low or max(numbers) > high:
                raise SolverFailure("rankine", "no waves")
            return wave_answers(variables, level, numbers)

        monkeypatch.setattr(speed_curves, "wave_answers", given)

    least = whole[2].froude_number
    assert least < min(conditions)
    none_beyond(least, 1.0)
    assert resistance_points(case, evaluation, reference) == whole[2:]
    # what is not slow is no matter of short waves: the failure is told
    none_beyond(0.0, max(conditions))
    with pytest.raises(SolverFailure, match="no waves"):
        resistance_points(case, evaluation, reference)


def test_the_chart_tells_powers_profile_and_gain(designs: list[tuple[Look, PowerCurves, Ok]]):
    rating = 1.2 * max(condition.brake_power for condition in designs[0][2].conditions)
    plot = power_chart(Engine(rating, 1.7), designs, MARGIN, SHEET)
    rows = list(csv.reader(io.StringIO(plot.csv())))[1:]
    for look, _, evaluation in designs:
        for number, condition in enumerate(evaluation.conditions, start=1):
            row = next(row for row in rows if row[0] == f"condition {number}, {look.name}")
            assert float(row[1]) == pytest.approx(condition.speed / KNOT, rel=1e-8)
            assert float(row[2]) == pytest.approx(1e-6 * condition.brake_power, rel=1e-8)
    assert {row[2] for row in rows if row[0] == "rating"} == {f"{1e-6 * rating:.9g}"}
    svg = str(plot.svg("power"))
    # two shades that stand for two things have each their own words and strength
    keys = {key.words: key.style for key in plot.keys if key.shape == "band"}
    assert keys == {"share of time": "fill-opacity:.35", "its sea margin": ""}
    assert 'class="key-band selected" style="fill-opacity:.35"' in svg
    weights = [condition.weight for condition in designs[1][2].conditions]
    for weight in weights:
        assert f"{100.0 * weight / sum(weights):.3g} %<" in svg
    for before, after in zip(designs[0][2].conditions, designs[1][2].conditions, strict=True):
        change = f"{100.0 * (after.brake_power / before.brake_power - 1.0):+.1f} %".replace("-", "−")
        assert change in svg


def test_the_engine_diagram_shows_the_propeller_s_demand(designs: list[tuple[Look, PowerCurves, Ok]]):
    shown = [(look, evaluation) for look, _, evaluation in designs]
    plot = engine_chart(None, shown, SHEET, [(look, curves) for look, curves, _ in designs])
    names = [series.name for series in plot.series]
    assert names == ["initial, service", "slender, service", "slender, calm water"]
    assert np.array_equal(plot.series[0].x, designs[0][1].rotation_rate_rpm)
    assert [series.name for series in engine_chart(None, shown, SHEET).series] == ["initial", "slender"]


def test_charts_without_designs_say_so():
    assert "computing" in str(power_chart(None, [], 0.0, SHEET).svg("power"))
