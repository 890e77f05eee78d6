"""The tabs of charts: only the chosen one is drawn, so a stream of generations costs no more than what is looked at."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.chips import NOTHING, box, chip, chips, soft
from explorer.views.saving import Figure, Saving, shown
from hpsop_core.markup import Markup, fill, joined


@dataclass(frozen=True)
class ChartTab:
    """A chart that can be chosen.

    Attributes:
        name: for events.
        title: on its button.
        topics: what it is drawn from.
        of: "design" or "run": which row its button stands in.
        render: charts and HTML in their order; called on the session's worker.
        controls: lists to choose from, apart, so that one that is open stays open while a chart is drawn anew.
        below: whether these stand below the charts instead of above.
    """

    name: str
    title: str
    of: str
    topics: frozenset[str]
    render: Callable[[Session, Designs], Sequence[Figure | Markup]]
    controls: Callable[[Session], Markup] | None = None
    below: bool = False


class ChartsView:
    """A row of buttons and the chosen chart."""

    def __init__(
        self, session: Session, designs: Designs, gui: viser.GuiApi, tabs: Mapping[str, ChartTab], saving: Saving
    ) -> None:
        self._session = session
        self._designs = designs
        self._tabs = tabs
        self._saving = saving
        self._bar = Slot(gui)
        self._controls = Slot(gui)
        self._html = Slot(gui)
        self._controls_below = Slot(gui)
        session.gestures.on("act", "tab", self._choose)
        topics = sorted({topic for tab in tabs.values() for topic in tab.topics})
        # another run changes most of them at once, and the chart is drawn once
        session.hub.on(topics, self._draw_again, self._html.failed, now=lambda topic: topic in self._chosen().topics)
        session.hub.on(("tab", "size"), self.draw, self._html.failed)
        self.draw()

    def draw(self) -> None:
        """Draw the bar and the chosen chart."""
        chosen = self._chosen()
        rows = joined(
            soft(word, "span")
            + chips(
                *(chip("tab", tab.title, tab.name, on=tab is chosen) for tab in self._tabs.values() if tab.of == of)
            )
            for of, word in (("design", "Design"), ("run", "Run"))
        )
        self._bar.show(box(fill('<div class="tools">{}</div>', rows)))
        self._draw_chart(chosen)

    def _draw_chart(self, chosen: ChartTab) -> None:
        controls = box(chosen.controls(self._session)) if chosen.controls is not None else NOTHING
        self._controls.show(NOTHING if chosen.below else controls)
        self._controls_below.show(controls if chosen.below else NOTHING)
        parts = chosen.render(self._session, self._designs)
        save = self._saving.offer([part for part in parts if isinstance(part, Figure)])
        self._html.show(box(fill('<div data-chart-tab="{}">{}</div>', chosen.name, shown(parts)), save))

    def _draw_again(self) -> None:
        self._draw_chart(self._chosen())

    def _chosen(self) -> ChartTab:
        return self._tabs.get(self._session.tab) or next(iter(self._tabs.values()))

    def _choose(self, event: PageEvent) -> None:
        if event.arg in self._tabs:
            self._session.choose_tab(event.arg)
