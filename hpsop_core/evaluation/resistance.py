"""Resistance of a hull, or of a design of a case, over Froude numbers: the question that a towing tank answers."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.case.fields import FieldRule, checked_value
from hpsop_core.case.sections import ConstantsSection
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.curves import resistance_curve
from hpsop_core.evaluation.hull_answer import ResistancePoint, resistance_point, solve_waves
from hpsop_core.evaluation.levels import level_of
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.hydrostatics import Hydrostatics
from hpsop_core.hydro.powering import ResistanceFactors
from hpsop_core.one_thread import one_blas_thread

FROUDE_RULE = FieldRule("number", "Froude number", "", 0.1, 0.5)
FORM_FACTOR_RULE = FieldRule("number", "form factor", "", 0.0, 1.0)
DENSITY_RULE = FieldRule("number", "density of the water", "kg/m3", 900.0, 1100.0)
VISCOSITY_RULE = FieldRule("number", "kinematic viscosity of the water", "m2/s", 5e-7, 3e-6)
# ITTC recommended properties at 15 C: density in kg/m3, kinematic viscosity in m2/s.
WATERS = {"salt": (1025.0, 1.188e-6), "fresh": (999.1, 1.1386e-6)}


@dataclass(frozen=True, eq=False)
class Resistance:
    """Resistance over Froude numbers.

    Attributes:
        hull: what was towed.
        level: 1 (Michell) or 2 (Rankine panels).
        density, viscosity: of the water, in kg/m3 and m2/s.
        points: one a Froude number, in the order that was asked; resistances in N, speeds in m/s.
    """

    hull: Hull
    level: int
    density: float
    viscosity: float
    points: tuple[ResistancePoint, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What hull and solver say about these numbers, each once."""
        return tuple(dict.fromkeys([*self.hull.warnings, *(line for point in self.points for line in point.warnings)]))

    def as_dict(self) -> dict[str, Any]:
        """The document of ``hpsop resistance --json``."""
        hydrostatics = self.hull.hydrostatics
        hull = {
            "length": self.hull.length,
            "breadth": self.hull.breadth,
            "draft": self.hull.draft,
            "block_coefficient": hydrostatics.block_coefficient,
            "displaced_volume": hydrostatics.displaced_volume,
            "wetted_surface": hydrostatics.wetted_surface,
            "longitudinal_centre_of_buoyancy": hydrostatics.longitudinal_centre_of_buoyancy,
        }
        return {"hull": hull, "points": [dataclasses.asdict(point) for point in self.points]}


@one_blas_thread()
def resistance(
    subject: Case | Hull,
    froude_numbers: Sequence[float],
    level: int = 1,
    variables: DesignVariables | None = None,
    *,
    form_factor: float | None = None,
    density: float | None = None,
    viscosity: float | None = None,
) -> Resistance:
    """Resistance of a design of a case, or of a hull at hand, over Froude numbers, in its parts.

    Args:
        subject: a case, whose design is towed with the case's water, form factor, allowances and calibration; or a hull
            (``load_hull``), which is towed as it is: salt water, friction and waves alone, unless given.
        froude_numbers: V/sqrt(g Lpp) on the hull's own length, each 0.1 to 0.5.
        level: 1 (Michell's integral) or 2 (Rankine panels).
        variables: with a case: the design; the initial one by default.
        form_factor: k on the friction of ITTC-57, 0 to 1.
        density, viscosity: of the water, in kg/m3 and m2/s.

    Returns:
        Hull and points; ITTC 7.5-02-02-01 for the friction line, docs/theory-rankine.md for level 2's waves.

    Raises:
        ValueError: level is neither 1 nor 2, or variables are given with a hull.
        InputError: a number outside its limits, or a file that the case names cannot be used.
        SolverFailure: the form or its waves cannot be computed.
    """
    level_of(level)
    numbers = tuple(float(checked_value(float(value), FROUDE_RULE, "froude_numbers")) for value in froude_numbers)
    if not numbers:
        raise InputError("froude_numbers: none given; give for example (0.22, 0.27)")
    for value, rule, name in (
        (form_factor, FORM_FACTOR_RULE, "form_factor"),
        (density, DENSITY_RULE, "density"),
        (viscosity, VISCOSITY_RULE, "viscosity"),
    ):
        if value is not None:
            checked_value(value, rule, name)
    if isinstance(subject, Hull):
        if variables is not None:
            raise ValueError("variables belong to a case; a hull is taken as it is")
        water = (
            WATERS["salt"][0] if density is None else density,
            WATERS["salt"][1] if viscosity is None else viscosity,
        )
        waves = solve_waves(subject, level, numbers)
        points = tuple(
            resistance_point(
                subject,
                wave,
                froude,
                gravity=ConstantsSection.gravity,
                density=water[0],
                viscosity=water[1],
                factors=ResistanceFactors(form_factor=form_factor or 0.0),
            )
            for froude, wave in zip(numbers, waves, strict=True)
        )
        return Resistance(subject, level, *water, points)
    own = subject.constants
    water = (own.density if density is None else density, own.viscosity if viscosity is None else viscosity)
    design = subject.initial.variables if variables is None else variables
    case = dataclasses.replace(subject, constants=dataclasses.replace(own, density=water[0], viscosity=water[1]))
    points = resistance_curve(case, design, level, numbers, form_factor=form_factor)
    return Resistance(design_hull(case, design), level, *water, points)


def hydrostatics(subject: Case | Hull, variables: DesignVariables | None = None) -> Hydrostatics:
    """Hydrostatics of a design of a case, or of a hull at hand, measured on the surface itself.

    Args:
        subject: a case or a hull.
        variables: with a case: the design; the initial one by default.

    Returns:
        Volume, coefficients, centres and the sectional-area curve (two arrays of the same shape (n,)); SI units, x from
        the after perpendicular, upright at the design draft.

    Raises:
        ValueError: variables are given with a hull.
        InputError: a file that the case names cannot be used.
        SolverFailure: the form cannot be made.
    """
    if isinstance(subject, Hull):
        if variables is not None:
            raise ValueError("variables belong to a case; a hull is taken as it is")
        return subject.hydrostatics
    return design_hull(subject, subject.initial.variables if variables is None else variables).hydrostatics
