"""The sections of a case that make a hull and a propeller a ship: loading and engine."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from hpsop_core.case.fields import number, numbers, optional_number
from hpsop_core.errors import InputError

_JOULES_OF_KWH = 3.6e6
_GREATEST_KILOGRAMS_PER_JOULE = 1.0e-6
_LEAST_GRAMS_PER_KWH = 50.0


@dataclass(frozen=True)
class LoadingSection:
    """Weights and stability: of the initial design; other designs by its dimensions. Depth scales with the draft."""

    centre_of_gravity_height: float | None = optional_number(
        0.001, 100.0, "KG of the loaded initial design above the baseline; other designs in proportion to depth", "m"
    )
    least_metacentric_height: float = number(
        0.15,
        0.0,
        20.0,
        "least GM, where centre_of_gravity_height is given (0.15: IMO Intact Stability Code)",
        "m",
    )
    lightship_mass: float | None = optional_number(
        1.0e-3, 1.0e9, "the initial design's mass without cargo and fuel; others in proportion to L B depth", "kg"
    )
    capacity_share: float = number(
        1.0, 0.1, 1.0, "share of the deadweight that is the EEDI's capacity: 1, of container ships 0.7"
    )


@dataclass(frozen=True)
class EngineSection:
    """The main engine, on the propeller's shaft (with a gear: rates of revolutions are the propeller's)."""

    maximum_continuous_rating: float | None = optional_number(
        1.0, 2.0e8, "MCR; without it power, torque and fuel are not looked at", "W"
    )
    rated_rotation_rate_rpm: float | None = optional_number(
        1.0, 1.0e5, "at the MCR; limits torque and rate of revolutions where given", "1/min"
    )
    load_fractions: tuple[float, ...] = numbers(
        (), 0.01, 1.2, "brake power over MCR at which the consumption is known, ascending"
    )
    specific_fuel_consumptions: tuple[float, ...] = numbers(
        (), 1.0e-8, 1000.0, "at these loads, in kg/J (165 g/kWh is 4.583e-8); numbers from 50 on are read as g/kWh",
        "kg/J",
    )  # fmt: skip
    fuel_carbon_factor: float = number(
        3.114, 0.0, 5.0, "kg of CO2 per kg of fuel (MEPC.364(79): heavy fuel oil 3.114, diesel oil 3.206, LNG 2.750)"
    )
    auxiliary_specific_fuel_consumption: float = number(
        215.0 / 3.6e9, 1.0e-8, 1000.0,
        "of the auxiliary engines, for the EEDI alone; the IMO's reference lines take 215 g/kWh; as above", "kg/J",
    )  # fmt: skip

    def __post_init__(self) -> None:
        loads, consumptions = self.load_fractions, self.specific_fuel_consumptions
        if len(loads) != len(consumptions):
            raise InputError(
                f"engine: {len(consumptions)} specific_fuel_consumptions for {len(loads)} load_fractions; "
                "give one a load"
            )
        if any(b <= a for a, b in itertools.pairwise(loads)):
            raise InputError("engine: load_fractions must ascend; sort them together with their consumptions")
        for value in (*consumptions, self.auxiliary_specific_fuel_consumption):
            kilograms_per_joule(value)
        if self.maximum_continuous_rating is None and (loads or self.rated_rotation_rate_rpm is not None):
            raise InputError("engine: maximum_continuous_rating is missing; give it in W, for example 45e6")


def kilograms_per_joule(value: float) -> float:
    """A specific consumption in kg/J, given so or in g/kWh: no engine's two numbers can be taken for each other.

    Raises:
        InputError: it is neither.
    """
    if value <= _GREATEST_KILOGRAMS_PER_JOULE:
        return value
    if value < _LEAST_GRAMS_PER_KWH:
        raise InputError(
            f"engine: a specific fuel consumption of {value:g} is neither kg/J nor g/kWh; "
            "give 165 or 4.583e-8 for 165 g/kWh"
        )
    return value / (1000.0 * _JOULES_OF_KWH)
