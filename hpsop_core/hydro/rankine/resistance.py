"""Resistance, elevation, sinkage and trim from a Rankine solution.

Solver axes: lengths in Lpp, speeds in U, x aft from FP, z up from the surface, g = 1/Fn^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.rankine.grid import SurfaceGrid
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.singularities.source_panels import SourcePanels, panel_velocities, point_velocities
from hpsop_core.typing_aliases import Array


@dataclass(frozen=True, eq=False)
class WavePlanes:
    """Points of the transverse momentum planes with their quadrature weights.

    Attributes:
        points: (planes, rows, 1 + layers, 3); the first of the vertical points lies on the surface.
        width: (rows,) of the rows.
        depth_weight: (layers,) quadrature weights in z.
    """

    points: Array
    width: Array
    depth_weight: Array


def wave_planes(grid: SurfaceGrid, settings: RankineSettings, tail_end: float = 0.0) -> WavePlanes:
    """The planes behind the ship; rows are the grid's own, so that lattice ripples of the sources cancel.

    Args:
        grid: of the surface.
        settings: where the planes are, aft of AP.
        tail_end: how far aft of AP the closure of a wet transom ends; the planes start there instead.

    Raises:
        SolverFailure: the tail pushes a plane out of the domain.
    """
    if tail_end + max(settings.planes) >= settings.downstream:
        raise SolverFailure("rankine", f"the tail behind the transom, {tail_end:.3f} L, leaves no room for the planes")
    stretch = 4.0
    edges = -settings.plane_depth * np.expm1(stretch * np.linspace(0.0, 1.0, settings.plane_layers + 1))
    edges /= np.expm1(stretch)
    half = 0.5 * (edges[:-1] - edges[1:])
    middle = 0.5 * (edges[:-1] + edges[1:])
    # Two Gauss points a layer.
    root = 1.0 / np.sqrt(3.0)
    depths = np.stack([middle + root * half, middle - root * half], axis=1).reshape(-1)
    weight = np.repeat(half, 2)
    x = 1.0 + tail_end + np.array(settings.planes)
    z = np.concatenate([[0.0], depths])
    mesh = np.meshgrid(x, grid.row_middle, z, indexing="ij")
    return WavePlanes(np.stack(mesh, axis=-1), grid.row_width, weight)


def plane_resistance(
    planes: WavePlanes,
    panels: SourcePanels,
    hull_strengths: Array,
    grid: SurfaceGrid,
    surface_strengths: Array,
    gravity: Array,
) -> Array:
    """Wave resistance by conservation of momentum, (planes, conditions), both sides of the ship.

        R = 1/2 rho g int eta^2 dy + 1/2 rho iint (v^2 + w^2 - u^2) dy dz,   eta = -u/g,

    over a transverse plane behind the ship, u, v, w the whole disturbance of the uniform stream (Eggers, Sharma and
    Ward 1967); returned in units of rho U^2 Lpp^2.

    Args:
        planes: where.
        panels, hull_strengths: hull sources (m, conditions), with their z-images.
        grid, surface_strengths: raised sources (n, conditions).
        gravity: (conditions,) 1/Fn^2.
    """
    shape = planes.points.shape[:3]
    flat = planes.points.reshape(-1, 3)
    from_hull = panel_velocities(flat, panels, image_z=True)
    from_surface = point_velocities(flat, grid.sources, grid.area)
    u, v, w = (
        (hull @ hull_strengths + surface @ surface_strengths).reshape(*shape, -1)
        for hull, surface in zip(from_hull, from_surface, strict=True)
    )
    elevation = -u[:, :, 0, :] / gravity
    surface_term = gravity * np.einsum("pyc,y->pc", elevation**2, planes.width)
    flux = (v**2 + w**2 - u**2)[:, :, 1:, :]
    depth_term = np.einsum("pyzc,y,z->pc", flux, planes.width, planes.depth_weight)
    # Half of each integral, and both sides of the ship.
    return np.asarray(surface_term + depth_term)


def pressure_force(pressure_coefficient: Array, panels: SourcePanels) -> Array:
    """Force (3,) on the whole hull from a pressure coefficient (m,), in units of rho U^2 Lpp^2; y cancels."""
    force: Array = -np.einsum("m,m,mc->c", pressure_coefficient, panels.area, panels.normal)
    force[1] = 0.0
    return force


def sinkage_and_trim(
    pressure_coefficient: Array, panels: SourcePanels, waterline: Array, gravity: float
) -> tuple[float, float]:
    """First-order sinkage midships (Lpp, positive down) and trim (rad, positive bow down) of the fixed-hull pressure.

    The dynamic lift and its moment are balanced by the change of buoyancy of a wall-sided hull; the lever between the
    centres of gravity and buoyancy is neglected against the longitudinal metacentric radius.

    Args:
        pressure_coefficient: (m,) of the whole flow, without the hydrostatic part.
        panels: hull panels.
        waterline: (n, 2) x and half-breadth, ascending in x.
        gravity: 1/Fn^2.
    """
    lift = -pressure_coefficient * panels.area * panels.normal[:, 2]
    thrust = -pressure_coefficient * panels.area * panels.normal[:, 0]
    x = panels.centre[:, 0] - 0.5
    # Per unit of rho U^2 Lpp^2: 1/2 from the dynamic pressure, 2 from both sides. Moments raise the stern.
    force = float(np.sum(lift))
    moment = float(np.sum(lift * x - thrust * panels.centre[:, 2]))
    at = waterline[:, 0] - 0.5
    breadth = 2.0 * waterline[:, 1]
    area, first, second = (float(np.trapezoid(breadth * at**k, at)) for k in range(3))
    # rise(x) = a + b x carries gravity * int breadth * rise * (1, x) dx
    determinant = gravity * (area * second - first**2)
    if determinant <= 0.0:
        # A submerged body has no waterplane that could hold it.
        return 0.0, 0.0
    rise = (force * second - moment * first) / determinant
    slope = (moment * area - force * first) / determinant
    return -rise, slope
