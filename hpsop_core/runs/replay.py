"""Driving a run: ask, answer from the file or by evaluation, tell. To resume is to do the same again.

The evaluations on disk are the only checkpoint. A run that is started again asks the same questions from its seed and
finds the answers in the file (about 5 ms a generation) until it comes to the first one that is missing; from there it
computes. So nothing of the algorithm's state is ever stored, and nothing can be forgotten between two checkpoints.
"""

from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import time
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeVar

from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.levels import FAST, LEVELS, TRUTH, level_of
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate
from hpsop_core.optimization.two_level import TwoLevelSearch
from hpsop_core.runs.batch import BatchEvaluator, reconnect
from hpsop_core.runs.control import RunControl
from hpsop_core.runs.events import RunEvent, RunSnapshot, State
from hpsop_core.runs.learning import Learning
from hpsop_core.runs.ledger import DivergedError, Ledger
from hpsop_core.runs.packing import document_of
from hpsop_core.runs.records import variables_text
from hpsop_core.runs.refinement import keep_errors, shown_front, unrefined
from hpsop_core.runs.results import Result
from hpsop_core.runs.schema import initial_id, software_versions
from hpsop_core.runs.store import RunStore, StoreUnwritableError
from hpsop_core.runs.tasks import Physics, failure, reference_task
from hpsop_core.runs.time_left import level2_seconds
from hpsop_core.runs.workers import Workers, WorkersLostError, WorkersUnavailableError

_EVENT_INTERVAL = 0.1  # seconds between events about progress within a generation
_RETRY_INTERVAL = 1.0  # seconds between tries to write to a full disk
_REFERENCE_TRIES = 3
_RECENT = 10  # generations that the estimate of the time left looks back on
_LEVEL2_SECONDS = 0.3  # an evaluation at level 2, until one is measured: the initial design's finds its hull remembered

_T = TypeVar("_T")


class _StoppedError(Exception):
    """The run was asked to stop."""


