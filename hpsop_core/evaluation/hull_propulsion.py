"""What a case says about allowances, wake, thrust deduction and eta_R, as numbers of a design.

A formula of the case gives each of them, or the case states it. Stated for the initial design, the others follow by the
change of Holtrop's formula: a design has the stated number plus what the formula gives for it less what the formula
gives for the initial design.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.sections import ConstantsSection
from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.hydro import holtrop, interaction
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.powering import ResistanceFactors


@dataclass(frozen=True)
class HoltropNumbers:
    """What Holtrop's formulas give for a design.

    Attributes:
        form_factor: k1.
        correlation_allowance: C_A.
        wake_fractions: w at each condition.
        thrust_deduction: t.
        relative_rotative_efficiency: eta_R.
    """

    form_factor: float
    correlation_allowance: float
    wake_fractions: tuple[float, ...]
    thrust_deduction: float
    relative_rotative_efficiency: float


@dataclass(frozen=True)
class PropulsionFactors:
    """How hull and propeller meet at one condition: w, t and eta_R."""

    wake_fraction: float
    thrust_deduction: float
    relative_rotative_efficiency: float


def uses_holtrop(constants: ConstantsSection) -> bool:
    """Whether any number of a design of the case comes from Holtrop's formulas."""
    return (
        constants.form_factor_formula != "stated"
        or constants.correlation_allowance_formula != "stated"
        or constants.wake_formula in ("holtrop", "stated")
        or constants.thrust_deduction_formula != "schoenherr"
        or constants.relative_rotative_efficiency_formula != "stated"
    )


def holtrop_hull(hull: Hull, displaced_volume: float, constants: ConstantsSection) -> holtrop.HoltropHull:
    """A hull as Holtrop's method sees it, measured on its geometry.

    The bulb is the sectional area at the forward perpendicular, its centroid taken at half the draft (it only moves the
    allowance of ships with T/L below 0.04, by less than a tenth). Appendages are left out.

    Args:
        hull: of the design.
        displaced_volume: in m3, as the case counts it.
        constants: of the case.

    Raises:
        SolverFailure: the method has no value for such a form.
    """
    ends = hull.waterline(9)[:, 0]
    length = float(ends[-1] - ends[0])
    measured = hull.hydrostatics
    centre = measured.longitudinal_centre_of_buoyancy - float(ends[0])
    bulb = np.interp(hull.length, measured.sectional_area_x, measured.sectional_area)
    return holtrop.HoltropHull(
        length=length,
        breadth=hull.breadth,
        draft=hull.draft,
        displaced_volume=displaced_volume,
        midship_coefficient=measured.midship_coefficient,
        buoyancy_centre=100.0 * (centre / length - 0.5),
        wetted_surface=measured.wetted_surface,
        bulb_area=float(bulb),
        bulb_centre_height=0.5 * hull.draft,
        stern_shape=constants.stern_shape,
    )


def holtrop_numbers(
    ship: holtrop.HoltropHull, diameter: float, expanded_area_ratio: float, speeds: tuple[float, ...], viscosity: float
) -> HoltropNumbers:
    """What Holtrop's formulas give.

    Args:
        ship: the hull.
        diameter: D in m.
        expanded_area_ratio: of the propeller.
        speeds: at the conditions, in m/s.
        viscosity: of the water, in m2/s.

    Raises:
        SolverFailure: a formula leaves what can be.
    """
    form_factor = holtrop.form_factor(ship)
    allowance = holtrop.correlation_allowance(ship)
    wakes = []
    for speed in speeds:
        friction = ittc57_coefficient(speed * ship.length / viscosity)
        viscous = holtrop.viscous_coefficient(form_factor, friction, allowance)
        wakes.append(holtrop.wake_fraction(ship, viscous, diameter))
    return HoltropNumbers(
        form_factor=form_factor,
        correlation_allowance=allowance,
        wake_fractions=tuple(wakes),
        thrust_deduction=holtrop.thrust_deduction(ship, diameter),
        relative_rotative_efficiency=holtrop.relative_rotative_efficiency(ship, expanded_area_ratio),
    )


def holtrop_warnings(ship: holtrop.HoltropHull, speeds: tuple[float, ...], gravity: float) -> tuple[str, ...]:
    """One line where the ship is not like those that Holtrop's regression was made with."""
    found = holtrop.outside(ship, max(speeds) / (gravity * ship.length) ** 0.5)
    if not found:
        return ()
    return (
        f"Holtrop's formulas are used outside their ships: {', '.join(found)}; state the numbers from a test instead, "
        "or trust the differences between designs only",
    )


