"""What belongs to one browser: its selection, pins, filters, zooms and what it draws."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

from explorer.server.html_slot import reason_of
from explorer.server.worker import LatestWorker
from explorer.state.app_state import AppState
from explorer.state.chart_options import ChartOptions
from explorer.state.gestures import Gestures
from explorer.state.hub import Hub
from explorer.state.link import Link, LinkedDesign
from explorer.state.run_picture import RunPicture
from explorer.state.shown import Shown
from explorer.state.table_options import TableOptions
from explorer.state.view_options import ViewOptions
from hpsop_core.markup import Markup

MOST_PINS = 4
_MOST_STARS = 500
# viser's client holds a batch of messages with 3D nodes in it until the graphics' next frame; curves and tables that
# travel with them would wait too. So the scene follows a moment later, in a batch of its own.
_SCENE_SETTLES = 0.06
# so long after a gesture's answer the news of a run wait: a browser that draws them would show the answer later
_ANSWER_SECONDS = 0.12
# width of the left dock, px
LEFT_DOCK = 340
# windows narrower than this (px) show the left dock when asked, and the right one has this part of them
_NARROW, _NARROW_SHARE = 1200, 0.44
# viser's page is a sheet over the 3D view in windows of this width or less (36 em), px; assets/page.css gives the sheet
# this part of their height
PHONE, PHONE_SHEET = 576, 0.58
# sides of a browser's window that can be meant, px
_LEAST_SIDE, _MOST_SIDE = 100, 20000

Limits = tuple[tuple[float, float], tuple[float, float]]


class Session:
    """One browser's own state. Views read its attributes and change them by its methods only.

    Attributes:
        app: the shared state.
        browser: the browser's own name for itself, "" until it has said so.
        number: by which the other browsers know it, from 1; 0 until it has said who it is.
        scrubbed: the generation looked at, or None to follow the run.
        playing: whether the generations are being played.
        filters: ranges by quantity key, from brushes and boxes.
        limits: zoomed limits by chart.
        tab: the chosen chart.
        options: of the 3D view.
        table: how the table of all designs is shown.
        charts: what the charts of a run show.
        follow: whether the selection goes on to the newest compromise as a run finds it.
        followed: the design that this has selected last, or None.
        archive, infeasible: what the Pareto chart shows besides the front.
        size: of the browser's window in px.
        legends: of what is overlaid in 3D, by overlay.
        worker, heavy, slow: threads of the panels, of the ship in 3D, and of what takes seconds.
        hub: topics of this browser's views.
        gestures: of this browser.
    """

    def __init__(self, app: AppState, client_id: int, notify: Callable[[str, str, str], None]) -> None:
        self.app = app
        self.client_id = client_id
        self.notify = notify
        self.browser = ""
        self.number = 0
        self._selected: Shown | None = None
        self._pins: tuple[Shown, ...] = ()
        self.scrubbed: int | None = None
        self.playing = False
        self.filters: dict[str, tuple[float, float]] = {}
        self.limits: dict[str, Limits] = {}
        self.tab = "open_water"
        self.options = ViewOptions()
        self.table = TableOptions()
        self.charts = ChartOptions()
        self.follow = False
        self.followed: int | None = None
        self._stars: dict[str, frozenset[int]] = {}
        self.archive = True
        self.infeasible = False
        self.size = (1366, 768)
        self.legends: dict[str, Markup] = {}
        self.worker = LatestWorker(f"page-{client_id}", self._stumbled, calm=_ANSWER_SECONDS)
        self.heavy = LatestWorker(f"scene-{client_id}", self._stumbled, _SCENE_SETTLES, turn=app.ships)
        # maps and curves by level 2 take seconds: the next design's geometry must not wait for them
        self.slow = LatestWorker(f"maps-{client_id}", self._stumbled, turn=app.maps)
        self.hub = Hub(self.worker)
        self.gestures = Gestures(self.worker)
        self._closers: list[Callable[[], None]] = []

    def _stumbled(self, error: BaseException) -> None:
        self.notify("Something went wrong", reason_of(error), "red")

    @property
    def picture(self) -> RunPicture:
        """The run as it is now."""
        return self.app.picture

    @property
    def selected(self) -> Shown | None:
        """The design on display; never one of a run that is no longer on display itself."""
        shown = self._selected
        return shown if shown is not None and self._belongs(shown) else None

    @property
    def pins(self) -> tuple[Shown, ...]:
        """Designs kept side by side, all of the run on display."""
        return tuple(shown for shown in self._pins if self._belongs(shown))

    def _belongs(self, shown: Shown) -> bool:
        return shown.opening == self.picture.opening

    @property
    def stars(self) -> frozenset[int]:
        """Designs of the run on display that bear this browser's star."""
        return self._stars.get(self.picture.name, frozenset())

    @property
    def dock_width(self) -> int:
        """Of the right dock in px: a large screen gives its charts more room, a small one leaves half to the ship."""
        if self.phone:
            return self.size[0]
        width = min(max(490, round(0.31 * self.size[0])), 620)
        return min(width, round(_NARROW_SHARE * self.size[0])) if self.narrow else width

    @property
    def phone(self) -> bool:
        """Whether the window is so small that the page is one column: the ship, and below it the panels."""
        return self.size[0] <= PHONE

    @property
    def narrow(self) -> bool:
        """Whether the window is so narrow that the left dock is closed at first, to leave half of it to the ship."""
        return self.size[0] < _NARROW

    @property
    def left_dock(self) -> int:
        """Width of the left dock in px, as the page puts it."""
        return 0 if self.narrow or self.options.wide else LEFT_DOCK

    @property
    def chart_width(self) -> float:
        """Of a chart that fills the right dock, px."""
        return self.dock_width - 24.0

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

    # ---- changes ---------------------------------------------------------------------------------------------------
    def greet(self, browser: str) -> None:
        """The browser has said its own name."""
        self.browser = browser[:64]
        self.app.greet(self)

    def resize(self, width: float | None, height: float | None) -> None:
        """The browser's window has another size; nonsense is not taken."""
        sides = [side for side in (width, height) if side is not None and _LEAST_SIDE <= side <= _MOST_SIDE]
        if len(sides) == 2:
            self.size = (int(sides[0]), int(sides[1]))
            self.hub.changed("size")

    def select(self, shown: Shown) -> None:
        """Put a design on display, unless another run has come on display since it was looked up."""
        with self.app.lock:
            if not self._belongs(shown):
                return
            self._selected = shown
        self._changed("selection")

    def renew(self, again: Callable[[Shown], Shown | None]) -> None:
        """Show the same designs with what is true of them now; one that is no longer to be had is left out."""
        selected = self.selected
        chosen = again(selected) if selected is not None else None
        pins = tuple(found for item in self.pins if (found := again(item)) is not None)
        with self.app.lock:
            if (chosen, pins) == (selected, self.pins):
                return
            self._selected, self._pins = chosen, pins
        self.hub.changed("selection", "pins")

    def pin(self, shown: Shown) -> None:
        """Keep a design side by side, or drop it when it is kept already."""
        with self.app.lock:
            if not self._belongs(shown):
                return
            pins = self.pins
            without = tuple(item for item in pins if item.key != shown.key)
            full = len(without) == len(pins) >= MOST_PINS
            if not full:
                self._pins = without if len(without) < len(pins) else (*pins, shown)
        if full:
            self.notify("Four designs are pinned", "Unpin one of them first.", "yellow")
            return
        self._changed("pins")

    def scrub(self, generation: int | None) -> None:
        """Look at a generation, or follow the run for None."""
        self.scrubbed = generation
        self._changed("scrub")

    def play(self, on: bool) -> None:
        """Begin or end playing the generations."""
        if on != self.playing:
            self.playing = on
            self.hub.changed("play")

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

    def zoom(self, chart: str, limits: Limits | None) -> None:
        """Zoom a chart, or show all of it for None."""
        if limits is None:
            self.limits.pop(chart, None)
        else:
            self.limits[chart] = limits
        self.hub.changed(f"zoom {chart}")

    def switch_layer(self, name: str) -> None:
        """Show or hide "archive" or "infeasible" on the Pareto chart."""
        if name == "archive":
            self.archive = not self.archive
        elif name == "infeasible":
            self.infeasible = not self.infeasible
        self._changed("layers")

    def choose_tab(self, name: str) -> None:
        """Choose a chart."""
        self.tab = name
        self._changed("tab")

    def set_options(self, **changes: Any) -> None:
        """Change what is drawn in 3D."""
        self.options = dataclasses.replace(self.options, **changes)
        self._changed("options")

    def set_table(self, **changes: Any) -> None:
        """Change how the table of all designs is shown."""
        self.table = dataclasses.replace(self.table, **changes)
        self._changed("table")

    def set_charts(self, **changes: Any) -> None:
        """Change what the charts of a run show."""
        self.charts = dataclasses.replace(self.charts, **changes)
        self._changed("charts")

    def set_follow(self, on: bool) -> None:
        """Let the selection go on to the newest compromise, or stay."""
        self.follow, self.followed = on, None
        self._changed("follow")

    def go_on(self, shown: Shown) -> None:
        """The newest compromise, that a run has found while it is followed."""
        self.followed = shown.design_id
        if shown is not self.selected:
            self.select(shown)

    def star(self, design_id: int) -> None:
        """Give a design of the run on display a star, or take it back."""
        run = self.picture.name
        stars = self._stars.get(run, frozenset()) ^ {design_id}
        if len(stars) > _MOST_STARS:
            self.notify("No more stars", f"{_MOST_STARS} designs bear one already; take some back.", "yellow")
            return
        self._stars[run] = stars
        self._changed("stars")

    def set_legend(self, overlay: str, legend: Markup | None) -> None:
        """The legend of what is overlaid in 3D, or none."""
        if legend is None:
            self.legends.pop(overlay, None)
        else:
            self.legends[overlay] = legend
        self.hub.changed("legend")

    def curves_ready(self) -> None:
        """Curves of a design on display have been computed."""
        self.hub.changed("curves")

    def leave_run(self, first: Shown | None) -> None:
        """Another run is on display: forget what belonged to the one before and show this design."""
        with self.app.lock:
            self.scrubbed = None
            self.filters = {}
            self.limits = {}
            self.table = dataclasses.replace(self.table, page=0)
            self._pins = ()
            self.followed = None
            self._selected = first
        self.hub.changed("left", "run", "selection", "scrub", "filter", "pins")

    def _changed(self, topic: str) -> None:
        """Tell the views, and keep for a reload what has changed."""
        self.hub.changed(topic)
        self.remember()

    # ---- links -----------------------------------------------------------------------------------------------------
    def link(self) -> Link:
        """What a link to this page says."""
        return Link(
            run=self.picture.name,
            generation=self.scrubbed,
            design=LinkedDesign.of(self.selected) if self.selected is not None else None,
            pins=tuple(LinkedDesign.of(item) for item in self.pins),
            options=self.options,
            tab=self.tab,
        )

    def follow_link(self, link: Link, find: Callable[[LinkedDesign], Shown | None]) -> list[str]:
        """Look at what a link says, of the run on display.

        Args:
            link: its run is on display already.
            find: a design that it names, or None where there is none.

        Returns:
            Words for what is not there.
        """
        missing = []
        if link.generation is not None:
            if link.generation <= len(self.picture.generations):
                self.scrubbed = link.generation
            else:
                missing.append(f"generation {link.generation}")
        if link.design is not None:
            found = find(link.design)
            if found is None:
                missing.append(f"design {link.design.word()[:20]}")
            else:
                self._selected = found
        pins = [find(pin) for pin in link.pins]
        if pins:
            self._pins = tuple(shown for shown in pins if shown is not None)
            missing += ["a pinned design"] * pins.count(None)
        if link.options is not None:
            own = {
                name: value
                for name, value in dataclasses.asdict(self.options).items()
                if name == "dark" or name.startswith("picture")
            }
            self.options = dataclasses.replace(link.options, **own)
        self.tab = link.tab or self.tab
        self._changed("options")
        self.hub.changed("selection", "pins", "scrub", "tab")
        return missing

    # ---- coming back after a reload --------------------------------------------------------------------------------
    def remember(self) -> None:
        """Keep what a reload brings back."""
        self.app.remember(self.browser, self.saved())

    def saved(self) -> dict[str, Any]:
        """What a reload brings back, as JSON."""
        selected = self.selected
        return {
            "number": self.number,
            "run": self.picture.name,
            "selected": selected.saved() if selected is not None else None,
            "pins": [item.saved() for item in self.pins],
            "scrubbed": self.scrubbed,
            "tab": self.tab,
            "archive": self.archive,
            "infeasible": self.infeasible,
            "options": dataclasses.asdict(self.options),
            "table": dataclasses.asdict(self.table),
            "charts": dataclasses.asdict(self.charts),
            "follow": self.follow,
            "stars": {run: sorted(stars) for run, stars in self._stars.items() if stars},
        }

    def restore(self, saved: Mapping[str, Any], find: Callable[[object], Shown | None]) -> None:
        """Come back to what ``saved`` described, as far as it still exists.

        Args:
            saved: as ``saved`` gave it, or anything that a file may hold instead.
            find: a design from what ``Shown.saved`` gave, or None when there is none any more.
        """
        self.options = self.options.restored(saved.get("options"))
        self.table = self.table.restored(saved.get("table"))
        self.charts = self.charts.restored(saved.get("charts"))
        self.follow = saved.get("follow") is True
        stars = saved.get("stars")
        for run, ids in stars.items() if isinstance(stars, dict) else ():
            if isinstance(ids, list):
                self._stars[str(run)] = frozenset(item for item in ids[:_MOST_STARS] if type(item) is int)
        self.tab = str(saved.get("tab", self.tab))
        self.archive = saved.get("archive") is not False
        self.infeasible = saved.get("infeasible") is True
        if saved.get("run") == self.picture.name:
            scrubbed = saved.get("scrubbed")
            self.scrubbed = scrubbed if isinstance(scrubbed, int) and not isinstance(scrubbed, bool) else None
            pins = saved.get("pins")
            again = [find(item) for item in pins[:MOST_PINS]] if isinstance(pins, list) else []
            self._pins = tuple(shown for shown in again if shown is not None)
            self._selected = find(saved.get("selected")) or self._selected
        self.hub.changed("selection", "pins", "scrub", "options", "tab", "layers", "table", "stars", "charts", "follow")
