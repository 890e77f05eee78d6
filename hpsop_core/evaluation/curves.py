"""What is drawn of a design beyond its evaluation: resistance and thrust over speed, sections, sectional areas."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.hull_answer import (
    HullVariables,
    ResistancePoint,
    build_hull,
    hull_variables,
    resistance_point,
    wave_answers,
)
from hpsop_core.evaluation.physics import basis_for, design_factors
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation, OpenWaterCurve
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.hydro.operating_point import PropellerCurve
from hpsop_core.typing_aliases import Array

FROUDE_MARGIN = 0.05
"""Resistance curves reach this far beyond the conditions' Froude numbers, up to 0.5."""

SLOWEST = 0.15
"""They go down no further than this, or than the slowest condition: the waves are then finer than level 2's grid."""

CURVE_STEP = 0.05
"""Steps of the advance coefficient in an evaluation's open-water curve."""

FROUDE_STEP = 0.01
"""Steps of the Froude number in a resistance curve."""

_FASTEST = 0.5
# a step of the table nearer to a condition than this part of a step would only double it
_APART = 0.02

# The classic twenty, denser towards the ends where the form changes fast, and the bulb ahead of FP.
_STATIONS = np.array([-0.2, 0.0, 0.5, 1.0, 1.5, *range(2, 19), 18.5, 19.0, 19.5, 20.0, 20.2])


def resistance_curve(
    case: Case,
    variables: DesignVariables,
    level: int,
    froude_numbers: tuple[float, ...],
    reference: Reference | None = None,
    form_factor: float | None = None,
) -> tuple[ResistancePoint, ...]:
    """Resistance of a design at any Froude numbers (on its own length), calibrated as in its evaluation.

    Args:
        case: what is optimised.
        variables: the design.
        level: 1 or 2.
        froude_numbers: at which to compute.
        reference: of this level; only its V0 and calibration are used.
        form_factor: k; the case's by default.

    Raises:
        SolverFailure: the form or its waves cannot be computed.
    """
    basis = basis_for(case, level) if reference is None else reference.basis
    key = hull_variables(case.hull, variables, basis.displaced_volume)
    waves = wave_answers(key, level, tuple(froude_numbers))
    constants = case.constants
    calibration = basis.calibration_of(case, build_hull(key), variables)
    factors, _ = design_factors(case, variables, build_hull(key), basis, form_factor)
    return tuple(
        resistance_point(
            build_hull(key),
            wave,
            froude,
            gravity=constants.gravity,
            density=constants.density,
            viscosity=constants.viscosity,
            factors=factors,
            wave_calibration=calibration(froude),
        )
        for froude, wave in zip(froude_numbers, waves, strict=True)
    )


def froude_range(evaluation: Evaluation, above: float = FROUDE_MARGIN, step: float = FROUDE_STEP) -> tuple[float, ...]:
    """Froude numbers, ascending, at which a design's resistance is tabulated; its conditions are among them.

    Args:
        evaluation: the design's.
        above: how far beyond the greatest condition.
        step: between them.
    """
    conditions = [condition.froude_number for condition in evaluation.conditions]
    return tuple(sorted({*_steps(conditions, above, step), *conditions}))


def _steps(conditions: Sequence[float], above: float, step: float) -> list[float]:
    slowest = min(conditions)
    low, high = max(min(SLOWEST, slowest), slowest - FROUDE_MARGIN), min(_FASTEST, max(conditions) + above)
    steps = np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step
    return [round(float(value), 6) for value in steps]


def common_speeds(
    case: Case, evaluation: Evaluation, above: float = FROUDE_MARGIN, step: float = FROUDE_STEP
) -> tuple[float, ...]:
    """Where a case fixes speeds: a design's Froude numbers at the speeds at which every design is tabulated.

    These are the initial design's of ``froude_range``, less those that this design's own length takes out of range; its
    conditions are among them.
    """
    conditions = [condition.froude_number for condition in evaluation.conditions]
    scale = conditions[0] / case.froude_numbers[0]
    low = min(SLOWEST, *conditions)
    own = [round(scale * froude, 6) for froude in _steps(case.froude_numbers, above, step)]
    apart = [
        froude
        for froude in own
        if low <= froude <= _FASTEST and all(abs(froude - other) > _APART * step for other in conditions)
    ]
    return tuple(sorted({*apart, *conditions}))


def resistance_points(
    case: Case,
    evaluation: Evaluation,
    reference: Reference,
    above: float = FROUDE_MARGIN,
    step: float = FROUDE_STEP,
) -> tuple[ResistancePoint, ...]:
    """Resistance over speed at the evaluation's level, calibrated as the evaluation was.

    Where the case fixes speeds, every design is tabulated at the same ones (``common_speeds``), else each over its own
    ``froude_range``. Speeds slower than every condition that the level cannot give, their waves too short for its grid,
    are left out.

    Raises:
        SolverFailure: the design failed, or another speed cannot be computed.
    """
    if not evaluation.ok:
        raise SolverFailure("curves", evaluation.reason)
    if case.conditions.speeds_are_fixed:
        froude_numbers = common_speeds(case, evaluation, above, step)
    else:
        froude_numbers = froude_range(evaluation, above, step)
    level, slowest = evaluation.level, min(condition.froude_number for condition in evaluation.conditions)
    try:
        return resistance_curve(case, evaluation.variables, level, froude_numbers, reference)
    except SolverFailure:
        key = hull_variables(case.hull, evaluation.variables, basis_for(case, level).displaced_volume)
        first = next(
            k for k, froude in enumerate(froude_numbers) if froude >= slowest or _has_waves(key, level, froude)
        )
        if first == 0:
            raise
        return resistance_curve(case, evaluation.variables, level, froude_numbers[first:], reference)


