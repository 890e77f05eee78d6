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
from hpsop_core.hydro.blade_grid import STAGE, StripSurface
from hpsop_core.hydro.influence_blade import PanelSet, body_influence, strip_influence
from hpsop_core.typing_aliases import Array

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

    def wake_potential(self, panels: PanelSet, strip: Array) -> Array:
        """(n, m): phi of a unit jump over each wake strip."""
        influence = strip_influence(self.points, panels, strip, self.surface.shape[1], self.blade_count)
        result: Array = lu_solve(self.factors, influence, check_finite=False)
        return result


def factorise(
    surface: StripSurface,
    blade_count: int,
    onset: Array,
    attached: tuple[PanelSet, Array, Array] | None = None,
    attached_free: Array | None = None,
) -> BodyPotential:
    """Assemble and factorise the body's equations.

    Args:
        surface: the lifting surface.
        blade_count: number of rotational images, 1 for a wing.
        onset: (n, 3, b) basis of onset velocities at all collocation points (surface first).
        attached: panels, collocation points and normals of what is attached.
        attached_free: (m,) bool, which strips of the surface are away from what is attached: their row sums are
            checked tightly. None checks every strip.

    Raises:
        SolverFailure: the panels do not enclose the body (row sums), or the matrix is singular.
    """
    count = surface.panels.count
    points = surface.collocation.reshape(-1, 3)
    normals = surface.normal.reshape(-1, 3)
    panels = surface.panels
    if attached is not None:
        panels = _joined(panels, attached[0])
        points = np.concatenate([points, attached[1]])
        normals = np.concatenate([normals, attached[2]])
    own = np.arange(points.shape[0])
    dipole, source = body_influence(points, panels, blade_count, own)
    if not (np.all(np.isfinite(dipole)) and np.all(np.isfinite(source))):
        raise SolverFailure(STAGE, "an influence coefficient is not finite: a panel has collapsed")
    defect = np.abs(dipole.sum(axis=1) + 2.0 * np.pi)
    strips = surface.shape[1]
    free = np.ones(strips, dtype=bool) if attached_free is None else attached_free
    on_surface = defect[:count].reshape(-1, strips)
    worst = float(np.max(on_surface[:, free], initial=0.0))
    if worst > ROW_SUM_TOLERANCE:
        strip = int(np.argmax(np.where(free, on_surface.max(axis=0), -1.0)))
        raise SolverFailure(
            STAGE,
            f"row sums of the dipole matrix miss -2 pi by {worst:.2f} (at most {ROW_SUM_TOLERANCE}) on strip "
            f"{strip + 1} of {strips}: the blade's surface cuts itself or the next blade",
        )
    matrix = -dipole
    matrix[own, own] += 2.0 * np.pi
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
        """For collocation points (n, m, 3), n and m at least 3."""
        a = np.gradient(collocation, axis=0, edge_order=2)
        b = np.gradient(collocation, axis=1, edge_order=2)
        aa, ab, bb = (a * a).sum(-1), (a * b).sum(-1), (b * b).sum(-1)
        det = np.maximum(aa * bb - ab * ab, 1e-300)
        dual_i = (bb[..., None] * a - ab[..., None] * b) / det[..., None]
        dual_j = (aa[..., None] * b - ab[..., None] * a) / det[..., None]
        return cls(dual_i, dual_j)

    def of(self, potential: Array) -> Array:
        """Gradient (n, m, 3, k) of k potentials (n, m, k)."""
        along_i = np.gradient(potential, axis=0, edge_order=2)
        along_j = np.gradient(potential, axis=1, edge_order=2)
        return self.dual_i[..., None] * along_i[:, :, None, :] + self.dual_j[..., None] * along_j[:, :, None, :]

    def at_trailing_edge(self, potential: Array) -> tuple[Array, Array]:
        """Gradients (m, 3, k) at the first and the last row, of k potentials (n, m, k)."""
        first = -1.5 * potential[0] + 2.0 * potential[1] - 0.5 * potential[2]
        last = 1.5 * potential[-1] - 2.0 * potential[-2] + 0.5 * potential[-3]
        across_first = np.gradient(potential[0], axis=0, edge_order=2)
        across_last = np.gradient(potential[-1], axis=0, edge_order=2)
        lower = self.dual_i[0][:, :, None] * first[:, None, :] + self.dual_j[0][:, :, None] * across_first[:, None, :]
        upper = self.dual_i[-1][:, :, None] * last[:, None, :] + self.dual_j[-1][:, :, None] * across_last[:, None, :]
        return lower, upper


