"""Pictures of the page in each of its states: ``python -m tools.pictures.page --to FOLDER``.

It starts the real page in a folder of its own, runs a small real search (or shows a given run), presses the buttons as
a person would, and photographs. It needs Playwright's Python client and Chromium, as the browser tests do.
"""

from __future__ import annotations

import argparse
import io
import sqlite3
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PIL import Image

from explorer.app import Explorer, demonstration
from explorer.server.security import free_port
from explorer.state.run_picture import ACTIVE, FAILED, FINISHED, PAUSED
from hpsop_core.case.case import load_case
from hpsop_core.runs.reader import open_run
from tools.chromium import ARGUMENTS, chromium_program

_HIDE = ".mantine-Notifications-root{display:none!important}"
# A picture larger than this is saved with fewer shades: the repository carries them all.
_LARGEST = 245_000
# what docs/page.md and the README show
_DOCS = frozenset(
    {
        "ready",
        "running",
        "finished",
        "compare",
        "waves",
        "pressure",
        "propeller-pressure",
        "dark",
        "charts",
        "your-ship",
    }
)
_SHIP = Path("tests") / "data" / "hulls" / "s60_cb060.csv"
_SHIP_LENGTH = 121.92
_GAP = 14
_SIZES = {"": (1366, 768), "-large": (1920, 1080)}


