"""Who wants to know of which topic."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from explorer.server.worker import LatestWorker


def _told(callback: Callable[[], None], failed: Callable[[BaseException], None]) -> Callable[[], None]:
    def run() -> None:
        try:
            callback()
        except Exception as error:
            failed(error)
            raise

    return run


@dataclass(frozen=True)
class _Wish:
    """What one view asked for: its waiting slot, how it is drawn, its tab, and whether it wants a topic just now."""

    key: str
    callback: Callable[[], None]
    tab: str
    now: Callable[[str], bool]


class Hub:
    """Tells views that a topic changed.

    A view is called on the hub's own thread, where a newer call replaces one that still waits: a stream of generations
    never piles up behind a slow browser, and callbacks of viser's pool never overlap inside a view.

    Args:
        worker: the thread.
    """

    def __init__(self, worker: LatestWorker) -> None:
        self._worker = worker
        self._wanted: dict[str, list[_Wish]] = {}
        self._lock = threading.Lock()
        self._serial = 0
        self._tab = ""
        self._open: frozenset[str] | None = None

    @contextlib.contextmanager
    def in_tab(self, title: str) -> Iterator[None]:
        """Views that are made within stand in the tab of this title."""
        self._tab = title
        try:
            yield
        finally:
            # where a view cannot be made too: what is made after it stands elsewhere
            self._tab = ""

    def tabs_open(self, titles: Iterable[str]) -> None:
        """These tabs are seen, and the others not: their views are drawn when nobody waits for anything."""
        self._open = frozenset(titles)

    def on(
        self,
        topics: Iterable[str],
        callback: Callable[[], None],
        failed: Callable[[BaseException], None] | None = None,
        now: Callable[[str], bool] = lambda topic: True,
    ) -> None:
        """Call ``callback`` on the worker after any of these topics changed.

        Args:
            topics: of any number.
            callback: draws a view anew.
            failed: told of what it raises, so that the view can say so instead of what stood there before.
            now: whether what the view shows just now depends on this topic; asked in the thread of the change.
        """
        if failed is not None:
            callback = _told(callback, failed)
        with self._lock:
            self._serial += 1
            for topic in topics:
                self._wanted.setdefault(topic, []).append(_Wish(f"view {self._serial}", callback, self._tab, now))

    def wait_until_drawn(self, timeout: float) -> None:
        """Until all views have drawn what they were told of, ``timeout`` seconds at most."""
        self._worker.wait_until_idle(timeout)

    def wait_until_answered(self, timeout: float) -> None:
        """While a gesture waits or is in work, ``timeout`` seconds at most."""
        self._worker.wait_until_answered(timeout)

    def changed(self, *topics: str, news: bool = False) -> None:
        """Tell; a view that wants several of the topics is called once.

        Args:
            topics: of any number.
            news: whether nobody has asked for it: a run goes on. Then whatever a person waits for is drawn before.
        """
        with self._lock:
            wishes = [(topic, wish) for topic in topics for wish in self._wanted.get(topic, [])]
        called = {wish.key: wish for topic, wish in wishes if wish.now(topic)}
        for wish in called.values():
            unseen = bool(wish.tab) and self._open is not None and wish.tab not in self._open
            self._worker.latest(wish.key, wish.callback, first=not news and not unseen, last=unseen)
