"""Fields of a design at a condition: the waves on the water, the pressures on hull and blades.

The same solvers as the evaluation's, asked for what they know beyond a resistance and a thrust. Level 1's waves are the
free waves of Michell's own spectrum (hydro/kelvin.py), level 2's are the Rankine solver's surface. Pressures are always
level 2's: thin-ship theory and the lifting line have none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.levels import FAST, LEVEL_NUMBERS, TRUTH, level_of
from hpsop_core.evaluation.physics import basis_for
from hpsop_core.evaluation.propeller_answer import blade_drag
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.panels import block_points
from hpsop_core.hydro import kelvin
from hpsop_core.hydro.cavitation import section_dynamic_pressure
from hpsop_core.hydro.kelvin import WaveGrid, WaveSpectrum
from hpsop_core.typing_aliases import Array, IntArray

# A little finer than the optimiser's grid: here the pressures are looked at, not the circulation.
_CHORDWISE_PANELS, _RADIAL_PANELS = 40, 16
_MIRROR = np.array([1.0, -1.0, 1.0])

Design = Evaluation | DesignVariables | None
"""A design as these functions take it: what was evaluated, its variables alone, or None for the initial design."""


@dataclass(frozen=True, eq=False)
class WaveField:
    """A water surface in ship axes (x forward from AP, y to port, z up from the baseline), metres, port side.

    Attributes:
        level: 1 the free waves of thin-ship theory, 2 the Rankine solver's surface.
        froude_number: V/sqrt(g Lpp).
        x, y: (nx, ny) points; columns from upstream, rows from the hull or the centreplane outwards.
        elevation: (nx, ny) above the static waterline.
        waterline: (n, 2) x ascending and y >= 0 of the static waterline.
        draft: height of the static waterline.
        wave_calibration: level 1: the factor on its wave resistance; the elevation has its root. 1 at level 2.
        spectrum: level 1: the waves far astern, which carry the wave resistance away, and how much of them this grid
            holds; None at level 2.
        solver: what made it.
        warnings: of the solver, one line each.
    """

    level: int
    froude_number: float
    x: Array
    y: Array
    elevation: Array
    waterline: Array
    draft: float
    wave_calibration: float
    spectrum: WaveSpectrum | None
    solver: str
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class PressureField:
    """The pressure on panels, in ship axes (x forward from AP, y to port, z up from the baseline), metres.

    Attributes:
        points: (n, 3) corners.
        quads: (m, 4) indices into ``points``, counter-clockwise seen from the water; two corners may coincide. On a
            hull the port side's come first, then their mirror images with the same first corner.
        pressure_coefficient: (m,) (p - p0)/q without the hydrostatic part.
        dynamic_pressure: (m,) q in Pa. Hull: 1/2 rho V^2. Blades and hub: 1/2 rho (V_A^2 + (2 pi n r)^2), the
            undisturbed relative speed at the panel's own radius r.
        reference_pressure: one q for the whole surface, Pa. Hull: the same. Blades: 1/2 rho (V_A^2 + (0.7 pi n D)^2),
            which the cavitation number refers to.
        blade: (m,) number of the blade, -1 on the hub; all -1 on a hull.
        froude_number, advance_coefficient: of the condition.
        solver: what made it.
        warnings: of the solver, one line each.
        vapour_coefficient: blades: (m,) the ``uniform_coefficient`` below which the water evaporates with that blade
            upwards, as the cavitating share counts it; None on a hull.
    """

    points: Array
    quads: IntArray
    pressure_coefficient: Array
    dynamic_pressure: Array
    reference_pressure: float
    blade: IntArray
    froude_number: float
    advance_coefficient: float
    solver: str
    warnings: tuple[str, ...] = ()
    vapour_coefficient: Array | None = None

    @property
    def pressure(self) -> Array:
        """(m,) p - p0 in Pa without the hydrostatic part."""
        return self.pressure_coefficient * self.dynamic_pressure

    @property
    def uniform_coefficient(self) -> Array:
        """(m,) (p - p0) over the surface's one ``reference_pressure``: equal values are equal pressures."""
        return self.pressure / self.reference_pressure


@dataclass(frozen=True, eq=False)
class Pressures:
    """The pressures of a design at a condition: on both sides of the hull below the waterline; on all blades and the
    hub, the first blade upwards."""

    hull: PressureField
    blades: PressureField


