"""Whoever cannot see, or has no mouse, against axe-core's rules: no serious finding in any panel, light and dark."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from conftest import choose_tab, press

_SERIOUS = ("serious", "critical")


@pytest.fixture(scope="module")
def page(open_page, explorer):
    return open_page(explorer, 1366, 768)


def _findings(page, within: str | None = None) -> list[str]:
    # names are given a moment after a panel appears
    page.wait_for_function("(given) => window.hpsop.named > given + 1", arg=page.evaluate("window.hpsop.named"))
    found = Axe().run(page, context=within).response["violations"]
    return [
        f"{item['id']}: {node['html'][:120]} {node.get('failureSummary', '')[:200]}"
        for item in found
        if item["impact"] in _SERIOUS
        for node in item["nodes"]
    ]


def test_no_panel_has_a_serious_finding(page):
    assert _findings(page) == []
    for tab in ("Table", "Compare", "What-if", "Your ship", "Case", "Runs"):
        choose_tab(page, tab)
        assert _findings(page) == [], tab
    press(page, "rename_run")
    page.wait_for_selector("input[data-set=run_name]")
    press(page, "link")
    page.wait_for_selector(".hpsop-link:visible")
    assert _findings(page) == [], "a run's name, and the link"
    page.keyboard.press("Escape")
    press(page, "help")
    page.wait_for_selector(".card.help:visible")
    assert _findings(page, ".hpsop-overlay-help") == [], "help"
    press(page, "tour", "0")
    page.wait_for_selector(".card.tour:visible")
    assert _findings(page, ".hpsop-overlay-tour") == [], "tour"
    press(page, "tour", "end")
    choose_tab(page, "Charts")
    assert _findings(page) == [], "Charts"
    for name in sorted(page.evaluate("[...document.querySelectorAll('[data-act=tab]')].map(node => node.dataset.arg)")):
        press(page, "tab", name)
        page.wait_for_selector(f'[data-chart-tab="{name}"]')
        # what stands around it has been looked at
        assert _findings(page, "[data-chart-tab]") == [], name
    choose_tab(page, "Design space")
    choose_tab(page, "Design")


def test_the_dark_page_has_none_either(page):
    press(page, "switch", "dark")
    page.wait_for_selector('[data-mantine-color-scheme="dark"]', state="attached")
    assert _findings(page) == []
