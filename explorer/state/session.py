"""The page's state: one object shared by all browsers, and in it one session for each browser.

Views never call one another. A view changes the state and says which topic changed; views that drew from that topic are
called, each on the session's own thread, where a newer call replaces one that still waits. So a stream of generations
can never pile up behind a slow browser, and callbacks of viser's pool never overlap inside a view.
"""

from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from explorer.server.bridge import PageEvent
from explorer.server.worker import LatestWorker
from explorer.state.draft import Draft
from explorer.state.run_picture import RunPicture
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import HpsopError
from hpsop_core.evaluation.result import Evaluation

MOST_PINS = 4
# viser's client holds a batch of messages with 3D nodes in it until the graphics' next frame; curves and tables that
# travel with them would wait too. So the scene follows a moment later, in a batch of its own.
_SCENE_SETTLES = 0.06
# width of the left dock, px
LEFT_DOCK = 340


@dataclass(frozen=True)
class Shown:
    """A design on display.

    Attributes:
        label: for people: "Design 1234", "Initial design", "What-if".
        evaluation: its numbers.
        design_id: in the run, or None.
        generation: it was born in, or None.
        kind: "run", "initial" or "whatif".
    """

    label: str
    evaluation: Evaluation
    design_id: int | None = None
    generation: int | None = None
    kind: str = "run"

    @property
    def key(self) -> tuple[object, ...]:
        """Two shown designs of equal keys have the same geometry and curves."""
        return (self.evaluation.level, *self.evaluation.variables.key())

    @property
    def name(self) -> str:
        """The key as text."""
        return " ".join(str(part) for part in self.key)


class Hub:
    """Who wants to know of which topic."""

    def __init__(self, worker: LatestWorker) -> None:
        self._worker = worker
        self._wanted: dict[str, list[tuple[str, Callable[[], None]]]] = {}
        self._lock = threading.Lock()
        self._serial = 0

    def on(self, topics: Iterable[str], callback: Callable[[], None]) -> None:
        """Call ``callback`` on the worker after any of these topics changed."""
        with self._lock:
            self._serial += 1
            for topic in topics:
                self._wanted.setdefault(topic, []).append((f"view {self._serial}", callback))

    def changed(self, *topics: str) -> None:
        """Tell; a view that wants several of the topics is called once."""
        with self._lock:
            called = {key: callback for topic in topics for key, callback in self._wanted.get(topic, [])}
        for key, callback in called.items():
            self._worker.latest(key, callback)


@dataclass(frozen=True)
class ViewOptions:
    """What of the design is drawn in 3D; belongs to a browser.

    ``ghost_of`` is "initial" or the ``name`` of a pinned design; a pin that is gone means the initial design.
    ``beside`` puts the ghost abeam, to port, where neither hull hides the other.
    """

    ghost: bool = False
    ghost_of: str = "initial"
    beside: bool = False
    waves: bool = False
    pressure: bool = False
    spin: bool = False
    topsides: bool = True
    water: bool = True
    condition: int = 0
    camera: str = "perspective"
    dark: bool = False