def waves(
    case: Case,
    design: Design = None,
    *,
    level: int | None = None,
    condition: int = 0,
    froude_number: float | None = None,
    reference: Reference | None = None,
    grid: WaveGrid | None = None,
) -> WaveField:
    """The water surface of a design.

    Args:
        case: the design's.
        design: an evaluation, variables, or None for the initial design.
        level: 1 or 2; an evaluation's own by default, else 1.
        condition: which of the case's conditions, from 0.
        froude_number: any other, on the design's own length, instead of a condition's.
        reference: of this level, to save its computation; level 1's calibration comes from it.
        grid: level 1: where; the default reaches a ship's length astern.

    Raises:
        InputError: there is no such condition, or no solver for this Froude number.
        SolverFailure: the design's form or waves cannot be computed.
    """
    own = design.level if isinstance(design, Evaluation) else FAST.number
    wanted = own if level is None else level
    if wanted not in LEVEL_NUMBERS:
        raise InputError(f"waves: level {wanted} is neither 1 nor 2")
    if froude_number is None:
        variables, point = _at_condition(case, design, wanted, condition, reference)
        froude, calibration = point.froude_number, point.wave_calibration
    else:
        variables, froude, calibration = _variables(case, design), froude_number, 1.0
        if level_of(wanted) is FAST:
            basis = reference.basis if reference is not None else basis_for(case, wanted)
            calibration = basis.calibration_of(case, design_hull(case, variables), variables)(froude)
    hull = design_hull(case, variables)
    return _panel_waves(hull, froude) if level_of(wanted) is TRUTH else kelvin_waves(hull, froude, calibration, grid)


def kelvin_waves(
    hull: Hull, froude_number: float, wave_calibration: float = 1.0, grid: WaveGrid | None = None
) -> WaveField:
    """Level 1's waves of a hull at hand.

    Raises:
        InputError: the Froude number is not positive, or the grid carries no wave.
    """
    table, waterline = hull.offset_table(), hull.waterline()
    found = kelvin.kelvin_waves(
        table.x,
        table.z,
        table.y,
        hull.length,
        froude_number,
        waterline,
        # a stated wave coefficient may be negative: there are no waves of a negative energy
        calibration=max(wave_calibration, 0.0),
        grid=grid,
    )
    return WaveField(
        level=1,
        froude_number=froude_number,
        x=found.x,
        y=found.y,
        elevation=found.elevation,
        waterline=waterline,
        draft=hull.draft,
        wave_calibration=wave_calibration,
        spectrum=found.spectrum,
        solver=kelvin.SOLVER,
    )


def _panel_waves(hull: Hull, froude_number: float) -> WaveField:
    from hpsop_core.hydro.rankine.solver import solve

    result = solve(hull, (froude_number,), fields=True)
    fields = result.conditions[0].fields
    if fields is None:
        raise SolverFailure("rankine", "the solver was asked for fields and gave none")
    return WaveField(
        level=2,
        froude_number=froude_number,
        x=fields.x,
        y=fields.y,
        elevation=fields.elevation,
        waterline=hull.waterline(),
        draft=hull.draft,
        wave_calibration=1.0,
        spectrum=None,
        solver=result.solver,
        warnings=result.warnings,
    )


def pressures(
    case: Case, design: Design = None, *, condition: int = 0, reference: Reference | None = None
) -> Pressures:
    """The pressures on hull and blades of a design, by level 2's solvers.

    Args:
        case: the design's.
        design: an evaluation, variables, or None for the initial design. An evaluation's own operating point is taken,
            whatever its level; variables are evaluated at level 2.
        condition: which of the case's conditions, from 0.
        reference: of level 2, to save its computation where variables are given.

    Raises:
        InputError: there is no such condition, or the solver is not made for its Froude number.
        SolverFailure: the design has no operating point there, or a solver gives no pressures.
    """
    known = design if isinstance(design, Evaluation) else evaluate(case, _variables(case, design), 2, reference)
    return Pressures(hull_pressure(case, known, condition=condition), blade_pressure(case, known, condition=condition))


