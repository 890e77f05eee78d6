"""Files from a browser: bounded in size, parts and time, read where a death costs one file, their names words only."""

from __future__ import annotations

import math
import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import viser
from page_client import Hostile
from viser import _messages

from explorer.app import Explorer
from explorer.server.security import free_port
from explorer.server.uploads import LARGEST_FILE, shown_name
from explorer.services.reading import ReadingProcess, hull_file, kind_of
from explorer.services.reading_job import Refused
from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input import HullFile, ReadOptions
from tests.patience import patience
from tests.two_speeds import stated_case

HULLS = Path(__file__).resolve().parents[1] / "data" / "hulls"
TABLE = (HULLS / "s60_cb060.csv").read_bytes()
SAID = ReadOptions(length=121.92, draft=6.5024)
_PART = 512 * 1024


def _until(condition: Callable[[], object], what: str) -> None:
    give_up = time.monotonic() + patience(60.0)
    while not condition():
        assert time.monotonic() < give_up, what
        time.sleep(0.02)


# ---- what comes over the line ----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Any:
    case = stated_case()
    page = Explorer(case, port=free_port("127.0.0.1", 8660), folder=tmp_path_factory.mktemp("runs"), workers=1)
    yield page
    page.close()


@pytest.fixture(scope="module")
def hostile(explorer: Explorer) -> Any:
    client = Hostile(explorer)
    yield client
    client.socket.close()


class Line:
    """One browser's upload button, spoken to by hand."""

    def __init__(self, explorer: Explorer, hostile: Hostile) -> None:
        self._hostile = hostile
        self.gui = explorer.server.get_clients()[hostile.session.client_id].gui
        _until(self._buttons, "the page's buttons")
        self.button: Any = self._buttons()[0]

    def _buttons(self) -> list[Any]:
        widgets = list(self.gui._gui_input_handle_from_uuid.values())
        return [widget for widget in widgets if isinstance(widget, viser.GuiUploadButtonHandle)]

    def start(self, size: int, parts: int, name: str = "hull.csv", transfer: str = "t", button: str = "") -> None:
        self._hostile.send(
            {
                "type": "FileTransferStartUpload",
                "source_component_uuid": button or self.button._impl.uuid,
                "transfer_uuid": transfer,
                "filename": name,
                "mime_type": "text/csv",
                "part_count": parts,
                "size_bytes": size,
            }
        )

    def part(self, index: int, content: bytes, transfer: str = "t") -> None:
        self._hostile.send(
            {
                "type": "FileTransferPart",
                "source_component_uuid": self.button._impl.uuid,
                "transfer_uuid": transfer,
                "part_index": index,
                "content": content,
            }
        )

    def told(self, word: str) -> None:
        _until(lambda: any(word in text for text in self._hostile.told), f"nobody was told '{word}'")
        self._hostile.told.clear()

    @property
    def kept(self) -> dict[str, Any]:
        return dict(self.gui._current_file_upload_states)


@pytest.fixture
def line(explorer: Explorer, hostile: Hostile) -> Line:
    return Line(explorer, hostile)


def test_what_is_too_large_or_no_file_is_refused_before_a_byte_is_kept(line: Line) -> None:
    for size, parts, word in (
        (LARGEST_FILE + 1, math.ceil((LARGEST_FILE + 1) / _PART), "more than 64 MB"),
        (10**15, 1, "more than 64 MB"),
        (0, 0, "empty"),
        (-1, 1, "whole numbers"),
        (1000, 10**9, "parts of 512 kB"),
        (1000, 0, "parts of 512 kB"),
    ):
        line.start(size, parts)
        line.told(word)
        assert not line.kept


def test_more_than_was_said_is_dropped(line: Line) -> None:
    line.start(2 * _PART, 2)
    line.part(0, bytes(_PART))
    line.part(1, bytes(_PART + 1))
    line.told("more arrived than")
    assert not line.kept


def test_a_browser_has_one_file_under_way(line: Line) -> None:
    for number in range(20):
        line.start(LARGEST_FILE, LARGEST_FILE // _PART, transfer=f"many {number}")
        line.part(0, bytes(_PART), transfer=f"many {number}")
    _until(lambda: list(line.kept) == ["many 19"], "only the newest is kept")


def test_only_a_button_for_files_takes_a_file(line: Line, explorer: Explorer) -> None:
    line.gui._current_file_upload_states.clear()
    channel = next(w for w in line.gui._gui_input_handle_from_uuid.values() if w.label == "hpsop channel")
    for uuid in (channel._impl.uuid, explorer.settings._preset._impl.uuid, "no such button"):
        line.start(100, 1, button=uuid)
    # a later message that is answered shows that the earlier ones were handled
    line.start(0, 0)
    line.told("empty")
    assert not line.kept
    assert not explorer.server.gui._current_file_upload_states


def test_an_upload_that_stalls_is_dropped(line: Line) -> None:
    handlers = line.gui._websock_interface._incoming_handlers[_messages.FileTransferStartUpload]
    (watch,) = {handler.__self__ for handler in handlers}
    seconds, watch._seconds = watch._seconds, 0.3
    try:
        line.start(1000, 1, transfer="slow")
        line.told("not there after 0.3 s")
        assert not line.kept
    finally:
        watch._seconds = seconds


def test_the_button_s_value_cannot_be_set(line: Line, hostile: Hostile) -> None:
    assert "own button" in hostile.refused(line.button, value={"name": "x", "content": b"y"})
    hostile.told.clear()


def test_a_file_is_read_and_its_name_is_words_only(line: Line, explorer: Explorer) -> None:
    before = set(explorer.folder.rglob("*"))
    name = "../../../../tmp/<script>alert(1)</script>\x00.csv"
    line.start(len(TABLE), 1, name=name)
    line.part(0, TABLE)
    _until(lambda: explorer.state.ship.hull is not None and not explorer.state.ship.reading, "the file is read")
    ship = explorer.state.ship
    assert ship.hull is not None
    assert ship.hull.name == "script>.csv"
    # a table in fractions that does not state its size: said in words, under its name for people
    assert ship.read is None
    assert ship.trouble.startswith("script>.csv: half-breadths and waterlines are fractions")
    assert "own-file" not in ship.trouble
    assert set(explorer.folder.rglob("*")) == before
    # viser keeps no copy
    assert line.button.value.content == b""
    explorer.services.ships.say(length=SAID.length)
    _until(lambda: explorer.state.ship.read is not None and not explorer.state.ship.reading, "read again")
    case = explorer.services.ships.case()
    assert Path(case.hull.file).parent == (explorer.folder / "ships").resolve()
    assert [path.name[:5] for path in (explorer.folder / "ships").iterdir()] == ["hull-"]
    explorer.services.ships.put_away("hull")
    assert explorer.state.ship.hull is None


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("C:\\ships\\hull.stl", "hull.stl"),
        ("/etc/passwd", "passwd"),
        ("a\nb\x1b[31m.csv", "ab[31m.csv"),
        ("", "file"),
        ("x" * 300 + ".csv", "x" * 59 + "…" + "x" * 16 + ".csv"),
    ],
)
def test_a_name_for_people(given: str, shown: str) -> None:
    assert shown_name(given) == shown