def _has_waves(hull: HullVariables, level: int, froude_number: float) -> bool:
    """Whether a level can give a hull's waves at a Froude number."""
    try:
        wave_answers(hull, level, (froude_number,))
    except SolverFailure:
        return False
    return True


@dataclass(frozen=True, eq=False)
class ThrustCurves:
    """Thrust over speed.

    Attributes:
        froude_number: (n,) on the design's own length.
        speed: (n,) in m/s.
        required: (n,) Rt/(1 - t) in N.
        available: one (n,) a condition: T in N at that condition's rate of rotation; NaN outside the open-water curve.
    """

    froude_number: Array
    speed: Array
    required: Array
    available: tuple[Array, ...]


def thrust_curves(case: Case, evaluation: Evaluation, points: tuple[ResistancePoint, ...]) -> ThrustCurves:
    """Thrust required and available over the speeds of a resistance curve.

    Raises:
        SolverFailure: the design failed.
    """
    if not evaluation.ok:
        raise SolverFailure("curves", evaluation.reason)
    curve = evaluation.open_water
    speed = np.array([point.speed for point in points])
    diameter = evaluation.variables.diameter
    thrust_coefficient = CubicSpline(curve.advance_coefficient, curve.thrust_coefficient, extrapolate=False)
    available = []
    for condition in evaluation.conditions:
        rate = condition.rotation_rate_rpm / 60.0
        advance = (1.0 - condition.wake_fraction) * speed / (rate * diameter)
        available.append(case.constants.density * rate**2 * diameter**4 * thrust_coefficient(advance))
    total = np.array([point.total_resistance for point in points])
    froude_number = np.array([point.froude_number for point in points])
    # t follows w, and w by Holtrop changes a little with the speed: each condition lies on the curve.
    deduction = np.interp(
        froude_number,
        [condition.froude_number for condition in evaluation.conditions],
        [condition.thrust_deduction for condition in evaluation.conditions],
    )
    return ThrustCurves(
        froude_number=froude_number,
        speed=speed,
        required=total / (1.0 - deduction),
        available=tuple(available),
    )


@dataclass(frozen=True, eq=False)
class DesignCurves:
    """What a design does over speed.

    Attributes:
        points: resistance, ascending in Froude number.
        thrust: required and available at the same Froude numbers.
    """

    points: tuple[ResistancePoint, ...]
    thrust: ThrustCurves


def open_water_curve(curve: PropellerCurve) -> OpenWaterCurve:
    """A propeller's curve in steps of ``CURVE_STEP`` of the advance coefficient."""
    lower, upper = curve.range
    advance = np.arange(lower, upper + 0.5 * CURVE_STEP, CURVE_STEP)
    thrust, torque = curve.coefficients(advance)
    # Beyond zero thrust the quotient of two small numbers means nothing: no useful work is done there.
    efficiency = np.where(thrust > 0.0, advance * thrust / (2.0 * math.pi * torque), 0.0)
    return OpenWaterCurve(*(tuple(float(value) for value in row) for row in (advance, thrust, torque, efficiency)))


def through(x: Array, y: Array, count: int = 200) -> tuple[Array, Array]:
    """A line without overshoot through points (n,), for drawing; the points are among its own, NaN is left out."""
    keep = np.isfinite(y)
    if np.count_nonzero(keep) < 3:
        return x[keep], y[keep]
    dense = np.union1d(np.linspace(x[keep][0], x[keep][-1], count), x[keep])
    return dense, np.asarray(PchipInterpolator(x[keep], y[keep])(dense))


def smooth_open_water(curve: OpenWaterCurve, count: int = 181) -> tuple[Array, Array, Array, Array]:
    """J, KT, 10KQ and efficiency, each (count,): splines through the tabulated KT and KQ; NaN where KT <= 0."""
    advance = np.asarray(curve.advance_coefficient)
    j = np.linspace(advance[0], advance[-1], count)
    kt, kq = (
        np.asarray(CubicSpline(advance, values)(j)) for values in (curve.thrust_coefficient, curve.torque_coefficient)
    )
    gives = (kt > 0.0) & (kq > 0.0)
    efficiency = np.full(count, np.nan)
    efficiency[gives] = j[gives] * kt[gives] / (2.0 * np.pi * kq[gives])
    return j, np.where(gives, kt, np.nan), np.where(gives, 10.0 * kq, np.nan), efficiency


@dataclass(frozen=True, eq=False)
class HullLines:
    """Sections and areas of a hull.

    Attributes:
        sections: (station from 0 at AP to 20 at FP, polylines (n, 2) of y and z in m, port side).
        area_station: (n,) x/Lpp from AP.
        area: (n,) immersed sectional area in m2.
        length, draft: in m.
    """

    sections: tuple[tuple[float, tuple[Array, ...]], ...]
    area_station: Array
    area: Array
    length: float
    draft: float


def hull_lines(case: Case, variables: DesignVariables) -> HullLines:
    """Sections and sectional areas of a design.

    Raises:
        SolverFailure: the form cannot be made.
    """
    hull = design_hull(case, variables)
    cut = zip(_STATIONS, hull.sections(_STATIONS / 20.0 * hull.length, points=41), strict=True)
    hydrostatics = hull.hydrostatics
    return HullLines(
        sections=tuple((float(station), tuple(line[:, 1:] for line in lines)) for station, lines in cut if lines),
        area_station=np.asarray(hydrostatics.sectional_area_x) / hull.length,
        area=np.asarray(hydrostatics.sectional_area),
        length=hull.length,
        draft=hull.draft,
    )
