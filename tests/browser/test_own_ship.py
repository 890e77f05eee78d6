"""A ship of the user's own: from a table and from a mesh to a finished run and its CAD files, by mouse and keyboard."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import PATIENCE, choose_tab, new_context, press, session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port
from explorer.services.reading import hull_file
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.mesh import hull_mesh
from hpsop_core.runs.reader import open_run

HULLS = Path(__file__).resolve().parents[1] / "data" / "hulls"
SERIES_60 = HULLS / "s60_cb060.csv"


@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    page = Explorer(small_case(), port=free_port("127.0.0.1", 8460), folder=tmp_path_factory.mktemp("runs"), workers=2)
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer: Explorer, open_page: Any) -> Any:
    opened = open_page(explorer, 1366, 900)
    opened.set_default_timeout(60_000)
    choose_tab(opened, "Your ship")
    opened.wait_for_selector('button:has-text("Open a hull file")')
    return opened


@pytest.fixture
def told(explorer: Explorer, page: Any) -> Iterator[list[str]]:
    """What the page's notifications said meanwhile."""
    session, heard = session_of(explorer), []
    notify, session.notify = session.notify, lambda title, body, color: heard.append(f"{title}: {body}")
    yield heard
    session.notify = notify


def bring(page: Any, path: Path, which: int = 0) -> None:
    """Choose a file with the page's own button."""
    with page.expect_file_chooser() as chooser:
        page.locator('button:has-text("Open a")').nth(which).click()
    chooser.value.set_files(path)


def length_field(page: Any, label: str) -> Any:
    """The input element beside a label."""
    return page.locator(f'label:visible:has-text("{label}")').locator("xpath=ancestor::*[.//input][1]//input")


def type_length(page: Any, label: str, text: str) -> None:
    """Type into a field of lengths, key by key."""
    length_field(page, label).click()
    page.keyboard.press("Control+a")
    page.keyboard.type(text, delay=60)


def understood(page: Any, explorer: Explorer, what: str = "good") -> None:
    """Wait until the hull is read and the page says so."""
    wait_until(lambda: not explorer.state.ship.reading, 60, "the reading")
    page.wait_for_selector(f"[data-ship-hull={what}]")


def short_search(explorer: Explorer) -> None:
    """A search of seconds; everything else as the ship's case has it."""

    def change(draft: Any) -> None:
        for name, value in {"population": 6, "generations": 3, "level1_generations": 2}.items():
            draft.set("optimization", name, value)

    explorer.state.change_draft(change, whole=True)


def run_to_its_end(page: Any, explorer: Explorer) -> None:
    """Start the search and wait for its end."""
    press(page, "run_start")
    wait_until(lambda: explorer.state.picture.status in ("finished", "failed"), 240, "the run")
    assert explorer.state.picture.status == "finished", explorer.state.picture.message


def make_it_the_case(page: Any, explorer: Explorer, name: str) -> None:
    page.get_by_role("button", name="Make it the case").click()
    wait_until(lambda: explorer.state.draft.base.name == name, 90, "the case")
    length = explorer.state.draft.base.initial.length
    wait_until(lambda: explorer.state.picture.case.initial.length == length, 60, "the case on display")
    session = session_of(explorer)
    initial = explorer.state.draft.base.initial.variables
    wait_until(lambda: session.selected and session.selected.evaluation.variables == initial, 90, "its initial design")
    assert session.selected.evaluation.ok
    page.wait_for_selector(f'.hpsop-overlay-card:has-text("{length:.1f}")')


