"""`hpsop report` and `hpsop reproduce`: mistakes are one line, and nothing of a person's is overwritten."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from explorer.services.reports import run_report
from hpsop_core import load_case, writing
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError
from hpsop_core.report import report
from hpsop_core.runs.controller import RunController
from tests.two_speeds import TWO_SPEEDS


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that has evaluated nothing: refusals do not need more."""
    file = tmp_path_factory.mktemp("run") / "new.hpsop"
    RunController(file, load_case(TWO_SPEEDS), workers=1).close()
    return file


def refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1 and printed.err.startswith("hpsop: ")
    return printed.err


def test_a_report_is_written_once(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "deep" / "report.html"
    words = ["report", str(file), "--to", str(target)]
    assert main(words) == 0
    assert str(target) in capsys.readouterr().out
    assert [entry.name for entry in target.parent.iterdir()] == ["report.html"]
    target.write_text("mine")
    assert "is there already; give --force" in refused(words, capsys)
    assert target.read_text() == "mine"
    assert main([*words, "--force"]) == 0
    assert target.read_text().startswith("<!DOCTYPE html>")


def test_a_report_never_replaces_a_run(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = file.read_bytes()
    assert "is a run file's name" in refused(["report", str(file), "--to", str(file), "--force"], capsys)
    other = tmp_path / "other.html"
    os.link(file, other)
    assert "is a run file's name" in refused(["report", str(file), "--to", str(other), "--force"], capsys)
    assert file.read_bytes() == before


def test_places_that_cannot_be_written(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "is a folder" in refused(["report", str(file), "--to", str(tmp_path)], capsys)
    taken = tmp_path / "taken"
    taken.write_text("")
    below = str(taken / "report.html")
    assert "cannot be written" in refused(["report", str(file), "--to", below], capsys)
    assert "is a file; --to needs a folder" in refused(["reproduce", "--to", str(taken)], capsys)
    assert "cannot be made" in refused(["reproduce", "--to", str(taken / "folder")], capsys)


def test_a_full_disk_leaves_the_old_report(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "report.html"
    target.write_text("old")

    def full(_from: str, _to: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writing.os, "replace", full)
    with pytest.raises(report.InputError, match="No space left on device"):
        writing.write_whole(target, "new")
    assert target.read_text() == "old" and [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_a_report_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    writing.write_whole(tmp_path / "a.html", "x")
    (tmp_path / "b.html").write_text("x")
    assert (tmp_path / "a.html").stat().st_mode == (tmp_path / "b.html").stat().st_mode


def test_no_run_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing = str(tmp_path / "none.hpsop")
    assert "none.hpsop" in refused(["report", missing, "--to", str(tmp_path / "r.html")], capsys)
    assert "none.hpsop" in refused(["reproduce", "--to", str(tmp_path / "x"), "--run", missing], capsys)
    assert not (tmp_path / "r.html").exists()


def test_reproduce_goes_on_with_runs_of_the_papers_case_alone(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["reproduce", "--to", str(tmp_path / "out"), "--run", str(file), "--workers", "2"]
    assert "leave --workers or --run away" in refused(words, capsys)
    # Another run that lies in the folder under the very name.
    changed = load_case("dtc-p4119-paper").replaced("constants", form_factor=0.094)
    folder = tmp_path / "folder"
    folder.mkdir()
    RunController(folder / "dtc-p4119-paper.hpsop", changed, workers=1).close()
    told = refused(["reproduce", "--to", str(folder)], capsys)
    assert "as it is shipped" in told and "with --run" in told


def test_reproduce_of_a_run_that_has_evaluated_nothing(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    empty = tmp_path / "empty.hpsop"
    RunController(empty, load_case("dtc-p4119-paper"), workers=1).close()
    for run in (empty, file):
        words = ["reproduce", "--to", str(tmp_path / "out"), "--run", str(run)]
        assert "its initial design is not evaluated yet" in refused(words, capsys)


def test_the_page_says_what_the_command_says_without_its_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such run file") as refusal:
        run_report(tmp_path / "gone.hpsop")
    assert str(refusal.value).startswith(str(tmp_path))
