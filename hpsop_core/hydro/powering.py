"""From the resistance to the engine: the parts beside friction and waves, the efficiencies, and the powers.

R_T = R_F + k R_F + R_W + R_A + R_AA + R_APP; eta_H = (1 - t)/(1 - w); eta_D = P_E/P_D;
P_B = (1 + sea margin) P_D/eta_S (ITTC 7.5-02-03-01.4, performance prediction method).
"""

from __future__ import annotations

from dataclasses import dataclass

AIR_DENSITY = 1.226
"""Of the air at 15 C and one atmosphere, in kg/m3 (ITTC 7.5-02-03-01.4)."""


@dataclass(frozen=True)
class ResistanceParts:
    """What a hull resists with; they add up to ``total``. All in N.

    Attributes:
        friction: of the flat plate with the hull's wetted surface.
        form: k times friction.
        wave: of the waves.
        correlation: of the model-ship correlation allowance.
        air: of the ship above water.
        appendages: of rudder, bilge keels and the like.
    """

    friction: float
    form: float
    wave: float
    correlation: float = 0.0
    air: float = 0.0
    appendages: float = 0.0


def resistance_parts(
    *,
    speed: float,
    density: float,
    wetted_surface: float,
    friction: float,
    wave: float,
    form_factor: float,
    correlation_allowance: float,
    air_drag_coefficient: float,
    frontal_area: float,
    appendage_factor: float,
) -> ResistanceParts:
    """The parts of the resistance at a speed.

    Args:
        speed: V in m/s.
        density: of the water, in kg/m3.
        wetted_surface: S in m2.
        friction, wave: R_F and R_W in N.
        form_factor: k.
        correlation_allowance: C_A; R_A = 1/2 rho V^2 S C_A.
        air_drag_coefficient: C_DA; R_AA = 1/2 rho_air V^2 A C_DA: the ship's own wind, no other.
        frontal_area: A of the ship above water, in m2.
        appendage_factor: R_APP over R_F, which is the sum of (1 + k2) S_APP over S.
    """
    return ResistanceParts(
        friction=friction,
        form=form_factor * friction,
        wave=wave,
        correlation=0.5 * density * speed**2 * wetted_surface * correlation_allowance,
        air=0.5 * AIR_DENSITY * speed**2 * frontal_area * air_drag_coefficient,
        appendages=appendage_factor * friction,
    )


def total_resistance(parts: ResistanceParts, form_factor: float) -> float:
    """(1 + k) R_F + R_W + R_A + R_AA + R_APP in N.

    In this order, parts that are zero leave every bit of (1 + k) R_F + R_W as it is.
    """
    bare = (1.0 + form_factor) * parts.friction + parts.wave
    return bare + parts.correlation + parts.air + parts.appendages


@dataclass(frozen=True)
class Powers:
    """Attributes:
    effective: P_E = R_T V in W.
    hull_efficiency: eta_H = (1 - t)/(1 - w).
    propulsive_efficiency: eta_D = P_E/P_D.
    brake: P_B in W, sea margin and losses of the shaft included.
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
        sea_margin: on the delivered power, 0.15 for 15 %.
        shaft_efficiency: eta_S, of shaft, bearings and gears.
    """
    effective = total_resistance * speed
    return Powers(
        effective=effective,
        hull_efficiency=(1.0 - deduction) / (1.0 - wake),
        propulsive_efficiency=effective / delivered_power,
        brake=(1.0 + sea_margin) * delivered_power / shaft_efficiency,
    )
