"""The physics of one operating condition: resistance and propeller in equilibrium, and the blades' cavitation."""

from __future__ import annotations

import math

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.hull_propulsion import PropulsionFactors
from hpsop_core.evaluation.propeller_answer import PropellerAnswer
from hpsop_core.evaluation.ship import running_point
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro import cavitation
from hpsop_core.hydro.operating_point import OperatingPoint, match
from hpsop_core.hydro.powering import powers


def condition_result(
    case: Case,
    point: ResistancePoint,
    weight: float,
    factors: PropulsionFactors,
    hull: Hull,
    propeller: Propeller,
    answer: PropellerAnswer,
) -> ConditionResult:
    """A design at one condition.

    Args:
        case: its constants.
        point: the hull's resistance at the condition's speed.
        weight: the condition's.
        factors: w, t and eta_R at this condition.
        hull, propeller: the design's.
        answer: the propeller's open-water curve, at level 2 with its blade pressures.

    Raises:
        SolverFailure: the propeller cannot drive the ship at this speed.
    """
    constants = case.constants
    wake, deduction = factors.wake_fraction, factors.thrust_deduction
    operating = match(
        answer.curve,
        point.total_resistance,
        wake,
        deduction,
        constants.density,
        point.speed,
        propeller.diameter,
        factors.relative_rotative_efficiency,
    )
    power = powers(
        total_resistance=point.total_resistance,
        speed=point.speed,
        wake=wake,
        deduction=deduction,
        delivered_power=operating.delivered_power,
        sea_margin=constants.sea_margin,
        shaft_efficiency=constants.shaft_efficiency,
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
    sigma = cavitation.cavitation_number(
        margin, constants.density, advance_speed, operating.rotation_rate, propeller.diameter
    )
    running = running_point(case.engine, power.brake, operating.rotation_rate)
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
        required_expanded_area_ratio=_required_area_ratio(case, propeller, operating, margin, advance_speed, sigma),
        wave_calibration=point.wave_calibration,
        cavitation_number=sigma,
        reynolds_number_07R=section_speed * _chord_07r(propeller) / constants.viscosity,
        blade_cavitation_margin=blades.margin if blades else None,
        blade_minimum_pressure_coefficient=blades.minimum_pressure_coefficient if blades else None,
        blade_cavitation_radius_ratio=blades.radius_ratio if blades else None,
        blade_cavitating_share=blades.cavitating_share if blades else None,
        wave_coefficient_pressure=point.wave_coefficient_pressure,
        sinkage=point.sinkage,
        trim=point.trim,
        form_resistance=point.form_resistance,
        correlation_resistance=point.correlation_resistance,
        air_resistance=point.air_resistance,
        appendage_resistance=point.appendage_resistance,
        effective_power=power.effective,
        hull_efficiency=power.hull_efficiency,
        relative_rotative_efficiency=factors.relative_rotative_efficiency,
        propulsive_efficiency=power.propulsive_efficiency,
        brake_power=power.brake,
        engine_load=running.load,
        engine_excess=running.excess,
        fuel_rate=running.fuel_rate,
    )


def _required_area_ratio(
    case: Case,
    propeller: Propeller,
    operating: OperatingPoint,
    margin: float,
    advance_speed: float,
    sigma: float,
) -> float:
    """Least expanded area ratio by the case's criterion."""
    if case.constraints.cavitation_criterion == "burrill":
        pressure = cavitation.section_dynamic_pressure(
            case.constants.density, advance_speed, operating.rotation_rate, propeller.diameter
        )
        return cavitation.burrill_expanded_area_ratio(
            operating.thrust, propeller.diameter, propeller.pitch_diameter_ratio_07R, pressure, sigma
        )
    return cavitation.keller_expanded_area_ratio(
        propeller.blade_count, operating.thrust, propeller.diameter, margin, case.constraints.keller_k
    )


def _chord_07r(propeller: Propeller) -> float:
    """Chord length at 0.7 R in m."""
    return float(propeller.table.at_07R.chord_ratio) * propeller.diameter
