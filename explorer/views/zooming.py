"""Wheel, drag and double click on a chart choose what part of it is seen."""

from __future__ import annotations

from collections.abc import Callable

from explorer.server.bridge import PageEvent
from explorer.state.session import Limits, Session


class Zooming:
    """Zoom and pan of one chart of one browser.

    Args:
        session: whose chart.
        chart: its name.
        drawn: the limits that it has, or will have as soon as it is drawn again.
        sensible: whether a chart can be drawn within some limits.
    """

    def __init__(
        self,
        session: Session,
        chart: str,
        drawn: Callable[[], Limits],
        sensible: Callable[[Limits], bool],
    ) -> None:
        self._session = session
        self._chart = chart
        self._drawn = drawn
        self._sensible = sensible
        self._panned: tuple[float, Limits] | None = None
        for kind, handler in (("zoom", self._zoom), ("pan", self._pan), ("reset", self._reset)):
            session.gestures.on(kind, chart, handler)

    def _limits(self) -> Limits:
        # several turns of the wheel may come before the chart is redrawn
        return self._session.limits.get(self._chart) or self._drawn()

    def _zoom(self, event: PageEvent) -> None:
        fx, fy, factor = (event.numbers.get(name) for name in ("fx", "fy", "factor"))
        if fx is None or fy is None or factor is None or not 0.2 < factor < 5.0:
            return
        # what stays in place is a fraction of the plot
        (x0, x1), (y0, y1) = self._limits()
        x, y = x0 + fx * (x1 - x0), y0 + fy * (y1 - y0)
        limits = ((x + (x0 - x) * factor, x + (x1 - x) * factor), (y + (y0 - y) * factor, y + (y1 - y) * factor))
        if self._sensible(limits):
            self._session.zoom(self._chart, limits)

    def _pan(self, event: PageEvent) -> None:
        fx, fy, drag = (event.numbers.get(name) for name in ("fx", "fy", "drag"))
        if fx is None or fy is None or drag is None or not max(abs(fx), abs(fy)) < 100.0:
            return
        if self._panned is None or self._panned[0] != drag:
            self._panned = (drag, self._limits())
        (x0, x1), (y0, y1) = self._panned[1]
        dx, dy = fx * (x1 - x0), fy * (y1 - y0)
        limits = ((x0 - dx, x1 - dx), (y0 - dy, y1 - dy))
        if self._sensible(limits):
            self._session.zoom(self._chart, limits)

    def _reset(self, _event: PageEvent) -> None:
        self._session.zoom(self._chart, None)
