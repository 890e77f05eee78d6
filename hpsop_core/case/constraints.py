"""The constraints, each declared once: g <= 0 is kept.

To add one, add an entry to ``CONSTRAINTS``: evaluation, page, report, exports and the reference of the case file
follow. Its limits are fields of the case's [constraints].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import DesignNumbers, InitialNumbers

FEASIBILITY_TOLERANCE = 1e-6
"""A design whose every g is at most this is feasible: an optimum on a limit must not fail by rounding."""


@dataclass(frozen=True)
class Constraint:
    """A constraint.

    Attributes:
        name: in every result.
        symbol: of g.
        label: short, for tables.
        meaning: what g is, for the reference.
        applies: where it applies, for the reference.
        violated: what is wrong where g > 0.
        asked: what a case asks by it, with the case's numbers; "" where the case does not ask it.
        value: g from a design's numbers, the initial design's and the case; None where it is not applied.
    """

    name: str
    symbol: str
    label: str
    meaning: str
    applies: str
    violated: str
    asked: Callable[[Case], str]
    value: Callable[[DesignNumbers, InitialNumbers, Case], float | None]

    def is_violated(self, value: float | None) -> bool:
        """Whether a value of g breaks the constraint; one that is not applied never does."""
        return value is not None and value > FEASIBILITY_TOLERANCE


def _displacement(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float:
    return abs(design.displaced_volume / initial.displaced_volume - 1.0) - case.constraints.displacement_tolerance


def _displacement_asked(case: Case) -> str:
    return f"displacement within {100.0 * case.constraints.displacement_tolerance:.1f} % of the initial design's"


def _diameter_to_draft(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float:
    limits, ratio = case.constraints, design.propeller.diameter / design.hull.draft
    return max(limits.diameter_to_draft_lower - ratio, ratio - limits.diameter_to_draft_upper)


def _diameter_to_draft_asked(case: Case) -> str:
    limits = case.constraints
    return f"D/d from {limits.diameter_to_draft_lower:.2f} to {limits.diameter_to_draft_upper:.2f}"


def _cavitation(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    if design.level < case.constraints.g3_level:
        return None
    return design.conditions[0].required_expanded_area_ratio - design.propeller.expanded_area_ratio


def _cavitation_asked(case: Case) -> str:
    limits = case.constraints
    both = limits.g3_level == 1
    where = "at both levels" if both else "at level 2 only: the search at level 1 does not see cavitation"
    return f"expanded area ratio at least Keller's with K = {limits.keller_k:.2f} at the first condition, {where}"


def _form(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float:
    limits = case.constraints
    if case.hull.form == "affine":
        block = design.block_coefficient
        return max(limits.booked_block_coefficient_lower - block, block - limits.booked_block_coefficient_upper)
    if not design.hull.clipped:
        return 0.0
    asked = initial.displaced_volume * design.variables.displacement_ratio
    # At least visibly infeasible: the form is not the one that was asked for, even where its volume is close.
    return max(abs(design.displaced_volume / asked - 1.0), design.buoyancy_centre_missed, 1e-4)


def _form_asked(case: Case) -> str:
    limits = case.constraints
    if case.hull.form == "affine":
        lower, upper = limits.booked_block_coefficient_lower, limits.booked_block_coefficient_upper
        return f"booked block coefficient from {lower:.2f} to {upper:.2f}"
    return "the parent's form carries the displacement and LCB asked for"


def _propeller_clearance(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float:
    return -min(design.propeller.tip_clearance, design.baseline_clearance) / design.propeller.diameter


CONSTRAINTS: tuple[Constraint, ...] = (
    Constraint(
        name="displacement",
        symbol="g₁",
        label="displacement",
        meaning="relative change of displacement from the initial design's beyond displacement_tolerance",
        applies="always",
        violated="displacement differs from the initial design's by more than allowed",
        asked=_displacement_asked,
        value=_displacement,
    ),
    Constraint(
        name="diameter_to_draft",
        symbol="g₂",
        label="diameter / draft",
        meaning="D/d beyond diameter_to_draft_lower or diameter_to_draft_upper",
        applies="always",
        violated="D/d outside its limits",
        asked=_diameter_to_draft_asked,
        value=_diameter_to_draft,
    ),
    Constraint(
        name="cavitation",
        symbol="g₃",
        label="cavitation (Keller)",
        meaning="expanded area ratio that Keller's criterion requires at the first condition, minus the design's",
        applies="from level g3_level",
        violated="blade area below Keller's requirement",
        asked=_cavitation_asked,
        value=_cavitation,
    ),
    Constraint(
        name="form",
        symbol="g₄",
        label="form carries what is asked",
        meaning="form shift: what the clipped form misses of the displacement asked for, relative, or of LCB, over L, "
        "whichever is more; form affine: booked CB beyond its limits",
        applies="always",
        violated="the parent form does not carry this displacement or LCB",
        asked=_form_asked,
        value=_form,
    ),
    Constraint(
        name="propeller_clearance",
        symbol="g₅",
        label="propeller clear of hull and baseline",
        meaning="minus the lesser of the blade tips' clearance to the hull and their height above the baseline, over D",
        applies="always",
        violated="the propeller would cut the hull",
        asked=lambda case: "the blades clear the hull and stay above the baseline",
        value=_propeller_clearance,
    ),
)
