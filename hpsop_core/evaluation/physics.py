"""The physics of a design at a level, not normalised: form, resistance, wake, open-water curve, every condition."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import DesignNumbers, HullResult, PropellerResult
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation import shipped_calibration
from hpsop_core.evaluation.condition import condition_result
from hpsop_core.evaluation.hull_answer import (
    HullVariables,
    build_hull,
    hull_variables,
    resistance_point,
    trial_wave_answers,
    wave_answers,
)
from hpsop_core.evaluation.hull_propulsion import (
    HoltropNumbers,
    holtrop_hull,
    holtrop_numbers,
    holtrop_warnings,
    propulsion_factors,
    resistance_factors,
    unused_statements,
    uses_holtrop,
)
from hpsop_core.evaluation.levels import TRUTH, Level, WaveAnswer, level_of
from hpsop_core.evaluation.propeller_answer import (
    PropellerAnswer,
    blade_drag,
    build_propeller,
    finer_propeller_answer,
    propeller_answer,
    propeller_variables,
)
from hpsop_core.evaluation.propeller_tables import PropellerTables
from hpsop_core.evaluation.shapes import initial_volume
from hpsop_core.evaluation.ship import Loading, loading
from hpsop_core.evaluation.surface import Surface, Told
from hpsop_core.evaluation.wave_correction import WaveCorrection, learn_correction, own_froude_numbers
from hpsop_core.geometry.clearance import baseline_clearance, propeller_clearance
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.hydro.holtrop import HoltropHull
from hpsop_core.hydro.operating_point import PropellerCurve
from hpsop_core.hydro.powering import ResistanceFactors


@dataclass(frozen=True)
class Basis:
    """What every design's physics takes from the initial one.

    Attributes:
        displaced_volume: V0 in m3, which the displacement ratio refers to.
        speeds: the initial design's at the case's Froude numbers, in m/s.
        froude_numbers: the case's.
        wave_calibration: factors on level 1's wave resistance at these Froude numbers; ones at level 2.
        holtrop: what Holtrop's formulas give for the initial design; None where the case does not use them.
        correction: with wave_calibration = learnt, at level 1: what gives each hull factors of its own.
    """

    displaced_volume: float
    speeds: tuple[float, ...]
    froude_numbers: tuple[float, ...]
    wave_calibration: tuple[float, ...]
    holtrop: HoltropNumbers | None = None
    correction: WaveCorrection | None = None

    def calibration_at(self, froude_number: float) -> float:
        """The factor at any Froude number: linear between the conditions, constant outside."""
        return float(np.interp(froude_number, self.froude_numbers, self.wave_calibration))

    def calibration_of(self, case: Case, hull: Hull, variables: DesignVariables) -> Callable[[float], float]:
        """The factor of one hull over its Froude number, likewise between its own conditions."""
        if self.correction is None:
            return self.calibration_at
        own = own_froude_numbers(case, hull, self.speeds)
        factors = self.correction.factors(hull, variables, own)
        return lambda froude_number: float(np.interp(froude_number, own, factors))


def basis_for(case: Case, level: int) -> Basis:
    """The basis of a case at a level.

    Raises:
        SolverFailure: the initial design's form or waves cannot be computed.
    """
    volume = initial_volume(case)
    return Basis(
        displaced_volume=volume,
        speeds=case.speeds,
        froude_numbers=case.froude_numbers,
        wave_calibration=_wave_calibration(case, level_of(level), volume),
        holtrop=_initial_holtrop(case, volume),
        correction=_correction(case, level_of(level), volume),
    )


def _initial_holtrop(case: Case, volume: float) -> HoltropNumbers | None:
    if not uses_holtrop(case.constants):
        return None
    design = case.initial.variables
    hull = build_hull(hull_variables(case.hull, design, volume))
    ship = holtrop_hull(hull, _counted_volume(case, design, hull, volume), case.constants)
    return holtrop_numbers(ship, design.diameter, design.expanded_area_ratio, case.speeds, case.constants.viscosity)


def _counted_volume(case: Case, variables: DesignVariables, hull: Hull, initial_volume: float) -> float:
    """Displacement in m3 as the case counts it: booked with the affine form, else the hull's own."""
    if case.hull.form == "affine":
        return initial_volume * variables.displacement_ratio
    return hull.hydrostatics.displaced_volume


