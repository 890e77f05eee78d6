"""The main job with a real mouse: Start, three generations, a click on the front, and that very design stands there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from conftest import front_marks, press, session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.hull.mesh import hull_view_parts


@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    """A search that does not end by itself before somebody has looked at three of its generations and pressed Stop."""
    case = small_case(generations=5000, level1_generations=5000)
    page = Explorer(case, port=free_port("127.0.0.1", 8350), folder=tmp_path_factory.mktemp("runs"), workers=2)
    yield page
    page.close()


def marks_at_rest(page) -> list[tuple[float, float]]:
    """The front's points once the chart has come to rest after a run's last news."""
    marks = front_marks(page)
    for _ in range(100):
        page.wait_for_timeout(500)
        before, marks = marks, front_marks(page)
        if marks and marks == before:
            return marks
    raise AssertionError("the chart does not come to rest")


def at(page, f1: float, f2: float) -> tuple[float, float]:
    """Where two objectives stand on the screen, by the chart's own box and limits."""
    chart = page.locator("svg[data-chart=pareto]")
    left, top, width, height = map(float, chart.get_attribute("data-plot").split(","))
    least, most, low, high = map(float, chart.get_attribute("data-limits").split(","))
    x, y = left + width * (f1 - least) / (most - least), top + height * (high - f2) / (high - low)
    return tuple(
        chart.evaluate(
            "(svg, [x, y]) => { const p = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM()); return [p.x, p.y]; }",
            [x, y],
        )
    )


def test_start_three_generations_click_a_front_point(explorer, open_page):
    page = open_page(explorer, drawn=True)
    session = session_of(explorer)
    # before any run: the initial design in table and scene
    client = explorer.server.get_clients()[session.client_id]
    wait_until(lambda: client.scene.get_handle_by_name("/ship/underwater"), 60, "the initial hull")
    assert session.selected.kind == "initial"
    assert page.locator("[data-run-status]").first.get_attribute("data-run-status") == "idle"

    press(page, "run_start")

    def enough() -> bool:
        generations = explorer.state.picture.generations
        return len(generations) >= 3 and len(generations[-1].front) >= 2

    wait_until(enough, 90, "three generations and a front to choose from")
    page.wait_for_function("() => +document.querySelector('[data-run-status]').dataset.generation >= 3")
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the run to stop")
    page.wait_for_selector('[data-run-status="stopped"]')

    front = set(explorer.state.picture.generations[-1].front)
    x, y = min(marks_at_rest(page))
    shown = session.selected
    # what is picked already stands under the pointer where it is the front's only mark
    page.mouse.click(x, y)
    wait_until(lambda: session.selected is not shown or session.selected.design_id in front, 30, "the picked design")
    # the picked design is the one drawn under the pointer, or of the family whose mark it is
    picked = session.selected.evaluation.objectives
    assert at(page, picked["f1"], picked["f2"]) == pytest.approx((x, y), abs=5.0)
    page.wait_for_selector(f'[data-selected="{session.selected.design_id}"]', state="attached")
    design_id = int(page.locator("[data-selected]").first.get_attribute("data-selected"))
    assert design_id in front
    assert session.selected.design_id == design_id
    # table
    evaluation = session.selected.evaluation
    row = page.locator('tr[data-quantity="length"]:visible td').all_inner_texts()
    assert row[2] == f"{evaluation.hull.length:.2f}"
    row = page.locator('tr[data-quantity="advance_coefficient_1"] td').all_inner_texts()
    assert row[2] == f"{evaluation.conditions[0].advance_coefficient:.4f}"

    # geometry: the vertices in the scene are those of this design's own hull, the propeller hangs at its own shaft
    case = explorer.state.picture.case
    hull = design_hull(case, evaluation.variables)
    # the whole ship is in view: the mesh for that, not the one for a close look
    wanted = hull_view_parts(hull, "drag")["underwater"][0].astype(np.float32)

    def stands() -> bool:
        handle = client.scene.get_handle_by_name("/ship/underwater")
        return handle.vertices.shape == wanted.shape and bool(np.array_equal(handle.vertices, wanted))

    wait_until(stands, 30, "the selected hull in the scene")
    tip = 0.5 * design_propeller(case, evaluation.variables).diameter

    def hangs() -> bool:
        height = client.scene.get_handle_by_name("/ship/propeller").position[2]
        blades = client.scene.get_handle_by_name("/ship/propeller/blades").vertices
        radius = np.hypot(blades[:, 1], blades[:, 2]).max()
        # the blade's tip section ends just inside the tip circle
        return bool(abs(height - hull.shaft_height) < 1e-6 and abs(radius - tip) < 0.01 * tip)

    # it is put there a moment after the hull
    wait_until(hangs, 30, "its own propeller at its own shaft")

    # curves: the open-water chart names this design and marks its own operating points
    page.get_by_role("tab", name="Charts", exact=True).click()
    page.wait_for_selector('[data-chart-tab="open_water"] svg')
    titles = " ".join(page.locator('svg[data-chart="open_water"] title').all_text_contents())
    assert f"J₁ {evaluation.conditions[0].advance_coefficient:.4f}, η₀" in titles.split(f"Design {design_id}, ", 1)[1]
    assert "KT, initial" in titles


def test_second_browser_has_its_own_selection(explorer, open_page):
    first = session_of(explorer)
    chosen = first.selected.design_id
    assert chosen is not None
    page = open_page(explorer)
    second = session_of(explorer, 1)
    assert second.selected.kind == "initial"
    assert first.selected.design_id == chosen
    # run control is shared: the second browser sees the stopped run, and that two are watching
    assert page.locator("[data-run-status]").first.get_attribute("data-run-status") == "stopped"
    page.wait_for_function("() => document.body.innerText.includes('2 watching')")
    press(page, "choose", "compromise")
    wait_until(lambda: second.selected.design_id == explorer.state.picture.compromise, 20, "the compromise")
    assert first.selected.design_id == chosen
