"""Design -> Evaluation at a level of fidelity; a failure is a value.

The chain: form, resistance at each condition, wake and thrust deduction, open-water curves, operating points
(``physics``), then the objectives, normalised by the initial design at the same level, and the constraints.
"""

from __future__ import annotations

import time
from dataclasses import replace

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.constraints import constraint_values
from hpsop_core.evaluation.curves import open_water_curve
from hpsop_core.evaluation.objectives import objective_values
from hpsop_core.evaluation.physics import Physics, compute
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import (
    FEASIBILITY_TOLERANCE,
    Evaluation,
    HullResult,
    PropellerResult,
    failed_evaluation,
)
from hpsop_core.geometry.clearance import baseline_clearance, propeller_clearance
from hpsop_core.one_thread import one_blas_thread

LEVELS = (1, 2)


@one_blas_thread()
def evaluate(
    case: Case, variables: DesignVariables | None = None, level: int = 1, reference: Reference | None = None
) -> Evaluation:
    """Everything about a design at a level.

    Args:
        case: what is optimised.
        variables: the design; the initial one by default.
        level: 1 (Michell, lifting line) or 2 (Rankine and blade panels).
        reference: the initial design's numbers at this level; computed when it is not given.

    Returns:
        The evaluation. It never raises for a design that cannot be computed: status is then "failed".

    Raises:
        ValueError: level is neither 1 nor 2, or the reference belongs to the other level.
        InputError: a file that the case names cannot be used.
    """
    if level not in LEVELS:
        raise ValueError(f"level {level} is neither 1 nor 2")
    started = time.perf_counter()
    design = case.initial.variables if variables is None else variables
    try:
        basis = reference_for(case, level) if reference is None else reference
        if basis.level != level:
            raise ValueError(f"a reference of level {basis.level} cannot normalise level {level}")
        result = _assess(case, design, level, basis, compute(case, design, level, basis.basis))
        return replace(result, elapsed=time.perf_counter() - started)
    except SolverFailure as failure:
        elapsed = time.perf_counter() - started
        return failed_evaluation(case.name, design, level, failure.stage, failure.reason, elapsed)


def _assess(case: Case, variables: DesignVariables, level: int, basis: Reference, physics: Physics) -> Evaluation:
    hull, propeller, conditions = physics.hull, physics.propeller, physics.conditions
    clearance = propeller_clearance(hull, propeller)
    constraints = constraint_values(case, level, variables, basis, physics, clearance)
    objectives = objective_values(basis, physics)
    affine = case.hull.form == "affine"
    warnings = [*hull.warnings, *physics.warnings]
    if clearance < 0.0:
        warnings.append(f"the propeller would cut the hull: tip clearance {clearance:.2f} m; reduce its diameter")
    if baseline_clearance(hull, propeller) < 0.0:
        warnings.append("the blade tips reach below the baseline; reduce the diameter or raise the draft")
    if constraints["form"] is not None and constraints["form"] > FEASIBILITY_TOLERANCE and affine:
        warnings.append(f"booked block coefficient {physics.effective_block_coefficient:.3f} is outside its limits")
    hydrostatics = hull.hydrostatics
    return Evaluation(
        case=case.name,
        level=level,
        status="ok",
        reason="",
        variables=variables,
        hull=HullResult(
            length=hull.length,
            breadth=hull.breadth,
            draft=hull.draft,
            block_coefficient=hydrostatics.block_coefficient,
            displaced_volume=hydrostatics.displaced_volume,
            wetted_surface=hydrostatics.wetted_surface,
            longitudinal_centre_of_buoyancy=hydrostatics.longitudinal_centre_of_buoyancy,
            clipped=hull.clipped,
            booked_block_coefficient=physics.effective_block_coefficient if affine else None,
            booked_volume=physics.effective_volume if affine else None,
        ),
        propeller=PropellerResult(
            diameter=propeller.diameter,
            blade_count=propeller.blade_count,
            pitch_ratio=propeller.pitch_ratio,
            pitch_diameter_ratio_07R=propeller.pitch_diameter_ratio_07R,
            expanded_area_ratio=propeller.expanded_area_ratio,
            shaft_height=hull.shaft_height,
            tip_clearance=clearance,
        ),
        conditions=conditions,
        objectives={"f1": objectives[case.objectives.first], "f2": objectives[case.objectives.second]},
        all_objectives=objectives,
        constraints=constraints,
        feasible=all(value <= FEASIBILITY_TOLERANCE for value in constraints.values() if value is not None),
        warnings=tuple(warnings),
        open_water=open_water_curve(physics.curve),
    )