def design_factors(
    case: Case, variables: DesignVariables, hull: Hull, basis: Basis, form_factor: float | None = None
) -> tuple[ResistanceFactors, HoltropHull | None]:
    """What makes a design's resistance beside friction and waves; with Holtrop's method, the hull as it sees it.

    Args:
        case: what it states.
        variables, hull: the design.
        basis: of the case.
        form_factor: k instead of the case's.

    Raises:
        SolverFailure: Holtrop's formulas have no value for this form.
    """
    ship = None
    if uses_holtrop(case.constants):
        volume = _counted_volume(case, variables, hull, basis.displaced_volume)
        ship = holtrop_hull(hull, volume, case.constants)
    return resistance_factors(case, hull, ship, basis.holtrop, form_factor), ship


@dataclass(frozen=True)
class Physics:
    """A design's physics before anything is normalised.

    Attributes:
        numbers: of hull, propeller and conditions.
        curve: the propeller's open-water curve.
        warnings: of the form and of the solvers.
        predicted: a learnt surface spoke for the solvers.
        propeller_tabulated: the open-water curve comes from a search's table, see ``propeller_tables``.
    """

    numbers: DesignNumbers
    curve: PropellerCurve
    warnings: tuple[str, ...]
    predicted: bool = False
    propeller_tabulated: bool = False


def compute(
    case: Case,
    variables: DesignVariables,
    level: int,
    basis: Basis,
    surface: Surface | None = None,
    propellers: PropellerTables | None = None,
) -> Physics:
    """A design's physics at a level.

    Args:
        case, variables, level: what is asked.
        basis: the case's at this level.
        surface: asked before the solvers; they decide where it is in doubt, and where it says that the design fails.
        propellers: at level 1, asked before the lifting line.

    Raises:
        SolverFailure: the form, the propeller or a solver's answer is not to be had.
    """
    hull_key = hull_variables(case.hull, variables, basis.displaced_volume)
    hull = build_hull(hull_key)
    froude_numbers = own_froude_numbers(case, hull, basis.speeds)
    propeller_key = propeller_variables(case.propeller, variables)
    assembled = partial(_assembled, case, variables, level, basis, froude_numbers, hull)
    if surface is not None:
        # What it says may fail for want of thrust: then it is the solvers that say so.
        with contextlib.suppress(SolverFailure):
            told = surface.answers(hull, variables, froude_numbers, propeller_key)
            guess = _predicted(case, variables, level, surface, told, assembled)
            if guess is not None:
                return guess
    tabulated = None if propellers is None else propellers.answer(propeller_key)
    answer = tabulated or propeller_answer(propeller_key, level, blade_drag(case.constants))
    physics = assembled(wave_answers(hull_key, level, froude_numbers), answer)
    return replace(physics, propeller_tabulated=tabulated is not None)


def _predicted(
    case: Case,
    variables: DesignVariables,
    level: int,
    surface: Surface,
    told: Told | None,
    assembled: Callable[..., Physics],
) -> Physics | None:
    """A design's physics as a surface tells it; None where it is in doubt.

    Raises:
        SolverFailure: the design fails, if the surface is right.
    """
    if told is None:
        return None
    guess = assembled(told.waves, told.propeller, predicted=True)
    if not told.is_sure(guess.numbers.conditions):
        return None
    if case.constraints.back_cavitation_limit is None:
        return guess
    conditions = surface.back_told(case, variables, guess.numbers.conditions)
    if conditions is not None:
        return replace(guess, numbers=replace(guess.numbers, conditions=conditions))
    # Near to the limit it is the pressures themselves that decide.
    key = propeller_variables(case.propeller, variables)
    return assembled(told.waves, propeller_answer(key, level, blade_drag(case.constants)), predicted=True)


