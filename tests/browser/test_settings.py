"""The settings with a real mouse and keyboard; the saved case gives `hpsop optimize` the page's very result."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import choose_tab, press, session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port
from hpsop_core.case.case import load_case


@pytest.fixture(scope="module")
def explorer(tmp_path_factory):
    page = Explorer(
        small_case(generations=3, level1_generations=3),
        port=free_port("127.0.0.1", 8360),
        folder=tmp_path_factory.mktemp("runs"),
        workers=2,
    )
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer, open_page):
    return open_page(explorer)


@pytest.fixture
def draft(explorer):
    return explorer.state.draft


def field(page, explorer, section: str, name: str):
    """The input element of a field of the case."""
    uuid = explorer.settings._widgets[(section, name)]._impl.uuid
    return page.locator(f'label[for="{uuid}"]').locator("xpath=ancestor::*[.//input][1]//input")


def replace_text(page, element, text: str) -> None:
    """Select all and type, key by key."""
    element.click()
    page.keyboard.press("Control+a")
    page.keyboard.type(text, delay=90)


def test_typing_a_number_digit_by_digit(page, explorer, draft):
    population = field(page, explorer, "optimization", "population")
    replace_text(page, population, "12")
    wait_until(lambda: draft.value("optimization", "population") == 12, 20, "population 12")
    assert population.input_value() == "12"
    replace_text(page, population, "8")
    wait_until(lambda: draft.value("optimization", "population") == 8, 20, "population 8")
    replace_text(page, field(page, explorer, "optimization", "seed"), "7")
    wait_until(lambda: draft.value("optimization", "seed") == 7, 20, "seed 7")
    # a changed setting is marked, and its own button takes it back
    page.wait_for_selector('label:has-text("Seed ●")')
    press(page, "reset_field", "optimization.seed")
    wait_until(lambda: draft.value("optimization", "seed") == 1, 20, "the seed of the case")
    page.wait_for_selector('label:has-text("Seed ●")', state="detached")
    replace_text(page, field(page, explorer, "optimization", "seed"), "7")
    wait_until(lambda: draft.value("optimization", "seed") == 7, 20, "seed 7 again")


@pytest.fixture
def told(explorer, page):
    """What the page's notifications said meanwhile."""
    session, heard = session_of(explorer), []
    notify, session.notify = session.notify, lambda title, body, color: heard.append(body)
    yield heard
    session.notify = notify


def test_a_refused_number_is_told_and_taken_back(page, explorer, draft, told):
    population = field(page, explorer, "optimization", "population")
    replace_text(page, population, "2")
    # while it stands there the page says what is wrong; when the typing has rested it is taken back
    page.wait_for_selector('p.bad:visible:has-text("population")')
    wait_until(lambda: told, 20, "a notification")
    assert "Population: 2 is outside its limits" in told[0]
    wait_until(lambda: population.input_value() == "8", 20, "the old value")
    page.wait_for_selector('p.bad:visible:has-text("population")', state="detached")
    assert draft.value("optimization", "population") == 8


def test_settings_that_make_no_case_do_not_start(page, explorer, draft, told):
    choose_tab(page, "Case")
    weights = field(page, explorer, "conditions", "weights")
    replace_text(page, weights, "0.65, 0.3")
    wait_until(lambda: draft.value("conditions", "weights") == (0.65, 0.3), 20, "the weights")
    page.wait_for_selector('p.bad:visible:has-text("Shares of time sum to 0.95")')
    press(page, "run_start")
    wait_until(lambda: told, 20, "a notification")
    assert "Shares of time sum to 0.95; they must sum to 1" in told[0]
    assert explorer.state.picture.status == "idle"
    assert not list(explorer.folder.glob("*.hpsop"))
    replace_text(page, weights, "0.6, 0.4")
    wait_until(lambda: draft.value("conditions", "weights") == (0.6, 0.4), 20, "the weights")
    page.wait_for_selector('p.bad:visible:has-text("Shares of time sum")', state="detached")
    choose_tab(page, "Design space")


