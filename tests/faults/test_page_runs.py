"""Runs on the page that are damaged, deleted, renamed, replaced or cut short: it starts, and says so within seconds."""

from __future__ import annotations

import logging
import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import quick_physics
from quick_physics import physics
from run_files import small_case, wait_until

from explorer.app import Explorer, _chosen, main
from explorer.server.security import free_port
from explorer.server.worker import LatestWorker
from explorer.services.designs import Designs
from explorer.services.library import NOT_READABLE, RunLibrary, runs_folder
from explorer.services.run_keeper import RunKeeper
from explorer.services.runs import Runs
from explorer.state.app_state import AppState
from explorer.state.draft import Draft
from explorer.state.hub import Hub
from explorer.state.run_picture import FAILED, FINISHED, RunPicture
from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.events import RunEvent
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.store import RunStore

SECONDS = 10.0


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("finished") / "run.hpsop"
    optimize(small_case(), path, workers=1, physics=physics())
    return path


@pytest.fixture
def keeper(tmp_path: Path, finished: Path) -> Iterator[RunKeeper]:
    path = tmp_path / "run.hpsop"
    shutil.copy(finished, path)
    kept = RunKeeper(path, lambda: None)
    assert kept.picture().status == FINISHED
    yield kept
    kept.close()


def test_the_first_picture_of_a_large_run_has_its_points_and_the_next_one_all_numbers(
    keeper: RunKeeper, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, told = keeper.picture(), []
    monkeypatch.setattr("explorer.services.run_keeper._LARGE", 5)
    large = RunKeeper(keeper.path, lambda: told.append(1))
    try:
        first, news = large.picture(), len(told)
        assert news, "the page must hear that there is more"
        assert first.columns == () and first.column("length") is None
        second = large.picture()
    finally:
        large.close()
    assert second.columns == whole.columns and np.array_equal(second.table, whole.table, equal_nan=True)
    for picture in (first, second):
        assert picture.generations == whole.generations and picture.compromise == whole.compromise
        for name in ("ids", "level", "generation", "objectives", "feasible", "failed", "by_hand", "predicted"):
            assert np.array_equal(getattr(picture, name), getattr(whole, name), equal_nan=name == "objectives"), name


def test_reading_a_large_run_makes_way_from_the_beginning_and_is_given_up(
    keeper: RunKeeper, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = keeper.picture()
    monkeypatch.setattr("explorer.services.run_keeper._LARGE", 5)
    monkeypatch.setattr("explorer.services.run_keeper._SLICE", 1000)
    monkeypatch.setattr("hpsop_core.runs.content._BETWEEN", 4)
    large = RunKeeper(keeper.path, lambda: None)
    try:
        assert large.picture().columns == ()
        asked: list[int] = []

        def until_closed() -> None:
            asked.append(len(large._known))
            if len(asked) == 3:
                large._closed.set()

        # its records are held against their checksums before the first of them is taken apart
        large.read_ahead(until_closed)
        assert asked == [0, 0, 0] and not large._known
        large._closed.clear()
        large.read_ahead(lambda: None)
        assert len(large._known) == len(whole.ids)
        assert np.array_equal(large.picture().table, whole.table, equal_nan=True)
    finally:
        large.close()


def test_a_click_does_not_wait_for_a_picture_of_a_large_run(keeper: RunKeeper, monkeypatch: pytest.MonkeyPatch) -> None:
    reading, go_on = threading.Event(), threading.Event()

    def slow(*_: object) -> None:
        reading.set()
        assert go_on.wait(30.0)

    design = keeper.picture().compromise
    assert design is not None
    monkeypatch.setattr(keeper, "_read_new", slow)
    picture = threading.Thread(target=keeper.picture)
    picture.start()
    found: list[object] = []
    click = threading.Thread(target=lambda: found.extend((keeper.evaluation(design), keeper.initial(1))))
    try:
        assert reading.wait(SECONDS)
        click.start()
        click.join(SECONDS)
        assert len(found) == 2 and None not in found
    finally:
        go_on.set()
        picture.join()
        click.join()


def test_numbers_of_a_run_are_read_when_the_page_stands(tmp_path: Path, finished: Path) -> None:
    case = small_case()
    draft = Draft(case)
    draft.begin(case)
    worker = LatestWorker("test")
    state = AppState(draft, worker, Hub(worker), RunPicture("", case))
    runs = Runs(state, Designs(state), RunLibrary(tmp_path), workers=1)
    pictures: list[float] = []
    try:
        runs.open(finished)
        keeper = runs._keeper
        assert keeper is not None
        make = keeper.picture
        keeper.picture = lambda: (pictures.append(time.monotonic()), make())[1]  # type: ignore[method-assign]
        runs.await_browser()
        runs.news()
        time.sleep(0.3)
        assert not pictures
        runs.browser_came()
        came = time.monotonic()
        wait_until(lambda: bool(pictures), SECONDS)
        assert pictures[0] - came > 1.0
    finally:
        runs.close()
        worker.close()


def test_who_watches_from_the_beginning_knows_what_a_late_comer_knows(tmp_path: Path) -> None:
    """The initial design of level 2 has the second number and is evaluated last of all: when level 2 begins."""
    path, watching = tmp_path / "run.hpsop", []

    def look(event: RunEvent) -> None:
        if event.kind == "generation":
            if not watching:
                watching.extend([open_run(path), RunKeeper(path, lambda: None)])
            reader, keeper = watching
            reader.known_fronts()
            keeper.picture()

    optimize(small_case(), path, workers=1, physics=physics(), progress=look)
    reader, keeper = watching
    late = open_run(path)
    assert 2 in late.generations()[4].asked and late.generations()[4].level == 2
    assert reader.known_fronts() == late.known_fronts()
    picture, afterwards = keeper.picture(), RunKeeper(path, lambda: None)
    assert picture.status == FINISHED and list(picture.ids) == list(afterwards.picture().ids)
    assert picture.generations == afterwards.picture().generations
    keeper.close()
    afterwards.close()


def damage(path: Path) -> None:
    """A bit in the middle of an evaluation."""
    content = bytearray(path.read_bytes())
    place = content.index(b'"offspring"') if b'"offspring"' in content else content.index(b"offspring")
    content[place] ^= 4
    path.write_bytes(bytes(content))


def test_what_becomes_of_a_file_on_display_is_said_and_the_picture_stays(
    keeper: RunKeeper, tmp_path: Path, finished: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path, count = keeper.path, len(keeper.picture().ids)

    def says(words: str) -> bool:
        picture = keeper.picture()
        return picture.status == FAILED and words in picture.message and len(picture.ids) == count

    path.rename(tmp_path / "moved.hpsop")
    wait_until(lambda: says("deleted or renamed"), SECONDS)
    shutil.copy(finished, path)
    wait_until(lambda: says("another file stands in its place"), SECONDS)
    path.unlink()
    (tmp_path / "moved.hpsop").rename(path)
    wait_until(lambda: keeper.picture().status == FINISHED, SECONDS)
    os.truncate(path, 20_000)
    wait_until(lambda: says("cut short"), SECONDS)
    assert not [record for record in caplog.records if record.levelno >= logging.WARNING]


def test_a_run_whose_file_is_deleted_while_it_is_driven_pauses_with_the_reason(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    with RunController(path, small_case(), workers=1, physics=physics(quick_physics.slow)) as controller:
        controller.start()
        wait_until(lambda: controller.snapshot().generation >= 1)
        path.rename(tmp_path / "moved.hpsop")
        wait_until(lambda: controller.snapshot().state == "paused", SECONDS)
        assert "the file is gone" in controller.snapshot().reason
        (tmp_path / "moved.hpsop").rename(path)
        assert controller.wait(60.0)
        assert controller.snapshot().state == "finished"


def test_the_page_starts_though_the_newest_run_is_damaged(tmp_path: Path, finished: Path) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    path = folder / "newest.hpsop"
    shutil.copy(finished, path)
    damage(path)
    opening = _chosen([], folder)
    assert opening.run == path, "its first look tells nothing"
    port = free_port("127.0.0.1", 8730)
    page = Explorer(opening.case, opening.run, port=port, folder=folder, workers=1, run_asked=False)
    try:
        assert "newest.hpsop: is damaged" in page.trouble
        assert page.state.picture.name.endswith(".hpsop") and page.state.picture.name != "newest.hpsop"
        entry = page.services.runs.library()[0]
        assert entry.title == NOT_READABLE and "is damaged" in entry.summary
        with pytest.raises(InputError, match="is damaged"):
            page.services.runs.open_named("newest.hpsop")
        assert page.state.picture.name != "newest.hpsop", "what was on display stays"
    finally:
        page.close()


def test_a_damaged_run_that_was_asked_for_is_refused_in_one_line(
    tmp_path: Path, finished: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HPSOP_RUNS", str(tmp_path / "runs"))
    path = tmp_path / "asked.hpsop"
    shutil.copy(finished, path)
    damage(path)
    assert main([str(path), "--no-browser", "--port", "8395"]) == 2
    told = capsys.readouterr()
    assert "asked.hpsop: is damaged" in told.err and told.err.count("\n") == 1


def test_a_failed_run_may_be_continued_from_the_library(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    with pytest.raises(InputError):
        optimize(small_case(), path, workers=1, physics=physics(quick_physics.failing_everywhere))
    RunStore(path).close()
    entry = RunLibrary(tmp_path).entries()[0]
    assert entry.summary.startswith("failed") and entry.continuable


@pytest.mark.parametrize("home", ["none", "file"])
def test_without_a_home_that_can_be_written_runs_have_a_folder_of_their_own(
    home: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HPSOP_RUNS", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "file").write_text("", encoding="utf-8")

    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    # a file where the home should be: also root cannot write into it
    monkeypatch.setattr(Path, "home", no_home if home == "none" else lambda: tmp_path / "file")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder, told = runs_folder()
    assert folder.parent == tmp_path and not list(folder.iterdir())
    assert str(folder) in told and "HPSOP_RUNS" in told
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "nowhere"))
    assert "cannot be saved" in runs_folder()[1]
    monkeypatch.setenv("HPSOP_RUNS", str(tmp_path / "mine"))
    assert runs_folder() == (tmp_path / "mine", "")