def test_a_kind_is_one_of_ours() -> None:
    assert kind_of("hull.STL") == ".stl"
    assert kind_of("hull.sh") == ".csv"
    assert kind_of("hull") == ".csv"


# ---- the process that reads ------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def process() -> Any:
    found = ReadingProcess()
    yield found
    found.close()


def _alive(number: int) -> bool:
    return Path(f"/proc/{number}").exists()


def _read(process: ReadingProcess) -> Any:
    return process.hull("ship.csv", TABLE, SAID)


def test_the_process_reads_and_may_write_nothing(process: ReadingProcess) -> None:
    found = _read(process)
    assert isinstance(found, HullFile)
    assert found.understood.name == "ship.csv"
    assert process._process is not None
    limits = Path(f"/proc/{process._process.pid}/limits").read_text(encoding="utf-8")
    (written,) = (row for row in limits.splitlines() if row.startswith("Max file size"))
    assert written.split()[3:5] == ["0", "0"]
    (mapped,) = (row for row in limits.splitlines() if row.startswith("Max address space"))
    assert mapped.split()[3] == str(2 * 2**30)


def test_a_process_that_dies_costs_one_file(process: ReadingProcess) -> None:
    _read(process)
    assert process._process is not None
    number = process._process.pid
    os.kill(number, signal.SIGSTOP)
    threading.Timer(0.3, os.kill, (number, signal.SIGKILL)).start()
    found = _read(process)
    assert isinstance(found, Refused)
    assert "died" in found.why
    assert not _alive(number)
    assert isinstance(_read(process), HullFile)


def test_a_file_that_takes_too_long_is_given_up(process: ReadingProcess) -> None:
    _read(process)
    assert process._process is not None
    number = process._process.pid
    os.kill(number, signal.SIGSTOP)
    process._seconds = 0.3
    try:
        found = _read(process)
    finally:
        process._seconds = 60.0
    assert isinstance(found, Refused)
    assert "not read within 0.3 s" in found.why
    assert not _alive(number)
    assert isinstance(_read(process), HullFile)


def test_memory_is_bounded() -> None:
    # what the interpreter and its libraries have mapped at the start is not given back: nothing is left for the file
    process = ReadingProcess(memory=64 * 2**20)
    try:
        found = process.hull("wide.csv", b"station_x_m,waterline_z_m,half_breadth_m\n" + b"1,2,3\n" * 3_000_000, SAID)
        assert isinstance(found, Refused)
        assert "64 MB" in found.why or "died" in found.why
    finally:
        process.close()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("noise.stl", bytes(range(256)) * 40),
        ("noise.glb", b"glTF" + bytes(2000)),
        ("noise.obj", b"f 1 2 3\n" * 50),
        ("noise.ply", b"ply\nformat ascii 1.0\nelement vertex 999999999\nend_header\n"),
        ("noise.off", b"OFF\n99999999 99999999 0\n"),
        ("noise.csv", os.urandom(3000)),
        ("noise.3dm", b"3D Geometry File Format" + bytes(500)),
        ("noise.step", b"ISO-10303-21;\nHEADER;\n" + b"#1=" * 100),
    ],
)
def test_noise_is_refused_in_one_line_by_name(process: ReadingProcess, name: str, content: bytes) -> None:
    found = process.hull(name, content, ReadOptions())
    assert isinstance(found, Refused)
    assert found.why.startswith(name)
    assert "own-file" not in found.why
    assert "\n" not in found.why


def test_no_process_is_left_behind() -> None:
    process = ReadingProcess()
    process.warm()
    assert process._process is not None
    number = process._process.pid
    process.close()
    assert not _alive(number)
    assert isinstance(_read(process), Refused)


def test_a_file_of_this_machine_is_bounded_too(tmp_path: Path) -> None:
    huge = tmp_path / "huge.csv"
    with open(huge, "wb") as stream:
        stream.truncate(LARGEST_FILE + 1)
    for path in (str(huge), "/dev/zero", str(tmp_path), str(tmp_path / "none.csv"), "a\0b.csv", "x" * 5000):
        with pytest.raises(InputError):
            hull_file(path)