def test_a_table_is_put_right_with_the_picture_following(page: Any, explorer: Explorer) -> None:
    bring(page, SERIES_60)
    # fractions of B/2 and of the draft, and nothing says how long the ship is
    understood(page, explorer, "bad")
    page.wait_for_selector('[data-ship-hull] p.bad:has-text("state the breadth and the draft")')
    assert page.locator("svg[data-chart=ship_body]").count() == 0
    assert page.get_by_role("button", name="Make it the case").is_disabled()
    type_length(page, "Lpp [m]", "121,92")
    understood(page, explorer)
    page.wait_for_selector("svg[data-chart=ship_body]")
    read = explorer.state.ship.read
    assert read is not None
    # L/B 7.5 and B/T 2.5 stand in the file's comment; volume and LCB as Todd gives them: CB 0.600, 1.5 % aft
    assert read.understood.draft == pytest.approx(121.92 / 7.5 / 2.5)
    assert read.understood.block_coefficient == pytest.approx(0.600, abs=0.003)
    assert read.understood.buoyancy_centre_percent == pytest.approx(-1.5, abs=0.1)
    page.wait_for_selector("text=/% of Lpp aft of midship/")
    # said the wrong way round the ship turns, and the page says that its form speaks against it
    plan = page.locator("svg[data-chart=ship_body]").inner_html()
    press(page, "ship_say", "bow +x")
    press(page, "ship_say", "origin ap")
    wait_until(lambda: explorer.state.ship.options.axes.origin == "ap", 20, "the axes")
    understood(page, explorer)
    page.wait_for_selector("text=/% of Lpp forward of midship/")
    page.wait_for_selector('p.bad:has-text("as if its bow were aft")')
    page.wait_for_selector("[data-ship-picture=now] svg[data-chart=ship_body]")
    assert page.locator("svg[data-chart=ship_body]").inner_html() != plan
    press(page, "ship_say", "bow auto")
    press(page, "ship_say", "origin auto")
    page.wait_for_selector("text=/% of Lpp aft of midship/")
    # a smaller draught by the keyboard: the figures follow
    type_length(page, "Draft [m]", "5.2")
    page.wait_for_selector('text="121.92, 16.256, 5.2 m"')
    type_length(page, "Draft [m]", "6.5024")
    page.wait_for_selector('text="121.92, 16.256, 6.5024 m"')


def test_a_length_that_cannot_be_is_told(page: Any, explorer: Explorer, told: list[str]) -> None:
    type_length(page, "Breadth [m]", "wide")
    wait_until(lambda: told, 30, "a notification")
    assert "breadth: 'wide' is no number of metres" in told[0]
    wait_until(lambda: length_field(page, "Breadth [m]").input_value() == "", 20, "the empty field")
    assert explorer.state.ship.options.breadth is None


def test_a_propeller_comes_too(page: Any, explorer: Explorer, tmp_path: Path) -> None:
    radii = [0.18, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0]
    lines = ["r/R; c/D; P/D; t0/c; f0/c"]
    for r in radii:
        chord = 0.12 + 0.45 * (r - 0.1) * (1.0 - r) ** 0.5 * 2.0 if r < 1.0 else 0.0
        row = (r, chord, 0.95, 0.16 - 0.13 * r, 0.02)
        lines.append("; ".join(f"{value:.4f}".replace(".", ",") for value in row))
    table = tmp_path / "own.csv"
    table.write_text("\n".join(lines), encoding="utf-8")
    bring(page, table, 1)
    page.wait_for_selector("[data-ship-propeller=good]")
    page.wait_for_selector("svg[data-chart=ship_blade]")
    press(page, "ship_blades", "5")
    wait_until(lambda: getattr(explorer.state.ship.read_propeller, "blade_count", 0) == 5, 30, "five blades")
    page.wait_for_selector('p.soft:has-text("no column of skew")')


