"""What all browsers share: the case being set up, the run on display, and who is watching."""

from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

from explorer.server.worker import LatestWorker, Turn
from explorer.state.draft import Draft, DraftSnapshot
from explorer.state.history import History
from explorer.state.hub import Hub
from explorer.state.own_ship import OwnShip
from explorer.state.run_picture import RunPicture
from explorer.state.shown import Shown
from hpsop_core.case.case import Case
from hpsop_core.errors import HpsopError

_MOST_REMEMBERED = 50
# a browser's curves are made within a tenth of that, and wait no longer for another one's maps, which take seconds
_TURN_SECONDS = 0.5


class Watcher(Protocol):
    """What the shared state asks of a browser's own state (explorer/state/session.py)."""

    browser: str
    number: int
    hub: Hub
    notify: Callable[[str, str, str], None]

    def close(self) -> None:
        """The browser has left."""

    def leave_run(self, first: Shown | None) -> None:
        """Another run is on display: forget what belonged to the one before and show this design."""


@dataclass
class AppState:
    """Everything that all browsers share. Views read its attributes and change them by its methods only.

    Attributes:
        draft: the case being set up.
        worker: the thread of shared work and shared views.
        hub: topics of the shared views: draft, settings, run, people, library.
        picture: the run on display.
        sessions: by client id.
        memory: what a reload brings back, by the browser's own name; the latest is the last.
        doings: who did what to the run last, for people.
        asked_to_delete: the run of the library that somebody is being asked about, or "".
        renamed: the run of the library whose name and note are being written, or "".
        coming: the run of the library that is being opened, or "": until it stands all that is shown is the one before.
        ship: a ship of the user's own on its way to a case.
        history: changes of the settings, which can be taken back.
        ships, maps: whose turn it is among the browsers' threads that make the ship in 3D, and maps and curves.
    """

    draft: Draft
    worker: LatestWorker
    hub: Hub
    picture: RunPicture
    sessions: dict[int, Watcher] = field(default_factory=dict)
    memory: dict[str, dict[str, Any]] = field(default_factory=dict)
    lock: threading.RLock = field(default_factory=threading.RLock)
    on_remember: Callable[[], None] | None = None
    doings: str = ""
    asked_to_delete: str = ""
    renamed: str = ""
    coming: str = ""
    ship: OwnShip = field(default_factory=OwnShip)
    history: History[DraftSnapshot] = field(default_factory=History)
    ships: Turn = field(default_factory=lambda: Turn(_TURN_SECONDS))
    maps: Turn = field(default_factory=lambda: Turn(_TURN_SECONDS))

    # ---- browsers --------------------------------------------------------------------------------------------------
    def join(self, client_id: int, watcher: Watcher) -> None:
        """A browser has come."""
        with self.lock:
            self.sessions[client_id] = watcher

    def leave(self, client_id: int) -> Watcher | None:
        """A browser has gone; it is returned where it was known."""
        with self.lock:
            return self.sessions.pop(client_id, None)

    def greet(self, watcher: Watcher) -> None:
        """Give a browser the number it had before, or the least that is free."""
        with self.lock:
            taken = {other.number for other in self.sessions.values() if other is not watcher}
            had = self.memory.get(watcher.browser, {}).get("number")
            if isinstance(had, int) and had > 0 and had not in taken:
                watcher.number = had
            else:
                watcher.number = next(number for number in range(1, len(taken) + 2) if number not in taken)
        self.hub.changed("people")

    def did(self, watcher: Watcher, what: str) -> None:
        """Tell everybody else what this browser did to the run or the settings that all share."""
        with self.lock:
            others = [other for other in self.sessions.values() if other is not watcher]
        self.doings = f"browser {watcher.number} {what}" if others else ""
        for other in others:
            other.notify(f"Browser {watcher.number}", what, "blue")
        self.hub.changed("run")

    def remember(self, browser: str, saved: dict[str, Any]) -> None:
        """Keep what a reload of this browser brings back; one that has not said its name yet is not kept."""
        if not browser:
            return
        with self.lock:
            self.memory.pop(browser, None)
            self.memory[browser] = saved
            while len(self.memory) > _MOST_REMEMBERED:
                self.memory.pop(next(iter(self.memory)))
        if self.on_remember is not None:
            self.on_remember()

    def refuse(self, client_id: int, text: str) -> None:
        """Tell a browser that what it sent was not accepted."""
        watcher = self.sessions.get(client_id)
        if watcher is not None:
            watcher.notify("Not accepted", text, "red")

    def tell_all(self, topic: str) -> None:
        """A shared topic that every browser's own views may want too."""
        self.hub.changed(topic)
        with self.lock:
            watchers = list(self.sessions.values())
        for watcher in watchers:
            watcher.hub.changed(topic)

    # ---- the run on display ----------------------------------------------------------------------------------------
    def show_run(self, picture: RunPicture, first: Callable[[], Shown | None]) -> None:
        """A newer picture of the run, or another run, for everybody.

        Args:
            picture: of the run.
            first: the design that everybody sees first; asked only when it is another run.
        """
        with self.lock:
            before = self.picture
            replaced = (picture.opening, picture.name) != (before.opening, before.name) or (
                not picture.name and another_ship(picture.case, before.case)
            )
            self.picture = picture
            watchers = list(self.sessions.values())
        if not replaced:
            self.hub.changed("run", news=True)
            for watcher in watchers:
                watcher.hub.changed("run", news=True)
            return
        try:
            shown, why = first(), ""
        except HpsopError as error:
            # what was shown before is of another run: better nothing than that
            shown, why = None, str(error)
        # run, charts and design change together
        self.hub.changed("run")
        for watcher in watchers:
            watcher.leave_run(shown)
            if why:
                watcher.notify("The initial design has no numbers", why, "red")

    def wait_until_drawn(self, timeout: float) -> None:
        """Until every page has drawn the run, ``timeout`` seconds at most."""
        for hub, left in self._hubs_within(timeout):
            hub.wait_until_drawn(left)

    def make_way(self, timeout: float) -> None:
        """While any browser's gesture waits for its answer, ``timeout`` seconds at most."""
        for hub, left in self._hubs_within(timeout):
            hub.wait_until_answered(left)

    def _hubs_within(self, timeout: float) -> Iterator[tuple[Hub, float]]:
        """All hubs, one after another, each with what is left then of so many seconds."""
        give_up = time.monotonic() + timeout
        with self.lock:
            hubs = [self.hub, *(watcher.hub for watcher in self.sessions.values())]
        for hub in hubs:
            yield hub, max(give_up - time.monotonic(), 0.0)

    def ask_to_delete(self, name: str) -> None:
        """Ask whether this run of the library is to be deleted, or no longer for ""."""
        self.asked_to_delete = name
        self.tell_all("library")

    def expect(self, name: str) -> None:
        """This run of the library is being opened, or none any more for ""."""
        self.coming = name
        self.tell_all("library")

    def rename(self, name: str) -> None:
        """Open the boxes for this run's name and note, or none for ""."""
        self.renamed = name
        self.tell_all("library")

    # ---- a ship of the user's own --------------------------------------------------------------------------------
    def change_ship(self, **changes: Any) -> OwnShip:
        """Change something of the ship that is being brought in; returns it as it is then."""
        with self.lock:
            self.ship = dataclasses.replace(self.ship, **changes)
            ship = self.ship
        self.tell_all("ship")
        return ship

    # ---- the case being set up -------------------------------------------------------------------------------------
    def drafted(self) -> Case:
        """The case as it is set up now.

        Raises:
            InputError: the settings do not make a case; the text says which field and what to do.
        """
        with self.lock:
            return self.draft.case()

    def change_draft(self, change: Callable[[Draft], None], whole: bool = False) -> None:
        """Change the case being set up.

        Args:
            change: what to do to the draft.
            whole: whether widgets have to follow it too: a preset, a reset, another run's case.
        """
        with self.lock:
            before = self.draft.snapshot()
            change(self.draft)
            changed = before.differing(self.draft.snapshot())
            if changed:
                self.history.record(before, changed)
        if whole:
            self.show_settings()
        self.tell_all("draft")

    def turn_draft(self, back: bool) -> bool:
        """Take the last change of the settings back, or again; whether there was one."""
        with self.lock:
            present = self.draft.snapshot()
            found = self.history.undo(present) if back else self.history.redo(present)
            if found is None:
                return False
            self.draft.come_back(found)
        self.show_settings()
        self.tell_all("draft")
        return True

    def show_settings(self) -> None:
        """Widgets of the settings show the draft again: it was changed elsewhere, or what was typed was refused."""
        self.hub.changed("settings")


def another_ship(case: Case, other: Case) -> bool:
    """Whether two cases have other parents: no design that was shown of the one stands for the other."""
    return (case.hull, case.propeller) != (other.hull, other.propeller)
