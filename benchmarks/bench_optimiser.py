"""What the optimiser itself costs: a generation of NSGA-II, a sample, a stored evaluation, a trip to a worker.

Run as a script. Evaluations cost nothing here, so all that is measured is overhead. Best of several; the algorithm's
own figures are processor time, which a busy machine disturbs least.
"""

from __future__ import annotations

import dataclasses
import pickle
import tempfile
import time
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np

from hpsop_core.case.case import load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Evaluation, Ok
from hpsop_core.optimization.nsga2 import Nsga2, Operators
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.optimization.sampling import latin_hypercube
from hpsop_core.optimization.two_level import TwoLevelSearch
from hpsop_core.runs.executor import LocalWorkers
from hpsop_core.runs.records import json_text
from hpsop_core.runs.results import Result
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import evaluation_task


def best_of(repeats: int, action: Callable[[], object]) -> float:
    """The least wall time in s."""
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        action()
        times.append(time.perf_counter() - started)
    return min(times)


@lru_cache
def template() -> Ok:
    """A real design's whole result."""
    result = evaluate(load_case("dtc-p4119-paper"))
    assert result.ok
    return result


def free_evaluation(case: object, variables: DesignVariables, level: int, reference: object) -> Evaluation:
    """Nothing to compute."""
    objectives = {"f1": variables.draft / 14.0, "f2": 14.0 / variables.draft}
    return dataclasses.replace(template(), level=level, variables=variables, objectives=objectives, feasible=True)


def nsga2_generation() -> tuple[float, float]:
    """(pymoo alone, the whole search with decoding, front, indicators): best of 60 generations of 50, in s of
    processor time."""
    case = load_case("dtc-p4119")
    space = case.bounds
    algorithm = Nsga2(space, Operators(50, 0.9, 15.0, 0.05, 20.0), latin_hypercube(space, 50, 1), 1)
    alone = []
    for generation in range(60):
        started = time.process_time()
        vectors = algorithm.ask()
        asked = time.process_time() - started
        assert vectors is not None
        shares = (vectors - space.relaxed_lower) / (space.relaxed_upper - space.relaxed_lower)
        objectives = np.column_stack((shares[:, 0], 1.0 - np.sqrt(shares[:, 0]))) + shares[:, 1:].mean(axis=1)[:, None]
        started = time.process_time()
        algorithm.tell([50 * generation + row for row in range(len(vectors))], objectives, np.zeros((len(vectors), 1)))
        _ = algorithm.population
        alone.append(asked + time.process_time() - started)
    search = TwoLevelSearch(space, case.optimization, case.initial.variables)
    numbers: dict[tuple[float, ...], int] = {}
    whole = []
    for _ in range(60):
        started = time.process_time()
        candidates = search.ask()
        asked = time.process_time() - started
        outcomes = []
        for candidate in candidates:
            number = numbers.setdefault(candidate.key, len(numbers) + 1)
            ratio = candidate.variables.length_to_breadth / 8.5
            extra = 0.1 * candidate.variables.pitch_ratio
            outcomes.append(Outcome(number, (ratio + extra, 2.0 - ratio + extra), (0.0,), True))
        started = time.process_time()
        search.tell(outcomes)
        whole.append(asked + time.process_time() - started)
    return min(alone[1:]), min(whole[1:])


def main() -> None:
    """Print every figure."""
    case = load_case("dtc-p4119")
    alone, whole = nsga2_generation()
    print(f"NSGA-II, a generation of 50           {1e3 * alone:8.2f} ms   (budget 15 ms)")
    print(f"  with decoding, front, indicators    {1e3 * whole:8.2f} ms")
    sample = best_of(3, lambda: latin_hypercube(case.bounds, 50, 1))
    print(f"Latin hypercube of 50                 {1e3 * sample:8.1f} ms")

    variables = case.initial.variables
    reference = reference_for(case, 1)
    space = case.bounds
    designs = [space.decode(vector) for vector in latin_hypercube(space, 300, 3)]
    documents = [evaluate(case, design, 1, reference).as_dict() for design in designs]
    results = [Result.of(document) for document in documents]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.hpsop"
        store = RunStore(path, case)
        numbers = iter(range(len(designs)))

        def record() -> None:
            row = next(numbers)
            store.record_evaluation(row + 1, Candidate(1, designs[row], "sample"), 1, results[row])

        print(f"An evaluation written to the run file {1e3 * best_of(len(designs), record):8.3f} ms")
        read = best_of(5, store.outcomes) / len(designs)
        print(f"  read when the run is resumed        {1e3 * read:8.3f} ms")
        store.close()
        written = np.mean([len(json_text(document)) for document in documents])
        print(f"  bytes as JSON                       {written:8.0f}")
        print(f"  bytes in the file                   {path.stat().st_size / len(designs):8.0f}")

    started = time.perf_counter()
    workers = LocalWorkers(1)
    print(f"Workers ready after                   {1e3 * (time.perf_counter() - started):8.0f} ms")
    arguments = (free_evaluation, case, variables, 1, None)
    trip = best_of(200, lambda: workers.submit(evaluation_task, *arguments).result())
    print(f"A trip to a worker and back           {1e3 * trip:8.3f} ms")
    print(f"Workers killed and made anew in       {1e3 * best_of(3, workers.rebuild):8.0f} ms")
    workers.close()
    print(f"Bytes that a design costs to ship     {len(pickle.dumps((evaluation_task, *arguments))):8d}")


if __name__ == "__main__":
    main()