def tangential(vector: Array, normal: Array) -> Array:
    """The part of vectors (..., 3, k) along surfaces with unit normals (..., 3)."""
    along = np.einsum("...ak,...a->...k", vector, normal)
    return vector - normal[..., :, None] * along[..., None, :]


@dataclass(frozen=True)
class KuttaProblem:
    """Equal pressure on both sides of the trailing edge, for states that superpose.

    Velocities at the last collocation points of strip j, lower and upper side, are onset part times the weights of the
    onset basis plus jump part times dphi.

    Attributes:
        onset_lower, onset_upper: (m, 3, b) total tangential velocity of unit onset flows, wake without jump.
        free_lower, free_upper: (m, 3, b) the onset flow itself.
        gradient: of the lifting surface.
        surface: the lifting surface.
    """

    onset_lower: Array
    onset_upper: Array
    free_lower: Array
    free_upper: Array
    gradient: SurfaceGradient
    surface: StripSurface

    @classmethod
    def of(cls, body: BodyPotential, gradient: SurfaceGradient) -> KuttaProblem:
        rows, strips = body.surface.shape
        count = rows * strips
        basis = body.onset.shape[2]
        onset = body.onset[:count].reshape(rows, strips, 3, basis)
        lower, upper = gradient.at_trailing_edge(body.onset_potential[:count].reshape(rows, strips, basis))
        normal = body.surface.normal
        return cls(
            tangential(onset[0], normal[0]) + lower,
            tangential(onset[-1], normal[-1]) + upper,
            onset[0],
            onset[-1],
            gradient,
            body.surface,
        )

    def jump_velocities(self, wake_potential: Array) -> tuple[Array, Array]:
        """(m, 3, m) velocities at the trailing edge, lower and upper, of unit jumps."""
        rows, strips = self.surface.shape
        return self.gradient.at_trailing_edge(wake_potential[: rows * strips].reshape(rows, strips, -1))

    def solve(
        self, weights: Array, jump_lower: Array, jump_upper: Array, start: Array, label: str
    ) -> Array:
        """The jumps (m,) that make the pressures equal.

        Args:
            weights: (b,) of the onset basis.
            jump_lower, jump_upper: from ``jump_velocities``.
            start: (m,) first guess.
            label: names the condition in a failure.

        Raises:
            SolverFailure: Newton's method does not converge.
        """
        base_lower, base_upper = self.onset_lower @ weights, self.onset_upper @ weights
        head = np.sum((self.free_upper @ weights) ** 2, axis=1) - np.sum((self.free_lower @ weights) ** 2, axis=1)
        scale = float(np.max(np.sum((self.free_upper @ weights) ** 2, axis=1)))
        jump = start.copy()

        def residual(jump: Array) -> tuple[Array, Array, Array]:
            lower, upper = base_lower + jump_lower @ jump, base_upper + jump_upper @ jump
            value = head - np.sum(upper**2, axis=1) + np.sum(lower**2, axis=1)
            return value / scale, lower, upper

        value, lower, upper = residual(jump)
        for _ in range(_KUTTA_ITERATIONS):
            jacobian = 2.0 * (
                np.einsum("ma,mak->mk", lower, jump_lower) - np.einsum("ma,mak->mk", upper, jump_upper)
            ) / scale
            try:
                step = np.linalg.solve(jacobian, -value)
            except np.linalg.LinAlgError:
                break
            length, norm = 1.0, float(np.abs(value).max())
            for _ in range(8):
                trial = residual(jump + length * step)
                if np.abs(trial[0]).max() < norm or norm < 1e-11:
                    break
                length *= 0.5
            jump = jump + length * step
            value, lower, upper = trial
            if float(np.abs(length * step).max()) <= 1e-11 * (1.0 + float(np.abs(jump).max())):
                break
        if not np.all(np.isfinite(jump)) or float(np.abs(value).max()) > 1e-7:
            raise SolverFailure(
                STAGE,
                f"the pressure Kutta condition does not converge at {label} "
                f"(pressure difference {float(np.abs(value).max()):.1e} of the dynamic pressure)",
            )
        return jump

    def linear_start(self, weights: Array, onset_potential: Array, wake_potential: Array) -> Array:
        """Morino's condition: the jump is the difference of the potentials of the last panels (first guess)."""
        rows, strips = self.surface.shape
        last = slice((rows - 1) * strips, rows * strips)
        onset = (onset_potential[last] - onset_potential[:strips]) @ weights
        matrix = np.eye(strips) - (wake_potential[last] - wake_potential[:strips])
        result: Array = np.linalg.solve(matrix, onset)
        return result
