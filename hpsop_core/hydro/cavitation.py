"""Keller's and Burrill's criteria and the cavitation number."""

from __future__ import annotations

import math


def pressure_margin(
    shaft_immersion: float, density: float, gravity: float, atmospheric_pressure: float, vapour_pressure: float
) -> float:
    """P0 - Pv in Pa at the shaft: atmosphere and head of water over it, less vapour pressure.

    Args:
        shaft_immersion: in m below the water surface.
        density: in kg/m3.
        gravity: in m/s2.
        atmospheric_pressure, vapour_pressure: in Pa.
    """
    return atmospheric_pressure + density * gravity * shaft_immersion - vapour_pressure


def keller_expanded_area_ratio(
    blade_count: int, thrust: float, diameter: float, pressure_margin_pascal: float, keller_k: float
) -> float:
    """Least expanded area ratio (1.3 + 0.3 Z) T/((P0 - Pv) D^2) + K (paper, equation 3, third constraint).

    Args:
        blade_count: Z.
        thrust: T in N.
        diameter: D in m.
        pressure_margin_pascal: P0 - Pv at the shaft, in Pa.
        keller_k: K, 0 to 0.2.
    """
    return (1.3 + 0.3 * blade_count) * thrust / (pressure_margin_pascal * diameter**2) + keller_k


def cavitation_number(
    pressure_margin_pascal: float, density: float, advance_speed: float, rotation_rate: float, diameter: float
) -> float:
    """sigma = (P0 - Pv)/(1/2 rho (V_A^2 + (0.7 pi n D)^2)), at the shaft's depth and the speed of the 0.7 R section.

    Args:
        pressure_margin_pascal: P0 - Pv in Pa.
        density: kg/m3.
        advance_speed: V_A in m/s.
        rotation_rate: n in 1/s.
        diameter: D in m.
    """
    return pressure_margin_pascal / section_dynamic_pressure(density, advance_speed, rotation_rate, diameter)


def section_dynamic_pressure(density: float, advance_speed: float, rotation_rate: float, diameter: float) -> float:
    """1/2 rho (V_A^2 + (0.7 pi n D)^2) in Pa of the 0.7 R section; arguments as for ``cavitation_number``."""
    speed_squared = advance_speed**2 + (0.7 * math.pi * rotation_rate * diameter) ** 2
    return 0.5 * density * speed_squared


# The line of 5 % back cavitation in Burrill and Emerson's diagram (Propeller cavitation: further tests on 16-inch
# propeller models in the King's College cavitation tunnel, NECIES Transactions 79, 1963), as fitted by Birk
# (Fundamentals of Ship Hydrodynamics, Wiley 2019, chapter 46): a sigma^b + c.
_BURRILL_5 = (0.715, 0.184, -0.437)
# The fit falls to nothing at 0.07, and the diagram ends at 0.1 and 2.0.
_FIT_FROM, _DIAGRAM_TO = 0.15, 2.0


def burrill_thrust_loading(cavitation_number_07r: float) -> float:
    """tau_c at 5 % back cavitation: greatest T/(A_P 1/2 rho V_07R^2), by Burrill and Emerson's diagram.

    Below 0.15 it is proportional to the cavitation number, which lies below the diagram's curve; above 2.0, where the
    diagram ends, it stays.

    Args:
        cavitation_number_07r: as ``cavitation_number``, positive.
    """
    factor, exponent, shift = _BURRILL_5
    within = min(max(cavitation_number_07r, _FIT_FROM), _DIAGRAM_TO)
    limit: float = factor * within**exponent + shift
    return limit * min(1.0, cavitation_number_07r / _FIT_FROM)


def burrill_expanded_area_ratio(
    thrust: float, diameter: float, pitch_ratio: float, dynamic_pressure: float, cavitation_number_07r: float
) -> float:
    """Least expanded area ratio by Burrill's criterion; the developed area is taken as the expanded one.

    Projected over developed area is 1.067 - 0.229 P/D (Taylor's approximation, as in Burrill's diagram).

    Args:
        thrust: T in N.
        diameter: D in m.
        pitch_ratio: P/D at 0.7 R.
        dynamic_pressure: as ``section_dynamic_pressure``, in Pa.
        cavitation_number_07r: as ``cavitation_number``.
    """
    projected = thrust / (dynamic_pressure * burrill_thrust_loading(cavitation_number_07r))
    return projected / (1.067 - 0.229 * pitch_ratio) / (0.25 * math.pi * diameter**2)
