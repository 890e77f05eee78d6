"""Evaluations that cost nothing, and ones that go wrong on purpose. Module-level functions: workers import them."""

from __future__ import annotations

import hashlib
import os
import signal
import struct
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import HullResult, PropellerResult
from hpsop_core.case.variables import VARIABLE_NAMES, DesignVariables
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.result import Evaluation, Ok, OpenWaterCurve, evaluation_from_dict
from hpsop_core.runs.tasks import Physics

# Nobody looks at these.
HULL = HullResult(100.0, 15.0, 5.0, 0.7, 5250.0, 2000.0, 50.0)
PROPELLER = PropellerResult(3.0, 4, 1.0, 1.0, 0.6, 2.0, 1.0)


def evaluate(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """Two conflicting smooth objectives near 1 with a kept and a violated region; level 2 is shifted."""
    space = case.bounds
    shares = [
        (value - low) / (high - low) if high > low else 0.0
        for value, low, high in zip(variables.key(), space.lower, space.upper, strict=True)
    ]
    shift = 0.03 * (level - 1)
    first = 0.8 + 0.3 * shares[0] + 0.2 * sum((share - 0.4) ** 2 for share in shares[1:]) + shift
    second = 1.1 - 0.3 * shares[0] ** 0.5 * (1.0 if shares[0] >= 0.0 else 0.0) if shares[0] >= 0.0 else 1.2
    second += 0.2 * sum((share - 0.6) ** 2 for share in shares[1:]) + shift
    constraints = {"displacement": 0.2 - shares[1], "diameter_to_draft": -0.1, "cavitation": 0.1 - shares[2]}
    return Ok(
        case=case.name,
        level=level,
        variables=variables,
        hull=HULL,
        propeller=PROPELLER,
        conditions=(),
        objectives={"f1": first, "f2": second},
        all_objectives={},
        constraints=constraints,
        feasible=all(value <= 1e-6 for value in constraints.values()),
        warnings=(),
        open_water=OpenWaterCurve((), (), (), ()),
    )


def no_reference(case: Case, level: int) -> None:
    """Nothing to normalise with."""


def no_reference_from_dict(data: object) -> None:
    """Never called: there is none."""


def refused_reference(case: Case, level: int) -> None:
    """A case that cannot be: what a person stated is at fault."""
    raise InputError("engine: too small; state more")


def broken_reference(case: Case, level: int) -> None:
    """A defect of the program."""
    raise ZeroDivisionError("a defect")


def physics(function: object = evaluate) -> Physics:
    """A physics around one of this module's evaluations."""
    return Physics(function, no_reference, no_reference_from_dict)  # type: ignore[arg-type]


def learning_physics(function: object) -> Physics:
    """A physics that learns."""
    return Physics(function, no_reference, no_reference_from_dict, learn=learn)  # type: ignore[arg-type]


def refining_physics() -> Physics:
    """A physics that states errors."""
    return Physics(evaluate, no_reference, no_reference_from_dict, refine=refined)  # type: ignore[arg-type]


def marking(function: object, marks: Path) -> Physics:
    """A physics around an evaluation that leaves marks in a folder."""
    return physics(partial(function, marks=marks))  # type: ignore[call-overload]


def with_shape(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """The same with the true figures of hull and propeller."""
    from hpsop_core.evaluation.shapes import design_hull, design_propeller

    result = evaluate(case, variables, level, reference)
    assert result.ok
    hull, blades = design_hull(case, variables).hydrostatics, design_propeller(case, variables)
    return replace(
        result,
        hull=replace(HULL, displaced_volume=hull.displaced_volume, wetted_surface=hull.wetted_surface),
        propeller=replace(
            PROPELLER,
            pitch_diameter_ratio_07R=blades.pitch_diameter_ratio_07R,
            expanded_area_ratio=blades.expanded_area_ratio,
        ),
    )


def slow(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """The same after a while, so that a kill hits something."""
    time.sleep(0.02)
    return evaluate(case, variables, level, reference)


def slower(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """The same after a longer while."""
    time.sleep(0.3)
    return evaluate(case, variables, level, reference)


def is_initial(case: Case, variables: DesignVariables) -> bool:
    """The design that must not fail."""
    return variables == case.initial.variables


def lot(variables: DesignVariables, level: int) -> float:
    """A number in [0, 1) that looks random and depends on the design alone."""
    text = repr((level, [float(getattr(variables, name)) for name in VARIABLE_NAMES]))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:6], "big") / 2.0**48


def every_fault(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """5 % of the designs each: a solver's failure, an exception, a NaN, an infinity, a missing number, an exit."""
    number = lot(variables, level)
    result = evaluate(case, variables, level, reference)
    if is_initial(case, variables) or number >= 0.30:
        return result
    if number < 0.05:
        raise SolverFailure("rankine", "the linear system is singular")
    if number < 0.10:
        raise ZeroDivisionError("a solver's defect")
    values = dict(result.as_dict())
    if number < 0.15:
        values["objectives"] = {"f1": float("nan"), "f2": 1.0}
    elif number < 0.20:
        values["constraints"] = {**values["constraints"], "displacement": float("inf")}
    elif number < 0.25:
        values["objectives"] = {"f1": None, "f2": 1.0}
    else:
        raise SystemExit(3)
    return evaluation_from_dict(values)


def dying(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """5 % of the designs take their worker along, each time they are tried."""
    if not is_initial(case, variables) and lot(variables, level) < 0.05:
        os._exit(17)
    return evaluate(case, variables, level, reference)


def dying_once(case: Case, variables: DesignVariables, level: int, reference: object, marks: Path) -> Evaluation:
    """5 % of the designs have their worker killed by the system, the first time they are tried."""
    if not is_initial(case, variables) and lot(variables, level) < 0.05:
        mark = marks / f"{lot(variables, level):.12f}"
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return evaluate(case, variables, level, reference)


def hanging(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """4 % of the designs never come back."""
    if not is_initial(case, variables) and lot(variables, level) < 0.04:
        time.sleep(3600)
    return evaluate(case, variables, level, reference)


def failing_everywhere(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """Not even the initial design can be computed."""
    raise SolverFailure("hull", "no such form")


def counting(case: Case, variables: DesignVariables, level: int, reference: object, marks: Path) -> Evaluation:
    """Leaves one line for each time it is called: nothing finished may be computed again."""
    time.sleep(0.02)
    with open(marks / "calls", "a", encoding="utf-8") as stream:
        stream.write(f"{level} {[float(getattr(variables, name)) for name in VARIABLE_NAMES]!r}\n")
    return evaluate(case, variables, level, reference)


def hanging_once(case: Case, variables: DesignVariables, level: int, reference: object, marks: Path) -> Evaluation:
    """5 % of the designs hang the first time they are tried."""
    mark = marks / f"{lot(variables, level):.12f}"
    if not is_initial(case, variables) and lot(variables, level) < 0.05 and not mark.exists():
        mark.touch()
        time.sleep(3600)
    return evaluate(case, variables, level, reference)


def refined(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """The same with errors."""
    result = evaluate(case, variables, level, reference)
    assert result.ok and level == 2
    return replace(result, errors={"f1": 0.01}, comparison_errors={"f1": 0.01}, errors_source="solved")


_warm = False


def warm_up(case: Case, level: int, reference: object) -> None:
    """What compiling takes."""
    global _warm
    if not _warm:
        time.sleep(2.0)
        _warm = True


def cold_and_dying_once(
    case: Case, variables: DesignVariables, level: int, reference: object, marks: Path
) -> Evaluation:
    """Slow in a worker that was not warmed up; 5 % of the designs have their worker killed the first time."""
    warm_up(case, level, reference)
    return dying_once(case, variables, level, reference, marks)


def killed_reference(case: Case, level: int, marks: Path, times: int) -> None:
    """The system kills the worker that computes a reference, so many times a level."""
    made = len(list(marks.glob(f"{level}-*")))
    if made < times:
        (marks / f"{level}-{made}").touch()
        os.kill(os.getpid(), signal.SIGKILL)


def half_an_answer(mark: Path) -> None:
    """An answer of 20 kB of which only the length is ever sent: what a kill between a worker's two writes leaves."""
    frame = sys._getframe()
    while "result_queue" not in frame.f_locals:
        assert frame.f_back is not None
        frame = frame.f_back
    frame.f_locals["result_queue"]._writer._send(struct.pack("!i", 20_000))
    mark.touch()
    time.sleep(3600)


def never_present(seconds: float) -> int:
    """A worker that is still importing."""
    time.sleep(3600)
    return 0


@dataclass(frozen=True)
class Learnt:
    """What ``learning`` evaluations are told instead of a reference: a surface's error depends on all that it knows."""

    error: float


def surface_case(case: Case) -> Case:
    """The case with a surface that is soon learnt anew."""
    settings = {"surface": True, "surface_sample": 6, "surface_checks": 3, "surface_generations": 3}
    return case.replaced("optimization", **settings)


def learn(
    case: Case, reference: object, solved: Sequence[Mapping[str, Any]], fast: object
) -> tuple[Learnt, dict[str, float]]:
    """A surface whose error depends on every design that it was learnt from."""
    assert all(data["level"] == 2 and not data["predicted"] for data in solved)
    total = sum(lot(DesignVariables.from_dict(data["variables"]), 2) for data in solved)
    error = 1e-3 * (total % 1.0)
    names = ("designs", "answered", "resistance", "greatest_resistance", "efficiency", "greatest_efficiency")
    return Learnt(error), {**dict.fromkeys(names, error), "designs": len(solved), "answered": len(solved)}


def learning(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """Predicted where there is a surface, but for every fifth design, of which it is in doubt."""
    result = evaluate(case, variables, level, reference)
    assert isinstance(result, Ok)
    if not isinstance(reference, Learnt) or lot(variables, level) < 0.2:
        return result
    objectives = {name: value + reference.error for name, value in result.objectives.items()}
    return replace(result, objectives=objectives, predicted=True)


def slow_learning(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """The same after a while, so that a kill hits something."""
    time.sleep(0.03)
    return learning(case, variables, level, reference)
