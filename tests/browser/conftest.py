"""A real server on a real small case, and Debian's Chromium with software graphics."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from explorer.app import Explorer
from explorer.server.security import free_port
from hpsop_core.case.case import Case
from tests.patience import patience
from tests.two_speeds import stated_case
from tools.chromium import ARGUMENTS, chromium_program

pytestmark = pytest.mark.browser
# Software graphics on a busy machine: the first mesh alone may stall a page for many seconds.
PATIENCE = 120_000
# With software graphics a page's picture costs most of what the browser computes, and only some tests look at it. The
# others leave the last step out: all messages, meshes and layout are as ever, and the canvas stays empty.
_UNDRAWN = """
for (const context of [WebGLRenderingContext, WebGL2RenderingContext])
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"])
        if (context.prototype[name]) context.prototype[name] = () => {};
"""
# Counts what explorer/assets/frames.js is to keep from being fetched, and lets it through.
_PHOTOGRAPHS = """
window.photographs = 0;
const get = window.fetch;
window.fetch = (what, ...rest) => {
    if (String(what && what.url || what).startsWith("data:image/jpeg")) window.photographs += 1;
    return get.call(window, what, ...rest);
};
"""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Everything in this folder needs Chromium."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)


def small_case(**settings: Any) -> Case:
    """Two speeds with a small search at level 1; the waves stated, so that level 2 is not needed."""
    case = stated_case()
    return case.replaced("optimization", **{"population": 8, "generations": 40, "level1_generations": 40, **settings})


def new_context(chromium: Browser, width: int, height: int, drawn: bool = False) -> BrowserContext:
    """A browser of another person's; its pages draw their picture only if ``drawn``."""
    context = chromium.new_context(viewport={"width": width, "height": height})
    if not drawn:
        context.add_init_script(_UNDRAWN)
    return context


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """One browser process for all tests."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_program(), args=list(ARGUMENTS))
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    """The page on the small case."""
    folder = tmp_path_factory.mktemp("runs")
    page = Explorer(small_case(), port=free_port("127.0.0.1", _any_port()), folder=folder, workers=2)
    yield page
    page.close()


@pytest.fixture(scope="module")
def open_page(chromium: Browser) -> Iterator[Callable[..., Page]]:
    """Opens a page of its own browser context (as another person's browser) and waits until it stands."""
    contexts = []

    def open_one(
        explorer: Explorer,
        width: int = 1200,
        height: int = 700,
        fresh: bool = True,
        toured: bool = True,
        drawn: bool = False,
    ) -> Page:
        """``fresh``: nobody has chosen a design here before; the tests begin at the initial one, without a ghost.

        ``toured``: this browser has seen the tour, which is not offered again. ``drawn``: with its picture.
        """
        context = new_context(chromium, width, height, drawn)
        context.add_init_script(_PHOTOGRAPHS)
        contexts.append(context)
        if toured:
            context.add_init_script('localStorage.setItem("hpsop-toured", "1")')
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.goto(explorer.address)
        # viser's own notice about software graphics stands in the way of the mouse
        page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
        page.wait_for_selector("svg[data-chart=pareto]")
        page.wait_for_selector("[data-selected]", state="attached")
        if fresh:
            # a run with a front opens at its compromise, the initial design its ghost
            session = explorer.state.sessions[max(explorer.state.sessions)]
            if session.selected.kind != "initial":
                assert session.selected.design_id == explorer.state.picture.compromise and session.options.ghost
                session.set_options(ghost=False)
                session.select(explorer.services.designs.first())
            page.wait_for_selector('[data-selected="initial"]', state="attached")
        return page

    yield open_one
    for context in contexts:
        context.close()


def _any_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_until(condition: Callable[[], object], seconds: float = 60.0, what: str = "") -> None:
    """Poll until true; ``seconds`` are stretched (``patience``).

    Raises:
        AssertionError: it did not become true.
    """
    give_up = time.monotonic() + patience(seconds)
    while time.monotonic() < give_up:
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError(f"waited {seconds:g} s in vain for {what or condition}")


def session_of(explorer: Explorer, index: int = 0) -> Any:
    """The Python side of the browser that came as number ``index``."""
    return explorer.state.sessions[sorted(explorer.state.sessions)[index]]


def front_marks(page: Page) -> list[tuple[float, float]]:
    """Where the newest front's points stand on the screen."""
    return [
        (float(x), float(y))
        for x, y in page.evaluate(
            """() => [...document.querySelectorAll('svg[data-chart=pareto] path.mark.level1')].map((mark) => {
                const box = mark.getBoundingClientRect();
                return [box.x + box.width / 2, box.y + box.height / 2];
            })"""
        )
    ]


def press(page: Page, action: str, argument: str | None = None) -> None:
    """Press a button with the mouse."""
    extra = f'[data-arg="{argument}"]' if argument is not None else ""
    page.locator(f'[data-act="{action}"]{extra}:visible').first.click()


def choose_tab(page: Page, name: str) -> None:
    """Choose a tab of a panel with the mouse."""
    page.get_by_role("tab", name=name, exact=True).first.click()
