"""The numbers of a design at a level: what its objectives and constraints are made of.

They stand below the case, because a case names the objectives that are made of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from hpsop_core.case.variables import DesignVariables


@dataclass(frozen=True)
class HullResult:
    """The hull's main figures, measured on its geometry.

    Attributes:
        length, breadth, draft: Lpp, B and d in m.
        block_coefficient: CB.
        displaced_volume: in m3.
        wetted_surface: static, in m2.
        longitudinal_centre_of_buoyancy: LCB forward of AP, in m.
        clipped: whether the asked displacement or LCB was more than the parent's form carries.
        booked_block_coefficient, booked_volume: affine form only: what the paper books, not what the geometry has.
        depth: height of the deck above the baseline, in m.
        displacement_mass: density times the geometry's displaced volume, in kg.
        midship_coefficient, prismatic_coefficient, waterplane_coefficient: CM, CP, CWP.
        centre_of_buoyancy_height, metacentric_radius, metacentre_height: KB, BM, KM = KB + BM, in m.
        centre_of_gravity_height, metacentric_height: KG, GM = KM - KG, in m; None where the case states no KG.
        lightship_mass, deadweight: in kg; None where the case states no lightship.
    """

    length: float
    breadth: float
    draft: float
    block_coefficient: float
    displaced_volume: float
    wetted_surface: float
    longitudinal_centre_of_buoyancy: float
    clipped: bool = False
    booked_block_coefficient: float | None = None
    booked_volume: float | None = None
    depth: float | None = None
    displacement_mass: float | None = None
    midship_coefficient: float | None = None
    prismatic_coefficient: float | None = None
    waterplane_coefficient: float | None = None
    centre_of_buoyancy_height: float | None = None
    metacentric_radius: float | None = None
    metacentre_height: float | None = None
    centre_of_gravity_height: float | None = None
    metacentric_height: float | None = None
    lightship_mass: float | None = None
    deadweight: float | None = None


@dataclass(frozen=True)
class PropellerResult:
    """The propeller's main figures.

    Attributes:
        diameter: D in m.
        blade_count: Z.
        pitch_ratio: multiplier on the parent's pitch.
        pitch_diameter_ratio_07R: absolute P/D at 0.7 R.
        expanded_area_ratio: EAR.
        shaft_height: above the baseline, in m.
        tip_clearance: least distance of the blade tips' circle from the hull, in m; negative where it cuts the hull.
    """

    diameter: float
    blade_count: int
    pitch_ratio: float
    pitch_diameter_ratio_07R: float  # noqa: N815 - a name of the contract
    expanded_area_ratio: float
    shaft_height: float
    tip_clearance: float


@dataclass(frozen=True)
class ConditionResult:
    """One operating condition of a design.

    Attributes:
        froude_number: V/sqrt(g Lpp) of this design.
        weight: of the condition in the objectives.
        speed: V in m/s.
        friction_resistance: ITTC-57 without form factor, in N.
        wave_resistance: after calibration, in N.
        total_resistance: friction + form + wave + correlation + air + appendages, in N.
        wave_coefficient: wave resistance over 1/2 rho V^2 S.
        wake_fraction, thrust_deduction: w and t.
        advance_coefficient: J where required and available KT meet.
        rotation_rate_rpm: 1/min.
        thrust: T in N; torque: Q in N m.
        thrust_coefficient, torque_coefficient: KT and KQ at J.
        open_water_efficiency: J KT/(2 pi KQ).
        delivered_power: 2 pi n Q in W.
        required_expanded_area_ratio: Keller's or Burrill's, as the case asks.
        wave_calibration: the factor on the solver's wave resistance.
        cavitation_number: (P0 + rho g h - Pv)/(1/2 rho (V_A^2 + (0.7 pi n D)^2)).
        reynolds_number_07R: chord Reynolds number at 0.7 R, full scale.
        blade_cavitation_margin: level 2: least Cp + sigma on the blades between hub and 0.9 R, both on the undisturbed
            speed of their radius, blade upwards; negative where the water would evaporate.
        blade_minimum_pressure_coefficient, blade_cavitation_radius_ratio: level 2: Cp and r/R there.
        blade_cavitating_share: level 2: share of the back's area under vapour pressure.
        wave_coefficient_pressure: level 2's cross-check by pressure integration, not calibrated.
        sinkage, trim: level 2: m (positive down) and rad (positive bow down), reported, not fed back.
        form_resistance: k times friction, in N.
        correlation_resistance, air_resistance, appendage_resistance: of the correlation allowance, of the ship above
            water in its own wind, and of the appendages, in N.
        effective_power: resistance times speed, in W.
        hull_efficiency: (1 - t)/(1 - w).
        relative_rotative_efficiency: open-water torque over the torque behind the ship, at the same thrust.
        propulsive_efficiency: effective over delivered power.
        brake_power: of the engine, with sea margin and shaft losses, in W.
        engine_load: brake power over the engine's MCR; None without an engine.
        engine_excess: how far the point lies outside the engine's layout (greatest of power, torque and rate of
            revolutions over their limits, minus 1); None without an engine.
        fuel_rate: of the main engine, in kg/s; None without its consumption.

    Numbers that an earlier version neither kept nor implied are None in its files.
    """

    froude_number: float
    weight: float
    speed: float
    friction_resistance: float
    wave_resistance: float
    total_resistance: float
    wave_coefficient: float
    wake_fraction: float
    thrust_deduction: float
    advance_coefficient: float
    rotation_rate_rpm: float
    thrust: float
    torque: float
    thrust_coefficient: float
    torque_coefficient: float
    open_water_efficiency: float
    delivered_power: float
    required_expanded_area_ratio: float
    wave_calibration: float = 1.0
    cavitation_number: float | None = None
    reynolds_number_07R: float | None = None  # noqa: N815 - a name of the contract's kind
    wave_coefficient_pressure: float | None = None
    blade_cavitation_margin: float | None = None
    blade_minimum_pressure_coefficient: float | None = None
    blade_cavitation_radius_ratio: float | None = None
    blade_cavitating_share: float | None = None
    sinkage: float | None = None
    trim: float | None = None
    form_resistance: float | None = None
    correlation_resistance: float | None = None
    air_resistance: float | None = None
    appendage_resistance: float | None = None
    effective_power: float | None = None
    hull_efficiency: float | None = None
    relative_rotative_efficiency: float | None = None
    propulsive_efficiency: float | None = None
    brake_power: float | None = None
    engine_load: float | None = None
    engine_excess: float | None = None
    fuel_rate: float | None = None


@dataclass(frozen=True)
class DesignNumbers:
    """Everything that an objective or a constraint may ask of a design.

    Attributes:
        level: of fidelity, 1 or 2.
        variables: the design.
        hull, propeller: their main figures.
        conditions: one a condition of the case, in its order.
        baseline_clearance: of the blade tips above the baseline, in m; negative below it.
        buoyancy_centre_missed: distance of LCB from the asked place, as a fraction of the length.
    """

    level: int
    variables: DesignVariables
    hull: HullResult
    propeller: PropellerResult
    conditions: tuple[ConditionResult, ...]
    baseline_clearance: float
    buoyancy_centre_missed: float

    @property
    def fuel_per_hour(self) -> float | None:
        """Of the main engine over the operating profile (the weights are shares of time), in kg/h."""
        rates = [condition.fuel_rate for condition in self.conditions]
        if None in rates:
            return None
        pairs = zip(self.conditions, rates, strict=True)
        return 3600.0 * math.fsum(condition.weight * rate for condition, rate in pairs if rate is not None)

    @property
    def displaced_volume(self) -> float:
        """In m3, as the case counts it: booked with the affine form, else the hull's own."""
        booked = self.hull.booked_volume
        return self.hull.displaced_volume if booked is None else booked

    @property
    def block_coefficient(self) -> float:
        """CB as the case counts it, see ``displaced_volume``."""
        booked = self.hull.booked_block_coefficient
        return self.hull.block_coefficient if booked is None else booked


@dataclass(frozen=True)
class InitialNumbers:
    """The initial design's numbers at the same level, by which objectives are normalised.

    Attributes:
        displaced_volume: V0 in m3.
        conditions: by the name of a ``ConditionResult``'s field: (n,) its values, one a condition.
        hull: by the name of a ``HullResult``'s field: its value.

    A number that the file of an older version did not keep is missing from the mappings.
    """

    displaced_volume: float
    conditions: Mapping[str, tuple[float, ...]]
    hull: Mapping[str, float]
