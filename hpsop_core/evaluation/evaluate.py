"""Design -> Evaluation at a level of fidelity; a failure is a value.

The chain: form, resistance at each condition, wake and thrust deduction, open-water curves, operating points
(``physics``), then the objectives, normalised by the initial design at the same level, and the constraints.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from hpsop_core.case.case import Case
from hpsop_core.case.constraints import CONSTRAINTS, Constraint
from hpsop_core.case.design_numbers import DesignNumbers
from hpsop_core.case.objectives import OBJECTIVES, Objective
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.curves import open_water_curve
from hpsop_core.evaluation.levels import level_of
from hpsop_core.evaluation.physics import Physics, compute
from hpsop_core.evaluation.propeller_answer import propeller_warnings
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation, Failed, Ok
from hpsop_core.evaluation.ship import profile_eedi, ship_warnings
from hpsop_core.one_thread import one_blas_thread


@one_blas_thread()
def evaluate(
    case: Case,
    variables: DesignVariables | Mapping[str, object] | None = None,
    level: int = 1,
    reference: Reference | None = None,
    objectives: Sequence[Objective] = OBJECTIVES,
    constraints: Sequence[Constraint] = CONSTRAINTS,
) -> Evaluation:
    """Everything about a design at a level.

    Args:
        case: what is optimised.
        variables: the design, or what is changed of the initial one (``Case.design``); the initial one by default.
        level: 1 (Michell, lifting line) or 2 (Rankine and blade panels).
        reference: the initial design's numbers at this level; computed when it is not given.
        objectives: to be computed, the case's two among them; the declared ones by default.
        constraints: to be kept; the declared ones by default.

    Returns:
        The evaluation. It never raises for a design that cannot be computed: it is then ``Failed``.

    Raises:
        ValueError: level is neither 1 nor 2, or the reference belongs to the other level.
        InputError: a file that the case names cannot be used; or the case's loading or engine is none, see
            ``reference_for``.
    """
    level_of(level)
    started = time.perf_counter()
    design = variables if isinstance(variables, DesignVariables) else case.design(variables or {})
    try:
        basis = reference_for(case, level) if reference is None else reference
        if basis.level != level:
            raise ValueError(f"a reference of level {basis.level} cannot normalise level {level}")
        physics = compute(case, design, level, basis.basis, basis.surface, basis.propellers)
        result = assessed(case, physics, basis, objectives, constraints)
        return replace(result, elapsed=time.perf_counter() - started)
    except SolverFailure as failure:
        elapsed = time.perf_counter() - started
        return Failed(case.name, level, design, failure.stage, failure.reason, elapsed)


def assessed(
    case: Case,
    physics: Physics,
    reference: Reference,
    objectives: Sequence[Objective],
    constraints: Sequence[Constraint],
) -> Ok:
    """The evaluation of a design's physics.

    Raises:
        SolverFailure: a number is missing for one of the case's objectives.
    """
    design, initial = physics.numbers, reference.initial
    values = {objective.name: objective.value(design, initial) for objective in objectives}
    known = {name: value for name, value in values.items() if value is not None}
    for name in (case.objectives.first, case.objectives.second):
        if name not in known:
            raise SolverFailure("objectives", f"the numbers for {name} are missing; choose another objective")
    kept = {constraint.name: constraint.value(design, initial, case) for constraint in constraints}
    violated = {constraint.name for constraint in constraints if constraint.is_violated(kept[constraint.name])}
    fuel = design.fuel_per_hour
    return Ok(
        case=case.name,
        level=design.level,
        variables=design.variables,
        hull=design.hull,
        propeller=design.propeller,
        conditions=design.conditions,
        objectives={"f1": known[case.objectives.first], "f2": known[case.objectives.second]},
        all_objectives=known,
        constraints=kept,
        feasible=not violated,
        warnings=(
            *physics.warnings,
            *propeller_warnings(case.propeller),
            *_warnings(design, "form" in violated),
            *ship_warnings(case, design),
        ),
        open_water=open_water_curve(physics.curve),
        active_bounds=case.bounds.active(design.variables),
        fuel_per_hour=fuel,
        carbon_dioxide_per_hour=None if fuel is None else case.engine.fuel_carbon_factor * fuel,
        attained_eedi_g_per_tonne_mile=profile_eedi(case, design),
        predicted=physics.predicted,
        propeller_tabulated=physics.propeller_tabulated,
    )


def _warnings(design: DesignNumbers, form_violated: bool) -> list[str]:
    clearance = design.propeller.tip_clearance
    warnings = []
    if clearance < 0.0:
        warnings.append(
            f"the propeller would cut the hull: tip clearance {clearance:.2f} m; reduce its diameter, or "
            "state hull.boss_x further aft or hull.shaft_height lower"
        )
    if design.baseline_clearance < 0.0:
        warnings.append("the blade tips reach below the baseline; reduce the diameter or raise the draft")
    if form_violated and design.hull.booked_volume is not None:
        warnings.append(f"booked block coefficient {design.block_coefficient:.3f} is outside its limits")
    return warnings
