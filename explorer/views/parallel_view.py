"""Brushes on the parallel coordinates."""

from __future__ import annotations

from explorer.charts.parallel import brushed
from explorer.server.bridge import PageEvent
from explorer.state.session import Session


class ParallelBrushes:
    """Turns drags along an axis into range filters."""

    def __init__(self, session: Session) -> None:
        self._session = session
        session.gestures.on("brush", "parallel", self._brush)
        session.gestures.on("click", "parallel", self._click)

    def _brush(self, event: PageEvent) -> None:
        fx, fy0, fy1 = (event.numbers.get(name) for name in ("fx0", "fy0", "fy1"))
        if fx is not None and fy0 is not None and fy1 is not None:
            self._apply(fx, fy0, fy1)

    def _click(self, event: PageEvent) -> None:
        fx, fy = event.numbers.get("fx"), event.numbers.get("fy")
        if fx is not None and fy is not None:
            self._apply(fx, fy, fy)

    def _apply(self, fx: float, fy0: float, fy1: float) -> None:
        found = brushed(self._session.picture, fx, fy0, fy1)
        if found is not None:
            key, limits = found
            self._session.filter({key: limits})
