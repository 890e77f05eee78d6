"""Level 1 for the propeller: a lifting line whose circulation comes from flow tangency on the chord.

Each strip of a blade carries two bound vortices, at 1/8 and 5/8 of its chord; their legs trail along the chord to the
trailing edge and then along a helix of one pitch. The circulations make the flow tangent to the camber line at 3/8 and
7/8 of the chord (Weissinger's condition, twice), with the velocity that the blades' thickness induces there; this
replaces every lifting-surface correction. Forces are Kutta-Joukowski's at the lifting line with the induced velocities
in Wrench's closed form. The hub is an image vortex in its axis. Theory, what is neglected and the accuracy found:
docs/theory-lifting-line.md.

The flow is linear in the advance speed for a given wake pitch, and smooth in that pitch: one table over the pitch holds
the solution for every advance coefficient, and one scalar equation aligns the wake. The prepared table answers any
further J in well under a millisecond, exactly and not by interpolation in J, so that KT(J) is as smooth as the theory.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.radial_table import BladeSections
from hpsop_core.geometry.propeller.sections import (
    IDEAL_ANGLE_PER_CAMBER,
    IDEAL_LIFT_PER_CAMBER,
    MEAN_LINE_LOADING,
    ZERO_LIFT_ANGLE_PER_CAMBER,
)
from hpsop_core.hydro.lifting_line.horseshoes import HorseshoeGrid, induced_at_lifting_line, normal_influence
from hpsop_core.hydro.lifting_line.thickness import thickness_normal_velocity
from hpsop_core.hydro.open_water import OpenWater, reynolds_number_07R
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

SOLVER = "lifting line 1.2"
CAMBER_EFFECTIVENESS = 0.846
"""The one lift factor, fitted on the open-water test of P4119 alone (docs/theory-lifting-line.md)."""

_STAGE = "lifting_line"


def _two_vortex_slopes() -> tuple[float, float]:
    """Slopes at 3/8 and 7/8 of the chord, for f/c = 1, that give two bound vortices the lift and the moment of a = 0.8.

    In two dimensions at the ideal angle: the load is even to 0.8 c and falls to nothing at the trailing edge, so its
    centre is at 0.4519 c, which shares it between vortices at 1/8 and 5/8.
    """
    a = MEAN_LINE_LOADING
    centre = (0.5 * a**2 + 0.5 * (1.0 - a) * (a + (1.0 - a) / 3.0)) / (0.5 * (1.0 + a))
    rear = (centre - 0.125) / 0.5
    front = 1.0 - rear
    scale = 0.5 * IDEAL_LIFT_PER_CAMBER / (2.0 * np.pi)
    forward = IDEAL_ANGLE_PER_CAMBER - scale * (front / 0.25 - rear / 0.25)
    aft = IDEAL_ANGLE_PER_CAMBER - scale * (front / 0.75 + rear / 0.25)
    return float(forward), float(aft)


_CAMBER_SLOPES = {1: (ZERO_LIFT_ANGLE_PER_CAMBER,), 2: _two_vortex_slopes()}
"""Effective slopes of the mean line at the control points for f/c = 1, by the number of bound vortices."""

_ROTATION = 2.0 * np.pi
_TOLERANCE = 1.0e-12
_ITERATIONS = 40


@dataclass(frozen=True)
class LiftingLineSettings:
    """How the lifting line is solved.

    Attributes:
        strips: radial strips on a blade.
        chordwise: bound vortices on each strip, 1 or 2.
        camber_effectiveness: share of its camber that a blade with a boundary layer keeps; not used where the drag is
            inviscid.
        wake_nodes: Chebyshev nodes of the table over the logarithm of the wake pitch.
        lowest_wake_pitch, highest_wake_pitch: range of that table, over the geometric pitch at 0.7 R.
    """

    strips: int = 8
    chordwise: int = 2
    camber_effectiveness: float = CAMBER_EFFECTIVENESS
    wake_nodes: int = 6
    lowest_wake_pitch: float = 0.42
    highest_wake_pitch: float = 1.65


DEFAULT_SETTINGS = LiftingLineSettings()


@dataclass(frozen=True, eq=False)
class LiftingLineState:
    """The flow at the lifting line; arrays (nJ, M) over the strips unless said otherwise.

    Velocities are in n R, circulation in n R^2, forces for rho = n = R = 1.

    Attributes:
        advance_coefficient: J, (nJ,).
        radius_ratio: strips' radii r/R, (M,).
        circulation: of one blade.
        axial_velocity, tangential_velocity: induced, positive downstream and with the rotation.
        lift_coefficient: 2 circulation/(V* c).
        drag_coefficient: of the sections.
        lift_excess: 2 pi (alpha - alpha_ideal), what the off-design drag grows with.
        wake_pitch_ratio: pitch of the wake over the geometric pitch at 0.7 R, (nJ,).
        thrust_coefficient, torque_coefficient: KT and KQ, (nJ,).
    """

    advance_coefficient: Array
    radius_ratio: Array
    circulation: Array
    axial_velocity: Array
    tangential_velocity: Array
    lift_coefficient: Array
    drag_coefficient: Array
    lift_excess: Array
    wake_pitch_ratio: Array
    thrust_coefficient: Array
    torque_coefficient: Array


@dataclass(frozen=True, eq=False)
class PreparedLiftingLine:
    """A propeller's lifting line with its table over the wake pitch, made by ``prepare``.

    Attributes:
        propeller: the propeller.
        settings: the settings.
        grid: the horseshoes.
        wake_weight: weights of the strips in the wake's mean pitch, sum 1, (M,).
        table: Chebyshev coefficients over the logarithm of the wake pitch of circulation, axial and tangential
            velocity (axis 1), for inviscid and viscous camber (axis 3), for unit advance speed and for the rotation
            (axis 4): (nodes, 3, M, 2, 2).
    """

    propeller: Propeller
    settings: LiftingLineSettings
    grid: HorseshoeGrid
    wake_weight: Array
    table: Array

    @property
    def sections(self) -> BladeSections:
        """The sections of the strips."""
        return self.grid.sections

    @one_blas_thread()
    def solve(self, advance_coefficients: Array | Sequence[float] | float, drag: SectionDrag) -> OpenWater:
        """Open-water characteristics at the given J (a number or (nJ,)).

        Raises:
            InputError: a J is negative or not finite.
            SolverFailure: the wake does not align or the flow reverses; the reason names J.
        """
        state = self.state(advance_coefficients, drag)
        reynolds = None
        if drag.rotation_rate is not None and drag.viscosity is not None:
            reynolds = reynolds_number_07R(
                self.propeller, state.advance_coefficient, drag.rotation_rate, drag.viscosity
            )
        return OpenWater(
            advance_coefficient=state.advance_coefficient,
            thrust_coefficient=state.thrust_coefficient,
            torque_coefficient=state.torque_coefficient,
            reynolds_number_07R=reynolds,
            level=1,
            solver=SOLVER,
            settings=f"{self.settings}; {drag}",
        )

    @one_blas_thread()
    def state(self, advance_coefficients: Array | Sequence[float] | float, drag: SectionDrag) -> LiftingLineState:
        """As ``solve``, with the flow at every strip."""
        advance = np.atleast_1d(np.asarray(advance_coefficients, dtype=np.float64))
        if advance.ndim != 1 or not np.all(np.isfinite(advance)) or np.any(advance < 0.0):
            raise InputError(f"advance coefficients {advance_coefficients} must be finite numbers from 0 on")
        table = self.table[..., 1 if drag.viscous else 0, :]
        # the flow at each J is a polynomial in the wake pitch: (nJ, nodes, 3 M)
        speed = 2.0 * advance
        coefficients = (table[..., 0] * speed[:, None, None, None] + table[..., 1]).reshape(
            advance.size, self.settings.wake_nodes, -1
        )
        wake_pitch = self._aligned_wake_pitch(advance, coefficients)
        flow = self._evaluate(coefficients, wake_pitch)
        return self._forces(advance, wake_pitch, flow, drag)

    def _evaluate(self, coefficients: Array, wake_pitch: Array) -> Array:
        """Circulation and induced velocities (nJ, 3, M) at a wake pitch for each J."""
        low, high = np.log(self.settings.lowest_wake_pitch), np.log(self.settings.highest_wake_pitch)
        position = np.clip((2.0 * np.log(wake_pitch) - low - high) / (high - low), -1.0, 1.0)
        polynomials = np.cos(np.arange(self.settings.wake_nodes) * np.arccos(position)[:, None])
        flow = np.matmul(polynomials[:, None, :], coefficients)
        return np.asarray(flow).reshape(wake_pitch.size, 3, -1)

    def _inflow(self, advance: Array, flow: Array) -> tuple[Array, Array]:
        axial = 2.0 * advance[:, None] + flow[:, 1]
        tangential = _ROTATION * self.grid.radii - flow[:, 2]
        return axial, tangential

    def _wake_defect(self, advance: Array, coefficients: Array, wake_pitch: Array) -> Array:
        """Mean hydrodynamic pitch at the lifting line less the wake's pitch, over the reference pitch."""
        axial, tangential = self._inflow(advance, self._evaluate(coefficients, wake_pitch))
        # where the flow round the axis nearly stops, the pitch of one strip would swamp the mean
        tangential = np.maximum(tangential, 0.05 * _ROTATION * self.grid.radii)
        hydrodynamic = (axial / tangential * self.grid.radii) @ self.wake_weight
        return np.asarray(hydrodynamic / self.grid.reference_advance - wake_pitch)

    def _aligned_wake_pitch(self, advance: Array, coefficients: Array) -> Array:
        """Secant iteration for all J side by side, each kept inside the table.

        Raises:
            SolverFailure: no wake pitch inside the table aligns with the flow.
        """
        low, high = self.settings.lowest_wake_pitch, self.settings.highest_wake_pitch
        old = np.full(advance.shape, 0.9)
        old_defect = self._wake_defect(advance, coefficients, old)
        new = np.clip(old + 0.7 * old_defect, low, high)
        for _ in range(_ITERATIONS):
            defect = self._wake_defect(advance, coefficients, new)
            moving = np.abs(defect) > _TOLERANCE
            if not np.any(moving):
                return new
            step = new - old
            slope = np.where(step == 0.0, -1.0, (defect - old_defect) / np.where(step == 0.0, 1.0, step))
            slope = np.minimum(slope, -0.2)
            old, old_defect = np.where(moving, new, old), np.where(moving, defect, old_defect)
            new = np.where(moving, np.clip(new - defect / slope, low, high), new)
        worst = int(np.argmax(np.abs(self._wake_defect(advance, coefficients, new))))
        at_end = "longest" if new[worst] >= high - 1e-9 else "shortest" if new[worst] <= low + 1e-9 else "best"
        raise SolverFailure(
            _STAGE,
            f"at J = {advance[worst]:.4g} the wake does not align with the flow; the {at_end} wake tried has "
            f"{new[worst]:.3g} of the geometric pitch",
        )

    def _forces(self, advance: Array, wake_pitch: Array, flow: Array, drag: SectionDrag) -> LiftingLineState:
        sections, radii = self.grid.sections, self.grid.radii
        circulation = flow[:, 0]
        axial, tangential = self._inflow(advance, flow)
        reversed_flow = np.any((tangential <= 0.0) | (axial <= 0.0) & (advance[:, None] > 0.0), axis=1)
        reversed_flow |= ~np.all(np.isfinite(flow), axis=(1, 2))
        if np.any(reversed_flow):
            at = float(advance[int(np.argmax(reversed_flow))])
            raise SolverFailure(_STAGE, f"at J = {at:.4g} the flow at the lifting line reverses or is not finite")
        relative = np.hypot(axial, tangential)
        chord = 2.0 * sections.chord_ratio
        excess = (
            2.0
            * np.pi
            * (sections.pitch_angle - np.arctan2(axial, tangential) - IDEAL_ANGLE_PER_CAMBER * sections.camber_ratio)
        )
        undisturbed = np.sqrt(advance[:, None] ** 2 + (np.pi * radii) ** 2)
        ideal = drag.ideal_coefficient(
            self.propeller.diameter, sections.chord_ratio, sections.thickness_ratio, undisturbed
        )
        drag_coefficient = drag.coefficient(ideal, excess)
        resistance = 0.5 * relative * chord * drag_coefficient
        width = np.diff(self.grid.edges)
        blades = self.propeller.blade_count
        thrust = blades * ((circulation * tangential - resistance * axial) @ width)
        torque = blades * ((circulation * axial + resistance * tangential) @ (width * radii))
        return LiftingLineState(
            advance_coefficient=advance,
            radius_ratio=radii,
            circulation=circulation,
            axial_velocity=flow[:, 1],
            tangential_velocity=flow[:, 2],
            lift_coefficient=2.0 * circulation / (relative * chord),
            drag_coefficient=np.asarray(drag_coefficient),
            lift_excess=np.asarray(excess),
            wake_pitch_ratio=wake_pitch,
            thrust_coefficient=np.asarray(thrust / 16.0),
            torque_coefficient=np.asarray(torque / 32.0),
        )


