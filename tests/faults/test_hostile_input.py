"""Files and words that nobody sane would give: exit 2, one bounded line, at once, in little memory.

The fuzzers mutate good files of every kind and write new ones from nothing; what is read may be right or refused, and
nothing else.
"""

from __future__ import annotations

import contextlib
import io
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hpsop_core import load_case, load_hull, load_propeller, open_run
from hpsop_core.assets import read_asset_text
from hpsop_core.case.case import case_from_toml
from hpsop_core.cli.main import main
from hpsop_core.errors import HpsopError, InputError, SolverFailure, message_line, shown

LONGEST_LINE = 900
CASE = read_asset_text("cases", "dtc-p4119.toml")
BLADE = read_asset_text("propellers", "p4119.csv")
# one machine's seed for a bug that another one found: the examples are the same in every run
EXAMPLES = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
# long runs look elsewhere each time; pytest's --hypothesis-seed=N repeats one
SOAK = settings(EXAMPLES, max_examples=5000, derandomize=False)


def _box(x0: float, x1: float, half: float, z1: float) -> str:
    """A table of offsets of a simple hull, rounded at its ends."""
    rows = ["station_x_m,waterline_z_m,half_breadth_m"]
    for k in range(11):
        x = x0 + (x1 - x0) * k / 10
        for j in range(6):
            z = z1 * j / 5
            y = half * (1 - (2 * k / 10 - 1) ** 2) * (z / z1) ** 0.5
            rows.append(f"{x:g},{z:g},{y:g}")
    return "\n".join(rows) + "\n"


OFFSETS = _box(0.0, 100.0, 8.0, 8.0)


@cache
def _meshes() -> dict[str, bytes]:
    """A small closed body in every kind of mesh file."""
    import trimesh

    body = trimesh.creation.box((100.0, 16.0, 8.0))
    found = {}
    for kind in ("stl", "obj", "ply", "off", "glb"):
        content = body.export(file_type=kind)
        found[kind] = content if isinstance(content, bytes) else content.encode()
    found["ascii.stl"] = body.export(file_type="stl_ascii").encode()
    return found


def refused(call: Callable[[], object]) -> str:
    """The message of a refusal; "" where it was understood."""
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            call()
    except HpsopError as error:
        text = str(error)
        assert text
        assert len(text) <= LONGEST_LINE
        assert text.isprintable(), text
        return text
    return ""


