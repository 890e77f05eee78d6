"""Objectives and constraints against their definitions, and the worked example of the docs."""

from __future__ import annotations

import contextlib
import dataclasses
import html
import io
import math
import re
from pathlib import Path
from typing import Any

import pytest

from hpsop_core import evaluate, load_case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.fields import rules
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.case.sections import ObjectivesSection
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import all_quantities, condition_names, objective_title, violated
from hpsop_core.report.words import assumptions, objective_lines

DOCS = Path(__file__).resolve().parents[2] / "docs"
CASE = load_case("dtc-p4119-paper")
# What every objective needs: an engine that burns, and weights.
SHIP = CASE.changed({
    "engine": {"maximum_continuous_rating": 2e8, "load_fractions": [0.5], "specific_fuel_consumptions": [170.0]},
    "loading": {"centre_of_gravity_height": 20.0, "lightship_mass": 5e7},
})  # fmt: skip
OTHER = CASE.initial.variables.replaced({"diameter": 9.4, "draft": 14.0, "pitch_ratio": 1.05})


@pytest.fixture(scope="module")
def reference() -> Reference:
    return reference_for(CASE, 1)


@pytest.fixture(scope="module")
def initial(reference: Reference) -> Evaluation:
    return evaluate(CASE, None, 1, reference)


@pytest.fixture(scope="module")
def other(reference: Reference) -> Evaluation:
    return evaluate(CASE, OTHER, 1, reference)


def weighted(initial: Evaluation, other: Evaluation, name: str) -> float:
    pairs = zip(initial.conditions, other.conditions, strict=True)
    return math.fsum(b.weight * getattr(b, name) / getattr(a, name) for a, b in pairs)


def test_objectives_are_what_they_say(initial: Evaluation, other: Evaluation) -> None:
    assert initial.ok and other.ok
    values = other.all_objectives
    assert values["resistance"] == pytest.approx(weighted(initial, other, "total_resistance"), rel=1e-12)
    assert values["delivered_power"] == pytest.approx(weighted(initial, other, "delivered_power"), rel=1e-12)
    inverse = [a.weight * a.open_water_efficiency / b.open_water_efficiency
               for a, b in zip(initial.conditions, other.conditions, strict=True)]  # fmt: skip
    assert values["efficiency"] == pytest.approx(math.fsum(inverse), rel=1e-12)
    assert initial.hull.booked_volume is not None and other.hull.booked_volume is not None
    assert values["displacement"] == pytest.approx(initial.hull.booked_volume / other.hull.booked_volume, rel=1e-12)
    required, area = other.conditions[0].required_expanded_area_ratio, other.propeller.expanded_area_ratio
    assert values["cavitation_margin"] == pytest.approx(required / area, rel=1e-12)


def test_constraints_are_what_they_say(initial: Evaluation, other: Evaluation) -> None:
    assert initial.ok and other.ok and initial.hull.booked_volume and other.hull.booked_volume
    g, limits = other.constraints, CASE.constraints
    change = abs(other.hull.booked_volume / initial.hull.booked_volume - 1.0)
    assert g["displacement"] == pytest.approx(change - limits.displacement_tolerance, abs=1e-12)
    ratio = 9.4 / 14.0
    sides = (limits.diameter_to_draft_lower - ratio, ratio - limits.diameter_to_draft_upper)
    assert g["diameter_to_draft"] == pytest.approx(max(sides), abs=1e-12)
    assert g["cavitation"] is None, "the paper's case applies it at level 2 only"
    kept = evaluate(CASE.replaced("constraints", g3_level=1), OTHER, 1)
    assert kept.ok
    required, area = kept.conditions[0].required_expanded_area_ratio, kept.propeller.expanded_area_ratio
    assert kept.constraints["cavitation"] == pytest.approx(required - area, abs=1e-12)
    block = other.hull.booked_block_coefficient or 0.0
    assert g["form"] == pytest.approx(
        max(limits.booked_block_coefficient_lower - block, block - limits.booked_block_coefficient_upper), abs=1e-12
    )
    # P4119 has no rake, so its tips turn in the plane of the shaft's height.
    above_baseline = other.propeller.shaft_height - 0.5 * 9.4
    assert 0.0 < above_baseline < other.propeller.tip_clearance
    assert g["propeller_clearance"] == pytest.approx(-above_baseline / 9.4, abs=1e-12)


