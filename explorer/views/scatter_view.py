"""The scatter chart of one browser: what it shows, and which design a gesture on it means."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from explorer.charts.designs_table import known_columns
from explorer.charts.scatter import (
    GESTURES,
    choices,
    chosen,
    pick_scatter,
    scatter_chart,
    scatter_limits,
    scatter_rows,
    scatter_words,
)
from explorer.server.bridge import PageEvent, tooltip
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.session import Limits, Session
from explorer.state.shown import Shown
from explorer.views.charts_view import ChartTab
from explorer.views.chips import NOTHING, chips, soft
from explorer.views.on_display import select_design
from explorer.views.saving import Figure
from explorer.views.tables import design_card
from explorer.views.zooming import Zooming
from hpsop_core.charts.looks import Sheet
from hpsop_core.charts.search import Mark
from hpsop_core.markup import Markup
from hpsop_core.quantities import Quantity, size_of_case

_CHOICES = (("x", "x", False), ("y", "y", False), ("colour", "colour", True), ("size", "size", True))
_TOPICS = frozenset({"run", "filter", "selection", "pins", "scrub", "layers", "charts", "zoom scatter"})


def choose_quantity(session: Session, event: PageEvent) -> None:
    """A quantity chosen in a list: "colour=draft"; one that the run does not have is not taken."""
    name, _, key = event.arg.partition("=")
    optional = {choice: may for choice, _, may in _CHOICES} | {"axis_colour": True}
    if name in optional and (key in known_columns(session.picture) or (not key and optional[name])):
        session.set_charts(**{name: key})
        if name in ("x", "y"):
            session.zoom("scatter", None)


class ScatterView:
    """Draws the chart when its tab is chosen, and answers clicks, hovers, wheel and drags on it."""

    def __init__(self, session: Session, designs: Designs, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs = designs
        self._tip = Slot(gui)
        self._serial = 0
        self._hovered = -1
        self._size = (1.0, 1.0)
        session.gestures.on("click", "scatter", self._click)
        session.gestures.on("hover", "scatter", self._hover)
        session.gestures.on("act", "chart_choice", lambda event: choose_quantity(session, event))
        Zooming(session, "scatter", self._limits, _drawable)

    def tab(self) -> ChartTab:
        """The chart among the others."""
        return ChartTab("scatter", "Scatter", "run", _TOPICS, self._render, self._controls)

    def _rows(self) -> NDArray[np.int64]:
        session = self._session
        return scatter_rows(session.picture, session.scrubbed, session.infeasible)

    def _limits(self) -> Limits:
        session = self._session
        return session.limits.get("scatter") or scatter_limits(session.picture, session.charts, self._rows())

    def _render(self, session: Session, designs: Designs) -> Sequence[Figure | Markup]:
        picture, options, rows = session.picture, session.charts, self._rows()
        sheet = Sheet(session.chart_width, min(max(0.36 * session.size[1], 230.0), 420.0))
        plot = scatter_chart(picture, options, rows, session.filters, self._limits(), self._marks(designs), sheet)
        self._size = (plot.area.width, plot.area.height)
        hint = "Click a point to select its design; wheel and drag zoom and pan, a double click shows all."
        return [Figure("scatter", plot, gestures=GESTURES), scatter_words(picture, options, rows), soft(hint)]

    def _controls(self, session: Session) -> Markup:
        wanted = chosen(session.picture, session.charts)
        keys = {name: item.key if item is not None else "" for name, item in vars(wanted).items()}
        return chips(*(choices(name, session.picture, keys[name], word, may) for name, word, may in _CHOICES))

    def _marks(self, designs: Designs) -> list[Mark]:
        session = self._session
        wanted = chosen(session.picture, session.charts)
        marked: list[tuple[Shown, str, float, str, str]] = [
            (designs.first(), "square", 4.5, "initial", "initial design")
        ]
        for index, item in enumerate(session.pins):
            marked.append((item, "triangle", 5.5, f"pin{index + 1}", f"pinned: {item.label}"))
        if session.selected is not None:
            marked.append((session.selected, "ring", 8.0, "selected", f"selected: {session.selected.label}"))
        return [
            Mark(_value(item, wanted.x), _value(item, wanted.y), shape, size, css, title)
            for item, shape, size, css, title in marked
        ]

    # ---- gestures --------------------------------------------------------------------------------------------------
    def _near(self, event: PageEvent) -> int | None:
        x, y = event.numbers.get("x"), event.numbers.get("y")
        if x is None or y is None:
            return None
        session = self._session
        found = pick_scatter(session.picture, session.charts, self._rows(), (x, y), self._limits(), self._size)
        return found[0] if found else None

    def _click(self, event: PageEvent) -> None:
        found = self._near(event)
        if found is not None:
            select_design(self._session, self._designs, found)

    def _hover(self, event: PageEvent) -> None:
        found = self._near(event)
        if found is not None and found == self._hovered:
            return
        self._hovered = -1 if found is None else found
        self._serial += 1
        shown = self._designs.shown(found) if found is not None else None
        card = design_card(shown, size_of_case(self._session.picture.case)) if shown is not None else NOTHING
        self._tip.show(tooltip("scatter", card, self._serial))


def _value(shown: Shown, quantity: Quantity) -> float:
    value = quantity.value(shown.evaluation) if shown.evaluation.ok else None
    return math.nan if value is None else float(value)


def _drawable(limits: Limits) -> bool:
    return all(
        math.isfinite(low)
        and math.isfinite(high)
        and high - low > 1e-9 * max(abs(low), abs(high))
        and high - low < 1e12
        for low, high in limits
    )