def command(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What the command says when it refuses."""
    try:
        code = main(arguments)
    except SystemExit as ended:
        code = int(ended.code or 0)
    said = capsys.readouterr()
    assert code == 2, said
    assert said.err.count("\n") == 1
    assert len(said.err) <= LONGEST_LINE
    assert "Traceback" not in said.err
    return said.err


LONG_NAME = "x" * 300
BROKEN_CASES = {
    "a name of 300 letters": CASE.replace('parent = "dtc"', f'file = "{LONG_NAME}.csv"\nlength = 3.0\ndraft = 0.2'),
    "NUL in a path": CASE.replace('parent = "dtc"', 'file = "a\\u0000b.csv"\nlength = 3.0\ndraft = 0.2'),
    "a NUL in the file": CASE.replace("seed = 1", "seed = 1\0"),
    "thousands of digits": CASE.replace("seed = 1", f"seed = {'9' * 5000}"),
    "a million digits": CASE.replace("seed = 1", f"seed = {'9' * 1_000_000}"),
    "hexadecimal digits": CASE.replace("seed = 1", f"seed = 0x{'f' * 9000}"),
    "hexadecimal digits for a text": CASE.replace('parent = "dtc"', f"parent = 0x{'f' * 9000}"),
    "deep lists": f"a = {'[' * 5000}{']' * 5000}",
    "deep tables": f"{'[' + 'a.' * 5000}a]\nx = 1",
    "deep inline tables": "a = " + "{a = " * 3000 + "1" + "}" * 3000,
    "a long unknown key": f"{'k' * 100_000} = 1\n{CASE}",
    "a long value": CASE.replace('parent = "dtc"', f'parent = "{"k" * 100_000}"'),
    "line breaks in a value": CASE.replace('parent = "dtc"', 'parent = "a\\nb\\nc\\u001b[31m"'),
    "line breaks in a key": f'"a\\nb\\nc" = 1\n{CASE}',
}


@pytest.mark.parametrize("name", BROKEN_CASES)
def test_a_broken_case_is_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert BROKEN_CASES[name] != CASE
    path = tmp_path / "my.toml"
    path.write_text(BROKEN_CASES[name], encoding="utf-8")
    assert "my.toml" in command(["evaluate", str(path), "--json"], capsys)


@pytest.mark.parametrize("name", [LONG_NAME, f"{LONG_NAME}.csv", "a\0b", "x" * 100_000, "a\nb", "\udcff", "/", "."])
def test_a_name_that_no_file_can_have(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (
        ["evaluate", name],
        ["optimize", name, "--run", str(tmp_path / "a.hpsop")],
        ["show", name],
        ["show", f"{name}.hpsop"],
        ["report", f"{name}.hpsop", "--to", str(tmp_path / "a.html")],
        ["hull", name, "--length", "100", "--draft", "8"],
        ["hull", f"{name}.stl", "--length", "100", "--draft", "8", "--unit", "m"],
        ["propeller", name, "--blades", "4"],
        ["open-water", "--geometry", name, "--blades", "4", "--advance", "0.5"],
        ["resistance", "--offsets", name, "--length", "100", "--draft", "8", "--froude", "0.2"],
    ):
        command(arguments, capsys)


def test_words_of_a_command_are_echoed_short(capsys: pytest.CaptureFixture[str]) -> None:
    book = "9" * 100_000
    for arguments in (
        [book],
        ["evaluate", "dtc-p4119", "--level", book],
        ["evaluate", "dtc-p4119", "--set", book],
        ["evaluate", "dtc-p4119", "--set", f"diameter={book}"],
        ["evaluate", "dtc-p4119", "--set", f"{book}=1"],
        ["evaluate", "dtc-p4119", "--set", f"optimization.seed={book}"],
        ["evaluate", "dtc-p4119", "--set", "diameter=a\nb\nc"],
        ["resistance", "dtc-p4119", "--froude", book],
        ["optimize", "dtc-p4119", "--run", "a.hpsop", "--seed", book],
    ):
        command(arguments, capsys)


@pytest.mark.parametrize("suffix", ["toml", "csv", "stl", "hpsop", "3dm"])
def test_pipes_devices_and_folders_are_no_files(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe, zero, folder = (tmp_path / f"{name}.{suffix}" for name in ("pipe", "zero", "folder"))
    os.mkfifo(pipe)
    zero.symlink_to("/dev/zero")
    folder.mkdir()
    for path in map(str, (pipe, zero, folder)):
        arguments = {
            "toml": ["evaluate", path],
            "hpsop": ["show", path],
            "csv": ["propeller", path, "--blades", "4"],
        }.get(suffix, ["hull", path, "--length", "100", "--draft", "8", "--unit", "m"])
        command(arguments, capsys)
        if suffix == "csv":
            command(["hull", path, "--length", "100", "--draft", "8"], capsys)


def test_a_cell_of_a_megabyte_and_a_file_of_a_hundred(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "my.csv"
    for text in (
        OFFSETS + f'"{"x" * 1_000_000}",1,2\n',
        OFFSETS + f"{'9' * 1_000_000},1,2\n",
        OFFSETS + f"{'9' * 5000},1,2\n",
        "," * 100_000,
        '"' + "x\n" * 50_000,
    ):
        path.write_text(text, encoding="utf-8")
        command(["hull", str(path), "--length", "100", "--draft", "8"], capsys)
        command(["propeller", str(path), "--blades", "4"], capsys)
    # sparse: no block of it is on the disk
    with path.open("wb") as file:
        file.truncate(3 << 30)
    command(["hull", str(path), "--length", "100", "--draft", "8"], capsys)
    for suffix in ("toml", "stl"):
        other = path.rename(tmp_path / f"my.{suffix}")
        arguments = ["hull", str(other), "--length", "100", "--draft", "8", "--unit", "m"]
        command(["evaluate", str(other)] if suffix == "toml" else arguments, capsys)
        path = other


def test_memory_stays_bounded_on_a_device(tmp_path: Path) -> None:
    """A process of two gigabytes of address space that reads /dev/zero ends with the line, not with a MemoryError."""

    def little() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

    done = subprocess.run(
        [sys.executable, "-m", "hpsop_core.cli", "evaluate", "/dev/zero"],
        preexec_fn=little,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "device" in done.stderr


def test_messages_are_one_bounded_line() -> None:
    assert message_line("a  b\n c\r\n\td") == "a b c d"
    assert message_line("\x1b[31m\udcff") == r"\x1b[31m\udcff"
    long = message_line("head " + "x" * 10**6 + " remedy")
    assert long.startswith("head") and long.endswith("remedy") and len(long) < LONGEST_LINE
    assert message_line(long) == long
    assert str(InputError("a\nb")) == "a b"
    failure = SolverFailure("rankine", "x" * 10**6)
    assert len(str(failure)) < LONGEST_LINE
    assert shown(16**9000) == "this int"
    assert len(shown("x" * 10**6)) <= 60
    deep: object = 1
    for _ in range(100_000):
        deep = [deep]
    assert shown(deep) == "this list"


# ---- fuzzers ---------------------------------------------------------------------------------------------------------
@st.composite
def mutated(draw: st.DrawFn, content: bytes) -> bytes:
    """Good content with a few places changed, cut out, doubled or grown."""
    found = bytearray(content)
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(len(found) - 1, 0)))
        length = draw(st.sampled_from([1, 1, 2, 8, 64, 1000]))
        kind = draw(st.sampled_from(["flip", "insert", "cut", "double", "end"]))
        if kind == "flip" and found:
            found[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "insert":
            found[at:at] = draw(st.sampled_from(NASTY)) if draw(st.booleans()) else draw(st.binary(max_size=12))
        elif kind == "cut":
            del found[at : at + length]
        elif kind == "double":
            found[at:at] = found[at : at + length]
        elif kind == "end":
            del found[at:]
    return bytes(found)


NASTY = [
    *(b"nan", b"inf", b"-inf", b"1e308", b"1e-308", b"-1e308", b"-0", b"1e999", b"\0", b"\xff\xfe", b"\xef\xbb\xbf"),
    *(b'"', b"'", b",", b";", b"\n", b"\r", b"[", b"]", b"{", b"}", b"=", b"#", b"\t", b"\x1b[31m", b"9" * 400),
]


def _fuzz_case(content: bytes) -> None:
    with contextlib.suppress(UnicodeDecodeError):
        text = content.decode("utf-8")
        refused(lambda: case_from_toml(text, "my.toml"))


def _fuzz_file(folder: Path, name: str, content: bytes, read: Callable[[Path], object]) -> None:
    path = folder / name
    path.write_bytes(content)
    refused(lambda: read(path))


def _hull(path: Path) -> object:
    return load_hull(path, length=100.0, draft=6.0, unit="m")


def _run_bytes(folder: Path) -> bytes:
    from hpsop_core.assets import asset_path

    names = [item for item in asset_path("demo").iterdir() if item.name.endswith(".hpsop")]
    return names[0].read_bytes()


@EXAMPLES
@given(mutated(CASE.encode()))
def test_fuzz_cases(content: bytes) -> None:
    _fuzz_case(content)


@EXAMPLES
@given(st.text(max_size=300) | st.binary(max_size=300).map(lambda raw: raw.decode("latin-1")))
def test_fuzz_cases_from_nothing(text: str) -> None:
    refused(lambda: case_from_toml(text, "my.toml"))


@EXAMPLES
@given(mutated(OFFSETS.encode()))
def test_fuzz_tables_of_offsets(tmp_path: Path, content: bytes) -> None:
    _fuzz_file(tmp_path, "my.csv", content, lambda path: load_hull(path, length=100.0, draft=6.0))


@EXAMPLES
@given(mutated(BLADE.encode()) | st.binary(max_size=300))
def test_fuzz_propeller_tables(tmp_path: Path, content: bytes) -> None:
    _fuzz_file(tmp_path, "my.csv", content, lambda path: load_propeller(path, blade_count=4))


@EXAMPLES
@given(st.data())
def test_fuzz_meshes(tmp_path: Path, data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from(sorted(_meshes())))
    _fuzz_file(tmp_path, f"my.{kind}", data.draw(mutated(_meshes()[kind])), _hull)


@settings(EXAMPLES, max_examples=20)
@given(st.data())
def test_fuzz_run_files(tmp_path: Path, data: st.DataObject) -> None:
    def read(path: Path) -> object:
        reader = open_run(path)
        return reader.summary(), reader.front()

    _fuzz_file(tmp_path, "my.hpsop", data.draw(mutated(_run_bytes(tmp_path))), read)


@pytest.mark.soak
def test_fuzz_at_length(tmp_path: Path) -> None:
    """Thousands of examples of each kind."""

    def at_length(content: bytes, try_one: Callable[[bytes], None]) -> None:
        @SOAK
        @given(mutated(content))
        def run(found: bytes) -> None:
            try_one(found)

        run()

    def table(found: bytes) -> None:
        _fuzz_file(tmp_path, "my.csv", found, lambda path: load_hull(path, length=100.0, draft=6.0))

    def blade(found: bytes) -> None:
        _fuzz_file(tmp_path, "my.csv", found, lambda path: load_propeller(path, blade_count=4))

    def mesh(kind: str) -> Callable[[bytes], None]:
        return lambda found: _fuzz_file(tmp_path, f"my.{kind}", found, _hull)

    at_length(CASE.encode(), _fuzz_case)
    at_length(OFFSETS.encode(), table)
    at_length(BLADE.encode(), blade)
    for kind, content in _meshes().items():
        at_length(content, mesh(kind))


def test_the_good_files_are_understood() -> None:
    """What the fuzzers begin with is right: else every mutation would be refused for the same reason."""
    assert case_from_toml(CASE, "my.toml") == load_case("dtc-p4119")


def test_the_good_tables_are_understood(tmp_path: Path) -> None:
    path = tmp_path / "my.csv"
    path.write_text(OFFSETS, encoding="utf-8")
    assert load_hull(path, length=100.0, draft=6.0).length == pytest.approx(100.0)
    path.write_text(BLADE, encoding="utf-8")
    assert load_propeller(path, blade_count=4).blade_count == 4
