"""Another run comes on display while views, clicks and news of the one before are still under way."""

from __future__ import annotations

import itertools
import os
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import MagicMock

import pytest
from quick_physics import physics
from run_files import small_case, wait_until

from explorer.server.bridge import PageEvent
from explorer.server.worker import LatestWorker
from explorer.services.designs import Designs
from explorer.services.library import RunLibrary
from explorer.services.remembered import Remembered
from explorer.services.runs import Runs
from explorer.state.app_state import AppState
from explorer.state.draft import Draft
from explorer.state.hub import Hub
from explorer.state.run_picture import RunPicture
from explorer.state.session import Session
from explorer.views.charts_view import ChartsView, ChartTab
from explorer.views.families import families
from explorer.views.on_display import select_design
from explorer.views.run_control import RunControl
from explorer.views.run_view import RunView
from explorer.views.settings_view import SettingsView
from explorer.views.table_view import TableView
from hpsop_core.case.case import load_case
from hpsop_core.errors import InputError
from hpsop_core.markup import Markup
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.reader import RunReader


class Page:
    """The page's state and its runs, without a server."""

    def __init__(self, folder: Path) -> None:
        case = small_case()
        draft = Draft(case)
        draft.begin(case)
        self.worker = LatestWorker("test")
        self.state = AppState(draft, self.worker, Hub(self.worker), RunPicture("", case))
        self.designs = Designs(self.state)
        self.runs = Runs(self.state, self.designs, RunLibrary(folder), workers=1)
        self.session = Session(self.state, 1, lambda *_: None)
        self.state.join(1, self.session)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A run of three generations and one of a single one, in two folders, of one name."""
    long, short = (tmp_path_factory.mktemp(name) / "run.hpsop" for name in ("long", "short"))
    optimize(small_case(), long, workers=1, physics=physics())
    optimize(small_case(generations=1, level1_generations=1), short, workers=1, physics=physics())
    return long, short


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Page]:
    made = Page(tmp_path)
    yield made
    made.session.close()
    made.runs.close()
    made.worker.close()


def copied(finished: tuple[Path, Path], folder: Path, *names: str) -> list[Path]:
    """Runs that a test may write to, by these names."""
    return [Path(shutil.copy(run, folder / name)) for run, name in zip(finished, names, strict=True)]


def test_late_news_of_the_run_before_does_not_come_back(
    page: Page, finished: tuple[Path, Path], tmp_path: Path
) -> None:
    first, second = copied(finished, tmp_path, "first.hpsop", "second.hpsop")
    page.runs.open(first)
    keeper = page.runs._keeper
    assert keeper is not None
    asked, go_on, opened = threading.Event(), threading.Event(), threading.Event()
    make = keeper.picture

    def slow_picture() -> RunPicture:
        picture = make()
        asked.set()
        assert go_on.wait(60.0)
        return picture

    keeper.picture = slow_picture  # type: ignore[method-assign]
    page.runs.news()
    assert asked.wait(60.0)

    def switch() -> None:
        page.runs.open(second)
        opened.set()

    thread = threading.Thread(target=switch)
    thread.start()
    # where the late picture does not hold it up the other run is on display now
    opened.wait(0.5)
    go_on.set()
    thread.join(60.0)
    assert page.runs._pictures.wait_until_idle(60.0)
    assert page.state.picture.name == "second.hpsop"


def test_another_run_need_not_wait_until_a_large_one_has_been_read(
    page: Page, finished: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its numbers give way to whoever is waited for, and are given up once nobody will see them."""
    monkeypatch.setattr("explorer.services.run_keeper._LARGE", 5)
    monkeypatch.setattr("explorer.services.run_keeper._SLICE", 2)
    reading, answered, read = threading.Event(), threading.Event(), []
    decode = RunReader.news

    def slow(reader: RunReader, *arguments: object) -> Iterator[object]:
        for item in decode(reader, *arguments):  # type: ignore[arg-type]
            read.append(reader.path)
            reading.set()
            yield item

    monkeypatch.setattr(RunReader, "news", slow)
    page.session.worker.every(lambda: bool(reading.wait(60.0) and answered.wait(60.0)), first=True)
    page.runs._rested = time.monotonic() + 3600.0  # as after a run whose pictures took long
    page.runs.open(finished[0])
    assert reading.wait(60.0)
    page.runs.open(finished[1])
    assert page.state.picture.opening == page.runs._keeper.opening  # type: ignore[union-attr]
    assert len(read) <= 4, "reading went on under a gesture"
    answered.set()
    assert page.runs._pictures.wait_until_idle(60.0)
    assert read.count(finished[0]) < 10 < len(page.state.picture.ids)


