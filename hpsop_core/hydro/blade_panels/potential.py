"""Potential flow about a lifting body by constant-strength dipole and source panels (Morino's formulation).

At the collocation point of panel i, with unit outward normals n, onset flow U and perturbation potential phi,

    2 pi phi_i - sum_j D_ij phi_j - sum_m DW_im dphi_m = sum_j S_ij (U . n)_j

where D is the principal value and dphi_m the jump of the potential over wake strip m. The equation is linear in U and
dphi: one LU factorisation gives the answers to every unit onset flow and every unit jump, and any advance coefficient
is a superposition of them. The jumps follow from equal pressures on both sides of the trailing edge, by Newton.

Pressures are of steady flow in the rotating frame: p - p_inf = rho/2 (U^2 - v^2), v the total relative velocity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.blade_panels.grid import STAGE, StripSurface
from hpsop_core.hydro.blade_panels.hub_grid import HubGrid
from hpsop_core.hydro.singularities.dipole_panels import PanelSet, body_influence, strip_influence
from hpsop_core.typing_aliases import Array, BoolArray, IntArray

ROW_SUM_TOLERANCE = 0.1
_KUTTA_ITERATIONS = 30


@dataclass(frozen=True)
class BodyPotential:
    """Factorised body: blades (or a wing) and what else is attached (a hub).

    Attributes:
        surface: the lifting surface, whose panels come first.
        points: (n, 3) all collocation points.
        blade_count: rotational images.
        factors: LU factors of 2 pi I - D.
        onset: (n, 3, b) basis of onset velocities at the collocation points.
        onset_potential: (n, b) phi of each unit onset flow.
        row_sum_defect: (n,) |sum_j D_ij + 2 pi|.
    """

    surface: StripSurface
    points: Array
    blade_count: int
    factors: tuple[Array, Array]
    onset: Array
    onset_potential: Array
    row_sum_defect: Array

    def wake_potential(self, panels: PanelSet, strip: IntArray) -> Array:
        """(n, m): phi of a unit jump over each wake strip."""
        influence = strip_influence(self.points, panels, strip, self.surface.shape[1], self.blade_count)
        result: Array = lu_solve(self.factors, influence, check_finite=False)
        return result


def factorise(surface: StripSurface, blade_count: int, onset: Array, hub: HubGrid | None = None) -> BodyPotential:
    """Assemble and factorise the body's equations.

    Args:
        surface: the lifting surface, closed but for the edge that it shares with the hub.
        blade_count: number of rotational images, 1 for a wing.
        onset: (n, 3, b) basis of onset velocities at all collocation points (surface first).
        hub: one blade's sector of the hub.

    Raises:
        SolverFailure: the panels do not enclose the body (row sums), or the matrix is singular.
    """
    count, strips = surface.panels.count, surface.shape[1]
    points = surface.collocation.reshape(-1, 3)
    normals = surface.normal.reshape(-1, 3)
    panels = surface.panels
    if hub is not None:
        panels = _joined(panels, hub.panels)
        points = np.concatenate([points, hub.collocation])
        normals = np.concatenate([normals, hub.normal])
    index = np.arange(points.shape[0])
    dipole, source = body_influence(points, panels, blade_count, index)
    if not (np.all(np.isfinite(dipole)) and np.all(np.isfinite(source))):
        raise SolverFailure(STAGE, "an influence coefficient is not finite: a panel has collapsed")
    defect = np.abs(dipole.sum(axis=1) + 2.0 * np.pi)
    worst = int(np.argmax(defect))
    if defect[worst] > ROW_SUM_TOLERANCE:
        where = f"strip {worst % strips + 1} of {strips} of the blade" if worst < count else "the hub"
        raise SolverFailure(
            STAGE,
            f"row sums of the dipole matrix miss -2 pi by {defect[worst]:.2f} (at most {ROW_SUM_TOLERANCE}) on "
            f"{where}: the surface cuts itself or the next blade",
        )
    matrix = -dipole
    matrix[index, index] += 2.0 * np.pi
    factors = lu_factor(matrix, check_finite=False)
    right = source @ np.einsum("nab,na->nb", onset, normals)
    potential = lu_solve(factors, right, check_finite=False)
    if not np.all(np.isfinite(potential)):
        raise SolverFailure(STAGE, "the dipole matrix is singular")
    return BodyPotential(surface, points, blade_count, factors, onset, potential, defect)


def _joined(first: PanelSet, second: PanelSet) -> PanelSet:
    return PanelSet(
        np.concatenate([first.corners, second.corners]),
        np.concatenate([first.centre, second.centre]),
        np.concatenate([first.axes, second.axes]),
        np.concatenate([first.local, second.local]),
        np.concatenate([first.moments, second.moments]),
    )


@dataclass(frozen=True)
class SurfaceGradient:
    """Gradient along a grid of collocation points by second-order differences in the grid's own indices.

    Attributes:
        dual_i, dual_j: (n, m, 3) dual vectors: gradient = (d/di) dual_i + (d/dj) dual_j.
    """

    dual_i: Array
    dual_j: Array

    @classmethod
    def on(cls, collocation: Array) -> SurfaceGradient:
        """For collocation points (n, m, 3), n and m at least 2; along an index with two points it is of first order."""
        a, b = _index_derivative(collocation, 0), _index_derivative(collocation, 1)
        aa, ab, bb = (a * a).sum(-1), (a * b).sum(-1), (b * b).sum(-1)
        det = np.maximum(aa * bb - ab * ab, 1e-300)
        dual_i = (bb[..., None] * a - ab[..., None] * b) / det[..., None]
        dual_j = (aa[..., None] * b - ab[..., None] * a) / det[..., None]
        return cls(dual_i, dual_j)

    def of(self, potential: Array) -> Array:
        """Gradient (n, m, 3, k) of k potentials (n, m, k)."""
        along_i, along_j = _index_derivative(potential, 0), _index_derivative(potential, 1)
        return np.asarray(
            self.dual_i[..., None] * along_i[:, :, None, :] + self.dual_j[..., None] * along_j[:, :, None, :]
        )


def _index_derivative(values: Array, axis: int) -> Array:
    return np.asarray(np.gradient(values, axis=axis, edge_order=2 if values.shape[axis] > 2 else 1))


def tangential(vector: Array, normal: Array) -> Array:
    """The part of vectors (..., 3, k) along surfaces with unit normals (..., 3)."""
    along = np.einsum("...ak,...a->...k", vector, normal)
    return np.asarray(vector - normal[..., :, None] * along[..., None, :])


@dataclass(frozen=True)
class _TrailingStation:
    """Total velocity on one side, half way between two chordwise neighbours, for states that superpose.

    Attributes:
        free: (m, 3, b) onset flow; tangent: (m, 3, b) velocity of unit onset flows without wake.
        along, across: (m, 3) dual vectors of the index along the chord and across the span.
        step: (m, 3) from the one row to the other.
        rows: the two rows of collocation points.
    """

    free: Array
    tangent: Array
    along: Array
    across: Array
    step: Array
    rows: tuple[int, int]

    @classmethod
    def between(cls, surface: StripSurface, onset: Array, potential: Array, rows: tuple[int, int]) -> _TrailingStation:
        first, second = rows
        points = surface.collocation
        a = points[second] - points[first]
        b = np.gradient(0.5 * (points[second] + points[first]), axis=0, edge_order=2)
        aa, ab, bb = (a * a).sum(-1), (a * b).sum(-1), (b * b).sum(-1)
        det = np.maximum(aa * bb - ab * ab, 1e-300)[:, None]
        along = (bb[:, None] * a - ab[:, None] * b) / det
        across = (aa[:, None] * b - ab[:, None] * a) / det
        normal = np.cross(a, b)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        free = 0.5 * (onset[first] + onset[second])
        bare = cls(free, tangential(free, normal), along, across, a, rows)
        return cls(free, bare.tangent + bare.gradient(potential), along, across, a, rows)

    def weighting(self, cross_flow_share: Array) -> Array:
        """(m, 3, 3): v . W v is the squared speed, the part across the chord times its share."""
        size = np.linalg.norm(self.step, axis=1, keepdims=True)
        chord = self.step / np.maximum(size, 1e-300)
        share = cross_flow_share[:, None, None]
        return np.asarray(share * np.eye(3) + (1.0 - share) * chord[:, :, None] * chord[:, None, :])

    def gradient(self, potential: Array) -> Array:
        """(m, 3, k) surface gradient of potentials (n, m, k)."""
        first, second = potential[self.rows[0]], potential[self.rows[1]]
        across = np.gradient(0.5 * (first + second), axis=0, edge_order=2)
        return np.asarray(
            self.along[:, :, None] * (second - first)[:, None, :] + self.across[:, :, None] * across[:, None, :]
        )


@dataclass(frozen=True)
class KuttaProblem:
    """Equal pressure on both sides of the trailing edge.

    The pressure difference of the two sides is taken at half stations, between the first and second and between the
    second and third row of collocation points (there a central difference gives the velocity), and extrapolated to the
    edge linearly in the row index: 2 dp(1/2) - dp(3/2) = 0. On 24 x 10 panels the forces are then within 0.5 % of
    those on 80 x 24; equal pressures at the last collocation points would leave 3 to 5 %.

    Close to the tip the flow crosses round its edge from one side to the other, and beside the hub the edge of the
    wake crosses hub panels; no jump makes the pressures equal there. Towards the ends the part of the velocity across
    the chord is taken out of the pressures (`cross_flow_share` from 1, equal pressures, to 0, equal speeds along the
    chord), and the end strips take Morino's linear condition (the jump is the difference of the last potentials).

    Attributes:
        surface: the lifting surface.
        stations: ((lower, upper), (lower, upper)) from the trailing edge.
        onset_difference: (m, b) upper minus lower potential at the last collocation points.
        weighting: (4 m, 3, 3) W of every side and strip: v . W v is the squared speed, across the chord in part.
        linear: (m,) bool, strips that take Morino's condition.
    """

    surface: StripSurface
    stations: tuple[tuple[_TrailingStation, _TrailingStation], ...]
    onset_difference: Array
    weighting: Array
    linear: BoolArray

    @classmethod
    def of(cls, body: BodyPotential, cross_flow_share: Array, linear: BoolArray) -> KuttaProblem:
        rows, strips = body.surface.shape
        count = rows * strips
        onset = body.onset[:count].reshape(rows, strips, 3, -1)
        potential = body.onset_potential[:count].reshape(rows, strips, -1)
        stations = tuple(
            (
                _TrailingStation.between(body.surface, onset, potential, (k, k + 1)),
                _TrailingStation.between(body.surface, onset, potential, (rows - 1 - k, rows - 2 - k)),
            )
            for k in range(2)
        )
        weighting = np.concatenate([station.weighting(cross_flow_share) for pair in stations for station in pair])
        return cls(body.surface, stations, potential[-1] - potential[0], weighting, linear)

    def wake_terms(self, wake_potential: Array) -> Array:
        """What the condition needs of unit jumps: (5, m, 3, m), linear in the wake potentials (n, m).

        Velocities at the stations (lower, upper; first, second), then in place [4, :, 0] the difference of the
        potentials of the last collocation points.
        """
        rows, strips = self.surface.shape
        potential = wake_potential[: rows * strips].reshape(rows, strips, strips)
        terms = np.zeros((5, strips, 3, strips))
        for k, pair in enumerate(self.stations):
            for side, station in enumerate(pair):
                terms[2 * k + side] = station.gradient(potential)
        terms[4, :, 0] = potential[-1] - potential[0]
        return terms

    def _linear(self, weights: Array, terms: Array) -> tuple[Array, Array]:
        return np.eye(self.surface.shape[1]) - terms[4, :, 0], self.onset_difference @ weights

    def first_guess(self, weights: Array, terms: Array) -> Array:
        """(m,) jumps by Morino's linear condition on every strip."""
        matrix, right = self._linear(weights, terms)
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)

    def solve(self, weights: Array, terms: Array, start: Array, label: str) -> Array:
        """The jumps (m,), by Newton's method.

        Args:
            weights: (b,) of the onset basis.
            terms: from ``wake_terms``.
            start: (m,) first guess.
            label: names the condition in a failure.

        Raises:
            SolverFailure: Newton's method does not converge.
        """
        linear_matrix, linear_right = self._linear(weights, terms)
        sides = [station for pair in self.stations for station in pair]
        # One row a side and strip: sum over rows of factor v . W v, with v = base + term jump.
        factor = np.repeat([2.0, -2.0, -1.0, 1.0], self.linear.size)[:, None]
        base = np.concatenate([station.tangent @ weights for station in sides])
        free = [station.free @ weights for station in sides]
        share = self.weighting
        term = terms[:4].reshape(-1, 3, self.linear.size)
        onset = np.concatenate(free)
        speeds = np.sum(onset * (share @ onset[:, :, None])[:, :, 0], axis=1, keepdims=True)
        scale = float(np.max(speeds))
        head = np.sum((-factor * speeds).reshape(4, -1), axis=0)
        length = float(np.sqrt(scale))
        linear = self.linear

        def residual(jump: Array) -> tuple[Array, Array]:
            velocity = base + term @ jump
            weighted = factor * (share @ velocity[:, :, None])[:, :, 0]
            value = (head + np.sum(weighted * velocity, axis=1).reshape(4, -1).sum(axis=0)) / scale
            change = (weighted[:, None, :] @ term)[:, 0]
            jacobian = change.reshape(4, jump.size, jump.size).sum(axis=0) * (2.0 / scale)
            value[linear] = (linear_matrix[linear] @ jump - linear_right[linear]) / length
            jacobian[linear] = linear_matrix[linear] / length
            return value, jacobian

        jump = np.asarray(start, dtype=np.float64)
        value, jacobian = residual(jump)
        for _ in range(_KUTTA_ITERATIONS):
            size = float(np.abs(value).max())
            try:
                step = np.linalg.solve(jacobian, -value)
            except np.linalg.LinAlgError:
                break
            part = 1.0
            for _ in range(8):
                trial = residual(jump + part * step)
                if float(np.abs(trial[0]).max()) < size or size < 1e-10:
                    break
                part *= 0.5
            jump = jump + part * step
            value, jacobian = trial
            if float(np.abs(part * step).max()) <= 1e-11 * (1.0 + float(np.abs(jump).max())):
                break
        worst = float(np.abs(value).max())
        if not (np.all(np.isfinite(jump)) and worst < 1e-7):
            raise SolverFailure(
                STAGE,
                f"the pressure Kutta condition does not converge at {label} (pressure difference {worst:.1e} of the "
                "dynamic pressure)",
            )
        return jump
