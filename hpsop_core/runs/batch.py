"""Evaluating the designs of a generation on workers that may raise, hang or die."""

from __future__ import annotations

import concurrent.futures
import itertools
import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import dataclass
from typing import Any, TypeAlias

from hpsop_core.case.case import Case
from hpsop_core.optimization.problem import Candidate
from hpsop_core.runs.control import RunControl
from hpsop_core.runs.parcels import Parcel, parcel_of, parcel_task
from hpsop_core.runs.results import Result
from hpsop_core.runs.tasks import EvaluateFunction, WarmUpFunction, failure, warm_up_task
from hpsop_core.runs.workers import Workers, WorkersLostError

_TICK = 0.1  # seconds between looks at the controls while evaluations run
_STOP_GRACE = 3.0  # seconds that evaluations under way may still have when the run is stopped
_STALL = 1.0  # seconds beyond a tick from which this program itself was stopped or starved
_LAST_RESULTS = 5.0  # seconds to collect what else comes from a pool that broke
_DEATHS_ALLOWED = 2
_TIMEOUTS_ALLOWED = 2
_QUICK = 0.05  # seconds: evaluations below have a spare one queued behind each; see ``BatchEvaluator._room``
_GATHERING = 0.05  # seconds within which quick evaluations are stored together
_RECONNECT_INTERVAL = 2.0  # seconds between tries to reach a cluster that does not answer


FinishedFunction: TypeAlias = Callable[[Sequence[tuple[int, Candidate, Result]]], None]
"""Told of results that came in together: id, candidate and what the evaluation came to of each."""


def _nothing() -> None:
    """What is told where nobody listens."""


def reconnect(workers: Workers, control: RunControl, lost: Callable[[str], None], reason: str) -> None:
    """Wait until workers that were lost answer again, or the run is stopped.

    Args:
        workers: the lost ones.
        control: of the run.
        lost: told the reason, and "" when it is over.
        reason: why they are lost.

    Raises:
        WorkersUnavailableError: others answer than can be used.
    """
    lost(reason)
    while not control.stopped:
        control.wait(_RECONNECT_INTERVAL)
        try:
            if not control.stopped:
                workers.reach()
            break
        except WorkersLostError:
            continue
    lost("")


@dataclass
class _Job:
    number: int
    candidate: Candidate
    reference: Any
    deaths: int = 0
    timeouts: int = 0
    alone: bool = False
    unknown: bool = False  # to a worker: its parcel goes along
    started: float | None = None


