"""How a design stands to each constraint, condition by condition: kept, on its limit, violated, or not asked at all.

"Feasible" is said of what a case asks. What it does not ask, at a condition or at a level, is said here with its
amount, so that nobody takes silence for safety.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hpsop_core.case.case import Case
from hpsop_core.case.constraints import CONSTRAINTS, Constraint, is_judged
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.evaluation.result import Evaluation, Ok

KEPT, LIMIT, VIOLATED, UNCOVERED = "kept", "limit", "violated", "uncovered"


@dataclass(frozen=True)
class Standing:
    """A design's standing to one constraint.

    Attributes:
        constraint: which.
        condition: index of the operating condition, or None where the constraint knows none.
        state: KEPT, LIMIT, VIOLATED or UNCOVERED.
        value: g, kept at or below zero; None where there is none.
        words: why it is not covered, and by how much it would be missed; "" otherwise.
    """

    constraint: Constraint
    condition: int | None
    state: str
    value: float | None = None
    words: str = ""


def standings(case: Case, evaluation: Evaluation) -> tuple[Standing, ...]:
    """A design's standing to every constraint that it could be held to, in the constraints' order.

    Args:
        case: what asks the constraints.
        evaluation: the design's; one that failed has no standing.
    """
    if not evaluation.ok:
        return ()
    design = evaluation
    by_condition: dict[str, Callable[[], list[Standing]]] = {
        "cavitation": lambda: _cavitation(case, design),
        "back_cavitation": lambda: _back_cavitation(case, design),
        "engine": lambda: _engine(design),
    }
    found: list[Standing] = []
    for item in CONSTRAINTS:
        own = by_condition.get(item.name)
        if own is not None:
            found += own()
        elif (value := evaluation.constraints.get(item.name)) is not None:
            found.append(Standing(item, None, _state(item, value), value))
        elif item.name == "metacentric_height":
            found.append(Standing(item, None, UNCOVERED, None, "the case states no centre of gravity (KG)"))
    return tuple(found)


def _named(name: str) -> Constraint:
    return next(item for item in CONSTRAINTS if item.name == name)


def _state(constraint: Constraint, value: float) -> str:
    if constraint.is_violated(value):
        return VIOLATED
    return LIMIT if constraint.is_active(value) else KEPT


def _cavitation(case: Case, evaluation: Ok) -> list[Standing]:
    item, limits = _named("cavitation"), case.constraints
    found = []
    for index, condition in enumerate(evaluation.conditions):
        value = condition.required_expanded_area_ratio - evaluation.propeller.expanded_area_ratio
        if evaluation.level >= limits.g3_level and is_judged(index, case):
            found.append(Standing(item, index, _state(item, value), value))
            continue
        why = "not asked at level 1" if evaluation.level < limits.g3_level else "not asked at this condition"
        amount = f", where {value:.3f} of blade area ratio is missing" if item.is_violated(value) else ", but kept"
        found.append(Standing(item, index, UNCOVERED, value, why + amount))
    return found


def _back_cavitation(case: Case, evaluation: Ok) -> list[Standing]:
    item, limit = _named("back_cavitation"), case.constraints.back_cavitation_limit
    if evaluation.level < TRUTH.number:
        return [Standing(item, None, UNCOVERED, None, "known at level 2 only")]
    found = []
    for index, condition in enumerate(evaluation.conditions):
        share = condition.blade_cavitating_share
        if share is None:
            found.append(Standing(item, index, UNCOVERED, None, "not computed"))
        elif limit is not None and is_judged(index, case):
            found.append(Standing(item, index, _state(item, share - limit), share - limit))
        else:
            why = "no limit is stated" if limit is None else "not asked at this condition"
            found.append(Standing(item, index, UNCOVERED, None, f"{why}; {100.0 * share:.0f} % of the back"))
    return found


def _engine(evaluation: Ok) -> list[Standing]:
    item = _named("engine")
    excesses: list[tuple[int, float]] = [
        (index, condition.engine_excess)
        for index, condition in enumerate(evaluation.conditions)
        if condition.engine_excess is not None
    ]
    if not excesses:
        return [Standing(item, None, UNCOVERED, None, "the case states no engine")]
    return [Standing(item, index, _state(item, value), value) for index, value in excesses]
