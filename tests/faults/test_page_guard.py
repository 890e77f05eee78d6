"""What a browser that was let in may say: share tunnels, uploads, and values no widget could send."""

from __future__ import annotations

import asyncio
import math
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import msgspec
import pytest
from page_client import Hostile
from viser._messages import GuiCloseModalMessage
from viser.infra._async_message_buffer import AsyncMessageBuffer

from explorer.app import Explorer
from explorer.server.guard import check_update
from explorer.server.security import free_port
from explorer.server.wakeups import MarkedEvent
from explorer.state.draft import Draft
from hpsop_core.errors import InputError
from tests.two_speeds import stated_case


@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Any:
    # stated waves: the initial design then needs level 1 alone
    case = stated_case()
    page = Explorer(case, port=free_port("127.0.0.1", 8560), folder=tmp_path_factory.mktemp("runs"), workers=1)
    yield page
    page.close()


def _port(explorer: Explorer) -> int:
    return int(explorer.server.get_port())


@pytest.fixture(scope="module")
def hostile(explorer: Explorer) -> Any:
    client = Hostile(explorer)
    yield client
    client.socket.close()


def test_only_this_machine_is_listened_to(explorer: Explorer) -> None:
    own = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    # 127.0.0.2 is this machine too, and yet another address than the one bound
    for address in {*own, "127.0.0.2"}:
        with socket.socket() as probe:
            probe.settimeout(2.0)
            assert probe.connect_ex((address, _port(explorer))) != 0


def test_a_message_may_be_queued_while_the_loop_changes_who_waits(explorer: Explorer) -> None:
    class Changing(deque[Any]):
        def __iter__(self) -> Any:
            raise RuntimeError("deque mutated during iteration")

    def in_a_thread(work: Callable[[], None]) -> None:
        with ThreadPoolExecutor(1) as threads:
            threads.submit(work).result(20.0)

    loop = asyncio.new_event_loop()
    buffer = AsyncMessageBuffer(loop, persistent_messages=False)
    try:
        buffer.message_event._waiters = Changing()  # type: ignore[attr-defined]
        buffer.push(GuiCloseModalMessage("x"))
        assert buffer.message_event.is_set()

        async def another_loop() -> None:
            buffer.push(GuiCloseModalMessage("w"))

        in_a_thread(lambda: asyncio.run(another_loop()))
        # whoever waits is woken by the loop, although it has been marked already
        buffer.message_event = MarkedEvent(loop)
        buffer.push(GuiCloseModalMessage("y"))
        buffer.message_event.clear()

        async def wait() -> None:
            waiting = asyncio.ensure_future(buffer.message_event.wait())
            await asyncio.sleep(0)
            thread = threading.Thread(target=buffer.push, args=(GuiCloseModalMessage("z"),))
            thread.start()
            await asyncio.wait_for(waiting, 10.0)

        # the browser tests' driver keeps a loop running in the tests' own thread
        in_a_thread(lambda: loop.run_until_complete(wait()))
    finally:
        loop.close()


def test_nobody_gets_a_share_tunnel_or_an_upload(explorer: Explorer, hostile: Hostile) -> None:
    hostile.send({"type": "ShareUrlRequest"})
    hostile.send(
        {
            "type": "FileTransferStartUpload",
            "source_component_uuid": explorer.settings._preset._impl.uuid,
            "transfer_uuid": "x",
            "filename": "x",
            "mime_type": "text/plain",
            "part_count": 1,
            "size_bytes": 10**12,
        }
    )
    # a later message that is answered shows that the earlier ones were handled
    hostile.refused(explorer.settings._preset, value="no such case")
    assert explorer.server._share_tunnel is None
    assert explorer.server.request_share_url() is None
    assert not explorer.server.gui._current_file_upload_states


