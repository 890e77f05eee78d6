"""``hpsop optimize`` and ``hpsop show`` from end to end, on the real hydrodynamics of level 1."""

from __future__ import annotations

import contextlib
import io
import json
import os
import pty
import shlex
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import pytest
from run_files import content

from hpsop_core.case.case import load_case
from hpsop_core.cli.main import main
from hpsop_core.runs.reader import open_run
from tests.patience import patience

RUN = "run.hpsop"
VARIABLES = [
    "length_to_breadth",
    "breadth_to_draft",
    "draft",
    "diameter",
    "blade_count",
    "pitch_ratio",
    "displacement_ratio",
    "expanded_area_ratio",
    "buoyancy_centre_shift",
]


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "hpsop_core.cli.main", *words]


def hpsop(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    root = str(Path(__file__).resolve().parents[2])
    environment = {**os.environ, "PYTHONPATH": root}
    return subprocess.run(
        command(*words), check=False, capture_output=True, text=True, cwd=folder, env=environment, timeout=240
    )


def in_process(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """As ``hpsop``, without a second of imports."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a finished run of level 1."""
    folder = tmp_path_factory.mktemp("commands")
    plan = ("--generations", "4", "--level1-generations", "4", "--population", "8", "--seed", "3", "--workers", "2")
    ended = hpsop("optimize", "dtc-p4119-paper", "--run", RUN, *plan, folder=folder)
    assert ended.returncode == 0, ended.stderr
    lines = ended.stderr.splitlines()
    assert lines[0] == f"dtc-p4119-paper: 4 generations of 8, 4 of them at level 1; seed 3; {RUN}"
    assert [line.split(",")[0] for line in lines if line.startswith("generation")] == [
        f"generation {number}/4" for number in range(1, 5)
    ]
    assert "\r" not in ended.stderr and "front:" in ended.stdout
    return folder


def test_show_front_has_the_shape_of_the_contract(folder: Path) -> None:
    ended = hpsop("show", RUN, "--front", "--json", folder=folder)
    assert ended.returncode == 0 and ended.stderr == ""
    document = json.loads(ended.stdout)
    assert document["generation"] == 4 and document["level"] == 1
    assert {"generation", "level", "designs", "compromise", "initial"} <= document.keys()
    for design in [*document["designs"], document["initial"]]:
        assert list(design)[:4] == ["id", "objectives", "variables", "feasible"]
        assert {"active_bounds", "errors"} <= set(design) and set(design["active_bounds"].values()) <= {
            "lower",
            "upper",
        }
        assert type(design["id"]) is int and list(design["variables"]) == VARIABLES
        assert set(design["objectives"]) == {"f1", "f2"}
    assert document["compromise"] in [design["id"] for design in document["designs"]]
    assert all(design["feasible"] for design in document["designs"])
    # 1 but for the rounding of a sum of two weighted ratios that are 1.
    assert document["initial"]["objectives"]["f1"] == pytest.approx(1.0, abs=1e-12)
    bounds = load_case("dtc-p4119-paper").bounds.as_dict()
    for design in document["designs"]:
        for name, side in design["active_bounds"].items():
            low, high = bounds[name]
            assert side in ("lower", "upper")
            place = (design["variables"][name] - low) / (high - low)
            assert place <= 0.01 if side == "lower" else place >= 0.99
    names = [design["family"] for design in document["designs"]]
    assert names[0] == 1 and names == sorted(names) and set(names) == set(range(1, max(names) + 1))
    points = [tuple(design["objectives"].values()) for design in document["designs"]]
    assert points == sorted(points) and all(a[1] > b[1] for a, b in pairwise(points))


def test_show_one_design_is_the_json_of_evaluate(folder: Path) -> None:
    compromise = json.loads(in_process("show", RUN, "--design", "compromise", "--json", folder=folder).stdout)
    by_id = json.loads(in_process("show", RUN, "--design", str(compromise["id"]), "--json", folder=folder).stdout)
    assert by_id == compromise
    changes = [f"{name}={value!r}" for name, value in compromise["variables"].items()]
    ended = in_process("evaluate", "dtc-p4119-paper", "--set", *changes, "--json", folder=folder)
    evaluated = json.loads(ended.stdout)
    assert evaluated.keys() <= compromise.keys()
    # The run's case differs in its [optimization] alone: the same code on the same numbers.
    for key in ("variables", "hull", "propeller", "conditions", "objectives", "constraints", "feasible", "open_water"):
        assert evaluated[key] == compromise[key], key
    initial = json.loads(in_process("show", RUN, "--design", "initial", "--json", folder=folder).stdout)
    assert initial["id"] == 1 and initial["variables"]["blade_count"] == 3


def test_show_summary_generation_and_texts(folder: Path) -> None:
    summary = json.loads(in_process("show", RUN, "--json", folder=folder).stdout)
    assert summary["state"] == "finished" and summary["generation"] == 4 and summary["seed"] == 3
    assert summary["evaluations"]["2"]["count"] == 1, "the initial design, at level 2 too"
    second = json.loads(in_process("show", RUN, "--generation", "2", "--json", folder=folder).stdout)
    assert second["number"] == 2 and len(second["designs"]) == 8
    for words in ((), ("--front",), ("--generation", "1"), ("--design", "knee"), ("--design", "2")):
        ended = in_process("show", RUN, *words, folder=folder)
        assert ended.returncode == 0 and len(ended.stdout.splitlines()) > 3, ended.stderr


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("show", "nowhere.hpsop"), "no such run file"),
        (("show", RUN, "--design", "9999"), "has no design 9999"),
        (("show", RUN, "--design", "1" + "0" * 30), "has no design 1000"),
        (("show", RUN, "--design", "-1"), "has no design -1"),
        (("show", RUN, "--design", "best"), "give a design's number"),
        (("show", RUN, "--generation", "5"), "has generations 1 to 4"),
        (("show", RUN, "--front", "--design", "1"), "ask one of them"),
        (("optimize", "dtc-p4119", "--run", RUN), "holds a run of the case 'dtc-p4119-paper'"),
        (("optimize", "dtc-p4119-paper", "--run", RUN, "--seed", "4"), "seed = 3"),
        (("optimize", "dtc-p4119-paper", "--run", RUN, "--generations", "3"), "as many or more"),
        (("optimize", "dtc-p4119-paper", "--run", "x/y.hpsop"), "folder cannot be written"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--population", "1"), "population"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--workers", "0"), "--workers 0"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--workers", "100000"), "--workers 100000"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--generations", "many"), "--generations"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--seed", "1" + "0" * 400), "2147483647"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--seeds-from", "old.hpsop"), "no such run file"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--executor", "dask"), "local or dask:HOST:PORT"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--executor", "dask:head"), "dask:HOST:PORT"),
        (("optimize", "dtc-p4119-paper", "--run", "new.hpsop", "--executor", "dask:head:0"), "dask:HOST:PORT"),
        (("optimize", "dtc-p4119-paper"), "--run"),
    ],
)
def test_mistakes_are_one_line(
    words: tuple[str, ...],
    expected: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folder)
    try:
        code = main(words)
    except SystemExit as end:
        code = end.code
    printed = capsys.readouterr()
    assert code == 2 and printed.out == ""
    assert len(printed.err.splitlines()) == 1 and expected in printed.err
    assert not Path("new.hpsop").exists()


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_streams_that_are_closed_lead_to_nothing(folder: Path, closed: str) -> None:
    """As some services start their programs: the next file opened had the number of standard output."""
    words = shlex.join(command("show", "run.hpsop"))
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    done = subprocess.run(
        ["sh", "-c", f"{words} {closed}"], check=False, capture_output=True, text=True, cwd=folder, env=environment
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_terminal_without_greek_letters_has_their_escapes(folder: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2]), "PYTHONIOENCODING": "ascii"}
    words = command("evaluate", "dtc-p4119-paper")
    done = subprocess.run(words, check=False, capture_output=True, text=True, cwd=folder, env=environment)
    assert done.returncode == 0, done.stderr
    assert "\\u" in done.stdout and done.stdout.isascii()


