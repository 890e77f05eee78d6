"""The page's main gestures with mouse and keyboard, one after another on one page and one small finished run."""

from __future__ import annotations

import json
import math
import re
import zipfile

import numpy as np
import pytest
from conftest import choose_tab, front_marks, press, session_of, small_case, wait_until
from PIL import Image

from explorer.app import Explorer
from explorer.server.security import free_port
from hpsop_core.errors import InputError
from hpsop_core.runs.reader import open_run


@pytest.fixture(scope="module")
def explorer(tmp_path_factory):
    page = Explorer(
        small_case(generations=5, level1_generations=5),
        port=free_port("127.0.0.1", 8460),
        folder=tmp_path_factory.mktemp("runs"),
        workers=2,
    )
    page.services.runs.start()
    wait_until(lambda: page.state.picture.status == "finished", 90, "the small run")
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer, open_page):
    return open_page(explorer)


@pytest.fixture
def session(explorer, page):
    return session_of(explorer)


def chart_point(page, fx: float, fy: float, chart: str = "pareto") -> tuple[float, float]:
    """Screen coordinates of a fraction of a chart's plot area (upwards)."""
    return tuple(
        page.evaluate(
            """([chart, fx, fy]) => {
                const svg = document.querySelector(`svg[data-chart=${chart}]`);
                const box = svg.getBoundingClientRect(), view = svg.viewBox.baseVal;
                const [px, py, pw, ph] = svg.dataset.plot.split(',').map(Number);
                return [box.x + (px + fx * pw) / view.width * box.width,
                        box.y + (py + (1 - fy) * ph) / view.height * box.height];
            }""",
            [chart, fx, fy],
        )
    )


def test_hover_shows_all_numbers_of_the_design(page, session):
    x, y = front_marks(page)[-1]
    page.mouse.move(x, y)
    page.wait_for_function("() => document.querySelector('.hpsop-tip').style.display === 'block'")
    text = page.locator(".hpsop-tip").inner_text()
    assert text.startswith("Design ")
    for word in ("LPP", "CB", "KT1", "PD2", "η02", "g₃"):
        assert word in text
    page.mouse.move(5, 5)
    page.wait_for_function("() => document.querySelector('.hpsop-tip').style.display === 'none'")


def test_keyboard_walks_along_the_front(page, session):
    from explorer.charts.pareto import front_order

    order = front_order(session.picture, None)
    page.mouse.click(*front_marks(page)[0])
    wait_until(lambda: session.selected.design_id in order, 20, "a front design")
    page.keyboard.press("Home")
    wait_until(lambda: session.selected.design_id == order[0], 20, "Home")
    page.keyboard.press("ArrowRight")
    wait_until(lambda: session.selected.design_id == order[min(1, len(order) - 1)], 20, "ArrowRight")
    page.keyboard.press("End")
    wait_until(lambda: session.selected.design_id == order[-1], 20, "End")
    page.keyboard.press("ArrowLeft")
    wait_until(lambda: session.selected.design_id == order[max(len(order) - 2, 0)], 20, "ArrowLeft")


def test_wheel_zooms_drag_pans_and_double_click_shows_all(page, session):
    page.mouse.move(*chart_point(page, 0.5, 0.5))
    page.mouse.wheel(0, -200)
    wait_until(lambda: "pareto" in session.limits, 20, "the zoom")
    (a, b), _ = session.limits["pareto"]
    x, y = chart_point(page, 0.5, 0.5)
    page.mouse.down()
    page.mouse.move(x + 40, y, steps=4)
    page.mouse.up()
    wait_until(lambda: session.limits["pareto"][0][0] < a - 1e-6, 20, "the pan")
    (c, d), _ = session.limits["pareto"]
    # a pan moves both limits by the same amount
    assert math.isclose(d - c, b - a, rel_tol=1e-6)
    page.mouse.dblclick(*chart_point(page, 0.95, 0.95))
    wait_until(lambda: "pareto" not in session.limits, 20, "the whole chart")


