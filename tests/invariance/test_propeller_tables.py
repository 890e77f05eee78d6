"""Level 1's propellers from a table: the lifting line's numbers where one stands, and none where it would not be so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hpsop_core.case.case import Case, load_case
from hpsop_core.errors import InputError
from hpsop_core.evaluation import propeller_tables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.propeller_answer import PropellerAnswer, propeller_answer, propeller_variables
from hpsop_core.evaluation.propeller_tables import TOLERANCE, PropellerTables, tables_for
from hpsop_core.evaluation.reference import reference_for, searching
from hpsop_core.evaluation.result import Ok
from hpsop_core.optimization.sampling import latin_hypercube


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("dtc-p4119")


@pytest.fixture(scope="module")
def tables(case: Case) -> PropellerTables:
    found = tables_for(case)
    assert found is not None
    return found


def numbers(answer: PropellerAnswer) -> Any:
    return np.array([answer.curve.thrust_coefficient, answer.curve.torque_coefficient])


def test_curves_are_the_lifting_lines_all_over_the_case(case: Case, tables: PropellerTables) -> None:
    for vector in latin_hypercube(case.bounds, 24, 3):
        key = propeller_variables(case.propeller, case.bounds.decode(vector))
        told, solved = tables.answer(key), propeller_answer(key, 1, tables.drag)
        assert told is not None
        size = np.sqrt(np.mean(numbers(solved) ** 2, axis=1, keepdims=True))
        assert np.max(np.abs(numbers(told) - numbers(solved)) / size) < TOLERANCE


def test_a_design_of_the_search_says_whence_its_curve_is(case: Case) -> None:
    plain = reference_for(case, 1)
    design = case.bounds.decode(latin_hypercube(case.bounds, 1, 5)[0])
    told, solved = evaluate(case, design, 1, searching(case, plain)), evaluate(case, design, 1, plain)
    assert isinstance(told, Ok) and isinstance(solved, Ok)
    assert told.propeller_tabulated and not solved.propeller_tabulated and not told.predicted
    assert told.objectives["f1"] == pytest.approx(solved.objectives["f1"], rel=TOLERANCE)
    assert told.objectives["f1"] != solved.objectives["f1"]


def test_beyond_its_bounds_a_table_says_nothing(case: Case, tables: PropellerTables) -> None:
    inside = case.initial.variables
    for change in ({"blade_count": 7}, {"pitch_ratio": 1.16}, {"diameter": 8.7}, {"expanded_area_ratio": 0.84}):
        assert tables.answer(propeller_variables(case.propeller, inside.replaced(change))) is None


def test_who_searches_little_or_at_level_1_alone_solves(case: Case) -> None:
    assert tables_for(case.replaced("optimization", surface=False)) is None
    assert tables_for(case.replaced("optimization", population=8, generations=6, level1_generations=4)) is None
    assert tables_for(case.replaced("optimization", level1_generations=150)) is None


def wavy(tables: PropellerTables, blade_count: int, place: tuple[float, ...]) -> Any:
    """A family whose thrust no polynomial of these degrees follows; it cannot be computed for 6 blades."""
    if blade_count == 6:
        raise InputError("no such propeller")
    return np.concatenate([np.full(7, 0.3 + 0.01 * np.sin(90.0 * place[0] * (blade_count == 4))), np.full(7, 0.03)])


def test_no_table_stands_that_is_not_within_its_tolerance(
    tables: PropellerTables, case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(propeller_tables, "_solved", wavy)
    propeller_tables._table.cache_clear()
    try:
        designs = {count: case.initial.variables.replaced({"blade_count": count}) for count in (4, 5, 6)}
        told = {n: tables.answer(propeller_variables(case.propeller, design)) for n, design in designs.items()}
    finally:
        propeller_tables._table.cache_clear()
    assert told[4] is None and told[6] is None
    assert told[5] is not None and numbers(told[5]) == pytest.approx(wavy(tables, 5, (1.0,)).reshape(2, 7))


def test_a_variable_that_is_fixed_needs_one_node(case: Case) -> None:
    fixed = case.with_bounds({"diameter": (9.2, 9.2), "blade_count": (5, 5), "expanded_area_ratio": (1.0, 1.0)})
    tables = tables_for(fixed)
    assert tables is not None
    key = propeller_variables(case.propeller, case.initial.variables.replaced({"expanded_area_ratio": 1.0}))
    table, told = propeller_tables._table(tables, 5), tables.answer(key)
    assert table is not None and table.series.shape[:3] == (5, 1, 1)
    assert told is not None and numbers(told) == pytest.approx(numbers(propeller_answer(key, 1, tables.drag)), rel=1e-4)
