"""A run in the hands of a person: start, pause, resume, stop, extend, and events for a page or a progress bar."""

from __future__ import annotations

import atexit
import logging
import threading
import weakref
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.runs.control import RunControl
from hpsop_core.runs.events import RunEvent, RunSnapshot
from hpsop_core.runs.executor import LocalWorkers, checked_executor, make_workers
from hpsop_core.runs.reader import RunReader, open_run
from hpsop_core.runs.records import MOST_GENERATIONS
from hpsop_core.runs.ship import is_same_ship
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import Physics, hydrodynamics

if TYPE_CHECKING:
    from hpsop_core.runs.replay import RunDriver

_log = logging.getLogger(__name__)

# Settings that decide a run's bits: they may be stated again when it is continued, not changed.
_FIXED_SETTINGS = ("population", "seed", "level1_generations")


class RunController:
    """Holds one run file open for writing and drives it in a thread of its own.

    A file that does not exist (or is empty) is begun with the case; one that exists is continued, and a case or
    settings given with it must be the ones that it was begun with; ``generations`` may be greater than before.

    Args:
        run_path: the run file.
        case: what to optimise; may be left away for an existing run.
        generations, level1_generations, population, seed: instead of the case's own.
        workers: local processes; all cores by default.
        executor: "local" or "dask:HOST:PORT".
        seeds: designs to start a new run from (see ``front_designs``).
        physics: how designs are evaluated; the hydrodynamics by default.

    Raises:
        InputError: the file is being written by someone else, is no run file, or holds another run than asked for.
    """

    def __init__(
        self,
        run_path: str | Path,
        case: Case | None = None,
        *,
        generations: int | None = None,
        level1_generations: int | None = None,
        population: int | None = None,
        seed: int | None = None,
        workers: int | None = None,
        executor: str = "local",
        seeds: Sequence[DesignVariables] = (),
        physics: Physics | None = None,
    ) -> None:
        self.path = Path(run_path)
        checked_executor(executor, workers)
        self._workers, self._executor = workers, executor
        self._physics = physics
        self._control = RunControl()
        self._callbacks: list[Callable[[RunEvent], None]] = []
        self._guard = threading.RLock()
        self._thread: threading.Thread | None = None
        # Not Thread.join: an interrupt in the middle of it makes Python 3.11 believe that the thread has ended.
        self._ended = threading.Event()
        self._ended.set()
        self._driver: RunDriver | None = None
        self._error: BaseException | None = None
        asked = {
            "generations": generations,
            "level1_generations": level1_generations,
            "population": population,
            "seed": seed,
        }
        changes = {name: value for name, value in asked.items() if value is not None}
        planned = None if case is None else planned_case(case, changes)
        self._store = RunStore(self.path, planned, seeds)
        if not self._store.created:
            try:
                self._check(case, changes)
            except HpsopError:
                self._store.close()
                raise
        _open_controllers.add(self)

    def _check(self, case: Case | None, changes: Mapping[str, int]) -> None:
        stored = self._store.case
        if case is not None and not is_same_ship(case.replaced("optimization", **_settings(stored)), stored):
            aboard = (
                " with the files that it holds; 'Continue' on the page goes on with those" if self._store.files else ""
            )
            raise InputError(
                f"{self.path}: holds a run of the case '{stored.name}' as it was when the run was started{aboard}; "
                "give that case again, or choose another file"
            )
        for name in _FIXED_SETTINGS:
            was = getattr(stored.optimization, name)
            if name in changes and changes[name] != was:
                raise InputError(
                    f"{self.path}: was started with {name} = {was}, not {changes[name]}; "
                    "leave it away or choose another file"
                )
        total, asked = self._store.generations, changes.get("generations")
        if asked is not None and asked < total:
            raise InputError(f"{self.path}: was asked for {total} generations; ask for as many or more, not {asked}")
        if asked is not None and asked > total:
            self._check_total(asked)
            self._store.set_values(generations=str(asked))

    def _check_total(self, total: int) -> None:
        """A run never asks for more generations than a case may state.

        Raises:
            InputError: it would.
        """
        if total > MOST_GENERATIONS:
            raise InputError(
                f"{self.path}: {total} generations in total are more than {MOST_GENERATIONS}, the most of a run; "
                "start a new run from its front (--seeds-from)"
            )

    # -- what a person asks for ------------------------------------------------------------------------------------

    @property
    def case(self) -> Case:
        """The run's exact case."""
        return self._store.case

    def start(self) -> None:
        """Start, or start again after a stop or the end; resume if it is paused."""
        with self._guard:
            if self.running:
                self._control.resume()
                return
            self._control = RunControl()
            self._error = None
            self._ended.clear()
            self._thread = threading.Thread(target=self._drive, args=(self._control,), name="hpsop-run", daemon=True)
            self._thread.start()

    def _drive(self, control: RunControl) -> None:
        try:
            if self._executor == "local":
                LocalWorkers.prepare()
            # The algorithm's imports take a second, in which the fork server does its own.
            from hpsop_core.runs.replay import RunDriver

            physics = self._physics or hydrodynamics()
            workers = partial(make_workers, self._executor, self._workers, control)
            self._driver = RunDriver(self._store, physics, workers, control, self._emit)
            self._driver.run()
        except HpsopError as error:
            self._error = error
        except Exception as error:  # noqa: BLE001 - raised again by wait(), in the thread that wants to know
            self._error = error
            _log.exception("the run ended by an error of the program")
        finally:
            self._ended.set()

    def pause(self) -> None:
        """Start no more evaluations; those under way finish and are kept. Acts within one evaluation."""
        self._control.pause()

    def resume(self) -> None:
        """Go on after a pause."""
        self._control.resume()

    def stop(self) -> None:
        """End the run; ``start`` or the same command goes on later. Acts within one evaluation (3 s at most)."""
        self._control.stop()

    def extend(self, generations: int) -> None:
        """Ask for so many more generations; start it again if it had ended.

        Raises:
            InputError: not a positive number, or more in total than a run may have.
            StoreUnwritableError: the run stands still and its file cannot be written.
        """
        if generations < 1:
            raise InputError(f"extend by {generations} generations: give 1 or more")
        with self._guard:
            if self.running:
                # What was asked a moment ago and is not in the file yet counts too.
                self._check_total(self._store.generations + self._control.extension + generations)
                self._control.extend(generations)
            else:
                self._check_total(self._store.generations + generations)
                self._store.set_values(generations=str(self._store.generations + generations))

    def add_design(self, evaluation: Evaluation) -> int:
        """Keep a design that a person made in the run's file; it never enters the search.

        Returns:
            Its id.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        return self._store.record_by_hand(evaluation)

    def wait(self, seconds: float | None = None) -> bool:
        """Wait for the run to end.

        Returns:
            Whether it has.

        Raises:
            HpsopError: why it ended before its end; whatever else went wrong in it.
        """
        if not self._ended.wait(seconds):
            return False
        if self._error is not None:
            raise self._error
        return True

    def close(self) -> None:
        """Stop, wait for what is under way, and give the file back. No process is left behind."""
        _open_controllers.discard(self)
        self._control.stop()
        if threading.current_thread() is not self._thread:
            self._ended.wait()
        self._store.close()

    def __enter__(self) -> RunController:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    # -- what it tells ---------------------------------------------------------------------------------------------

    @property
    def begun(self) -> bool:
        """Whether this controller began the run, rather than continuing it."""
        return self._store.created

    @property
    def running(self) -> bool:
        """Whether the run is being driven (pauses included)."""
        return not self._ended.is_set()

    @property
    def error(self) -> BaseException | None:
        """Why the run ended before its end, if it did."""
        return self._error

    def snapshot(self) -> RunSnapshot:
        """Where the run stands."""
        driver = self._driver
        return RunSnapshot(generations=self._store.generations) if driver is None else driver.snapshot

    def subscribe(self, callback: Callable[[RunEvent], None]) -> Callable[[], None]:
        """Receive the run's events in the thread that drives it; be quick, and hand longer work to another thread.

        Returns:
            A function that ends the subscription.
        """
        with self._guard:
            self._callbacks.append(callback)

        def unsubscribe() -> None:
            with self._guard:
                if callback in self._callbacks:
                    self._callbacks.remove(callback)

        return unsubscribe

    def _emit(self, event: RunEvent) -> None:
        with self._guard:
            callbacks = tuple(self._callbacks)
        for callback in callbacks:
            try:
                callback(event)
            except Exception:  # noqa: BLE001 - a page with a defect must not end the run
                _log.exception("a listener failed on the event %s", event.kind)


def planned_case(case: Case, changes: Mapping[str, int]) -> Case:
    """The case with the run's own settings; where only the total changes, level 1 keeps its proportion of it.

    Raises:
        InputError: a refused value.
    """
    settings = dict(changes)
    total = settings.get("generations")
    if total is not None and "level1_generations" not in settings:
        settings["level1_generations"] = proportional_level1(case, total)
    return case.replaced("optimization", **settings) if settings else case


def proportional_level1(case: Case, generations: int) -> int:
    """Level-1 generations of a run of another total, in the case's proportion; neither level it has is lost."""
    own = case.optimization
    share = int(generations * own.level1_generations / own.generations + 0.5)
    if 0 < own.level1_generations < own.generations and generations > 1:
        return min(max(share, 1), generations - 1)
    return share


