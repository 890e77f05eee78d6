"""Wave resistance by Rankine sources, linearised about the double-body flow: level 2 of the hull.

Unknowns are Hess-Smith panels on the hull, each with its images in y = 0 and z = 0, and point sources raised above the
water surface, each with its image in y = 0.  About the double-body flow U (with q = |U|^2) the disturbance p fulfils

    hull:     dp/dn = 0
    surface:  U.grad(U.grad p) + [U.grad(q/2)/q] (U.grad p) + g p_z = -U.grad(q/2)      (Dawson 1977)

The hull's z-images make its own p_z vanish on the surface.  The hull's unknowns are eliminated once (Schur complement):
what remains for a Froude number is one linear system of the size of the surface grid, in which only g p_z differs.
Source: Dawson, 2nd Int. Conf. Numerical Ship Hydrodynamics 1977; raised sources after Jensen, Mi and Soeding 1986.
Departures: the difference formula (see rankine_operator), and the elimination. docs/theory-rankine.md says more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, lu_factor, lu_solve

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.panels import HullPanels, hull_panels
from hpsop_core.hydro.rankine.checks import check_answer, check_base_flow, check_froude_numbers, check_panels
from hpsop_core.hydro.rankine.grid import SurfaceGrid, surface_grid
from hpsop_core.hydro.rankine.many_speeds import strengths_together
from hpsop_core.hydro.rankine.operator import combine, convect, difference_weights
from hpsop_core.hydro.rankine.resistance import plane_resistance, pressure_force, sinkage_and_trim, wave_planes
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.singularities.source_panels import (
    SourcePanels,
    flat_panels,
    panel_velocities,
    point_velocities,
    surface_influence,
)
from hpsop_core.kept_memory import keep_freed_memory
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

__all__ = [
    "DoubleBody",
    "RankineCondition",
    "RankineFields",
    "RankineResult",
    "RankineSettings",
    "SurfaceSystem",
    "double_body",
    "normal_component",
    "solve",
    "solve_panels",
    "solver_axes",
    "surface_strengths",
    "surface_system",
]

SOLVER_VERSION = "rankine-1.2"
# Panels off their own plane by this part of their diagonal: on the plane itself the solid angle has two values.
COLLOCATION_LIFT = 1e-5
REFINEMENTS = 3
# Surface cells on a transverse wave of 2 pi Fn^2 L below which a result carries a warning.
FEWEST_CELLS = 10.0


@dataclass(frozen=True, eq=False)
class RankineFields:
    """What can be shown of one condition, in ship axes (x forward from AP, y to port, z up from the baseline), metres.

    Attributes:
        x, y: (nx, ny) points of the water surface, port side; columns from upstream, rows from the hull.
        elevation: (nx, ny) above the static waterline, m.
        quads: (m, 4, 3) hull panels; blocks: their (name, along, across).
        pressure_coefficient: (m,) (p - p0)/(1/2 rho V^2) without the hydrostatic part.
    """

    x: Array
    y: Array
    elevation: Array
    quads: Array
    blocks: tuple[tuple[str, int, int], ...]
    pressure_coefficient: Array


@dataclass(frozen=True, eq=False)
class RankineCondition:
    """The answer at one Froude number; coefficients on 1/2 rho V^2 S with the hull's static wetted surface S.

    Attributes:
        froude_number: V/sqrt(g Lpp).
        wave_coefficient: mean over the momentum planes: the objective.
        wave_coefficient_planes: the value of each plane, the nearest first.
        wave_coefficient_pressure: by pressure on the panels less the double body's on the same panels: a cross-check.
        sinkage: midships, m, positive down; trim: rad, positive bow down. First order, the hull stays fixed.
        elevation_range: lowest and highest elevation on the grid, m.
        fields: for showing, or None.
    """

    froude_number: float
    wave_coefficient: float
    wave_coefficient_planes: tuple[float, ...]
    wave_coefficient_pressure: float
    sinkage: float
    trim: float
    elevation_range: tuple[float, float]
    fields: RankineFields | None = None


@dataclass(frozen=True, eq=False)
class RankineResult:
    """Answers of one hull.

    Attributes:
        conditions: one for each Froude number, in the order asked.
        double_body_drag: the drag coefficient of the double body, zero but for the panels' coarseness.
        unknowns: hull panels plus surface cells.
        warnings: one line each.
        settings, solver: what made it.
    """

    conditions: tuple[RankineCondition, ...]
    double_body_drag: float
    unknowns: int
    warnings: tuple[str, ...]
    settings: RankineSettings
    solver: str = SOLVER_VERSION


@dataclass(frozen=True, eq=False)
class DoubleBody:
    """The flow past the hull and its reflection, in units of Lpp and U.

    Attributes:
        panels: in solver axes.
        lifted: (m, 3) collocation points just off the panels.
        velocities: three (m, m) influence matrices at the lifted points.
        factor: LU of the normal influence.
        strengths: (m,).
        flow: (m, 3) velocity on the panels.
    """

    panels: SourcePanels
    lifted: Array
    velocities: tuple[Array, Array, Array]
    factor: Any
    strengths: Array
    flow: Array

    @property
    def pressure_coefficient(self) -> Array:
        """1 - |U|^2 on the panels."""
        return np.asarray(1.0 - np.sum(self.flow**2, axis=1))


def normal_component(panels: SourcePanels, velocities: Sequence[Array]) -> Array:
    """Normal velocities from three component matrices whose rows are the panels."""
    n = panels.normal
    return np.asarray(n[:, 0, None] * velocities[0] + n[:, 1, None] * velocities[1] + n[:, 2, None] * velocities[2])


@one_blas_thread()
def double_body(panels: SourcePanels, *, image_z: bool = True) -> DoubleBody:
    """Hess-Smith solution in a unit stream along +x.

    Raises:
        SolverFailure: the panels' equations cannot be solved.
    """
    lifted = panels.centre + COLLOCATION_LIFT * panels.diagonal[:, None] * panels.normal
    velocities = panel_velocities(lifted, panels, image_z=image_z)
    matrix = normal_component(panels, velocities)
    if not np.all(np.isfinite(matrix)):
        raise SolverFailure("rankine", "panels coincide: their influence on each other is not finite")
    try:
        factor = lu_factor(matrix, check_finite=False)
        strengths = lu_solve(factor, -panels.normal[:, 0], check_finite=False)
    except (LinAlgError, ValueError) as problem:
        raise SolverFailure("rankine", f"the double-body equations cannot be solved ({problem})") from problem
    flow = np.stack([component @ strengths for component in velocities], axis=1)
    flow[:, 0] += 1.0
    return DoubleBody(panels, lifted, velocities, factor, strengths, flow)


@dataclass(frozen=True, eq=False)
class SurfaceSystem:
    """The free-surface equations with the hull eliminated; what all Froude numbers share.

    Attributes:
        grid: the water surface.
        flow_square: (n,) q of the double body at the collocation points.
        normal_influence: (m, n) normal velocities on the hull from surface sources.
        elimination: (m, n), hull strengths are the double body's minus this times the surface's.
        on_hull: three (m, n) velocities on the hull from surface sources.
        along: (n, n) U.grad p of surface sources and the hull's answer to them.
        convection: (n, n) the operator without gravity.
        vertical: (n, n) p_z.
        forcing: (n,) right-hand side.
    """

    grid: SurfaceGrid
    flow_square: Array
    elimination: Array
    on_hull: tuple[Array, Array, Array]
    along: Array
    convection: Array
    vertical: Array
    forcing: Array


@one_blas_thread()
def surface_system(body: DoubleBody, grid: SurfaceGrid, single_precision: bool = False) -> SurfaceSystem:
    """Assemble the free-surface equations and eliminate the hull's unknowns, these in single precision if asked."""
    kind = np.float32 if single_precision else np.float64
    # On z = 0 the z-image doubles the horizontal velocities and cancels the vertical one.
    hull_u, hull_v, _ = panel_velocities(grid.points, body.panels, image_z=False)
    hull_u *= 2.0
    hull_v *= 2.0
    u = 1.0 + hull_u @ body.strengths
    v = hull_v @ body.strengths
    flow_square = u * u + v * v
    along, vertical = surface_influence(grid.points, grid.sources, grid.area, u, v)
    on_hull = point_velocities(body.lifted, grid.sources, grid.area)
    factor, pivots = body.factor
    coupling = normal_component(body.panels, on_hull).astype(kind, copy=False)
    elimination = lu_solve((factor.astype(kind, copy=False), pivots), coupling, check_finite=False)
    along -= (u[:, None] * hull_u + v[:, None] * hull_v).astype(kind, copy=False) @ elimination

    columns, rows = grid.shape
    weights = difference_weights(grid.points[:, 0].reshape(columns, rows))
    rate = np.zeros((len(u), 1))
    # q - 1 vanishes upstream, as the difference assumes of every function.
    convect(0.5 * (flow_square - 1.0)[:, None], weights, u, np.zeros_like(u), rate)
    convection = np.zeros_like(along)
    convect(along, weights, u, rate[:, 0] / flow_square, convection)
    return SurfaceSystem(grid, flow_square, elimination, on_hull, along, convection, vertical, -rate[:, 0])


