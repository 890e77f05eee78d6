"""The upstream difference that turns U.grad(p) on the surface into U.grad(U.grad(p)).

Dawson (1977) used (10 f_i - 15 f_{i-1} + 6 f_{i-2} - f_{i-3})/(6 dx).  Here stands the five-point relative

    (3 f_{i+1} + 10 f_i - 18 f_{i-1} + 6 f_{i-2} - f_{i-3})/(12 dx),

with symbol i k dx (1 + O(k dx)^4) + (k dx)^6/24: fourth order, half of Dawson's damping, and without his second-order
dispersion (k dx)^2/6.  No purely upstream formula can do this: a causal one that never amplifies has a dispersion of at
least (k dx)^2/12.  The remaining damping is positive at every wave number, which keeps waves from running ahead of the
bow.  The last column, which has no neighbour downstream, takes Dawson's formula.  On the stretched grid both act in
index space and are divided by the same difference of x.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from hpsop_core.typing_aliases import Array

INNER = (3.0 / 12.0, 10.0 / 12.0, -18.0 / 12.0, 6.0 / 12.0, -1.0 / 12.0)
LAST = (0.0, 10.0 / 6.0, -15.0 / 6.0, 6.0 / 6.0, -1.0 / 6.0)


def difference_weights(x: Array) -> Array:
    """Weights (nx, ny, 5) of f at columns i + 1, i, i - 1, i - 2, i - 3 for df/dx along each row.

    Args:
        x: (nx, ny) collocation points, ascending along columns. Ahead of the first column f is zero, and x goes on
            with the first spacing.
    """
    columns = x.shape[0]
    spacing = x[1] - x[0]
    ahead = [x[0] - k * spacing for k in (3, 2, 1)]
    extended = np.concatenate([np.stack(ahead), x, x[-1:] + (x[-1:] - x[-2:-1])])
    weights = np.zeros((*x.shape, 5))
    for i in range(columns):
        stencil = LAST if i == columns - 1 else INNER
        metric = np.zeros(x.shape[1])
        for k in range(5):
            metric += stencil[k] * extended[i + 4 - k]
        for k in range(5):
            weights[i, :, k] = stencil[k] / metric
    for i in range(3):
        # f is zero ahead of the domain.
        weights[i, :, i + 2 :] = 0.0
    weights[-1, :, 0] = 0.0
    return weights


@njit(cache=True)
def convect(values: Array, weights: Array, speed: Array, reaction: Array, out: Array) -> None:
    """out = speed * D values + reaction * values for every column of ``values``, D the difference along the rows.

    Args:
        values: (nx ny, m) in the grid's order, row index fastest.
        weights: (nx, ny, 5) from ``difference_weights``.
        speed, reaction: (nx ny,).
        out: (nx ny, m), filled.
    """
    columns, rows = weights.shape[0], weights.shape[1]
    for i in range(columns):
        for j in range(rows):
            n = i * rows + j
            own = speed[n] * weights[i, j, 1] + reaction[n]
            first = speed[n] * weights[i, j, 2]
            second = speed[n] * weights[i, j, 3]
            third = speed[n] * weights[i, j, 4]
            down = speed[n] * weights[i, j, 0]
            n1 = max(n - rows, 0)
            n2 = max(n - 2 * rows, 0)
            n3 = max(n - 3 * rows, 0)
            nd = min(n + rows, columns * rows - 1)
            for k in range(values.shape[1]):
                out[n, k] = (
                    own * values[n, k]
                    + first * values[n1, k]
                    + second * values[n2, k]
                    + third * values[n3, k]
                    + down * values[nd, k]
                )
