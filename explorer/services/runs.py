"""The run on display and the folder of runs: start, open, control, extend, keep a design, delete."""

from __future__ import annotations

import threading
import time
from pathlib import Path

from explorer.server.worker import LatestWorker
from explorer.services.designs import Designs
from explorer.services.display import Display
from explorer.services.library import LibraryEntry, RunLibrary
from explorer.services.reports import run_report
from explorer.services.run_keeper import RunKeeper
from explorer.services.run_labels import RunLabel
from explorer.state.run_picture import ACTIVE, FAILED, IDLE, STARTING, STOPPING, RunPicture
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.runs.executor import default_workers

# between two pictures of a run: what eyes need; and on a busy machine a rest of so many times what it took to make and
# draw the last one, in which a press is answered at once; drawing is waited for so long at most
_PICTURE_SECONDS, _PICTURE_REST, _DRAWN_SECONDS = 0.25, 3.0, 1.0
# reading a large run waits for gestures, so long for one and so long for all of them
_WAY_SECONDS, _PATIENCE_SECONDS = 0.2, 10.0
# after a browser has said hello its page is put up for so long; who lets no browser come has waited long enough then
_PUT_UP_SECONDS, _NOBODY_SECONDS = 1.5, 10.0


class Runs:
    """One run on display, and the folder that it and others lie in.

    Args:
        display: shows what changes.
        designs: told where to read a run's designs from.
        library: the user's runs.
        workers: local processes of a run; all cores by default.
    """

    def __init__(self, display: Display, designs: Designs, library: RunLibrary, workers: int | None = None) -> None:
        self._display = display
        self._designs = designs
        self._library = library
        self._workers = workers
        self._keeper: RunKeeper | None = None
        self._guard = threading.RLock()
        self._pictures = LatestWorker("pictures")
        self._rested = 0.0
        self._turned = threading.Event()
        self._standing: tuple[object, ...] = ()
        self._quiet_until = 0.0
        self._awaited = threading.Event()

    def await_browser(self) -> None:
        """A browser is about to come: news of the run wait until its page stands, or until nobody has come.

        What makes a large run's second picture would take one of a small machine's cores just while it loads.
        """
        self._quiet_until = time.monotonic() + _NOBODY_SECONDS

    def browser_came(self) -> None:
        """A browser has said hello: its page stands in a moment."""
        if self._quiet_until:
            self._quiet_until = min(self._quiet_until, time.monotonic() + _PUT_UP_SECONDS)
            self._awaited.set()

    def _wait_for_page(self) -> None:
        if self._awaited.wait(self._quiet_until - time.monotonic()):
            time.sleep(max(self._quiet_until - time.monotonic(), 0.0))
        self._quiet_until = 0.0

    def add_by_hand(self, evaluation: Evaluation) -> int:
        """Keep a hand-made design in the run's archive.

        Raises:
            InputError: there is no run that can be written.
        """
        with self._guard:
            keeper = self._keeper
            if keeper is None:
                raise InputError("there is no run yet; press Start first")
            design_id = keeper.add_by_hand(evaluation)
            self._display.show_run(keeper.picture(), self._designs.first)
            return design_id

    def can_add_by_hand(self) -> bool:
        """Whether the run on display can keep a hand-made design."""
        return self._keeper is not None and self._keeper.writable

    def keep_errors(self, design_id: int, evaluation: Evaluation) -> None:
        """Keep a design's errors in the run's file, where it rests and can be written."""
        keeper = self._keeper
        if keeper is not None:
            keeper.keep_errors(design_id, evaluation)

    def start(self) -> None:
        """Start a new run of the case as set up.

        Raises:
            InputError: the settings do not make a case, or another run is being driven.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven:
                raise InputError("a run is under way; stop it first")
            case = self._display.drafted()
            if not case.bounds.free:
                raise InputError("bounds: every variable is fixed; give at least one a range")
            path = self._library.new_path(case.name)
            keeper = RunKeeper(path, self.news, case, self._workers, before=self._keeper)
            self._show(keeper)
            keeper.start()

    def open(self, path: Path, read_only: bool = False) -> None:
        """Show a run file.

        Raises:
            InputError: no run file.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven and self._keeper.path != path:
                raise InputError("a run is under way; stop it before you open another")
            self._show(RunKeeper(path, self.news, None, self._workers, read_only, before=self._keeper))

    def open_named(self, name: str) -> None:
        """Show a run of the library.

        Raises:
            InputError: there is none of that name.
        """
        path = self._library.path(name)
        if path is None:
            raise InputError(f"{name[:60]}: no such run in the folder")
        self.open(path, read_only=self._library.is_shipped(path))

    def continue_named(self, name: str) -> None:
        """Show a run of the library and go on with it.

        Raises:
            InputError: there is none of that name, or it cannot be driven.
        """
        self.open_named(name)
        self.control("continue")

    def _show(self, keeper: RunKeeper) -> None:
        try:
            picture = keeper.picture()
        except HpsopError as error:
            # Damaged further in than its first look: what is on display stays.
            keeper.close()
            self._library.refuse(keeper.path, str(error))
            raise
        old, self._keeper = self._keeper, keeper
        # the rest was earned by pictures of another run
        self._rested = 0.0
        self._turned.set()
        self._designs.read_from(keeper)
        if old is not None:
            old.close()
        self._display.show_run(picture, self._designs.best)
        self._display.tell_all("library")

    def news(self) -> None:
        """Something of the run changed: make a new picture soon."""
        self._pictures.latest("picture", self._refresh)

    def _refresh(self) -> None:
        if self._quiet_until:
            self._wait_for_page()
        # A search tells of every evaluation; eyes need a few pictures a second.
        pause = self._rested - time.monotonic()
        if pause > 0.0:
            self._turned.wait(pause)
        self._turned.clear()
        keeper = self._keeper
        if keeper is None:
            return
        # Without the guard: who opens another run need not wait until this one has been read to its end.
        patience = time.monotonic() + _PATIENCE_SECONDS
        keeper.read_ahead(lambda: self._display.make_way(min(_WAY_SECONDS, max(patience - time.monotonic(), 0.0))))
        # Under the guard: between a run's picture and its display no other run must come on display.
        with self._guard:
            if self._keeper is not keeper:
                return
            began = time.monotonic()
            picture = keeper.picture()
            self._display.show_run(picture, self._designs.first)
        self._display.wait_until_drawn(_DRAWN_SECONDS)
        ended = time.monotonic()
        self._rested = max(began + _PICTURE_SECONDS, ended + _PICTURE_REST * (ended - began))
        # the library says what may be deleted and continued: that changes too when the file is given back
        standing = (picture.name, picture.status, keeper.holds_file)
        if standing != self._standing:
            self._standing = standing
            self._display.tell_all("library")

    def draft_changed(self) -> None:
        """While no run is on display, the page shows the case as it is being set up."""
        with self._guard:
            if self._keeper is not None:
                return
            try:
                case = self._display.drafted()
            except InputError:
                return
            if case != self._display.picture.case:
                self._display.show_run(RunPicture("", case), self._designs.first)

    def close_run(self) -> None:
        """Back to the set-up, with no run on display.

        Raises:
            InputError: the run is under way.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven:
                raise InputError("a run is under way; stop it first")
            if self._keeper is not None:
                self._keeper.close()
            self._keeper = None
            self._designs.read_from(None)
            self._display.show_run(RunPicture("", self._display.drafted()), self._designs.first)
        self._display.tell_all("library")

    def control(self, what: str) -> None:
        """pause, resume, stop or continue.

        Raises:
            InputError: it cannot be done; the text says why.
        """
        keeper = self._keeper
        if keeper is None:
            raise InputError("there is no run")
        {"pause": keeper.pause, "resume": keeper.resume, "stop": keeper.stop, "continue": keeper.start}[what]()

    def extend(self, generations: int) -> None:
        """More generations.

        Raises:
            InputError: there is no run, or it cannot be written.
        """
        if self._keeper is None:
            raise InputError("there is no run")
        self._keeper.extend(generations)

    @property
    def workers(self) -> int:
        """Processes of the next run."""
        return self._workers or default_workers()

    def set_workers(self, count: object) -> None:
        """Processes of the next run.

        Raises:
            InputError: not a whole number from 1 to 64.
        """
        if isinstance(count, bool) or not isinstance(count, int | float) or not 1 <= count <= 64 or count != int(count):
            raise InputError("workers: give a whole number from 1 to 64")
        self._workers = int(count)

    def can_continue(self) -> bool:
        """Whether the run on display has generations left and can be driven."""
        keeper, picture = self._keeper, self._display.picture
        if keeper is None or not keeper.writable:
            return False
        return picture.status not in ACTIVE and len(picture.generations) < picture.total_generations

    def can_extend(self) -> bool:
        """Whether the run on display can be asked for more generations."""
        ended = self._display.picture.status in (STARTING, STOPPING, FAILED, IDLE)
        return self._keeper is not None and self._keeper.writable and not ended

    def part_of_generation(self) -> float:
        """How much of the generation under way is done."""
        return self._keeper.part_of_generation() if self._keeper is not None else 0.0

    def library(self) -> list[LibraryEntry]:
        """The user's runs."""
        return self._library.entries()

    def delete(self, name: str) -> None:
        """Delete a run of the library for good.

        Raises:
            InputError: it is on display, being written, or not there.
        """
        if self._keeper is not None and self._keeper.path == self._library.path(name):
            self.close_run()
        self._library.delete(name)

    def label(self) -> RunLabel:
        """What people call the run on display."""
        return self._library.labels.of(self._display.picture.name)

    def relabel(self, run: str, name: str | None = None, note: str | None = None) -> None:
        """Give a run of the library another name or note.

        Raises:
            InputError: there is no such run.
        """
        if self._library.path(run) is None:
            raise InputError(f"{run[:60]}: no such run in the folder")
        self._library.labels.write(run, name, note)
        self._display.tell_all("library")

    def report(self) -> tuple[str, bytes]:
        """A name for the file, and the report of the run on display as it is now; takes seconds.

        Raises:
            InputError: there is no run, or it cannot be made.
        """
        keeper = self._keeper
        if keeper is None:
            raise InputError("report: there is no run yet; press Start first")
        keeper.check_file()
        content = run_report(keeper.path)
        # its process has opened whatever stood there
        keeper.check_file()
        return f"{keeper.path.stem}-report.html", content

    def folder_text(self) -> str:
        """The folder, for people."""
        return str(self._library.folder)

    def close(self) -> None:
        """Leave no process behind."""
        self._pictures.close()
        if self._keeper is not None:
            self._keeper.close()