class BatchEvaluator:
    """Evaluates designs side by side; each ends in exactly one result, whatever its worker does.

    An exception or a NaN is caught in the worker (``evaluation_task``). Here is caught what takes the worker along:

    * Time-out: all workers are killed and started again, what else was under way is queued again. The design that was
      late is evaluated once more, alone on a warm worker, and recorded as failed if it is late again. The time in which
      this program itself stood still (Ctrl-Z, a sleeping machine, no processor to be had) does not count, nor what a
      new worker needs to import and compile.
    * A dead worker (out of memory, a crash in compiled code): every design under way is a suspect, and suspects are
      evaluated again one at a time, so the guilty one is known for certain: if its worker dies then too, it is
      recorded as failed. So the result does not depend on the number of workers.
    * A cluster that does not answer any more: the run is paused with the reason, and goes on when it answers again.

    Results are handed out when the workers have their next designs, and quick ones together, a twentieth of a second
    after the first of them at the latest: a transaction of the run file costs as much as ten records. One evaluator
    serves a whole run: it knows how long an evaluation takes, and which parcels there are.

    Args:
        workers: where to evaluate.
        evaluate: the evaluation.
        case: what is optimised.
        control: asked between evaluations.
        lost: called with the reason when the workers cannot be reached any more, and with "" when they can.
        warm_up: called once in each new worker, as ``Physics.warm_up``.
    """

    def __init__(
        self,
        workers: Workers,
        evaluate: EvaluateFunction,
        case: Case,
        control: RunControl,
        lost: Callable[[str], None] = lambda reason: None,
        warm_up: WarmUpFunction | None = None,
    ) -> None:
        self._lost = lost
        self._warm_up = warm_up
        self._typical = math.inf  # seconds of an evaluation of this level
        self._looked = time.monotonic()
        self._workers = workers
        self._evaluate = evaluate
        self._case = case
        self._control = control
        self._limit = case.optimization.evaluation_time_limit
        self._queue: deque[_Job] = deque()
        self._suspects: deque[_Job] = deque()
        self._under_way: dict[Future[Result | None], _Job] = {}
        self._parcels: dict[int, tuple[Any, Parcel]] = {}
        self._finished: FinishedFunction = lambda results: None
        self._begun: Callable[[], None] = _nothing
        self._level = 0
        self._results: list[tuple[int, Candidate, Result]] = []
        self._first_result = 0.0

    def run(
        self,
        tasks: Sequence[tuple[int, Candidate, Any]],
        finished: FinishedFunction,
        paused: Callable[[bool], None],
        begun: Callable[[], None] = _nothing,
    ) -> bool:
        """Evaluate all.

        Args:
            tasks: (id, candidate, reference of its level).
            finished: called with what has come in, quick evaluations gathered.
            paused: called with True when nothing is under way any more because of a pause, and with False when it is
                over.
            begun: called once, when the workers have their first designs, and before anything else is told or waited
                for.

        Returns:
            False if the run was stopped before all were evaluated.

        Raises:
            WorkersUnavailableError: no workers can be had any more.
        """
        self._queue = deque(_Job(number, candidate, reference) for number, candidate, reference in tasks)
        self._suspects = deque()
        self._under_way = {}
        # By identity, which a reference keeps as long as it is held here; making a parcel of a surface takes a while.
        references = {id(reference): reference for _, _, reference in tasks}
        self._parcels = {
            name: self._parcels.get(name) or (reference, parcel_of(self._evaluate, self._case, reference))
            for name, reference in references.items()
        }
        self._finished, self._begun = finished, begun
        self._results = []
        if tasks[0][1].level != self._level:
            self._level, self._typical = tasks[0][1].level, math.inf
        self._looked = time.monotonic()
        try:
            while self._queue or self._suspects or self._under_way:
                if self._control.stopped:
                    self._drain()
                    return False
                if self._control.paused and not self._under_way:
                    self._hand_out()
                    paused(True)
                    self._control.wait_while_paused()
                    paused(False)
                    continue
                try:
                    self._workers.look()
                    if not self._control.paused:
                        self._submit()
                    self._begin()
                    if self._is_due():
                        self._hand_out()
                    self._collect()
                except WorkersLostError as error:
                    self._requeue()
                    reconnect(self._workers, self._control, self._lost, str(error))
        except BaseException:
            # A full disk that the user gave up on, Ctrl-C: nothing may go on computing behind the run's back.
            self._abandon()
            raise
        self._hand_out()
        return True

    @property
    def quick(self) -> bool:
        """Whether an evaluation takes little enough that a few of them may be lost with the process."""
        return self._typical < _QUICK

    def _is_due(self) -> bool:
        """Whether what has come in is to be handed out now."""
        return not self.quick or time.monotonic() - self._first_result >= _GATHERING

    def _begin(self) -> None:
        begun, self._begun = self._begun, _nothing
        begun()

    def _hand_out(self) -> None:
        self._begin()
        if self._results:
            results, self._results = self._results, []
            self._finished(results)

    def _keep(self, result: tuple[int, Candidate, Result]) -> None:
        if not self._results:
            self._first_result = time.monotonic()
        self._results.append(result)

    def _submit(self) -> None:
        if self._suspects:
            if not self._under_way:
                job = self._suspects.popleft()
                job.alone = True
                self._start(job)
            return
        while self._queue and len(self._under_way) < self._room():
            if not self._start(self._queue.popleft()):
                return

    def _room(self) -> int:
        """How many evaluations may be under way: one a worker, and where they are quick a spare one behind each.

        A worker with a spare one has something to do while the result before is being stored: that takes a tenth of an
        evaluation of level 1. Slow ones gain nothing from it, and a stop would wait for them. On a cluster nobody knows
        when a spare one begins.
        """
        slots = self._workers.slots
        return 2 * slots if self.quick and self._workers.blamable else slots

    def _start(self, job: _Job) -> bool:
        try:
            future = self._submitted(job)
        except WorkersLostError:
            self._queue_again(job)
            raise
        except BrokenExecutor:
            # A worker died while it was idle: nobody here is to blame.
            self._queue_again(job)
            self._requeue()
            self._workers.rebuild()
            return False
        if not self._under_way:
            self._looked = time.monotonic()
        job.started = None
        self._under_way[future] = job
        self._start_clocks()
        return True

    def _start_clocks(self) -> None:
        # Workers take them in the order submitted: as many as there are workers are being evaluated, the rest waits.
        now = time.monotonic()
        for job in itertools.islice(self._under_way.values(), self._workers.slots):
            if job.started is None:
                job.started = now

    def _submitted(self, job: _Job) -> Future[Result | None]:
        candidate = job.candidate
        if self._warm_up is not None:
            # Before its clock runs: a worker that was just started has yet to load, and maybe to compile, the solvers.
            self._workers.warm(
                candidate.level, self._control, warm_up_task, self._warm_up, self._case, candidate.level, job.reference
            )
        _, parcel = self._parcels[id(job.reference)]
        return self._workers.submit(
            parcel_task, parcel if job.unknown else parcel.label, candidate.variables, candidate.level
        )

    def _queue_again(self, job: _Job) -> None:
        # A suspect stays one.
        (self._suspects if job.deaths or job.timeouts else self._queue).appendleft(job)

    def _requeue(self) -> None:
        self._hand_out()
        for job in sorted(self._under_way.values(), key=lambda job: -job.number):
            self._queue_again(job)
        self._under_way = {}

    def _collect(self) -> None:
        if not self._under_way:
            return
        longest = min(_TICK, _GATHERING) if self._results else _TICK
        concurrent.futures.wait(self._under_way, timeout=longest, return_when=concurrent.futures.FIRST_COMPLETED)
        if self._take_finished():
            if not self._workers.blamable:
                self._requeue()
                self._workers.reach()
                return
            # Others of the broken pool may have finished; what has not is a suspect.
            concurrent.futures.wait(self._under_way, timeout=_LAST_RESULTS)
            self._take_finished()
            self._blame()
            return
        self._allow_for_stalls()
        now = time.monotonic()
        late = [
            future
            for future, job in self._under_way.items()
            if job.started is not None and now - job.started > self._limit and not future.done()
        ]
        if late:
            for future in late:
                job = self._under_way.pop(future)
                job.timeouts += 1
                if job.timeouts >= _TIMEOUTS_ALLOWED:
                    reason = f"took longer than the limit of {self._limit:g} s, twice"
                    self._keep(self._failed(job, "time-out", reason))
                else:
                    self._suspects.append(job)
            self._requeue()
            self._workers.rebuild()

    def _allow_for_stalls(self) -> None:
        """What stopped this loop stopped the workers too, or may have: it is no fault of theirs."""
        now = time.monotonic()
        stalled = now - self._looked - _TICK
        self._looked = now
        if stalled > _STALL:
            for job in self._under_way.values():
                if job.started is not None:
                    job.started += stalled

    def _take_finished(self) -> bool:
        """Keep the results that have come in; True if a worker died."""
        broken = False
        for future in [future for future in self._under_way if future.done()]:
            try:
                error = future.exception()
            except CancelledError:
                broken = True
                continue
            if isinstance(error, (BrokenExecutor, CancelledError)):
                broken = True
                continue
            if isinstance(error, OSError) and not self._workers.blamable:
                # Of the way to the cluster: ``evaluation_task`` lets none of its own out.
                broken = True
                continue
            job = self._under_way.pop(future)
            result = future.result() if error is None else None
            if error is None and result is None:
                job.unknown = True
                self._queue_again(job)
                continue
            if job.started is not None:
                took = time.monotonic() - job.started
                self._typical = took if self._typical == math.inf else 0.8 * self._typical + 0.2 * took
            if result is not None:
                self._keep((job.number, job.candidate, result))
            elif type(error).__name__ == "KilledWorker":
                # Dask has tried it on several workers already and knows for certain that this one was to blame.
                self._keep(self._failed(job, "worker", "its worker processes died"))
            else:
                # SystemExit, or a result that cannot be pickled.
                text = " ".join(f"{type(error).__name__}: {error}".split())
                self._keep(self._failed(job, "worker", text))
        self._start_clocks()
        return broken

    def _blame(self) -> None:
        for job in sorted(self._under_way.values(), key=lambda job: job.number):
            job.deaths += 1
            if job.alone and job.deaths >= _DEATHS_ALLOWED:
                self._keep(self._failed(job, "worker", "its worker process died twice"))
            else:
                self._suspects.append(job)
        self._under_way = {}
        self._hand_out()
        self._workers.rebuild()

    def _failed(self, job: _Job, stage: str, reason: str) -> tuple[int, Candidate, Result]:
        candidate = job.candidate
        elapsed = 0.0 if job.started is None else time.monotonic() - job.started
        return (
            job.number,
            candidate,
            failure(self._case, candidate.variables, candidate.level, stage, reason, elapsed),
        )

    def _drain(self) -> None:
        """The run ends: keep what finishes within a moment, drop the rest."""
        self._hand_out()
        concurrent.futures.wait(self._under_way, timeout=_STOP_GRACE)
        self._take_finished()
        self._hand_out()
        self._abandon()

    def _abandon(self) -> None:
        for future in self._under_way:
            future.cancel()
        self._under_way = {}
