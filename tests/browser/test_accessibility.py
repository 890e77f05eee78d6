"""Whoever cannot see, or has no mouse, against axe-core's rules: no serious finding in any panel, light and dark."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from conftest import choose_tab, press

_SERIOUS = ("serious", "critical")


@pytest.fixture(scope="module")
def page(open_page, explorer):
    return open_page(explorer, 1366, 768)


def _findings(page) -> list[str]:
    # names are given a moment after a panel appears
    page.wait_for_timeout(2500)
    found = Axe().run(page).response["violations"]
    return [
        f"{item['id']}: {node['html'][:120]} {node.get('failureSummary', '')[:200]}"
        for item in found
        if item["impact"] in _SERIOUS
        for node in item["nodes"]
    ]


def test_no_panel_has_a_serious_finding(page):
    assert _findings(page) == []
    for tab in ("Charts", "Compare", "What-if", "Your ship", "Case", "Runs"):
        choose_tab(page, tab)
        assert _findings(page) == [], tab
    choose_tab(page, "Design space")
    choose_tab(page, "Design")


def test_the_dark_page_has_none_either(page):
    press(page, "switch", "dark")
    page.wait_for_selector('[data-mantine-color-scheme="dark"]', state="attached")
    assert _findings(page) == []
