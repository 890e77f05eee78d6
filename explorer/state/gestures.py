"""Which handler answers which gesture of a browser."""

from __future__ import annotations

from collections.abc import Callable

from explorer.server.bridge import PageEvent
from explorer.server.worker import LatestWorker

Handler = Callable[[PageEvent], None]
# kinds that belong to the page as a whole and not to one of its charts
_OF_THE_PAGE = ("hello", "stands", "tabs", "size", "key")
# of a stream of these only the newest counts
_STREAMS = ("hover", "pan")


class Gestures:
    """Hands each gesture to its handler, on the browser's own thread.

    Args:
        worker: the thread.
    """

    def __init__(self, worker: LatestWorker) -> None:
        self._worker = worker
        self._handlers: dict[tuple[str, str], Handler] = {}

    def on(self, kind: str, target: str, handler: Handler) -> None:
        """Let ``handler`` answer a gesture: kind and chart ("click", "pareto"), or "act" and the button's name."""
        self._handlers[(kind, target)] = handler

    def receive(self, event: PageEvent) -> None:
        """A gesture from the browser, whatever thread brings it."""
        target = event.name if event.kind == "act" else "" if event.kind in _OF_THE_PAGE else event.chart
        handler = self._handlers.get((event.kind, target))
        if handler is None:
            return
        if event.kind in _STREAMS:
            self._worker.latest(f"{event.kind} {target}", lambda: handler(event), first=True)
        else:
            self._worker.every(lambda: handler(event), first=True)
