"""Gestures on the parallel coordinates: a drag along an axis keeps a range, its name is dragged or stepped."""

from __future__ import annotations

from explorer.charts.parallel import brushed, moved, stepped
from explorer.server.bridge import PageEvent
from explorer.state.session import Session

# above the axes' ends and the numbers beside them stand their names; page.js draws its band by the same number
_TOP = 1.06


class ParallelBrushes:
    """Turns drags into range filters, and into another order of the axes."""

    def __init__(self, session: Session) -> None:
        self._session = session
        session.gestures.on("brush", "parallel", self._brush)
        session.gestures.on("click", "parallel", self._click)
        session.gestures.on("act", "axis_move", self._step)

    def _brush(self, event: PageEvent) -> None:
        fx, fy0, fy1 = (event.numbers.get(name) for name in ("fx0", "fy0", "fy1"))
        end = event.numbers.get("fx1")
        if fx is None or fy0 is None or fy1 is None or end is None:
            return
        if fy0 <= _TOP:
            self._apply(fx, fy0, fy1)
            return
        order = moved(self._session.picture, self._session.charts.axes, fx, end)
        if order is not None:
            self._session.set_charts(axes=order)

    def _step(self, event: PageEvent) -> None:
        """An arrow key on the name of an axis: "draft=1"."""
        key, _, by = event.arg.partition("=")
        if by in ("1", "-1"):
            order = stepped(self._session.picture, self._session.charts.axes, key, int(by))
            if order is not None:
                self._session.set_charts(axes=order)

    def _click(self, event: PageEvent) -> None:
        fx, fy = event.numbers.get("fx"), event.numbers.get("fy")
        if fx is not None and fy is not None and fy <= _TOP:
            self._apply(fx, fy, fy)

    def _apply(self, fx: float, fy0: float, fy1: float) -> None:
        found = brushed(self._session.picture, self._session.charts.axes, fx, fy0, fy1)
        if found is not None:
            key, limits = found
            self._session.filter({key: limits})
