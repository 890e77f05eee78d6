"""Which of the page's messages answers which gesture: followed through the page's own threads.

A browser that takes the first message after its gesture for the answer measures something else: many a gesture meets
nothing, and what becomes of a run comes to everybody. A test in the page's process knows better: what a gesture's
handler asks for is asked for by the gesture, what that asks for too, and what is sent meanwhile is the answer. A mark
goes to the browser behind it.
"""

from __future__ import annotations

import itertools
import statistics
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest
import zstandard
from viser._messages import RunJavascriptMessage
from viser.infra._async_message_buffer import AsyncMessageBuffer

from explorer.server.bridge import PageEvent
from explorer.server.worker import LatestWorker
from explorer.state.gestures import Gestures

_serials = itertools.count(1)


@dataclass(eq=False)
class Trip:
    """A gesture's way through the page and back, or another cause of drawing. Times are monotonic, 0 until then.

    Attributes:
        kind: of gesture.
        buffer: of messages to the browser that made it; None where no browser did.
        sent, received: when the browser sent it, and when the page had it.
        begun, handled: when its handler began and ended.
        drawn: when the first message of its answer was given to be sent; stays 0 where it meets nothing.
        answered: when the browser heard that one.
        ended: when all was drawn that it asked for; maps, curves, the ship in 3D and a large run's numbers apart.
        complete: when the browser had heard all of that.
        done, heard: set with ``ended`` and ``complete``.
    """

    kind: str
    buffer: AsyncMessageBuffer | None = None
    sent: float = 0.0
    received: float = 0.0
    begun: float = 0.0
    handled: float = 0.0
    drawn: float = 0.0
    answered: float = 0.0
    ended: float = 0.0
    complete: float = 0.0
    done: threading.Event = field(default_factory=threading.Event)
    heard: threading.Event = field(default_factory=threading.Event)
    serial: int = field(default_factory=lambda: next(_serials))
    under_way: int = 0

    @property
    def marks(self) -> tuple[str, str]:
        """What stands behind the first and the last message of the answer."""
        return f"// first of {self.serial};", f"// last of {self.serial};"

    def hear(self, frame: bytes | str) -> None:
        """The browser has heard this."""
        now = time.monotonic()
        if not isinstance(frame, bytes):
            return
        # viser's frame: two lengths, then the packed messages
        text = zstandard.ZstdDecompressor().decompress(frame[16 : 16 + int.from_bytes(frame[8:16], "little")])
        first, last = self.marks
        if first.encode() in text:
            self.answered = now
        if last.encode() in text:
            self.complete = now
            self.heard.set()


class Trips:
    """Follows what is done within ``following``, and the gestures that are ``expected``.

    Args:
        monkeypatch: gives the page's threads back as they were.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._thread = threading.local()
        self._lock = threading.Lock()
        self._waiting: dict[tuple[int, str], frozenset[Trip]] = {}
        self._expected: dict[int, Trip] = {}
        self._latest, self._push = LatestWorker.latest, AsyncMessageBuffer.push
        receive = Gestures.receive

        def received(gestures: Gestures, event: PageEvent) -> None:
            with self._lock:
                trip = self._expected.pop(id(gestures), None)
            if trip is not None:
                trip.received = time.monotonic()
            with self.following(*(() if trip is None else (trip,))):
                receive(gestures, event)

        monkeypatch.setattr(Gestures, "receive", received)
        monkeypatch.setattr(LatestWorker, "latest", lambda worker, *asked, **how: self._follow(worker, *asked, **how))
        monkeypatch.setattr(AsyncMessageBuffer, "push", lambda buffer, message: self._sent(buffer, message))

    def expect(self, gestures: Gestures, trip: Trip) -> None:
        """The next gesture of this browser, which it sends now, is this one."""
        with self._lock:
            self._expected[id(gestures)] = trip
        trip.sent = time.monotonic()

    @contextmanager
    def following(self, *trips: Trip) -> Iterator[None]:
        """What this thread asks for within is asked for by these."""
        before, self._thread.trips = self._here, frozenset(trips)
        self._hold(trips)
        try:
            yield
        finally:
            self._thread.trips = before
            self._release(trips)

    @property
    def _here(self) -> frozenset[Trip]:
        trips: frozenset[Trip] = getattr(self._thread, "trips", frozenset())
        return trips

    def _follow(
        self, worker: LatestWorker, key: str, task: Callable[[], None], first: bool = False, last: bool = False
    ) -> None:
        place = id(worker), key
        # what may take seconds is waited for by nobody
        counts = not worker._thread.name.startswith(("scene-", "maps-", "pictures"))
        with worker._condition:
            # a task that takes a waiting one's place answers for that one too
            before = self._waiting.get(place, frozenset()) if worker.waiting(key) else frozenset()
            trips = self._waiting[place] = before | self._here
            if counts:
                self._hold(trips - before)

            def run() -> None:
                for trip in trips:
                    trip.begun = trip.begun or time.monotonic()
                earlier, self._thread.trips = self._here, trips
                try:
                    task()
                finally:
                    self._thread.trips = earlier
                    for trip in trips:
                        trip.handled = trip.handled or time.monotonic()
                    if counts:
                        self._release(trips)

            self._latest(worker, key, run, first, last)

    def _sent(self, buffer: AsyncMessageBuffer, message: Any) -> None:
        self._push(buffer, message)
        for trip in self._here:
            if trip.buffer is buffer and not trip.drawn:
                trip.drawn = time.monotonic()
                self._push(buffer, RunJavascriptMessage(trip.marks[0]))

    def _hold(self, trips: Iterable[Trip]) -> None:
        with self._lock:
            for trip in trips:
                trip.under_way += 1

    def _release(self, trips: Iterable[Trip]) -> None:
        for trip in trips:
            with self._lock:
                trip.under_way -= 1
                if trip.under_way or trip.ended:
                    continue
                trip.ended = time.monotonic()
            if trip.buffer is not None and trip.drawn:
                self._push(trip.buffer, RunJavascriptMessage(trip.marks[1]))
            trip.done.set()


def told(trips: Sequence[Trip], meanwhile: Sequence[Trip]) -> str:
    """For people: the trips by kind, and apart those into which any of ``meanwhile`` fell."""
    apart = {trip for trip in trips if any(_meet(trip, other) for other in meanwhile)}
    rows = [("all", list(trips)), ("meanwhile", list(apart)), ("else", list(set(trips) - apart))]
    rows += [(kind, [trip for trip in trips if trip.kind == kind]) for kind in sorted({trip.kind for trip in trips})]
    lines = [f"{'':16}{'made':>7}{'answered':>9}   ms: first answer p50, p95, worst; all of it p50, p95, worst"]
    for name, some in rows:
        found = [trip for trip in some if trip.answered]
        times = (_times([trip.answered - trip.sent for trip in found]), _times([t.complete - t.sent for t in found]))
        lines.append(f"{name:16}{len(some):7}{len(found):9}   {times[0]}   {times[1]}")
    return "\n".join(lines)


def _meet(trip: Trip, other: Trip) -> bool:
    return trip.sent < (other.ended or float("inf")) and other.sent < max(trip.ended, trip.complete)


def _times(seconds: Sequence[float]) -> str:
    if not seconds:
        return " " * 18
    ordered = sorted(1e3 * value for value in seconds)
    return f"{statistics.median(ordered):6.0f}{ordered[int(0.95 * len(ordered))]:6.0f}{ordered[-1]:6.0f}"