@dataclass(frozen=True)
class Trial:
    """What is done differently from ``compute`` at the true level, to see what it is worth.

    Attributes:
        waves: "finer" mesh, "wider" domain; "pressure": plus half of what the finer mesh's pressures exceed its
            momentum planes by; "" as ever.
        finer_blades: the propeller on finer panels.
        form_factor, wake_fraction: added to k and to w at every condition; t stays.
    """

    waves: Literal["", "finer", "wider", "pressure"] = ""
    finer_blades: bool = False
    form_factor: float = 0.0
    wake_fraction: float = 0.0


def compute_trial(case: Case, variables: DesignVariables, basis: Basis, trial: Trial) -> Physics:
    """A design's physics at the true level with something done differently.

    Raises:
        SolverFailure: as ``compute``.
    """
    hull_key = hull_variables(case.hull, variables, basis.displaced_volume)
    hull = build_hull(hull_key)
    froude_numbers = own_froude_numbers(case, hull, basis.speeds)
    propeller_key = propeller_variables(case.propeller, variables)
    drag = blade_drag(case.constants)
    if trial.finer_blades:
        answer = finer_propeller_answer(propeller_key, drag)
    else:
        answer = propeller_answer(propeller_key, TRUTH.number, drag)
    waves = _trial_waves(hull_key, froude_numbers, trial)
    return _assembled(case, variables, TRUTH.number, basis, froude_numbers, hull, waves, answer, trial=trial)


def _trial_waves(key: HullVariables, froude_numbers: tuple[float, ...], trial: Trial) -> tuple[WaveAnswer, ...]:
    if trial.waves in ("finer", "wider"):
        return trial_wave_answers(key, froude_numbers, trial.waves)
    plain = wave_answers(key, TRUTH.number, froude_numbers)
    if trial.waves != "pressure":
        return plain
    finer = trial_wave_answers(key, froude_numbers, "finer")
    return tuple(
        replace(own, wave_coefficient=own.wave_coefficient + 0.5 * (pressure - other.wave_coefficient))
        if (pressure := other.wave_coefficient_pressure) is not None
        else own
        for own, other in zip(plain, finer, strict=True)
    )


def _assembled(
    case: Case,
    variables: DesignVariables,
    level: int,
    basis: Basis,
    froude_numbers: tuple[float, ...],
    hull: Hull,
    waves: tuple[WaveAnswer, ...],
    answer: PropellerAnswer,
    predicted: bool = False,
    trial: Trial | None = None,
) -> Physics:
    """What follows from the answers about waves and propeller."""
    constants = case.constants
    propeller = build_propeller(propeller_variables(case.propeller, variables))
    volume = _counted_volume(case, variables, hull, basis.displaced_volume)
    if case.hull.form == "affine":
        block_coefficient = volume / (hull.length * hull.breadth * hull.draft)
    else:
        block_coefficient = hull.hydrostatics.block_coefficient
    resistance, ship = design_factors(case, variables, hull, basis)
    own: HoltropNumbers | None = None
    cautions = unused_statements(constants)
    if ship is not None:
        speeds = tuple(froude * (constants.gravity * hull.length) ** 0.5 for froude in froude_numbers)
        own = holtrop_numbers(ship, propeller.diameter, propeller.expanded_area_ratio, speeds, constants.viscosity)
        cautions += holtrop_warnings(ship, speeds, constants.gravity)
    propulsion = propulsion_factors(constants, block_coefficient, len(froude_numbers), own, basis.holtrop)
    if trial is not None:
        resistance = replace(resistance, form_factor=resistance.form_factor + trial.form_factor)
        propulsion = tuple(
            replace(factors, wake_fraction=factors.wake_fraction + trial.wake_fraction) for factors in propulsion
        )
    calibration = basis.calibration_of(case, hull, variables)
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
                factors=resistance,
                wave_calibration=calibration(froude),
            ),
            weight,
            factors,
            hull,
            propeller,
            answer,
        )
        for froude, wave, weight, factors in zip(
            froude_numbers, waves, case.conditions.weights, propulsion, strict=True
        )
    )
    booked = (volume, block_coefficient) if case.hull.form == "affine" else None
    numbers = DesignNumbers(
        level=level,
        variables=variables,
        hull=_hull_result(hull, loading(case, hull), booked),
        propeller=PropellerResult(
            diameter=propeller.diameter,
            blade_count=propeller.blade_count,
            pitch_ratio=propeller.pitch_ratio,
            pitch_diameter_ratio_07R=propeller.pitch_diameter_ratio_07R,
            expanded_area_ratio=propeller.expanded_area_ratio,
            shaft_height=hull.shaft_height,
            tip_clearance=propeller_clearance(hull, propeller),
        ),
        conditions=conditions,
        baseline_clearance=baseline_clearance(hull, propeller),
        buoyancy_centre_missed=_centre_missed(hull, variables),
    )
    # A solver tells everything of one call with each of its answers.
    warnings = dict.fromkeys(line for wave in waves for line in wave.warnings)
    return Physics(numbers, answer.curve, (*hull.warnings, *warnings, *cautions), predicted)


