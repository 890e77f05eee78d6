"""What makes a hull and a propeller a ship: weights, stability, and the engine's part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.design_numbers import ConditionResult, DesignNumbers
from hpsop_core.case.ship import EngineSection, kilograms_per_joule
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.machinery.energy_efficiency import MAIN_ENGINE_LOAD, attained_eedi, speed_at_power
from hpsop_core.machinery.engine import Engine
from hpsop_core.units import written

# No design of a search saves half of the initial design's power: bounds reach some ten per cent around it.
_HOPELESS = 2.0


@lru_cache(maxsize=8)
def engine_of(section: EngineSection) -> Engine | None:
    """The engine that a case states; None where it states none."""
    if section.maximum_continuous_rating is None:
        return None
    rate = section.rated_rotation_rate_rpm
    return Engine(
        section.maximum_continuous_rating,
        None if rate is None else rate / 60.0,
        section.load_fractions,
        tuple(kilograms_per_joule(value) for value in section.specific_fuel_consumptions),
    )


@dataclass(frozen=True)
class RunningPoint:
    """An engine at one condition: load, excess over the layout, fuel in kg/s; None where it is not known."""

    load: float | None = None
    excess: float | None = None
    fuel_rate: float | None = None


def running_point(section: EngineSection, brake_power: float, rotation_rate: float) -> RunningPoint:
    """The case's engine at a brake power in W and a rate of revolutions in 1/s."""
    engine = engine_of(section)
    if engine is None:
        return RunningPoint()
    return RunningPoint(
        engine.load(brake_power), engine.excess(brake_power, rotation_rate), engine.fuel_rate(brake_power)
    )


@dataclass(frozen=True)
class Loading:
    """Weights and centre of gravity of a design.

    Attributes:
        displacement_mass: in kg.
        centre_of_gravity_height, metacentric_height: KG and GM in m; None where the case states no KG.
        lightship_mass, deadweight: in kg; None where the case states no lightship.
    """

    displacement_mass: float
    centre_of_gravity_height: float | None
    metacentric_height: float | None
    lightship_mass: float | None
    deadweight: float | None


def loading(case: Case, hull: Hull) -> Loading:
    """A design's loading: KG in proportion to depth, the lightship in proportion to L B depth.

    Depth scales with the draft, so that only its ratio to the initial design's enters, which every parent hull knows.

    Raises:
        SolverFailure: the lightship is heavier than the displacement.
    """
    initial, stated = case.initial, case.loading
    mass = case.constants.density * hull.hydrostatics.displaced_volume
    depth = hull.draft / initial.draft
    gravity = None if stated.centre_of_gravity_height is None else stated.centre_of_gravity_height * depth
    lightship = None
    if stated.lightship_mass is not None:
        box = hull.length / initial.length * (hull.breadth / initial.breadth) * depth
        lightship = stated.lightship_mass * box
        if lightship >= mass:
            raise SolverFailure(
                "loading",
                f"the lightship of {1e-3 * lightship:.5g} t is no lighter than the displacement of {1e-3 * mass:.5g} t",
            )
    return Loading(
        displacement_mass=mass,
        centre_of_gravity_height=gravity,
        metacentric_height=None if gravity is None else hull.hydrostatics.metacentre_height - gravity,
        lightship_mass=lightship,
        deadweight=None if lightship is None else mass - lightship,
    )


def check_loading(case: Case, hull: Hull) -> None:
    """Refuse a case whose initial design would not float upright.

    Args:
        hull: the initial design's.

    Raises:
        InputError: KG is not below the metacentre, or the lightship not below the displacement.
    """
    stated, metacentre = case.loading, hull.hydrostatics.metacentre_height
    if stated.centre_of_gravity_height is not None and stated.centre_of_gravity_height >= metacentre:
        raise InputError(
            f"loading: centre_of_gravity_height {stated.centre_of_gravity_height:g} m is not below the initial "
            f"design's metacentre at {metacentre:.2f} m (KB + BM): it would capsize; lower it"
        )
    mass = case.constants.density * hull.hydrostatics.displaced_volume
    if stated.lightship_mass is not None and stated.lightship_mass >= mass:
        raise InputError(
            f"loading: lightship_mass {stated.lightship_mass:g} kg is no lighter than the initial design's "
            f"displacement of {mass:.4g} kg; state the ship without cargo and fuel, in kg"
        )


