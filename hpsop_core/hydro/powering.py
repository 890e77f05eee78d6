"""From the resistance to the engine: the parts beside friction and waves, the efficiencies, and the powers.

R_T = R_F + k R_F + R_W + R_A + R_AA + R_APP; eta_H = (1 - t)/(1 - w); eta_D = P_E/P_D;
P_B = (1 + sea margin) P_D/eta_S (ITTC 7.5-02-03-01.4, performance prediction method).
"""

from __future__ import annotations

from dataclasses import dataclass

AIR_DENSITY = 1.226
"""Of the air at 15 C and one atmosphere, in kg/m3 (ITTC 7.5-02-03-01.4)."""


@dataclass(frozen=True)
class ResistanceFactors:
    """What makes the parts of the resistance beside friction and waves; none of it depends on the speed.

    Attributes:
        form_factor: k on the friction.
        correlation_allowance: C_A; R_A = 1/2 rho V^2 S C_A.
        air_drag_coefficient: C_DA; R_AA = 1/2 rho_air V^2 A C_DA: the ship's own wind, no other.
        frontal_area: A of the ship above water, in m2.
        appendage_factor: R_APP over R_F, which is the sum of (1 + k2) S_APP over S.
    """

    form_factor: float = 0.0
    correlation_allowance: float = 0.0
    air_drag_coefficient: float = 0.0
    frontal_area: float = 0.0
    appendage_factor: float = 0.0


@dataclass(frozen=True)
class ResistanceParts:
    """What a hull resists with, in N; the six add up to ``total``.

    Attributes:
        friction: of a flat plate of the hull's wetted surface.
        form: k times friction.
        wave: of the waves.
        correlation: of the model-ship correlation allowance.
        air: of the ship above water.
        appendage: of rudder, bilge keels and the like.
        total: their sum.
    """

    friction: float
    form: float
    wave: float
    correlation: float
    air: float
    appendage: float
    total: float


def resistance_parts(
    factors: ResistanceFactors, *, speed: float, density: float, wetted_surface: float, friction: float, wave: float
) -> ResistanceParts:
    """The parts of the resistance at a speed.

    Args:
        factors: of the ship.
        speed: V in m/s.
        density: of the water, in kg/m3.
        wetted_surface: S in m2.
        friction, wave: R_F and R_W in N.
    """
    correlation = 0.5 * density * speed**2 * wetted_surface * factors.correlation_allowance
    air = 0.5 * AIR_DENSITY * speed**2 * factors.frontal_area * factors.air_drag_coefficient
    appendage = factors.appendage_factor * friction
    # In this order parts that are zero leave (1 + k) R_F + R_W as it is, to the last bit.
    total = (1.0 + factors.form_factor) * friction + wave + correlation + air + appendage
    return ResistanceParts(friction, factors.form_factor * friction, wave, correlation, air, appendage, total)


@dataclass(frozen=True)
class Powers:
    """Powers and efficiencies of a ship at a speed.

    Attributes:
        effective: P_E = R_T V in W.
        hull_efficiency: eta_H = (1 - t)/(1 - w).
        propulsive_efficiency: eta_D = P_E/P_D.
        brake: P_B in W, with the sea margin and the losses of the shaft.
    """

    effective: float
    hull_efficiency: float
    propulsive_efficiency: float
    brake: float


def powers(
    *,
    total_resistance: float,
    speed: float,
    wake: float,
    deduction: float,
    delivered_power: float,
    sea_margin: float,
    shaft_efficiency: float,
) -> Powers:
    """Powers and efficiencies of a ship at a speed.

    Args:
        total_resistance: R_T in N.
        speed: V in m/s.
        wake, deduction: w and t.
        delivered_power: P_D in W, in calm water.
        sea_margin: on the power, 0.15 for 15 %.
        shaft_efficiency: eta_S, of shaft, bearings and gears.
    """
    effective = total_resistance * speed
    return Powers(
        effective=effective,
        hull_efficiency=(1.0 - deduction) / (1.0 - wake),
        propulsive_efficiency=effective / delivered_power,
        brake=(1.0 + sea_margin) * delivered_power / shaft_efficiency,
    )