def test_values_no_widget_could_send_are_refused_in_words(explorer: Explorer, hostile: Hostile) -> None:
    settings, draft = explorer.settings, explorer.state.draft
    blades, draught = settings._sliders["blade_count"], settings._sliders["draft"]
    population = settings._widgets[("optimization", "population")]
    before = (draft.case(), explorer.state.picture)
    for widget, value, word in (
        (blades, [3.5, 5], "not a whole number"),
        (blades, [3, 99], "outside its limits"),
        (draught, [math.nan, 14.5], "finite"),
        (draught, [14.0, math.inf], "finite"),
        (draught, [14.5, 14.0], "reversed"),
        (draught, [14.0], "2 numbers"),
        (draught, "14", "2 numbers"),
        (draught, [True, 14.5], "finite"),
        (population, math.nan, "finite"),
        (population, "50", "finite"),
        (population, 50.5, "whole number"),
        (settings._widgets[("hull", "form")], "rm -rf", "no option"),
        (settings._widgets[("hull", "form")], 7, "no text"),
        (settings._widgets[("conditions", "weights")], "x" * 20_000, "characters"),
        (settings._widgets[("optimization", "keep_initial")], "yes", "on nor off"),
        (settings._preset, "../../etc/passwd", "no option"),
        (settings._workers, 10**9, "1 to 64"),
    ):
        assert word in hostile.refused(widget, value=value), (word, value)
    assert draft.case() == before[0]
    assert explorer.state.picture.case == before[1].case
    assert settings._sliders["draft"].value == (14.0, 14.5)
    assert explorer.services.runs.workers == 1


def test_a_number_that_may_be_left_out_is_typed_and_taken_away(explorer: Explorer, hostile: Hostile) -> None:
    wake = explorer.settings._widgets[("constants", "stated_wake_fraction")]
    draft = explorer.state.draft
    assert wake.value == ""
    for text in ("0,2", "nan", "0.9"):
        refused = hostile.refused(wake, value=text)
        assert "not a" in refused or "outside its limits" in refused
        assert wake.value == ""
    explorer.settings.set_field("constants", "stated_wake_fraction", "0.25")
    assert draft.case().constants.stated_wake_fraction == 0.25
    explorer.settings.set_field("constants", "stated_wake_fraction", " ")
    assert draft.case().constants.stated_wake_fraction is None
    draft.reset_all()


def test_a_typed_number_out_of_range_is_refused_when_the_typing_rests(explorer: Explorer, hostile: Hostile) -> None:
    population = explorer.settings._widgets[("optimization", "population")]
    draft, before = explorer.state.draft, explorer.state.draft.case()
    for value in (-50, 10**9):
        assert "outside its limits" in hostile.refused(population, value=value)
        assert population.value == before.optimization.population
    froude = explorer.settings._widgets[("conditions", "froude_numbers")]
    for text in ("0.22, x", "nan, 0.27", "inf"):
        assert "not a list of numbers" in hostile.refused(froude, value=text)
    assert draft.case() == before
    # on the way to 120, "1" is no mistake: nobody is told, and Start would be refused with the reason meanwhile
    told = len(hostile.told)
    hostile.update(population, value=1)
    give_up = time.monotonic() + 60.0
    while not draft.held and time.monotonic() < give_up:
        time.sleep(0.01)
    with pytest.raises(InputError, match="population"):
        explorer.services.runs.start()
    hostile.update(population, value=120)
    while draft.value("optimization", "population") != 120 and time.monotonic() < give_up:
        time.sleep(0.01)
    assert draft.case().optimization.population == 120
    time.sleep(2.0)
    assert len(hostile.told) == told
    draft.reset_all()


def test_a_stand_in_takes_a_slider_over(explorer: Explorer) -> None:
    settings, state = explorer.settings, explorer.state
    slider, readout = (found["displacement_ratio"] for found in (settings._sliders, settings._readouts))
    state.change_draft(lambda draft: draft.search_by("block_coefficient_ratio"), whole=True)
    assert state.worker.wait_until_idle(60.0)
    assert (slider.label, slider.value) == ("CB/CB₀", (0.95, 1.05))
    words = str(readout._content)
    assert 'data-variable="block_coefficient_ratio"' in words and "search ∇/∇₀ instead" in words
    settings.set_bounds("block_coefficient_ratio", (0.92, 1.04))
    assert state.draft.case().bounds.as_dict()["block_coefficient_ratio"] == (0.92, 1.04)
    state.change_draft(Draft.reset_all, whole=True)
    assert state.worker.wait_until_idle(60.0)
    assert (slider.label, slider.value) == ("∇/∇₀", state.draft.value("bounds", "displacement_ratio"))


def test_no_attribute_but_the_value_can_be_changed(explorer: Explorer, hostile: Hostile) -> None:
    slider = explorer.settings._sliders["draft"]
    limits, callbacks = (slider.min, slider.max), list(slider._impl.update_cb)
    for updates in ({"min": -1e9}, {"update_cb": []}, {"value": (14.0, 14.2), "max": 99.0}, {"removed": True}, {}):
        assert "only its value" in hostile.refused(slider, **updates)
    assert (slider.min, slider.max) == limits
    assert slider._impl.update_cb == callbacks
    assert slider.value == (14.0, 14.5)


