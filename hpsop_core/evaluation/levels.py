"""The two levels of fidelity: each is a solver of waves and a solver of propellers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hpsop_core.errors import InputError, SolverFailure

# Solvers are loaded when they are needed: those of the true level take a second to load their compiled kernels, and
# whoever only needs to know what levels there are shall not load any.
if TYPE_CHECKING:
    from hpsop_core.geometry.hull.hull import Hull
    from hpsop_core.geometry.propeller.propeller import Propeller
    from hpsop_core.hydro.blade_panels.pressure import BladePressureTable
    from hpsop_core.hydro.open_water import OpenWater, SectionDrag
    from hpsop_core.typing_aliases import Array


REFINEMENT = 1.25
"""Panels of hull and water in each direction, over the working mesh's, with which final designs are solved again."""

WIDENING = 1.5
"""Size of the water's domain in each direction, over the working one's, likewise."""

BLADE_REFINEMENT = 1.5
"""Panels of blades and hub in each direction, likewise."""


@dataclass(frozen=True)
class WaveAnswer:
    """A solver's answer at one Froude number.

    Attributes:
        wave_coefficient: Rw over 1/2 rho V^2 S, S the design's own static wetted surface.
        wave_coefficient_pressure: level 2's cross-check, else None.
        sinkage: level 2, in m, positive down; trim: in rad, positive bow down; else None.
        warnings: what the solver says about its answers, one line each.
    """

    wave_coefficient: float
    wave_coefficient_pressure: float | None = None
    sinkage: float | None = None
    trim: float | None = None
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class PropellerSolution:
    """What a level's solver gives for a propeller.

    Attributes:
        open_water: at the advance coefficients asked for.
        pressures: gives the pressures on the blades; None for a solver that knows none.
    """

    open_water: OpenWater
    pressures: Callable[[], BladePressureTable] | None = None


@dataclass(frozen=True)
class Level:
    """A level of fidelity.

    Attributes:
        number: as people write it.
        words: its two solvers.
        solve_waves: (hull, Froude numbers) -> an answer at each, before any calibration; raises SolverFailure.
        solve_propeller: (propeller, advance coefficients, section drag) -> its solution; raises SolverFailure.
        caution: what a reader must know of results that all have this level; "" for the true one.
        solve_finer_waves: as ``solve_waves`` on ``REFINEMENT`` times as many panels in each direction; None where there
            are none.
        solve_wider_waves: the same with a domain ``WIDENING`` times as large; None where there is none.
        solve_finer_propeller: as ``solve_propeller`` on ``BLADE_REFINEMENT`` times as many panels; None likewise.
        is_calibrated: whether a case may scale its wave resistance to the true level's at the initial design.
        comparison_error: half width of the 90 % interval of an objective between two designs, as a fraction, unless
            their own is known. The true level: between forms that differ in fullness and LCB the default mesh scatters
            by 3 % of the wave resistance, which is a fifth of the total (docs/theory-rankine.md, Mesh). Level 1: near
            the optimum its first objective leaves level 2's by 0.02 (docs/what-to-believe.md).
    """

    number: int
    words: str
    caution: str
    solve_waves: Callable[[Hull, Sequence[float]], tuple[WaveAnswer, ...]]
    solve_propeller: Callable[[Propeller, Array, SectionDrag], PropellerSolution]
    is_calibrated: bool
    comparison_error: float
    solve_finer_waves: Callable[[Hull, Sequence[float]], tuple[WaveAnswer, ...]] | None = None
    solve_wider_waves: Callable[[Hull, Sequence[float]], tuple[WaveAnswer, ...]] | None = None
    solve_finer_propeller: Callable[[Propeller, Array, SectionDrag], PropellerSolution] | None = None


