"""A propeller's potential flow, factorised once, and its solution at any advance coefficient.

Blades and hub carry dipoles and sources, helical wakes carry dipoles. With

    phi = V phi_V + omega phi_omega + sum_m dphi_m phi_m

one factorisation serves all advance coefficients. Forces come from the strips' circulations (Kutta-Joukowski), which
converge on grids far too coarse for the pressures; integrating the pressures is the audit on a fine grid. Equations,
signs, what is neglected and the accuracy found: docs/theory-propeller-panels.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.blade_panels.forces import (
    OMEGA,
    StripData,
    circulation_forces,
    drag_forces,
    induction_matrices,
    local_flow,
    pressure_forces,
)
from hpsop_core.hydro.blade_panels.grid import STAGE, BladeGrid, blade_grid, helical_wake
from hpsop_core.hydro.blade_panels.hub_grid import HubGrid, hub_grid
from hpsop_core.hydro.blade_panels.potential import KuttaProblem, SurfaceGradient, factorise, tangential
from hpsop_core.hydro.blade_panels.settings import CROSS_FLOW_DISTANCE, HUB_WAKE_PITCH, BladePanelSettings
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array, BoolArray

_PITCH_TOLERANCE = 1e-8


@dataclass(frozen=True)
class FlowCondition:
    """The flow at one advance coefficient: jumps (m,) of the potential, wake pitch P/R (scalar)."""

    advance_coefficient: float
    jump: Array
    wake_pitch: float


@dataclass(frozen=True)
class BladePanelModel:
    """A propeller's factorised flow, ready for any advance coefficient. Lengths in tip radii, n = 1, rho = 1.

    Attributes:
        propeller, settings: what was solved.
        grid, hub: the panels.
        strips: data of the strips for the force formulas.
        onset_points: (n, 3) where the onset flow is taken.
        onset_potential: (n, 2) phi of V = 1 and of omega = 1.
        wake_pitches: (k,) scalar pitch P/R of each tabulated wake (one, of no meaning, for "geometric_pitch").
        wake_potentials: (k, n, m) phi of unit jumps.
        wake_terms: (k, 5, m, 3, m) of the Kutta condition.
        kutta: the condition at the trailing edge.
        row_sum_defect: (n,) of the dipole matrix.
    """

    propeller: Propeller
    settings: BladePanelSettings
    grid: BladeGrid
    hub: HubGrid
    strips: StripData
    onset_points: Array
    onset_potential: Array
    wake_pitches: Array
    wake_potentials: Array
    wake_terms: Array
    kutta: KuttaProblem
    row_sum_defect: Array

    def interpolate(self, table: Array, wake_pitch: float) -> Array:
        """A table over the wake pitches (k, ...) at one pitch, by the polynomial in its logarithm through them."""
        if self.wake_pitches.size == 1:
            result: Array = table[0]
            return result
        place, nodes = float(np.log(wake_pitch)), np.log(self.wake_pitches)
        weights = np.array([np.prod([(place - b) / (a - b) for b in nodes if b != a]) for a in nodes])
        return np.asarray(np.tensordot(weights, table, 1))

    def edge_pitch(self, wake_pitch: float) -> Array:
        """(m + 1,) P/R of the wake from each strip edge."""
        if self.settings.wake == "geometric_pitch":
            return np.asarray(2.0 * self.propeller.table.at(self.grid.radius_edges).pitch_ratio)
        return np.full(self.grid.radius_edges.size, wake_pitch)

    def condition(self, advance_coefficient: float) -> FlowCondition:
        """Solve one advance coefficient: jumps by the Kutta condition, wake pitch by alignment.

        Raises:
            SolverFailure: the Kutta condition or the alignment does not converge.
        """
        weights = np.array([2.0 * advance_coefficient, OMEGA])
        label = f"J = {advance_coefficient:g}"

        def jumps(wake_pitch: float, start: Array | None) -> Array:
            terms = self.interpolate(self.wake_terms, wake_pitch)
            first = self.kutta.first_guess(weights, terms) if start is None else start
            return self.kutta.solve(weights, terms, first, label)

        if self.settings.wake == "geometric_pitch":
            return FlowCondition(advance_coefficient, jumps(0.0, None), 0.0)
        low, high = float(self.wake_pitches[0]), float(self.wake_pitches[-1])
        # where the wake of a usual propeller settles
        blade_pitch = 2.0 * self.propeller.pitch_diameter_ratio_07R
        pitch = min(max(0.62 * blade_pitch + 0.44 * 2.0 * advance_coefficient, low), high)
        jump = jumps(pitch, None)
        last: tuple[float, float] | None = None
        for _ in range(40):
            error = min(max(self._loaded_pitch(jump, pitch, advance_coefficient), low), high) - pitch
            if abs(error) < _PITCH_TOLERANCE:
                return FlowCondition(advance_coefficient, jump, pitch)
            slope = -1.0 if last is None or pitch == last[0] else (error - last[1]) / (pitch - last[0])
            last = (pitch, error)
            # the error falls with the pitch, at a slope of about -0.7 to -1.3
            pitch = min(max(pitch - error / min(max(slope, -3.0), -0.3), low), high)
            jump = jumps(pitch, jump)
        raise SolverFailure(STAGE, f"the wake does not align with the loading at {label} (pitch {error:.1e} R off)")

    def _loaded_pitch(self, jump: Array, wake_pitch: float, advance_coefficient: float) -> float:
        """Hydrodynamic pitch 2 pi r tan(beta_i), averaged over the radius with the weight of an elliptic loading."""
        flow = local_flow(
            self.strips, jump, 2.0 * advance_coefficient, induction_matrices(self.strips, self.edge_pitch(wake_pitch))
        )
        edges = self.strips.edges
        fraction = (self.strips.radius - edges[0]) / (edges[-1] - edges[0])
        weight = np.sqrt(fraction * (1.0 - fraction)) * self.strips.width * self.strips.radius
        pitch = OMEGA * self.strips.radius * flow.axial / flow.tangential
        return float(np.sum(weight * pitch) / np.sum(weight))

    def forces(self, condition: FlowCondition, drag: SectionDrag) -> tuple[float, float]:
        """(KT, KQ) of a solved condition."""
        advance = 2.0 * condition.advance_coefficient
        matrices = induction_matrices(self.strips, self.edge_pitch(condition.wake_pitch))
        flow = local_flow(self.strips, condition.jump, advance, matrices)
        viscous = drag_forces(self.strips, flow, advance, drag)
        if self.settings.forces == "circulation":
            thrust, torque = circulation_forces(self.strips, condition.jump, flow)
        else:
            panels = self.grid.surface.panels
            thrust, torque = pressure_forces(
                self.blade_pressure(condition).ravel(),
                panels.axes[:, 2] * panels.moments[:, :1],
                panels.centre,
                self.propeller.blade_count,
            )
        if self.settings.hub_in_forces:
            panels = self.hub.panels
            hub_thrust, hub_torque = pressure_forces(
                self.hub_pressure(condition),
                panels.axes[:, 2] * panels.moments[:, :1],
                panels.centre,
                self.propeller.blade_count,
            )
            thrust, torque = thrust + hub_thrust, torque + hub_torque
        return thrust + viscous[0], torque + viscous[1]

    def _potential(self, condition: FlowCondition) -> Array:
        weights = np.array([2.0 * condition.advance_coefficient, OMEGA])
        wake = self.interpolate(self.wake_potentials, condition.wake_pitch)
        return np.asarray(self.onset_potential @ weights + wake @ condition.jump)

    def _pressure(self, condition: FlowCondition, points: Array, normal: Array, rows: slice) -> Array:
        """(p - p_inf)/rho = (U^2 - v^2)/2 on a grid of collocation points (n, m, 3)."""
        weights = np.array([2.0 * condition.advance_coefficient, OMEGA])
        shape = points.shape[:2]
        potential = self._potential(condition)[rows].reshape(*shape, 1)
        onset = (rotating_onset(self.onset_points[rows]) @ weights).reshape(*shape, 3, 1)
        velocity = tangential(onset, normal) + SurfaceGradient.on(points).of(potential)
        return np.asarray(0.5 * (np.sum(onset**2, axis=(2, 3)) - np.sum(velocity**2, axis=(2, 3))))

    def blade_pressure(self, condition: FlowCondition) -> Array:
        """(n, m) pressures over rho (n = R = 1) at the blade's collocation points."""
        surface = self.grid.surface
        return self._pressure(condition, surface.collocation, surface.normal, slice(0, surface.panels.count))

    def hub_pressure(self, condition: FlowCondition) -> Array:
        """(n,) pressures over rho at the hub's collocation points."""
        count = self.grid.surface.panels.count
        pressures = []
        for block, part in zip(self.hub.blocks, self.hub.block_slices, strict=True):
            shape = (block.shape[0] - 1, block.shape[1] - 1, 3)
            rows = slice(part.start + count, part.stop + count)
            points, normal = self.hub.collocation[part].reshape(shape), self.hub.normal[part].reshape(shape)
            pressures.append(self._pressure(condition, points, normal, rows).ravel())
        return np.concatenate(pressures)


