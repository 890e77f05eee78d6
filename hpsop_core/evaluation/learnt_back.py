"""What a learnt surface says of cavitation on a blade's back, where that decides nothing: far from the case's limit.

The share of the back under vapour pressure is regressed, a condition apart, over what the pressures on a blade depend
on: its form, the advance coefficient, the cavitation number, and how fast the pressure of the water falls towards the
upper blade. It is counted in whole panels, and it grows steeply where it begins. So an answer is given only where the
limit lies beyond twice the greatest error that the regression makes of any solved design that it was not told of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.constraints import is_judged
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.gaussian_process import GaussianProcess, fit
from hpsop_core.typing_aliases import Array

_TIMES_THE_GREATEST_ERROR = 2.0
_DEVIATIONS = 4.0
_LEAST_MARGIN = 0.01
"""A hundredth of the back, some four panels: so near to the limit no regression is believed, however sure it is."""


@dataclass(frozen=True, eq=False)
class LearntBack:
    """Regressions of the share by the index of the conditions at which the case judges it; picklable."""

    shares: Mapping[int, GaussianProcess]

    @property
    def greatest_error(self) -> float:
        """Of all designs that it was learnt from, each predicted from the others: a part of the back."""
        return max((_greatest(regression) for regression in self.shares.values()), default=0.0)

    def told(
        self, case: Case, variables: DesignVariables, conditions: Sequence[ConditionResult]
    ) -> tuple[ConditionResult, ...] | None:
        """The conditions with the share at those that are judged; None where it is not sure of the limit.

        Args:
            case: with ``back_cavitation_limit``.
            variables: the propeller's are used.
            conditions: of the design, without pressures.
        """
        limit = case.constraints.back_cavitation_limit
        if limit is None:
            return None
        found, kept, broken = list(conditions), True, False
        for index, regression in self.shares.items():
            condition = conditions[index]
            if condition.cavitation_number is None:
                return None
            share, deviation = regression.predict(
                _inputs(
                    case,
                    variables,
                    condition.advance_coefficient,
                    condition.cavitation_number,
                    condition.rotation_rate_rpm,
                )
            )
            margin = max(
                _LEAST_MARGIN, _TIMES_THE_GREATEST_ERROR * _greatest(regression), _DEVIATIONS * float(deviation[0])
            )
            value = min(1.0, max(0.0, float(share[0])))
            kept &= value + margin <= limit
            broken |= value - margin > limit
            found[index] = replace(condition, blade_cavitating_share=value)
        return tuple(found) if kept or broken else None


def learn_back(case: Case, solved: Sequence[Mapping[str, Any]]) -> LearntBack | None:
    """Learn from solved designs; None without a limit, or where one of them has no share.

    Args:
        case: what is optimised.
        solved: JSON documents of the true level in a fixed order.
    """
    if case.constraints.back_cavitation_limit is None:
        return None
    shares: dict[int, GaussianProcess] = {}
    for index in range(len(case.conditions.weights)):
        if not is_judged(index, case):
            continue
        points = [data["conditions"][index] for data in solved]
        if any(point.get(name) is None for point in points for name in ("blade_cavitating_share", "cavitation_number")):
            return None
        inputs = [
            _inputs(
                case,
                DesignVariables.from_dict(data["variables"]),
                point["advance_coefficient"],
                point["cavitation_number"],
                point["rotation_rate_rpm"],
            )
            for data, point in zip(solved, points, strict=True)
        ]
        regression = fit(np.array(inputs), np.array([[point["blade_cavitating_share"]] for point in points]))
        if regression is None:
            return None
        shares[index] = regression
    return LearntBack(shares)


def _greatest(regression: GaussianProcess) -> float:
    return float(np.max(np.abs(regression.held_out)))


def _inputs(
    case: Case, variables: DesignVariables, advance: float, cavitation_number: float, rotation_rate_rpm: float
) -> Array:
    """Without dimension; the last is n^2 D/g."""
    fall = (rotation_rate_rpm / 60.0) ** 2 * variables.diameter / case.constants.gravity
    form = (variables.pitch_ratio, float(variables.blade_count), variables.expanded_area_ratio)
    return np.array([*form, advance, cavitation_number, fall])
