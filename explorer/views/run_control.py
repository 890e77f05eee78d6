"""Buttons for what all browsers share (run, library, settings): pressed in one, told to the others."""

from __future__ import annotations

from collections.abc import Callable

from explorer.server.bridge import PageEvent
from explorer.state.session import Session
from hpsop_core.errors import HpsopError, InputError


class RunControl:
    """Answers run_* and library buttons of one browser on the shared thread."""

    def __init__(self, session: Session) -> None:
        self._session = session
        services = session.app.services
        for name, action, told in (
            ("run_start", lambda event: services.start(), "started a run"),
            ("run_pause", lambda event: services.control("pause"), "paused the run"),
            ("run_resume", lambda event: services.control("resume"), "resumed the run"),
            ("run_stop", lambda event: services.control("stop"), "stopped the run"),
            ("run_continue", lambda event: services.control("continue"), "continued the run"),
            ("run_extend", lambda event: services.extend(_count(event.arg)), "extended the run"),
            ("open_run", lambda event: services.open_named(event.arg), "opened another run"),
            ("continue_run", lambda event: services.continue_named(event.arg), "continued a run"),
            ("delete_run", lambda event: self._ask(event.arg), ""),
            ("delete_no", lambda event: self._ask(""), ""),
            ("delete_yes", lambda event: self._delete(event.arg), "deleted a run"),
            ("adopt", lambda event: self._adopt(), "took the shown run's settings over"),
            ("reset_field", lambda event: self._reset(event.arg), ""),
        ):
            session.handle("act", name, self._guarded(action, told))

    def _guarded(self, action: Callable[[PageEvent], None], told: str) -> Callable[[PageEvent], None]:
        def run(event: PageEvent) -> None:
            try:
                action(event)
            except HpsopError as error:
                self._session.notify("Not done", str(error), "red")
                return
            if told:
                self._session.app.did(self._session, told)

        return lambda event: self._session.app.worker.every(lambda: run(event))

    def _ask(self, name: str) -> None:
        self._session.app.services.asked_to_delete = name
        self._session.app.tell_all("library")

    def _adopt(self) -> None:
        app = self._session.app
        with app.lock:
            app.draft.begin(app.picture.case)
        app.hub.changed("settings")
        app.tell_all("draft")

    def _reset(self, argument: str) -> None:
        app = self._session.app
        section, _, name = argument.partition(".")
        with app.lock:
            if not app.draft.changed(section, name):
                return
            app.draft.reset(section, name)
        app.hub.changed("settings")
        app.tell_all("draft")

    def _delete(self, name: str) -> None:
        services = self._session.app.services
        if services.asked_to_delete != name:
            return
        services.asked_to_delete = ""
        try:
            services.delete(name)
        finally:
            self._session.app.tell_all("library")


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= len(text) <= 5 or int(text) < 1:
        raise InputError(f"extend by {text[:20]!r} generations: give a whole number from 1 to 99999")
    return int(text)
