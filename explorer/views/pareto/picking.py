"""Gestures on the Pareto chart: picking designs, and choosing what part of the chart is seen."""

from __future__ import annotations

import math

import viser

from explorer.charts.pareto import front_order, newest_families, pick
from explorer.server.bridge import PageEvent, tooltip
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.session import Limits, Session
from explorer.views.chips import NOTHING, soft
from explorer.views.on_display import select_design
from explorer.views.pareto.chart import ParetoChart
from explorer.views.tables import design_card
from explorer.views.zooming import Zooming
from hpsop_core.markup import Markup
from hpsop_core.quantities import size_of_case

# a click so near to the initial design's mark means it, px
_NEAR = 14.0
# objectives are parts of the initial design's: what is zoomed to, at the least, and where the chart ends
_LEAST_SPAN, _FARTHEST = 1e-6, 1e3


def _seen(limits: Limits) -> bool:
    """Whether a chart can be drawn within these: objectives are of the order of one."""
    return all(_LEAST_SPAN < high - low < _FARTHEST and max(abs(low), abs(high)) < _FARTHEST for low, high in limits)


class ParetoPicking:
    """Clicks, hovers, wheel, drags, boxes and keys of one browser; the card beside the pointer."""

    def __init__(self, session: Session, designs: Designs, chart: ParetoChart, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs = designs
        self._chart = chart
        self._serial = 0
        self._hovered: tuple[int, ...] = ()
        self._tip = Slot(gui)
        for kind, handler in (
            ("click", self._click),
            ("hover", self._hover),
            ("box", self._box),
        ):
            session.gestures.on(kind, "pareto", handler)
        Zooming(session, "pareto", lambda: chart.limits, _seen)
        session.gestures.on("key", "", self._key)
        for name, action in (("layer", self._layer), ("unfilter", self._unfilter), ("unzoom", self._reset)):
            session.gestures.on("act", name, action)

    # ---- designs ---------------------------------------------------------------------------------------------------
    def _candidates(self, event: PageEvent) -> list[int]:
        x, y = event.numbers.get("x"), event.numbers.get("y")
        if x is None or y is None:
            return []
        return pick(self._session.picture, self._chart.options, x, y, self._chart.limits, self._chart.plot_size)

    def _click(self, event: PageEvent) -> None:
        found = self._candidates(event)
        if not found:
            self._click_initial(event)
            return
        selected = self._session.selected
        design_id = found[0]
        # A second click on the same spot goes on to the next of the designs that coincide there.
        if selected is not None and selected.design_id in found:
            design_id = found[(found.index(selected.design_id) + 1) % len(found)]
        select_design(self._session, self._designs, design_id)

    def _click_initial(self, event: PageEvent) -> None:
        x, y = event.numbers.get("x"), event.numbers.get("y")
        initial = self._designs.first()
        f1, f2 = (initial.evaluation.objectives.get(name) for name in ("f1", "f2"))
        if x is None or y is None or f1 is None or f2 is None:
            return
        (x0, x1), (y0, y1) = self._chart.limits
        width, height = self._chart.plot_size
        if math.hypot((f1 - x) / (x1 - x0) * width, (f2 - y) / (y1 - y0) * height) < _NEAR:
            self._session.select(initial)

    def _hover(self, event: PageEvent) -> None:
        found = self._candidates(event)
        if tuple(found) == self._hovered and found:
            return
        self._hovered = tuple(found)
        self._serial += 1
        shown = self._designs.shown(found[0]) if found else None
        if shown is None:
            self._tip.show(tooltip("pareto", NOTHING, self._serial))
            return
        crowded = len(found) > 1
        more = soft(f"{len(found)} designs coincide here: click again for the next.") if crowded else NOTHING
        card = design_card(shown, size_of_case(self._session.picture.case))
        self._tip.show(tooltip("pareto", card + more + self._family(found[0]), self._serial))

    def _family(self, design_id: int) -> Markup:
        """How many designs of the newest front cannot be told from this one."""
        picture = self._session.picture
        rows, names, _ = newest_families(picture, self._session.scrubbed)
        own = [name for row, name in zip(rows, names, strict=True) if int(picture.ids[row]) == design_id]
        count = names.count(own[0]) if own else 0
        return (
            soft(f"One of {count} designs that the error of their numbers cannot tell apart.") if count > 1 else NOTHING
        )

    def _key(self, event: PageEvent) -> None:
        session = self._session
        if event.key == "Escape":
            session.clear_filters()
            session.zoom("pareto", None)
            return
        order = front_order(session.picture, session.scrubbed)
        if not order:
            return
        selected = session.selected
        now = selected.design_id if selected is not None else None
        if event.key == "Home":
            target = 0
        elif event.key == "End":
            target = len(order) - 1
        else:
            step = 1 if event.key in ("ArrowRight", "]") else -1
            target = order.index(now) + step if now in order else (0 if step > 0 else len(order) - 1)
        select_design(session, self._designs, order[min(max(target, 0), len(order) - 1)])

    # ---- what is seen ----------------------------------------------------------------------------------------------
    def _box(self, event: PageEvent) -> None:
        x0, x1, y0, y1 = (event.numbers.get(name) for name in ("x0", "x1", "y0", "y1"))
        if x0 is None or x1 is None or y0 is None or y1 is None:
            return
        self._session.filter({"f1": (min(x0, x1), max(x0, x1)), "f2": (min(y0, y1), max(y0, y1))})

    def _reset(self, _event: PageEvent) -> None:
        self._session.zoom("pareto", None)

    def _unfilter(self, _event: PageEvent) -> None:
        self._session.clear_filters()

    def _layer(self, event: PageEvent) -> None:
        self._session.switch_layer(event.arg)
