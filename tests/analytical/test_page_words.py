"""What the page says beside its pictures: speeds that all designs share, what lies beyond a front, what is covered."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from explorer.charts.pareto import beyond_fronts
from explorer.services.answers import Answers
from explorer.state.run_picture import GenerationPicture, RunPicture
from explorer.state.shown import Shown
from explorer.views.headline import headline_card, traffic_lights
from explorer.views.tables import warnings_html
from hpsop_core.case.case import KNOT, Case
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.propulsion import resistance_chart
from hpsop_core.evaluation.coverage import KEPT, LIMIT, UNCOVERED, VIOLATED, standings
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import conditions_of, quantities_of_case
from tests.two_speeds import stated_case


@pytest.fixture(scope="module")
def case() -> Case:
    """The recommended case with stated wave coefficients, so that level 1 needs no level 2."""
    return stated_case()


@pytest.fixture(scope="module")
def answers() -> Answers:
    return Answers()


@pytest.fixture(scope="module")
def longer(case: Case, answers: Answers) -> Evaluation:
    """A design longer than the initial one: at the same speeds it has smaller Froude numbers."""
    return answers.evaluate(case, dataclasses.replace(case.initial.variables, length_to_breadth=7.6), 1)


# ---- speeds ----------------------------------------------------------------------------------------------------------
def test_at_fixed_speeds_every_design_is_tabulated_at_the_same_ones(case: Case, answers: Answers, longer: Evaluation):
    initial = answers.initial(case, 1)
    first = np.array([point.speed for point in answers.curves(case, initial).points])
    second = np.array([point.speed for point in answers.curves(case, longer).points])
    # Froude numbers have six digits
    assert all(np.min(np.abs(first - speed)) < 2e-6 * speed * 10 for speed in second)
    assert len(second) > 10
    assert longer.conditions[0].froude_number < 0.97 * initial.conditions[0].froude_number
    for condition in longer.conditions:
        assert np.min(np.abs(second - condition.speed)) < 1e-9


def test_a_resistance_chart_in_knots_compares_at_the_same_speed(case: Case, answers: Answers, longer: Evaluation):
    initial = answers.initial(case, 1)
    designs = [
        (Look(name, role), answers.curves(case, item).points, item)
        for name, role, item in (("initial", "initial", initial), ("longer", "selected", longer))
    ]
    plot = resistance_chart(designs, "total", Sheet(480.0, 300.0), knots=True)
    svg = plot.svg("resistance")
    assert "speed V [kn]" in svg
    words = f"{initial.conditions[0].speed / KNOT:.4g} kn (Fn {longer.conditions[0].froude_number:.3f})"
    assert f"longer, {words}" in svg
    # the legend says whose Froude number is which
    assert f"(Fn {longer.conditions[0].froude_number:.3f}, {longer.conditions[1].froude_number:.3f})" in svg


# ---- fronts ----------------------------------------------------------------------------------------------------------
def _picture(
    case: Case,
    points: list[tuple[float, float]],
    cavitation: list[float],
    front: tuple[int, ...],
    predicted: tuple[int, ...] = (),
    by_hand: tuple[int, ...] = (),
) -> RunPicture:
    count = len(points)
    ids = np.arange(1, count + 1)
    return RunPicture(
        "run.hpsop",
        case,
        ids=ids,
        level=np.ones(count, dtype=np.int64),
        generation=np.ones(count, dtype=np.int64),
        objectives=np.array(points),
        feasible=np.full(count, True),
        failed=np.full(count, False),
        by_hand=np.isin(ids, by_hand),
        predicted=np.isin(ids, predicted),
        table=np.array(cavitation)[:, None],
        columns=("g_cavitation",),
        generations=(GenerationPicture(1, 1, front, front, 0.1),),
    )


def test_no_design_dominates_a_drawn_front_without_a_word(case: Case):
    points = [(0.9, 0.95), (0.95, 0.9), (0.89, 0.94), (0.94, 0.89), (0.88, 0.94), (0.99, 0.99)]
    said = beyond_fronts(_picture(case, points, [-1.0] * 6, (1, 2), predicted=(3, 6), by_hand=(4,)))
    assert said.count == 3
    assert said.most == pytest.approx(0.01)
    (reason,) = said.reasons
    for words in ("1 predicted by a learnt surface", "1 made by hand", "1 of a generation that is not finished"):
        assert words in reason
    assert said.margin == ("", "")


def test_who_is_better_than_a_front_is_found_in_a_crowd_as_by_asking_each(case: Case):
    chance = np.random.default_rng(3)
    points = np.round(chance.uniform(0.8, 1.0, (300, 2)), 2)
    order = np.lexsort((points[:, 1], points[:, 0]))
    # a front that is not quite one: some of its designs beat each other, and others stand on the same place
    front = tuple(int(row) + 1 for row in order[20:120:9])
    chosen = points[np.array(front) - 1]
    expected = sum(any((other >= point).all() and (other > point).any() for other in chosen) for point in points)
    said = beyond_fronts(_picture(case, [tuple(row) for row in points], [-1.0] * 300, front))
    assert 0 < expected < 300 and said.count == expected


def test_what_the_search_avoids_is_said_where_it_is_on_the_front(case: Case):
    margin = case.optimization.handover_margin
    points = [(0.9, 0.95), (0.95, 0.9), (0.9, 0.95), (0.91, 0.96)]
    said = beyond_fronts(_picture(case, points, [-2 * margin, -0.5 * margin, -1.0, -1.0], (1, 2)))
    # nothing lies beyond this front
    assert said.count == 0
    words, why = said.margin
    assert "1 of the 2 designs on level 1's front" in words and f"{margin:g} of blade area ratio" in why


# ---- what "feasible" covers ------------------------------------------------------------------------------------------
def test_a_condition_that_is_not_asked_is_uncovered(case: Case, answers: Answers):
    evaluation = answers.initial(case, 1)
    cavitation = [item for item in standings(case, evaluation) if item.constraint.name == "cavitation"]
    assert [item.state for item in cavitation] == [KEPT, UNCOVERED]
    missing = evaluation.conditions[1].required_expanded_area_ratio - evaluation.propeller.expanded_area_ratio
    assert cavitation[1].value == pytest.approx(missing)
    asked = case.replaced("constraints", cavitation_conditions="all")
    both = [item.state for item in standings(asked, evaluation) if item.constraint.name == "cavitation"]
    assert both[1] == (VIOLATED if missing > 0 else KEPT)
    names = conditions_of(evaluation)
    lights = traffic_lights(case, Shown("Initial design", evaluation, kind="initial"), names)
    assert f"{names[1]}" in lights and "does not cover" in lights and "the case states no engine" in lights


def test_the_states_agree_with_the_constraints_of_the_evaluation(case: Case, longer: Evaluation):
    found = standings(case, longer)
    for item in found:
        value = longer.constraints.get(item.constraint.name)
        if item.condition is None and item.state != UNCOVERED:
            assert item.value == value
            assert (item.state == VIOLATED) == item.constraint.is_violated(value)
    assert {item.state for item in found} <= {KEPT, LIMIT, VIOLATED, UNCOVERED}
    assert longer.feasible == all(item.state != VIOLATED for item in found)


def test_a_warning_names_its_condition_by_the_speed(longer: Evaluation):
    condition = longer.conditions[0]
    said = f"Froude number {condition.froude_number:g}: 7.7 cells on a transverse wave of 2 pi Fn^2 L = 0.193 L"
    told = warnings_html(Shown("Design 7", dataclasses.replace(longer, warnings=(said,)), 7))
    assert f"{condition.speed / KNOT:.4g} kn (Fn {condition.froude_number:.4g}): 7.7 cells" in told
    assert "Froude number" not in told


def test_a_number_of_a_condition_says_of_which(case: Case):
    by_key = {item.key: item for item in quantities_of_case(case)}
    for number, speed in enumerate(case.speeds, start=1):
        assert by_key[f"delivered_power_{number}"].place == f" at {speed / KNOT:.4g} kn"
    assert by_key["length"].place == by_key["f1"].place == ""


def test_the_headline_says_before_and_after_with_the_error(case: Case, answers: Answers, longer: Evaluation):
    initial = answers.initial(case, 1)
    card = headline_card(case, Shown("Initial design", initial, kind="initial"), Shown("Design 7", longer, 7))
    before, after = (1e-6 * item.conditions[0].delivered_power for item in (initial, longer))
    assert f"{before:.1f} → {after:.1f}" in card
    change = 100.0 * (after / before - 1.0)
    assert f"{abs(change):.1f} ± 2.0 %" in card
    assert "GM" in card and "not stated by the case" in card
    assert "powers of two speeds" not in card and "not calibrated" not in card
    # plain thin-ship theory says 599 MW of the paper's initial design, and level 2 132 MW
    plain = case.replaced("constants", wave_calibration="none")
    assert "level 1, not calibrated: powers compare designs" in headline_card(plain, None, Shown("Design 7", longer, 7))
    solved = dataclasses.replace(longer, level=2)
    assert "not calibrated" not in headline_card(plain, None, Shown("Design 7", solved, 7))
    # at fixed Froude numbers a longer ship sails faster, and its power is of that speed
    froude = case.replaced("conditions", speed="froude")
    first, second = answers.initial(froude, 1), answers.evaluate(froude, longer.variables, 1)
    card = headline_card(froude, Shown("Initial design", first, kind="initial"), Shown("Design 7", second, 7))
    speeds = [item.conditions[0].speed / KNOT for item in (first, second)]
    assert speeds[1] > 1.02 * speeds[0]
    assert "delivered power at Fn 0.22" in card
    assert f"powers of two speeds: {speeds[0]:.1f} → {speeds[1]:.1f} kn at Fn 0.22" in card
