"""Power over speed: the propeller in equilibrium with the hull at every speed of a resistance curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from hpsop_core.case.case import Case
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.hydro.operating_point import required_thrust_factor
from hpsop_core.typing_aliases import Array


@dataclass(frozen=True, eq=False)
class PowerCurves:
    """Power over speed; NaN where the propeller cannot give the thrust.

    Attributes:
        speed: (n,) in m/s, ascending.
        rotation_rate_rpm: (n,) in 1/min.
        delivered: (n,) P_D in calm water, in W.
        calm: (n,) brake power in calm water, P_D/eta_S, in W.
        service: (n,) brake power with the case's sea margin, in W.
    """

    speed: Array
    rotation_rate_rpm: Array
    delivered: Array
    calm: Array
    service: Array


def power_curves(case: Case, evaluation: Evaluation, points: Sequence[ResistancePoint]) -> PowerCurves:
    """Power over the speeds of a resistance curve, by the propeller's own open-water curve.

    w, t and eta_R are read between the conditions and kept beyond them; every condition lies on the curves.

    Args:
        case: its density, margin and shaft.
        evaluation: the design's.
        points: its resistance, ascending in Froude number.

    Raises:
        SolverFailure: the design failed.
    """
    if not evaluation.ok:
        raise SolverFailure("curves", evaluation.reason)
    constants, diameter = case.constants, evaluation.variables.diameter
    curve = evaluation.open_water
    advance = np.asarray(curve.advance_coefficient)
    thrust = CubicSpline(advance, curve.thrust_coefficient)
    torque = CubicSpline(advance, curve.torque_coefficient)
    conditions = sorted(evaluation.conditions, key=lambda item: item.froude_number)
    known = [item.froude_number for item in conditions]
    froude = np.array([point.froude_number for point in points])
    wake = np.interp(froude, known, [item.wake_fraction for item in conditions])
    deduction = np.interp(froude, known, [item.thrust_deduction for item in conditions])
    rotative = np.interp(froude, known, [item.relative_rotative_efficiency or 1.0 for item in conditions])
    speed = np.array([point.speed for point in points])
    rate, delivered = np.full(len(points), np.nan), np.full(len(points), np.nan)
    for index, point in enumerate(points):
        factor = required_thrust_factor(
            point.total_resistance, wake[index], deduction[index], constants.density, point.speed, diameter
        )

        def surplus(j: float, factor: float = factor) -> float:
            return float(thrust(j)) - factor * j**2

        if surplus(advance[0]) <= 0.0 or surplus(advance[-1]) >= 0.0:
            continue
        at = float(brentq(surplus, advance[0], advance[-1]))
        rate[index] = (1.0 - wake[index]) * point.speed / (at * diameter)
        moment = float(torque(at)) * constants.density * rate[index] ** 2 * diameter**5 / rotative[index]
        delivered[index] = 2.0 * np.pi * rate[index] * moment
    calm = delivered / constants.shaft_efficiency
    return PowerCurves(speed, 60.0 * rate, delivered, calm, (1.0 + constants.sea_margin) * calm)
