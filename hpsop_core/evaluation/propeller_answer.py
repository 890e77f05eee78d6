"""From the design's propeller to its open-water curves at full scale; remembered apart from the hull."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hpsop_core.case.sections import ConstantsSection, PropellerSection
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.levels import TRUTH, level_of
from hpsop_core.geometry.propeller.input import UnderstoodPropeller, read_propeller
from hpsop_core.geometry.propeller.propeller import Propeller, RadialTable, load_propeller, propeller_family
from hpsop_core.hydro.open_water import OpenWater, SectionDrag
from hpsop_core.hydro.operating_point import PropellerCurve, chebyshev_nodes
from hpsop_core.typing_aliases import Array

if TYPE_CHECKING:
    from hpsop_core.hydro.blade_panels.pressure import BladePressureTable

# Operating points of a ship's propeller lie between; beyond the upper end P4119 gives no thrust.
ADVANCE_RANGE = (0.25, 1.15)
NODE_COUNT = 7


@dataclass(frozen=True)
class PropellerVariables:
    """What of a design decides the propeller; the key under which its curves are remembered."""

    section: PropellerSection
    diameter: float
    blade_count: int
    pitch_ratio: float
    expanded_area_ratio: float


def propeller_variables(section: PropellerSection, variables: DesignVariables) -> PropellerVariables:
    """The propeller's share of a design."""
    return PropellerVariables(
        section, variables.diameter, variables.blade_count, variables.pitch_ratio, variables.expanded_area_ratio
    )


@lru_cache(maxsize=8)
def parent_table(section: PropellerSection) -> RadialTable:
    """The radial table that a case names.

    Raises:
        InputError: a file that cannot be used.
    """
    return own_propeller(section).table if section.geometry else load_propeller(section.parent)


def propeller_warnings(section: PropellerSection) -> tuple[str, ...]:
    """What is doubted of the radial table that a case names: nothing of a shipped one."""
    return own_propeller(section).warnings if section.geometry else ()


@lru_cache(maxsize=8)
def own_propeller(section: PropellerSection) -> UnderstoodPropeller:
    """The radial table of one's own that a case names, with what was understood of its file.

    Raises:
        InputError: a file that cannot be used.
    """
    return read_propeller(Path(section.geometry), section.geometry_blade_count)


@lru_cache(maxsize=512)
def build_propeller(variables: PropellerVariables) -> Propeller:
    """The propeller of a design.

    Raises:
        SolverFailure: the family does not reach it.
    """
    return propeller_family(
        parent_table(variables.section),
        variables.diameter,
        variables.blade_count,
        variables.pitch_ratio,
        variables.expanded_area_ratio,
    )


def curve_nodes() -> Array:
    """The advance coefficients at which the solvers are asked, ascending; (``NODE_COUNT``,)."""
    return chebyshev_nodes(*ADVANCE_RANGE, NODE_COUNT)


@dataclass(frozen=True, eq=False)
class PropellerAnswer:
    """What is remembered of a propeller at a level.

    Attributes:
        curve: KT and KQ over J.
        pressures: level 2: the pressures on its blades over J, else None.
    """

    curve: PropellerCurve
    pressures: BladePressureTable | None


def blade_drag(constants: ConstantsSection) -> SectionDrag:
    """What a case's boundary layer does to its blades at full scale."""
    return SectionDrag.full_scale(constants.propeller_roughness, camber_scaling=constants.camber_scaling)


@lru_cache(maxsize=4096)
def propeller_answer(variables: PropellerVariables, level: int, drag: SectionDrag) -> PropellerAnswer:
    """Open-water curves at full scale between the ends of ``ADVANCE_RANGE``, and at level 2 the blades' pressures.

    The section drag is ITTC-78's rough line, which does not depend on the rate of revolutions, so one curve serves
    every condition.

    Args:
        variables: the propeller.
        level: 1 lifting line, 2 panel method.
        drag: ``blade_drag`` of the case.

    Raises:
        SolverFailure: the solver does not converge; names the J.
    """
    nodes = curve_nodes()
    solution = level_of(level).solve_propeller(build_propeller(variables), nodes, drag)
    result = solution.open_water
    pressures = solution.pressures() if solution.pressures else None
    return PropellerAnswer(PropellerCurve(nodes, result.thrust_coefficient, result.torque_coefficient), pressures)


@lru_cache(maxsize=512)
def finer_propeller_answer(variables: PropellerVariables, drag: SectionDrag) -> PropellerAnswer:
    """As ``propeller_answer`` at the true level, on its finer panels; without pressures.

    Raises:
        SolverFailure: the solver does not converge; names the J.
    """
    if TRUTH.solve_finer_propeller is None:
        raise SolverFailure("propeller", "the true level has no finer panels")
    nodes = curve_nodes()
    result = TRUTH.solve_finer_propeller(build_propeller(variables), nodes, drag).open_water
    return PropellerAnswer(PropellerCurve(nodes, result.thrust_coefficient, result.torque_coefficient), None)


def solve_open_water(
    propeller: Propeller, level: int, advance_coefficients: Array | Sequence[float], drag: SectionDrag
) -> OpenWater:
    """Open-water results of a propeller at a level, straight from its solver.

    Raises:
        SolverFailure: the solver does not converge; names the J.
    """
    advance = np.asarray(advance_coefficients, dtype=float)
    return level_of(level).solve_propeller(propeller, advance, drag).open_water
