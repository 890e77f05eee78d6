"""The run on display: driven by this program, or read from a file that may be written by another one.

It turns what the core tells (a controller's events, a file that grows) into pictures (explorer/state/run_picture.py). A
picture is made on the shared worker, at most a few times a second, from what is new in the file.
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import os
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explorer.state.run_picture import (
    ACTIVE,
    FAILED,
    FINISHED,
    IDLE,
    PAUSED,
    RUNNING,
    STARTING,
    STOPPED,
    STOPPING,
    GenerationPicture,
    RunPicture,
)
from hpsop_core.case.case import Case
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import Quantity, quantities_of_case, variable_quantities
from hpsop_core.runs.controller import RunController
from hpsop_core.runs.events import RunEvent
from hpsop_core.runs.fronts import FrontHistory
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.reader import RunReader, open_run
from hpsop_core.runs.records import ArchivePoint
from hpsop_core.runs.refinement import keep_errors
from hpsop_core.runs.store import RunStore

_STATES = {
    "new": STARTING,
    "running": RUNNING,
    "paused": PAUSED,
    "stopped": STOPPED,
    "finished": FINISHED,
    "failed": FAILED,
    "interrupted": STOPPED,
}
_POLL_SECONDS = 0.7
_LARGE = 1000  # designs from which a run's first picture is one of points alone
_SLICE = 16  # designs that are read between two looks whether something is more urgent: some milliseconds
_openings = itertools.count(1)


class RunKeeper:
    """One run file, its controller if this program drives it, and the arrays read so far.

    Args:
        path: the file.
        on_news: called (from any thread) when ``picture`` would tell something new.
        case, workers: given for a new run.
        read_only: never drive it (the shipped demonstration).
        before: the one that was on display; where it had the same file open, the run on display stays the same.

    Attributes:
        opening: which opening of a run this is (``RunPicture.opening``).
    """

    def __init__(
        self,
        path: Path,
        on_news: Callable[[], None],
        case: Case | None = None,
        workers: int | None = None,
        read_only: bool = False,
        before: RunKeeper | None = None,
    ) -> None:
        self.path = path
        self._on_news = on_news
        self._workers = workers
        self._read_only = read_only
        self._controller: RunController | None = None
        self._reader: RunReader | None = None
        self._stop_asked = False
        self._begun = False
        self._error = ""
        self._trouble = ""
        self._shape = ""
        self._event: RunEvent | None = None
        self._closed = threading.Event()
        self._guard = threading.RLock()
        self._known: set[int] = set()
        self._initials: dict[int, int] = {}
        self._ids = np.zeros(0, dtype=np.int64)
        self._rows = np.zeros((0, 8))
        # by id, as its fronts need them
        self._points: dict[int, ArchivePoint] = {}
        self._fronts = FrontHistory(self._points)
        self._table = np.zeros((0, 0))
        self._quantities: tuple[Quantity, ...] = ()
        self._picture: RunPicture | None = None
        self._started_case = case
        if case is None:
            self._reader = open_run(path)
        else:
            self._controller = RunController(path, case, workers=workers)
            self._controller.subscribe(self._on_event)
        self._file = _identity(path)
        same = before is not None and self._file is not None and before._file == self._file
        self.opening: int = before.opening if before is not None and same else next(_openings)
        self._watcher = threading.Thread(target=self._watch, name="run-watch", daemon=True)
        self._watcher.start()

    # ---- control ---------------------------------------------------------------------------------------------------
    @property
    def case(self) -> Case:
        """What it runs."""
        if self._reader is not None:
            return self._reader.case
        if self._started_case is None:
            raise InputError(f"{self.path}: holds no case")
        return self._started_case

    @property
    def driven(self) -> bool:
        """Whether this program drives it now."""
        return self._controller is not None and self._controller.running

    @property
    def holds_file(self) -> bool:
        """Whether this program keeps others from writing the file."""
        return self._controller is not None

    def start(self) -> None:
        """Start or go on.

        Raises:
            InputError: somebody else writes the file, or it is the read-only demonstration.
        """
        with self._guard:
            controller = self._open_controller()
            self._stop_asked = False
            self._error = ""
            controller.start()
            self._begun = True
        self._on_news()

    def pause(self) -> None:
        """Start no more evaluations."""
        if self._controller is not None:
            self._controller.pause()
            self._on_news()

    def resume(self) -> None:
        """Go on after a pause."""
        if self._controller is not None:
            self._controller.resume()
            self._on_news()

    def stop(self) -> None:
        """End it after the evaluations under way."""
        if self._controller is not None:
            self._stop_asked = True
            self._controller.stop()
            self._on_news()

    def extend(self, generations: int) -> None:
        """More generations; a run that had ended starts again, a paused one stays paused.

        Raises:
            InputError: as ``start``.
        """
        with self._guard:
            controller = self._open_controller()
            controller.extend(generations)
            if controller.running:
                self._on_news()
                return
        self.start()

    def add_by_hand(self, evaluation: Evaluation) -> int:
        """Keep a hand-made design in the file.

        Raises:
            HpsopError: it cannot be written.
        """
        with self._guard:
            controller = self._open_controller()
            number = controller.add_design(evaluation)
            if not controller.running:
                controller.close()
                self._controller = None
        self._on_news()
        return number

    def keep_errors(self, design_id: int, evaluation: Evaluation) -> None:
        """Keep a design's errors in the file; nothing where it is being written, or is the demonstration."""
        with self._guard:
            if self._read_only or self._controller is not None or is_being_written(self.path):
                return
            with contextlib.suppress(HpsopError):
                self.check_file()
                store = RunStore(self.path)
                try:
                    keep_errors(store, {design_id: evaluation.as_dict()})
                finally:
                    store.close()

    @property
    def writable(self) -> bool:
        """Whether hand-made designs and continuation are possible."""
        return not self._read_only and (self._controller is not None or not is_being_written(self.path))

    def part_of_generation(self) -> float:
        """How much of the generation under way is done, 0 to 1."""
        event = self._event
        if event is None or event.snapshot.population < 1 or not self.driven:
            return 0.0
        return min(1.0, event.snapshot.done / event.snapshot.population)

    def close(self) -> None:
        """Stop driving and leave no process behind; the file keeps everything."""
        self._closed.set()
        controller = self._controller
        if controller is not None:
            controller.close()

    # ---- news ------------------------------------------------------------------------------------------------------
    def _on_event(self, event: RunEvent) -> None:
        self._event = event
        self._on_news()

    def _watch(self) -> None:
        self._check_ship()
        last: tuple[object, ...] = ()
        now: tuple[object, ...]
        while not self._closed.wait(_POLL_SECONDS):
            try:
                self._release()
                reader = self._ensure_reader()
                if reader is None:
                    continue
                now = (*reader.progress(), *reader.state())
                self._trouble = ""
            except HpsopError as error:
                # Deleted, renamed, replaced, cut short or damaged while it is on display.
                now = (str(error),)
                self._trouble = str(error) if self._picture is not None else ""
            if now != last:
                last = now
                self._on_news()

    def _check_ship(self) -> None:
        """A run of an earlier version may name a hull file that is gone or changed: its numbers stand alone then."""
        if self._reader is not None:
            try:
                self._reader.check_ship()
            except HpsopError as error:
                self._shape = str(error)
                self._on_news()

    def _release(self) -> None:
        """Give the file back once the run has ended, so that other programs may write it."""
        with self._guard:
            controller = self._controller
            if controller is None or controller.running or not self._begun:
                return
            if controller.error is not None:
                self._error = str(controller.error)
            controller.close()
            self._controller = None
            self._begun = False
            self._event = None
        self._on_news()

    def _open_controller(self) -> RunController:
        if self._read_only:
            raise InputError("the demonstration run is read-only; press Start for a run of your own")
        if self._controller is None:
            self.check_file()
            self._controller = RunController(self.path, workers=self._workers)
            self._controller.subscribe(self._on_event)
        return self._controller

    def check_file(self) -> None:
        """What is driven or written to is the file on display, and none that has come into its place since.

        Raises:
            InputError: it is gone, or another one stands there.
        """
        reader = self._ensure_reader()
        if reader is not None:
            reader.progress()

    def _ensure_reader(self) -> RunReader | None:
        # without the guard, which a picture of a large run holds for seconds: a click must not wait for it
        if self._reader is not None:
            return self._reader
        with self._guard:
            if self._reader is None and self.path.is_file() and self.path.stat().st_size > 0:
                try:
                    self._reader = open_run(self.path)
                except HpsopError:
                    return None
            return self._reader

    # ---- pictures --------------------------------------------------------------------------------------------------
    def evaluation(self, design_id: int) -> Evaluation | None:
        """A design's numbers."""
        reader = self._ensure_reader()
        if reader is None:
            return None
        try:
            return reader.designs([design_id])[0].evaluation
        except HpsopError:
            return None

    def prepare(self, design_ids: Sequence[int]) -> None:
        """Several designs are about to be asked for: read them at once."""
        reader = self._ensure_reader()
        if reader is not None:
            # one that cannot be read is met again when it is asked for by itself
            with contextlib.suppress(HpsopError):
                reader.designs(list(design_ids))

    def reference(self, level: int) -> Reference | None:
        """What normalises at a level, or None while the run does not have it, or not as this version does."""
        reader = self._ensure_reader()
        if reader is None:
            return None
        with contextlib.suppress(HpsopError, KeyError, TypeError, ValueError):
            stored = reader.reference(level)
            return None if stored is None else Reference.from_dict(stored)
        return None

    def initial(self, level: int) -> Evaluation | None:
        """The initial design's numbers at a level, or None while the run does not have them."""
        reader = self._ensure_reader()
        if reader is None:
            return None
        try:
            number = self._initials.get(level)
            # asked for by every view of a design: looked up once, its errors may still come
            record = reader.initial(level) if number is None else reader.designs([number])[0]
        except HpsopError:
            return None
        if record.evaluation.level != level:
            return None
        self._initials[level] = record.id
        return record.evaluation

    def picture(self) -> RunPicture:
        """The run as it is now."""
        with self._guard:
            try:
                return self._make_picture()
            except HpsopError as error:
                if self._picture is None:
                    raise
                # What was read stays on display, with the word why no more comes.
                status = self._picture.status if self.driven else FAILED
                return dataclasses.replace(self._picture, status=status, message=str(error), live=self.driven)

    def _make_picture(self) -> RunPicture:
        reader = self._ensure_reader()
        case = self.case
        if not self._quantities:
            self._quantities = (
                *variable_quantities(case),
                *quantities_of_case(case),
            )
            self._table = np.zeros((0, len(self._quantities)))
        driven = self.driven
        status, message = self._status(reader, driven)
        if reader is None:
            return RunPicture(self.path.name, case, status, message, driven, opening=self.opening)
        finished = reader.generations()
        if self._picture is None and reader.sealed and reader.progress()[1] > _LARGE:
            ids, rows = self._points_alone(reader)
            columns: tuple[str, ...] = ()
            table = np.zeros((len(ids), 0))
            self._on_news()
        else:
            self._read_new(reader)
            ids, rows, table = self._ids, self._rows, self._table
            columns = tuple(quantity.key for quantity in self._quantities)
        for item in finished[len(self._fronts.fronts) :]:
            self._fronts.add(item)
        fronts = self._fronts.fronts
        known = self._picture.generations if self._picture is not None else ()
        generations = known + tuple(
            GenerationPicture(item.number, item.level, item.members, front.ids, front.hypervolume)
            for item, front in zip(finished[len(known) :], fronts[len(known) :], strict=True)
        )
        newest = fronts[-1] if fronts else None
        snapshot = self._event.snapshot if self._event is not None else None
        total = snapshot.generations if snapshot is not None and snapshot.generations else reader.generations_asked()
        if total != case.optimization.generations:
            case = case.replaced("optimization", generations=total)
        elapsed = sum(record.elapsed for record in reader.generation_records())
        self._picture = RunPicture(
            name=self.path.name,
            case=case,
            status=status,
            message=message,
            live=driven,
            ids=ids,
            level=rows[:, 0].astype(np.int64),
            generation=rows[:, 1].astype(np.int64),
            objectives=rows[:, 2:4],
            feasible=rows[:, 4] > 0.5,
            failed=rows[:, 5] > 0.5,
            by_hand=rows[:, 6] > 0.5,
            table=table,
            columns=columns,
            generations=generations,
            compromise=newest.compromise if newest is not None else None,
            knee=newest.knee if newest is not None else None,
            seconds_left=snapshot.seconds_left if snapshot is not None else None,
            elapsed=elapsed,
            predicted=rows[:, 7] > 0.5,
            opening=self.opening,
            comparison=reader.comparison_errors(generations[-1].front) if generations else {},
        )
        return self._picture

    def _points_alone(self, reader: RunReader) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids and rows of a large run's first picture: where each design stands, without its other numbers.

        Those of thousands of designs take a second; they come with the next picture, soon. A damaged record is found
        here already: each has its checksum.
        """
        points = [*reader.archive(), *reader.archive(by_hand=True)]
        self._points.update((point.id, point) for point in points)
        return np.array([point.id for point in points], dtype=np.int64), np.array([_row(point) for point in points])

    def read_ahead(self, make_way: Callable[[], None]) -> None:
        """Read what the next picture will need of a large run, while others may ask for pictures or close this.

        Args:
            make_way: called every few milliseconds: returns when whatever is more urgent has been done.
        """
        with self._guard:
            reader = self._reader
            if reader is None or self._picture is None or self._picture.columns:
                return

        def between() -> None:
            make_way()
            if self._closed.is_set():
                raise _GivenUpError

        with contextlib.suppress(HpsopError, _GivenUpError):
            # what cannot be read is said when the picture is made
            news = self._decoded(reader, between)
            with self._guard:
                self._take(news)

    def _read_new(self, reader: RunReader) -> None:
        self._take(self._decoded(reader, lambda: None))

    def _decoded(self, reader: RunReader, between: Callable[[], None]) -> _News:
        news = _News()
        for point, evaluation in reader.news(self._complete_until(reader), self._known, between):
            if len(news.points) % _SLICE == _SLICE - 1:
                between()
            values = (quantity.value(evaluation) for quantity in self._quantities)
            news.points.append(point)
            news.table.append(np.array([np.nan if value is None else value for value in values], dtype=float))
        return news

    def _take(self, news: _News) -> None:
        # two may have read the same
        fresh = [index for index, point in enumerate(news.points) if point.id not in self._known]
        if not fresh:
            return
        points = [news.points[index] for index in fresh]
        # Not before all of them have been read: a record that cannot be read is met again.
        self._known.update(point.id for point in points)
        self._points.update((point.id, point) for point in points)
        # Fresh arrays each time: a picture that a view still draws from never changes under it.
        ids = np.concatenate([self._ids, np.array([point.id for point in points], dtype=np.int64)])
        order = np.argsort(ids, kind="stable")
        self._ids = ids[order]
        self._rows = np.concatenate([self._rows, np.array([_row(point) for point in points], dtype=float)])[order]
        self._table = np.concatenate([self._table, np.array([news.table[index] for index in fresh])])[order]

    def _complete_until(self, reader: RunReader) -> int:
        """Ids up to here have all been read: those of finished generations that were pictured before."""
        if self._picture is None or not self._known or not self._picture.generations:
            return 0
        finished = self._picture.generations[-1].number
        asked = reader.generation(finished)
        return max(asked.asked) if asked is not None and asked.asked else 0

    def _status(self, reader: RunReader | None, driven: bool) -> tuple[str, str]:
        controller = self._controller
        if controller is not None and driven:
            snapshot = controller.snapshot()
            status = _STATES.get(snapshot.state, RUNNING)
            if self._stop_asked and status in ACTIVE:
                return STOPPING, "waiting for the evaluations under way"
            if status == STARTING:
                return STARTING, "starting the workers and evaluating the initial design"
            return status, snapshot.reason or self._trouble
        if self._error:
            return FAILED, self._error
        if reader is None:
            return IDLE, ""
        state, reason = reader.state()
        if controller is not None and _STATES.get(state, state) in ACTIVE:
            # it is this program that holds the file: the run begins or has just ended, and nobody else drives it
            return STOPPED, reason
        return _STATES.get(state, state), reason or self._shape


class _GivenUpError(Exception):
    """Nobody will see any more what is being read."""


@dataclasses.dataclass
class _News:
    """Designs that have been read, and their rows of the table."""

    points: list[ArchivePoint] = dataclasses.field(default_factory=list)
    table: list[NDArray[np.float64]] = dataclasses.field(default_factory=list)


def _row(point: ArchivePoint) -> list[float]:
    f1, f2 = point.objectives if point.objectives is not None else (np.nan, np.nan)
    flags = (point.feasible, point.objectives is None, point.origin == "hand", point.predicted)
    return [point.level, point.generation, f1, f2, *map(float, flags)]


def _identity(path: Path) -> tuple[int, int] | None:
    """Which file stands there, whatever it is called; a new one in its place is another one."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_dev, status.st_ino
