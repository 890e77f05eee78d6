"""How sure a case's k and wake fraction are: what it states, else what is known of the formula that gives them."""

from __future__ import annotations

from dataclasses import dataclass

from hpsop_core.case.sections import ConstantsSection

FORMULA_FORM_FACTOR = 0.04
"""Of k by Holtrop's formula: a judgement. What it misses on the ships whose k is known here is in
docs/what-to-believe.md."""

FORMULA_WAKE_FRACTION = 0.05
"""Of w by any of the formulas: a judgement likewise; on one ship they differ among themselves by as much."""


@dataclass(frozen=True)
class InputWidth:
    """Half width of a number's 90 % interval, and who says so."""

    half_width: float
    source: str


def form_factor_width(constants: ConstantsSection) -> InputWidth | None:
    """Of k; None where it is taken as stated."""
    if constants.form_factor_uncertainty is not None:
        return InputWidth(constants.form_factor_uncertainty, "stated by the case")
    if constants.form_factor_formula == "holtrop":
        return InputWidth(FORMULA_FORM_FACTOR, "a judgement of Holtrop's formula")
    return None


def wake_fraction_width(constants: ConstantsSection) -> InputWidth | None:
    """Of w; None where it is taken as stated."""
    if constants.wake_fraction_uncertainty is not None:
        return InputWidth(constants.wake_fraction_uncertainty, "stated by the case")
    if constants.wake_formula != "stated":
        return InputWidth(FORMULA_WAKE_FRACTION, "a judgement of wake formulas")
    return None