@one_blas_thread()
def surface_strengths(system: SurfaceSystem, gravity: float) -> Array:
    """Surface source strengths (n,) at one Froude number, 1/Fn^2 = ``gravity``.

    Factorised in single precision and refined against the double-precision matrix, which restores double precision.

    Raises:
        SolverFailure: singular, or the refinement does not converge.
    """
    scale = float(np.max(np.abs(system.forcing)))
    single = np.zeros(system.vertical.shape, dtype=np.float32)
    combine(system.convection, system.vertical, gravity, single)
    try:
        # LAPACK reads columns first: the rows that stand here are its columns, so it factorises the transpose in place.
        factor = lu_factor(single.T, overwrite_a=True, check_finite=False)
        strengths = np.zeros_like(system.forcing)
        residual = system.forcing
        for _ in range(1 + REFINEMENTS):
            strengths = strengths + lu_solve(factor, residual.astype(np.float32), trans=1, check_finite=False)
            residual = system.forcing - system.convection @ strengths - gravity * (system.vertical @ strengths)
    except (LinAlgError, ValueError) as problem:
        raise SolverFailure("rankine", f"the free-surface equations cannot be solved ({problem})") from problem
    error = float(np.max(np.abs(residual)))
    if not error <= 1e-8 * scale:
        raise SolverFailure(
            "rankine", f"the free-surface equations are too ill-conditioned (residual {error / scale:.1e})"
        )
    return strengths