def test_a_run_that_came_into_the_place_of_the_one_on_display_is_not_driven(
    page: Page, finished: tuple[Path, Path], tmp_path: Path
) -> None:
    shown, other = copied(finished, tmp_path, "shown.hpsop", "other.hpsop")
    page.runs.open(shown)
    design = page.designs.shown(3)
    assert design is not None
    os.replace(other, shown)
    before = shown.read_bytes()
    for act in (
        lambda: page.runs.extend(2),
        lambda: page.runs.control("continue"),
        lambda: page.runs.add_by_hand(design.evaluation),
        page.runs.report,
    ):
        with pytest.raises(InputError, match="another file stands in its place"):
            act()
    page.runs.keep_errors(3, design.evaluation)
    assert shown.read_bytes() == before and not is_being_written(shown)
    shown.unlink()
    with pytest.raises(InputError, match="is gone"):
        page.runs.extend(2)
    assert not shown.exists()


def test_a_click_on_the_run_before_selects_nothing_in_the_next(page: Page, finished: tuple[Path, Path]) -> None:
    page.runs.open(finished[0])
    late = page.designs.shown(3)
    assert late is not None
    page.session.select(late)
    page.session.pin(late)
    assert page.session.selected is late
    # of the same name and also with a design 3
    page.runs.open(finished[1])
    now = page.session.selected
    assert now is not None and now is not late
    assert page.session.pins == ()
    page.session.select(late)
    page.session.pin(late)
    assert page.session.selected is now
    assert page.session.pins == ()
    select_design(page.session, page.designs, 3)
    assert page.session.selected is not now


def test_while_the_next_run_s_first_design_is_computed_none_of_the_run_before_is_shown(
    page: Page, finished: tuple[Path, Path]
) -> None:
    page.runs.open(finished[0])
    session = page.session
    assert session.selected is not None
    session.pin(session.selected)
    seen = []

    def first() -> None:
        seen.append((session.selected, session.pins))

    page.state.show_run(RunPicture("other.hpsop", small_case(), opening=999), first)
    assert seen == [(None, ())]


def test_run_and_design_change_together(page: Page) -> None:
    told: list[str] = []
    page.state.hub.on(("run",), lambda: told.append("run"))
    before: list[list[str]] = []

    def first() -> None:
        page.worker.wait_until_idle(10.0)
        before.append(list(told))

    page.state.show_run(RunPicture("other.hpsop", small_case(), opening=999), first)
    assert page.worker.wait_until_idle(10.0)
    assert (before, told) == ([[]], ["run"])


def test_a_run_that_is_being_opened_is_named_until_it_stands_or_is_refused(page: Page) -> None:
    status = MagicMock()
    status.add_html.side_effect = lambda *_, **__: MagicMock()
    view = RunView(page.state, page.runs, status)
    opening, go_on = threading.Event(), threading.Event()

    def slow(name: str) -> None:
        opening.set()
        assert go_on.wait(30.0)
        raise InputError(f"{name}: is damaged")

    page.runs.open_named = slow  # type: ignore[method-assign]
    RunControl(page.session, page.runs)
    page.session.gestures.receive(PageEvent("act", name="open_run", arg="other.hpsop"))
    try:
        assert opening.wait(10.0)
        assert "opening other.hpsop …" in view._facts_slot._content
    finally:
        go_on.set()
    wait_until(lambda: page.state.coming == "", 10.0)
    assert page.worker.wait_until_idle(10.0)
    assert "opening" not in view._facts_slot._content


