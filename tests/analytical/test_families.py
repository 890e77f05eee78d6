"""Families of designs that cannot be told apart, bounds that are stood on, and what page and report say of them."""

from __future__ import annotations

import dataclasses
import re
from unittest.mock import Mock

import numpy as np
import pytest

from explorer.charts.pareto import ParetoOptions, automatic_limits, newest_families, pareto_background, pareto_chart
from explorer.state.draft import Draft
from explorer.state.run_picture import RUNNING, GenerationPicture, RunPicture
from explorer.state.shown import Shown
from explorer.views.tables import warnings_html
from explorer.views.whatif_view import WhatIfView
from hpsop_core import evaluate, load_case
from hpsop_core.charts.engine import engine_chart
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.errors import InputError
from hpsop_core.evaluation.result import Failed
from hpsop_core.evaluation.ship import engine_of
from hpsop_core.machinery.engine import Engine
from hpsop_core.optimization.families import STATED_ERRORS, families, half_widths, narrow
from hpsop_core.quantities import standing_on
from tests.two_speeds import TWO_SPEEDS

FRONT = np.array([[0.90, 1.00], [0.904, 0.998], [0.907, 0.996], [0.95, 0.95], [1.00, 0.90], [1.003, 0.897]])
CASE = load_case(TWO_SPEEDS)


def test_a_family_is_what_the_leader_cannot_be_told_from() -> None:
    widths = np.full((6, 2), 0.005)
    # 0.907 is within the error of 0.904 but not of the leader 0.90: families do not chain.
    assert families(FRONT, widths).tolist() == [1, 1, 2, 3, 4, 4]
    assert families(FRONT, np.full((6, 2), 1e-6)).tolist() == [1, 2, 3, 4, 5, 6]
    assert families(FRONT, np.full((6, 2), 1.0)).tolist() == [1] * 6
    # Both objectives must agree: near in f1 alone is no family.
    assert families(np.array([[1.0, 1.0], [1.001, 0.5]]), np.full((2, 2), 0.005)).tolist() == [1, 2]


def test_families_do_not_depend_on_the_order_of_the_designs() -> None:
    order = [3, 0, 5, 2, 4, 1]
    widths = np.full((6, 2), 0.005)
    assert families(FRONT[order], widths).tolist() == families(FRONT, widths)[order].tolist()


def test_an_evaluations_own_errors_come_before_the_stated_ones() -> None:
    widths = half_widths([1, 2], np.array([[1.0, 0.5], [2.0, 1.0]]), [{}, {"f1": 0.0625}])
    assert widths == pytest.approx(
        np.array([[STATED_ERRORS[1], 0.5 * STATED_ERRORS[1]], [0.125, STATED_ERRORS[2]]]), rel=1e-12
    )


def test_a_front_narrower_than_its_error_is_said() -> None:
    points = np.array([[1.0, 1.0], [1.009, 0.996]])
    sentence = narrow(points, np.full((2, 2), 0.02))
    assert "0.9 %" in sentence and "0.4 %" in sentence and "one answer" in sentence
    assert "decides nothing" in narrow(points, np.array([[0.02, 0.001]] * 2))
    assert narrow(points, np.full((2, 2), 0.001)) == ""
    assert narrow(points[:1], np.full((1, 2), 0.02)) == ""


def picture(points: np.ndarray) -> RunPicture:
    count = len(points)
    ids = np.arange(1, count + 1)
    return RunPicture(
        "a.hpsop",
        CASE,
        ids=ids,
        level=np.full(count, 2),
        generation=np.ones(count, dtype=np.int64),
        objectives=points,
        feasible=np.ones(count, dtype=bool),
        failed=np.zeros(count, dtype=bool),
        by_hand=np.zeros(count, dtype=bool),
        table=np.zeros((count, 0)),
        generations=(GenerationPicture(1, 2, tuple(ids), tuple(ids), 0.1),),
    )


def test_the_pareto_chart_has_one_mark_with_a_count_for_a_family() -> None:
    run = picture(FRONT)
    rows, names, sentence = newest_families(run)
    assert names == (1, 1, 2, 3, 4, 4) and len(rows) == 6 and sentence == ""
    svg = pareto_background(run, ParetoOptions(), ("f1", "f2"), 500.0, 300.0).svg("pareto")
    assert len(re.findall(r"×2<", svg)) == 2
    apart = pareto_background(picture(FRONT[[0, 3, 4]]), ParetoOptions(), ("f1", "f2"), 500.0, 300.0).svg("pareto")
    assert "×" not in apart
    assert "one answer" in newest_families(picture(FRONT[:2]))[2]


