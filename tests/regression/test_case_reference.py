"""docs/case.md is what the declarations say."""

from __future__ import annotations

from pathlib import Path

from tools.case_reference import case_reference


def test_documentation_of_the_case_is_up_to_date() -> None:
    page = Path(__file__).resolve().parents[2] / "docs" / "case.md"
    assert page.read_text(encoding="utf-8") == case_reference(), "run python -m tools.case_reference"
