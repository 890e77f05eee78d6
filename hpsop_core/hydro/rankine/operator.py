"""The upstream difference that turns U.grad(p) on the surface into U.grad(U.grad(p)).

Dawson (1977) used (10 f_i - 15 f_{i-1} + 6 f_{i-2} - f_{i-3})/(6 dx).  Here stands the six-point, fifth-order
upwind-biased difference

    (-3 f_{i+2} + 30 f_{i+1} + 20 f_i - 60 f_{i-1} + 15 f_{i-2} - 2 f_{i-3})/(60 dx),

whose symbol, with kappa = k dx, is i kappa (1 + O(kappa^6)) + 2/15 (1 - cos kappa)^3.  Dawson's is
i kappa (1 + kappa^2/6 + ...) + 2/3 (1 - cos kappa)^3: his waves are too long and five times as damped.  A purely
upstream formula cannot do much better: one that never amplifies has a dispersion of at least kappa^2/12.  The damping
that remains is positive at every wave number, which is what keeps waves from running ahead of the bow.  The last two
columns, which lack neighbours downstream, take Dawson's formula.  On the stretched grid both act in index space and are
divided by the same difference of x.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hpsop_core.compiled import njit
from hpsop_core.typing_aliases import Array

# Columns i + 2 .. i - 3.
INNER = (-3.0 / 60.0, 30.0 / 60.0, 20.0 / 60.0, -60.0 / 60.0, 15.0 / 60.0, -2.0 / 60.0)
LAST = (0.0, 0.0, 10.0 / 6.0, -15.0 / 6.0, 6.0 / 6.0, -1.0 / 6.0)
DOWNSTREAM, UPSTREAM = 2, 3


def difference_weights(x: Array) -> Array:
    """Weights (nx, ny, 6) of f at columns i + 2, i + 1, i, i - 1, i - 2, i - 3 for df/dx along each row.

    Args:
        x: (nx, ny) collocation points, ascending along columns. Ahead of the first column f is zero, and x goes on
            with the first spacing.
    """
    columns = x.shape[0]
    first, last = x[1] - x[0], x[-1] - x[-2]
    extended = np.concatenate(
        [
            np.stack([x[0] - k * first for k in range(UPSTREAM, 0, -1)]),
            x,
            np.stack([x[-1] + k * last for k in range(1, DOWNSTREAM + 1)]),
        ]
    )
    weights = np.zeros((*x.shape, len(INNER)))
    for i in range(columns):
        stencil = LAST if i >= columns - DOWNSTREAM else INNER
        # x of column i + 2 - k
        metric = sum(stencil[k] * extended[i + UPSTREAM + DOWNSTREAM - k] for k in range(len(stencil)))
        for k in range(len(stencil)):
            column = i + DOWNSTREAM - k
            # f is zero ahead of the domain.
            if column >= 0:
                weights[i, :, k] = stencil[k] / metric
    return weights


@njit()
def convect(values: Array, weights: Array, speed: Array, reaction: Array, out: Array) -> None:
    """out = speed * D values + reaction * values for every column of ``values``, D the difference along the rows.

    Args:
        values: (nx ny, m) in the grid's order, row index fastest.
        weights: (nx, ny, 6) from ``difference_weights``.
        speed, reaction: (nx ny,).
        out: (nx ny, m), filled.
    """
    columns, rows, terms = weights.shape
    for i in range(columns):
        for j in range(rows):
            n = i * rows + j
            for k in range(values.shape[1]):
                out[n, k] = reaction[n] * values[n, k]
            for term in range(terms):
                weight = speed[n] * weights[i, j, term]
                if weight != 0.0:
                    other = n + (2 - term) * rows
                    for k in range(values.shape[1]):
                        out[n, k] += weight * values[other, k]


@njit()
def combine(convection: Array, vertical: Array, gravity: float, out: NDArray[np.float32]) -> None:
    """out = convection + gravity * vertical, (n, n), rounded to the precision of ``out`` in one pass."""
    for i in range(convection.shape[0]):
        for j in range(convection.shape[1]):
            out[i, j] = convection[i, j] + gravity * vertical[i, j]
