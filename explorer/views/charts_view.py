"""The tabs of charts: only the chosen one is drawn, so a stream of generations costs no more than what is looked at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import viser

from explorer.charts.curves import Series
from explorer.server.bridge import PageEvent
from explorer.state.session import Session, Shown
from explorer.views.chips import box, chip, chips
from explorer.views.slot import Slot


@dataclass(frozen=True)
class ChartTab:
    """A chart that can be chosen.

    Attributes:
        name: for events.
        title: on its button.
        topics: what it is drawn from.
        of: "design" or "run": which row its button stands in.
        render: the HTML; called on the session's worker.
    """

    name: str
    title: str
    of: str
    topics: frozenset[str]
    render: Callable[[Session], str]


class ChartsView:
    """A row of buttons and the chosen chart."""

    def __init__(self, session: Session, gui: viser.GuiApi, tabs: Mapping[str, ChartTab]) -> None:
        self._session = session
        self._tabs = tabs
        self._bar = Slot(gui)
        self._html = Slot(gui)
        session.handle("act", "tab", self._choose)
        for topic in sorted({topic for tab in tabs.values() for topic in tab.topics}):
            session.hub.on((topic,), lambda topic=topic: self._topic(topic))
        session.hub.on(("tab", "size"), self.draw)
        self.draw()

    def draw(self) -> None:
        """Draw the bar and the chosen chart."""
        chosen = self._chosen()
        rows = "".join(
            f'<span class="soft">{word}</span>'
            + chips(
                *(chip("tab", tab.title, tab.name, on=tab is chosen) for tab in self._tabs.values() if tab.of == of)
            )
            for of, word in (("design", "Design"), ("run", "Run"))
        )
        self._bar.show(box(f'<div class="tools">{rows}</div>'))
        self._html.show(box(f'<div data-chart-tab="{chosen.name}">{chosen.render(self._session)}</div>'))

    def _topic(self, topic: str) -> None:
        chosen = self._chosen()
        if topic in chosen.topics:
            self._html.show(box(f'<div data-chart-tab="{chosen.name}">{chosen.render(self._session)}</div>'))

    def _chosen(self) -> ChartTab:
        return self._tabs.get(self._session.tab) or next(iter(self._tabs.values()))

    def _choose(self, event: PageEvent) -> None:
        if event.arg in self._tabs:
            self._session.tab = event.arg
            self._session.app.remember(self._session)
            self._session.hub.changed("tab")


def on_display(session: Session) -> list[tuple[Series, Shown]]:
    """What charts overlay: the initial design dashed, pins, and the selection last."""
    shown: list[tuple[Series, Shown]] = []
    selected = session.selected
    level = selected.evaluation.level if selected else 1
    initial = session.app.initial_shown(level)
    if initial is not None:
        shown.append((Series("initial", "initial", "dash"), initial))
    for index, item in enumerate(session.pins):
        if selected is None or item.key != selected.key:
            other = f" (level {item.evaluation.level})" if item.evaluation.level != level else ""
            shown.append((Series(f"pinned {item.label.lower()}{other}", f"pin{index + 1}"), item))
    if selected is not None and selected.kind != "initial":
        shown.append((Series(selected.label, "selected"), selected))
    return shown
