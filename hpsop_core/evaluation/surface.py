"""A learnt surface: what the true level's solvers would say of a design, from what they have said of others.

In non-dimensional form the waves of a hull depend on few numbers: its proportions, its block coefficient, the place of
its centre of buoyancy and the Froude number. The logarithm of the wave coefficient is regressed over these, a condition
apart, and KT and KQ at the nodes of the open-water curve over the propeller's variables; hydrostatics, wetted surface,
friction and all that follows from resistance and curves are computed as ever. Where level 1 was taught by hulls that
level 2 solved, their waves are learnt from too. Each regression says how little it knows of a design: where that is
more than the doubts below, and for a clipped form, it does not answer and the solvers are asked.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.variables import VARIABLE_NAMES, DesignVariables
from hpsop_core.evaluation.gaussian_process import GaussianProcess, fit
from hpsop_core.evaluation.learnt_back import LearntBack, learn_back
from hpsop_core.evaluation.levels import WaveAnswer
from hpsop_core.evaluation.propeller_answer import (
    ADVANCE_RANGE,
    NODE_COUNT,
    PropellerAnswer,
    PropellerVariables,
    curve_nodes,
    propeller_variables,
)
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.hydro.operating_point import PropellerCurve
from hpsop_core.typing_aliases import Array

RESISTANCE_DOUBT = 0.005 / 4.0
"""Standard deviation of the total resistance at a condition, as a part of it, above which a design is solved: half a
per cent, the most that a prediction may be off, is four of them, for a regression may be too sure of itself."""

WAVE_DOUBT = 0.05
"""The same of a wave coefficient, as a part of itself, however little the waves matter: far from what it knows a
regression does not know how little."""

PROPELLER_DOUBT = 0.002
"""The same of KT and KQ at a node, as a part of their root mean square over the curve."""

FEWEST_DESIGNS = 20
"""Solved designs below which there is no surface."""

# Advance coefficients at which propellers work: there the efficiency's error is stated.
_WORKING_RANGE = (0.4, 0.95)
_OF_PROPELLER = tuple(item.name for item in dataclasses.fields(PropellerVariables) if item.name != "section")
# Of the form beside main dimensions, displacement and centre of buoyancy, which are measured on the hull itself.
_OTHERS = tuple(
    name
    for name in VARIABLE_NAMES
    if name not in _OF_PROPELLER
    and name not in ("length_to_breadth", "breadth_to_draft", "draft", "displacement_ratio", "buoyancy_centre_shift")
)


@dataclass(frozen=True)
class HeldOut:
    """How well a surface predicts each of its designs from all the others.

    Attributes:
        designs: that it was learnt from.
        answered: of these, predicted without doubt from the others; over them the errors are taken.
        resistance, greatest_resistance: root mean square and greatest error of the total resistance as a part of it,
            over all conditions.
        efficiency, greatest_efficiency: the same of the open-water efficiency.
        greatest_back_share: greatest error of the back's share under vapour pressure, where the case limits it.
    """

    designs: int
    answered: int
    resistance: float
    greatest_resistance: float
    efficiency: float
    greatest_efficiency: float
    greatest_back_share: float = 0.0


@dataclass(frozen=True)
class Told:
    """What a surface says of a design.

    Attributes:
        waves: at the conditions.
        deviations: standard deviation of each wave coefficient, as a part of it.
        propeller: open-water curves.
    """

    waves: tuple[WaveAnswer, ...]
    deviations: tuple[float, ...]
    propeller: PropellerAnswer

    def is_sure(self, conditions: Sequence[ConditionResult]) -> bool:
        """Whether the waves leave little enough doubt of the resistance that came of them."""
        return all(
            deviation * condition.wave_resistance <= RESISTANCE_DOUBT * condition.total_resistance
            for deviation, condition in zip(self.deviations, conditions, strict=True)
        )


@dataclass(frozen=True, eq=False)
class Surface:
    """What has been learnt; picklable.

    Attributes:
        waves: ln of the wave coefficient, one regression a condition.
        propeller: KT at the curve's nodes, then KQ.
        propeller_scale: root mean square of KT and of KQ over designs and nodes.
        held_out: its error.
        back: the share of the blades' back under vapour pressure; None where the case has no limit on it.
    """

    waves: tuple[GaussianProcess, ...]
    propeller: GaussianProcess
    propeller_scale: tuple[float, float]
    held_out: HeldOut
    back: LearntBack | None = None

    def answers(
        self,
        hull: Hull,
        variables: DesignVariables,
        froude_numbers: Sequence[float],
        propeller: PropellerVariables,
    ) -> Told | None:
        """Waves at the conditions and open-water curves; None where any of it is in doubt: solved is a whole design."""
        if hull.clipped:
            return None
        curve, doubt = self.propeller.predict(_propeller_inputs(propeller))
        for part, scale in zip(np.split(doubt, 2), self.propeller_scale, strict=True):
            if float(np.max(part)) > PROPELLER_DOUBT * scale:
                return None
        answers, deviations = [], []
        for regression, froude in zip(self.waves, froude_numbers, strict=True):
            logarithm, spread = regression.predict(hull_inputs(hull, variables, froude))
            if float(spread[0]) > WAVE_DOUBT:
                return None
            answers.append(WaveAnswer(math.exp(float(logarithm[0]))))
            deviations.append(float(spread[0]))
        thrust, torque = np.split(curve, 2)
        answer = PropellerAnswer(PropellerCurve(curve_nodes(), thrust, torque), None)
        return Told(tuple(answers), tuple(deviations), answer)

    def back_told(
        self, case: Case, variables: DesignVariables, conditions: Sequence[ConditionResult]
    ) -> tuple[ConditionResult, ...] | None:
        """As ``LearntBack.told``; None where nothing was learnt of it."""
        return None if self.back is None else self.back.told(case, variables, conditions)


def learn(
    case: Case, evaluations: Sequence[Mapping[str, Any]], hulls: Sequence[tuple[Array, Array]] = ()
) -> Surface | None:
    """Learn from solved designs of a case.

    Args:
        case: what is optimised.
        evaluations: JSON documents of the true level in a fixed order, on which the last bits depend; failed, predicted
            and clipped ones are left out.
        hulls: further ones whose waves are known, a condition apart: (n, numbers) of ``hull_inputs`` and (n,) ln of the
            wave coefficient.

    Returns:
        The surface; None where there are too few designs, or a condition without waves.
    """
    used = [data for data in evaluations if data["status"] == "ok" and not data.get("predicted")]
    used = [data for data in used if not data["hull"].get("clipped")]
    # Of a wave too small for the solver's mesh there is no logarithm.
    if len(used) < FEWEST_DESIGNS or any(c["wave_coefficient"] <= 0.0 for data in used for c in data["conditions"]):
        return None
    waves, errors, sure = [], [], np.full(len(used), True)
    for place in range(len(case.conditions.weights)):
        points = [document["conditions"][place] for document in used]
        inputs = [_solved_inputs(document, place) for document in used]
        own = [[point["wave_coefficient"] / point["wave_calibration"]] for point in points]
        data = np.array(inputs), np.log(own)
        if hulls:
            data = np.vstack([data[0], hulls[place][0]]), np.vstack([data[1], hulls[place][1][:, None]])
        regression = fit(*data)
        if regression is None:
            return None
        waves.append(regression)
        shares = np.array([point["wave_resistance"] / point["total_resistance"] for point in points])
        errors.append(regression.held_out[: len(used), 0] * shares)
        deviation = regression.held_out_deviation[: len(used), 0]
        sure &= (deviation <= WAVE_DOUBT) & (deviation * shares <= RESISTANCE_DOUBT)
    designs = [DesignVariables.from_dict(data["variables"]) for data in used]
    keys = [_propeller_inputs(propeller_variables(case.propeller, design)) for design in designs]
    curves = np.array([_node_values(data["open_water"]) for data in used])
    propeller = fit(np.array(keys), curves)
    if propeller is None:
        return None
    scale = [float(np.sqrt(np.mean(part**2))) for part in np.split(curves, 2, axis=1)]
    for part, size in zip(np.split(propeller.held_out_deviation, 2, axis=1), scale, strict=True):
        sure &= np.max(part, axis=1) <= PROPELLER_DOUBT * size
    resistance = np.abs(np.stack(errors, axis=1)[sure])
    efficiency = np.abs(_efficiency_errors(propeller.held_out, curves)[sure])
    back = learn_back(case, used)
    return Surface(
        tuple(waves),
        propeller,
        (scale[0], scale[1]),
        HeldOut(
            len(used),
            int(np.sum(sure)),
            *_size(resistance),
            *_size(efficiency),
            0.0 if back is None else back.greatest_error,
        ),
        back,
    )


def _size(errors: Array) -> tuple[float, float]:
    """Root mean square and greatest; zeros of none."""
    return (float(np.sqrt(np.mean(errors**2))), float(np.max(errors))) if errors.size else (0.0, 0.0)


def _efficiency_errors(errors: Array, curves: Array) -> Array:
    nodes = curve_nodes()
    working = np.flatnonzero((nodes >= _WORKING_RANGE[0]) & (nodes <= _WORKING_RANGE[1]))
    relative = errors / curves
    return np.asarray(relative[:, working] - relative[:, NODE_COUNT + working])


def _proportions(length: float, breadth: float, draft: float, block: float, centre: float) -> list[float]:
    return [length / breadth, breadth / draft, block, centre / length]


def hull_inputs(hull: Hull, variables: DesignVariables, froude_number: float) -> Array:
    """The numbers that a hull's waves depend on, without dimension."""
    form = hull.hydrostatics
    own = _proportions(
        hull.length, hull.breadth, hull.draft, form.block_coefficient, form.longitudinal_centre_of_buoyancy
    )
    return np.array([*own, froude_number, *_other_inputs(variables)])


