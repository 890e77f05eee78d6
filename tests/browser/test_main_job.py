"""The main job with a real mouse: Start, three generations, a click on the front, and that very design stands there."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import front_marks, press, session_of, wait_until

from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.hull.mesh import hull_view_parts


# Fails on the page as it is since the recommended case changed, not yet understood: see CHANGELOG, Known faults.
@pytest.mark.soak
def test_start_three_generations_click_a_front_point(explorer, open_page):
    page = open_page(explorer)
    session = session_of(explorer)
    # before any run: the initial design in table and scene
    client = explorer.server.get_clients()[session.client_id]
    wait_until(lambda: client.scene.get_handle_by_name("/ship/underwater"), 60, "the initial hull")
    assert session.selected.kind == "initial"
    assert page.locator("[data-run-status]").first.get_attribute("data-run-status") == "idle"

    press(page, "run_start")
    wait_until(lambda: len(explorer.state.picture.generations) >= 3, 90, "three generations")
    page.wait_for_function("() => +document.querySelector('[data-run-status]').dataset.generation >= 3")
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the run to stop")
    page.wait_for_selector('[data-run-status="stopped"]')

    marks = front_marks(page)
    x, y = marks[0]
    front = set(explorer.state.picture.generations[-1].front)
    page.mouse.click(x, y)
    # the picked design is the one drawn under the pointer: the front's least f1 stands first
    order = explorer.state.picture.rows(tuple(front))
    f1 = explorer.state.picture.objectives[order, 0]
    wait_until(lambda: session.selected.evaluation.objectives["f1"] == f1.min(), 30, "the front's first mark")
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
    wanted = hull_view_parts(hull, "view")["underwater"][0].astype(np.float32)

    def stands() -> bool:
        handle = client.scene.get_handle_by_name("/ship/underwater")
        return handle.vertices.shape == wanted.shape and bool(np.array_equal(handle.vertices, wanted))

    wait_until(stands, 30, "the selected hull in the scene")
    shaft = client.scene.get_handle_by_name("/ship/propeller").position
    assert abs(shaft[2] - hull.shaft_height) < 1e-6
    blades = client.scene.get_handle_by_name("/ship/propeller/blades").vertices
    radius = np.hypot(blades[:, 1], blades[:, 2]).max()
    # the blade's tip section ends just inside the tip circle
    assert abs(radius - design_propeller(case, evaluation.variables).diameter / 2) < 0.01 * radius

    # curves: the open-water chart names this design and marks its own operating points
    page.get_by_role("tab", name="Charts", exact=True).click()
    page.wait_for_selector('[data-chart-tab="open_water"] svg')
    titles = " ".join(page.locator('svg[data-chart="open_water"] title').all_text_contents())
    assert f"Design {design_id}: J₁ {evaluation.conditions[0].advance_coefficient:.4f}" in titles
    assert "KT, initial" in titles


# Fails on the page as it is since the recommended case changed, not yet understood: see CHANGELOG, Known faults.
@pytest.mark.soak
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