def rotating_onset(points: Array) -> Array:
    """(n, 3, 2) velocities of V = 1 (along x) and of omega = 1 (-r theta^) at points (n, 3)."""
    onset = np.zeros((points.shape[0], 3, 2))
    onset[:, 0, 0] = 1.0
    onset[:, 1, 1] = points[:, 2]
    onset[:, 2, 1] = -points[:, 1]
    return onset


def blade_panel_model(propeller: Propeller, settings: BladePanelSettings, viscous: bool = False) -> BladePanelModel:
    """Panel and factorise a propeller, with the camber that a viscous flow leaves if ``viscous``.

    Raises:
        SolverFailure: the panels cannot represent the geometry.
    """
    camber = settings.camber_effectiveness if viscous else 1.0
    table = propeller.table
    effective = replace(propeller, table=replace(table, camber_ratio=camber * table.camber_ratio))
    grid = blade_grid(effective, settings.chordwise_panels, settings.radial_panels)
    pitch_07 = 2.0 * propeller.pitch_diameter_ratio_07R
    hub = hub_grid(grid, propeller.blade_count, settings.hub, HUB_WAKE_PITCH * pitch_07)
    onset_points = np.concatenate([grid.onset_points.reshape(-1, 3), hub.collocation])
    body = factorise(
        grid.surface,
        propeller.blade_count,
        rotating_onset(onset_points),
        hub,
    )
    kutta = KuttaProblem.of(body, _cross_flow_share(propeller, grid), _end_strips(settings.radial_panels))
    if settings.wake == "geometric_pitch":
        wake_pitches = np.zeros(1)
        pitches = [2.0 * propeller.table.at(grid.radius_edges).pitch_ratio]
    else:
        wake_pitches = settings.wake_pitch_nodes() * pitch_07
        pitches = [np.full(grid.radius_edges.size, p) for p in wake_pitches]
    potentials = np.stack([body.wake_potential(*helical_wake(grid, p, settings.wake_grid)) for p in pitches])
    if not np.all(np.isfinite(potentials)):
        raise SolverFailure(STAGE, "the potential of the wake is not finite")
    terms = np.stack([kutta.wake_terms(p) for p in potentials])
    return BladePanelModel(
        propeller,
        settings,
        grid,
        hub,
        StripData.of(propeller, grid),
        onset_points,
        body.onset_potential,
        wake_pitches,
        potentials,
        terms,
        kutta,
        body.row_sum_defect,
    )


def _cross_flow_share(propeller: Propeller, grid: BladeGrid) -> Array:
    """(m,) share of the cross flow in the Kutta condition: rises smoothly with the distance from the blade's ends."""
    radius, edges = grid.radius_middle, grid.radius_edges
    distance = np.minimum(radius - edges[0], edges[-1] - radius) / (2.0 * propeller.table.at(radius).chord_ratio)
    low, high = CROSS_FLOW_DISTANCE
    x = np.clip((distance - low) / (high - low), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))


def _end_strips(strips: int) -> BoolArray:
    ends = np.zeros(strips, dtype=np.bool_)
    ends[[0, -1]] = True
    return ends