def test_a_run_that_has_only_its_initial_design_says_that_the_first_are_being_evaluated() -> None:
    begun = dataclasses.replace(picture(np.array([[1.0, 1.0]])), generations=(), status=RUNNING)
    assert automatic_limits(begun, ParetoOptions()) == ((0.9, 1.05), (0.9, 1.05))
    background = pareto_background(begun, ParetoOptions(), ("f1", "f2"), 500.0, 300.0)
    assert "being evaluated" in pareto_chart(begun, background, []).svg("pareto")
    more = dataclasses.replace(picture(FRONT[:2]), generations=(), status=RUNNING)
    background = pareto_background(more, ParetoOptions(), ("f1", "f2"), 500.0, 300.0)
    assert "being evaluated" not in pareto_chart(more, background, []).svg("pareto")


def test_the_pareto_charts_families_are_those_of_the_designs_own_errors() -> None:
    # As the report and `show` have them: three of the six were solved on a finer mesh.
    own = {1: {"f1": 1e-4, "f2": 1e-4}, 2: {"f1": 1e-4, "f2": 1e-4}, 5: {"f1": 0.02, "f2": 0.02}}
    run = dataclasses.replace(picture(FRONT), comparison=own)
    widths = half_widths([2] * 6, FRONT, [own.get(number, {}) for number in range(1, 7)])
    assert newest_families(run)[1] == tuple(families(FRONT, widths)) != newest_families(picture(FRONT))[1]


def test_what_a_design_stands_on_is_said_in_words_and_on_the_page() -> None:
    design = CASE.initial.variables.replaced({"diameter": 9.5, "blade_count": 5})
    result = evaluate(CASE.replaced("constraints", diameter_to_draft_upper=9.5 / 14.5 + 0.004), design)
    assert result.ok
    lines = standing_on(result)
    assert "D on its upper bound" in lines and "d on its upper bound" in lines
    assert any(line.startswith("diameter / draft") and line.endswith("at its limit") for line in lines)
    assert not any("form" in line for line in lines), "a form that is not clipped stands on no limit"
    html = warnings_html(Shown("whatif", result))
    assert "Stands on: " in html and "D on its upper bound" in html
    free = CASE.initial.variables.replaced({"draft": 14.25, "blade_count": 5})
    inside = evaluate(CASE, free)
    assert inside.ok and not inside.active_bounds


def test_a_bound_is_widened_by_a_quarter_of_its_range_in_whole_steps() -> None:
    draft = Draft(CASE)
    draft.widen("length_to_breadth", "upper")
    assert draft.value("bounds", "length_to_breadth") == pytest.approx((6.5, 9.0))
    draft.widen("draft", "lower")
    assert draft.value("bounds", "draft") == pytest.approx((13.87, 14.5))
    draft.widen("blade_count", "lower")
    assert draft.value("bounds", "blade_count") == (2, 7)
    draft.widen("blade_count", "lower")
    assert draft.value("bounds", "blade_count") == (2, 7), "no propeller has one blade"
    assert draft.case().bounds.as_dict()["length_to_breadth"] == pytest.approx((6.5, 9.0))


def test_several_sections_are_judged_together() -> None:
    engine = {"maximum_continuous_rating": 2e8, "load_fractions": [0.5], "specific_fuel_consumptions": [170.0]}
    changed = CASE.changed({"objectives": {"first": "fuel"}, "engine": engine})
    assert changed.objectives.first == "fuel"
    with pytest.raises(InputError, match="engine"):
        CASE.changed({"objectives": {"first": "fuel"}})


def test_the_engine_diagram_draws_the_layout_and_the_points() -> None:
    case = CASE.changed(
        {
            "conditions": {"froude_numbers": [0.17, 0.22], "weights": [0.5, 0.5]},
            "engine": {"maximum_continuous_rating": 5.0e7, "rated_rotation_rate_rpm": 95.0},
        }
    )
    result = evaluate(case)
    assert result.ok
    engine = engine_of(case.engine)
    assert engine == Engine(5.0e7, 95.0 / 60.0)
    plot = engine_chart(engine, [(Look("initial", "initial"), result)], Sheet(500.0, 300.0))
    numbers = plot.csv()
    for condition in result.conditions:
        assert f"{condition.rotation_rate_rpm:.4g}"[:4] in numbers
    svg = plot.svg("engine")
    outside = [condition for condition in result.conditions if condition.engine_excess > 0.0]
    assert len(outside) == 1 and svg.count("outside the layout") == 1
    assert "50.00 MW at 95.0 rpm" in svg
    assert "rating" not in engine_chart(None, [(Look("initial", "initial"), result)], Sheet(500.0, 300.0)).svg("engine")


