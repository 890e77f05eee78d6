"""A case of a 6 m towing-tank model is set by the same sliders, with a real mouse and real keys."""

from __future__ import annotations

import re

import pytest
from conftest import choose_tab, session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port
from hpsop_core.case.case import Case


def model() -> Case:
    case = small_case().replaced("initial", length=6.0, breadth=0.86, draft=0.25, diameter=0.15)
    return case.with_bounds({"draft": (0.2412, 0.25), "diameter": (0.1417, 0.1583)})


@pytest.fixture(scope="module")
def explorer(tmp_path_factory):
    page = Explorer(model(), port=free_port("127.0.0.1", 8390), folder=tmp_path_factory.mktemp("runs"), workers=1)
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer, open_page):
    return open_page(explorer)


def thumbs(page, label: str) -> list[tuple[float, float]]:
    """The middles of the visible thumbs on the line of a slider's own label, from the left."""
    # what stands on its bound says so behind its name
    named = re.compile(f"^{re.escape(label)}( [↓↑])?$")
    box = page.locator("label:visible").get_by_text(named).last.bounding_box()
    found = page.evaluate(
        """([x, y]) => [...document.querySelectorAll('.multi-slider-thumb, .mantine-Slider-thumb, [class*=thumb]')]
            .map(e => e.getBoundingClientRect())
            .map(r => [r.x + r.width / 2, r.y + r.height / 2, r.width])
            .filter(([u, v, w]) => w > 2 && Math.abs(v - y) < 16 && u > x && u - x < 330)""",
        [box["x"], box["y"] + box["height"] / 2],
    )
    return sorted((float(x), float(y)) for x, y, _ in found)


def test_a_bound_of_the_draft_is_dragged_by_millimetres(page, explorer):
    slider = explorer.settings._sliders["draft"]
    assert (slider.min, slider.max, slider.step) == (0.19, 0.293, 0.0001)
    boxes = page.locator('[data-variable="draft"] input')
    assert [box.input_value() for box in boxes.all()] == ["0.2412", "0.2500"]
    *_, (x, y) = thumbs(page, "d [m]")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 12, y, steps=6)
    page.mouse.up()
    draft = explorer.state.draft
    # The moves of one drag arrive one by one: the last one's bound is waited for, a dozen pixels of a track of 100 to
    # 300 pixels over 103 mm.
    wait_until(lambda: 0.253 < draft.value("bounds", "draft")[1] < 0.264, 20, "the moved bound")
    wait_until(lambda: boxes.nth(1).input_value() == f"{draft.value('bounds', 'draft')[1]:.4f}", 20, "the readout")
    low, high = draft.value("bounds", "draft")
    assert low == 0.2412
    assert high * 1e4 == pytest.approx(round(high * 1e4), abs=1e-6)


def test_what_if_answers_for_the_model_in_tenths_of_a_millimetre(page, explorer):
    session = session_of(explorer)
    choose_tab(page, "What-if")
    # until the tab is laid out the label found is that of the bounds, with two thumbs
    wait_until(lambda: len(thumbs(page, "d [m]")) == 1, 20, "the what-if's slider")
    ((x, y),) = thumbs(page, "d [m]")
    page.mouse.click(x + 9, y)
    wait_until(lambda: session.selected.kind == "whatif", 30, "a what-if design")
    first = session.selected.evaluation
    assert first.status == "ok"
    assert 0.25 < first.variables.draft < 0.262
    assert first.variables.diameter == 0.15
    page.keyboard.press("ArrowRight")
    wait_until(lambda: session.selected.evaluation.variables.draft != first.variables.draft, 20, "the next step")
    step = session.selected.evaluation.variables.draft - first.variables.draft
    assert step == pytest.approx(1e-4, abs=1e-9)
