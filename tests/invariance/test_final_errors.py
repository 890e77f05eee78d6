"""Errors of final designs: what a finer mesh changes, found again by hand from the solver itself."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from hpsop_core.case.case import load_case
from hpsop_core.evaluation.errors import evaluate_with_errors
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Ok
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.rankine.solver import solve
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.refinement import refine_front
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)


@pytest.fixture(scope="module")
def design() -> Ok:
    variables = CASE.initial.variables.replaced({"length_to_breadth": 7.3})
    result = evaluate_with_errors(CASE, variables, 2, reference_for(CASE, 2))
    assert isinstance(result, Ok)
    return result


def test_they_are_what_the_finer_mesh_changes(design: Ok) -> None:
    constants, totals = CASE.constants, []
    for variables in (design.variables, CASE.initial.variables):
        hull = design_hull(CASE, variables)
        speeds = [froude * math.sqrt(constants.gravity * 355.0) for froude in CASE.froude_numbers]
        froude_numbers = [speed / math.sqrt(constants.gravity * hull.length) for speed in speeds]
        finer = solve(hull, froude_numbers, RankineSettings().refined(1.25))
        for speed, condition in zip(speeds, finer.conditions, strict=True):
            dynamic = 0.5 * constants.density * speed**2 * hull.hydrostatics.wetted_surface
            friction = 0.075 / (math.log10(speed * hull.length / constants.viscosity) - 2.0) ** 2
            totals.append(dynamic * (friction * (1.0 + constants.form_factor) + condition.wave_coefficient))
            if variables is design.variables:
                place = len(totals)
                own = design.conditions[place - 1]
                moved = abs(condition.wave_coefficient - own.wave_coefficient)
                apart = abs(condition.wave_coefficient_pressure - condition.wave_coefficient)
                # 1/(1 - 1.25^-2), and half of what plane and pressure differ by over the coefficient that is reported.
                mesh, plane = moved / 0.36, 0.5 * apart * own.wave_coefficient / condition.wave_coefficient
                expected = math.hypot(mesh, plane)
                assert design.errors[f"wave_coefficient_{place}"] == pytest.approx(expected, rel=1e-6)
                assert design.errors[f"total_resistance_{place}"] == pytest.approx(expected * dynamic, rel=1e-6)
    ratio = sum(w * new / old for w, new, old in zip(CASE.conditions.weights, totals[:2], totals[2:], strict=True))
    assert design.errors["f1"] == pytest.approx(1.5 * abs(ratio - design.objectives["f1"]), rel=1e-4)


def test_a_ratio_is_surer_than_a_resistance(design: Ok) -> None:
    relative = design.errors["total_resistance_1"] / design.conditions[0].total_resistance
    assert design.errors["f1"] < relative
    assert set(design.errors) >= {"f1", "f2", "delivered_power_1", "delivered_power_2"}


def test_level_1_has_none() -> None:
    with pytest.raises(ValueError, match="level 2 only"):
        evaluate_with_errors(CASE, CASE.initial.variables, 1, None)


def test_a_run_states_them_at_its_end_or_afterwards(tmp_path: Path) -> None:
    plan = {"population": 6, "generations": 2, "level1_generations": 1}
    asked = optimize(CASE.replaced("optimization", **plan, final_errors=True), tmp_path / "asked.hpsop", workers=2)
    records = (*asked.front(), asked.initial(2))
    assert len(records) > 1 and all({"f1", "f2"} <= set(record.evaluation.errors) for record in records)
    # The initial design is the measure itself: only the mesh's unevenness is left of its ratios.
    assert asked.initial(2).evaluation.errors["f1"] == pytest.approx(2e-4)
    path = tmp_path / "afterwards.hpsop"
    plain = optimize(CASE.replaced("optimization", **plan), path, workers=2)
    assert not any(record.evaluation.errors for record in plain.front())
    assert refine_front(path, lambda done, wanted: None) == len({record.id for record in records})
    assert refine_front(path, lambda done, wanted: None) == 0
    again = open_run(path)
    for one, two in zip((*again.front(), again.initial(2)), records, strict=True):
        assert one.evaluation.errors == two.evaluation.errors
