"""Pressures on blades and hub for the page, and the margin against cavitation that follows from them.

Cp = (p - p_inf)/(rho/2 U^2) with U^2 = V^2 + (omega r)^2, the undisturbed relative speed at the panel's own radius
(not at 0.7 R).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.propeller.surface import rotate_blade
from hpsop_core.hydro.blade_panels.forces import OMEGA
from hpsop_core.hydro.blade_panels.grid import blade_grid, to_propeller_axes
from hpsop_core.hydro.blade_panels.model import BladePanelModel, FlowCondition
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, IntArray

MARGIN_RADIUS = 0.9
"""The margin against cavitation is taken from the hub to this r/R."""

_MARGIN_STATIONS = 15


@dataclass(frozen=True)
class SurfacePressure:
    """Pressure on panels, ready to be drawn.

    Attributes:
        advance_coefficient: J.
        points: (np, 3) corners in m, propeller axes (x downstream, y to starboard, z up, blade 0 upwards).
        quads: (nq, 4) indices into points, counter-clockwise seen from the water; a triangle has two equal points.
        pressure_coefficient: (nq,) Cp on U^2 = V^2 + (omega r)^2.
        dynamic_pressure: (nq,) U^2/2 over rho for n = R = 1, which Cp refers to.
        blade: (nq,) number of the blade, -1 on the hub.
    """

    advance_coefficient: float
    points: Array
    quads: IntArray
    pressure_coefficient: Array
    dynamic_pressure: Array
    blade: IntArray


@one_blas_thread()
def surface_pressure(model: BladePanelModel, advance_coefficient: float, all_blades: bool = True) -> SurfacePressure:
    """Cp on the blades (one or all) and on the hub (one sector or all) at any J.

    The surface drawn is the true one, also where a viscous camber factor was used to compute the pressures.

    Raises:
        InputError: J is negative or not finite.
        SolverFailure: the condition does not converge.
    """
    if not (np.isfinite(advance_coefficient) and advance_coefficient >= 0.0):
        raise InputError(f"advance coefficient {advance_coefficient} must be a finite number of at least 0")
    condition = model.condition(float(advance_coefficient))
    blade_speed = _relative_speed_squared(model.grid.surface.collocation, advance_coefficient)
    hub_speed = _relative_speed_squared(model.hub.collocation, advance_coefficient)
    blade_cp = (2.0 * model.blade_pressure(condition) / blade_speed).ravel()
    hub_cp = 2.0 * model.hub_pressure(condition) / hub_speed
    rows, strips = model.grid.surface.shape
    blade_corners = blade_grid(model.propeller, rows, strips).surface.corners
    scale = 0.5 * model.propeller.diameter
    count = model.propeller.blade_count
    # one block of panels a time: the blade, then the hub's
    surfaces = [(blade_corners, blade_cp, blade_speed.ravel(), True)] + [
        (corners, hub_cp[part], hub_speed[part], False)
        for corners, part in zip(model.hub.blocks, model.hub.block_slices, strict=True)
    ]
    points: list[Array] = []
    quads: list[IntArray] = []
    values: list[Array] = []
    speeds: list[Array] = []
    blades: list[IntArray] = []
    offset = 0
    for number in range(count if all_blades else 1):
        for corners, coefficient, speed, is_blade in surfaces:
            n, m = corners.shape[:2]
            place = np.arange(n * m).reshape(n, m)
            # Swapping y and z mirrors the panels, so their corners turn the other way.
            quad = np.stack([place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]], axis=2).reshape(-1, 4)
            points.append(rotate_blade(scale * to_propeller_axes(corners.reshape(-1, 3)), number, count))
            quads.append(quad + offset)
            values.append(coefficient)
            speeds.append(speed)
            blades.append(np.full(quad.shape[0], number if is_blade else -1))
            offset += n * m
    return SurfacePressure(
        float(advance_coefficient),
        np.concatenate(points),
        np.concatenate(quads),
        np.concatenate(values),
        0.5 * np.concatenate(speeds),
        np.concatenate(blades),
    )


def _relative_speed_squared(points: Array, advance_coefficient: float) -> Array:
    radius = np.hypot(points[..., 1], points[..., 2])
    return np.asarray((2.0 * advance_coefficient) ** 2 + (OMEGA * radius) ** 2)


@dataclass(frozen=True)
class CavitationMargin:
    """How far the blades are from the vapour pressure, a blade upwards being the worst case.

    Attributes:
        margin: least Cp + sigma between the hub and 0.9 R; negative where the water would evaporate.
        minimum_pressure_coefficient: Cp at that place, sigma: the cavitation number there, both on U^2 of its radius.
        radius_ratio: r/R of that place.
        cavitating_share: share of the suction side's area on which Cp < -sigma, without the end strips.
    """

    margin: float
    minimum_pressure_coefficient: float
    sigma: float
    radius_ratio: float
    cavitating_share: float


@dataclass(frozen=True, eq=False)
class BladePressureTable:
    """The pressures on a blade at some advance coefficients: all that the margin needs, small enough to be remembered.

    Attributes:
        advance_coefficient: J, (nJ,), different from each other.
        pressure: (nJ, n, m) over rho, for n = R = 1; back and face as in ``StripSurface``.
        radius: (n, m) r/R of the panels.
        strip_radius: (m,) r/R of the strips.
        area: (n, m) of the panels over R^2.
        hub_ratio: r_hub/R.
    """

    advance_coefficient: Array
    pressure: Array
    radius: Array
    strip_radius: Array
    area: Array
    hub_ratio: float

    @classmethod
    def of(cls, model: BladePanelModel, conditions: Sequence[FlowCondition]) -> BladePressureTable:
        """At the advance coefficients of solved conditions."""
        surface = model.grid.surface
        return cls(
            np.array([condition.advance_coefficient for condition in conditions]),
            np.stack([model.blade_pressure(condition) for condition in conditions]),
            np.hypot(surface.collocation[..., 1], surface.collocation[..., 2]),
            model.grid.radius_middle,
            surface.panels.moments[:, 0].reshape(surface.shape),
            float(model.grid.radius_edges[0]),
        )

    def at(self, advance_coefficient: float) -> Array:
        """(n, m) pressures at a J, by the polynomial through the table's."""
        nodes = self.advance_coefficient
        weights = [np.prod([(advance_coefficient - b) / (a - b) for b in nodes if b != a]) for a in nodes]
        return np.asarray(np.tensordot(np.array(weights), self.pressure, 1))

    def margin(
        self,
        advance_coefficient: float,
        diameter: float,
        rotation_rate: float,
        density: float,
        pressure_margin_pascal: float,
        gravity: float = 9.80665,
    ) -> CavitationMargin:
        """Least pressure on the blade against the vapour pressure, in the uniform wake of the open-water condition.

        sigma = (P0 - Pv - rho g r)/(rho/2 U^2) at each radius, with the blade upwards. Nearer to the tip than 0.9 R the
        least pressure belongs to a thin nose and to the tip vortex: it falls without end as the panels get smaller, so
        the margin stops there. The share of the area counts the tip.

        Args:
            advance_coefficient: J within the table.
            diameter: D in m.
            rotation_rate: n in 1/s.
            density: kg/m3.
            pressure_margin_pascal: P0 - Pv at the shaft's depth, Pa (hydro.cavitation.pressure_margin).
            gravity: m/s2.

        Raises:
            InputError: diameter, rotation rate or density is not positive, or J lies outside the table.
        """
        if not (diameter > 0.0 and rotation_rate > 0.0 and density > 0.0):
            raise InputError("cavitation margin: diameter, rotation_rate and density must be positive")
        lowest, highest = float(np.min(self.advance_coefficient)), float(np.max(self.advance_coefficient))
        if not lowest <= advance_coefficient <= highest:
            raise InputError(
                f"cavitation margin: J = {advance_coefficient:g} lies outside the table, {lowest:g} to {highest:g}"
            )
        tip_radius = 0.5 * diameter
        scale = density * (rotation_rate * tip_radius) ** 2

        def dynamic(radius: Array) -> Array:
            return np.asarray(0.5 * (4.0 * advance_coefficient**2 + (OMEGA * radius) ** 2))

        def cavitation_number(radius: Array) -> Array:
            head = pressure_margin_pascal - density * gravity * tip_radius * radius
            return np.asarray(head / (scale * dynamic(radius)))

        coefficient = self.at(advance_coefficient) / dynamic(self.radius)
        radii = np.linspace(self.hub_ratio + 0.1 * (1.0 - self.hub_ratio), MARGIN_RADIUS, _MARGIN_STATIONS)
        coefficient_there = np.stack([np.interp(radii, self.strip_radius, row) for row in coefficient])
        sigma_there = cavitation_number(radii)
        reserve = coefficient_there + sigma_there
        row, place = np.unravel_index(int(np.argmin(reserve)), reserve.shape)
        back = slice(self.area.shape[0] // 2, None)
        area = self.area[back, 1:-1]
        evaporates = (coefficient + cavitation_number(self.radius))[back, 1:-1] < 0.0
        return CavitationMargin(
            float(reserve[row, place]),
            float(coefficient_there[row, place]),
            float(sigma_there[place]),
            float(radii[place]),
            float(np.sum(area[evaporates]) / np.sum(area)),
        )