def front_designs(run_path: str | Path, generation: int | None = None) -> tuple[DesignVariables, ...]:
    """The designs of an old run's front, to seed a new one, with other bounds if you like.

    That of its population: crowding has spread these, and they are no more than a first sample has places.

    Raises:
        InputError: no such run.
    """
    run = open_run(run_path)
    found = run.generation(generation)
    return tuple(record.evaluation.variables for record in run.designs(found.front if found is not None else ()))


def optimize(
    case: Case,
    run_path: str | Path,
    *,
    generations: int | None = None,
    level1_generations: int | None = None,
    population: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    executor: str = "local",
    seeds: Sequence[DesignVariables] = (),
    physics: Physics | None = None,
    progress: Callable[[RunEvent], None] | None = None,
) -> RunReader:
    """Run an optimisation to its end, or go on with one that was interrupted; Ctrl-C keeps all that is finished.

    Args:
        case, run_path, generations, level1_generations, population, seed, workers, executor, seeds, physics: as
            ``RunController``.
        progress: receives the run's events.

    Returns:
        The finished run, for reading.

    Raises:
        InputError: as ``RunController``, or the initial design cannot be computed.
        WorkersUnavailableError: no workers can be had.
    """
    controller = RunController(
        run_path,
        case,
        generations=generations,
        level1_generations=level1_generations,
        population=population,
        seed=seed,
        workers=workers,
        executor=executor,
        seeds=seeds,
        physics=physics,
    )
    with controller:
        if progress is not None:
            controller.subscribe(progress)
        controller.start()
        while not controller.wait(0.5):
            pass
    return open_run(run_path)


def _settings(case: Case) -> dict[str, object]:
    """The optimization settings that a run may be started with instead of its case's own."""
    own = case.optimization
    return {name: getattr(own, name) for name in ("generations", *_FIXED_SETTINGS)}


_open_controllers: weakref.WeakSet[RunController] = weakref.WeakSet()


def _close_all() -> None:
    for controller in list(_open_controllers):
        controller.close()


atexit.register(_close_all)
