"""How the hull changes the propeller's inflow and the propeller the hull's resistance: w and t."""

from __future__ import annotations

import numpy as np

from hpsop_core.assets import read_asset_text
from hpsop_core.errors import SolverFailure


def _taylor_fit() -> tuple[float, float, float]:
    """Coefficients (a, b, c) of the least-squares parabola a CB^2 + b CB + c through Taylor's table."""
    lines = [line for line in read_asset_text("reference", "taylor_wake.csv").splitlines() if line[:1].isdigit()]
    table = np.array([[float(word) for word in line.split(",")] for line in lines])
    a, b, c = np.polyfit(table[:, 0], table[:, 1], 2)
    return float(a), float(b), float(c)


TAYLOR_FIT = _taylor_fit()


def wake_fraction(block_coefficient: float, formula: str = "taylor_quadratic") -> float:
    """Wake fraction w of a single-screw ship.

    Args:
        block_coefficient: CB.
        formula: "taylor_quadratic": the parabola through Taylor's table, which gives the 0.261 and 0.299 that the
            paper's Table 4 implies, held constant below its minimum (CB .532), where it would rise again; "linear":
            0.5 CB - 0.05, the usual short form of the same data.

    Raises:
        SolverFailure: the formula leaves 0 to 0.6, so CB is outside what it describes.
    """
    if formula == "linear":
        wake = 0.5 * block_coefficient - 0.05
    else:
        a, b, c = TAYLOR_FIT
        wake = float(np.polyval((a, b, c), max(block_coefficient, -b / (2.0 * a))))
    if not 0.0 <= wake <= 0.6:
        raise SolverFailure("interaction", f"w {wake:.3f} at CB {block_coefficient:.3f} is outside 0 to 0.6")
    return wake


def thrust_deduction(wake: float, factor: float) -> float:
    """Schoenherr's thrust deduction t = factor times w (0.6 by default, between his 0.5 and 0.9 for rudder types)."""
    return factor * wake
