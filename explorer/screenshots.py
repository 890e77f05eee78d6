"""Pictures of the page in each of its states: ``python -m explorer.screenshots --to docs/pictures``.

It starts the real page in a folder of its own, runs a small real search, presses the buttons, and photographs. It needs
Playwright's Python client and Chromium, as the browser tests do.
"""

from __future__ import annotations

import argparse
import io
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PIL import Image

from explorer.app import Explorer, demonstration
from explorer.run_picture import FINISHED, PAUSED
from explorer.security import free_port
from hpsop_core.case import load_case

_ARGUMENTS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_HIDE = ".mantine-Notifications-root{display:none!important}"
_COLOURS = 200
_SIZES = {"": (1366, 768), "-large": (1920, 1080)}


class Photographer:
    """One browser page and where its pictures go."""

    def __init__(self, page: Any, folder: Path, suffix: str) -> None:
        self._page = page
        self._folder = folder
        self._suffix = suffix

    def press(self, action: str, argument: str | None = None, pause: float = 1.0) -> None:
        """Press a button of the page."""
        extra = f'[data-arg="{argument}"]' if argument is not None else ""
        self._page.locator(f'[data-act="{action}"]{extra}:visible').first.click()
        time.sleep(pause)

    def tab(self, name: str, pause: float = 0.8) -> None:
        """Choose a tab of a panel."""
        self._page.get_by_role("tab", name=name, exact=True).first.click()
        time.sleep(pause)

    def take(self, name: str) -> None:
        """Save the page as a small PNG."""
        raw = self._page.screenshot(timeout=180_000)
        image = Image.open(io.BytesIO(raw)).convert("RGB").quantize(_COLOURS)
        self._folder.mkdir(parents=True, exist_ok=True)
        image.save(self._folder / f"page-{name}{self._suffix}.png", optimize=True)

    def hover_front(self) -> None:
        """Rest on a point of the front."""
        box = self._page.locator(
            "svg[data-chart=pareto] path.mark.level1, svg[data-chart=pareto] path.mark.level2"
        ).last
        found = box.bounding_box()
        if found is not None:
            self._page.mouse.move(found["x"] + found["width"] / 2, found["y"] + found["height"] / 2)
            time.sleep(1.5)


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
    time.sleep(1.0)
    camera.take("paused")
    camera.press("run_resume")
    _wait(lambda: explorer.state.picture.status == FINISHED, 300.0)
    time.sleep(1.0)


def _tour(camera: Photographer) -> None:
    camera.press("choose", "compromise", 4.0)
    camera.take("finished")
    camera.hover_front()
    camera.take("hover")
    camera.tab("Charts")
    for name in ("open_water", "resistance", "thrust", "lines", "parallel", "drivers", "convergence", "failures"):
        camera.press("tab", name, 2.0)
        camera.take(f"chart-{name.replace('_', '-')}")
    camera.tab("Design")
    camera.press("pin")
    camera.press("choose", "initial", 2.0)
    camera.press("pin")
    camera.press("choose", "compromise", 2.0)
    camera.tab("Compare")
    camera.press("switch", "ghost", 3.0)
    camera.take("compare")
    camera.press("switch", "ghost")
    camera.tab("What-if")
    camera.take("what-if")
    camera.tab("Case")
    camera.take("case")
    camera.tab("Runs")
    camera.take("runs")
    camera.tab("Design space")
    camera.tab("Charts")
    camera.press("tab", "open_water")
    camera.press("switch", "waves", 5.0)
    camera.take("waves")
    camera.press("camera", "propeller", 3.0)
    camera.take("propeller")
    camera.press("switch", "pressure", 5.0)
    camera.take("pressure")
    camera.press("camera", "perspective", 2.0)
    camera.press("switch", "dark", 3.0)
    camera.take("dark")


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m explorer.screenshots")
    parser.add_argument("--to", type=Path, required=True, help="folder for page-*.png")
    parser.add_argument("--large", action="store_true", help="1920x1080 instead of 1366x768")
    parser.add_argument("--states", choices=("all", "run", "tour"), default="all")
    parser.add_argument("--run", type=Path, default=None, help="photograph this run instead of a small new one")
    arguments = parser.parse_args(argv)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sys.stderr.write("Playwright is missing: pip install '.[test]'\n")
        return 2
    suffix = "-large" if arguments.large else ""
    width, height = _SIZES[suffix]
    case = load_case("dtc-p4119").replaced("optimization", population=24, generations=30, level1_generations=20)
    shown = arguments.run or (demonstration() if arguments.states == "tour" else None)
    names = ("chromium", "chromium-browser", "google-chrome")
    program = next((path for name in names if (path := shutil.which(name))), None)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        explorer = Explorer(case, shown, shown is not None, port=free_port("127.0.0.1", 8700), folder=Path(folder))
        try:
            browser = playwright.chromium.launch(executable_path=program, args=list(_ARGUMENTS))
            page = browser.new_page(viewport={"width": width, "height": height})
            page.set_default_timeout(120_000)
            page.goto(explorer.address)
            page.add_style_tag(content=_HIDE)
            page.wait_for_selector("[data-selected]", state="attached")
            time.sleep(8.0)
            camera = Photographer(page, arguments.to, suffix)
            if shown is None:
                _states_of_a_run(explorer, camera)
            if arguments.states != "run":
                _tour(camera)
            browser.close()
        finally:
            explorer.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
