"""Errors of designs of the true level that were not solved finer: typical ones, so that no number stands without.

The waves' half width is what designs of the Duisburg Test Case's family had (``python -m tools.error_study``) at the
same Froude number; the mesh of the propeller likewise. k and wake are the case's. What they do to thrust, revolutions
and power follows by matching the changed resistance or inflow with the design's own open-water curve again. The
objectives' are those of a comparison of two designs.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.evaluation.input_widths import form_factor_width, wake_fraction_width
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.evaluation.result import Evaluation

# J, KT, 10 KQ of a design's propeller, close together
_Curves = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
WAVE_WIDTHS = ((0.168, 0.186, 0.20, 0.217, 0.27), (1.7e-4, 1.2e-4, 0.8e-4, 1.0e-4, 0.9e-4))
"""Froude numbers, and the half width of the wave coefficient there: medians of 16 designs over the space of dtc-p4119,
and at the last of 12 over that of dtc-p4119-paper. Nine of ten had less than 2.4e-4 and 1.6e-4 from the second on."""

PROPELLER_WIDTH = 0.002
"""Of the delivered power, from the propeller's panels, likewise; nine of ten had less than 0.0045."""


def with_stated_errors(case: Case, evaluation: Evaluation) -> Evaluation:
    """The evaluation with typical errors, marked as such; as it is where it has its own, failed or is of level 1.

    Args:
        case: of the design.
        evaluation: any.
    """
    if not evaluation.ok or evaluation.level != TRUTH.number or evaluation.errors:
        return evaluation
    # Where designs have errors of their own SciPy's interpolation is not loaded for this.
    from hpsop_core.evaluation.curves import smooth_open_water

    curves: _Curves | None = None
    errors: dict[str, float] = {}
    burnt = []
    for place, condition in enumerate(evaluation.conditions, 1):
        curves = curves or smooth_open_water(evaluation.open_water, _CURVE_POINTS)[:3]
        widths = _summed(_terms(case, curves, condition))
        errors |= {f"{name}_{place}": float(f"{width:.3g}") for name, width in widths.items()}
        if condition.fuel_rate:
            burnt.append((condition.weight * condition.fuel_rate, condition.weight * widths["fuel_rate"]))
    if burnt and evaluation.fuel_per_hour:
        # The same at every speed: they add up.
        share = sum(width for _, width in burnt) / sum(rate for rate, _ in burnt)
        for name in ("fuel_per_hour", "carbon_dioxide_per_hour", "attained_eedi_g_per_tonne_mile"):
            value = getattr(evaluation, name)
            if value is not None:
                errors[name] = float(f"{share * value:.3g}")
    for name, value in evaluation.objectives.items():
        errors[name] = float(f"{TRUTH.comparison_error * abs(value):.3g}")
    return dataclasses.replace(evaluation, errors=errors, errors_source="stated")


def _terms(case: Case, curves: _Curves, condition: ConditionResult) -> list[dict[str, float]]:
    """Half widths by quantity: of the waves, the propeller's mesh, k and wake."""
    waves = float(np.interp(condition.froude_number, *WAVE_WIDTHS)) / condition.wave_coefficient
    terms = [_rematched(case, curves, condition, waves * condition.wave_resistance)]
    terms[0] |= {
        "wave_coefficient": waves * condition.wave_coefficient,
        "wave_resistance": waves * condition.wave_resistance,
    }
    named = ("torque", "open_water_efficiency", "propulsive_efficiency", "delivered_power", *_OF_BRAKE_POWER)
    values = {name: getattr(condition, name) for name in named}
    terms.append({name: PROPELLER_WIDTH * abs(value) for name, value in values.items() if value is not None})
    factor, wake = form_factor_width(case.constants), wake_fraction_width(case.constants)
    if factor is not None:
        form = factor.half_width * condition.friction_resistance
        terms.append(_rematched(case, curves, condition, form) | {"form_resistance": form})
    if wake is not None:
        changed = _rematched(case, curves, condition, 0.0, wake.half_width)
        terms.append(changed | {"wake_fraction": wake.half_width})
    return terms


_CURVE_POINTS = 721
_OF_BRAKE_POWER = ("brake_power", "engine_load", "fuel_rate")


def _rematched(
    case: Case, curves: _Curves, condition: ConditionResult, resistance: float, wake: float = 0.0
) -> dict[str, float]:
    """By how much a condition's numbers change with a resistance and a wake fraction added, t as it is."""
    advance, thrust, torque = curves
    useful = thrust > 0.0
    advance, thrust, torque = advance[useful], thrust[useful], torque[useful]
    load = thrust / advance**2  # falls with J
    inflow = (1.0 - condition.wake_fraction - wake) / (1.0 - condition.wake_fraction)
    more = 1.0 + resistance / condition.total_resistance
    own = condition.thrust_coefficient / condition.advance_coefficient**2

    def at(loading: float) -> tuple[float, float, float]:
        place = float(np.interp(-math.log(loading), -np.log(load), advance))
        return place, loading * place**2, float(np.interp(place, advance, torque))

    # Both by the tabulated curve, so that what it misses falls out.
    (place, lift, turn), (old_place, old_lift, old_turn) = at(own * more / inflow**2), at(own)
    turns = inflow * old_place / place
    power = turns**3 * turn / old_turn
    efficiency = place * lift / turn / (old_place * old_lift / old_turn)
    ratios = {
        "total_resistance": more,
        "effective_power": more,
        "thrust": more,
        "torque": turns**2 * turn / old_turn,
        "advance_coefficient": place / old_place,
        "thrust_coefficient": lift / old_lift,
        "torque_coefficient": turn / old_turn,
        "rotation_rate_rpm": turns,
        "open_water_efficiency": efficiency,
        "hull_efficiency": 1.0 / inflow,
        "propulsive_efficiency": efficiency / inflow,
        "delivered_power": power,
        **dict.fromkeys(_OF_BRAKE_POWER, power),
    }
    values = {name: getattr(condition, name) for name in ratios}
    found = {name: abs(ratios[name] - 1.0) * abs(value) for name, value in values.items() if value is not None}
    if case.constraints.cavitation_criterion == "keller":
        area = condition.required_expanded_area_ratio - case.constraints.keller_k
        found["required_expanded_area_ratio"] = abs(more - 1.0) * area
    return found


def _summed(terms: list[dict[str, float]]) -> dict[str, float]:
    """In quadrature."""
    squares: dict[str, float] = {}
    for widths in terms:
        for name, width in widths.items():
            squares[name] = squares.get(name, 0.0) + width**2
    return {name: math.sqrt(square) for name, square in squares.items()}