def _slider(label: str, low: float, high: float, step: float, value: float, hint: str) -> Mock:
    return Mock(label=label, min=low, max=high, step=step, value=value, hint=hint)


def test_a_what_if_slider_says_that_its_design_stands_on_a_bound() -> None:
    evaluation = evaluate(CASE)
    assert evaluation.ok
    on = {"draft": "upper", "diameter": "lower"}
    session = Mock(selected=Shown("whatif", dataclasses.replace(evaluation, active_bounds=on)))
    session.picture.case = CASE
    gui = Mock(add_slider=_slider)
    view = WhatIfView(session, Mock(), gui)
    labels = {key: slider.label for key, slider in view._sliders.items()}
    assert labels["draft"] == "d [m] ↑" and labels["diameter"] == "D [m] ↓" and labels["length_to_breadth"] == "L/B"
    assert "this design stands on its upper bound" in view._sliders["draft"].hint
    # The mark goes when the design leaves the bound.
    session.selected = Shown("whatif", dataclasses.replace(evaluation, active_bounds={}))
    view._follow()
    assert view._sliders["draft"].label == "d [m]" and "bound" not in view._sliders["draft"].hint


def test_a_what_if_slider_moves_what_the_case_searches() -> None:
    case = CASE.with_bounds({"block_coefficient_ratio": (0.9, 1.1)})
    evaluation = evaluate(case)
    assert evaluation.ok
    session = Mock(selected=Shown("whatif", evaluation))
    session.picture.case = case
    view = WhatIfView(session, Mock(), Mock(add_slider=_slider))
    fullness, length = view._sliders["displacement_ratio"], view._sliders["length_to_breadth"]
    assert (fullness.label, fullness.value) == ("CB/CB₀", 1.0)
    length.value, fullness.value = 1.04 * case.initial.variables.length_to_breadth, 1.02
    moved = view._variables()
    assert moved.displacement_ratio == pytest.approx(1.04 * 1.02)
    assert moved.block_coefficient_ratio(case.initial.variables) == pytest.approx(1.02)
    # another run is opened that searches the displacement: the slider is that one's again
    session.picture.case, session.selected = CASE, Shown("whatif", evaluate(CASE, moved))
    view._follow()
    assert (fullness.label, fullness.value) == ("∇/∇₀ ↑", 1.061)


def test_a_what_if_slider_shows_digits_that_mean_something_and_keeps_the_design_s_own_number() -> None:
    own = dataclasses.replace(CASE.initial.variables, pitch_ratio=0.9999999, draft=14.123456789)
    evaluation = evaluate(CASE, own)
    assert evaluation.ok
    session = Mock(selected=Shown("whatif", evaluation))
    session.picture.case = CASE
    view = WhatIfView(session, Mock(), Mock(add_slider=_slider))
    assert (view._sliders["pitch_ratio"].value, view._sliders["draft"].value) == (1.0, 14.12)
    assert view._variables() == own
    view._sliders["draft"].value = 14.2
    assert view._variables() == dataclasses.replace(own, draft=14.2)


def test_the_what_if_shows_the_shift_of_lcb_in_percent_as_bounds_and_tables_do() -> None:
    own = dataclasses.replace(CASE.initial.variables, buoyancy_centre_shift=-0.0121)
    evaluation = evaluate(CASE, own)
    assert evaluation.ok
    session = Mock(selected=Shown("whatif", evaluation))
    session.picture.case = CASE
    view = WhatIfView(session, Mock(), Mock(add_slider=_slider))
    slider = view._sliders["buoyancy_centre_shift"]
    assert (slider.min, slider.max, slider.step, slider.value) == (-2.5, 2.5, 0.05, -1.21)
    assert slider.label.startswith("ΔLCB/L [%]") and "here in %" in slider.hint
    assert view._variables() == own
    slider.value = 0.55
    assert view._variables() == dataclasses.replace(own, buoyancy_centre_shift=0.0055)


def test_a_failed_design_stands_on_nothing() -> None:
    result = evaluate(CASE)
    assert result.ok
    failed = Failed("case", 1, result.variables, "hull", "no form")
    assert standing_on(failed) == [] and failed.as_dict()["active_bounds"] == {}