def check_engine(case: Case, initial: DesignNumbers) -> None:
    """Refuse an engine that no design of the case can be driven by.

    Args:
        initial: the initial design's numbers.

    Raises:
        InputError: less than half of the power that the initial design needs.
    """
    loads = [(condition.engine_load or 0.0, condition.speed) for condition in initial.conditions]
    load, speed = max(loads)
    rating = case.engine.maximum_continuous_rating
    if rating is not None and load > _HOPELESS:
        needed = 1e-6 * load * rating
        digit = 10.0 ** (math.floor(math.log10(needed)) - 1)
        enough = digit * math.ceil(needed / digit)  # rounded up: what is said to be enough is
        raise InputError(
            f"engine: maximum_continuous_rating {rating:g} W is smaller than any design needs: the initial one takes "
            f"{written(needed, 'MW', 2)} at {speed / KNOT:.2f} kn; state at least {1e6 * enough:.2g} W or lower the "
            "speeds"
        )


def profile_eedi(case: Case, design: DesignNumbers) -> float | None:
    """The attained EEDI in g/(t nm); None where engine, consumption, deadweight or the power at 75 % MCR is unknown.

    The speed at 75 % of the rating is read between the conditions' powers in calm water.
    """
    engine, capacity = engine_of(case.engine), design.hull.deadweight
    if engine is None or capacity is None:
        return None
    power = MAIN_ENGINE_LOAD * engine.maximum_continuous_rating
    consumption = engine.specific_fuel_consumption(power)
    speed = speed_at_power(power, *calm_water(design.conditions, case.constants.shaft_efficiency))
    if consumption is None or speed is None:
        return None
    return attained_eedi(
        maximum_continuous_rating=engine.maximum_continuous_rating,
        specific_fuel_consumption=consumption,
        carbon_factor=case.engine.fuel_carbon_factor,
        auxiliary_specific_fuel_consumption=kilograms_per_joule(case.engine.auxiliary_specific_fuel_consumption),
        auxiliary_carbon_factor=case.engine.fuel_carbon_factor,
        capacity=case.loading.capacity_share * capacity,
        reference_speed=speed,
    )


def calm_water(conditions: Sequence[ConditionResult], shaft_efficiency: float) -> tuple[list[float], list[float]]:
    """Speeds in m/s and brake powers in W without sea margin."""
    powers = [condition.delivered_power / shaft_efficiency for condition in conditions]
    return [condition.speed for condition in conditions], powers


def ship_warnings(case: Case, design: DesignNumbers) -> list[str]:
    """What a reader must know of a design's stability and of its engine."""
    warnings = []
    hull, engine = design.hull, engine_of(case.engine)
    height, metacentre = hull.centre_of_gravity_height, hull.metacentre_height
    if height is not None and metacentre is not None and height >= metacentre:
        warnings.append(
            f"the centre of gravity (KG {height:.2f} m) is not below the metacentre (KM {metacentre:.2f} m): the ship "
            "would capsize"
        )
    if engine is None:
        return warnings
    for condition in design.conditions:
        load, rate = condition.engine_load or 0.0, condition.rotation_rate_rpm / 60.0
        power, speed = load * engine.maximum_continuous_rating, f"at {condition.speed / KNOT:.2f} kn"
        needed = f"{speed}: {written(1e-6 * power, 'MW', 2)}"
        if load > 1.0:
            warnings.append(f"{needed} are more than the engine's rating; the consumption is extrapolated")
        elif engine.excess(power, rate) > 0.0:
            warnings.append(
                f"{needed} at {condition.rotation_rate_rpm:.1f} rpm are outside the engine's "
                "torque and rate of revolutions"
            )
        elif engine.load_fractions and not engine.knows(power):
            warnings.append(f"{speed}: no consumption is stated at {100.0 * load:.0f} % load; the nearest is taken")
    return warnings
