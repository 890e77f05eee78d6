"""Waves at several Froude numbers from one factorisation, for solutions that are compared and not kept.

The equations of two speeds differ in g p_z alone, A(g) = C + g V. With A at a gravity g0 factorised, B = A(g0)^-1 V and
b = A(g0)^-1 f they are

    (1 + (g - g0) B) x(g) = b,

whose Krylov space of B and b is the same for every g: one sequence of vectors, each the cost of a back substitution,
answers all speeds (shifted systems: Frommer and Glaessner, SIAM Journal on Scientific Computing 19, 1998). Each x(g)
has the least residual in it, as in GMRES. Speeds far from g0 need more vectors, so only neighbours share a
factorisation, and one that has not converged gets its own.

All in single precision: strengths to about 1e-5 (tested), where ``surface_strengths`` gives 1e-8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, lu_factor, lu_solve

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.rankine.operator import combine
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, BoolArray, IntArray

Single = NDArray[np.float32]

# Of the largest 1/Fn^2 over the smallest among speeds that share a factorisation: 25 % of speed, where some 55 vectors
# converge. Each costs a sixtieth of a factorisation of 1,700 unknowns.
NEIGHBOURS = 1.6
MOST_VECTORS = 80
STEP = 10
# Of the preconditioned residual over its first value; rounding in single precision leaves about a tenth.
CONVERGED = 1e-5
# Of the true residual over the largest right-hand side; converged answers leave some 1e-6.
TRUSTED = 1e-4


@one_blas_thread()
def strengths_together(convection: Array, vertical: Array, forcing: Array, gravity: Sequence[float] | Array) -> Array:
    """Surface source strengths (n, k): x(g) of (C + g V) x = f at k Froude numbers, each 1/Fn^2 = g.

    Args:
        convection, vertical: (n, n) C and V.
        forcing: (n,) f.
        gravity: (k,) g.

    Raises:
        SolverFailure: singular, or the answers do not fulfil the equations.
    """
    asked = np.asarray(gravity, dtype=float)
    strengths = np.zeros((forcing.shape[0], len(asked)))
    single = vertical.astype(np.float32)
    groups = _neighbours(asked)
    while groups:
        group = groups.pop()
        solved, converged = _from_one_factorisation(convection, vertical, single, forcing, asked[group])
        strengths[:, group[converged]] = solved[:, converged]
        groups += [np.array([place]) for place in group[~converged]]
    residual = forcing[:, None] - convection @ strengths - asked * (vertical @ strengths)
    error = float(np.max(np.abs(residual))) / float(np.max(np.abs(forcing)))
    if not error <= TRUSTED:
        raise SolverFailure("rankine", f"the free-surface equations are too ill-conditioned (residual {error:.1e})")
    return strengths


def _neighbours(gravity: Array) -> list[IntArray]:
    """Places of the speeds that share a factorisation."""
    groups: list[list[int]] = []
    for place in np.argsort(gravity, kind="stable"):
        if groups and gravity[place] <= NEIGHBOURS * gravity[groups[-1][0]]:
            groups[-1].append(int(place))
        else:
            groups.append([int(place)])
    return [np.array(group) for group in groups]


def _from_one_factorisation(
    convection: Array, vertical: Array, single: Single, forcing: Array, gravity: Array
) -> tuple[Array, BoolArray]:
    """Strengths (n, k) from the factorisation amid some gravities, and which of them have converged.

    Args:
        convection, vertical, forcing, gravity: as ``strengths_together``.
        single: ``vertical`` in single precision.
    """
    centre = 0.5 * (float(np.min(gravity)) + float(np.max(gravity)))
    try:
        back = _inverse(convection, vertical, centre)
        first = back(forcing.astype(np.float32))
    except (LinAlgError, ValueError) as problem:
        raise SolverFailure("rankine", f"the free-surface equations cannot be solved ({problem})") from problem
    length = float(np.linalg.norm(first))
    if not 0.0 < length < np.inf:
        raise SolverFailure("rankine", "the free-surface equations cannot be solved (no finite answer)")
    if np.all(gravity == centre):
        return np.repeat(first[:, None].astype(np.float64), len(gravity), axis=1), np.ones(len(gravity), dtype=np.bool_)
    basis = np.zeros((MOST_VECTORS + 1, first.shape[0]), dtype=np.float32)
    basis[0] = first / np.float32(length)
    projected = np.zeros((MOST_VECTORS + 1, MOST_VECTORS))
    weights, converged = np.zeros((0, len(gravity))), np.zeros(len(gravity), dtype=np.bool_)
    for count in range(1, MOST_VECTORS + 1):
        _extend(basis, projected, count - 1, back(single @ basis[count - 1]))
        if count % STEP == 0:
            weights, converged = _least_residuals(projected[: count + 1, :count], length, gravity - centre)
            if np.all(converged):
                break
    return basis[: len(weights)].T.astype(np.float64) @ weights, converged


def _inverse(convection: Array, vertical: Array, gravity: float) -> Callable[[Single], Single]:
    """What applies the inverse of the equations at one gravity, factorised."""
    matrix = np.zeros(vertical.shape, dtype=np.float32)
    combine(convection, vertical, gravity, matrix)
    # LAPACK reads columns first: the rows that stand here are its columns, so it factorises the transpose in place.
    factor = lu_factor(matrix.T, overwrite_a=True, check_finite=False)
    return lambda right: lu_solve(factor, right, trans=1, check_finite=False)


def _extend(basis: Single, projected: Array, count: int, vector: Single) -> None:
    """The next vector of the space, made orthogonal to the ``count`` + 1 that stand; twice: once is not enough."""
    standing = basis[: count + 1]
    for _ in range(2):
        share: Single = standing @ vector
        vector = np.asarray(vector - share @ standing, dtype=np.float32)
        projected[: count + 1, count] += share
    length = float(np.linalg.norm(vector))
    projected[count + 1, count] = length
    if length > 0.0:
        basis[count + 1] = vector / np.float32(length)


def _least_residuals(projected: Array, length: float, shifts: Array) -> tuple[Array, BoolArray]:
    """For each shift the vectors' weights (count, shifts) of the least residual, and whether that is small enough."""
    rows, columns = projected.shape
    weights, converged = np.zeros((columns, len(shifts))), np.zeros(len(shifts), dtype=np.bool_)
    for place, shift in enumerate(shifts):
        matrix = np.eye(rows, columns) + shift * projected
        orthogonal, triangle = np.linalg.qr(matrix)
        weights[:, place] = np.linalg.solve(triangle, length * orthogonal[0])
        residual = -(matrix @ weights[:, place])
        residual[0] += length
        converged[place] = np.linalg.norm(residual) <= CONVERGED * length
    return weights, converged
