"""The constraints: g <= 0 is kept."""

from __future__ import annotations

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.physics import Physics
from hpsop_core.evaluation.reference import Reference
from hpsop_core.geometry.clearance import baseline_clearance
from hpsop_core.geometry.hull.hull import Hull


def constraint_values(
    case: Case, level: int, variables: DesignVariables, basis: Reference, physics: Physics, clearance: float
) -> dict[str, float | None]:
    """g <= 0 by name; the last two are ours: a form that is not reached, and blades that would cut the hull."""
    limits = case.constraints
    ratio = physics.propeller.diameter / physics.hull.draft
    asked = basis.displaced_volume * variables.displacement_ratio
    if case.hull.form == "affine":
        block = physics.effective_block_coefficient
        form = max(limits.booked_block_coefficient_lower - block, block - limits.booked_block_coefficient_upper)
    elif physics.hull.clipped:
        # At least visibly infeasible: the form is not the one that was asked for, even where its volume is close.
        form = max(abs(physics.effective_volume / asked - 1.0), _centre_missed(physics.hull, variables), 1e-4)
    else:
        form = 0.0
    cavitation_excess = None
    if level >= limits.g3_level:
        first = physics.conditions[0]
        cavitation_excess = first.required_expanded_area_ratio - physics.propeller.expanded_area_ratio
    return {
        "displacement": abs(physics.effective_volume / basis.displaced_volume - 1.0) - limits.displacement_tolerance,
        "diameter_to_draft": max(limits.diameter_to_draft_lower - ratio, ratio - limits.diameter_to_draft_upper),
        "cavitation": cavitation_excess,
        "form": form,
        "propeller_clearance": -min(clearance, baseline_clearance(physics.hull, physics.propeller))
        / physics.propeller.diameter,
    }


def _centre_missed(hull: Hull, variables: DesignVariables) -> float:
    """How far the centre of buoyancy of a clipped form lies from the asked place, as a fraction of the length."""
    parent = hull.parent
    own = parent.hydrostatics.longitudinal_centre_of_buoyancy / parent.length + variables.buoyancy_centre_shift
    return abs(hull.hydrostatics.longitudinal_centre_of_buoyancy / hull.length - own)
