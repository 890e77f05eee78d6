"""The constraints, each declared once: g <= 0 is kept.

To add one, add an entry to ``CONSTRAINTS``: evaluation, page, report, exports and the reference of the case file
follow. Its limits are fields of the case's [constraints].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult, DesignNumbers, InitialNumbers
from hpsop_core.units import written

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
        near: a design whose g is above minus this stands on the limit; None where there is no limit to stand on.
    """

    name: str
    symbol: str
    label: str
    meaning: str
    applies: str
    violated: str
    asked: Callable[[Case], str]
    value: Callable[[DesignNumbers, InitialNumbers, Case], float | None]
    near: float | None = 0.005

    def is_violated(self, value: float | None) -> bool:
        """Whether a value of g breaks the constraint; one that is not applied never does."""
        return value is not None and value > FEASIBILITY_TOLERANCE

    def is_active(self, value: float | None) -> bool:
        """Whether a design stands on this limit, or beyond."""
        return value is not None and self.near is not None and value > -self.near


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


def is_judged(index: int, case: Case) -> bool:
    """Whether cavitation is judged at the condition of this index."""
    return case.constraints.cavitation_conditions == "all" or index == 0


def _judged(design: DesignNumbers, case: Case) -> tuple[ConditionResult, ...]:
    return tuple(condition for index, condition in enumerate(design.conditions) if is_judged(index, case))


def _where_judged(case: Case) -> str:
    return "at every condition" if case.constraints.cavitation_conditions == "all" else "at the first condition"


def _cavitation(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    if design.level < case.constraints.g3_level:
        return None
    required = max(condition.required_expanded_area_ratio for condition in _judged(design, case))
    return required - design.propeller.expanded_area_ratio


def _cavitation_asked(case: Case) -> str:
    limits = case.constraints
    both = limits.g3_level == 1
    where = "at both levels" if both else "at level 2 only: the search at level 1 does not see cavitation"
    whose = "Burrill's for 5 % back cavitation"
    if limits.cavitation_criterion == "keller":
        whose = f"Keller's with K = {limits.keller_k:.2f}"
    return f"expanded area ratio at least {whose} {_where_judged(case)}, {where}"


def _back_cavitation(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    limit = case.constraints.back_cavitation_limit
    shares = [condition.blade_cavitating_share for condition in _judged(design, case)]
    known = [share for share in shares if share is not None]
    return None if limit is None or not known else max(known) - limit


def _back_cavitation_asked(case: Case) -> str:
    limit = case.constraints.back_cavitation_limit
    if limit is None:
        return ""
    return f"at most {100.0 * limit:.1f} % of the blades' back below vapour pressure {_where_judged(case)} (level 2)"


def _tip_clearance(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    least = case.constraints.least_tip_clearance
    return None if least is None else least - design.propeller.tip_clearance / design.propeller.diameter


def _tip_clearance_asked(case: Case) -> str:
    least = case.constraints.least_tip_clearance
    return "" if least is None else f"the blade tips clear the hull by at least {100.0 * least:.1f} % of D"


def _length(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    greatest = case.constraints.greatest_length
    return None if greatest is None else design.hull.length / greatest - 1.0


def _length_asked(case: Case) -> str:
    greatest = case.constraints.greatest_length
    return "" if greatest is None else f"length at most {greatest:.2f} m"


def _breadth(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    greatest = case.constraints.greatest_breadth
    return None if greatest is None else design.hull.breadth / greatest - 1.0


def _breadth_asked(case: Case) -> str:
    greatest = case.constraints.greatest_breadth
    return "" if greatest is None else f"breadth at most {greatest:.2f} m"


def _metacentric_height(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    own = design.hull.metacentric_height
    return None if own is None else (case.loading.least_metacentric_height - own) / design.hull.breadth


def _metacentric_height_asked(case: Case) -> str:
    if case.loading.centre_of_gravity_height is None:
        return ""
    return f"metacentric height at least {case.loading.least_metacentric_height:.2f} m"


def _engine(design: DesignNumbers, initial: InitialNumbers, case: Case) -> float | None:
    excesses = [condition.engine_excess for condition in design.conditions]
    known = [excess for excess in excesses if excess is not None]
    return max(known) if known else None


def _engine_asked(case: Case) -> str:
    rating, rate = case.engine.maximum_continuous_rating, case.engine.rated_rotation_rate_rpm
    if rating is None:
        return ""
    torque = "" if rate is None else f", its torque at {rate:.1f} rpm and 105 % of that rate"
    return f"every condition within the engine's {written(1e-6 * rating, 'MW', 2)}{torque}"


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
        label="cavitation (blade area)",
        meaning="expanded area ratio that cavitation_criterion requires at cavitation_conditions, minus the design's",
        applies="from level g3_level",
        violated="blade area below what the cavitation criterion requires",
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
        near=None,
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
    Constraint(
        name="back_cavitation",
        symbol="g₆",
        label="back below vapour pressure",
        meaning="share of the blades' back below vapour pressure at cavitation_conditions, minus back_cavitation_limit",
        applies="at level 2, where back_cavitation_limit is stated",
        violated="more of the blades' back cavitates than allowed",
        asked=_back_cavitation_asked,
        value=_back_cavitation,
    ),
    Constraint(
        name="tip_clearance",
        symbol="g₇",
        label="tip clearance / D",
        meaning="least_tip_clearance minus the blade tips' distance from the hull over D",
        applies="where least_tip_clearance is stated",
        violated="the blade tips come closer to the hull than allowed",
        asked=_tip_clearance_asked,
        value=_tip_clearance,
    ),
    Constraint(
        name="length",
        symbol="g₈",
        label="length / greatest",
        meaning="length over greatest_length, minus 1",
        applies="where greatest_length is stated",
        violated="the ship is longer than allowed",
        asked=_length_asked,
        value=_length,
    ),
    Constraint(
        name="breadth",
        symbol="g₉",
        label="breadth / greatest",
        meaning="breadth over greatest_breadth, minus 1",
        applies="where greatest_breadth is stated",
        violated="the ship is broader than allowed",
        asked=_breadth_asked,
        value=_breadth,
    ),
    Constraint(
        name="metacentric_height",
        symbol="g₁₀",
        label="metacentric height",
        meaning="least_metacentric_height minus GM, over the breadth",
        applies="where centre_of_gravity_height is stated",
        violated="metacentric height below the least",
        asked=_metacentric_height_asked,
        value=_metacentric_height,
        near=0.001,
    ),
    Constraint(
        name="engine",
        symbol="g₁₁",
        label="engine layout",
        meaning="greatest of brake power, torque and rate of revolutions over the engine's limits, minus 1, over all "
        "conditions",
        applies="where maximum_continuous_rating is stated",
        violated="a condition lies outside the engine's layout",
        asked=_engine_asked,
        value=_engine,
    ),
)
