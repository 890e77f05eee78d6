"""A main engine that drives the propeller directly: where it may run, and what it burns there.

The layout is that of a two-stroke engine's load diagram, simplified to three straight limits: the maximum continuous
rating, the torque at that rating (power proportional to the rate of revolutions below it), and 105 % of the rated rate
of revolutions. The load diagrams of engine makers bend the torque limit further down at low rates (the turbocharger's
limit, power over n^2 below some 90 % of the rated rate); that depends on the make and is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

GREATEST_RATE = 1.05
"""Continuous running up to this part of the rated rate of revolutions."""


@dataclass(frozen=True)
class Engine:
    """A main engine.

    Attributes:
        maximum_continuous_rating: in W, at the coupling.
        rated_rotation_rate: in 1/s, of the propeller's shaft at the rating; None leaves torque and rate unlimited.
        load_fractions: (n,) ascending parts of the rating at which the consumption is known; may be empty.
        specific_fuel_consumptions: (n,) in kg/J.
    """

    maximum_continuous_rating: float
    rated_rotation_rate: float | None = None
    load_fractions: tuple[float, ...] = ()
    specific_fuel_consumptions: tuple[float, ...] = ()

    def load(self, power: float) -> float:
        """Part of the rating that a brake power in W is."""
        return power / self.maximum_continuous_rating

    def power_limit(self, rotation_rate: float) -> float:
        """Greatest brake power in W at a rate of revolutions in 1/s; 0 beyond the greatest rate."""
        rated = self.rated_rotation_rate
        if rated is None:
            return self.maximum_continuous_rating
        if rotation_rate > GREATEST_RATE * rated:
            return 0.0
        return self.maximum_continuous_rating * min(1.0, rotation_rate / rated)

    def excess(self, power: float, rotation_rate: float) -> float:
        """How far a point lies outside the layout: the greatest of power, torque and rate over their limits, minus 1.

        Args:
            power: brake power in W.
            rotation_rate: of the propeller's shaft, in 1/s, positive.
        """
        load = self.load(power)
        rated = self.rated_rotation_rate
        if rated is None:
            return load - 1.0
        rate = rotation_rate / rated
        return max(load, load / rate, rate / GREATEST_RATE) - 1.0

    def specific_fuel_consumption(self, power: float) -> float | None:
        """In kg/J at a brake power in W: linear over the load, constant beyond the loads stated; None if none is."""
        if not self.load_fractions:
            return None
        return float(np.interp(self.load(power), self.load_fractions, self.specific_fuel_consumptions))

    def fuel_rate(self, power: float) -> float | None:
        """Fuel in kg/s at a brake power in W; None where no consumption is stated."""
        consumption = self.specific_fuel_consumption(power)
        return None if consumption is None else consumption * power

    def knows(self, power: float) -> bool:
        """Whether a power lies within the loads for which the consumption is stated (one alone serves all)."""
        known = self.load_fractions
        return len(known) == 1 or (len(known) > 1 and known[0] <= self.load(power) <= known[-1])
