"""Minutes of three busy browsers, others that come and vanish, and runs that are switched under them all."""

from __future__ import annotations

import asyncio
import itertools
import json
import logging
import random
import shutil
import threading
import time
from pathlib import Path
from typing import Any

import msgspec
import pytest
from page_client import connect_as
from page_trips import Trip, Trips, told
from run_files import small_case, wait_until
from test_page_visitors import CAMERA
from viser._messages import RunJavascriptMessage
from viser.infra._async_message_buffer import AsyncMessageBuffer

from explorer.app import Explorer
from explorer.server import bridge
from explorer.server.bridge import PageEvent
from explorer.server.process import serve_from_here
from explorer.server.security import free_port
from explorer.server.worker import LatestWorker
from explorer.state.gestures import Gestures
from explorer.state.hub import Hub
from explorer.state.session import Session
from explorer.views.chart_tabs import chart_tabs
from hpsop_core.assets import asset_path
from hpsop_core.runs.controller import optimize

MINUTES = 20.0
WARM_UP = 8.0  # min: what is remembered of designs (shapes, curves, waves) fills up to its limit


class Busy(threading.Thread):
    """A browser that does something new as soon as the page has answered, or has nothing to say to what it did."""

    def __init__(self, explorer: Explorer, channels: list[bridge.Bridge], follow: Trips, seed: int) -> None:
        super().__init__(daemon=True)
        known, there = len(channels), set(explorer.state.sessions)
        self._follow = follow
        self.socket = connect_as(explorer, f"http://127.0.0.1:{explorer.server.get_port()}")
        self.socket.send(msgspec.msgpack.encode(CAMERA))
        wait_until(lambda: len(channels) > known and set(explorer.state.sessions) > there)
        self._channel = channels[-1]._channel._impl.uuid
        (client,) = set(explorer.state.sessions) - there
        session = explorer.state.sessions[client]
        assert isinstance(session, Session)
        self._gestures = session.gestures
        self._buffer = explorer.server._websock_server._client_state_from_id[client].message_buffer
        self._random = random.Random(seed)
        self.stop = threading.Event()
        self.trips: list[Trip] = []

    def run(self) -> None:
        threading.Thread(target=self._listen, daemon=True).start()
        for number in itertools.count(1):
            if self.stop.is_set():
                return
            gesture = self._something()
            trip = Trip(f"{gesture['t']} {gesture.get('name', '')}".strip(), self._buffer)
            text = json.dumps([{"n": number, **gesture}])
            message = {"type": "GuiUpdateMessage", "uuid": self._channel, "updates": {"value": text}}
            self.trips.append(trip)
            self._follow.expect(self._gestures, trip)
            self.socket.send(msgspec.msgpack.encode(message))
            if not trip.done.wait(60.0) or (trip.drawn and not trip.heard.wait(60.0)):
                return
            time.sleep(0.1)

    def _listen(self) -> None:
        try:
            while True:
                frame = self.socket.recv()
                if self.trips:
                    self.trips[-1].hear(frame)
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
                {"t": "brush", "chart": "parallel", "fx0": draw.random(), "fx1": 0.5, "fy0": 0.0, "fy1": draw.random()},
                {"t": "act", "name": "table_page", "arg": draw.choice(["first", "on", "last", "selected"])},
                {"t": "act", "name": "table_which", "arg": draw.choice(["all", "front", "feasible"])},
                {"t": "act", "name": "table_sort", "arg": draw.choice(["f1", "f2", "id"])},
                {"t": "act", "name": "star", "arg": str(draw.randint(1, 60))},
                {"t": "act", "name": "layer", "arg": draw.choice(["archive", "infeasible"])},
            ]
        )


def test_an_answer_is_the_answer_to_its_gesture(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is sent without having been asked for answers nobody, and a gesture that meets nothing has no answer."""
    follow, loop = Trips(monkeypatch), asyncio.new_event_loop()
    buffer = AsyncMessageBuffer(loop, persistent_messages=False)
    worker, held = LatestWorker("test"), threading.Event()
    hub, gestures = Hub(worker), Gestures(worker)

    def draws(what: str) -> None:
        buffer.push(RunJavascriptMessage(what))

    try:
        hub.on(("tab",), lambda: draws("the chart"))
        gestures.on("act", "tab", lambda event: hub.changed("tab"))
        met, missed, late = Trip("act tab", buffer), Trip("act nothing", buffer), Trip("act tab", buffer)
        for trip, name in ((met, "tab"), (missed, "nothing")):
            follow.expect(gestures, trip)
            draws("news of a run")
            gestures.receive(PageEvent("act", name=name))
            assert trip.done.wait(60.0)
        # a run's news take the place of what the gesture has asked for, and answer it
        worker.every(lambda: bool(held.wait(60.0)), first=True)
        with follow.following(late):
            hub.changed("tab")
        hub.changed("tab", news=True)
        held.set()
        assert late.done.wait(60.0)
        sent = [message.source for message in buffer.message_from_id.values()]
        assert sent == ["news of a run", "the chart", *met.marks, "news of a run", "the chart", *late.marks]
        assert met.drawn and late.drawn and not missed.drawn
    finally:
        held.set()
        worker.close()
        loop.close()


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
    follow = Trips(monkeypatch)
    busy: list[Busy] = []
    switches: list[Trip] = []
    try:
        page.services.runs.open_named("short.hpsop")
        for seed in range(3):
            busy.append(Busy(page, channels, follow, seed))
        for browser in busy:
            browser.start()
        begun_at, memory = time.monotonic(), []
        for number in itertools.count():
            spent = (time.monotonic() - begun_at) / 60.0
            if spent > MINUTES:
                break
            switches.append(Trip("switch"))
            switches[-1].sent = time.monotonic()
            with follow.following(switches[-1]):
                page.services.runs.open_named("long.hpsop" if number % 2 else "short.hpsop")
            socket = connect_as(page, f"http://127.0.0.1:{page.server.get_port()}")
            socket.send(msgspec.msgpack.encode(CAMERA))
            socket.socket.close()
            time.sleep(2.0)
            if spent > WARM_UP:
                memory.append(_resident())
        assert all(browser.is_alive() for browser in busy), "a gesture was lost"
        print(told([trip for browser in busy for trip in browser.trips if trip.ended], switches))
        # a look may fall into the reading of the large run, which takes 100 MB for two seconds
        part = max(len(memory) // 4, 1)
        warm, end = min(memory[:part]), min(memory[-part:])
        print(f"resident {warm:.0f} MB after the warm-up, {end:.0f} MB at the end, at most {max(memory):.0f} MB")
        lines = [record.getMessage() for record in caplog.records]
        assert not [record for record in caplog.records if record.exc_info], lines
        # the allocator keeps some of what was freed
        assert end < 1.15 * warm
    finally:
        for browser in busy:
            browser.stop.set()
        page.close()
