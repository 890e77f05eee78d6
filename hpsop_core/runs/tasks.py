"""What a worker process does: one evaluation in, one result out, and nothing that can end a run."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing import connection, parent_process
from typing import Any, TypeAlias

import threadpoolctl

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.result import Evaluation, Failed
from hpsop_core.runs.records import json_text
from hpsop_core.runs.results import Result

EvaluateFunction: TypeAlias = Callable[[Case, DesignVariables, int, Any], Evaluation]
"""(case, variables, level, reference) -> evaluation; picklable."""

ReferenceFunction: TypeAlias = Callable[[Case, int], Any]
"""(case, level) -> a reference with ``as_dict``, or None for an evaluation that needs none; picklable."""

WarmUpFunction: TypeAlias = Callable[[Case, int, Any], None]
"""(case, level, reference): whatever makes the first evaluation as quick as the others; picklable."""

LearnFunction: TypeAlias = Callable[[Case, Any, Sequence[Mapping[str, Any]], Any], tuple[Any, Mapping[str, float]]]
"""(case, reference, solved designs' JSON, level 1's reference or None without level 1) -> the reference with what
was learnt, and how far off that is, by name; the reference as it was, and nothing, where the designs are too few."""

_NICENESS = 10
_PR_SET_PDEATHSIG = 1
_threads_pinned = False


@dataclass(frozen=True)
class Physics:
    """How designs are evaluated; everything in it can be pickled.

    Attributes:
        evaluate: the evaluation.
        reference_for: what normalises at a level.
        reference_from_dict: makes a reference from its ``as_dict``.
        warm_up: called once in each new worker and level, before evaluations are timed; None if there is no need.
        learn: called by the run itself with solved designs of level 2; None if nothing can be learnt.
        refine: as ``evaluate`` at level 2, with the numbers' errors; None if they cannot be had.
        searching: level 1's reference as designs of a search are evaluated with it; None if it is the same.
    """

    evaluate: EvaluateFunction
    reference_for: ReferenceFunction
    reference_from_dict: Callable[[Mapping[str, Any]], Any]
    warm_up: WarmUpFunction | None = None
    learn: LearnFunction | None = None
    refine: EvaluateFunction | None = None
    searching: Callable[[Case, Any], Any] | None = None


def hydrodynamics() -> Physics:
    """The real thing."""
    # Imported here: this module is also the workers' first import, and tests bring their own physics.
    from hpsop_core.evaluation.evaluate import evaluate
    from hpsop_core.evaluation.reference import Reference, learnt, reference_for, searching

    return Physics(evaluate, reference_for, Reference.from_dict, _make_ready, learnt, _evaluate_with_errors, searching)


def _evaluate_with_errors(case: Case, variables: DesignVariables, level: int, reference: Any) -> Evaluation:
    from hpsop_core.evaluation.errors import evaluate_with_errors

    return evaluate_with_errors(case, variables, level, reference)


def _make_ready(case: Case, level: int, reference: Any) -> None:
    from hpsop_core.evaluation.evaluate import evaluate

    # Also where a surface would answer: the solvers are to be made ready.
    evaluate(case, case.initial.variables, level, dataclasses.replace(reference, surface=None))


def evaluation_task(
    evaluate: EvaluateFunction, case: Case, variables: DesignVariables, level: int, reference: Any
) -> Result:
    """Evaluate one design in this process.

    Returns:
        What it came to. An exception, a NaN or an infinity becomes a failed evaluation with its stage and reason:
        nothing but the death of the process comes out of here otherwise.
    """
    pin_threads()
    started = time.perf_counter()
    try:
        data = evaluate(case, variables, level, reference).as_dict()
        fault = _missing(data)
        if not fault:
            try:
                return Result.of(data)
            except ValueError as error:
                # Every number is looked at there anyway, and only then we look for which it was.
                fault = _search(data, "") or _one_line(error)
        stage, reason = "check", fault
    except SolverFailure as error:
        stage, reason = error.stage, error.reason
    except Exception as error:  # noqa: BLE001 - whatever a solver raises is this design's failure, not the run's
        stage, reason = "evaluation", _one_line(error)
    return failure(case, variables, level, stage, reason, time.perf_counter() - started)


def failure(case: Case, variables: DesignVariables, level: int, stage: str, reason: str, elapsed: float) -> Result:
    """What a failed evaluation came to."""
    return Result.of(Failed(case.name, level, variables, stage, reason, elapsed).as_dict())


def reference_task(reference_for: ReferenceFunction, case: Case, level: int) -> tuple[bool, str]:
    """Compute a level's reference in this process: (True, JSON text) or (False, what is wrong and what to do)."""
    pin_threads()
    try:
        reference = reference_for(case, level)
        return True, json_text(None if reference is None else reference.as_dict())
    except InputError as error:
        return False, str(error)
    except Exception as error:  # noqa: BLE001 - told to the user as the reason why the run cannot start
        return False, f"the initial design cannot be computed at level {level} ({_one_line(error)}); change [initial]"


