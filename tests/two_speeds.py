"""A small problem for tests that need some case and not the recommended one, which may change."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.case.case import Case, load_case

TWO_SPEEDS = str(Path(__file__).parent / "data" / "two_speeds.toml")


def stated_case() -> Case:
    """The same with stated wave coefficients, so that level 1 needs no level 2."""
    return load_case(TWO_SPEEDS).replaced(
        "constants", wave_calibration="stated", stated_wave_coefficients=(2.8e-4, 6.6e-4)
    )
