"""What can be taken back, linked to and called by a name is the same again afterwards; no browser, no physics."""

from __future__ import annotations

import dataclasses
import threading
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from explorer.charts.parallel import axes_of, brushed, moved
from explorer.charts.scatter import pick_scatter, scatter_chart, scatter_limits, scatter_rows
from explorer.scene.camera import PRESETS
from explorer.server.bridge import PageEvent
from explorer.server.worker import LatestWorker, Turn
from explorer.services.library import RunLibrary
from explorer.state.app_state import AppState
from explorer.state.chart_options import ChartOptions
from explorer.state.draft import Draft
from explorer.state.gestures import Gestures
from explorer.state.history import History
from explorer.state.hub import Hub
from explorer.state.link import Link, LinkedDesign, read_link
from explorer.state.run_picture import GenerationPicture, RunPicture
from explorer.state.session import Session
from explorer.state.shown import Shown
from explorer.state.view_options import ViewOptions
from explorer.views.on_display import follow_best
from hpsop_core.case.case import Case, load_case
from hpsop_core.charts.looks import Sheet
from hpsop_core.charts.search import Mark
from hpsop_core.errors import InputError
from hpsop_core.evaluation.evaluate import evaluate
from tests.two_speeds import TWO_SPEEDS


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(TWO_SPEEDS)


# ---- steps -----------------------------------------------------------------------------------------------------------
def test_steps_go_back_and_forth_and_a_drag_is_one_of_them():
    history: History[int] = History()
    assert history.undo(0) is None and not history.can_undo
    history.record(0, "draft", now=0.0)
    history.record(1, "draft", now=0.5)
    history.record(2, "diameter", now=0.6)
    assert (history.undo(3), history.undo(2), history.undo(0)) == (2, 0, None)
    assert (history.redo(0), history.redo(2), history.redo(3)) == (2, 3, None)
    # what is changed after an undo replaces what was taken back
    assert history.undo(3) == 2
    history.record(2, "draft", now=9.0)
    assert not history.can_redo
    # the same thing later is another step
    history.record(5, "draft", now=20.0)
    assert (history.undo(6), history.undo(5)) == (5, 2)


def test_settings_are_taken_back_and_made_again(case: Case):
    worker = LatestWorker("test")
    app = AppState(Draft(case), worker, Hub(worker), RunPicture("", case))
    try:
        before = app.drafted()
        app.change_draft(lambda draft: draft.set("bounds", "draft", (14.1, 14.4)))
        app.change_draft(lambda draft: draft.set("optimization", "population", 30))
        changed = app.drafted()
        # no change is no step
        app.change_draft(lambda draft: draft.set("optimization", "population", 30))
        assert app.turn_draft(back=True)
        assert app.drafted().optimization == before.optimization and app.drafted().bounds == changed.bounds
        assert app.turn_draft(back=True) and app.drafted() == before
        assert not app.turn_draft(back=True)
        assert app.turn_draft(back=False) and app.turn_draft(back=False) and app.drafted() == changed
        # a preset chosen by mistake
        app.change_draft(lambda draft: draft.begin(load_case("dtc-p4119-paper")))
        assert app.turn_draft(back=True) and app.drafted() == changed
    finally:
        worker.close()


# ---- who comes first -------------------------------------------------------------------------------------------------
def test_a_gesture_and_what_follows_from_it_go_before_a_runs_news():
    worker = LatestWorker("test")
    hub, held = Hub(worker), threading.Event()
    done: list[str] = []
    try:
        for name in ("chart", "table", "curves"):
            hub.on(("run",), partial(done.append, f"{name} of the run"))
        hub.on(("tab",), partial(done.append, "the tab"))
        hub.on(("ready",), partial(done.append, "the curves"))
        gestures = Gestures(worker)
        gestures.on("act", "tab", lambda event: hub.changed("tab"))
        worker.every(lambda: bool(held.wait(60.0)))
        hub.changed("run", news=True)
        gestures.receive(PageEvent("act", name="tab"))
        # as curves that have been computed meanwhile
        hub.changed("ready")
        held.set()
        assert worker.wait_until_idle(60.0)
        assert done == ["the curves", "the tab", "chart of the run", "table of the run", "curves of the run"]
    finally:
        held.set()
        worker.close()


