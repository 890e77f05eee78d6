"""From the design's hull to its resistance at any Froude number; remembered apart from the propeller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

from hpsop_core.case.own_hull import own_table
from hpsop_core.case.sections import HullSection
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.levels import TRUTH, WaveAnswer, level_of
from hpsop_core.geometry.hull.hull import Hull, ParentHull, load_parent_hull
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.powering import ResistanceFactors, resistance_parts

if TYPE_CHECKING:
    from hpsop_core.geometry.hull.input import HullFile


@dataclass(frozen=True)
class HullVariables:
    """What of a design decides the hull; the key under which its waves are remembered.

    Attributes:
        section: the parent and the kind of form.
        length, breadth, draft: in m.
        displaced_volume: asked, in m3; None for scaling alone.
        buoyancy_centre_shift: in m, forward.
    """

    section: HullSection
    length: float
    breadth: float
    draft: float
    displaced_volume: float | None
    buoyancy_centre_shift: float


@dataclass(frozen=True)
class ResistancePoint:
    """Resistance at one speed; see ConditionResult for the meaning of each number."""

    froude_number: float
    speed: float
    friction_coefficient: float
    friction_resistance: float
    form_resistance: float
    wave_coefficient: float
    wave_resistance: float
    correlation_resistance: float
    air_resistance: float
    appendage_resistance: float
    total_resistance: float
    wave_coefficient_pressure: float | None
    sinkage: float | None
    trim: float | None
    wave_calibration: float
    warnings: tuple[str, ...] = ()


@lru_cache(maxsize=8)
def own_hull(section: HullSection) -> HullFile:
    """The hull of one's own that a case names, with what was understood of its file.

    Raises:
        InputError: a file that cannot be used.
    """
    from hpsop_core.geometry.hull.input import hull_from_table  # with all that reads and fits

    return hull_from_table(own_table(section), section.shaft_height, section.boss_x)


def parent_hull(section: HullSection) -> ParentHull:
    """The parent hull that a case names.

    Raises:
        InputError: a file that cannot be used.
    """
    return own_hull(section).parent if section.own_file else load_parent_hull(section.parent)


@lru_cache(maxsize=512)
def build_hull(variables: HullVariables) -> Hull:
    """The hull of a design.

    Raises:
        SolverFailure: the form cannot be made.
    """
    return parent_hull(variables.section).transform(
        variables.length,
        variables.breadth,
        variables.draft,
        variables.displaced_volume,
        variables.buoyancy_centre_shift,
    )


def hull_variables(section: HullSection, variables: DesignVariables, initial_volume: float) -> HullVariables:
    """The hull's share of a design; ``initial_volume`` is V0, which the displacement ratio refers to."""
    return HullVariables(
        section=section,
        length=variables.length,
        breadth=variables.breadth,
        draft=variables.draft,
        displaced_volume=initial_volume * variables.displacement_ratio if section.form == "shift" else None,
        buoyancy_centre_shift=variables.buoyancy_centre_shift * variables.length,
    )


@lru_cache(maxsize=4096)
def wave_answers(variables: HullVariables, level: int, froude_numbers: tuple[float, ...]) -> tuple[WaveAnswer, ...]:
    """Wave resistance of a hull as the level's solver gives it, before any calibration.

    Raises:
        SolverFailure: the solver cannot give a number.
    """
    hull = build_hull(variables)
    return solve_waves(hull, level, froude_numbers)


@lru_cache(maxsize=1024)
def trial_wave_answers(
    variables: HullVariables, froude_numbers: tuple[float, ...], way: Literal["finer", "wider"]
) -> tuple[WaveAnswer, ...]:
    """As ``wave_answers`` at the true level, on its finer mesh or in its wider domain.

    Raises:
        SolverFailure: the solver cannot give a number.
    """
    solve = {"finer": TRUTH.solve_finer_waves, "wider": TRUTH.solve_wider_waves}[way]
    if solve is None:
        raise SolverFailure("waves", f"the true level has no {way} solution")
    return solve(build_hull(variables), froude_numbers)


def solve_waves(hull: Hull, level: int, froude_numbers: Sequence[float]) -> tuple[WaveAnswer, ...]:
    """As ``wave_answers``, for a hull at hand.

    Raises:
        SolverFailure: the solver cannot give a number, or is not made for one of these Froude numbers.
    """
    return level_of(level).solve_waves(hull, froude_numbers)


def resistance_point(
    hull: Hull,
    wave: WaveAnswer,
    froude_number: float,
    *,
    gravity: float,
    density: float,
    viscosity: float,
    factors: ResistanceFactors,
    wave_calibration: float = 1.0,
) -> ResistancePoint:
    """Resistance of a hull at a Froude number, in its parts.

    Args:
        hull: the design's.
        wave: the level's answer at this Froude number.
        froude_number: V/sqrt(g Lpp).
        gravity, density, viscosity: in SI units.
        factors: of the parts beside friction (ITTC-57) and waves.
        wave_calibration: factor on the wave resistance.

    Raises:
        SolverFailure: Reynolds number too small for the friction line.
    """
    speed: float = froude_number * (gravity * hull.length) ** 0.5
    dynamic = 0.5 * density * speed**2 * hull.hydrostatics.wetted_surface
    friction_coefficient = ittc57_coefficient(speed * hull.length / viscosity)
    wave_coefficient = wave.wave_coefficient * wave_calibration
    parts = resistance_parts(
        factors,
        speed=speed,
        density=density,
        wetted_surface=hull.hydrostatics.wetted_surface,
        friction=friction_coefficient * dynamic,
        wave=wave_coefficient * dynamic,
    )
    return ResistancePoint(
        froude_number=froude_number,
        speed=speed,
        friction_coefficient=friction_coefficient,
        friction_resistance=parts.friction,
        form_resistance=parts.form,
        wave_coefficient=wave_coefficient,
        wave_resistance=parts.wave,
        correlation_resistance=parts.correlation,
        air_resistance=parts.air,
        appendage_resistance=parts.appendage,
        total_resistance=parts.total,
        wave_coefficient_pressure=wave.wave_coefficient_pressure,
        sinkage=wave.sinkage,
        trim=wave.trim,
        wave_calibration=wave_calibration,
        warnings=wave.warnings,
    )