def test_the_same_file_opened_again_keeps_what_is_selected(page: Page, finished: tuple[Path, Path]) -> None:
    page.runs.open(finished[0])
    select_design(page.session, page.designs, 3)
    selected = page.session.selected
    page.runs.open(finished[0])
    assert page.session.selected is selected


def test_another_case_is_shown_at_once_and_a_run_that_rests_waits(page: Page, finished: tuple[Path, Path]) -> None:
    page.runs.open(finished[0])
    # its widgets belong to a server, and choosing touches none of them
    view = object.__new__(SettingsView)
    view._app, view._runs = page.state, page.runs
    wanted = load_case("dtc-p4119-paper")
    view._on_preset(MagicMock(client_id=1, target=MagicMock(value=wanted.name)))
    wait_until(lambda: page.state.picture.name == "")
    assert page.state.picture.case == wanted
    wait_until(lambda: page.session.selected is not None)
    selected = page.session.selected
    assert selected is not None and selected.kind == "initial"
    assert selected.evaluation.conditions[0].speed == pytest.approx(wanted.speeds[0])


def test_a_chart_is_drawn_once_when_another_run_comes(page: Page, finished: tuple[Path, Path]) -> None:
    page.runs.open(finished[0])
    drawn, saving, held = [], MagicMock(), threading.Event()
    saving.offer.return_value = Markup("")

    def tab(name: str, *topics: str) -> ChartTab:
        return ChartTab(name, name, "run", frozenset(topics), lambda session, _: drawn.append(name) or [])

    tabs = [tab("parallel", "run", "filter", "selection", "scrub"), tab("waves", "curves")]
    ChartsView(page.session, page.designs, MagicMock(), {item.name: item for item in tabs}, saving)
    assert page.session.worker.wait_until_idle(60.0)
    drawn.clear()
    page.session.worker.every(lambda: bool(held.wait(60.0)), first=True)
    page.runs.open(finished[1])
    page.session.hub.changed("curves")
    held.set()
    assert page.session.worker.wait_until_idle(60.0)
    # of the five things that are new with it the chart shows four; what only another chart shows draws nothing
    assert drawn == ["parallel"]


def test_more_families_than_lines_are_remembered_are_drawn_and_that_is_all(
    page: Page, finished: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cutting those that had been forgotten again forgot others, and so on for as long as the page stood."""
    remembered = 4
    monkeypatch.setattr(page.designs._answers, "_lines", Remembered(remembered))
    monkeypatch.setattr("explorer.views.families._MOST_PICTURES", remembered - 1, raising=False)
    page.runs.open(finished[0])
    drawn: list[int] = []

    def draw() -> None:
        parts = families(page.session, page.designs)
        drawn.append(str(parts[0]).count("<button"))

    page.session.hub.on(("curves",), draw)
    page.session.hub.changed("curves")
    wait_until(lambda: page.designs.known_lines(page.designs.case.initial.variables) is not None)
    time.sleep(2.0)
    assert drawn[-1] > remembered
    before = len(drawn)
    time.sleep(2.0)
    assert len(drawn) == before


def test_a_table_is_drawn_of_one_picture(
    page: Page, finished: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another run comes on display between any two looks: rows of one never meet the columns of another."""
    pictures = []
    for path in finished:
        page.runs.open(path)
        pictures.append(page.state.picture)
    assert len(pictures[0].ids) > len(pictures[1].ids)
    view = TableView(page.session, page.designs, MagicMock(), lambda *_: None)
    wait_until(lambda: page.session.worker.wait_until_idle(1.0))
    page.session.table = page.session.table.restored({"which": "all", "choosing": True})
    event = MagicMock(arg="selected")
    for order in (pictures, pictures[::-1]):
        looks = itertools.cycle(order)
        monkeypatch.setattr(Session, "picture", property(lambda _session, looks=looks: next(looks)))
        view.draw()
        view._csv(event)
        view._turn(event)
