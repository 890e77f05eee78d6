"""The shapes of a case's designs: the initial displacement, hulls and propellers."""

from __future__ import annotations

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.hull_answer import HullVariables, build_hull, hull_variables
from hpsop_core.evaluation.propeller_answer import build_propeller, propeller_variables
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller


def initial_volume(case: Case) -> float:
    """V0: the parent's displacement at the initial design's dimensions, times its displacement ratio, in m3."""
    initial = case.initial
    scaled = build_hull(HullVariables(case.hull, initial.length, initial.breadth, initial.draft, None, 0.0))
    return scaled.hydrostatics.displaced_volume * initial.displacement_ratio


def design_hull(case: Case, variables: DesignVariables) -> Hull:
    """The hull of a design of the case, for views and exports.

    Raises:
        SolverFailure: the form cannot be made.
    """
    return build_hull(hull_variables(case.hull, variables, initial_volume(case)))


def design_propeller(case: Case, variables: DesignVariables) -> Propeller:
    """The propeller of a design of the case, for views and exports.

    Raises:
        SolverFailure: the family does not reach it.
    """
    return build_propeller(propeller_variables(case.propeller, variables))
