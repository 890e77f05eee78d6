"""Design -> Evaluation at a level of fidelity; a failure is a value.

The chain is DESIGN section 3's: form, resistance at each condition, wake and thrust deduction, open-water curves,
operating points, then the objectives (normalised by the initial design at the same level) and the constraints.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.hull_answer import (
    HullVariables,
    ResistancePoint,
    build_hull,
    hull_variables,
    resistance_point,
    wave_answers,
)
from hpsop_core.evaluation.propeller_answer import (
    PropellerAnswer,
    build_propeller,
    propeller_answer,
    propeller_variables,
)
from hpsop_core.evaluation.result import (
    FEASIBILITY_TOLERANCE,
    ConditionResult,
    Evaluation,
    HullResult,
    OpenWaterCurve,
    PropellerResult,
    failed_evaluation,
)
from hpsop_core.geometry.clearance import baseline_clearance, propeller_clearance
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro import cavitation
from hpsop_core.hydro.interaction import thrust_deduction, wake_fraction
from hpsop_core.hydro.operating_point import PropellerCurve, match
from hpsop_core.one_thread import one_blas_thread

LEVELS = (1, 2)
CURVE_STEP = 0.05


@dataclass(frozen=True)
class Reference:
    """What a case's objectives are normalised with at a level; computed once, shipped to every worker.

    Attributes:
        level: 1 or 2.
        displaced_volume: V0, the initial design's displacement in m3 (booked with the affine form).
        speeds: the initial design's speeds at the case's Froude numbers, in m/s.
        froude_numbers: the case's.
        wave_calibration: factors on level 1's wave resistance at these Froude numbers; ones at level 2.
        total_resistance, efficiency, delivered_power: the initial design's, one a condition.
    """

    level: int
    displaced_volume: float
    speeds: tuple[float, ...]
    froude_numbers: tuple[float, ...]
    wave_calibration: tuple[float, ...]
    total_resistance: tuple[float, ...]
    efficiency: tuple[float, ...]
    delivered_power: tuple[float, ...]

    def as_dict(self) -> dict[str, Any]:
        """For the run file."""
        return {key: list(v) if isinstance(v, tuple) else v for key, v in asdict(self).items()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Reference:
        """The reference that ``as_dict`` described, to the last bit."""
        values: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in data.items()}
        return cls(**values)

    def calibration_at(self, froude_number: float) -> float:
        """The factor at any Froude number: linear between the conditions, constant outside."""
        return float(np.interp(froude_number, self.froude_numbers, self.wave_calibration))


@dataclass(frozen=True)
class _Physics:
    """A design's numbers before they are normalised."""

    hull: Hull
    propeller: Propeller
    conditions: tuple[ConditionResult, ...]
    curve: PropellerCurve
    effective_volume: float
    effective_block_coefficient: float
    warnings: tuple[str, ...]


@one_blas_thread()
def evaluate(
    case: Case, variables: DesignVariables | None = None, level: int = 1, reference: Reference | None = None
) -> Evaluation:
    """Everything about a design at a level.

    Args:
        case: what is optimised.
        variables: the design; the initial one by default.
        level: 1 (Michell, lifting line) or 2 (Rankine and blade panels).
        reference: the initial design's numbers at this level; computed when it is not given.

    Returns:
        The evaluation. It never raises for a design that cannot be computed: status is then "failed".

    Raises:
        ValueError: level is neither 1 nor 2, or the reference belongs to the other level.
        InputError: a file that the case names cannot be used.
    """
    if level not in LEVELS:
        raise ValueError(f"level {level} is neither 1 nor 2")
    started = time.perf_counter()
    design = case.initial.variables if variables is None else variables
    try:
        basis = reference_for(case, level) if reference is None else reference
        if basis.level != level:
            raise ValueError(f"a reference of level {basis.level} cannot normalise level {level}")
        result = _assess(case, design, level, basis, _compute(case, design, level, basis))
        return replace(result, elapsed=time.perf_counter() - started)
    except SolverFailure as failure:
        elapsed = time.perf_counter() - started
        return failed_evaluation(case.name, design, level, failure.stage, failure.reason, elapsed)