class Session:
    """One browser's own state.

    Attributes:
        app: the shared state.
        browser: the browser's own name for itself, "" until it has said so.
        number: by which the other browsers know it, from 1; 0 until it has said who it is.
        selected: the design on display, or None before the first.
        pins: designs kept side by side, at most four.
        scrubbed: the generation looked at, or None to follow the run.
        filters: ranges by quantity key, from brushes and boxes.
        limits: zoomed limits by chart.
        tab: the chosen chart.
        options: of the 3D view.
        archive, infeasible: what the Pareto chart shows besides the front.
        size: of the browser's window in px.
        legends: HTML legends of what is overlaid in 3D, by overlay.
    """

    def __init__(self, app: AppState, client_id: int, notify: Callable[[str, str, str], None]) -> None:
        self.app = app
        self.client_id = client_id
        self.notify = notify
        self.browser = ""
        self.number = 0
        self.selected: Shown | None = None
        self.pins: tuple[Shown, ...] = ()
        self.scrubbed: int | None = None
        self.filters: dict[str, tuple[float, float]] = {}
        self.limits: dict[str, tuple[tuple[float, float], tuple[float, float]]] = {}
        self.tab = "open_water"
        self.options = ViewOptions()
        self.archive = True
        self.infeasible = False
        self.size = (1366, 768)
        self.legends: dict[str, str] = {}
        self.since = time.time()
        self.worker = LatestWorker(f"page-{client_id}", self._stumbled)
        self.heavy = LatestWorker(f"scene-{client_id}", self._stumbled, _SCENE_SETTLES)
        # maps and curves by level 2 take seconds: the next design's geometry must not wait for them
        self.slow = LatestWorker(f"maps-{client_id}", self._stumbled)
        self.hub = Hub(self.worker)
        self._handlers: dict[tuple[str, str], Callable[[PageEvent], None]] = {}
        self._closers: list[Callable[[], None]] = []

    def _stumbled(self, error: BaseException) -> None:
        text = str(error) if isinstance(error, HpsopError) else f"{type(error).__name__}: {error}"
        self.notify("Something went wrong", text, "red")

    @property
    def picture(self) -> RunPicture:
        """The run as it is now."""
        return self.app.picture

    @property
    def dock_width(self) -> int:
        """Of the right dock in px: a large screen gives its charts more room, a small one keeps the 3D view usable."""
        return min(max(490, round(0.31 * self.size[0])), 620)

    @property
    def chart_width(self) -> float:
        """Of a chart that fills the right dock, px."""
        return self.dock_width - 24.0

    def ghost(self) -> tuple[Shown | None, int | None]:
        """The design that stands beside the selected one in 3D, and which pin it is; a ship is not its own ghost."""
        selected = self.selected
        if not self.options.ghost or selected is None:
            return None, None
        place = next((index for index, item in enumerate(self.pins) if item.name == self.options.ghost_of), None)
        found = self.app.initial_shown(selected.evaluation.level) if place is None else self.pins[place]
        same = found is not None and found.evaluation.variables == selected.evaluation.variables
        return (None if same else found), place

    def on_close(self, closer: Callable[[], None]) -> None:
        """Call when the browser leaves."""
        self._closers.append(closer)

    def close(self) -> None:
        """The browser has left."""
        for closer in self._closers:
            closer()
        self.worker.close()
        self.heavy.close()
        self.slow.close()

    # ---- gestures --------------------------------------------------------------------------------------------------
    def handle(self, kind: str, target: str, handler: Callable[[PageEvent], None]) -> None:
        """Let ``handler`` answer a gesture: kind and chart ("click", "pareto"), or "act" and the button's name."""
        self._handlers[(kind, target)] = handler

    def receive(self, event: PageEvent) -> None:
        """A gesture from the browser; hovering and dragging keep only the newest."""
        target = (
            event.name if event.kind == "act" else event.chart if event.kind not in ("hello", "size", "key") else ""
        )
        handler = self._handlers.get((event.kind, target))
        if handler is None:
            return
        if event.kind in ("hover", "pan"):
            self.worker.latest(f"{event.kind} {target}", lambda: handler(event))
        else:
            self.worker.every(lambda: handler(event))

    # ---- changes ---------------------------------------------------------------------------------------------------
    def select(self, shown: Shown) -> None:
        """Put a design on display."""
        self.selected = shown
        self.hub.changed("selection")
        self.app.remember(self)

    def select_id(self, design_id: int) -> bool:
        """Put a design of the run on display; False when the run does not have it or it failed."""
        shown = self.app.shown(design_id)
        if shown is None or not shown.evaluation.ok:
            return False
        self.select(shown)
        return True

    def select_initial(self) -> None:
        """Put the initial design on display."""
        initial = self.app.initial_shown(self.picture.current_level)
        if initial is not None:
            self.select(initial)

    def pin(self, shown: Shown) -> None:
        """Keep a design side by side, or drop it when it is kept already."""
        if any(item.key == shown.key for item in self.pins):
            self.pins = tuple(item for item in self.pins if item.key != shown.key)
        elif len(self.pins) >= MOST_PINS:
            self.notify("Four designs are pinned", "Unpin one of them first.", "yellow")
            return
        else:
            self.pins = (*self.pins, shown)
        self.hub.changed("pins")
        self.app.remember(self)

    def scrub(self, generation: int | None) -> None:
        """Look at a generation, or follow the run for None."""
        self.scrubbed = generation
        self.hub.changed("scrub")
        self.app.remember(self)

    def filter(self, ranges: Mapping[str, tuple[float, float] | None]) -> None:
        """Set or (None) drop range filters."""
        for key, value in ranges.items():
            if value is None:
                self.filters.pop(key, None)
            else:
                self.filters[key] = value
        self.hub.changed("filter")

    def clear_filters(self) -> None:
        """Drop every filter."""
        self.filters = {}
        self.hub.changed("filter")

    def zoom(self, chart: str, limits: tuple[tuple[float, float], tuple[float, float]] | None) -> None:
        """Zoom a chart, or show all of it for None."""
        if limits is None:
            self.limits.pop(chart, None)
        else:
            self.limits[chart] = limits
        self.hub.changed(f"zoom {chart}")

    def set_options(self, **changes: Any) -> None:
        """Change what is drawn in 3D."""
        self.options = dataclasses.replace(self.options, **changes)
        self.hub.changed("options")
        self.app.remember(self)

    # ---- coming back after a reload --------------------------------------------------------------------------------
    def saved(self) -> dict[str, Any]:
        """What a reload brings back, as JSON."""

        def design(shown: Shown) -> dict[str, Any]:
            return {
                "id": shown.design_id,
                "kind": shown.kind,
                "level": shown.evaluation.level,
                "variables": shown.evaluation.variables.as_dict(),
            }

        return {
            "number": self.number,
            "run": self.picture.name,
            "selected": design(self.selected) if self.selected else None,
            "pins": [design(item) for item in self.pins],
            "scrubbed": self.scrubbed,
            "tab": self.tab,
            "archive": self.archive,
            "infeasible": self.infeasible,
            "options": dataclasses.asdict(self.options),
        }

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Come back to what ``saved`` described, as far as it still exists."""
        fields = {item.name: item.type for item in dataclasses.fields(ViewOptions)}
        options = saved.get("options")
        if isinstance(options, dict):
            default = ViewOptions()
            self.options = dataclasses.replace(
                self.options,
                **{
                    key: value
                    for key, value in options.items()
                    if key in fields and type(value) is type(getattr(default, key))
                },
            )
        self.tab = str(saved.get("tab", self.tab))
        self.archive = saved.get("archive") is not False
        self.infeasible = saved.get("infeasible") is True
        if saved.get("run") == self.picture.name:
            scrubbed = saved.get("scrubbed")
            self.scrubbed = scrubbed if isinstance(scrubbed, int) and not isinstance(scrubbed, bool) else None
            pins = saved.get("pins")
            again = [self._again(item) for item in pins[:MOST_PINS]] if isinstance(pins, list) else []
            self.pins = tuple(shown for shown in again if shown is not None)
            selected = self._again(saved.get("selected"))
            if selected is not None:
                self.selected = selected
        self.hub.changed("selection", "pins", "scrub", "options", "tab")

    def _again(self, item: object) -> Shown | None:
        if not isinstance(item, dict):
            return None
        if isinstance(item.get("id"), int):
            return self.app.shown(item["id"])
        if item.get("kind") == "initial":
            return self.app.initial_shown(item["level"] if item.get("level") in (1, 2) else 1)
        try:
            variables = DesignVariables.from_dict(item.get("variables") or {})
            return self.app.whatif(variables, item["level"] if item.get("level") in (1, 2) else 1)
        except (HpsopError, TypeError, AttributeError):
            return None


@dataclass
class AppState:
    """Everything that all browsers share.

    Attributes:
        draft: the case being set up.
        worker: the thread of shared work and shared views.
        hub: topics of the shared views: draft, run, people, library.
        picture: the run on display.
        sessions: by client id.
        services: what answers for runs and physics (explorer/services/services.py).
        memory: what a reload brings back, by the browser's own name; the latest is the last.
        doings: who did what to the run last, for people.
    """

    draft: Draft
    worker: LatestWorker
    hub: Hub
    picture: RunPicture
    services: Any
    sessions: dict[int, Session] = field(default_factory=dict)
    memory: dict[str, dict[str, Any]] = field(default_factory=dict)
    lock: threading.RLock = field(default_factory=threading.RLock)
    on_remember: Callable[[], None] | None = None
    doings: str = ""

    def greet(self, session: Session) -> None:
        """Give a browser the number it had before, or the least that is free."""
        with self.lock:
            taken = {other.number for other in self.sessions.values() if other is not session}
            had = self.memory.get(session.browser, {}).get("number")
            if isinstance(had, int) and had > 0 and had not in taken:
                session.number = had
            else:
                session.number = next(number for number in range(1, len(taken) + 2) if number not in taken)
        self.hub.changed("people")

    def did(self, session: Session, what: str) -> None:
        """Tell everybody else what this browser did to the run or the settings that all share."""
        with self.lock:
            others = [other for other in self.sessions.values() if other is not session]
        self.doings = f"browser {session.number} {what}" if others else ""
        for other in others:
            other.notify(f"Browser {session.number}", what, "blue")
        self.hub.changed("run")

    def remember(self, session: Session) -> None:
        """Keep what a reload of this browser brings back."""
        if not session.browser:
            return
        with self.lock:
            self.memory.pop(session.browser, None)
            self.memory[session.browser] = session.saved()
            while len(self.memory) > 50:
                self.memory.pop(next(iter(self.memory)))
        if self.on_remember is not None:
            self.on_remember()

    def show_run(self, picture: RunPicture) -> None:
        """A newer picture of the run, for everybody."""
        with self.lock:
            replaced = picture.name != self.picture.name
            self.picture = picture
            sessions = list(self.sessions.values())
        self.hub.changed("run")
        for session in sessions:
            if replaced:
                session.scrubbed = None
                session.filters = {}
                session.limits = {}
                session.pins = ()
                session.selected = self.initial_shown(picture.current_level)
                session.hub.changed("run", "selection", "scrub", "filter", "pins")
            else:
                session.hub.changed("run")

    def refuse(self, client_id: int, text: str) -> None:
        """Tell a browser that what it sent was not accepted."""
        session = self.sessions.get(client_id)
        if session is not None:
            session.notify("Not accepted", text, "red")

    def tell_all(self, topic: str) -> None:
        """A shared topic that every browser's own views may want too."""
        self.hub.changed(topic)
        with self.lock:
            sessions = list(self.sessions.values())
        for session in sessions:
            session.hub.changed(topic)

    def shown(self, design_id: int) -> Shown | None:
        """A design of the run."""
        evaluation = self.services.evaluation(design_id)
        if evaluation is None:
            return None
        picture = self.picture
        row = picture.row(design_id)
        generation = int(picture.generation[row]) if row is not None else None
        hand = row is not None and bool(picture.by_hand[row])
        label = f"Design {design_id}" + (" (by hand)" if hand else "")
        return Shown(label, evaluation, design_id, generation)

    def initial_shown(self, level: int) -> Shown | None:
        """The initial design at a level."""
        evaluation = self.services.initial(level)
        return None if evaluation is None else Shown("Initial design", evaluation, kind="initial")

    def whatif(self, variables: DesignVariables, level: int = 1) -> Shown | None:
        """A design of the user's own making, evaluated now."""
        evaluation = self.services.evaluate(variables, level)
        return None if evaluation is None else Shown("What-if", evaluation, kind="whatif")