class RunDriver:
    """Drives one run to its end, or to a stop. One thread calls ``run``; any thread uses the control.

    Args:
        store: the run file.
        physics: how designs are evaluated.
        make_workers: called when the first evaluation is needed.
        control: what people ask for.
        emit: receives the events, in the driving thread.
    """

    def __init__(
        self,
        store: RunStore,
        physics: Physics,
        make_workers: Callable[[], Workers],
        control: RunControl,
        emit: Callable[[RunEvent], None],
    ) -> None:
        self._store = store
        self._case = store.case
        self._physics = physics
        self._make_workers = make_workers
        self._workers: Workers | None = None
        self._control = control
        self._emit = emit
        self._ledger = Ledger(variables_text(self._case.initial.variables), store.outcomes())
        self._learning = Learning(store, self._case, physics, self._ledger)
        self._references: dict[int, Any] = {}
        self._evaluator: BatchEvaluator | None = None
        self._later: list[Callable[[], None]] = []
        self._waited = 0.0
        self._noted: set[str] = set()
        self._last_event = 0.0
        self._level2_seconds: float | None = None
        self.snapshot = RunSnapshot()

    def run(self) -> State:
        """Drive the run.

        Returns:
            "finished" or "stopped".

        Raises:
            InputError: the initial design cannot be computed, or the file cannot be continued to the same bits.
            WorkersUnavailableError: no workers can be had.
        """
        state: State = "failed"
        reason = ""
        try:
            try:
                self._search()
            finally:
                self._catch_up()
            state = "finished"
        except _StoppedError:
            state = "stopped"
        except HpsopError as error:
            if self._control.stopped and isinstance(error, WorkersUnavailableError):
                # Whoever stopped us (a service manager, say) ended the workers too.
                state = "stopped"
                return state
            reason = str(error)
            raise
        except BaseException as error:
            reason = f"{type(error).__name__}: {error}"
            raise
        finally:
            if self._workers is not None:
                self._workers.close()
                self._workers = None
            self._end(state, reason)
        return state

    def _end(self, state: State, reason: str) -> None:
        try:
            self._store.set_values(state=state, reason=reason)
            if reason:
                self._store.note(f"{state}: {reason}")
        except StoreUnwritableError as error:
            # The evaluations are what counts; the file only goes on calling the run interrupted.
            reason = reason or str(error)
        self._tell("state", state=state, reason=reason)

    # -- the loop --------------------------------------------------------------------------------------------------

    def _search(self) -> None:
        store, settings = self._store, self._case.optimization
        search = TwoLevelSearch(self._case.bounds, settings, self._case.initial.variables, store.seeds)
        search.extend(max(settings.generations, store.generations))
        for number in json.loads(store.value("closings", "[]")):
            search.close(number)
        times = store.generation_times()
        self.snapshot = dataclasses.replace(
            self.snapshot,
            generations=search.generations,
            level=search.level,
            evaluations=self._ledger.counts(),
            predictions=self._ledger.predictions,
            failures=self._ledger.failures,
            elapsed=sum(elapsed for _, elapsed in times),
        )
        self._keep(lambda: store.set_values(state="running", reason=""))
        self._note_versions()
        self._tell("state", state="running", reason="")
        first, second = (FAST, TRUTH) if settings.level1_generations > 0 else (TRUTH, FAST)
        # An even first sample takes a second, in which local workers import their solvers.
        search.ask()
        self._evaluate_initial(first.number, planned=True)
        while True:
            self._extend(search)
            if self._control.stopped and not self._is_known(search):
                raise _StoppedError
            self._close_last(search)
            candidates = search.ask()
            if not candidates:
                break
            self._generation(search, candidates, times)
            if search.number == 1:
                # Only now: the first front shall be seen before the slower level has been compiled and computed.
                needed = first is FAST and settings.level1_generations < search.generations
                self._evaluate_initial(second.number, planned=needed)
        if settings.final_errors:
            self._refine(search.number)

    def _refine(self, generation: int) -> None:
        """Solve the front that is shown and the initial design on a finer mesh, and keep their numbers' errors."""
        last = self._store.generation(generation)
        if self._physics.refine is None or last is None or last.level != TRUTH.number:
            return
        wanted = unrefined(self._store, shown_front(self._store.path, generation))
        if not wanted:
            return
        reference = self._reference(TRUTH.number)
        tasks = [
            (number, Candidate(TRUTH.number, variables, "initial"), reference) for number, variables in wanted.items()
        ]
        refined: dict[int, Mapping[str, Any]] = {}

        def finished(results: Sequence[tuple[int, Candidate, Result]]) -> None:
            refined.update(
                (number, document_of(result.essence, variables_text(candidate.variables)))
                for number, candidate, result in results
            )

        def paused(now: bool) -> None:
            self._change_state("paused" if now else "running", "")

        self._tell("state", reason="the front is solved again, finer, for its errors")
        evaluator = BatchEvaluator(
            self._ready_workers(), self._physics.refine, self._case, self._control, self._lost, self._physics.warm_up
        )
        complete = evaluator.run(tasks, finished, paused)
        self._keep(lambda: keep_errors(self._store, refined))
        if not complete:
            raise _StoppedError

    def _is_known(self, search: TwoLevelSearch) -> bool:
        # A stop during the replay waits for its end: that takes seconds, and the snapshot is then worth something.
        return self._store.generation(search.number + 1) is not None

    def _close_last(self, search: TwoLevelSearch) -> None:
        """With a surface the last generation is solved; the file keeps which one that was, should the run go on."""
        last = search.number + 1
        if not self._case.optimization.surface or last != search.generations:
            return
        closings = json.loads(self._store.value("closings", "[]"))
        if last not in closings:
            self._keep(lambda: self._store.set_values(closings=json.dumps([*closings, last])))
        search.close(last)

    def _extend(self, search: TwoLevelSearch) -> None:
        extension = self._control.take_extension()
        if extension:
            total = search.generations + extension
            self._keep(lambda: self._store.set_values(generations=str(total)))
            search.extend(total)
            self._tell("state", generations=total)

    def _generation(
        self, search: TwoLevelSearch, candidates: tuple[Candidate, ...], times: list[tuple[int, float]]
    ) -> None:
        started = time.monotonic()
        number = search.number + 1
        for surface in {candidate.surface for candidate in candidates} - {0}:
            self._learning.announce(surface)
        numbers: list[int] = []
        missing: list[tuple[int, Candidate]] = []
        for candidate in candidates:
            place, is_new = self._number(candidate)
            numbers.append(place)
            if is_new and not self._ledger.knows(place):
                missing.append((place, candidate))

        def begun() -> None:
            self._catch_up()
            self.snapshot = dataclasses.replace(
                self.snapshot,
                level=candidates[0].level,
                population=len(candidates),
                done=len(candidates) - len(missing),
                seconds_left=self._seconds_left(search, times),
            )

        waited = 0.0
        if missing:
            waited = self._evaluate(missing, number, begun)
        else:
            begun()
        self._ledger.settle(candidates)
        generation = search.tell([self._ledger.outcome(place) for place in numbers])
        self.snapshot = dataclasses.replace(
            self.snapshot,
            generation=number,
            hypervolume=generation.hypervolume,
            feasible_share=generation.feasible_share,
        )
        stored = self._store.generation(number)
        if stored is not None:
            self._compare(stored, generation)
            self._catch_up()
            self._progress()
            return
        elapsed = time.monotonic() - started - waited
        times.append((generation.level, elapsed))
        seconds_left = self._seconds_left(search, times)

        def keep() -> None:
            self._keep(lambda: self._store.record_generation(generation, elapsed))
            self._tell("generation", generation, elapsed=self.snapshot.elapsed + elapsed, seconds_left=seconds_left)

        self._later.append(keep)
        # Where evaluations are quick, workers get their next designs before this is written; else nothing waits.
        quick = self._evaluator is not None and self._evaluator.quick
        if not quick or number == 1 or generation.note or search.finished:
            self._catch_up()
        if generation.note:
            text = f"generation {number}: {generation.note}"
            self._keep(lambda: self._store.note(text))
            self._tell("handover", generation, text=generation.note)

    def _catch_up(self) -> None:
        """Write and tell what was put off until the workers have their next designs."""
        while self._later:
            # What fails is tried again at the end of the run: no generation without its evaluations.
            self._later[0]()
            del self._later[0]

    def _number(self, candidate: Candidate) -> tuple[int, bool]:
        """The design's number, and whether it appears for the first time."""
        try:
            return self._ledger.number(candidate)
        except DivergedError as error:
            raise self._diverged(str(error)) from error

    def _compare(self, stored: Generation, replayed: Generation) -> None:
        if stored != replayed:
            raise self._diverged(f"generation {stored.number} comes out different")

    def _diverged(self, what: str) -> InputError:
        made_with = json.loads(self._store.value("versions", "{}"))
        now = software_versions()
        changed = [f"{name} {old}, now {now.get(name)}" for name, old in made_with.items() if now.get(name) != old]
        because = "it was made with " + "; ".join(changed) if changed else "its content was changed"
        return InputError(
            f"{self._store.path}: cannot be continued to the same bits ({what}): {because}; "
            "read it as it is, or start a new run from its front"
        )

    def _note_versions(self) -> None:
        made_with, now = json.loads(self._store.value("versions", "{}")), software_versions()
        if made_with != now and len(self._ledger):
            text = f"continued with other versions: {json.dumps(now)}"
            self._keep(lambda: self._store.note(text))

    # -- evaluations -----------------------------------------------------------------------------------------------

    def _evaluate(
        self, missing: list[tuple[int, Candidate]], generation: int, begun: Callable[[], None] | None = None
    ) -> float:
        """Evaluate designs and store each as it finishes; of quick ones a generation's last wait for ``_catch_up``.

        Args:
            missing: the designs with their numbers.
            generation: that asks for them; 0 for the initial design.
            begun: as of ``BatchEvaluator.run``; ``_catch_up`` by default.

        Returns:
            Seconds spent waiting for people or disks.
        """
        self._waited = 0.0
        left = len(missing)

        def finished(results: Sequence[tuple[int, Candidate, Result]]) -> None:
            nonlocal left
            left -= len(results)
            self._note_results(results)
            if generation > 0 and left == 0 and evaluator.quick:
                self._later.append(lambda: self._record(results, generation))
            else:
                self._record(results, generation)

        def paused(now: bool) -> None:
            self._waited += -time.monotonic() if now else time.monotonic()
            self._change_state("paused" if now else "running", "")

        tasks = [(number, candidate, self._reference_of(candidate)) for number, candidate in missing]
        workers = self._ready_workers()
        evaluator = self._evaluator = self._evaluator or BatchEvaluator(
            workers, self._physics.evaluate, self._case, self._control, self._lost, self._physics.warm_up
        )
        if not evaluator.run(tasks, finished, paused, begun or self._catch_up):
            raise _StoppedError
        self._note_workers(workers)
        return self._waited

    def _lost(self, reason: str) -> None:
        """The workers cannot be reached, and "" when they can again."""
        self._waited += -time.monotonic() if reason else time.monotonic()
        text = f"{reason}; the run goes on when it does, or stop it" if reason else ""
        self._change_state("paused" if reason else "running", text)

    def _note_workers(self, workers: Workers) -> None:
        """In the journal: with which versions other machines computed."""
        fresh = {name: versions for name, versions in workers.versions.items() if name not in self._noted}
        if fresh:
            self._noted.update(fresh)
            text = (
                f"evaluated by {len(fresh)} workers of {workers.description}: {json.dumps(next(iter(fresh.values())))}"
            )
            self._keep(lambda: self._store.note(text))

    def _note_results(self, results: Sequence[tuple[int, Candidate, Result]]) -> None:
        """Know what came in together."""
        counts = list(self.snapshot.evaluations)
        for number, candidate, result in results:
            self._ledger.record(number, candidate, dataclasses.replace(result.outcome, evaluation_id=number))
            counts[LEVELS.index(level_of(candidate.level))] += 1
        outcomes = [result.outcome for _, _, result in results]
        self.snapshot = dataclasses.replace(
            self.snapshot,
            done=self.snapshot.done + len(outcomes),
            evaluations=(counts[0], counts[1]),
            predictions=self.snapshot.predictions + sum(outcome.predicted for outcome in outcomes),
            failures=self.snapshot.failures + sum(outcome.failed for outcome in outcomes),
        )

    def _record(self, results: Sequence[tuple[int, Candidate, Result]], generation: int) -> None:
        """Keep what came in together, and tell of it."""
        started = time.monotonic()
        try:
            self._store.record_evaluations(results, generation)
        except StoreUnwritableError as error:
            self._keep(lambda: self._store.record_evaluations(results, generation), error)
            self._waited += time.monotonic() - started
        for number, _, result in results:
            if result.outcome.failed:
                self._tell("failure", evaluation_id=number, text=f"{result.stage}: {result.reason}")
        self._progress()

    def _evaluate_initial(self, level: int, planned: bool) -> None:
        """The initial design, at both levels, whether or not a population holds it."""
        variables = self._case.initial.variables
        candidate = Candidate(level, variables, "initial")
        self._number(candidate)
        if not self._ledger.knows(initial_id(level)):
            try:
                self._reference(level)
            except InputError as error:
                if planned:
                    raise
                # No generation needs this level; that it cannot be computed is worth a record, not the run.
                result = failure(self._case, variables, level, "reference", str(error), 0.0)
                self._note_results([(level, candidate, result)])
                self._record([(level, candidate, result)], 0)
            else:
                self._evaluate([(level, candidate)], 0)
        if self._ledger.outcome(initial_id(level)).failed and planned:
            raise InputError(
                f"{self._case.name}: the initial design, by which everything is normalised, fails at level {level} "
                f"({self._store.failure_of(level)}); change [initial] and choose another run file"
            )

    def _reference_of(self, candidate: Candidate) -> Any:
        """What a design is evaluated with: with a surface, what that has learnt too."""
        plain = self._reference(candidate.level)
        if candidate.surface:
            self._catch_up()  # what is learnt from stands in the file
            begins_fast = self._case.optimization.level1_generations > 0
            fast = self._reference(FAST.number) if begins_fast else None
            return self._learning.reference(candidate.surface, plain, fast, self._keep)
        if candidate.level == FAST.number and candidate.origin != "initial":
            return self._searching
        return plain

    @cached_property
    def _searching(self) -> Any:
        """Level 1's reference for the designs of the search; the initial one, which normalises all, is solved."""
        plain, searching = self._reference(FAST.number), self._physics.searching
        return plain if searching is None else searching(self._case, plain)

    def _reference(self, level: int) -> Any:
        if level not in self._references:
            text = self._store.reference(level)
            if text is None:
                constants = self._case.constants
                if level == FAST.number and constants.wave_calibration == "learnt":
                    # Some twenty seconds where what is learnt is not shipped.
                    self._tell(
                        "state", reason=f"level 1 learns from {constants.wave_calibration_hulls} hulls of level 2"
                    )
                elif level != FAST.number:
                    self._tell("state", reason=f"solving the initial design at level {level}")
                try:
                    text = self._computed_reference(level)
                finally:
                    # also where it cannot be computed and the run goes on without it
                    self._tell("state", reason="")
                stored = text
                self._keep(lambda: self._store.record_reference(level, stored))
            # Also a fresh one goes through its text: a resumed run has nothing else.
            data = json.loads(text)
            self._references[level] = None if data is None else self._physics.reference_from_dict(data)
        return self._references[level]

    def _computed_reference(self, level: int) -> str:
        """Computed by a worker like everything else: with one BLAS thread, and a crash there is not ours."""
        for _ in range(_REFERENCE_TRIES):
            workers = self._ready_workers()
            try:
                future = workers.submit(reference_task, self._physics.reference_for, self._case, level)
                while not concurrent.futures.wait([future], timeout=_EVENT_INTERVAL).done:
                    if self._control.stopped:
                        raise _StoppedError
                    # a result that was under way when a cluster's scheduler died is never done
                    workers.look()
                done, text = future.result()
                if done:
                    return str(text)
                raise InputError(f"{self._case.name}: {text}, and choose another run file")
            except (concurrent.futures.BrokenExecutor, concurrent.futures.CancelledError):
                # Killed by the system, maybe, and not by the design: the same again decides.
                if self._control.stopped:
                    raise _StoppedError from None
                try:
                    workers.reach()
                except WorkersLostError as error:
                    reconnect(workers, self._control, self._lost, str(error))
            except WorkersLostError as error:
                reconnect(workers, self._control, self._lost, str(error))
        raise InputError(
            f"{self._case.name}: the initial design cannot be computed at level {level}: {_REFERENCE_TRIES} worker "
            "processes died over it; is there memory enough? The same command tries again"
        )

    def _ready_workers(self) -> Workers:
        if self._workers is None:
            self._workers = self._make_workers()
            self._tell("state", workers=self._workers.description)
        return self._workers

    # -- telling and keeping ---------------------------------------------------------------------------------------

    def _keep(self, write: Callable[[], _T], error: StoreUnwritableError | None = None) -> _T:
        """Write to the file; while it cannot be written the run is paused with the reason and tries again."""
        if error is None:
            try:
                return write()
            except StoreUnwritableError as first:
                error = first
        while True:
            self._tell("state", state="paused", reason=f"{error}; goes on when it can be written again")
            self._control.wait(_RETRY_INTERVAL)
            if self._control.stopped:
                raise _StoppedError
            try:
                result = write()
            except StoreUnwritableError as again:
                error = again
                continue
            self._tell("state", state="running", reason="")
            return result

    def _change_state(self, state: State, reason: str) -> None:
        self._keep(lambda: self._store.set_values(state=state, reason=reason))
        self._tell("state", state=state, reason=reason)

    def _progress(self) -> None:
        now = time.monotonic()
        if now - self._last_event >= _EVENT_INTERVAL:
            self._last_event = now
            self._tell("evaluation")

    def _tell(
        self,
        kind: Any,
        generation: Generation | None = None,
        evaluation_id: int | None = None,
        text: str = "",
        **changes: Any,
    ) -> None:
        if changes:
            if kind == "state" and all(getattr(self.snapshot, name) == value for name, value in changes.items()):
                return
            self.snapshot = dataclasses.replace(self.snapshot, **changes)
        self._emit(RunEvent(kind, self.snapshot, generation, evaluation_id, text))

    def _seconds_left(self, search: TwoLevelSearch, times: list[tuple[int, float]]) -> float | None:
        settings = self._case.optimization
        left = search.generations - search.number
        at_level1 = 0
        if level_of(search.level) is FAST:
            level1 = settings.level1_generations
            only_level1 = level1 >= settings.generations
            at_level1 = left if only_level1 else max(0, level1 - search.number)
        seconds = 0.0
        for level, count in ((FAST, at_level1), (TRUTH, left - at_level1)):
            if count == 0:
                continue
            known = [elapsed for known_level, elapsed in times if known_level == level.number]
            recent = known[-_RECENT:]
            estimate = self._level2_estimate() if level is TRUTH else None
            if estimate is not None and settings.surface:
                seconds += level2_seconds(settings, count, estimate / settings.population, known)
            elif recent:
                seconds += count * sum(recent) / len(recent)
            elif estimate is not None:
                seconds += count * estimate
            else:
                return None
        return seconds

    def _level2_estimate(self) -> float | None:
        """Seconds a generation at level 2, before there is one."""
        if self._level2_seconds is None and self._workers is not None:
            elapsed = self._store.elapsed_of(initial_id(TRUTH.number))
            if elapsed is not None:
                typical = max(elapsed, _LEVEL2_SECONDS)
                self._level2_seconds = typical * self._case.optimization.population / self._workers.slots
        return self._level2_seconds
