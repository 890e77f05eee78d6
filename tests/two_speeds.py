"""A small problem for tests that need some case and not the recommended one, which may change."""

from __future__ import annotations

from pathlib import Path

TWO_SPEEDS = str(Path(__file__).parent / "data" / "two_speeds.toml")