def test_background_work_of_browsers_takes_turns_and_none_waits_long_for_another():
    turn = Turn(0.5)
    workers = [LatestWorker(f"maps {number}", turn=turn) for number in range(3)]
    running, most, go_on = [], [], threading.Event()

    def short() -> None:
        running.append(1)
        most.append(len(running))
        time.sleep(0.02)
        running.pop()

    def drain() -> None:
        assert all(worker.wait_until_idle(60.0) for worker in workers)

    try:
        for worker in workers * 5:
            worker.every(short)
        drain()
        assert (len(most), max(most)) == (15, 1)
        # one takes seconds: the others go on beside it
        workers[0].every(lambda: bool(go_on.wait(60.0)))
        workers[1].every(short)
        assert workers[1].wait_until_idle(60.0)
        assert not workers[0].wait_until_idle(0.0)
        go_on.set()
        drain()
        # and what failed has given its turn back
        workers[0].every(lambda: 1 // 0)
        drain()
        assert turn._lock.acquire(timeout=0.0)
    finally:
        go_on.set()
        for worker in workers:
            worker.close()


def test_a_view_that_cannot_be_made_gives_its_tab_back():
    worker = LatestWorker("test")
    hub, drawn, held = Hub(worker), [], threading.Event()
    try:
        with pytest.raises(InputError), hub.in_tab("Table"):
            raise InputError("no such view")
        hub.on(("selection",), lambda: drawn.append("card"))
        hub.tabs_open(["Charts"])
        with hub.in_tab("Charts"):
            hub.on(("selection",), lambda: drawn.append("charts"))
        worker.every(lambda: bool(held.wait(60.0)))
        hub.changed("selection")
        held.set()
        assert worker.wait_until_idle(60.0)
        # not behind what is seen, as if it stood in the closed table
        assert drawn == ["card", "charts"]
    finally:
        held.set()
        worker.close()


def test_what_nobody_sees_is_drawn_when_nobody_waits():
    worker = LatestWorker("test")
    hub, drawn, go_on = Hub(worker), [], threading.Event()
    try:
        with hub.in_tab("Table"):
            hub.on(("selection",), lambda: drawn.append("table"))
        with hub.in_tab("Charts"):
            hub.on(("selection",), lambda: drawn.append("charts"))
        hub.on(("selection",), lambda: drawn.append("card"))
        hub.changed("selection")
        assert worker.wait_until_idle(10.0)
        assert drawn == ["table", "charts", "card"]  # where the browser has not said yet what is seen
        drawn.clear()
        hub.tabs_open(["Pareto front", "Charts"])

        def gesture() -> None:
            # told by the worker itself, as a click's selection is
            hub.changed("selection")
            assert go_on.wait(10.0)

        worker.every(gesture, first=True)
        worker.every(lambda: drawn.append("next click"), first=True)
        go_on.set()
        assert worker.wait_until_idle(10.0)
        assert drawn.index("table") == 3 and set(drawn[:3]) == {"charts", "card", "next click"}
    finally:
        go_on.set()
        worker.close()


def test_a_runs_news_leave_a_gestures_answer_the_time_to_reach_the_screen():
    worker = LatestWorker("test", calm=0.5)
    first, done = threading.Event(), []
    try:
        worker.every(lambda: (done.append("press"), first.set()), first=True)
        assert first.wait(60.0)
        worker.every(lambda: done.append("news"))
        time.sleep(0.02)
        worker.every(lambda: done.append("next press"), first=True)
        assert worker.wait_until_idle(60.0)
        assert done == ["press", "next press", "news"]
    finally:
        worker.close()


def test_what_waits_already_goes_first_once_a_gesture_asks_for_it():
    worker = LatestWorker("test")
    held = threading.Event()
    done: list[str] = []
    try:
        worker.every(lambda: bool(held.wait(60.0)))
        worker.latest("table", lambda: done.append("table"))
        worker.latest("chart", lambda: done.append("old chart"))
        worker.latest("chart", lambda: done.append("chart"), first=True)
        # news of a run that come after it do not put it behind again
        worker.latest("chart", lambda: done.append("newer chart"))
        assert worker.waiting("chart") and worker.waiting("table")
        held.set()
        assert worker.wait_until_idle(60.0)
        assert done == ["newer chart", "table"]
    finally:
        held.set()
        worker.close()


# ---- links -----------------------------------------------------------------------------------------------------------
def test_a_link_opens_what_it_was_made_of(case: Case):
    variables = dataclasses.replace(case.initial.variables, length_to_breadth=7.123456)
    options = dataclasses.replace(ViewOptions(), camera="profile", waves=True, topsides=False, condition=1)
    link = Link(
        "my run.hpsop",
        12,
        LinkedDesign(None, variables, 2),
        (LinkedDesign(7411), LinkedDesign()),
        options,
        "resistance",
    )
    query = link.query()
    assert read_link("?" + query, PRESETS) == link
    assert "token" not in query and len(query) < 600


@pytest.mark.parametrize(
    "query",
    ["", "?", "?token=abc", "?chart=x", "?" + "run=a&" * 2000, "?run=" + "a" * 5000, "?a=" + "&b=" * 30],
)
def test_an_address_that_says_nothing_of_ours_opens_nothing(query: str):
    assert read_link(query, PRESETS) is None


def test_what_a_link_says_wrongly_is_left_out():
    link = read_link("?run=a.hpsop&design=w1~1_2&generation=-3&pins=x,5,nan&view=moon&at=99999", PRESETS)
    assert link == Link("a.hpsop", None, None, (LinkedDesign(5),), None, "")
    assert LinkedDesign.read("w1~" + "_".join(["nan"] * 9)) is None
    assert LinkedDesign.read("9" * 40) is None


# ---- names -----------------------------------------------------------------------------------------------------------
def test_a_run_keeps_its_name_and_note_and_the_demonstration_stays(tmp_path: Path):
    shipped = tmp_path / "shipped" / "demo.hpsop"
    shipped.parent.mkdir()
    shipped.write_bytes(b"no run, but there")
    folder = tmp_path / "runs"
    folder.mkdir()
    (folder / "mine.hpsop").write_bytes(b"no run either")
    library = RunLibrary(folder, shipped)
    library.labels.write("mine.hpsop", name="  Wide\x00 bulb ")
    library.labels.write("mine.hpsop", note="the owner's second wish")
    # written beside the run, which stays as it is
    assert (folder / "mine.hpsop").read_bytes() == b"no run either"
    again = RunLibrary(folder, shipped)
    mine, demonstration = again.entries()
    assert (mine.label.name, mine.label.note) == ("Wide bulb", "the owner's second wish")
    assert demonstration.shipped and not demonstration.deletable and not demonstration.continuable
    assert again.path("demo.hpsop") == shipped and again.is_shipped(shipped)
    with pytest.raises(InputError, match="stays"):
        again.delete("demo.hpsop")
    assert shipped.exists()
    again.delete("mine.hpsop")
    assert not again.labels.all()
    # whatever stands in the file
    (folder / "labels.json").write_text('{"a": 3, "b": {"name": ["x"], "note": null}}', encoding="utf-8")
    assert set(again.labels.all()) == {"b"}


# ---- charts of a run -------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def picture(case: Case) -> RunPicture:
    points = np.array([(1.0, 0.9), (0.95, 0.95), (0.9, 1.0), (np.nan, np.nan)])
    length = np.array([330.0, 340.0, 350.0, np.nan])
    return RunPicture(
        "run.hpsop",
        case,
        ids=np.arange(1, 5),
        level=np.ones(4, dtype=np.int64),
        generation=np.array([1, 1, 2, 2]),
        objectives=points,
        feasible=np.array([True, False, True, False]),
        failed=np.array([False, False, False, True]),
        by_hand=np.zeros(4, dtype=bool),
        table=length[:, None],
        columns=("length",),
        generations=(GenerationPicture(1, 1, (1, 2), (1,), 0.1), GenerationPicture(2, 1, (1, 3), (1, 3), 0.1)),
    )


def test_the_scatter_chart_draws_and_picks_what_was_chosen(picture: RunPicture):
    options = ChartOptions(x="length", y="f2", colour="f1", size="f2")
    rows = scatter_rows(picture, None, infeasible=False)
    assert rows.tolist() == [0, 2]
    assert scatter_rows(picture, 1, infeasible=True).tolist() == [0, 1]
    limits = scatter_limits(picture, options, rows)
    plot = scatter_chart(picture, options, rows, {}, limits, [], Sheet(400.0, 300.0))
    svg = plot.svg("scatter")
    assert "L_" not in svg and "[m]" in svg
    # two designs of two colours and two sizes, and both are on the front
    assert svg.count('class="dots archive"') == 2 and svg.count('class="mark level1 open"') == 2
    size = (plot.area.width, plot.area.height)
    assert pick_scatter(picture, options, rows, (350.0, 1.0), limits, size) == [3]
    assert pick_scatter(picture, options, rows, (340.0, 0.95), limits, size) == []
    # the initial design's mark has no place among no designs
    mark = Mark(1.0, 1.0, "square", 4.0, "initial", "initial design")
    empty = scatter_chart(picture, options, rows[:0], {}, ((0.0, 1.0), (0.0, 1.0)), [mark], Sheet(400.0, 300.0))
    assert "initial" not in empty.svg("scatter")
    # a quantity of another run makes room
    assert "f₁" in scatter_chart(
        picture, ChartOptions(x="gone"), rows, {}, scatter_limits(picture, ChartOptions(x="gone"), rows), [],
        Sheet(400.0, 300.0),
    ).svg("scatter")  # fmt: skip


def test_an_axis_goes_where_it_is_dragged_and_a_brush_finds_it_there(picture: RunPicture):
    keys = [quantity.key for quantity in axes_of(picture)]
    last = len(keys) - 1
    order = moved(picture, (), 0.0, 2.0 / last)
    assert order == (keys[1], keys[2], keys[0], *keys[3:])
    assert moved(picture, (), 0.0, 0.2 / last) is None
    assert moved(picture, order, 2.0 / last, -3.0) == tuple(keys)
    found = brushed(picture, order, 2.0 / last, 0.2, 0.8)
    assert found is not None and found[0] == keys[0]


def test_options_of_charts_come_back_whatever_a_file_holds():
    options = ChartOptions(x="draft", axes=("f1", "draft"))
    assert ChartOptions().restored(dataclasses.asdict(options)) == options
    assert ChartOptions().restored({"x": 3, "axes": [1], "colour": "a" * 500}) == ChartOptions()
    assert ChartOptions().restored(None) == ChartOptions()


# ---- following a run -------------------------------------------------------------------------------------------------
class _Designs:
    """Designs of a run, all of one form."""

    def __init__(self, case: Case) -> None:
        self._evaluation = evaluate(case, case.initial.variables, 1)

    def shown(self, design_id: int) -> Shown:
        return Shown(f"Design {design_id}", self._evaluation, design_id)


def test_the_selection_follows_the_best_until_another_design_is_selected(case: Case, picture: RunPicture):
    worker = LatestWorker("test")
    app = AppState(Draft(case), worker, Hub(worker), dataclasses.replace(picture, compromise=1))
    session = Session(app, 1, lambda title, body, colour: None)
    designs: Any = _Designs(case)
    try:
        follow_best(session, designs)
        assert session.selected is None
        session.set_follow(True)
        follow_best(session, designs)
        assert session.selected is not None and session.selected.design_id == 1
        app.picture = dataclasses.replace(picture, compromise=3)
        follow_best(session, designs)
        assert session.selected.design_id == 3 and session.follow
        session.select(designs.shown(2))
        app.picture = dataclasses.replace(picture, compromise=1)
        follow_best(session, designs)
        assert session.selected.design_id == 2 and not session.follow
    finally:
        session.close()
        worker.close()