def test_the_table_s_ship_is_optimised_at_both_levels_and_exported(
    page: Any, explorer: Explorer, told: list[str]
) -> None:
    make_it_the_case(page, explorer, "s60-cb060")
    assert any(text.startswith("Set up: s60_cb060.csv") for text in told), told
    assert not any(text.startswith(("Not", "Set up with less")) for text in told), told
    case = explorer.state.draft.case()
    assert case.propeller.geometry_blade_count == case.initial.blade_count == 5
    low, high = case.bounds.as_dict()["draft"]
    assert low < 6.5024 <= high + 1e-6
    assert (case.initial.length, case.initial.draft) == pytest.approx((121.92, 6.5024))
    short_search(explorer)
    run_to_its_end(page, explorer)
    (path,) = explorer.folder.glob("s60-cb060-*.hpsop")
    run = open_run(path)
    assert {record.evaluation.level for record in run.front()} == {2}
    session = session_of(explorer)
    choose_tab(page, "Design")
    press(page, "choose", "compromise")
    choose_tab(page, "Your ship")
    wait_until(lambda: session.selected.kind == "run", 60, "the compromise")
    with page.expect_download(timeout=180_000) as waiting:
        press(page, "take_away")
    archive = zipfile.ZipFile(waiting.value.path())
    assert {"design.3dm", "lines.dxf", "hull.stl", "propeller.stl", "offsets.csv"} <= set(archive.namelist())
    numbers = json.loads(archive.read("design.json"))
    assert numbers["variables"] == session.selected.evaluation.variables.as_dict()
    # the run holds its ship: the kept table may go
    for kept in (explorer.folder / "ships").iterdir():
        kept.unlink()
    assert open_run(path).case.initial == run.case.initial


@pytest.fixture(scope="module")
def mesh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped hull as somebody else's STL: millimetres, x from midship, bow at -x, z from the still water."""
    parent = load_parent_hull("dtc")
    found = hull_mesh(parent.transform(parent.length, parent.breadth, parent.draft), "view").copy()
    found.vertices = (found.vertices - [0.5 * parent.length, 0.0, parent.draft]) * [-1000.0, 1000.0, 1000.0]
    path = tmp_path_factory.mktemp("mesh") / "someone else's.stl"
    path.write_bytes(found.export(file_type="stl"))
    return path


def test_a_mesh_comes_in_and_is_optimised(page: Any, explorer: Explorer, mesh: Path, told: list[str]) -> None:
    press(page, "ship_away", "propeller")
    bring(page, mesh)
    wait_until(lambda: explorer.state.ship.hull.name == mesh.name, 60, "the mesh")
    # what was said of the table is not said of the mesh
    assert explorer.state.ship.options.length is None
    for said in ("unit mm", "bow -x", "origin midship", "waterline z0"):
        press(page, "ship_say", said)
    type_length(page, "Lpp [m]", "355")
    type_length(page, "Draft [m]", "14.5")
    wait_until(lambda: explorer.state.ship.options.draft == 14.5, 30, "the draft")
    understood(page, explorer)
    read = explorer.state.ship.read
    assert read is not None
    hull = load_parent_hull("dtc").hydrostatics
    # what triangles of a view leave of the surface
    assert read.understood.displaced_volume == pytest.approx(hull.displaced_volume, rel=0.005)
    make_it_the_case(page, explorer, "someone-else-s")
    assert not any(text.startswith(("Not", "Set up with less")) for text in told), told
    short_search(explorer)
    run_to_its_end(page, explorer)
    (path,) = explorer.folder.glob("someone-else-s-*.hpsop")
    assert {record.evaluation.level for record in open_run(path).front()} == {2}


def test_a_ship_lies_there_for_every_browser_and_after_a_reload(page: Any, explorer: Explorer, mesh: Path) -> None:
    page.reload()
    page.wait_for_selector("[data-ship-hull=good]")
    assert page.get_by_role("tab", name="Your ship").get_attribute("aria-selected") == "true"
    assert length_field(page, "Lpp [m]").input_value() == "355"


def test_the_command_s_argument_is_brought_in(tmp_path_factory: pytest.TempPathFactory, chromium: Any) -> None:
    """Its tab is the first and stands open."""
    own = Explorer(
        small_case(),
        port=free_port("127.0.0.1", 8480),
        folder=tmp_path_factory.mktemp("runs"),
        workers=1,
        hull=hull_file(str(HULLS / "kvlcc2.csv")),
    )
    context = new_context(chromium, 1366, 900)
    try:
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.goto(own.address)
        page.wait_for_selector('[data-ship-hull=good]:has-text("kvlcc2.csv")')
        page.wait_for_selector("svg[data-chart=ship_body]")
    finally:
        context.close()
        own.close()