def hull_pressure(
    case: Case, design: Design = None, *, condition: int = 0, reference: Reference | None = None
) -> PressureField:
    """The hull's alone: as ``pressures``."""
    from hpsop_core.hydro.rankine.solver import solve

    variables, point = _at_condition(case, design, None, condition, reference)
    result = solve(design_hull(case, variables), (point.froude_number,), fields=True)
    fields = result.conditions[0].fields
    if fields is None:
        raise SolverFailure("rankine", "the solver was asked for fields and gave none")
    points: list[Array] = []
    quads: list[IntArray] = []
    values: list[Array] = []
    start = first = 0
    for corners, (name, along, across) in zip(block_points(fields.quads, fields.blocks), fields.blocks, strict=True):
        panels = slice(start, start + along * across)
        start = panels.stop
        if name == "tail":
            continue  # it closes the water behind a wet transom and is no part of the hull
        place = np.arange((along + 1) * (across + 1)).reshape(along + 1, across + 1) + first
        # u forward, v up on the port side
        port = np.stack([place[:-1, :-1], place[:-1, 1:], place[1:, 1:], place[1:, :-1]], axis=2).reshape(-1, 4)
        points.append(corners.reshape(-1, 3))
        quads.append(port)
        values.append(fields.pressure_coefficient[panels])
        first += place.size
    corners, port, coefficient = np.concatenate(points), np.concatenate(quads), np.concatenate(values)
    both = np.concatenate([coefficient, coefficient])
    dynamic_pressure = 0.5 * case.constants.density * point.speed**2
    return PressureField(
        points=np.concatenate([corners, corners * _MIRROR]),
        quads=np.concatenate([port, port[:, [0, 3, 2, 1]] + first]),
        pressure_coefficient=both,
        dynamic_pressure=np.full(both.shape, dynamic_pressure),
        reference_pressure=dynamic_pressure,
        blade=np.full(both.shape, -1),
        froude_number=point.froude_number,
        advance_coefficient=point.advance_coefficient,
        solver=result.solver,
        warnings=result.warnings,
    )


def blade_pressure(
    case: Case, design: Design = None, *, condition: int = 0, reference: Reference | None = None
) -> PressureField:
    """The blades' and the hub's alone: as ``pressures``."""
    from hpsop_core.hydro.blade_panels.settings import BladePanelSettings
    from hpsop_core.hydro.blade_panels.solver import solve

    variables, point = _at_condition(case, design, None, condition, reference)
    propeller = design_propeller(case, variables)
    advance = point.advance_coefficient
    result = solve(
        propeller,
        (advance,),
        blade_drag(case.constants),
        BladePanelSettings(chordwise_panels=_CHORDWISE_PANELS, radial_panels=_RADIAL_PANELS),
    )
    found = result.surface_pressure(advance)
    placement = propeller_placement(design_hull(case, variables), propeller)
    density, rate = case.constants.density, point.rotation_rate_rpm / 60.0
    unit = section_dynamic_pressure(density, advance * rate * propeller.diameter, rate, propeller.diameter)
    vapour = None
    if point.cavitation_number is not None:
        # the shaft's margin over the vapour pressure less the water's head up to the panel
        radius = np.hypot(*found.points[found.quads].mean(axis=1)[:, 1:].T)
        vapour = density * case.constants.gravity * radius / unit - point.cavitation_number
    return PressureField(
        points=found.points @ placement[:3, :3].T + placement[:3, 3],
        quads=found.quads,
        pressure_coefficient=found.pressure_coefficient,
        # the solver's unit of speed is n R
        dynamic_pressure=density * (rate * 0.5 * propeller.diameter) ** 2 * found.dynamic_pressure,
        reference_pressure=unit,
        blade=found.blade,
        froude_number=point.froude_number,
        advance_coefficient=advance,
        solver=result.open_water.solver,
        vapour_coefficient=vapour,
    )


def _variables(case: Case, design: Design) -> DesignVariables:
    if design is None:
        return case.initial.variables
    return design.variables if isinstance(design, Evaluation) else design


def _at_condition(
    case: Case, design: Design, level: int | None, condition: int, reference: Reference | None
) -> tuple[DesignVariables, ConditionResult]:
    """A design and its operating point, evaluated where it is not known at this level (None: at any, else at 2)."""
    if isinstance(design, Evaluation) and level in (None, design.level):
        known = design
    else:
        known = evaluate(case, _variables(case, design), level or 2, reference)
    if not known.ok:
        raise SolverFailure(known.stage, known.reason)
    if not 0 <= condition < len(known.conditions):
        raise InputError(f"condition {condition}: the case has {len(known.conditions)}, numbered from 0")
    return known.variables, known.conditions[condition]
