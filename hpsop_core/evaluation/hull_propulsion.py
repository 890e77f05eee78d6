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
        wake_fractions: w at each condition.
        thrust_deduction: t.
    """

    form_factor: float
    wake_fractions: tuple[float, ...]
    thrust_deduction: float


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
        or constants.correlation_allowance_formula == "holtrop"
        or constants.wake_formula in ("holtrop", "stated")
        or constants.thrust_deduction_formula != "schoenherr"
        or constants.relative_rotative_efficiency_formula == "holtrop"
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
    ship: holtrop.HoltropHull, diameter: float, speeds: tuple[float, ...], viscosity: float
) -> HoltropNumbers:
    """What Holtrop's formulas give.

    Args:
        ship: the hull.
        diameter: D in m.
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
    return HoltropNumbers(form_factor, tuple(wakes), holtrop.thrust_deduction(ship, diameter))


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
    for name, formula, used, stated in (
        ("stated_wake_fraction", "wake_formula", "stated", constants.stated_wake_fraction is not None),
        (
            "stated_thrust_deduction",
            "thrust_deduction_formula",
            "stated",
            constants.stated_thrust_deduction is not None,
        ),
        ("correlation_allowance", "correlation_allowance_formula", "stated", constants.correlation_allowance != 0.0),
    ):
        chosen = getattr(constants, formula)
        if stated and chosen != used:
            lines.append(f'{name} is not used, for {formula} is {chosen}; write {formula} = "{used}" to use it')
    if constants.frontal_area == 0.0 and constants.air_drag_coefficient != ConstantsSection.air_drag_coefficient:
        lines.append("air_drag_coefficient is not used, for there is no frontal_area; state it in m2")
    return tuple(lines)


def resistance_factors(
    case: Case,
    hull: Hull,
    ship: holtrop.HoltropHull | None,
    initial_form_factor: float | None,
    form_factor: float | None = None,
) -> ResistanceFactors:
    """What makes the parts of a design's resistance beside friction and waves.

    Args:
        case: what it states.
        hull: of the design.
        ship: the same for Holtrop's method; None where the case does not use it.
        initial_form_factor: Holtrop's for the initial design, where the case uses the method.
        form_factor: k instead of the case's.
    """
    constants = case.constants
    factor = constants.form_factor if form_factor is None else form_factor
    allowance = constants.correlation_allowance
    if ship is not None:
        if form_factor is None and constants.form_factor_formula == "holtrop":
            factor = holtrop.form_factor(ship)
        elif form_factor is None and constants.form_factor_formula == "scaled" and initial_form_factor is not None:
            factor += holtrop.form_factor(ship) - initial_form_factor
        if constants.correlation_allowance_formula == "holtrop":
            allowance = holtrop.correlation_allowance(ship)
    return ResistanceFactors(
        form_factor=factor,
        correlation_allowance=allowance,
        air_drag_coefficient=constants.air_drag_coefficient,
        frontal_area=constants.frontal_area * (hull.breadth / case.initial.breadth),
        appendage_factor=constants.appendage_factor,
    )


def propulsion_factors(
    constants: ConstantsSection,
    block_coefficient: float,
    expanded_area_ratio: float,
    count: int,
    ship: holtrop.HoltropHull | None = None,
    own: HoltropNumbers | None = None,
    initial: HoltropNumbers | None = None,
) -> tuple[PropulsionFactors, ...]:
    """w, t and eta_R of a design at each of ``count`` conditions.

    Args:
        constants: of the case.
        block_coefficient: C_B as the case counts it.
        expanded_area_ratio: of the propeller.
        count: of conditions.
        ship, own, initial: for Holtrop's method: the hull, what the formulas give for it and for the initial design.

    Raises:
        SolverFailure: a number leaves what can be.
    """
    rotative = constants.relative_rotative_efficiency
    if ship is not None and constants.relative_rotative_efficiency_formula == "holtrop":
        rotative = holtrop.relative_rotative_efficiency(ship, expanded_area_ratio)
    found = []
    for index in range(count):
        wake = _wake(constants, block_coefficient, index, own, initial)
        found.append(PropulsionFactors(wake, _deduction(constants, wake, own, initial), rotative))
    return tuple(found)


def _wake(
    constants: ConstantsSection,
    block_coefficient: float,
    index: int,
    own: HoltropNumbers | None,
    initial: HoltropNumbers | None,
) -> float:
    if constants.wake_formula == "holtrop" and own is not None:
        return own.wake_fractions[index]
    if constants.wake_formula == "stated" and constants.stated_wake_fraction is not None:
        if own is None or initial is None:
            raise ValueError("a stated wake fraction needs Holtrop's for the design and the initial one")
        change = own.wake_fractions[index] - initial.wake_fractions[index]
        return _within("w", constants.stated_wake_fraction + change)
    return interaction.wake_fraction(block_coefficient, constants.wake_formula)


def _deduction(
    constants: ConstantsSection, wake: float, own: HoltropNumbers | None, initial: HoltropNumbers | None
) -> float:
    if constants.thrust_deduction_formula == "holtrop" and own is not None:
        return own.thrust_deduction
    if constants.thrust_deduction_formula == "stated" and constants.stated_thrust_deduction is not None:
        if own is None or initial is None:
            raise ValueError("a stated thrust deduction needs Holtrop's for the design and the initial one")
        change = own.thrust_deduction - initial.thrust_deduction
        return _within("t", constants.stated_thrust_deduction + change)
    return interaction.thrust_deduction(wake, constants.thrust_deduction_factor)


def _within(name: str, value: float) -> float:
    if not 0.0 <= value <= 0.6:
        raise SolverFailure("interaction", f"{name} {value:.3f}, stated and changed by Holtrop's, is outside 0 to 0.6")
    return value