def test_nonsense_on_the_hidden_channel_changes_nothing(explorer: Explorer, hostile: Hostile) -> None:
    """Gestures with foreign values: what no chart of ours could send."""
    channel = next(
        widget
        for widget in explorer.server.get_clients()[hostile.session.client_id].gui._gui_input_handle_from_uuid.values()
        if getattr(widget, "label", "") == "hpsop channel"
    )
    events: list[Any] = [
        {"t": "click", "chart": "pareto", "x": 1e308, "y": -1e308},
        {"t": "zoom", "chart": "pareto", "fx": 1e300, "fy": 0.5, "factor": 1e300},
        {"t": "pan", "chart": "pareto", "fx": 1e300, "fy": 0, "drag": 1},
        {"t": "box", "chart": "pareto", "x0": "a", "x1": None},
        {"t": "brush", "chart": "parallel", "fx0": 1e300, "fy0": 0, "fy1": 1},
        {"t": "act", "name": "open_run", "arg": "../../etc/passwd"},
        {"t": "act", "name": "delete_yes", "arg": "../../etc/passwd"},
        {"t": "act", "name": "run_extend", "arg": "-5"},
        {"t": "act", "name": "search_by", "arg": "draft"},
        {"t": "act", "name": "widen", "arg": "block_coefficient_ratio.upper"},
        {"t": "act", "name": "tab", "arg": "<script>"},
        {"t": "act", "name": "camera", "arg": "nowhere"},
        {"t": "act", "name": "show_pin", "arg": "99"},
        {"t": "act", "name": "condition", "arg": "7"},
        {"t": "act", "name": "step", "arg": "x" * 300},
        {"t": "key", "key": "ArrowRight"},
        {"t": "size", "width": -1, "height": 1e9},
        {"t": "pan", "chart": "pareto", "fx": 10**400, "fy": 0, "drag": 2},
        {"t": "zoom", "chart": "pareto", "fx": 1e14, "fy": 0.5, "factor": 1.1},
        {"t": "hello", "browser": {"a": 1}, "width": 1e99, "height": 5},
        ["no", "object"],
    ]
    for number, event in enumerate(events):
        if isinstance(event, dict):
            event["n"] = number + 1
    before = explorer.state.draft.case()
    hostile.update(channel, value=msgspec.json.encode(events).decode())
    give_up = time.monotonic() + 60.0
    while not any("no such run" in text for text in hostile.told) and time.monotonic() < give_up:
        time.sleep(0.02)
    for text in ("", "[", "[" * 5000, '[{"n": 1e400}]', "x" * 9000):
        hostile.update(channel, value=text)
    hostile.refused(explorer.settings._preset, value="no such case")
    assert hostile.session.worker.wait_until_idle(60.0)
    assert explorer.state.worker.wait_until_idle(60.0)
    # whatever was answered was answered in words meant for people, not by a view that stumbled
    assert not [text for text in hostile.told if "Error:" in text or "Traceback" in text], hostile.told
    assert any("no such run" in text for text in hostile.told)
    assert explorer.state.draft.case() == before
    assert hostile.session.limits == {}
    assert hostile.session.size == (1366, 768)


def test_check_update_takes_what_widgets_really_send() -> None:
    class Widget:
        label = "D"

        def __init__(self, value: Any) -> None:
            self.value = value

    # JavaScript knows one kind of number: 9.0 comes as 9, and 5 may come as 5.0
    check_update(Widget(8.5), {"value": 9})
    check_update(Widget(3), {"value": 5.0})
    check_update(Widget((8.5, 9.5)), {"value": [8, 9]})
    check_update(Widget(True), {"value": False})
    check_update(Widget(""), {"value": "0.22, "})


def test_a_busy_port_is_stepped_over_and_a_foreign_host_refused() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen(1)
        port = taken.getsockname()[1]
        assert free_port("127.0.0.1", port) > port
    with pytest.raises(InputError, match="--host"):
        free_port("192.0.2.1", 8080)
    for bad in (0, -1, 65536):
        with pytest.raises(InputError, match="--port"):
            free_port("127.0.0.1", bad)


def test_a_run_of_another_name_is_never_a_path(tmp_path: Path) -> None:
    from explorer.services.library import RunLibrary

    outside = tmp_path / "outside.hpsop"
    outside.write_bytes(b"")
    folder = tmp_path / "runs"
    folder.mkdir()
    library = RunLibrary(folder)
    assert library.path("../outside.hpsop") is None
    with pytest.raises(InputError, match="no such run"):
        library.delete("../outside.hpsop")
    assert outside.exists()