def _hull_result(hull: Hull, loaded: Loading, booked: tuple[float, float] | None) -> HullResult:
    hydrostatics = hull.hydrostatics
    return HullResult(
        length=hull.length,
        breadth=hull.breadth,
        draft=hull.draft,
        block_coefficient=hydrostatics.block_coefficient,
        displaced_volume=hydrostatics.displaced_volume,
        wetted_surface=hydrostatics.wetted_surface,
        longitudinal_centre_of_buoyancy=hydrostatics.longitudinal_centre_of_buoyancy,
        clipped=hull.clipped,
        booked_block_coefficient=None if booked is None else booked[1],
        booked_volume=None if booked is None else booked[0],
        depth=hull.depth,
        displacement_mass=loaded.displacement_mass,
        midship_coefficient=hydrostatics.midship_coefficient,
        prismatic_coefficient=hydrostatics.prismatic_coefficient,
        waterplane_coefficient=hydrostatics.waterplane_coefficient,
        centre_of_buoyancy_height=hydrostatics.vertical_centre_of_buoyancy,
        metacentric_radius=hydrostatics.transverse_metacentric_radius,
        metacentre_height=hydrostatics.metacentre_height,
        centre_of_gravity_height=loaded.centre_of_gravity_height,
        metacentric_height=loaded.metacentric_height,
        lightship_mass=loaded.lightship_mass,
        deadweight=loaded.deadweight,
    )


def _centre_missed(hull: Hull, variables: DesignVariables) -> float:
    """How far the centre of buoyancy lies from the asked place, as a fraction of the length."""
    parent = hull.parent
    own = parent.hydrostatics.longitudinal_centre_of_buoyancy / parent.length + variables.buoyancy_centre_shift
    return abs(hull.hydrostatics.longitudinal_centre_of_buoyancy / hull.length - own)


def _correction(case: Case, level: Level, volume: float) -> WaveCorrection | None:
    if level.is_calibrated and case.constants.wave_calibration == "learnt":
        kept = shipped_calibration.shipped(case, shipped_calibration.LEARNT)
        return learn_correction(case, volume, case.speeds) if kept is None else WaveCorrection.from_dict(kept)
    return None


def initial_true_waves(case: Case, volume: float) -> tuple[float, ...]:
    """The true level's wave coefficients of the initial design; ``volume``: V0 in m3.

    Raises:
        SolverFailure: the solver cannot give a number.
    """
    key = hull_variables(case.hull, case.initial.variables, volume)
    return tuple(answer.wave_coefficient for answer in wave_answers(key, TRUTH.number, case.froude_numbers))


def _wave_calibration(case: Case, level: Level, volume: float) -> tuple[float, ...]:
    """The level's factors: level 2's (or the stated) wave resistance of the initial design over the level's own."""
    froude_numbers = case.froude_numbers
    if not level.is_calibrated or case.constants.wave_calibration == "none":
        return (1.0,) * len(froude_numbers)
    key = hull_variables(case.hull, case.initial.variables, volume)
    if case.constants.wave_calibration == "stated":
        wanted = case.constants.stated_wave_coefficients
    else:
        kept = shipped_calibration.shipped(case, shipped_calibration.INITIAL)
        wanted = initial_true_waves(case, volume) if kept is None else tuple(kept)
    own = wave_answers(key, level.number, froude_numbers)
    return tuple(value / answer.wave_coefficient for value, answer in zip(wanted, own, strict=True))
