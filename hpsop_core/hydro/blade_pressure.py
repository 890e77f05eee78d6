"""Pressures on blades and hub for the page, and the margin against cavitation that follows from them.

Cp = (p - p_inf)/(rho/2 U^2) with U^2 = V^2 + (omega r)^2, the undisturbed relative speed at the panel's own radius
(not at 0.7 R).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.propeller_surface import rotate_blade
from hpsop_core.hydro.blade_forces import OMEGA
from hpsop_core.hydro.blade_grid import blade_grid, to_propeller_axes
from hpsop_core.hydro.blade_panels import BladePanelResult
from hpsop_core.typing_aliases import Array, IntArray


@dataclass(frozen=True)
class SurfacePressure:
    """Pressure on panels, ready to be drawn.

    Attributes:
        advance_coefficient: J.
        points: (np, 3) corners in m, propeller axes (x downstream, y to starboard, z up, blade 0 upwards).
        quads: (nq, 4) indices into points, counter-clockwise seen from the water; a triangle has two equal points.
        pressure_coefficient: (nq,) Cp on U^2 = V^2 + (omega r)^2.
        blade: (nq,) number of the blade, -1 on the hub.
    """

    advance_coefficient: float
    points: Array
    quads: IntArray
    pressure_coefficient: Array
    blade: IntArray


def surface_pressure(result: BladePanelResult, advance_coefficient: float, all_blades: bool = True) -> SurfacePressure:
    """Cp on the blades (one or all) and on the hub (one sector or all) at any J.

    The surface drawn is the true one, also where a viscous camber factor was used to compute the pressures.

    Raises:
        InputError: J is negative or not finite.
        SolverFailure: the condition does not converge.
    """
    if not (np.isfinite(advance_coefficient) and advance_coefficient >= 0.0):
        raise InputError(f"advance coefficient {advance_coefficient} must be a finite number of at least 0")
    model = result.model
    condition = model.condition(float(advance_coefficient))
    speed = _relative_speed_squared(model.grid.surface.collocation, advance_coefficient)
    blade_cp = (2.0 * model.blade_pressure(condition) / speed).ravel()
    hub_cp = 2.0 * model.hub_pressure(condition) / _relative_speed_squared(model.hub.collocation, advance_coefficient)
    rows, strips = model.grid.surface.shape
    blade_corners = blade_grid(model.propeller, rows, strips).surface.corners
    scale = 0.5 * model.propeller.diameter
    count = model.propeller.blade_count
    points: list[Array] = []
    quads: list[IntArray] = []
    values: list[Array] = []
    blades: list[IntArray] = []
    offset = 0
    for number in range(count if all_blades else 1):
        for index, corners in enumerate((blade_corners, *model.hub.blocks)):
            n, m = corners.shape[:2]
            place = np.arange(n * m).reshape(n, m)
            # Swapping y and z mirrors the panels, so their corners turn the other way.
            quad = np.stack([place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]], axis=2).reshape(-1, 4)
            points.append(rotate_blade(scale * to_propeller_axes(corners.reshape(-1, 3)), number, count))
            quads.append(quad + offset)
            values.append(blade_cp if index == 0 else hub_cp[model.hub.block_slices[index - 1]])
            blades.append(np.full(quad.shape[0], number if index == 0 else -1))
            offset += n * m
    return SurfacePressure(
        float(advance_coefficient),
        np.concatenate(points),
        np.concatenate(quads),
        np.concatenate(values),
        np.concatenate(blades),
    )


def _relative_speed_squared(points: Array, advance_coefficient: float) -> Array:
    radius = np.hypot(points[..., 1], points[..., 2])
    return np.asarray((2.0 * advance_coefficient) ** 2 + (OMEGA * radius) ** 2)


@dataclass(frozen=True)
class CavitationMargin:
    """How far the blades are from the vapour pressure, a blade upwards being the worst case.

    Attributes:
        margin: least Cp + sigma on the blade; negative where the water would evaporate.
        minimum_pressure_coefficient: Cp at that panel, sigma: the cavitation number there, both on U^2 of its radius.
        radius_ratio: r/R of that panel.
        cavitating_share: share of the suction side's area on which Cp < -sigma.
    """

    margin: float
    minimum_pressure_coefficient: float
    sigma: float
    radius_ratio: float
    cavitating_share: float


def cavitation_margin(
    result: BladePanelResult,
    advance_coefficient: float,
    rotation_rate: float,
    density: float,
    pressure_margin_pascal: float,
    gravity: float = 9.80665,
) -> CavitationMargin:
    """Least pressure on the blade against the vapour pressure, in the uniform wake of the open-water condition.

    sigma = (P0 - Pv - rho g r)/(rho/2 U^2) at each panel's radius, with the blade upwards. The end strips at hub and
    tip are left out: their pressures are those of a sharp edge that no blade has. On the optimiser's grid the nose is
    coarse; for a figure to rely on solve with 48 x 16 panels or more.

    Args:
        result: of ``blade_panels.solve``.
        advance_coefficient: J.
        rotation_rate: n in 1/s.
        density: kg/m3.
        pressure_margin_pascal: P0 - Pv at the shaft's depth, Pa (hydro.cavitation.pressure_margin).
        gravity: m/s2.

    Raises:
        InputError: rotation rate or density is not positive.
        SolverFailure: the condition does not converge.
    """
    if not (rotation_rate > 0.0 and density > 0.0):
        raise InputError("cavitation margin: rotation_rate and density must be positive")
    model = result.model
    surface = model.grid.surface
    condition = model.condition(float(advance_coefficient))
    speed = _relative_speed_squared(surface.collocation, advance_coefficient)
    coefficient = 2.0 * model.blade_pressure(condition) / speed
    tip_radius = 0.5 * model.propeller.diameter
    radius = np.hypot(surface.collocation[..., 1], surface.collocation[..., 2])
    head = pressure_margin_pascal - density * gravity * radius * tip_radius
    sigma = head / (0.5 * density * speed * (rotation_rate * tip_radius) ** 2)
    reserve = (coefficient + sigma)[:, 1:-1]
    row, strip = np.unravel_index(int(np.argmin(reserve)), reserve.shape)
    back = slice(surface.shape[0] // 2, None)
    area = surface.panels.moments[:, 0].reshape(surface.shape)[back, 1:-1]
    return CavitationMargin(
        float(reserve[row, strip]),
        float(coefficient[row, strip + 1]),
        float(sigma[row, strip + 1]),
        float(radius[row, strip + 1]),
        float(np.sum(area[reserve[back] < 0.0]) / np.sum(area)),
    )
