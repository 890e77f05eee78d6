"""The physics of a design at a level, not normalised: form, resistance, wake, open-water curve, every condition."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.condition import condition_result
from hpsop_core.evaluation.hull_answer import build_hull, hull_variables, resistance_point, wave_answers
from hpsop_core.evaluation.propeller_answer import build_propeller, propeller_answer, propeller_variables
from hpsop_core.evaluation.result import ConditionResult
from hpsop_core.evaluation.shapes import initial_volume
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.interaction import wake_fraction
from hpsop_core.hydro.operating_point import PropellerCurve


@dataclass(frozen=True)
class Basis:
    """What every design's physics takes from the initial one.

    Attributes:
        displaced_volume: V0 in m3, which the displacement ratio refers to.
        speeds: the initial design's at the case's Froude numbers, in m/s.
        froude_numbers: the case's.
        wave_calibration: factors on level 1's wave resistance at these Froude numbers; ones at level 2.
    """

    displaced_volume: float
    speeds: tuple[float, ...]
    froude_numbers: tuple[float, ...]
    wave_calibration: tuple[float, ...]

    def calibration_at(self, froude_number: float) -> float:
        """The factor at any Froude number: linear between the conditions, constant outside."""
        return float(np.interp(froude_number, self.froude_numbers, self.wave_calibration))


def basis_for(case: Case, level: int) -> Basis:
    """The basis of a case at a level.

    Raises:
        SolverFailure: the initial design's form or waves cannot be computed.
    """
    volume = initial_volume(case)
    froude_numbers = case.conditions.froude_numbers
    return Basis(
        displaced_volume=volume,
        speeds=tuple(froude * (case.constants.gravity * case.initial.length) ** 0.5 for froude in froude_numbers),
        froude_numbers=froude_numbers,
        wave_calibration=_wave_calibration(case, volume) if level == 1 else (1.0,) * len(froude_numbers),
    )


@dataclass(frozen=True)
class Physics:
    """A design's numbers before they are normalised.

    Attributes:
        hull, propeller: the shapes.
        conditions: one a condition of the case.
        curve: the propeller's open-water curve.
        effective_volume: in m3; booked with the affine form, else the hull's own.
        effective_block_coefficient: likewise.
        warnings: of the solvers.
    """

    hull: Hull
    propeller: Propeller
    conditions: tuple[ConditionResult, ...]
    curve: PropellerCurve
    effective_volume: float
    effective_block_coefficient: float
    warnings: tuple[str, ...]


def compute(case: Case, variables: DesignVariables, level: int, basis: Basis) -> Physics:
    """A design's physics at a level.

    Raises:
        SolverFailure: the form, the propeller or a solver's answer is not to be had.
    """
    constants = case.constants
    hull_key = hull_variables(case.hull, variables, basis.displaced_volume)
    hull = build_hull(hull_key)
    if case.conditions.speed == "fixed":
        froude_numbers = tuple(speed / (constants.gravity * hull.length) ** 0.5 for speed in basis.speeds)
    else:
        froude_numbers = basis.froude_numbers
    propeller_key = propeller_variables(case.propeller, variables)
    propeller = build_propeller(propeller_key)
    answer = propeller_answer(propeller_key, level, constants.propeller_roughness)
    waves = wave_answers(hull_key, level, froude_numbers)
    if case.hull.form == "affine":
        volume = basis.displaced_volume * variables.displacement_ratio
        block_coefficient = volume / (hull.length * hull.breadth * hull.draft)
    else:
        volume = hull.hydrostatics.displaced_volume
        block_coefficient = hull.hydrostatics.block_coefficient
    wake = wake_fraction(block_coefficient, constants.wake_formula)
    conditions = tuple(
        condition_result(
            case,
            resistance_point(
                hull,
                wave,
                froude,
                gravity=constants.gravity,
                density=constants.density,
                viscosity=constants.viscosity,
                form_factor=constants.form_factor,
                wave_calibration=basis.calibration_at(froude),
            ),
            weight,
            wake,
            hull,
            propeller,
            answer,
        )
        for froude, wave, weight in zip(froude_numbers, waves, case.conditions.weights, strict=True)
    )
    # A solver tells everything of one call with each of its answers.
    warnings = tuple(dict.fromkeys(line for wave in waves for line in wave.warnings))
    return Physics(hull, propeller, conditions, answer.curve, volume, block_coefficient, warnings)


def _wave_calibration(case: Case, volume: float) -> tuple[float, ...]:
    """Level 1's factors: level 2's (or the stated) wave resistance of the initial design over Michell's."""
    froude_numbers = case.conditions.froude_numbers
    if case.constants.wave_calibration == "none":
        return (1.0,) * len(froude_numbers)
    key = hull_variables(case.hull, case.initial.variables, volume)
    if case.constants.wave_calibration == "stated":
        wanted = case.constants.stated_wave_coefficients
    else:
        wanted = tuple(answer.wave_coefficient for answer in wave_answers(key, 2, froude_numbers))
    thin_ship = wave_answers(key, 1, froude_numbers)
    return tuple(value / answer.wave_coefficient for value, answer in zip(wanted, thin_ship, strict=True))
