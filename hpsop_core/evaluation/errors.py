"""How sure the true level's numbers are: a design solved again with its waves on a finer mesh.

What mesh and plane do to a wave coefficient goes through the whole evaluation, the initial design's included: the
error of a normalised objective is what the finer mesh changes of the *ratio*, which is far less than of the resistance.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import replace

from hpsop_core.case.case import Case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.evaluate import assessed, evaluate
from hpsop_core.evaluation.levels import REFINEMENT, TRUTH
from hpsop_core.evaluation.physics import compute_finer
from hpsop_core.evaluation.reference import Reference, initial_numbers, reference_for
from hpsop_core.evaluation.result import Evaluation, Failed, Ok
from hpsop_core.one_thread import one_blas_thread

# What the working mesh misses, over what the finer one adds. Flat panels converge with the square of their size: 2.8.
# Four forms on meshes of 1, 1.25 and 1.5: 10^4 Cw 3.80, 3.89, 3.99 (parent); 3.94, 4.25, 4.35; 2.52, 2.70, 2.78;
# 3.40, 3.64, 3.72 at Fn 0.22, which second order covers for all but the parent, by a little.
_LEFT_OVER = 1.0 / (1.0 - REFINEMENT**-2)
# Of ratios to the parent these forms' second step changed up to about a fifth of what the first one had; 1.5 is a
# judgement with room for forms that are less alike.
_LEFT_OVER_OF_RATIO = 1.5
_LEAST_RATIO_ERROR = 2e-4
"""Of a normalised objective: the working mesh's own unevenness from design to design (docs/theory-rankine.md)."""

CONDITION_NAMES = (
    "wave_coefficient",
    "wave_resistance",
    "total_resistance",
    "thrust",
    "torque",
    "rotation_rate_rpm",
    "open_water_efficiency",
    "delivered_power",
    "brake_power",
    "required_expanded_area_ratio",
)
"""Numbers of a condition whose errors are stated, under their names with _1, _2 ... for the condition."""


@one_blas_thread()
def evaluate_with_errors(case: Case, variables: DesignVariables, level: int, reference: Reference | None) -> Evaluation:
    """A design at the true level, with ``errors``: half widths of 90 % intervals by quantity.

    Two contributions are added in quadrature. *Mesh*: what is left below the working mesh, from the difference to the
    finer one. *Plane against pressure*, of resistances and what follows from them alone: half the difference between
    both ways of finding the finer mesh's wave resistance, in proportion. k, wake and thrust deduction are taken as
    stated; what they are worth is docs/what-to-believe.md's.

    Args:
        case: what is optimised.
        variables: the design.
        level: the true one's number.
        reference: of this level; computed when it is not given.

    Raises:
        ValueError: another level.
    """
    if level != TRUTH.number:
        raise ValueError(f"errors are stated at level {TRUTH.number} only, not {level}")
    started = time.perf_counter()
    try:
        basis = reference_for(case, level) if reference is None else replace(reference, surface=None)
        plain = evaluate(case, variables, level, basis)
        if not plain.ok:
            return plain
        numbers = compute_finer(case, case.initial.variables, basis.basis).numbers
        finer_reference = replace(basis, initial=initial_numbers(basis.basis.displaced_volume, numbers))
        physics = compute_finer(case, variables, basis.basis)
        finer = assessed(case, physics, finer_reference, OBJECTIVES, CONSTRAINTS)
    except SolverFailure as failure:
        return Failed(case.name, level, variables, failure.stage, failure.reason, time.perf_counter() - started)
    return replace(plain, errors=_errors(plain, finer), elapsed=time.perf_counter() - started)


def _errors(plain: Ok, finer: Ok) -> Mapping[str, float]:
    errors = {
        name: max(_LEFT_OVER_OF_RATIO * abs(finer.objectives[name] - value), _LEAST_RATIO_ERROR * abs(value))
        for name, value in plain.objectives.items()
    }
    for place, (coarse, fine) in enumerate(zip(plain.conditions, finer.conditions, strict=True), 1):
        pressure = fine.wave_coefficient_pressure
        apart = 0.0 if pressure is None else 0.5 * abs(pressure / fine.wave_coefficient - 1.0)
        moved = fine.wave_coefficient / coarse.wave_coefficient - 1.0
        for name in CONDITION_NAMES:
            one, two = getattr(coarse, name), getattr(fine, name)
            if one is None or two is None:
                continue
            mesh = _LEFT_OVER * abs(two - one)
            # To first order all of these go with the waves: what a change of waves by ``moved`` did, one by ``apart``
            # does in proportion.
            plane = abs(two - one) * apart / abs(moved) if moved else 0.0
            errors[f"{name}_{place}"] = math.hypot(mesh, plane)
    for name in ("fuel_per_hour", "carbon_dioxide_per_hour"):
        one, two = getattr(plain, name), getattr(finer, name)
        if one is not None and two is not None:
            errors[name] = _LEFT_OVER * abs(two - one)
    return errors