def test_box_filters_and_escape_clears(page, session):
    x, y = chart_point(page, 0.02, 0.02)
    page.mouse.move(x, y)
    page.keyboard.down("Shift")
    page.mouse.down()
    page.mouse.move(*chart_point(page, 0.6, 0.6), steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")
    wait_until(lambda: {"f1", "f2"} <= set(session.filters), 20, "the box")
    low, high = session.filters["f1"]
    assert low < high
    page.keyboard.press("Escape")
    wait_until(lambda: not session.filters, 20, "Escape")


def test_scrubber_steps_and_play(page, session):
    press(page, "step", "-1")
    wait_until(lambda: session.scrubbed == 4, 20, "the fourth generation")
    press(page, "follow")
    wait_until(lambda: session.scrubbed is None, 20, "the newest")
    press(page, "play")
    wait_until(lambda: session.scrubbed is not None and session.scrubbed >= 3, 20, "play")
    press(page, "follow")
    wait_until(lambda: session.scrubbed is None, 20, "the newest again")


def test_brush_on_parallel_coordinates_filters(page, session):
    choose_tab(page, "Charts")
    press(page, "tab", "parallel")
    # the panel may be lower than the chart
    page.locator("svg[data-chart=parallel]").scroll_into_view_if_needed()
    x, y = chart_point(page, 0.0, 0.2, "parallel")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(*chart_point(page, 0.0, 0.8, "parallel"), steps=4)
    page.mouse.up()
    wait_until(lambda: "length_to_breadth" in session.filters, 20, "the brush")
    low, high = session.filters["length_to_breadth"]
    # 0.2 and 0.8 of the bounds 6.5 .. 8.5; a pixel of the axis is about 0.015
    assert abs(low - 6.9) < 0.06
    assert abs(high - 8.1) < 0.06
    page.mouse.click(*chart_point(page, 0.0, 0.5, "parallel"))
    wait_until(lambda: "length_to_breadth" not in session.filters, 20, "the click that drops it")


def test_every_chart_draws(page, session):
    for name, chart in (
        ("resistance", "resistance_total"),
        ("thrust", "thrust"),
        ("lines", "body_plan"),
        ("convergence", "convergence"),
        ("open_water", "open_water"),
    ):
        press(page, "tab", name)
        page.wait_for_selector(f'svg[data-chart="{chart}"] path.line')
    press(page, "tab", "failures")
    page.wait_for_selector('[data-chart-tab="failures"]:has-text("No evaluation failed")')


def test_pins_stand_side_by_side(page, session):
    choose_tab(page, "Design")
    press(page, "choose", "initial")
    wait_until(lambda: session.selected.kind == "initial", 20, "the initial design")
    press(page, "pin")
    wait_until(lambda: len(session.pins) == 1, 20, "one pin")
    press(page, "choose", "compromise")
    wait_until(lambda: session.selected.kind == "run", 20, "the compromise")
    press(page, "pin")
    wait_until(lambda: len(session.pins) == 2, 20, "two pins")
    choose_tab(page, "Compare")
    page.wait_for_selector('[data-act="unpin"]')
    heads = page.locator("table.numbers:visible th").all_inner_texts()
    assert any(text.startswith("Design ") for text in heads)
    assert any(text.startswith("Initial design") for text in heads)


def drag_slider(page, label: str, share: float) -> None:
    """Click on the track of a slider of the what-if panel, found by its own label, with or without a bound's arrow."""
    box = page.locator("label:visible").get_by_text(re.compile(rf"^{re.escape(label)}( [↑↓])?$")).last.bounding_box()
    track = page.evaluate(
        """(y) => { const found = [...document.querySelectorAll('.mantine-Slider-track')].filter(e => {
            const r = e.getBoundingClientRect();
            return r.width > 20 && Math.abs(r.y + r.height / 2 - y) < 16 && r.x > 600; });
            const r = found[0].getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }""",
        box["y"] + box["height"] / 2,
    )
    page.mouse.click(track[0] + share * track[2], track[1] + track[3] / 2)


def test_what_if_answers_live(page, session):
    choose_tab(page, "What-if")
    before = session.selected
    drag_slider(page, "L/B", 0.5)
    wait_until(lambda: session.selected.kind == "whatif", 30, "a what-if design")
    value = session.selected.evaluation.variables.length_to_breadth
    # half of the slider's 5.5 .. 9.5
    assert abs(value - 7.5) < 0.1
    assert session.selected.evaluation.level == 1
    assert value != before.evaluation.variables.length_to_breadth
    assert session.selected.evaluation.variables.draft == pytest.approx(before.evaluation.variables.draft, abs=0.006)


def test_what_if_at_level_2_and_into_the_archive(page, session, explorer):
    """The buttons of the what-if: the same design by the panel methods, and kept in the run's file as made by hand."""
    choose_tab(page, "What-if")
    assert session.selected.kind == "whatif"
    variables, known = session.selected.evaluation.variables, len(session.picture.ids)
    page.get_by_role("button", name="Evaluate at level 2").click()
    wait_until(lambda: session.selected.evaluation.level == 2, 120, "the answer of level 2")
    assert session.selected.evaluation.variables == variables
    assert session.selected.evaluation.conditions[0].total_resistance > 0.0
    page.get_by_role("button", name="Add to the run's archive as a hand-made design").click()
    wait_until(lambda: session.selected.kind == "run", 30, "the kept design")
    kept = session.selected.design_id
    assert session.selected.evaluation.variables == variables
    assert session.selected.label.endswith("(by hand)")
    wait_until(lambda: len(session.picture.ids) == known + 1, 20, "the archive with it")
    assert session.picture.by_hand[session.picture.row(kept)]
    assert open_run(explorer.folder / session.picture.name).designs([kept])[0].evaluation.variables == variables
    # the search's own front does not change for it, and the chart marks it
    assert all(kept not in item.members for item in session.picture.generations)
    page.wait_for_selector(f'svg[data-chart=pareto] title:has-text("made by hand: design {kept}")', state="attached")
    # only a design of one's own making can be added
    wait_until(lambda: page.get_by_role("button", name="Add to the run's archive").is_disabled(), 20, "the grey button")


def test_what_if_says_in_words_what_is_violated(page, session):
    choose_tab(page, "What-if")
    drag_slider(page, "D [m]", 0.97)
    wait_until(
        lambda: session.selected.kind == "whatif" and not session.selected.evaluation.feasible, 30, "a violation"
    )
    assert session.selected.evaluation.constraints["diameter_to_draft"] > 0.0
    page.wait_for_selector('p.bad:visible:has-text("D/d")')


def test_layers_and_choices_of_the_chart(page, session):
    press(page, "layer", "infeasible")
    wait_until(lambda: session.infeasible, 20, "infeasible designs")
    if bool((~session.picture.feasible).any()):
        page.wait_for_selector("svg[data-chart=pareto] path.dots.infeasible", state="attached")
    press(page, "layer", "infeasible")
    press(page, "layer", "archive")
    wait_until(lambda: not session.archive, 20, "no archive")
    page.wait_for_selector("svg[data-chart=pareto] path.dots.archive", state="detached")
    press(page, "layer", "archive")
    wait_until(lambda: session.archive, 20, "the archive")
    choose_tab(page, "Design")
    press(page, "choose", "knee")
    wait_until(lambda: session.selected.design_id == session.picture.knee, 20, "the knee")
    assert session.picture.compromise is not None
    press(page, "choose", "compromise")
    wait_until(lambda: session.selected.design_id == session.picture.compromise, 20, "the compromise")


def test_camera_presets_and_the_turning_propeller(page, session, explorer):
    client = explorer.server.get_clients()[session.client_id]
    places = {}
    for name in ("profile", "plan", "body", "propeller", "perspective"):
        press(page, "camera", name)
        wait_until(lambda name=name: session.options.camera == name, 20, name)
        # profile looks along y, plan from above; a view may be framed anew once more before the next is asked for
        axis = {"profile": 1, "plan": 2}.get(name)
        far = 5 * session.selected.evaluation.hull.draft if axis is not None else 0.0
        wait_until(
            lambda axis=axis, far=far: (
                tuple(client.camera.position) not in places.values() and abs(client.camera.position[axis or 0]) > far
            ),
            20,
            f"the camera of {name}",
        )
        places[name] = tuple(client.camera.position)
    # the close-up stands within two diameters of the propeller
    shaft = np.asarray(client.scene.get_handle_by_name("/ship/propeller").position)
    assert np.linalg.norm(np.asarray(places["propeller"]) - shaft) < 6 * session.selected.evaluation.propeller.diameter
    press(page, "switch", "spin")
    frame = client.scene.get_handle_by_name("/ship/propeller")
    before = np.array(frame.wxyz)
    wait_until(lambda: not np.allclose(frame.wxyz, before), 20, "a turn")
    press(page, "switch", "spin")
    wait_until(lambda: not session.options.spin, 20, "the standstill")
    # the initial design is no ghost of itself
    press(page, "choose", "compromise")
    wait_until(lambda: session.selected.kind == "run", 20, "the compromise")
    press(page, "switch", "ghost")
    wait_until(lambda: client.scene.get_handle_by_name("/ghost") is not None, 60, "the ghost")
    press(page, "switch", "ghost")


def test_the_selected_design_downloads_as_cad(page, session):
    press(page, "choose", "compromise")
    wait_until(lambda: session.selected.kind == "run", 20, "the compromise")
    with page.expect_download(timeout=90_000) as waiting:
        press(page, "take_away")
    assert waiting.value.suggested_filename == f"hpsop-{session.selected.design_id}.zip"
    archive = zipfile.ZipFile(waiting.value.path())
    names = set(archive.namelist())
    assert {"design.3dm", "lines.dxf", "hull.stl", "propeller.stl", "design.glb", "offsets.csv", "README.txt"} <= names
    numbers = json.loads(archive.read("design.json"))
    assert numbers["variables"] == session.selected.evaluation.variables.as_dict()
    assert f"design {session.selected.design_id}" in archive.read("README.txt").decode()


def test_waves_have_a_legend_in_metres(page, session, explorer):
    press(page, "switch", "waves")
    page.wait_for_selector('.hpsop-overlay-card:has-text("wave elevation ζ [m]")')
    client = explorer.server.get_clients()[session.client_id]
    wait_until(lambda: client.scene.get_handle_by_name("/waves") is not None, 30, "the wave mesh")
    # in a low window a scale takes the place of all but the first numbers, not of the ship
    assert page.locator(".hpsop-overlay-card [data-headline]:visible").count() == 2
    press(page, "switch", "waves")
    wait_until(lambda: "waves" not in session.legends, 20, "the waves to go")


def test_bounds_and_refused_values(page, session, explorer):
    draft = explorer.state.draft
    low, high = draft.value("bounds", "draft")
    settings = explorer.settings
    # what a slider cannot send, a hostile browser can: each is refused and the draft stays
    for bad in ((15.0, 14.0), (math.nan, 14.5), (14.0, math.inf), (1.0, 99.0), "x", (14.0,), None):
        with pytest.raises(InputError):
            settings.set_bounds("draft", bad)
    with pytest.raises(InputError):
        settings.set_bounds("blade_count", (3.5, 5.0))
    with pytest.raises(InputError):
        settings.set_field("optimization", "population", math.nan)
    assert draft.value("bounds", "draft") == (low, high)
    settings.set_bounds("draft", (14.1, 14.4))
    page.wait_for_function("() => [...document.querySelectorAll('input')].some(box => box.value.startsWith('14.1'))")
    settings.set_bounds("draft", (low, high))


def test_charts_of_the_run_are_chosen_moved_and_read(page, session):
    choose_tab(page, "Charts")
    press(page, "tab", "scatter")
    page.wait_for_selector("svg[data-chart=scatter] path.mark.level1")
    page.select_option("select[data-arg=y]", "f2")
    wait_until(lambda: session.charts.y == "f2", 20, "the axis chosen")
    page.wait_for_selector('svg[data-chart=scatter][aria-label^="f₂"]')
    mark = page.locator("svg[data-chart=scatter] path.mark.level1").last
    mark.scroll_into_view_if_needed()
    box = mark.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    front = session.picture.generations[-1].front
    wait_until(lambda: session.selected.design_id in front, 20, "a design of the scatter chart")
    press(page, "tab", "families")
    page.locator("button.family").first.wait_for()
    # an axis is dragged by its name
    press(page, "tab", "parallel")
    page.locator("svg[data-chart=parallel]").scroll_into_view_if_needed()
    x, y = chart_point(page, 0.0, 1.0, "parallel")
    page.mouse.move(x, y - 34)
    page.mouse.down()
    page.mouse.move(x + 140, y - 34, steps=4)
    page.mouse.up()
    wait_until(lambda: session.charts.axes, 20, "another order of the axes")
    assert session.charts.axes[0] == "breadth_to_draft"
    page.wait_for_function("() => document.querySelector('[data-axis]').dataset.axis === 'breadth_to_draft'")
    # or stepped by the arrow keys, which stay with it
    page.locator("[data-axis=length_to_breadth]").focus()
    place = session.charts.axes.index("length_to_breadth")
    page.keyboard.press("ArrowRight")
    wait_until(lambda: session.charts.axes.index("length_to_breadth") == place + 1, 20, "an axis a place on")
    page.wait_for_function("() => document.activeElement.dataset.axis === 'length_to_breadth'")
    page.keyboard.press("ArrowLeft")
    wait_until(lambda: session.charts.axes.index("length_to_breadth") == place, 20, "the axis back")
    # a chart is read at the pointer, and the one over the same quantity with it
    press(page, "tab", "convergence")
    page.locator("svg[data-chart=convergence]").scroll_into_view_if_needed()
    page.mouse.move(*chart_point(page, 0.5, 0.5, "convergence"))
    page.wait_for_function("() => document.querySelector('.hpsop-reading').innerText.includes('hypervolume')")
    assert "least objective" in page.locator(".hpsop-reading").inner_text()
    page.mouse.move(5, 5)
    page.wait_for_function("() => document.querySelector('.hpsop-reading').style.display === 'none'")


def test_steps_are_taken_back_and_a_link_opens_the_same(page, session, explorer):
    draft = explorer.state.draft
    before = draft.value("bounds", "length_to_breadth")
    # the keyboard reaches the slider's thumb, and steps it
    thumb = page.locator('.multi-slider-thumb[data-bound="length_to_breadth.lower"]')
    thumb.focus()
    page.keyboard.press("PageUp")
    wait_until(lambda: draft.value("bounds", "length_to_breadth") != before, 20, "another bound")
    moved = draft.value("bounds", "length_to_breadth")
    press(page, "undo")
    wait_until(lambda: draft.value("bounds", "length_to_breadth") == before, 20, "the bound as it was")
    page.keyboard.press("Control+Shift+Z")
    wait_until(lambda: draft.value("bounds", "length_to_breadth") == moved, 20, "the bound made again")
    page.keyboard.press("Control+z")
    wait_until(lambda: draft.value("bounds", "length_to_breadth") == before, 20, "the bound as it was, by a key")
    choose_tab(page, "What-if")
    first = session.selected
    drag_slider(page, "L/B", 0.3)
    wait_until(lambda: session.selected.kind == "whatif", 30, "a what-if")
    press(page, "whatif_turn", "back")
    wait_until(lambda: session.selected.key == first.key, 20, "the design before it")
    press(page, "whatif_turn", "again")
    wait_until(lambda: session.selected.kind == "whatif", 20, "the what-if again")
    # the keys mean the what-if while one is at work there, and leave the settings alone
    page.keyboard.press("Control+z")
    wait_until(lambda: session.selected.key == first.key, 20, "the design before it, by a key")
    page.keyboard.press("Control+y")
    wait_until(lambda: session.selected.kind == "whatif", 20, "the what-if again, by a key")
    assert draft.value("bounds", "length_to_breadth") == before
    wanted = session.selected.key
    # by the keyboard: what was pressed keeps the focus though it is drawn anew, and takes the next key
    turned = session.options.topsides
    page.locator('[data-act="switch"][data-arg="topsides"]').focus()
    for wanted_now in (not turned, turned):
        # drawn anew: pressed as it was before, or as the press before this one made it
        page.wait_for_function(
            "on => { const at = document.activeElement;"
            " return at.dataset.arg === 'topsides' && at.getAttribute('aria-pressed') === on; }",
            arg=str(not wanted_now).lower(),
        )
        page.keyboard.press("Enter")
        wait_until(lambda wanted_now=wanted_now: session.options.topsides == wanted_now, 20, "the topsides")
    press(page, "camera", "plan")
    press(page, "link")
    address = page.locator(".hpsop-link input").input_value()
    page.keyboard.press("Escape")
    assert page.evaluate("document.activeElement.dataset.act") == "link"
    assert "token" not in address and address.startswith(explorer.address.partition("?")[0])
    other = page.context.new_page()
    other.goto(address)
    wait_until(
        lambda: (
            (fresh := session_of(explorer, -1)) is not session
            and fresh.selected is not None
            and (fresh.selected.key, fresh.options.camera) == (wanted, "plan")
        ),
        60,
        "the same in another window",
    )
    # followed once: a reload comes back to where this window is then
    other.wait_for_function("() => location.search === ''")
    other.close()
    press(page, "camera", "perspective")
    choose_tab(page, "Design")


def test_a_view_that_fails_says_so_and_goes_on(page, session, explorer, monkeypatch):
    choose_tab(page, "Design")
    first = explorer.services.designs.first()
    session.select(first)
    page.wait_for_selector('[data-selected="initial"]')

    def broken(*_arguments):
        raise ValueError("no table")

    monkeypatch.setattr("explorer.views.design_view.comparison_table", broken)
    session.select(explorer.services.designs.shown(session.picture.generations[-1].front[0]))
    page.wait_for_selector('[data-failed]:has-text("no table")')
    # what stood there is not shown as what stands now
    assert page.locator("[data-selected]").count() == 0
    monkeypatch.undo()
    session.select(first)
    page.wait_for_selector('[data-selected="initial"]')
    assert page.locator("[data-failed]").count() == 0


def test_reload_comes_back(page, session, explorer):
    choose_tab(page, "Design")
    press(page, "choose", "compromise")
    wait_until(lambda: session.selected.kind == "run", 20, "the compromise")
    wanted, pins = session.selected.design_id, len(session.pins)
    page.reload()
    page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
    page.wait_for_selector(f'[data-selected="{wanted}"]', state="attached")
    fresh = session_of(explorer)
    assert fresh is not session
    assert fresh.selected.design_id == wanted
    # a run opens at its compromise anyway; what else the browser had comes with its first word
    wait_until(lambda: len(fresh.pins) == pins, 20, "the pins")
    assert np.isfinite(fresh.selected.evaluation.objectives["f1"])


def test_a_tab_chosen_right_after_a_load_stays(page):
    choose_tab(page, "Design")
    page.wait_for_function("() => Object.values({...sessionStorage, ...localStorage}).includes('Design')")
    # what is chosen now is kept nowhere: as where the page looks what was open before a press has been kept
    page.add_init_script("if (!window.name) Storage.prototype.setItem = () => {}")
    page.reload()
    page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
    table = page.get_by_role("tab", name="Table", exact=True).first
    table.click()
    # the page looks last a second and a half after it stands
    page.wait_for_timeout(2500)
    assert table.get_attribute("aria-selected") == "true"
    page.evaluate("window.name = 'again'")
    page.reload()
    page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
    page.wait_for_selector("[data-selected]", state="attached")


def test_the_table_sorts_selects_filters_and_saves(page, session):
    choose_tab(page, "Table")
    press(page, "table_which", "all")
    press(page, "table_sort", "length")
    wait_until(lambda: session.table.sort == "length" and session.table.which == "all", 20, "the order")
    # after a generation of eight designs and more: the second row by length
    order = session.picture.ids[np.lexsort((session.picture.ids, session.picture.column("length")))]
    wanted = [int(number) for number in order if session.picture.row(number) is not None][1]
    row = page.locator(f'tr[data-design="{wanted}"]')
    row.wait_for()
    row.locator("td").nth(4).click(force=True)
    wait_until(lambda: session.selected.design_id == wanted, 20, "the row's design")
    page.locator(f'tr[data-design="{wanted}"].on').wait_for()
    # the keyboard reaches star and number
    star = row.locator("button.star")
    star.focus()
    page.keyboard.press("Enter")
    wait_until(lambda: session.stars == {wanted}, 20, "the star")
    press(page, "table_which", "starred")
    page.wait_for_function("() => document.querySelectorAll('tr[data-design]').length === 1")
    with page.expect_download() as caught:
        press(page, "table_csv")
    with open(caught.value.path(), encoding="utf-8") as file:
        lines = file.read().splitlines()
    assert lines[0].startswith("design,level,generation,feasible,star,")
    assert len(lines) == 2 and lines[1].startswith(f"{wanted},1,")
    # a condition in words narrows the table and fades the charts
    press(page, "table_which", "all")
    field = page.locator('label:text-is("Only")').locator("xpath=ancestor::*[.//input][1]//input")
    field.fill("f1 < 0, f2 > 9")
    wait_until(lambda: set(session.filters) == {"f1", "f2"}, 20, "the filter")
    page.get_by_text("No design keeps every condition above").wait_for()
    press(page, "table_unfilter", "f1")
    wait_until(lambda: not set(session.filters) & {"f1"}, 20, "the condition to go")
    session.clear_filters()
    choose_tab(page, "Design")


def test_charts_are_saved_as_drawing_picture_and_numbers(page, session):
    choose_tab(page, "Charts")
    press(page, "tab", "open_water")
    page.locator("svg[data-chart=open_water]").wait_for()
    for chart in ("pareto", "open_water"):
        for kind, start in (("svg", b"<?xml"), ("png", b"\x89PNG"), ("csv", b"")):
            with page.expect_download() as caught:
                press(page, "chart_save", f"{chart} {kind}")
            with open(caught.value.path(), "rb") as file:
                data = file.read()
            assert caught.value.suggested_filename.endswith(f"{chart.replace('_', '-')}.{kind}")
            assert data.startswith(start) and len(data) > 200, (chart, kind)
            if kind == "png":
                image = Image.open(caught.value.path())
                assert image.width >= 3 * 0.9 * session.chart_width and len(image.convert("L").getcolors()) > 20
    choose_tab(page, "Design")