def solver_axes(body: HullPanels) -> tuple[SourcePanels, Array]:
    """Panels and waterline (bow first) in solver axes: lengths in Lpp, x aft from FP, z up from the surface."""
    quads = body.quads - np.array([0.0, 0.0, body.draft])
    quads = quads / body.length
    quads[..., 0] = 1.0 - quads[..., 0]
    # Turning x round mirrors the panels: the corners' order is reversed to keep the normals outward.
    panels = flat_panels(np.ascontiguousarray(quads[:, ::-1]))
    waterline = body.waterline[::-1] / body.length
    waterline[:, 0] = 1.0 - waterline[:, 0]
    return panels, waterline


@one_blas_thread()
def solve(
    hull: Hull,
    froude_numbers: Sequence[float],
    settings: RankineSettings | None = None,
    fields: bool = False,
) -> RankineResult:
    """Waves and wave resistance of a hull at given Froude numbers.

    Args:
        hull: the hull, floating at its draft, fixed.
        froude_numbers: V/sqrt(g Lpp), each within 0.1 and 0.5.
        settings: mesh and domain; None takes the defaults.
        fields: whether elevations and pressures are returned too.

    Raises:
        InputError: a Froude number outside the range.
        SolverFailure: no trustworthy number for this hull, with the reason.
    """
    chosen = settings or RankineSettings()
    slowest = min(froude_numbers, default=None)
    body = hull_panels(hull, chosen.hull_lengthwise, chosen.hull_girthwise, slowest)
    return solve_panels(body, froude_numbers, chosen, fields)


@one_blas_thread()
def solve_panels(
    body: HullPanels, froude_numbers: Sequence[float], settings: RankineSettings, fields: bool = False
) -> RankineResult:
    """As ``solve``, for any hull given as panels."""
    numbers = check_froude_numbers(froude_numbers)
    keep_freed_memory()
    return _solve(body, numbers, settings, fields)