@one_blas_thread()
def prepare(propeller: Propeller, settings: LiftingLineSettings = DEFAULT_SETTINGS) -> PreparedLiftingLine:
    """Build the table over the wake pitch, the costly part of a solution.

    Raises:
        InputError: the settings make no grid.
        SolverFailure: the horseshoes of this geometry have no solution.
    """
    if settings.strips < 4 or settings.wake_nodes < 4 or settings.chordwise not in _CAMBER_SLOPES:
        raise InputError("lifting line: at least 4 strips, at least 4 wake nodes and 1 or 2 bound vortices are needed")
    grid = HorseshoeGrid.make(propeller, settings.strips, settings.chordwise)
    nodes = settings.wake_nodes
    position = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
    # in the logarithm of the pitch, because the induced velocities go like its inverse
    low, high = np.log(settings.lowest_wake_pitch), np.log(settings.highest_wake_pitch)
    wake_advance = grid.reference_advance * np.exp(0.5 * (low + high) + 0.5 * (high - low) * position)

    onset = _onset(grid, propeller, settings)
    count = onset.shape[0]
    try:
        bound = np.linalg.solve(normal_influence(grid, wake_advance), np.broadcast_to(onset, (nodes, count, 4)))
    except np.linalg.LinAlgError as error:
        raise SolverFailure(_STAGE, f"the horseshoes of this blade have no solution ({error})") from error
    strips = settings.strips
    circulation = bound.reshape(nodes, strips, settings.chordwise, 4).sum(axis=2)
    axial, tangential = induced_at_lifting_line(grid, wake_advance)
    flow = np.stack([circulation, axial @ circulation, tangential @ circulation], axis=1)
    if not np.all(np.isfinite(flow)):
        raise SolverFailure(_STAGE, "the horseshoes of this blade give no finite flow")
    transform = np.cos(np.arange(nodes)[:, None] * np.arccos(position)) * (2.0 / nodes)
    transform[0] *= 0.5
    table = np.tensordot(transform, flow, axes=1).reshape(nodes, 3, strips, 2, 2)
    hub = propeller.hub_ratio
    # The load's usual shape, fixed: weights from the solved load would be singular near zero thrust.
    weight = np.diff(grid.edges) * grid.radii * np.sqrt((1.0 - grid.radii) * (grid.radii - hub))
    return PreparedLiftingLine(propeller, settings, grid, weight / np.sum(weight), table)