def unused_statements(constants: ConstantsSection) -> tuple[str, ...]:
    """One line for each number that a case states and its formulas do not use."""
    lines = []
    for name, formula, use, wasted in (
        (
            "stated_wake_fraction",
            "wake_formula",
            "stated",
            constants.stated_wake_fraction is not None and constants.wake_formula != "stated",
        ),
        (
            "stated_thrust_deduction",
            "thrust_deduction_formula",
            "stated",
            constants.stated_thrust_deduction is not None and constants.thrust_deduction_formula != "stated",
        ),
        (
            "correlation_allowance",
            "correlation_allowance_formula",
            "stated",
            constants.correlation_allowance != 0.0 and constants.correlation_allowance_formula == "holtrop",
        ),
    ):
        if wasted:
            chosen = getattr(constants, formula)
            lines.append(f'{name} is not used, for {formula} is {chosen}; write {formula} = "{use}" to use it')
    if constants.frontal_area == 0.0 and constants.air_drag_coefficient != ConstantsSection.air_drag_coefficient:
        lines.append("air_drag_coefficient is not used, for there is no frontal_area; state it in m2")
    return tuple(lines)


def resistance_factors(
    case: Case,
    hull: Hull,
    ship: holtrop.HoltropHull | None = None,
    initial: HoltropNumbers | None = None,
    form_factor: float | None = None,
) -> ResistanceFactors:
    """What makes the parts of a design's resistance beside friction and waves.

    Args:
        case: what it states.
        hull: of the design.
        ship: the same for Holtrop's method; None where the case does not use it.
        initial: what Holtrop's formulas give for the initial design; None where the case does not use them.
        form_factor: k instead of the case's.
    """
    constants = case.constants
    factor, allowance = constants.form_factor, constants.correlation_allowance
    if ship is not None and initial is not None:
        own_factor, own_allowance = holtrop.form_factor(ship), holtrop.correlation_allowance(ship)
        factor = _chosen(constants.form_factor_formula, factor, own_factor, initial.form_factor)
        allowance = _chosen(
            constants.correlation_allowance_formula, allowance, own_allowance, initial.correlation_allowance
        )
    return ResistanceFactors(
        form_factor=factor if form_factor is None else form_factor,
        correlation_allowance=allowance,
        air_drag_coefficient=constants.air_drag_coefficient,
        frontal_area=constants.frontal_area * (hull.breadth / case.initial.breadth),
        appendage_factor=constants.appendage_factor,
    )


def propulsion_factors(
    constants: ConstantsSection,
    block_coefficient: float,
    count: int,
    own: HoltropNumbers | None = None,
    initial: HoltropNumbers | None = None,
) -> tuple[PropulsionFactors, ...]:
    """w, t and eta_R of a design at each of ``count`` conditions.

    Args:
        constants: of the case.
        block_coefficient: C_B as the case counts it.
        count: of conditions.
        own, initial: what Holtrop's formulas give for the design and for the initial one; None where the case does not
            use them.

    Raises:
        SolverFailure: a number leaves what can be.
    """
    return tuple(_at_condition(constants, block_coefficient, index, own, initial) for index in range(count))


def _at_condition(
    constants: ConstantsSection,
    block_coefficient: float,
    index: int,
    own: HoltropNumbers | None,
    initial: HoltropNumbers | None,
) -> PropulsionFactors:
    if own is None or initial is None:
        wake = interaction.wake_fraction(block_coefficient, constants.wake_formula)
        deduction = interaction.thrust_deduction(wake, constants.thrust_deduction_factor)
        return PropulsionFactors(wake, deduction, constants.relative_rotative_efficiency)
    stated_wake, stated_deduction = constants.stated_wake_fraction, constants.stated_thrust_deduction
    if constants.wake_formula == "holtrop":
        wake = own.wake_fractions[index]
    elif constants.wake_formula == "stated" and stated_wake is not None:
        wake = _within("w", stated_wake + (own.wake_fractions[index] - initial.wake_fractions[index]))
    else:
        wake = interaction.wake_fraction(block_coefficient, constants.wake_formula)
    if constants.thrust_deduction_formula == "holtrop":
        deduction = own.thrust_deduction
    elif constants.thrust_deduction_formula == "stated" and stated_deduction is not None:
        deduction = _within("t", stated_deduction + (own.thrust_deduction - initial.thrust_deduction))
    else:
        deduction = interaction.thrust_deduction(wake, constants.thrust_deduction_factor)
    rotative = _chosen(
        constants.relative_rotative_efficiency_formula,
        constants.relative_rotative_efficiency,
        own.relative_rotative_efficiency,
        initial.relative_rotative_efficiency,
    )
    return PropulsionFactors(wake, deduction, rotative)


def _chosen(formula: str, stated: float, own: float, initial: float) -> float:
    """The number as stated, or scaled with Holtrop's (stated for the initial design), or Holtrop's own."""
    if formula == "holtrop":
        return own
    return stated + (own - initial) if formula == "scaled" else stated


def _within(name: str, value: float) -> float:
    if not 0.0 <= value <= 0.6:
        raise SolverFailure("interaction", f"{name} {value:.3f}, stated and changed by Holtrop's, is outside 0 to 0.6")
    return value
