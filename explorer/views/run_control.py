"""Buttons for what all browsers share (run, library, settings): pressed in one, told to the others."""

from __future__ import annotations

from collections.abc import Callable

from explorer.server.bridge import PageEvent
from explorer.services.runs import Runs
from explorer.state.session import Session
from explorer.views.settings_fields import in_words
from hpsop_core.case.variables import SEARCH_TABLE, interchangeable
from hpsop_core.errors import HpsopError, InputError


class RunControl:
    """Answers run_* and library buttons of one browser on the shared thread."""

    def __init__(self, session: Session, runs: Runs) -> None:
        self._session = session
        self._app = session.app
        self._runs = runs
        actions: tuple[tuple[str, Callable[[PageEvent], None], str], ...] = (
            ("run_start", lambda event: runs.start(), "started a run"),
            ("run_pause", lambda event: runs.control("pause"), "paused the run"),
            ("run_resume", lambda event: runs.control("resume"), "resumed the run"),
            ("run_stop", lambda event: runs.control("stop"), "stopped the run"),
            ("run_continue", lambda event: runs.control("continue"), "continued the run"),
            ("run_extend", lambda event: runs.extend(_count(event.arg)), "extended the run"),
            ("delete_run", lambda event: self._app.ask_to_delete(event.arg), ""),
            ("delete_no", lambda event: self._app.ask_to_delete(""), ""),
            ("delete_yes", lambda event: self._delete(event.arg), "deleted a run"),
            ("rename_run", lambda event: self._app.rename(event.arg), ""),
            ("run_name", lambda event: self._label(event.arg, "name"), ""),
            ("run_note", lambda event: self._label(event.arg, "note"), ""),
            ("adopt", lambda event: self._adopt(), "took the shown run's settings over"),
            ("reset_field", lambda event: self._reset(event.arg), ""),
            ("undo", lambda event: self._turn(back=True), ""),
            ("redo", lambda event: self._turn(back=False), ""),
            ("widen", lambda event: self._widen(event.arg), ""),
            ("bound", lambda event: self._bound(event.arg), ""),
            ("search_by", lambda event: self._search_by(event.arg), ""),
        )
        for name, action, told in actions:
            session.gestures.on("act", name, self._guarded(action, told))
        for name, show, told in (
            ("open_run", runs.open_named, "opened another run"),
            ("continue_run", runs.continue_named, "continued a run"),
        ):
            session.gestures.on("act", name, self._opening(self._guarded(self._opened(show), told)))

    def _guarded(self, action: Callable[[PageEvent], None], told: str) -> Callable[[PageEvent], None]:
        def run(event: PageEvent) -> None:
            try:
                action(event)
            except HpsopError as error:
                self._session.notify("Not done", in_words(str(error)), "red")
                return
            if told:
                self._app.did(self._session, told)

        return lambda event: self._app.worker.every(lambda: run(event))

    def _opening(self, guarded: Callable[[PageEvent], None]) -> Callable[[PageEvent], None]:
        """Says at once that another run is on its way: a large one takes a second, and a busy machine more."""

        def begin(event: PageEvent) -> None:
            self._app.expect(event.arg)
            guarded(event)

        return begin

    def _opened(self, action: Callable[[str], None]) -> Callable[[PageEvent], None]:
        def run(event: PageEvent) -> None:
            try:
                action(event.arg)
            finally:
                self._app.expect("")

        return run

    def _adopt(self) -> None:
        case = self._app.picture.case
        self._app.change_draft(lambda draft: draft.begin(case), whole=True)

    def _reset(self, argument: str) -> None:
        section, _, name = argument.partition(".")
        if self._app.draft.changed(section, name):
            self._app.change_draft(lambda draft: draft.reset(section, name), whole=True)

    def _turn(self, back: bool) -> None:
        if not self._app.turn_draft(back):
            raise InputError(f"settings: no change to {'take back' if back else 'make again'}")

    def _widen(self, argument: str) -> None:
        """Move a bound out by a quarter of its range: "length_to_breadth.upper"."""
        name, _, side = argument.partition(".")
        if name not in self._app.draft.searched() or side not in ("lower", "upper"):
            raise InputError(f"widen: {argument[:40]!r} is no bound")
        self._app.change_draft(lambda draft: draft.widen(name, side), whole=True)

    def _search_by(self, name: str) -> None:
        """Search a variable instead of its stand-in, or the other way round."""
        if name not in interchangeable(name):
            raise InputError(f"bounds: {name[:40]!r} has nothing that could stand in for it")
        self._app.change_draft(lambda draft: draft.search_by(name), whole=True)

    def _bound(self, argument: str) -> None:
        """A bound typed into its box: "length_to_breadth.upper=8.2", in SI units."""
        place, _, text = argument.partition("=")
        name, _, side = place.partition(".")
        if name not in self._app.draft.searched() or side not in ("lower", "upper"):
            raise InputError(f"bounds: {place[:40]!r} is no bound")
        try:
            value = SEARCH_TABLE[name].from_shown(float(text))
            self._app.change_draft(lambda draft: draft.set_bound(name, side, value))
        except ValueError:
            raise InputError(f"{SEARCH_TABLE[name].symbol}: {text[:20]!r} is no number; write one as 8.2") from None
        finally:
            # the slider follows the box, and a refused box its slider
            self._app.show_settings()

    def _label(self, argument: str, what: str) -> None:
        """A name or note typed into its box: "RUN.hpsop=words"."""
        run, _, words = argument.partition("=")
        self._runs.relabel(run, **{what: words})

    def _delete(self, name: str) -> None:
        if self._app.asked_to_delete != name:
            return
        try:
            self._runs.delete(name)
        finally:
            self._app.ask_to_delete("")


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= len(text) <= 5 or int(text) < 1:
        raise InputError(f"extend by {text[:20]!r} generations: give a whole number from 1 to 99999")
    return int(text)
