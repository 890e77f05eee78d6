"""The open-water test of a propeller, or of a design's propeller: KT, KQ and efficiency over J."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.fields import FieldRule, checked_value
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import level_of
from hpsop_core.evaluation.propeller_answer import solve_open_water
from hpsop_core.evaluation.shapes import design_propeller
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.open_water import SectionDrag, reynolds_number_07R
from hpsop_core.model_test import MODEL_DIAMETER, MODEL_ROTATION_RATE, MODEL_VISCOSITY
from hpsop_core.one_thread import one_blas_thread

ADVANCE_RULE = FieldRule("number", "advance coefficient", "", 0.05, 2.0)
DIAMETER_RULE = FieldRule("number", "diameter", "m", 0.01, 20.0)
ROTATION_RATE_RULE = FieldRule("number", "rotation rate", "1/s", 0.1, 200.0)
VISCOSITY_RULE = FieldRule("number", "kinematic viscosity", "m2/s", 1e-7, 1e-4)


@dataclass(frozen=True)
class OpenWaterPoint:
    """One advance coefficient.

    Attributes:
        advance_coefficient: J = V/(n D).
        thrust_coefficient: KT = T/(rho n^2 D^4).
        torque_coefficient: KQ = Q/(rho n^2 D^5).
        open_water_efficiency: J KT/(2 pi KQ); None where the torque is not positive.
    """

    advance_coefficient: float
    thrust_coefficient: float
    torque_coefficient: float
    open_water_efficiency: float | None


@dataclass(frozen=True, eq=False)
class OpenWaterTest:
    """A propeller's open-water test.

    Attributes:
        propeller: what was tested, at the tested diameter.
        level: 1 (lifting line) or 2 (blade panels).
        inviscid: without section drag and without the viscous factor on the lift.
        reynolds_number_07R: chord Reynolds number at 0.7 R, one a point.
        solver: name and version.
        settings: the solver's, as text.
        points: one an advance coefficient, in the order that was asked.
    """

    propeller: Propeller
    level: int
    inviscid: bool
    reynolds_number_07R: tuple[float, ...]  # noqa: N815 - the discipline's own notation
    solver: str
    settings: str
    points: tuple[OpenWaterPoint, ...]

    def as_dict(self) -> dict[str, Any]:
        """The document of ``hpsop open-water --json``."""
        return {
            "level": self.level,
            "diameter": self.propeller.diameter,
            "blade_count": self.propeller.blade_count,
            "expanded_area_ratio": self.propeller.expanded_area_ratio,
            "reynolds_number_07R": list(self.reynolds_number_07R),
            "solver": self.solver,
            "settings": self.settings,
            "points": [asdict(point) for point in self.points],
        }


@one_blas_thread()
def open_water(
    subject: Case | Propeller,
    advance_coefficients: Sequence[float],
    level: int = 1,
    variables: DesignVariables | None = None,
    *,
    diameter: float | None = None,
    rotation_rate: float = MODEL_ROTATION_RATE,
    viscosity: float = MODEL_VISCOSITY,
    inviscid: bool = False,
) -> OpenWaterTest:
    """The open-water test of a case's propeller, or of a propeller at hand.

    Args:
        subject: a case, whose propeller is tested at model scale; or a propeller (``load_propeller``), which is tested
            at its own diameter.
        advance_coefficients: J, each 0.05 to 2.
        level: 1 (lifting line) or 2 (blade panels).
        variables: with a case: the design; the initial one by default.
        diameter: D in m at which to test, 0.01 to 20.
        rotation_rate, viscosity: in 1/s and m2/s: they and the diameter decide the sections' friction.
        inviscid: leave out section drag and the viscous factor on the lift.

    Returns:
        Points, Reynolds numbers and what computed them (docs/theory-lifting-line.md, docs/theory-propeller-panels.md).

    Raises:
        ValueError: level is neither 1 nor 2, or variables are given with a propeller.
        InputError: a number outside its limits, or a file that the case names cannot be used.
        SolverFailure: the family does not reach the propeller, or the solver does not converge; names the J.
    """
    level_of(level)
    advance = tuple(checked_value(float(value), ADVANCE_RULE, "advance_coefficients") for value in advance_coefficients)
    if not advance:
        raise InputError("advance_coefficients: none given; give for example (0.5, 0.7, 0.9)")
    if diameter is not None:
        checked_value(diameter, DIAMETER_RULE, "diameter")
    checked_value(rotation_rate, ROTATION_RATE_RULE, "rotation_rate")
    checked_value(viscosity, VISCOSITY_RULE, "viscosity")
    if isinstance(subject, Propeller):
        if variables is not None:
            raise ValueError("variables belong to a case; a propeller is taken as it is")
        propeller = subject if diameter is None else subject.with_diameter(diameter)
    else:
        own = design_propeller(subject, subject.initial.variables if variables is None else variables)
        propeller = own.with_diameter(MODEL_DIAMETER if diameter is None else diameter)
    drag = SectionDrag.inviscid() if inviscid else SectionDrag.model_scale(rotation_rate, viscosity)
    result = solve_open_water(propeller, level, advance, drag)
    points = tuple(
        # The identity, so that no rounding of a solver's own stands between the three numbers.
        OpenWaterPoint(j, float(kt), float(kq), float(j * kt / (2.0 * math.pi * kq)) if kq > 0.0 else None)
        for j, kt, kq in zip(advance, result.thrust_coefficient, result.torque_coefficient, strict=True)
    )
    reynolds = reynolds_number_07R(propeller, np.array(advance), rotation_rate, viscosity)
    return OpenWaterTest(propeller, level, inviscid, tuple(reynolds.tolist()), result.solver, result.settings, points)
