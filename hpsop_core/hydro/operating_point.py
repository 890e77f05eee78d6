"""Open-water curves as smooth functions of J, and where they meet the required thrust.

A solver is asked at a few Chebyshev nodes; between them the polynomial through them is the curve. Matching then costs
nothing, and the reported KT meets the required one to rounding. `tests/regression` holds its error against direct
solves below 2e-4 of KT.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import brentq

from hpsop_core.errors import SolverFailure
from hpsop_core.typing_aliases import Array

ADVANCE_TOLERANCE = 1e-12

_Number = TypeVar("_Number", float, Array)


def chebyshev_nodes(lower: float, upper: float, count: int) -> Array:
    """Chebyshev nodes of the second kind on [lower, upper], ascending, both ends included; shape (count,)."""
    angles = np.linspace(math.pi, 0.0, count)
    return 0.5 * (lower + upper) + 0.5 * (upper - lower) * np.cos(angles)


@dataclass(frozen=True, eq=False)
class PropellerCurve:
    """KT and KQ as polynomials in J through a solver's values at Chebyshev nodes.

    Attributes:
        advance_coefficient: the nodes, shape (n,), ascending.
        thrust_coefficient, torque_coefficient: the solver's KT and KQ there, shape (n,).
    """

    advance_coefficient: Array
    thrust_coefficient: Array
    torque_coefficient: Array

    def __post_init__(self) -> None:
        values = np.stack([self.thrust_coefficient, self.torque_coefficient], axis=1)
        if not np.all(np.isfinite(values)):
            raise SolverFailure("operating_point", "the open-water curve holds a number that is not finite")
        nodes = self._unit_interval(self.advance_coefficient)
        series = np.linalg.solve(chebyshev.chebvander(nodes, len(nodes) - 1), values)
        object.__setattr__(self, "_series", series)

    def _unit_interval(self, advance_coefficient: _Number) -> _Number:
        lower, upper = self.range
        return (2.0 * advance_coefficient - lower - upper) / (upper - lower)

    def coefficients(self, advance_coefficient: Array | float) -> tuple[Array, Array]:
        """KT and KQ at J inside the nodes' range, each of J's shape."""
        place = self._unit_interval(np.asarray(advance_coefficient, dtype=float))
        series: Array = self._series  # type: ignore[attr-defined]
        return np.asarray(chebyshev.chebval(place, series[:, 0])), np.asarray(chebyshev.chebval(place, series[:, 1]))

    def thrust_at(self, advance_coefficient: float) -> float:
        """KT at one J, the number of ``coefficients`` to the bit, in a tenth of the time that arrays take."""
        place = self._unit_interval(advance_coefficient)
        series: Array = self._series  # type: ignore[attr-defined]
        # Clenshaw's recurrence, in the order of numpy's chebval.
        *rest, first, second = series[:, 0].tolist()
        for coefficient in reversed(rest):
            first, second = coefficient - second, first + second * (2.0 * place)
        return float(first + second * place)

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest J."""
        return float(self.advance_coefficient[0]), float(self.advance_coefficient[-1])


@dataclass(frozen=True)
class OperatingPoint:
    """Where the propeller gives the thrust that the hull asks for.

    Attributes:
        advance_coefficient: J.
        thrust_coefficient, torque_coefficient: KT and KQ.
        open_water_efficiency: J KT/(2 pi KQ).
        rotation_rate: n in 1/s.
        thrust: T in N; torque: Q in N m.
        delivered_power: 2 pi n Q in W.
    """

    advance_coefficient: float
    thrust_coefficient: float
    torque_coefficient: float
    open_water_efficiency: float
    rotation_rate: float
    thrust: float
    torque: float
    delivered_power: float


def required_thrust_factor(
    total_resistance: float, wake: float, deduction: float, density: float, speed: float, diameter: float
) -> float:
    """c of the required KT = c J^2: Rt/((1 - t)(1 - w)^2 rho V^2 D^2)."""
    return total_resistance / ((1.0 - deduction) * (1.0 - wake) ** 2 * density * speed**2 * diameter**2)


def match(
    curve: PropellerCurve,
    total_resistance: float,
    wake: float,
    deduction: float,
    density: float,
    speed: float,
    diameter: float,
    relative_rotative_efficiency: float = 1.0,
) -> OperatingPoint:
    """The intersection of required and available thrust coefficient.

    Args:
        curve: the propeller in open water.
        total_resistance: Rt in N.
        wake, deduction: w and t.
        density: kg/m3.
        speed: the ship's, in m/s.
        diameter: D in m.
        relative_rotative_efficiency: torque behind the ship is the open-water torque over it.

    Raises:
        SolverFailure: the curves do not meet within the range of the open-water curve.
    """
    factor = required_thrust_factor(total_resistance, wake, deduction, density, speed, diameter)

    def surplus(advance: float) -> float:
        return curve.thrust_at(advance) - factor * advance**2

    lower, upper = curve.range
    if surplus(lower) <= 0.0:
        raise SolverFailure(
            "operating_point",
            f"the propeller cannot give the thrust: at J {lower:.2f} KT required {factor * lower**2:.3f} exceeds "
            f"KT available {curve.thrust_at(lower):.3f}",
        )
    if surplus(upper) >= 0.0:
        raise SolverFailure("operating_point", f"required and available KT meet beyond J {upper:.2f}: hardly any load")
    advance = float(brentq(surplus, lower, upper, xtol=ADVANCE_TOLERANCE, rtol=1e-14))
    thrust_coefficient, torque_coefficient = (float(value) for value in curve.coefficients(advance))
    if thrust_coefficient <= 0.0 or torque_coefficient <= 0.0:
        raise SolverFailure(
            "operating_point", f"KT {thrust_coefficient:.4f} and KQ {torque_coefficient:.5f} at J {advance:.3f}"
        )
    rotation_rate = (1.0 - wake) * speed / (advance * diameter)
    torque = torque_coefficient * density * rotation_rate**2 * diameter**5 / relative_rotative_efficiency
    return OperatingPoint(
        advance_coefficient=advance,
        thrust_coefficient=thrust_coefficient,
        torque_coefficient=torque_coefficient,
        open_water_efficiency=advance * thrust_coefficient / (2.0 * math.pi * torque_coefficient),
        rotation_rate=rotation_rate,
        thrust=thrust_coefficient * density * rotation_rate**2 * diameter**4,
        torque=torque,
        delivered_power=2.0 * math.pi * rotation_rate * torque,
    )
