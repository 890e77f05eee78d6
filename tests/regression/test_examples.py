"""Examples, tools and the README's commands do what they say, run as a reader runs them (with quick settings)."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from hpsop_core import load_case

ROOT = Path(__file__).resolve().parents[2]
# Two are long by nature; that they parse is asserted instead.
LONG = ("hpsop reproduce", "hpsop validate")
QUICKER = {"optimize": ["--generations", "2", "--level1-generations", "1", "--population", "6"]}


def run(words: list[str], folder: Path) -> str:
    # A worker process of an example finds the package as this process does.
    path = os.pathsep.join(entry for entry in sys.path if entry)
    done = subprocess.run(
        [sys.executable, *words], cwd=folder, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path}
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def example(name: str, folder: Path, *words: str) -> str:
    return run([str(ROOT / "examples" / f"{name}.py"), *words], folder)


def test_every_example_is_run_here() -> None:
    text = Path(__file__).read_text(encoding="utf-8")
    names = [path.stem for path in (ROOT / "examples").glob("*.py")]
    assert len(names) >= 5
    assert [name for name in names if f'example("{name}"' not in text] == []


def test_evaluate_a_design(tmp_path: Path) -> None:
    lines = example("evaluate_a_design", tmp_path).splitlines()
    powers = [float(re.findall(r"PD ([0-9.]+) MW", line)[0]) for line in lines]
    assert len(powers) == 4
    # Larger is better (momentum theory), at both levels.
    assert powers[1] < powers[0] and powers[3] < powers[2]


def test_sweep_length_to_breadth(tmp_path: Path) -> None:
    rows = example("sweep_length_to_breadth", tmp_path, "--points", "2").splitlines()[2:]
    numbers = [[float(word) for word in row.split()] for row in rows]
    assert [row[0] for row in numbers] == list(load_case("dtc-p4119").bounds.as_dict()["length_to_breadth"])
    # At one displacement and below Fn 0.22 friction decides, and the longer ship has more of it: at both levels.
    assert numbers[0][2] < numbers[1][2] and numbers[0][3] < numbers[1][3]


def test_own_objective(tmp_path: Path) -> None:
    out = example("own_objective", tmp_path, "--generations", "1", "--population", "4")
    values = [(float(a), float(b)) for a, b in re.findall(r": ([0-9.]+) W/\(kN m/s\) \(([0-9.]+) of", out)]
    assert values
    for power, share in values:
        # One initial design's value stands behind every row.
        assert power / share == pytest.approx(values[0][0] / values[0][1], rel=1e-3)


def test_own_hull_from_a_table(tmp_path: Path) -> None:
    out = example("own_hull_from_a_table", tmp_path)
    volume = float(re.findall(r"^volume ([0-9.]+) m3", out, re.MULTILINE)[0])
    # 4/9 L B d, exact for Wigley's hull; the table has 41 stations and the fit its millimetres.
    assert volume == pytest.approx(4.0 / 9.0 * 100.0 * 10.0 * 6.25, rel=1e-3)
    assert len(re.findall(r"^level [12], Fn", out, re.MULTILINE)) == 6


def test_small_optimisation(tmp_path: Path) -> None:
    example("small_optimisation", tmp_path, "--generations", "2", "--population", "6", "--to", "front.svg")
    drawing = ElementTree.parse(tmp_path / "front.svg").getroot()
    marks = [item for item in drawing.iter() if "initial" in item.get("class", "").split()]
    assert drawing.tag.endswith("svg") and marks
    assert not any("nan" in value for item in drawing.iter() for value in item.attrib.values())


def own_files(folder: Path) -> None:
    """The ship and the propeller that the documents speak of."""
    shutil.copy(ROOT / "tests" / "data" / "hulls" / "s60_cb060.csv", folder / "ship.csv")
    shutil.copy(ROOT / "assets" / "propellers" / "p4119.csv", folder / "blade.csv")


class Terminal:
    """Commands as they are typed, in this process: what they need is imported, compiled and remembered once."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        monkeypatch.chdir(folder)
        self._capsys = capsys

    def types(self, command: str) -> None:
        """The command ends well and says something."""
        from hpsop_core.cli.main import main

        words = command.split()[1:]
        code = main([*words, *QUICKER.get(words[0], [])])
        printed = self._capsys.readouterr()
        assert code == 0 and printed.out, (command, printed.err)


@pytest.fixture
def terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Terminal:
    return Terminal(tmp_path, monkeypatch, capsys)


def commands_of(page: str) -> list[str]:
    text = (ROOT / page).read_text(encoding="utf-8")
    lines = [line.split("#")[0].strip() for line in text.splitlines()]
    return [line for line in lines if line.startswith("hpsop ")]


def test_commands_of_the_readme(tmp_path: Path, terminal: Terminal) -> None:
    from hpsop_core.cli.main import build_parser

    own_files(tmp_path)
    commands = commands_of("README.md")
    assert len(commands) >= 8
    for command in commands:
        assert callable(build_parser().parse_args(command.split()[1:]).handler)
        if not command.startswith(LONG):
            terminal.types(command)
    assert (tmp_path / "report.html").stat().st_size > 10_000


def test_commands_of_the_guide_to_own_ships(tmp_path: Path, terminal: Terminal) -> None:
    own_files(tmp_path)
    commands = commands_of("docs/bring-your-ship.md")
    assert len(commands) >= 4
    for command in commands:
        terminal.types(command)
    assert (tmp_path / "ship.png").read_bytes().startswith(b"\x89PNG") and (tmp_path / "ship.toml").is_file()


def test_python_of_the_guide_to_own_ships(tmp_path: Path) -> None:
    own_files(tmp_path)
    text = (ROOT / "docs" / "bring-your-ship.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "block.py").write_text(block, encoding="utf-8")
    assert "ResistancePoint" in run(["block.py"], tmp_path)


def test_python_of_the_readme(tmp_path: Path) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert blocks
    for block in blocks:
        (tmp_path / "block.py").write_text(block, encoding="utf-8")
        assert run(["block.py"], tmp_path)


# Each module as the command line runs it, but in one process: what they all import is imported once.
ALL_HELP = """
import contextlib, io, runpy, sys
for name in sys.argv[1:]:
    sys.argv = [name, "--help"]
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            runpy.run_module(name, run_name="__main__", alter_sys=True)
        code = 0
    except SystemExit as end:
        code = end.code or 0
    if code or "usage:" not in said.getvalue():
        print(name, code)
"""


def test_every_tool_is_run_as_a_module() -> None:
    tools = [path for path in (ROOT / "tools").rglob("*.py") if "__main__" in path.read_text(encoding="utf-8")]
    assert len(tools) >= 5
    names = [".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__main__") for path in tools]
    command = [sys.executable, "-c", ALL_HELP, *names]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stderr


def test_files_that_the_docs_name_are_there() -> None:
    folders = r"(?:hpsop_core|explorer|tools|tests|docs|assets|examples|benchmarks)/[\w./-]*\w"
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]
    named = [(page.name, name) for page in pages for name in re.findall(folders, page.read_text(encoding="utf-8"))]
    assert len(named) > 50
    assert [pair for pair in named if not (ROOT / pair[1]).exists()] == []
