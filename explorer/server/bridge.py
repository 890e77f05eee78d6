"""What happens in the browser, told to Python: clicks, hovers, drags and keys on charts drawn as SVG.

viser 1.1.1 sends no event from its own plots. What does work (measured, and guarded by tests/browser):
``gui.add_html`` inserts HTML whose inline handlers run, and a hidden ``gui.add_text`` carries a text to Python when its
input element is set and an ``input`` event dispatched. ``assets/page.js`` does both; this module is its other end.

The text is a JSON list of the latest events, each with a rising number ``n``, because viser passes on only the newest
of a burst: what was dropped comes again with the next message, and what was seen before is skipped here. Everything
that arrives is checked: a browser may send anything.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

import viser

from explorer.server.html_slot import Slot
from hpsop_core.charts.style import SCREEN, style_sheet
from hpsop_core.markup import Markup, fill

PAGE_VERSION = "2"
_MAX_MESSAGE = 6000
# no gesture of ours means a number beyond this; its square still is one
_MOST = 1e15
_POINTS = ("x", "y", "fx", "fy", "x0", "x1", "y0", "y1", "fx0", "fx1", "fy0", "fy1")
_NUMBERS = (*_POINTS, "factor", "width", "height", "drag")
_TEXTS = {"t": 200, "chart": 200, "name": 200, "arg": 400, "key": 200, "browser": 200, "link": 1500}


@dataclass(frozen=True)
class PageEvent:
    """One gesture.

    Attributes:
        kind: hello, stands, tabs, size, click, hover, pan, zoom, box, brush, reset, act or key.
        chart: the chart it happened on, or "".
        name, arg: of a pressed button (kind "act"); of kind "tabs" arg names those that are seen, "|" between them.
        key: of the keyboard.
        numbers: numbers of a sensible size by name: x, y in the chart's data, fx, fy in fractions of its plot area; of
            a pan also drag, which tells one drag from the next.
        shift: whether Shift was held.
        browser: the browser's own name for itself (hello only).
        link: the query of the address that it was opened with (hello only).
    """

    kind: str
    chart: str = ""
    name: str = ""
    arg: str = ""
    key: str = ""
    numbers: dict[str, float] = field(default_factory=dict)
    shift: bool = False
    browser: str = ""
    link: str = ""


def _sensible(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -_MOST <= value <= _MOST:
        return None
    return float(value)


def parse_events(text: object, seen: int) -> tuple[list[PageEvent], int]:
    """Events newer than ``seen`` from what the browser sent, and the newest number; nonsense gives no events."""
    if not isinstance(text, str) or not text or len(text) > _MAX_MESSAGE:
        return [], seen
    try:
        raw = json.loads(text)
    except (ValueError, RecursionError):
        return [], seen
    if not isinstance(raw, list):
        return [], seen
    events = []
    newest = seen
    for item in raw:
        if not isinstance(item, dict):
            continue
        number = _sensible(item.get("n"))
        if number is None or number <= seen:
            continue
        newest = max(newest, int(number))
        texts = {name: str(item.get(name, ""))[:length] for name, length in _TEXTS.items()}
        events.append(
            PageEvent(
                kind=texts["t"],
                chart=texts["chart"],
                name=texts["name"],
                arg=texts["arg"],
                key=texts["key"],
                numbers={name: value for name in _NUMBERS if (value := _sensible(item.get(name))) is not None},
                shift=item.get("shift") is True,
                browser=texts["browser"],
                link=texts["link"],
            )
        )
    return events, newest


class Bridge:
    """The hidden channel of one browser.

    Args:
        gui: where the hidden elements go: a container of this client that is always mounted.
        receive: called with every event, once and in order, from one of viser's threads; must not block.
    """

    def __init__(self, gui: viser.GuiApi, receive: Callable[[PageEvent], None]) -> None:
        self._receive = receive
        self._seen = 0
        # viser calls from a pool of threads: two may bring texts that hold the same events
        self._lock = threading.Lock()
        self._channel = gui.add_text("hpsop channel", "")
        uuid = self._channel._impl.uuid
        script = f"({_asset('page.js')})('{PAGE_VERSION}'); window.hpsop.connect('{uuid}')"
        hide_row = Markup('div:has(> div > * > * > label[for="{}"]){{display:none!important}}').format(uuid)
        Slot(
            gui,
            fill('<div class="hpsop-root"></div><style>{}</style>{}', hide_row, _runs(script)),
        )
        self._channel.on_update(self._on_update)

    def _on_update(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None:
            return
        with self._lock:
            events, self._seen = parse_events(self._channel.value, self._seen)
            for item in events:
                self._receive(item)


def _runs(script: str) -> Markup:
    """What runs a script once the browser has put it into the page: React's inner HTML starts no ``<script>``."""
    return fill('<img alt="" style="display:none" src="data:," onerror="{}">', script)


def _calls(function: str) -> Markup:
    """What hands itself to a function of the page's script, once that is there."""
    return _runs(f"window.hpsop&&window.hpsop.{function}(this)")


def overlay(name: str, content: Markup) -> Markup:
    """HTML that the browser lifts out of its panel and lays over the 3D view."""
    return fill(
        '<template data-overlay="{}">{}</template>',
        name,
        content,
    ) + _calls("overlay")


def scrolling(name: str, content: Markup) -> Markup:
    """What is wider than its panel, in a box that keeps its place when it is drawn again; ``name`` is the box's."""
    return fill(
        '<div class="wide" data-keep="{}" tabindex="0" role="region" aria-label="{}, wider than the panel">{}</div>',
        name,
        name.replace("_", " "),
        content,
    ) + _calls("kept")


def picture_file(name: str, drawing: Markup, scale: float, serial: int) -> Markup:
    """An SVG drawing that the browser saves as a PNG of ``scale`` pixels for one of its own; once a ``serial``."""
    return fill(
        '<template data-file="{}" data-scale="{:g}" data-serial="{}">{}</template>',
        name,
        scale,
        serial,
        drawing,
    ) + _calls("picture")


def link_box(query: str, serial: int) -> Markup:
    """A query that the browser makes a link to its own address of, copies and shows; once a ``serial``."""
    return fill(
        '<template data-query="{}" data-serial="{}"></template>',
        query,
        serial,
    ) + _calls("link")


def tooltip(chart: str, content: Markup, serial: int) -> Markup:
    """HTML that the browser shows beside the pointer while it rests on ``chart``."""
    return fill(
        '<template data-chart="{}" data-serial="{}">{}</template>',
        chart,
        serial,
        content,
    ) + _calls("tip")


def page_style() -> str:
    """The page's style sheet; it stands in the page's head (``access``), before anything that it dresses."""
    return f"{_asset('page.css')}\n{style_sheet(SCREEN)}"


def _asset(name: str) -> str:
    return (files("explorer") / "assets" / name).read_text(encoding="utf-8")