def _solve(body: HullPanels, numbers: tuple[float, ...], settings: RankineSettings, fields: bool) -> RankineResult:
    if len(numbers) == 0:
        raise InputError("Rankine solver: no Froude number given")
    panels, waterline = solver_axes(body)
    check_panels(body, panels)
    base = double_body(panels)
    reference = body.wetted_surface / body.length**2
    drag = 2.0 * float(pressure_force(base.pressure_coefficient, panels)[0]) / reference
    check_base_flow(base.strengths, base.flow, drag)

    grid = surface_grid(waterline, settings)
    system = surface_system(base, grid, settings.single_precision)
    grid_step = float(np.ptp(waterline[:, 0])) / settings.columns_along_hull
    gravity = 1.0 / np.array(numbers) ** 2
    if settings.single_precision:
        on_surface = strengths_together(system.convection, system.vertical, system.forcing, gravity)
    else:
        on_surface = np.stack([surface_strengths(system, float(g)) for g in gravity], axis=1)
    on_hull = base.strengths[:, None] - system.elimination @ on_surface
    tail_end = max(0.0, float(waterline[-1, 0]) - 1.0) if body.tail_panels else 0.0
    by_plane = plane_resistance(wave_planes(grid, settings, tail_end), panels, on_hull, grid, on_surface, gravity)
    by_plane *= 2.0 / reference

    disturbance = [
        hull @ (on_hull - base.strengths[:, None]) + surface @ on_surface
        for hull, surface in zip(base.velocities, system.on_hull, strict=True)
    ]
    along = system.along @ on_surface
    # The tail behind a wet transom is no part of the hull.
    wet = (np.arange(panels.count) < panels.count - body.tail_panels).astype(np.float64)
    conditions = []
    for k, number in enumerate(numbers):
        flow = base.flow + np.stack([component[:, k] for component in disturbance], axis=1)
        pressure = 1.0 - np.sum(flow**2, axis=1)
        by_pressure = pressure_force((pressure - base.pressure_coefficient) * wet, panels)[0] * 2.0 / reference
        elevation = 0.5 * number**2 * (1.0 - system.flow_square - 2.0 * along[:, k]) * body.length
        sinkage, trim = sinkage_and_trim(pressure * wet, panels, waterline, float(gravity[k]))
        shown = _fields(body, grid, elevation, pressure) if fields else None
        condition = RankineCondition(
            froude_number=number,
            wave_coefficient=float(np.mean(by_plane[:, k])),
            wave_coefficient_planes=tuple(float(value) for value in by_plane[:, k]),
            wave_coefficient_pressure=float(by_pressure),
            sinkage=sinkage * body.length,
            trim=trim,
            elevation_range=(float(np.min(elevation)), float(np.max(elevation))),
            fields=shown,
        )
        by_both = condition.wave_coefficient, condition.wave_coefficient_pressure
        check_answer(number, *by_both, elevation, grid_step)
        conditions.append(condition)
    return RankineResult(
        conditions=tuple(conditions),
        double_body_drag=drag,
        unknowns=panels.count + len(grid.area),
        warnings=body.warnings + _warnings(numbers, grid_step),
        settings=settings,
    )


def _fields(body: HullPanels, grid: SurfaceGrid, elevation: Array, pressure: Array) -> RankineFields:
    points = grid.points.reshape(*grid.shape, 3)
    return RankineFields(
        x=(1.0 - points[..., 0]) * body.length,
        y=points[..., 1] * body.length,
        elevation=elevation.reshape(grid.shape),
        quads=body.quads,
        blocks=body.blocks,
        pressure_coefficient=pressure,
    )


def _warnings(numbers: Sequence[float], step: float) -> tuple[str, ...]:
    """Cells of length ``step`` (in Lpp) per transverse wave, where they are few."""
    lines = []
    for number in numbers:
        cells = 2.0 * np.pi * number**2 / step
        if cells < FEWEST_CELLS:
            lines.append(
                f"Froude number {number:g}: {cells:.1f} cells on a transverse wave of 2 pi Fn^2 L = "
                f"{2 * np.pi * number**2:.3f} L; the waves come out too small"
            )
    return tuple(lines)
