"""How a run grows with its workers, whatever cores this machine has: evaluations that sleep.

    python benchmarks/bench_workers.py [--seconds 0.15] [--generations 4] [--workers 1 2 4] [--local]

Dask workers, or with --local processes of the run's own: 0.012 s is an evaluation of level 1. The level changes half
way. An evaluation sleeps as long as a real one computes and returns a real design's whole result, so that all that
keeps workers idle is the run itself: a generation's last evaluations, sending, storing, the search. Then what a design
costs the wire and the driving process, from which larger clusters follow on paper: with w workers a generation of p
designs takes ceil(p / w) evaluations one after the other, and the driving process p times its own share.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import pickle
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from distributed import LocalCluster

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Evaluation, Ok
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.parcels import parcel_of, parcel_task
from hpsop_core.runs.tasks import Physics, evaluation_task

POPULATION = 50


def slept(
    template: Ok, seconds: float, case: Case, variables: DesignVariables, level: int, reference: object
) -> Evaluation:
    """A real design's whole result after a sleep."""
    time.sleep(seconds)
    ratio, extra = variables.length_to_breadth / 8.5, 0.1 * variables.pitch_ratio
    objectives = {"f1": ratio + extra, "f2": 2.0 - ratio + extra}
    return dataclasses.replace(template, level=level, variables=variables, objectives=objectives, feasible=True)


def no_reference(case: Case, level: int) -> None:
    """Nothing to normalise with."""


def unread(data: object) -> None:
    """No reference comes back either."""


def busy_share(case: Case, physics: Physics, workers: int, generations: int, seconds: float, local: bool) -> float:
    """Evaluations over what the workers had time for, without the first generation, which starts them.

    Time is the wall's from the first to the last result, so that what passes between two generations counts.
    """
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        place: dict[str, Any] = {"workers": workers}
        if not local:
            cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None, processes=True)
            stack.enter_context(cluster)
            place = {"executor": f"dask:{cluster.scheduler_address.removeprefix('tcp://')}"}
        run = optimize(
            case, Path(folder) / "slept.hpsop", generations=generations, level1_generations=generations // 2,
            physics=physics, **place,
        )  # fmt: skip
        first, *others = run.generation_records()
        evaluated = sum(point.generation > 1 for point in run.archive())
    return evaluated * seconds / workers / (others[-1].finished_at - first.finished_at)


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=0.15)
    parser.add_argument("--generations", type=int, default=4)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--local", action="store_true")
    asked = parser.parse_args()
    case = load_case("dtc-p4119").replaced("optimization", surface=False, final_errors=False, population=POPULATION)
    template = evaluate(case)
    assert isinstance(template, Ok)
    physics = Physics(partial(slept, template, asked.seconds), no_reference, unread)
    print(f"evaluations of {asked.seconds:g} s, {POPULATION} a generation")
    for workers in asked.workers:
        share = busy_share(case, physics, workers, asked.generations, asked.seconds, asked.local)
        print(f"{workers:3d} workers: {100.0 * share:5.1f} % of their time evaluations")
    reference = reference_for(case, 2)
    parcel = parcel_of(evaluate, case, reference)
    task = pickle.dumps((parcel_task, parcel.label, case.initial.variables, 2))
    once = len(parcel.content or b"")
    result = evaluation_task(evaluate, case, case.initial.variables, 2, reference)
    print(f"a design on its way to a worker {len(task)} bytes ({once} once), back {len(pickle.dumps(result))} bytes")


if __name__ == "__main__":
    main()
