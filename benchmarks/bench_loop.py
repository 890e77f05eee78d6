"""What a run costs beside its evaluations: asking, sending, packing, storing, telling; a whole run with free ones.

Run as a script. The run is a real one, controller, workers and file: 150 generations of 50 whose evaluations return a
real design's whole result at once. Beside it, in the same process, the search alone, and pymoo's own NSGA-II on as many
free evaluations: the part of a loop that any program has. Ratios say more than times on a busy machine.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import resource
import tempfile
import time
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.result import Evaluation, Ok
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.optimization.two_level import TwoLevelSearch
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.tasks import Physics


@lru_cache
def template() -> Ok:
    """A real design's whole result."""
    result = evaluate(load_case("dtc-p4119"))
    assert result.ok
    return result


def objectives(variables: DesignVariables) -> dict[str, float]:
    """Two that conflict."""
    ratio, extra = variables.length_to_breadth / 8.5, 0.1 * variables.pitch_ratio
    return {"f1": ratio + extra, "f2": 2.0 - ratio + extra}


def free_evaluation(case: Case, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """Nothing to compute."""
    return dataclasses.replace(
        template(), level=level, variables=variables, objectives=objectives(variables), feasible=True
    )


def no_reference(case: Case, level: int) -> None:
    """Nothing to normalise with."""


def unread(data: Any) -> None:
    """No reference comes back either."""


def processor_seconds(who: int) -> float:
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def whole_run(case: Case, generations: int, workers: int) -> tuple[float, float, float, int]:
    """Wall, own and workers' processor seconds of a run, and its evaluations."""
    physics = Physics(free_evaluation, no_reference, unread)
    with tempfile.TemporaryDirectory() as folder:
        before = [processor_seconds(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        started = time.perf_counter()
        run = optimize(
            case, Path(folder) / "free.hpsop", generations=generations, level1_generations=generations,
            workers=workers, physics=physics,
        )  # fmt: skip
        wall = time.perf_counter() - started
        after = [processor_seconds(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        count = sum(level["count"] for level in run.summary()["evaluations"].values())
    return wall, after[0] - before[0], after[1] - before[1], count


def search_alone(case: Case, generations: int) -> float:
    """Processor seconds of asking and telling, without files and workers."""
    settings = dataclasses.replace(case.optimization, generations=generations, level1_generations=generations)
    search = TwoLevelSearch(case.bounds, settings, case.initial.variables)
    numbers: dict[tuple[float, ...], int] = {}
    started = time.process_time()
    while candidates := search.ask():
        outcomes = []
        for candidate in candidates:
            number = numbers.setdefault(_key(candidate), len(numbers) + 1)
            values = objectives(candidate.variables)
            outcomes.append(Outcome(number, (values["f1"], values["f2"]), (0.0,), True))
        search.tell(outcomes)
    return time.process_time() - started


def _key(candidate: Candidate) -> tuple[float, ...]:
    return candidate.key


class _Free(Problem):
    """As many variables, the same objectives, a whole population at once."""

    def __init__(self, case: Case) -> None:
        space = case.bounds
        super().__init__(n_var=len(space.free), n_obj=2, xl=space.relaxed_lower, xu=space.relaxed_upper)

    def _evaluate(self, x: Any, out: Any, *args: Any, **kwargs: Any) -> None:
        share = (x[:, 0] - self.xl[0]) / (self.xu[0] - self.xl[0])
        out["F"] = np.column_stack((share, 2.0 - share)) + 0.1 * x[:, 1:].mean(axis=1)[:, None]


def plain_pymoo(case: Case, generations: int) -> float:
    """Processor seconds of pymoo's NSGA-II as its manual runs it."""
    started = time.process_time()
    minimize(_Free(case), NSGA2(pop_size=case.optimization.population), ("n_gen", generations), seed=1, verbose=False)
    return time.process_time() - started


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generations", type=int, default=150)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    case = load_case("dtc-p4119").replaced("optimization", surface=False, final_errors=False)
    template()
    pymoo, search = plain_pymoo(case, asked.generations), search_alone(case, asked.generations)
    wall, own, workers, count = whole_run(case, asked.generations, asked.workers)
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {asked.workers} workers")
    print(f"{count} free evaluations, all on disk  {wall:8.2f} s wall")
    print(f"  this process                      {own:8.2f} s of processor time, {1e3 * own / count:.3f} ms each")
    print(f"  workers, start included           {workers:8.2f} s of processor time")
    print(f"the search alone                    {search:8.2f} s of processor time")
    print(f"plain pymoo loop, as many           {pymoo:8.2f} s of processor time")
    print(f"ratio: this process over plain pymoo {own / pymoo:7.2f}; the search over plain pymoo {search / pymoo:.2f}")


if __name__ == "__main__":
    main()
