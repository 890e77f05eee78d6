"""ITTC-57 friction line."""

from __future__ import annotations

import math

from hpsop_core.errors import SolverFailure

LEAST_REYNOLDS_NUMBER = 1e5


def ittc57_coefficient(reynolds_number: float) -> float:
    """Friction coefficient 0.075/(log10 Re - 2)^2 of the ITTC 1957 model-ship correlation line.

    Args:
        reynolds_number: V Lpp / nu.

    Raises:
        SolverFailure: Re is below 1e5, where the line means nothing.
    """
    if not reynolds_number >= LEAST_REYNOLDS_NUMBER:
        raise SolverFailure(
            "friction", f"Reynolds number {reynolds_number:.3g} is below {LEAST_REYNOLDS_NUMBER:g}: too small or slow"
        )
    return 0.075 / (math.log10(reynolds_number) - 2.0) ** 2