class Photographer:
    """One browser page and where its pictures go.

    Args:
        page: Playwright's.
        folder, suffix: of the pictures.
        only: some of them, or all for None.
        patience: every rest is that many times as long, for a busy machine.
    """

    def __init__(
        self, page: Any, folder: Path, suffix: str, only: frozenset[str] | None = None, patience: float = 1.0
    ) -> None:
        self._only = only
        self._patience = patience
        self._page = page
        self._folder = folder
        self._suffix = suffix

    def rest(self, seconds: float) -> None:
        """Let the page draw."""
        time.sleep(seconds * self._patience)

    def until(self, selector: str) -> None:
        """Wait until the page has it."""
        self._page.wait_for_selector(selector, state="attached", timeout=900_000)

    def press(self, action: str, argument: str | None = None, pause: float = 1.0) -> None:
        """Press a button of the page; forced, because a page that software draws is never still."""
        extra = f'[data-arg="{argument}"]' if argument is not None else ""
        button = self._page.locator(f'[data-act="{action}"]{extra}:visible').first
        before = button.get_attribute("aria-pressed")
        button.click(force=True)
        if action == "switch":
            _wait(lambda: button.get_attribute("aria-pressed") != before, 10.0 * self._patience)
            if button.get_attribute("aria-pressed") == before:
                # lost while the page was being drawn
                button.click(force=True)
        self.rest(pause)

    def tab(self, name: str, pause: float = 0.8) -> None:
        """Choose a tab of a panel."""
        self._page.get_by_role("tab", name=name, exact=True).first.click()
        self.rest(pause)

    def button(self, name: str) -> None:
        """Press one of viser's own buttons."""
        self._page.get_by_role("button", name=name, exact=True).click()

    def take(self, name: str) -> None:
        """Save the page as a PNG of at most 245 kB."""
        if self._only is not None and name not in self._only:
            return
        raw = self._page.screenshot(timeout=180_000)
        self._save(Image.open(io.BytesIO(raw)).convert("RGB"), name)

    def _save(self, image: Image.Image, name: str) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)
        path = self._folder / f"page-{name}{self._suffix}.png"
        image.save(path, optimize=True)
        for step in (2, 3, 4, 6, 8, 12, 16):
            if path.stat().st_size <= _LARGEST:
                break
            # steps between colours that an eye hardly sees; a palette would turn one curve's colour into another's
            table = [255 if value == 255 else min(255, (value + step // 2) // step * step) for value in range(256)]
            image.point(table * 3).save(path, optimize=True)

    def charts(self, names: Sequence[str], columns: int) -> None:
        """One picture of several charts, as large as their tab draws them."""
        drawn = []
        for name in names:
            self.press("tab", name, 4.0)
            raw = self._page.locator(f'[data-chart-tab="{name}"]').screenshot(timeout=180_000)
            drawn.append(Image.open(io.BytesIO(raw)).convert("RGB"))
        # each into the column that is the shortest so far
        width = max(image.width for image in drawn) + _GAP
        ends = [_GAP] * columns
        places = []
        for image in drawn:
            column = ends.index(min(ends))
            places.append((_GAP + column * width, ends[column]))
            ends[column] += image.height + _GAP
        sheet = Image.new("RGB", (width * columns + _GAP, max(ends)), drawn[0].getpixel((0, 0)))
        for image, place in zip(drawn, places, strict=True):
            sheet.paste(image, place)
        self._save(sheet, "charts")

    def resize(self, width: int, height: int) -> None:
        """Another size of the window."""
        self._page.set_viewport_size({"width": width, "height": height})
        self.rest(6.0)

    def select_front(self, last: bool) -> None:
        """Click the point of the front with the least f2, or f1."""
        marks = self._page.locator("svg[data-chart=pareto] path.mark.level2")
        if not marks.count():
            marks = self._page.locator("svg[data-chart=pareto] path.mark.level1")
        box = (marks.last if last else marks.first).bounding_box()
        if box is not None:
            self._page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            self.rest(3.0)

    def hover_front(self) -> None:
        """Rest on a point of the front."""
        box = self._page.locator(
            "svg[data-chart=pareto] path.mark.level1, svg[data-chart=pareto] path.mark.level2"
        ).last
        found = box.bounding_box()
        if found is not None:
            self._page.mouse.move(found["x"] + found["width"] / 2, found["y"] + found["height"] / 2)
            self.rest(1.5)


def _wait(condition: Callable[[], bool], seconds: float) -> None:
    give_up = time.monotonic() + seconds
    while not condition() and time.monotonic() < give_up:
        time.sleep(0.2)


def _states_of_a_run(explorer: Explorer, camera: Photographer) -> None:
    camera.take("ready")
    camera.press("run_start")
    _wait(lambda: len(explorer.state.picture.generations) >= 3, 120.0)
    camera.take("running")
    camera.press("run_pause")
    _wait(lambda: explorer.state.picture.status == PAUSED, 20.0)
    camera.rest(1.0)
    camera.take("paused")
    camera.press("run_resume")
    _wait(lambda: explorer.state.picture.status == FINISHED, 900.0)
    camera.rest(1.0)


def _begun_and_stopped(explorer: Explorer, camera: Photographer) -> None:
    camera.take("ready")
    camera.press("run_start")
    _wait(lambda: len(explorer.state.picture.generations) >= 8, 900.0)
    camera.rest(2.0)
    camera.take("running")
    camera.press("run_stop")
    _wait(lambda: explorer.state.picture.status not in ACTIVE, 60.0)
    camera.rest(2.0)


def _failed_run(explorer: Explorer, camera: Photographer, folder: Path) -> None:
    """A copy of the run whose file says that it failed: a failing machine cannot be ordered."""
    source = folder / explorer.state.picture.name
    copy = folder / f"failed-{source.name}"
    with sqlite3.connect(source) as old, sqlite3.connect(copy) as new:
        old.backup(new)
        reason = "the workers ended three times in a row while evaluating design 412; see the log"
        new.executemany("UPDATE run SET value = ? WHERE key = ?", [("failed", "state"), (reason, "reason")])
    explorer.services.runs.open(copy)
    _wait(lambda: explorer.state.picture.status == FAILED, 20.0)
    camera.rest(3.0)
    camera.take("failed")
    explorer.services.runs.open(source)
    _wait(lambda: explorer.state.picture.status == FINISHED, 20.0)
    camera.rest(2.0)


def _tour(camera: Photographer) -> None:
    camera.press("choose", "compromise", 4.0)
    camera.take("finished")
    camera.hover_front()
    camera.take("hover")
    camera.press("pin")
    camera.select_front(last=True)
    camera.press("pin")
    camera.press("choose", "compromise", 2.0)
    camera.tab("Charts")
    _charts(camera)
    _scenes(camera)
    camera.tab("What-if")
    camera.take("what-if")
    camera.tab("Case")
    camera.take("case")
    camera.tab("Runs")
    camera.take("runs")
    camera.tab("Design space")


def _for_the_docs(camera: Photographer, compromise: int) -> None:
    """What docs/page.md and the README show."""
    camera.until('[data-run-status="finished"]')
    camera.until("svg[data-chart=pareto] path.mark.level2")
    camera.press("choose", "compromise")
    camera.until(f'[data-selected="{compromise}"]')
    camera.rest(5.0)
    camera.take("finished")
    camera.press("pin")
    camera.select_front(last=True)
    camera.press("pin")
    camera.press("choose", "compromise", 3.0)
    _scenes(camera)
    camera.press("switch", "waves")
    camera.until("text=wave elevation")
    camera.rest(5.0)
    camera.press("switch", "dark", 5.0)
    camera.take("dark")
    camera.press("switch", "dark", 2.0)
    camera.press("switch", "waves", 1.0)
    camera.resize(1366, 1600)
    camera.charts(("lines", "resistance", "open_water", "thrust", "convergence", "parallel"), 3)


def _your_ship(explorer: Explorer, camera: Photographer) -> None:
    """Series 60 from its published table, understood, and made the case."""
    ships = explorer.services.ships
    ships.bring_hull(_SHIP.name, _SHIP.read_bytes())
    ships.say(length=_SHIP_LENGTH)
    _wait(lambda: explorer.state.ship.read is not None and not explorer.state.ship.reading, 60.0)
    camera.resize(1366, 1400)
    camera.tab("Your ship")
    camera.button("Make it the case")
    _wait(lambda: explorer.state.picture.case.initial.length == _SHIP_LENGTH, 60.0)
    camera.rest(12.0)
    camera.take("your-ship")


def _charts(camera: Photographer) -> None:
    for name in ("open_water", "resistance", "thrust", "lines", "parallel", "drivers", "convergence", "failures"):
        camera.press("tab", name, 3.0)
        camera.take(f"chart-{name.replace('_', '-')}")


def _scenes(camera: Photographer) -> None:
    camera.tab("Compare")
    camera.press("show_pin", "0", 2.0)
    camera.press("ghost_pin", "1", 4.0)
    camera.take("compare-over")
    camera.press("switch", "beside", 4.0)
    camera.take("compare")
    camera.press("switch", "beside", 1.0)
    camera.press("switch", "ghost", 2.0)
    camera.tab("Charts")
    camera.press("tab", "open_water")
    camera.press("switch", "waves")
    camera.until("text=wave elevation")
    camera.rest(7.0)
    camera.take("waves")
    camera.press("switch", "pressure")
    camera.until("text=hull pressure")
    camera.rest(11.0)
    camera.press("camera", "below", 3.0)
    camera.take("pressure")
    camera.press("switch", "waves", 2.0)
    camera.press("camera", "propeller", 3.0)
    camera.take("propeller-pressure")
    camera.press("switch", "pressure", 3.0)
    camera.take("propeller")
    camera.press("camera", "perspective", 3.0)


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.pictures.page")
    parser.add_argument("--to", type=Path, required=True, help="folder for page-*.png")
    parser.add_argument("--large", action="store_true", help="1920x1080 instead of 1366x768")
    parser.add_argument("--dark", action="store_true", help="the dark page")
    parser.add_argument("--docs", action="store_true", help="only the pictures of docs/page.md")
    parser.add_argument("--states", choices=("all", "run", "tour"), default="all")
    parser.add_argument("--patience", type=float, default=1.0, help="wait that many times as long: a busy machine")
    parser.add_argument("--run", type=Path, default=None, help="photograph this run instead of a small new one")
    arguments = parser.parse_args(argv)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sys.stderr.write("Playwright is missing: pip install '.[test]'\n")
        return 2
    width, height = _SIZES["-large" if arguments.large else ""]
    suffix = ("-large" if arguments.large else "") + ("-dark" if arguments.dark else "")
    case = load_case("dtc-p4119")
    if not arguments.docs:
        case = case.replaced("optimization", population=20, generations=24, level1_generations=18)
    chosen = arguments.run or (demonstration() if arguments.docs or arguments.states == "tour" else None)
    if arguments.docs and chosen is None:
        sys.stderr.write("--docs shows a finished run: name one with --run\n")
        return 2
    shown = None if arguments.docs else chosen
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        explorer = Explorer(case, shown, shown is not None, port=free_port("127.0.0.1", 8700), folder=Path(folder))
        try:
            browser = playwright.chromium.launch(executable_path=chromium_program(), args=list(ARGUMENTS))
            page = browser.new_page(viewport={"width": width, "height": height})
            page.set_default_timeout(120_000)
            page.add_init_script('localStorage.setItem("hpsop-toured", "1")')
            page.goto(explorer.address)
            page.add_style_tag(content=_HIDE)
            camera = Photographer(page, arguments.to, suffix, _DOCS if arguments.docs else None, arguments.patience)
            camera.until("[data-selected]")
            camera.rest(8.0)
            if arguments.dark:
                camera.press("switch", "dark", 4.0)
            if arguments.docs:
                _begun_and_stopped(explorer, camera)
                explorer.services.runs.open(chosen, read_only=True)
                _for_the_docs(camera, open_run(chosen).design("compromise").id)
                _your_ship(explorer, camera)
            elif shown is None:
                _states_of_a_run(explorer, camera)
                _failed_run(explorer, camera, Path(folder))
            if not arguments.docs and arguments.states != "run":
                _tour(camera)
            browser.close()
        finally:
            explorer.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