def _solved_inputs(data: Mapping[str, Any], condition: int) -> Array:
    """The same of a solved design."""
    hull = data["hull"]
    names = ("length", "breadth", "draft", "block_coefficient", "longitudinal_centre_of_buoyancy")
    own = _proportions(*(hull[name] for name in names))
    froude_number = data["conditions"][condition]["froude_number"]
    return np.array([*own, froude_number, *_other_inputs(DesignVariables.from_dict(data["variables"]))])


def _other_inputs(variables: DesignVariables) -> list[float]:
    return [float(getattr(variables, name)) for name in _OTHERS]


def _propeller_inputs(propeller: PropellerVariables) -> Array:
    """The numbers that a propeller's curves depend on; the diameter acts through the drag alone."""
    return np.array([float(getattr(propeller, name)) for name in _OF_PROPELLER])


def _node_values(curves: Mapping[str, Sequence[float]]) -> Array:
    """KT, then KQ, at the nodes of the polynomial that an evaluation shows at even steps; shape (2 nodes,)."""
    lower, upper = ADVANCE_RANGE

    def scaled(advance: Array) -> Array:
        return np.asarray((2.0 * advance - lower - upper) / (upper - lower))

    advance = scaled(np.array(curves["advance_coefficient"]))
    values = np.array([curves["thrust_coefficient"], curves["torque_coefficient"]]).T
    series: Array = np.linalg.lstsq(chebyshev.chebvander(advance, NODE_COUNT - 1), values, rcond=None)[0]
    return np.concatenate(chebyshev.chebval(scaled(curve_nodes()), series))