def _thin_ship(hull: Hull, froude_numbers: Sequence[float]) -> tuple[WaveAnswer, ...]:
    from hpsop_core.hydro import michell

    table = hull.offset_table()
    coefficients = michell.wave_coefficients(
        table.x, table.z, table.y, hull.length, hull.hydrostatics.wetted_surface, froude_numbers
    )
    return tuple(WaveAnswer(float(value)) for value in coefficients)


def _lifting_line(propeller: Propeller, advance: Array, drag: SectionDrag) -> PropellerSolution:
    from hpsop_core.hydro.lifting_line import solver as lifting_line

    return PropellerSolution(lifting_line.solve(propeller, advance, drag))


def _rankine_panels(
    hull: Hull, froude_numbers: Sequence[float], refinement: float = 1.0, widening: float = 1.0
) -> tuple[WaveAnswer, ...]:
    from hpsop_core.hydro.rankine import solver as rankine

    try:
        settings = None
        # What these two change is hundreds of times what single precision does.
        if refinement != 1.0:
            settings = rankine.RankineSettings(single_precision=True).refined(refinement)
        elif widening != 1.0:
            settings = rankine.RankineSettings(single_precision=True).widened(widening)
        result = rankine.solve(hull, froude_numbers, settings)
    except InputError as problem:
        # Froude numbers follow from a design's length at fixed speed: out of range is that design's failure.
        raise SolverFailure("rankine", str(problem)) from problem
    return tuple(
        WaveAnswer(point.wave_coefficient, point.wave_coefficient_pressure, point.sinkage, point.trim, result.warnings)
        for point in result.conditions
    )


def _finer_rankine_panels(hull: Hull, froude_numbers: Sequence[float]) -> tuple[WaveAnswer, ...]:
    return _rankine_panels(hull, froude_numbers, REFINEMENT)


def _wider_rankine_panels(hull: Hull, froude_numbers: Sequence[float]) -> tuple[WaveAnswer, ...]:
    return _rankine_panels(hull, froude_numbers, widening=WIDENING)


def _blade_panels(
    propeller: Propeller, advance: Array, drag: SectionDrag, refinement: float = 1.0
) -> PropellerSolution:
    from hpsop_core.hydro.blade_panels import solver as blade_panels
    from hpsop_core.hydro.blade_panels.settings import BladePanelSettings

    settings = None if refinement == 1.0 else BladePanelSettings().refined(refinement)
    panels = blade_panels.solve(propeller, advance, drag, settings)
    return PropellerSolution(panels.open_water, panels.pressure_table)


def _finer_blade_panels(propeller: Propeller, advance: Array, drag: SectionDrag) -> PropellerSolution:
    return _blade_panels(propeller, advance, drag, BLADE_REFINEMENT)


FAST = Level(
    number=1,
    words="Michell's thin-ship integral and a lifting line",
    caution="It ranks hulls of one fullness as level 2 does, hulls of different fullness only where it has learnt from "
    "level 2; its absolute wave resistance is only as good as its calibration. Let the run reach level 2 before "
    "deciding anything.",
    solve_waves=_thin_ship,
    solve_propeller=_lifting_line,
    is_calibrated=True,
    comparison_error=0.02,
)
"""Searches wide."""

TRUTH = Level(
    number=2,
    words="Rankine panels on hull and water surface, panels on blades and hub",
    caution="",
    solve_waves=_rankine_panels,
    solve_propeller=_blade_panels,
    is_calibrated=False,
    comparison_error=0.006,
    solve_finer_waves=_finer_rankine_panels,
    solve_wider_waves=_wider_rankine_panels,
    solve_finer_propeller=_finer_blade_panels,
)
"""What a front is judged by."""

LEVELS = (FAST, TRUTH)
LEVEL_NUMBERS = tuple(level.number for level in LEVELS)


def level_of(number: int) -> Level:
    """The level of a number.

    Raises:
        ValueError: there is no such level.
    """
    for level in LEVELS:
        if level.number == number:
            return level
    raise ValueError(f"level {number} is neither {FAST.number} nor {TRUTH.number}")
