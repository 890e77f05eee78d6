"""Hull and propeller are evaluated and remembered separately; what is remembered changes no bit."""

from __future__ import annotations

from typing import Any

import pytest

from hpsop_core.case.case import load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation import hull_answer as resistance
from hpsop_core.evaluation import propeller_answer as propulsion
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import Reference, reference_for
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)
HULL = {"length_to_breadth": 7.3, "draft": 14.2, "displacement_ratio": 0.97}
PROPELLER = {"diameter": 9.2, "blade_count": 4, "pitch_ratio": 0.9}
MEMORIES = (
    resistance.build_hull,
    resistance.wave_answers,
    propulsion.build_propeller,
    propulsion.propeller_answer,
)


def forget() -> None:
    for memory in MEMORIES:
        memory.cache_clear()


def solved() -> tuple[int, int]:
    """(hulls, propellers) given to a solver since ``forget``."""
    return resistance.wave_answers.cache_info().misses, propulsion.propeller_answer.cache_info().misses


def result(variables: DesignVariables, level: int, reference: Reference) -> dict[str, Any]:
    data = evaluate(CASE, variables, level, reference).as_dict()
    assert data.pop("status") == "ok", data["reason"]
    del data["elapsed"]
    return data


@pytest.mark.parametrize("level", [1, 2])
def test_a_known_hull_or_propeller_is_not_solved_again_and_no_bit_changes(level: int) -> None:
    initial = CASE.initial.variables
    designs = {
        "one": initial.replaced({**HULL, **PROPELLER}),
        "same hull": initial.replaced({**HULL, **PROPELLER, "pitch_ratio": 1.1}),
        "same propeller": initial.replaced({**HULL, **PROPELLER, "length_to_breadth": 7.6}),
    }
    reference = reference_for(CASE, level)
    alone = {}
    for name, design in designs.items():
        forget()
        alone[name] = result(design, level, reference)
        assert solved() == (1, 1)
    # Every way round: what is remembered may come from any other design.
    for order in (("one", "same hull", "same propeller"), ("same propeller", "same hull", "one")):
        forget()
        for name in order:
            # repr of a float is exact and tells -0.0 from 0.0.
            assert repr(result(designs[name], level, reference)) == repr(alone[name]), f"{name} in {order}"
        assert solved() == (2, 2), "three designs of two hulls and two propellers"
    result(designs["one"], level, reference)
    assert solved() == (2, 2), "a known design is not solved at all"
