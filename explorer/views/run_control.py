"""Run buttons and the library's buttons: pressed in one browser, effective for all."""

from __future__ import annotations

from collections.abc import Callable

from explorer.bridge import PageEvent
from explorer.state import Session
from hpsop_core.errors import HpsopError


class RunControl:
    """Answers run_* and library buttons of one browser on the shared thread."""

    def __init__(self, session: Session) -> None:
        self._session = session
        services = session.app.services
        for name, action in (
            ("run_start", lambda event: services.start()),
            ("run_pause", lambda event: services.control("pause")),
            ("run_resume", lambda event: services.control("resume")),
            ("run_stop", lambda event: services.control("stop")),
            ("run_continue", lambda event: services.control("continue")),
            ("run_extend", lambda event: services.extend(25)),
            ("open_run", lambda event: services.open_named(event.arg)),
            ("delete_run", lambda event: self._ask(event.arg)),
            ("delete_no", lambda event: self._ask("")),
            ("delete_yes", lambda event: self._delete(event.arg)),
        ):
            session.handle("act", name, self._guarded(action))

    def _guarded(self, action: Callable[[PageEvent], None]) -> Callable[[PageEvent], None]:
        def run(event: PageEvent) -> None:
            try:
                action(event)
            except HpsopError as error:
                self._session.notify("Not done", str(error), "red")

        return lambda event: self._session.app.worker.every(lambda: run(event))

    def _ask(self, name: str) -> None:
        self._session.app.services.asked_to_delete = name
        self._session.app.tell_all("library")

    def _delete(self, name: str) -> None:
        services = self._session.app.services
        if services.asked_to_delete != name:
            return
        services.asked_to_delete = ""
        try:
            services.delete(name)
        finally:
            self._session.app.tell_all("library")