def test_a_thumb_is_dragged_and_the_readout_follows(page, explorer, draft):
    slider = explorer.settings._sliders["length_to_breadth"]
    box = page.locator('[data-variable="length_to_breadth"]').bounding_box()
    thumbs = page.evaluate(
        """(y) => [...document.querySelectorAll('.multi-slider-thumb, .mantine-Slider-thumb, [class*=thumb]')]
            .map(e => e.getBoundingClientRect())
            .filter(r => r.width > 2 && r.x < 400 && y - (r.y + r.height / 2) > 0 && y - (r.y + r.height / 2) < 45)
            .map(r => [r.x + r.width / 2, r.y + r.height / 2])""",
        box["y"] + box["height"] / 2,
    )
    assert len(thumbs) >= 2, "the two thumbs of L/B"
    (x, y), *_ = sorted(thumbs)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 25, y, steps=6)
    page.mouse.up()
    wait_until(lambda: draft.changed("bounds", "length_to_breadth"), 20, "the moved bound")
    boxes = page.locator('[data-variable="length_to_breadth"] input')

    def agrees() -> bool:
        low, high = draft.value("bounds", "length_to_breadth")
        shown = tuple(float(box.input_value()) for box in boxes.all())
        return slider.value == pytest.approx((low, high)) and shown == (low, high)

    wait_until(agrees, 20, "the readout")
    # a drag is told in steps, and the last of them is a change like any other: what follows must not come before it
    told = [draft.value("bounds", "length_to_breadth"), time.monotonic()]

    def rests() -> bool:
        now = draft.value("bounds", "length_to_breadth")
        if now != told[0]:
            told[:] = now, time.monotonic()
        return time.monotonic() - told[1] > 1.0

    wait_until(rests, 20, "the end of the drag")
    low, high = draft.value("bounds", "length_to_breadth")
    assert 6.5 < low < high == 8.5


def test_what_is_shown_is_of_the_case_as_it_is_set_up_now(page, explorer, draft):
    session = session_of(explorer)
    before = session.selected
    assert before.kind == "initial" and "breadth_to_draft" not in before.evaluation.active_bounds
    page.wait_for_selector("[data-standing]", state="attached")
    # a bound that reaches the initial design: it stands on it at once
    own = before.evaluation.variables.breadth_to_draft
    standing = '[data-standing]:has-text("B/d on its lower bound")'
    explorer.settings.set_bounds("breadth_to_draft", (own, 4.5))
    page.wait_for_selector(standing)
    choose_tab(page, "What-if")
    page.locator("label:visible").get_by_text("B/d ↓", exact=True).wait_for()
    choose_tab(page, "Design")
    press(page, "undo")
    page.wait_for_selector(standing, state="detached")
    # other speeds: its numbers are solved anew
    froude = session.selected.evaluation.conditions[0].froude_number
    explorer.settings.set_field("conditions", "froude_numbers", "0.2, 0.27")
    wait_until(lambda: session.selected.evaluation.conditions[0].froude_number < froude, 20, "the initial at Fn 0.2")
    press(page, "undo")
    wait_until(lambda: session.selected.evaluation.conditions[0].froude_number == froude, 20, "the speeds as before")


def test_a_bound_is_stepped_by_the_arrow_keys_and_a_wrong_one_goes_back(page, explorer, draft, told):
    low, high = draft.value("bounds", "breadth_to_draft")
    box = page.locator('[data-variable="breadth_to_draft"] input').first
    assert "lower bound" in box.get_attribute("aria-label")
    box.focus()
    page.keyboard.press("ArrowUp")
    wait_until(lambda: draft.value("bounds", "breadth_to_draft")[0] > low, 20, "the moved bound")
    stepped = draft.value("bounds", "breadth_to_draft")[0]
    wait_until(lambda: explorer.settings._sliders["breadth_to_draft"].value == (stepped, high), 20, "the slider")
    # the answer draws the box anew, and whoever steps stays in it
    focused = "document.activeElement.dataset.arg"
    wait_until(lambda: page.evaluate(focused) == "breadth_to_draft.lower", 20, "the focus")
    box.fill(str(high + 1.0))
    page.keyboard.press("Tab")
    wait_until(lambda: told, 20, "a notification")
    assert "the lower bound cannot lie above the upper one" in told[0]
    assert draft.value("bounds", "breadth_to_draft") == (stepped, high)
    wait_until(lambda: float(box.input_value()) == stepped, 20, "the old number")
    press(page, "reset_field", "bounds.breadth_to_draft")
    wait_until(lambda: not draft.changed("bounds", "breadth_to_draft"), 20, "the preset's bound")


def _front(explorer) -> list:
    """Evaluations of the newest front."""
    designs = explorer.services.designs
    return [designs.shown(number).evaluation for number in explorer.state.picture.generations[-1].front]


