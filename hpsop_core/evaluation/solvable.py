"""Which levels a new case can be solved at, found by solving its initial design."""

from __future__ import annotations

import dataclasses

from hpsop_core.case.case import Case
from hpsop_core.errors import HpsopError
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.evaluation.reference import reference_for


def solvable_case(case: Case) -> tuple[Case, str]:
    """The case with the levels that can be solved for its initial design, and what had to be left, or "".

    A full form is slow, and at the Froude number of a slow ship level 2's grid carries no waves: what is left is level
    1, which then has nothing to be calibrated with. The case's description says so too.

    Raises:
        HpsopError: not even level 1 gives numbers.
    """
    try:
        reference_for(case, TRUTH.number)
    except HpsopError as error:
        left = f"level 2 gives no numbers here ({error}); set up with level 1 alone, not calibrated"
        alone = case.replaced("constants", wave_calibration="none")
        alone = alone.replaced("optimization", level1_generations=case.optimization.generations)
        reference_for(alone, FAST.number)
        return dataclasses.replace(alone, description=f"{case.description}\nAt these speeds {left}."), left
    return case, ""
