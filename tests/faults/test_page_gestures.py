"""Gestures come over a pool of threads and out of a browser that may say anything: each arrives once, in order."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from explorer.server.bridge import Bridge, PageEvent

THREADS, ROUNDS, BURST = 8, 60, 5


class _Gui:
    """As much of viser's interface as the bridge uses."""

    def __init__(self) -> None:
        self.channel = SimpleNamespace(value="", _impl=SimpleNamespace(uuid="channel"))
        self.channel.on_update = lambda callback: setattr(self, "callback", callback)
        self.callback: Any = None

    def add_text(self, _label: str, _value: str) -> Any:
        return self.channel

    def add_html(self, _content: str, order: float | None) -> Any:
        return SimpleNamespace()


@pytest.fixture
def hasty_threads() -> Iterator[None]:
    """Threads that take turns as often as Python lets them."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def test_gestures_arrive_once_and_in_order_from_a_pool_of_threads(hasty_threads: None):
    gui, received = _Gui(), []

    def receive(event: PageEvent) -> None:
        received.append(int(event.numbers["x"]))

    Bridge(gui, receive)  # type: ignore[arg-type]
    barrier = threading.Barrier(THREADS)

    def hammer(first: bool) -> None:
        for turn in range(ROUNDS):
            barrier.wait()
            if first:
                # a burst carries the latest events, those of the burst before among them
                numbers = range(max(turn - 1, 0) * BURST + 1, (turn + 1) * BURST + 1)
                gui.channel.value = json.dumps([{"t": "hover", "n": number, "x": number} for number in numbers])
            barrier.wait()
            gui.callback(SimpleNamespace(client_id=1))

    threads = [threading.Thread(target=hammer, args=(index == 0,)) for index in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert received == list(range(1, ROUNDS * BURST + 1))