def _onset(grid: HorseshoeGrid, propeller: Propeller, settings: LiftingLineSettings) -> Array:
    """Minus the normal velocity of the flow without circulation, (M N, 4).

    The columns are (inviscid, viscous) x (unit advance speed, rotation).
    """
    sections = grid.sections
    effectiveness = np.array([1.0, settings.camber_effectiveness])
    slope = np.array(_CAMBER_SLOPES[settings.chordwise])
    # (M, N, 2): pitch angle of the camber line at the control points
    surface = sections.pitch_angle[:, None, None] - (
        effectiveness * slope[:, None] * sections.camber_ratio[:, None, None]
    )
    onset = np.stack([np.cos(surface), -_ROTATION * grid.radii[:, None, None] * np.sin(surface)], axis=-1)
    onset -= thickness_normal_velocity(propeller, grid.radii, grid.control_fraction)[:, :, None, :]
    return np.asarray(onset.reshape(-1, 4))


def solve(
    propeller: Propeller,
    advance_coefficients: Array | Sequence[float] | float,
    drag: SectionDrag,
    settings: LiftingLineSettings = DEFAULT_SETTINGS,
) -> OpenWater:
    """Open-water characteristics of a propeller by the lifting line.

    Args:
        propeller: its diameter matters for the drag's Reynolds number or roughness only.
        advance_coefficients: J, a number or (nJ,), from 0 on.
        drag: inviscid, model scale or full scale.
        settings: how it is solved.

    Raises:
        InputError: a J is negative or not finite.
        SolverFailure: no solution; the reason names J.
    """
    chord_07 = float(propeller.table.at_07R.chord_ratio)
    camber = settings.camber_effectiveness * drag.camber_gain(propeller.diameter, chord_07)
    return prepare(propeller, replace(settings, camber_effectiveness=camber)).solve(advance_coefficients, drag)