@one_blas_thread()
def reference_for(case: Case, level: int) -> Reference:
    """The initial design's numbers at a level, and level 1's wave calibration.

    Raises:
        SolverFailure: the initial design itself cannot be computed at this level.
    """
    volume = initial_volume(case)
    speeds = tuple(froude * (case.constants.gravity * case.initial.length) ** 0.5 for froude in _froude_numbers(case))
    count = len(speeds)
    start = Reference(
        level=level,
        displaced_volume=volume,
        speeds=speeds,
        froude_numbers=_froude_numbers(case),
        wave_calibration=_wave_calibration(case, volume) if level == 1 else (1.0,) * count,
        total_resistance=(1.0,) * count,
        efficiency=(1.0,) * count,
        delivered_power=(1.0,) * count,
    )
    conditions = _compute(case, case.initial.variables, level, start).conditions
    return Reference(
        **{
            **start.__dict__,
            "total_resistance": tuple(condition.total_resistance for condition in conditions),
            "efficiency": tuple(condition.open_water_efficiency for condition in conditions),
            "delivered_power": tuple(condition.delivered_power for condition in conditions),
        }
    )


def initial_volume(case: Case) -> float:
    """V0: the parent's displacement at the initial design's dimensions, times its displacement ratio, in m3."""
    initial = case.initial
    scaled = build_hull(HullVariables(case.hull, initial.length, initial.breadth, initial.draft, None, 0.0))
    return scaled.hydrostatics.displaced_volume * initial.displacement_ratio


def design_hull(case: Case, variables: DesignVariables) -> Hull:
    """The hull of a design of the case, for views and exports.

    Raises:
        SolverFailure: the form cannot be made.
    """
    return build_hull(hull_variables(case.hull, variables, initial_volume(case)))


def design_propeller(case: Case, variables: DesignVariables) -> Propeller:
    """The propeller of a design of the case, for views and exports.

    Raises:
        SolverFailure: the family does not reach it.
    """
    return build_propeller(propeller_variables(case.propeller, variables))


def resistance_curve(
    case: Case,
    variables: DesignVariables,
    level: int,
    froude_numbers: tuple[float, ...],
    reference: Reference | None = None,
    form_factor: float | None = None,
) -> tuple[ResistancePoint, ...]:
    """Resistance of a design at any Froude numbers (on its own length), calibrated as in its evaluation.

    Args:
        case: what is optimised.
        variables: the design.
        level: 1 or 2.
        froude_numbers: at which to compute.
        reference: of this level; only its V0 and calibration are used.
        form_factor: k; the case's by default.

    Raises:
        SolverFailure: the form or its waves cannot be computed.
    """
    if reference is None:
        volume = initial_volume(case)
        factors = _wave_calibration(case, volume) if level == 1 else (1.0,) * len(_froude_numbers(case))
    else:
        volume, factors = reference.displaced_volume, reference.wave_calibration
    key = hull_variables(case.hull, variables, volume)
    waves = wave_answers(key, level, tuple(froude_numbers))
    constants = case.constants
    return tuple(
        resistance_point(
            build_hull(key),
            wave,
            froude,
            gravity=constants.gravity,
            density=constants.density,
            viscosity=constants.viscosity,
            form_factor=constants.form_factor if form_factor is None else form_factor,
            wave_calibration=float(np.interp(froude, _froude_numbers(case), factors)),
        )
        for froude, wave in zip(froude_numbers, waves, strict=True)
    )


def _froude_numbers(case: Case) -> tuple[float, ...]:
    return case.conditions.froude_numbers


def _wave_calibration(case: Case, volume: float) -> tuple[float, ...]:
    """Level 1's factors: level 2's (or the stated) wave resistance of the initial design over Michell's."""
    froude_numbers = _froude_numbers(case)
    if case.constants.wave_calibration == "none":
        return (1.0,) * len(froude_numbers)
    key = hull_variables(case.hull, case.initial.variables, volume)
    if case.constants.wave_calibration == "stated":
        wanted = case.constants.stated_wave_coefficients
    else:
        wanted = tuple(answer.wave_coefficient for answer in wave_answers(key, 2, froude_numbers))
    thin_ship = wave_answers(key, 1, froude_numbers)
    return tuple(value / answer.wave_coefficient for value, answer in zip(wanted, thin_ship, strict=True))


