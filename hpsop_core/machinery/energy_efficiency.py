"""The attained Energy Efficiency Design Index of a conventional ship with one main engine.

Source: IMO, resolution MEPC.364(79), 2022 Guidelines on the method of calculation of the attained EEDI for new ships,
2.1 and 2.2 (as MEPC.308(73) before). Left out, with the value 1 or 0: corrections for ice class, voluntary structural
enhancement, cubic capacity and weather (f_j, f_i, f_c, f_l, f_w), shaft generators and motors, waste heat, innovative
devices. What they change is the verifier's to decide.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

MAIN_ENGINE_LOAD = 0.75
"""P_ME and V_ref are taken at this part of the rating (2.2.5.1)."""
LARGE_ENGINE = 1.0e7
"""W: from here on the auxiliary power follows another line (2.2.5.6.1 and .2)."""
_FARTHEST = 1.1


def auxiliary_power(maximum_continuous_rating: float) -> float:
    """P_AE in W: 2.5 % of the rating and 250 kW, for engines below 10 MW 5 % of it (MEPC.364(79), 2.2.5.6)."""
    if maximum_continuous_rating >= LARGE_ENGINE:
        return 0.025 * maximum_continuous_rating + 2.5e5
    return 0.05 * maximum_continuous_rating


def attained_eedi(
    *,
    maximum_continuous_rating: float,
    specific_fuel_consumption: float,
    carbon_factor: float,
    auxiliary_specific_fuel_consumption: float,
    auxiliary_carbon_factor: float,
    capacity: float,
    reference_speed: float,
) -> float:
    """Attained EEDI in grams of CO2 per tonne and nautical mile.

    Args:
        maximum_continuous_rating: in W.
        specific_fuel_consumption: of the main engine at 75 % of the rating, in kg/J.
        carbon_factor: kg of CO2 per kg of its fuel.
        auxiliary_specific_fuel_consumption, auxiliary_carbon_factor: of the auxiliary engines.
        capacity: in kg: the deadweight, of a container ship 70 % of it.
        reference_speed: V_ref at 75 % of the rating in calm water, in m/s.
    """
    main = MAIN_ENGINE_LOAD * maximum_continuous_rating * specific_fuel_consumption * carbon_factor
    auxiliary = (
        auxiliary_power(maximum_continuous_rating) * auxiliary_specific_fuel_consumption * auxiliary_carbon_factor
    )
    # kg of CO2 a second over kg times m/s, in g over t times nautical miles
    return (main + auxiliary) / (capacity * reference_speed) * 1.0e3 * 1.0e3 * 1852.0


def speed_at_power(power: float, speeds: Sequence[float], powers: Sequence[float]) -> float | None:
    """The speed at a power, by the local law P ~ V^m between the given points.

    Args:
        power: in W.
        speeds: (n,) ascending, in m/s.
        powers: (n,) in W.

    Returns:
        In m/s; beyond the ends by the law of the last two points, up to 10 % in speed. None further out, for fewer
        than two points, or where the powers do not ascend.
    """
    if len(speeds) < 2 or any(b <= a for a, b in itertools.pairwise(powers)) or powers[0] <= 0.0:
        return None
    inner = sum(value < power for value in powers[1:-1])
    low, high = inner, inner + 1
    exponent = math.log(powers[high] / powers[low]) / math.log(speeds[high] / speeds[low])
    speed = speeds[low] * (power / powers[low]) ** (1.0 / exponent)
    return speed if speeds[0] / _FARTHEST <= speed <= speeds[-1] * _FARTHEST else None