def presence_task(seconds: float) -> int:
    """Occupy a worker for a moment, so that the pool starts all of them; returns the process id."""
    pin_threads()
    time.sleep(seconds)
    return os.getpid()


def warm_up_task(warm_up: WarmUpFunction, case: Case, level: int, reference: Any) -> None:
    """Make this process ready; what fails here is found again, and told, by the evaluation itself."""
    pin_threads()
    started = time.perf_counter()
    with contextlib.suppress(Exception):
        warm_up(case, level, reference)
    # Long enough that no worker takes two of these and leaves another one cold.
    time.sleep(max(0.0, 0.05 - (time.perf_counter() - started)))


def _one_line(error: BaseException) -> str:
    text = " ".join(str(error).split())
    name = type(error).__name__
    return text if isinstance(error, SolverFailure) else f"{name}: {text}" if text else name


def _missing(data: dict[str, Any]) -> str:
    """Which objective an evaluation misses though ok; else ""."""
    if data["status"] == "ok":
        for name in ("f1", "f2"):
            if data["objectives"].get(name) is None:
                return f"objectives.{name} is missing"
    return ""


def _search(value: Any, path: str) -> str:
    """Where a document holds something that is no finite number; "" where it does not."""
    if isinstance(value, float) and not math.isfinite(value):
        return f"{path} is {value}"
    if isinstance(value, dict):
        items = [(f"{path}.{key}" if path else str(key), item) for key, item in value.items()]
    elif isinstance(value, (list, tuple)):
        items = [(f"{path}[{index}]", item) for index, item in enumerate(value)]
    else:
        return ""
    for name, item in items:
        fault = _search(item, name)
        if fault:
            return fault
    return ""


def pin_threads() -> None:
    """One BLAS thread in this process: more would change the last bits of a result, and fight for the cores."""
    global _threads_pinned
    if not _threads_pinned:
        threadpoolctl.threadpool_limits(limits=1)
        _threads_pinned = True


def start_worker() -> None:
    """What a local worker process does first: obey its parent alone, and never outlive it."""
    # Ctrl-C in a terminal reaches every process of the group; the parent decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as Ctrl-C: a terminal that is closed tells the whole group
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})  # blocked in the fork server, and so in its children
    _die_with_parent()
    os.nice(_NICENESS)  # the page and the desktop stay smooth while every core computes
    pin_threads()


def _die_with_parent() -> None:
    """End this process when the run's process ends, even by SIGKILL."""
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_watch, args=(parent.sentinel,), name="parent-watch", daemon=True).start()
    if sys.platform == "linux":
        # The watching thread needs Python's lock, which compiled code may hold for as long as it hangs. The kernel
        # needs nothing. Our direct parent is the fork server, which ends when the run's process does.
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _watch(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)