def _compute(case: Case, variables: DesignVariables, level: int, basis: Reference) -> _Physics:
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
        _condition(
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
    return _Physics(hull, propeller, conditions, answer.curve, volume, block_coefficient, warnings)


def _condition(
    case: Case,
    point: ResistancePoint,
    weight: float,
    wake: float,
    hull: Hull,
    propeller: Propeller,
    answer: PropellerAnswer,
) -> ConditionResult:
    constants = case.constants
    deduction = thrust_deduction(wake, constants.thrust_deduction_factor)
    operating = match(
        answer.curve,
        point.total_resistance,
        wake,
        deduction,
        constants.density,
        point.speed,
        propeller.diameter,
        constants.relative_rotative_efficiency,
    )
    margin = cavitation.pressure_margin(
        hull.draft - hull.shaft_height,
        constants.density,
        constants.gravity,
        constants.atmospheric_pressure,
        constants.vapour_pressure,
    )
    advance_speed = (1.0 - wake) * point.speed
    section_speed = math.hypot(advance_speed, 0.7 * math.pi * operating.rotation_rate * propeller.diameter)
    blades = (
        None
        if answer.pressures is None
        else answer.pressures.margin(
            operating.advance_coefficient,
            propeller.diameter,
            operating.rotation_rate,
            constants.density,
            margin,
            constants.gravity,
        )
    )
    return ConditionResult(
        froude_number=point.froude_number,
        weight=weight,
        speed=point.speed,
        friction_resistance=point.friction_resistance,
        wave_resistance=point.wave_resistance,
        total_resistance=point.total_resistance,
        wave_coefficient=point.wave_coefficient,
        wake_fraction=wake,
        thrust_deduction=deduction,
        advance_coefficient=operating.advance_coefficient,
        rotation_rate_rpm=60.0 * operating.rotation_rate,
        thrust=operating.thrust,
        torque=operating.torque,
        thrust_coefficient=operating.thrust_coefficient,
        torque_coefficient=operating.torque_coefficient,
        open_water_efficiency=operating.open_water_efficiency,
        delivered_power=operating.delivered_power,
        required_expanded_area_ratio=cavitation.keller_expanded_area_ratio(
            propeller.blade_count, operating.thrust, propeller.diameter, margin, case.constraints.keller_k
        ),
        wave_calibration=point.wave_calibration,
        cavitation_number=cavitation.cavitation_number(
            margin, constants.density, advance_speed, operating.rotation_rate, propeller.diameter
        ),
        reynolds_number_07R=section_speed * _chord_07r(propeller) / constants.viscosity,
        blade_cavitation_margin=blades.margin if blades else None,
        blade_minimum_pressure_coefficient=blades.minimum_pressure_coefficient if blades else None,
        blade_cavitation_radius_ratio=blades.radius_ratio if blades else None,
        blade_cavitating_share=blades.cavitating_share if blades else None,
        wave_coefficient_pressure=point.wave_coefficient_pressure,
        sinkage=point.sinkage,
        trim=point.trim,
    )


def _chord_07r(propeller: Propeller) -> float:
    """Chord length at 0.7 R in m."""
    return float(propeller.table.at(np.array(0.7)).chord_ratio) * propeller.diameter


def _assess(case: Case, variables: DesignVariables, level: int, basis: Reference, physics: _Physics) -> Evaluation:
    hull, propeller, conditions = physics.hull, physics.propeller, physics.conditions
    clearance = propeller_clearance(hull, propeller)
    constraints = _constraints(case, level, variables, basis, physics, clearance)
    objectives = _objectives(basis, physics)
    affine = case.hull.form == "affine"
    warnings = [*hull.warnings, *physics.warnings]
    if clearance < 0.0:
        warnings.append(f"the propeller would cut the hull: tip clearance {clearance:.2f} m; reduce its diameter")
    if baseline_clearance(hull, propeller) < 0.0:
        warnings.append("the blade tips reach below the baseline; reduce the diameter or raise the draft")
    if constraints["form"] is not None and constraints["form"] > FEASIBILITY_TOLERANCE and affine:
        warnings.append(f"booked block coefficient {physics.effective_block_coefficient:.3f} is outside its limits")
    hydrostatics = hull.hydrostatics
    return Evaluation(
        case=case.name,
        level=level,
        status="ok",
        reason="",
        variables=variables,
        hull=HullResult(
            length=hull.length,
            breadth=hull.breadth,
            draft=hull.draft,
            block_coefficient=hydrostatics.block_coefficient,
            displaced_volume=hydrostatics.displaced_volume,
            wetted_surface=hydrostatics.wetted_surface,
            longitudinal_centre_of_buoyancy=hydrostatics.longitudinal_centre_of_buoyancy,
            clipped=hull.clipped,
            booked_block_coefficient=physics.effective_block_coefficient if affine else None,
            booked_volume=physics.effective_volume if affine else None,
        ),
        propeller=PropellerResult(
            diameter=propeller.diameter,
            blade_count=propeller.blade_count,
            pitch_ratio=propeller.pitch_ratio,
            pitch_diameter_ratio_07R=propeller.pitch_diameter_ratio_07R,
            expanded_area_ratio=propeller.expanded_area_ratio,
            shaft_height=hull.shaft_height,
            tip_clearance=clearance,
        ),
        conditions=conditions,
        objectives={"f1": objectives[case.objectives.first], "f2": objectives[case.objectives.second]},
        all_objectives=objectives,
        constraints=constraints,
        feasible=all(value <= FEASIBILITY_TOLERANCE for value in constraints.values() if value is not None),
        warnings=tuple(warnings),
        open_water=_open_water_curve(physics.curve),
    )


def _objectives(basis: Reference, physics: _Physics) -> dict[str, float]:
    """Every objective of DESIGN section 3, all minimised, 1 for the initial design (the cavitation margin aside)."""
    conditions = physics.conditions
    first = conditions[0]
    area_ratio = physics.propeller.expanded_area_ratio
    return {
        "resistance": math.fsum(
            c.weight * c.total_resistance / r for c, r in zip(conditions, basis.total_resistance, strict=True)
        ),
        "efficiency": math.fsum(
            c.weight * e / c.open_water_efficiency for c, e in zip(conditions, basis.efficiency, strict=True)
        ),
        "delivered_power": math.fsum(
            c.weight * c.delivered_power / p for c, p in zip(conditions, basis.delivered_power, strict=True)
        ),
        "displacement": basis.displaced_volume / physics.effective_volume,
        "cavitation_margin": 1.0 - (area_ratio - first.required_expanded_area_ratio) / area_ratio,
    }


def _constraints(
    case: Case, level: int, variables: DesignVariables, basis: Reference, physics: _Physics, clearance: float
) -> dict[str, float | None]:
    """g <= 0 by name; the last two are ours: a form that is not reached, and blades that would cut the hull."""
    limits = case.constraints
    ratio = physics.propeller.diameter / physics.hull.draft
    asked = basis.displaced_volume * variables.displacement_ratio
    if case.hull.form == "affine":
        block = physics.effective_block_coefficient
        form = max(limits.booked_block_coefficient_lower - block, block - limits.booked_block_coefficient_upper)
    elif physics.hull.clipped:
        # At least visibly infeasible: the form is not the one that was asked for, even where its volume is close.
        form = max(abs(physics.effective_volume / asked - 1.0), _centre_missed(physics.hull, variables), 1e-4)
    else:
        form = 0.0
    cavitation_excess = None
    if level >= limits.g3_level:
        first = physics.conditions[0]
        cavitation_excess = first.required_expanded_area_ratio - physics.propeller.expanded_area_ratio
    return {
        "displacement": abs(physics.effective_volume / basis.displaced_volume - 1.0) - limits.displacement_tolerance,
        "diameter_to_draft": max(limits.diameter_to_draft_lower - ratio, ratio - limits.diameter_to_draft_upper),
        "cavitation": cavitation_excess,
        "form": form,
        "propeller_clearance": -min(clearance, baseline_clearance(physics.hull, physics.propeller))
        / physics.propeller.diameter,
    }


def _centre_missed(hull: Hull, variables: DesignVariables) -> float:
    """How far the centre of buoyancy of a clipped form lies from the asked place, as a fraction of the length."""
    parent = hull.parent
    own = parent.hydrostatics.longitudinal_centre_of_buoyancy / parent.length + variables.buoyancy_centre_shift
    return abs(hull.hydrostatics.longitudinal_centre_of_buoyancy / hull.length - own)


def _open_water_curve(curve: PropellerCurve) -> OpenWaterCurve:
    lower, upper = curve.range
    advance = np.arange(lower, upper + 0.5 * CURVE_STEP, CURVE_STEP)
    thrust, torque = curve.coefficients(advance)
    # Beyond zero thrust the quotient of two small numbers means nothing: no useful work is done there.
    efficiency = np.where(thrust > 0.0, advance * thrust / (2.0 * math.pi * torque), 0.0)
    return OpenWaterCurve(*(tuple(float(value) for value in row) for row in (advance, thrust, torque, efficiency)))
