"""`hpsop-explore`: loads the page without what its libraries load for others, and runs it."""

from __future__ import annotations

from hpsop_core.lean_imports import lean_imports


def main() -> int:
    """As ``explorer.app.main``."""
    with lean_imports():
        from explorer.app import main as page
    return page()