def test_the_saved_case_gives_the_same_front(page, explorer, draft, tmp_path):
    """TOML from the page, run by the command with another number of workers: the same bits."""
    # the TOML must carry what was set on the page, also numbers with many digits
    assert draft.count() >= 2
    choose_tab(page, "Case")
    # another question, asked with the mouse: power against displacement, of ships no longer than 370 m
    for name, words in (("first", "delivered_power"), ("second", "displacement")):
        page.locator(f'[id="{explorer.settings._widgets[("objectives", name)]._impl.uuid}"]').click()
        page.get_by_role("option", name=words, exact=True).click()
        wait_until(
            lambda name=name, words=words: draft.value("objectives", name) == words, 20, f"the objective {words}"
        )
    page.get_by_text("Constraints", exact=True).first.click()
    replace_text(page, field(page, explorer, "constraints", "greatest_length"), "370")
    wait_until(lambda: draft.value("constraints", "greatest_length") == 370.0, 20, "the greatest length")
    page.get_by_text("Constraints", exact=True).first.click()
    page.wait_for_selector('svg[data-chart=pareto]:has-text("f₁ = delivered power")')
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save this case as TOML").click()
    saved = tmp_path / "saved.toml"
    waiting.value.save_as(saved)
    assert load_case(saved) == draft.case()
    choose_tab(page, "Design space")
    press(page, "follow_best")
    press(page, "run_start")
    wait_until(lambda: explorer.state.picture.status == "finished", 90, "the run of three generations")
    # what is followed is the newest compromise, in the numbers and in the chart
    best = explorer.state.picture.compromise
    page.wait_for_selector(f'[data-selected="{best}"]', state="attached")
    page.locator("[data-headline]").get_by_text("delivered power").first.wait_for()
    assert all(shown.hull.length <= 370.0 + 1e-6 for shown in _front(explorer))
    press(page, "follow_best")
    (mine,) = explorer.folder.glob("*.hpsop")
    theirs = tmp_path / "command.hpsop"
    command = Path(sys.executable).with_name("hpsop")
    subprocess.run([command, "optimize", saved, "--run", theirs, "--workers", "1"], check=True, capture_output=True)

    def front(path: Path) -> list[dict]:
        shown = subprocess.run([command, "show", path, "--front", "--json"], check=False, capture_output=True)
        assert shown.returncode == 0, shown.stderr.decode()
        return json.loads(shown.stdout)["designs"]

    assert front(mine) == front(theirs)
    assert len(front(mine)) >= 1


def test_a_preset_is_chosen_and_its_two_lines_stand(page, explorer, draft):
    wanted = load_case("dtc-p4119-paper")
    element = page.locator(f'[id="{explorer.settings._preset._impl.uuid}"]')
    element.click()
    page.get_by_role("option", name="dtc-p4119-paper", exact=True).click()
    wait_until(lambda: draft.base.name == "dtc-p4119-paper", 20, "the paper's case")
    assert draft.count() == 0
    first, second = wanted.description.strip().splitlines()[:2]
    page.wait_for_selector(f"text={first[:40]}")
    page.wait_for_selector(f"text={second[:40]}")
    # the widgets show the preset's own values
    assert field(page, explorer, "optimization", "population").input_value() == str(wanted.optimization.population)
    low, high = wanted.bounds.as_dict()["draft"]
    shown = page.locator('[data-variable="draft"] input')
    assert [float(box.input_value()) for box in shown.all()] == [low, high]
    # what is shown is the case that was asked for; the run waits in Runs, with its settings
    wait_until(lambda: explorer.state.picture.name == "", 20, "the run to be put away")
    assert explorer.state.picture.case == wanted
    page.wait_for_selector('[data-selected="initial"]', state="attached")
    choose_tab(page, "Runs")
    page.wait_for_selector('[data-act="open_run"]:text-is("open")')
    assert page.locator('[data-act="open_run"]:text-is("shown")').count() == 0
    press(page, "open_run")
    wait_until(lambda: explorer.state.picture.name != "", 20, "the run")
    press(page, "adopt")
    wait_until(lambda: draft.value("optimization", "seed") == 7, 20, "the settings of the shown run")
    assert draft.case() == explorer.state.picture.case
    choose_tab(page, "Design space")


def test_a_fixed_variable_says_so(page, explorer, draft):
    explorer.settings.set_bounds("draft", (14.2, 14.2))
    page.wait_for_selector('[data-variable="draft"]:has-text("fixed")')
    assert [float(box.input_value()) for box in page.locator('[data-variable="draft"] input').all()] == [14.2, 14.2]
    page.get_by_role("button", name="Reset changes to the preset").click()
    wait_until(lambda: not draft.changed("bounds", "draft"), 20, "the reset")
    wait_until(lambda: draft.count() == 0, 20, "all changes to be taken back")
