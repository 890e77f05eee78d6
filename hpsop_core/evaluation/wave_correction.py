"""Level 1's wave resistance corrected towards level 2 by a smooth function, learnt on hulls of the case's own space.

The thin ship's waves are wrong by a factor that depends on the form; one factor, the initial design's, leaves the
ranking of forms of other fullness wrong. The logarithm of the factor is regressed over what a hull's waves depend on
(``surface.hull_inputs``), a condition apart, from a few dozen hulls that both levels' solvers are asked for.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.gaussian_process import GaussianProcess, fit, refitted
from hpsop_core.evaluation.hull_answer import build_hull, hull_variables, wave_answers
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.evaluation.surface import hull_inputs
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.typing_aliases import Array

_TRIED = 16  # designs of the space that are looked at for each whose form carries what is asked
_BEYOND = 0.2  # of the logarithm: never further beyond what was learnt

Rows: TypeAlias = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class WaveCorrection:
    """What was learnt from, a condition apart; hashable, so that each process fits once.

    Attributes:
        inputs: (conditions, hulls, numbers) of ``hull_inputs``.
        logarithms: (conditions, hulls) ln of level 2's wave coefficient over level 1's.
        kernels: (conditions, numbers + 1) length scales and nugget of each regression where they have been found
            before, as in the shipped cases' files; empty where each process finds them: a third of a second.
        true_waves: (conditions, hulls) ln of level 2's wave coefficient; empty in files of earlier versions.
    """

    inputs: tuple[Rows, ...]
    logarithms: Rows
    kernels: Rows = ()
    true_waves: Rows = ()

    def __hash__(self) -> int:
        # Asked for at every evaluation; the inputs, ten times as many numbers, tell nothing apart that these do not.
        return hash(self.logarithms)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> WaveCorrection:
        """What ``dataclasses.asdict`` described, from JSON."""
        inputs = tuple(tuple(tuple(row) for row in rows) for rows in data["inputs"])
        rest = ("logarithms", "kernels", "true_waves")
        return cls(inputs, **{name: tuple(tuple(row) for row in data.get(name, ())) for name in rest})

    def with_kernels(self) -> WaveCorrection:
        """The same with the kernels of its regressions."""
        found = (tuple(map(float, (*regression.scales, regression.nugget))) for regression in _fitted(self))
        return dataclasses.replace(self, kernels=tuple(found))

    def solved_hulls(self) -> tuple[tuple[Array, Array], ...]:
        """What level 2 said of the hulls, as ``surface.learn`` takes it; nothing where that was not kept."""
        return tuple((np.array(rows), np.array(logs)) for rows, logs in zip(self.inputs, self.true_waves, strict=False))

    def factors(self, hull: Hull, variables: DesignVariables, froude_numbers: Sequence[float]) -> tuple[float, ...]:
        """The factor on level 1's wave resistance at each condition's Froude number."""
        found = []
        for regression, known, froude in zip(_fitted(self), self.logarithms, froude_numbers, strict=True):
            logarithm = float(regression.mean_at(hull_inputs(hull, variables, froude))[0])
            # Beyond what it knows a regression may say anything.
            found.append(float(np.exp(np.clip(logarithm, min(known) - _BEYOND, max(known) + _BEYOND))))
        return tuple(found)


@lru_cache(maxsize=8)
def _fitted(correction: WaveCorrection) -> tuple[GaussianProcess, ...]:
    regressions = []
    kernels = correction.kernels or (None,) * len(correction.inputs)
    for rows, logarithms, kernel in zip(correction.inputs, correction.logarithms, kernels, strict=True):
        data = np.array(rows), np.array(logarithms)[:, None]
        regression = fit(*data) if kernel is None else refitted(*data, np.array(kernel[:-1]), kernel[-1])
        if regression is None:
            raise SolverFailure("wave_calibration", "nothing can be learnt from the hulls of this space")
        regressions.append(regression)
    return tuple(regressions)


def learn_correction(case: Case, displaced_volume: float, speeds: Sequence[float]) -> WaveCorrection:
    """Ask both levels for the waves of hulls spread over the case's space, the initial one among them.

    Args:
        case: what is optimised.
        displaced_volume: V0 in m3.
        speeds: of the conditions in m/s, where each design is asked for them; else its length decides them.

    Raises:
        SolverFailure: fewer than half of the hulls could be had; another wave_calibration helps.
    """
    from scipy.stats import qmc  # a slow import that only the beginning of a run needs

    space = case.bounds
    lower, upper = space.relaxed_lower, space.relaxed_upper
    hulls = case.constants.wave_calibration_hulls
    tried = 2 ** math.ceil(math.log2(_TRIED * hulls))
    points = qmc.Sobol(max(1, len(space.free)), scramble=False).random(tried)[:, : len(space.free)]
    designs = [case.initial.variables, *(space.decode(lower + point * (upper - lower)) for point in points)]
    conditions = len(case.froude_numbers)
    inputs: list[list[tuple[float, ...]]] = [[] for _ in range(conditions)]
    logarithms: list[list[float]] = [[] for _ in range(conditions)]
    true_waves: list[list[float]] = [[] for _ in range(conditions)]
    for design in dict.fromkeys(designs):
        if len(logarithms[0]) > hulls:
            break
        key = hull_variables(case.hull, design, displaced_volume)
        try:
            hull = build_hull(key)
            if hull.clipped:
                continue
            froude_numbers = own_froude_numbers(case, hull, speeds)
            fast, true = (wave_answers(key, level.number, froude_numbers) for level in (FAST, TRUTH))
        except SolverFailure:
            continue
        ratios = [two.wave_coefficient / one.wave_coefficient for one, two in zip(fast, true, strict=True)]
        if min(ratios) <= 0.0:
            continue
        for place, (froude, ratio, answer) in enumerate(zip(froude_numbers, ratios, true, strict=True)):
            inputs[place].append(tuple(map(float, hull_inputs(hull, design, froude))))
            logarithms[place].append(float(np.log(ratio)))
            true_waves[place].append(float(np.log(answer.wave_coefficient)))
    if len(logarithms[0]) <= hulls // 2:
        raise SolverFailure(
            "wave_calibration",
            f"only {len(logarithms[0])} hulls of the space can be solved to learn from; set wave_calibration = level2",
        )
    return WaveCorrection(
        tuple(map(tuple, inputs)), tuple(map(tuple, logarithms)), true_waves=tuple(map(tuple, true_waves))
    )


def own_froude_numbers(case: Case, hull: Hull, speeds: Sequence[float]) -> tuple[float, ...]:
    """A hull's Froude numbers at the conditions: from fixed speeds, or the case's own."""
    if case.conditions.speed == "fixed":
        return tuple(speed / (case.constants.gravity * hull.length) ** 0.5 for speed in speeds)
    return case.froude_numbers
