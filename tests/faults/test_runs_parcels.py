"""What all designs share travels to each worker once, and results that come quickly are stored together."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from quick_physics import evaluate, physics
from run_files import small_case

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate
from hpsop_core.runs import batch, parcels
from hpsop_core.runs.batch import BatchEvaluator
from hpsop_core.runs.control import RunControl
from hpsop_core.runs.controller import RunController
from hpsop_core.runs.executor import LocalWorkers
from hpsop_core.runs.packing import document_of
from hpsop_core.runs.parcels import Parcel, parcel_of, parcel_task
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.records import variables_text
from hpsop_core.runs.results import Result
from hpsop_core.runs.store import RunStore, StoreUnwritableError

CASE = small_case()


def slow(case: Case, variables: DesignVariables, level: int, reference: Any) -> Evaluation:
    """As slow as one of level 2."""
    time.sleep(0.06)
    return evaluate(case, variables, level, None)


def quick(case: Case, variables: DesignVariables, level: int, reference: Any) -> Evaluation:
    """As quick as one of level 1, with the reference's word in its warnings."""
    time.sleep(0.002)
    return dataclasses.replace(evaluate(case, variables, level, None), warnings=(str(reference),))  # type: ignore[type-var]


class _Threads:
    """Two workers that share their memory; what is sent to them is counted."""

    slots, description, blamable, versions = 2, "threads", True, {}  # type: ignore[var-annotated]

    def __init__(self) -> None:
        self.pool = ThreadPoolExecutor(2)
        self.sent: list[str] = []

    def look(self) -> None:
        """They are there."""

    def warm(self, *arguments: Any) -> None:
        """They are warm."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        parcel = arguments[0]
        assert isinstance(parcel, Parcel)
        self.sent.append(parcel.name if parcel.content is not None else "")
        return self.pool.submit(function, *arguments)

    def rebuild(self) -> None:
        raise AssertionError("nothing broke")

    reach = rebuild

    def close(self) -> None:
        self.pool.shutdown()


def evaluated(function: Any, references: Sequence[str]) -> tuple[_Threads, list[list[int]], dict[int, Any]]:
    workers, groups, documents = _Threads(), [], {}
    variables = CASE.initial.variables
    tasks = [
        (number, Candidate(1, variables.replaced({"draft": 14.0 + 0.01 * number}), "sample"), reference)
        for number, reference in enumerate(references)
    ]

    def begun() -> None:
        groups.append([-len(workers.sent)])

    def finished(results: Sequence[tuple[int, Candidate, Result]]) -> None:
        groups.append([number for number, _, _ in results])
        documents.update(
            (number, document_of(result.essence, variables_text(candidate.variables)))
            for number, candidate, result in results
        )

    try:
        evaluator = BatchEvaluator(workers, function, CASE, RunControl())
        assert evaluator.run(tasks, finished, lambda paused: None, begun)
    finally:
        workers.close()
    assert groups.pop(0)[0] <= -2, "both workers have a design before anything else is done"
    assert all(number >= 0 for group in groups for number in group), "once"
    return workers, groups, documents


def test_a_parcel_is_asked_for_by_who_does_not_have_it() -> None:
    parcel, variables = parcel_of(evaluate, CASE, None), CASE.initial.variables
    parcels._opened.clear()
    assert parcel_task(parcel.label, variables, 1) is None
    result = parcel_task(parcel, variables, 1)
    assert result is not None and result.outcome.objectives == tuple(
        evaluate(CASE, variables, 1, None).objectives.values()
    )
    again = parcel_task(parcel.label, variables, 1)
    assert again is not None and again.status == "ok"
    for number in range(9):
        parcel_task(parcel_of(evaluate, CASE, number), variables, 1)
    assert len(parcels._opened) < 9
    assert parcel_task(parcel.label, variables, 1) is None


def test_each_reference_is_sent_once_and_each_design_gets_its_own() -> None:
    references = ["learnt once", "learnt twice"] * 30
    workers, groups, documents = evaluated(quick, references)
    assert sorted(number for group in groups for number in group) == list(range(60))
    assert [documents[number]["warnings"] for number in range(60)] == [[word] for word in references]
    # A spare one behind each of the two may have asked for it too.
    assert sum(name != "" for name in workers.sent) <= 8
    # 60 of 2 ms on two workers: about 60 ms, and one transaction each 50 ms, not 60 of them.
    assert len(groups) < 30


def test_slow_results_are_stored_as_they_come() -> None:
    _, groups, documents = evaluated(slow, ["none"] * 6)
    assert len(documents) == 6
    assert len(groups) >= 3


def small_run(path: Path, monkeypatch: pytest.MonkeyPatch, written: Callable[[RunStore, int], None]) -> RunController:
    """Six quick generations of level 1; ``written`` is called when evaluations of one are about to be."""
    record = RunStore.record_evaluations

    def recorded(store: RunStore, results: Any, generation: int) -> Any:
        written(store, generation)
        return record(store, results, generation)

    monkeypatch.setattr(RunStore, "record_evaluations", recorded)
    # Quick also on a machine that stands still, and all of a generation together.
    monkeypatch.setattr(batch, "_QUICK", 60.0)
    monkeypatch.setattr(batch, "_GATHERING", 60.0)
    case = small_case(generations=6, level1_generations=6)
    return RunController(path, case, workers=1, physics=physics())


def test_workers_have_their_next_designs_before_a_quick_generation_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    submitted, at = [0], {}
    submit, record = LocalWorkers.submit, RunStore.record_generation

    def counted(workers: LocalWorkers, function: Any, *arguments: Any) -> Any:
        submitted[0] += function is parcel_task
        return submit(workers, function, *arguments)

    def noted(store: RunStore, generation: Generation, elapsed: float) -> None:
        known = {row[0] for row in store._connection.execute("SELECT id FROM evaluations")}
        assert set(generation.asked) <= known, "no generation without its evaluations"
        assert max(known) <= max(generation.asked), "nor an evaluation of the next one before it"
        at[generation.number] = submitted[0] - len(known)
        record(store, generation, elapsed)

    monkeypatch.setattr(LocalWorkers, "submit", counted)
    monkeypatch.setattr(RunStore, "record_generation", noted)
    with small_run(tmp_path / "run.hpsop", monkeypatch, lambda store, generation: None) as run:
        run.start()
        assert run.wait(60.0)
    # A parcel that a worker did not have was submitted twice.
    assert all(at[number] > at[1] == at[6] for number in (2, 3, 4, 5)), at


def test_what_was_put_off_is_written_before_its_generation_or_not_at_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(store: RunStore, generation: int) -> None:
        if generation == 3:
            run.stop()
            raise StoreUnwritableError("no room")

    path = tmp_path / "run.hpsop"
    run = small_run(path, monkeypatch, full)
    with run:
        run.start()
        assert run.wait(60.0)
    monkeypatch.undo()
    assert [generation.number for generation in open_run(path).generations()] == [1, 2]