def test_the_worked_example_of_the_docs_runs() -> None:
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "adding-an-objective.md").read_text(encoding="utf-8"), re.S)
    assert len(blocks) == 3
    names: dict[str, Any] = {}
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        for block in blocks:
            exec(compile(block, "docs/adding-an-objective.md", "exec"), names)
    result, case = names["result"], names["case"]
    start = evaluate(case)
    assert result.ok and start.ok and result.hull.length > 360.0
    assert result.all_objectives["torque"] == pytest.approx(weighted(start, result, "torque"), rel=1e-12)
    assert result.constraints["berth"] == pytest.approx(result.hull.length / 360.0 - 1.0, abs=1e-12)
    assert not result.feasible and "False" in printed.getvalue()
    without = evaluate(case, names["longer"])
    assert without.ok and set(result.constraints) - set(without.constraints) == {"berth"}


def test_every_declaration_is_chosen_shown_and_explained(other: Evaluation) -> None:
    names = tuple(objective.name for objective in OBJECTIVES)
    assert rules(ObjectivesSection)["first"].choices == rules(ObjectivesSection)["second"].choices == names
    reference = (DOCS / "case.md").read_text(encoding="utf-8")
    for objective in OBJECTIVES:
        assert objective.title in objective_title(objective.name, "f")
        chosen = dataclasses.replace(CASE.objectives, first=objective.name,
                                     second=next(name for name in names if name != objective.name))  # fmt: skip
        lines = objective_lines(dataclasses.replace(SHIP, objectives=chosen))
        assert objective.words in html.unescape(lines[0])
        assert f"| {objective.name} |" in reference and objective.words in reference
    shown = {quantity.label: quantity for quantity in all_quantities(condition_names(CASE))}
    spoken = html.unescape(assumptions(CASE))
    for constraint in CONSTRAINTS:
        assert shown[constraint.label].value(other) == other.constraints[constraint.name]
        assert constraint.asked(CASE) in spoken
        assert f"| {constraint.name} |" in reference and constraint.meaning in reference


def test_the_report_says_what_scale_the_lost_camber_is_of() -> None:
    scaled = CASE.replaced("constants", camber_scaling="reynolds")
    words = "in proportion to the friction"
    assert words in html.unescape(assumptions(scaled)) and words not in html.unescape(assumptions(CASE))


def test_what_is_violated_is_said_with_its_amount(other: Evaluation) -> None:
    assert other.ok
    broken = dataclasses.replace(other, constraints={**dict.fromkeys(other.constraints), "propeller_clearance": 0.25})
    assert violated(broken) == ["the propeller would cut the hull (g₅) by 0.2500"]
    assert violated(dataclasses.replace(other, constraints={"form": 1e-7, "displacement": None})) == []


def test_an_objective_whose_numbers_are_missing_fails_with_a_reason(reference: Reference) -> None:
    case = CASE.replaced("objectives", first="delivered_power")
    conditions = {name: values for name, values in reference.initial.conditions.items() if name != "delivered_power"}
    old = dataclasses.replace(reference, initial=dataclasses.replace(reference.initial, conditions=conditions))
    result = evaluate(case, OTHER, 1, old)
    assert not result.ok and result.stage == "objectives" and "delivered_power" in result.reason
    unasked = evaluate(CASE, OTHER, 1, old)
    assert unasked.ok and "delivered_power" not in unasked.all_objectives


def test_a_reference_comes_back_to_the_bit_and_one_of_schema_2_still_normalises(reference: Reference) -> None:
    data = reference.as_dict()
    assert Reference.from_dict(data) == reference
    assert set(reference.initial.conditions) <= {item.name for item in dataclasses.fields(ConditionResult)}
    columns = data.pop("conditions")
    del data["hull"]
    old = {**data, "total_resistance": columns["total_resistance"], "efficiency": columns["open_water_efficiency"],
           "delivered_power": columns["delivered_power"]}  # fmt: skip
    first, second = (evaluate(CASE, OTHER, 1, item) for item in (reference, Reference.from_dict(old)))
    assert first.ok and second.ok
    assert dataclasses.replace(first, elapsed=0.0) == dataclasses.replace(second, elapsed=0.0)