def test_an_interrupt_pauses_cleanly_and_says_how_to_go_on(folder: Path, tmp_path: Path) -> None:
    """On a terminal, by Ctrl-C: the bar is drawn, the signal reaches the whole process group."""
    plan = ["--generations", "4", "--level1-generations", "4", "--population", "12", "--workers", "2"]
    words = ["optimize", "dtc-p4119-paper", "--run", "int.hpsop", *plan]
    ours, theirs = pty.openpty()
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    process = subprocess.Popen(
        command(*words), stderr=theirs, stdout=theirs, cwd=tmp_path, env=environment, start_new_session=True
    )
    os.close(theirs)
    seen = b""
    while b"generation 2/4" not in seen:
        seen += os.read(ours, 4096)
    os.killpg(process.pid, signal.SIGINT)
    asked = time.monotonic()
    rest = b""
    while True:
        try:
            part = os.read(ours, 4096)
        except OSError:
            break
        rest += part
    assert process.wait(timeout=patience(30.0)) == 130
    # One evaluation of level 1 and the end of two processes, on a loaded machine.
    assert time.monotonic() - asked < patience(5.0)
    text = rest.decode()
    assert "Go on with: hpsop optimize dtc-p4119-paper --run int.hpsop" in text and "Traceback" not in text
    assert b"\r[#" in seen or b"[..." in seen
    ended = hpsop(*words[:4], "--workers", "2", folder=tmp_path)
    assert ended.returncode == 0, ended.stderr
    whole = hpsop(*words[:3], "whole.hpsop", *plan, folder=tmp_path)
    assert whole.returncode == 0, whole.stderr
    assert content(tmp_path / "int.hpsop") == content(tmp_path / "whole.hpsop")


def test_a_terminal_that_is_closed_ends_the_run_in_good_order(tmp_path: Path) -> None:
    """The kernel tells the whole session by SIGHUP, and nothing can be printed any more."""
    words = command(
        "optimize", "dtc-p4119-paper", "--run", "hup.hpsop", "--generations", "5000", "--level1-generations", "5000"
    )
    process, terminal = pty.fork()
    if process == 0:
        # Tests that run under nohup hand on that it is ignored; a program that is started so goes on, as it should.
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        os.chdir(tmp_path)
        os.environ["PYTHONPATH"] = str(Path(__file__).resolve().parents[2])
        os.execv(words[0], [*words, "--population", "12", "--workers", "2"])
    seen = b""
    while b"generation 2/5000" not in seen:
        seen += os.read(terminal, 4096)
    os.close(terminal)
    _, status = os.waitpid(process, 0)
    assert os.WIFEXITED(status), "ended by itself, not by the signal"
    run = open_run(tmp_path / "hup.hpsop")
    assert run.state() == ("stopped", "")
    assert run.progress()[0] >= 2
    assert not (tmp_path / "hup.hpsop-wal").exists() and not (tmp_path / "hup.hpsop.lock").exists()
