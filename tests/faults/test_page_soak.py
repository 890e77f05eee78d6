"""Minutes of three busy browsers, others that come and vanish, and runs that are switched under them all."""

from __future__ import annotations

import itertools
import json
import logging
import random
import shutil
import statistics
import threading
import time
from pathlib import Path
from typing import Any

import msgspec
import pytest
from page_client import connect_as
from run_files import small_case, wait_until
from test_page_visitors import CAMERA

from explorer.app import Explorer
from explorer.server import bridge
from explorer.server.process import serve_from_here
from explorer.server.security import free_port
from explorer.views.chart_tabs import chart_tabs
from hpsop_core.assets import asset_path
from hpsop_core.runs.controller import optimize

MINUTES = 20.0
WARM_UP = 8.0  # min: what is remembered of designs (shapes, curves, waves) fills up to its limit


class Busy(threading.Thread):
    """A browser that does something new as soon as the page has answered."""

    def __init__(self, explorer: Explorer, channels: list[bridge.Bridge], seed: int, stop: threading.Event) -> None:
        super().__init__(daemon=True)
        known = len(channels)
        self.socket = connect_as(explorer, f"http://127.0.0.1:{explorer.server.get_port()}")
        self.socket.send(msgspec.msgpack.encode(CAMERA))
        wait_until(lambda: len(channels) > known)
        self._channel = channels[-1]._channel._impl.uuid
        self._random = random.Random(seed)
        self._stop_asked = stop
        self.trips: list[float] = []
        self._heard = threading.Event()

    def run(self) -> None:
        threading.Thread(target=self._listen, daemon=True).start()
        for number in itertools.count(1):
            if self._stop_asked.is_set():
                return
            self._heard.clear()
            begun = time.monotonic()
            text = json.dumps([{"n": number, **self._something()}])
            message = {"type": "GuiUpdateMessage", "uuid": self._channel, "updates": {"value": text}}
            self.socket.send(msgspec.msgpack.encode(message))
            # some gestures meet nothing and have no answer
            if self._heard.wait(1.0):
                self.trips.append(1e3 * (time.monotonic() - begun))
            time.sleep(0.1)

    def _listen(self) -> None:
        try:
            while True:
                self.socket.recv()
                self._heard.set()
        except Exception:  # noqa: BLE001 - the end of the test
            return

    def _something(self) -> dict[str, Any]:
        draw = self._random
        return draw.choice(
            [
                {"t": "click", "chart": "pareto", "x": draw.uniform(0.85, 1.05), "y": draw.uniform(0.85, 1.2)},
                {"t": "hover", "chart": "pareto", "x": draw.uniform(0.85, 1.05), "y": draw.uniform(0.85, 1.2)},
                {"t": "zoom", "chart": "pareto", "fx": 0.5, "fy": 0.5, "factor": draw.uniform(0.5, 2.0)},
                {"t": "reset", "chart": "pareto"},
                {"t": "key", "key": draw.choice(["ArrowLeft", "ArrowRight", "Home", "End", "Escape"])},
                {"t": "act", "name": "tab", "arg": draw.choice(list(chart_tabs()))},
                {"t": "act", "name": "tab", "arg": "parallel"},
                {"t": "brush", "chart": "parallel", "fx0": draw.random(), "fy0": 0.0, "fy1": draw.random()},
                {"t": "act", "name": "table_page", "arg": draw.choice(["first", "on", "last", "selected"])},
                {"t": "act", "name": "table_which", "arg": draw.choice(["all", "front", "feasible"])},
                {"t": "act", "name": "table_sort", "arg": draw.choice(["f1", "f2", "id"])},
                {"t": "act", "name": "star", "arg": str(draw.randint(1, 60))},
                {"t": "act", "name": "layer", "arg": draw.choice(["archive", "infeasible"])},
            ]
        )


def _resident() -> float:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


@pytest.mark.soak
def test_the_page_stays_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.WARNING)
    # as the command does; whatever else runs in this process afterwards is none the worse
    serve_from_here()
    channels: list[bridge.Bridge] = []
    begin = bridge.Bridge.__init__

    def begun(self: bridge.Bridge, *arguments: Any) -> None:
        begin(self, *arguments)
        # those of the busy browsers alone: each holds its whole page
        if len(channels) < 3:
            channels.append(self)

    monkeypatch.setattr(bridge.Bridge, "__init__", begun)
    demonstration = next(item for item in asset_path("demo").iterdir() if item.name.endswith(".hpsop"))
    shutil.copy(str(demonstration), tmp_path / "long.hpsop")
    optimize(small_case(generations=3, level1_generations=3), tmp_path / "short.hpsop", workers=1)
    page = Explorer(small_case(), port=free_port("127.0.0.1", 8690), folder=tmp_path, workers=1)
    stop = threading.Event()
    busy = []
    try:
        page.services.runs.open_named("short.hpsop")
        for seed in range(3):
            busy.append(Busy(page, channels, seed, stop))
        for browser in busy:
            browser.start()
        begun_at, warm, memory = time.monotonic(), 0.0, []
        for number in itertools.count():
            spent = (time.monotonic() - begun_at) / 60.0
            if spent > MINUTES:
                break
            page.services.runs.open_named("long.hpsop" if number % 2 else "short.hpsop")
            socket = connect_as(page, f"http://127.0.0.1:{page.server.get_port()}")
            socket.send(msgspec.msgpack.encode(CAMERA))
            socket.socket.close()
            time.sleep(2.0)
            if spent > WARM_UP:
                warm = warm or _resident()
                memory.append(_resident())
        stop.set()
        trips = sorted(trip for browser in busy for trip in browser.trips)
        typical, slow = statistics.median(trips), trips[int(0.95 * len(trips))]
        print(f"{len(trips)} round trips, median {typical:.0f} ms, p95 {slow:.0f} ms")
        print(f"resident {warm:.0f} MB after the warm-up, {memory[-1]:.0f} MB at the end, at most {max(memory):.0f} MB")
        lines = [record.getMessage() for record in caplog.records]
        assert not [record for record in caplog.records if record.exc_info], lines
        # the allocator keeps some of what was freed
        assert memory[-1] < 1.15 * warm
    finally:
        stop.set()
        page.close()
