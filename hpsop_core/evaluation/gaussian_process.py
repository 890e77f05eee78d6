"""Regression by Gaussian processes: smooth functions of a few variables, each prediction with its standard deviation.

Ordinary kriging with an anisotropic kernel and a nugget; several outputs share one kernel. Length scales and nugget are
the maximum of the likelihood concentrated over mean and variance (Rasmussen and Williams, Gaussian Processes for
Machine Learning, 2006, equations 2.23 to 2.26, 5.8 and 5.9; Jones, Schonlau and Welch, J. Global Optimization 13, 1998,
455). Written on scipy: two hundred points need no library for it, and importing one would cost each worker a second.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, solve_triangular
from scipy.linalg.lapack import dpotrf, dpotri
from scipy.optimize import minimize

from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, IntArray

# Length scales in units of the data's range, nugget in units of the variance.
_SCALES = (0.05, 50.0)
_NUGGETS = (1e-10, 1e-2)
_STARTS = ((0.6, 1e-6), (2.5, 1e-7))
_STEPS = 80
_GAIN = 1e-7  # of the likelihood in a step, as a part of itself, below which a kernel is found
_SQRT5 = math.sqrt(5.0)


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """A fitted regression; picklable.

    Attributes:
        lower, extent: (d,) of the inputs' box, which is scaled to one.
        points: (n, d) the inputs, scaled.
        scales: (d,) length scales in units of the box.
        nugget: over the variance.
        factor: (n, n) lower Cholesky factor of the correlations, nugget included.
        weights: (n, m) correlations' inverse times what is left of the outputs without their means.
        mean, variance: (m,) of each output.
        held_out: (n, m) error of the prediction of each point by all others, at these scales.
        held_out_deviation: (n, m) standard deviation of that prediction.
    """

    lower: Array
    extent: Array
    points: Array
    scales: Array
    nugget: float
    factor: Array
    weights: Array
    mean: Array
    variance: Array
    held_out: Array
    held_out_deviation: Array

    def mean_at(self, inputs: Array) -> Array:
        """Means alone, as ``predict`` gives them."""
        place = (np.asarray(inputs, dtype=np.float64) - self.lower) / self.extent
        mean: Array = self.mean + _correlation(place[None, :], self.points, self.scales)[0] @ self.weights
        return mean

    def predict(self, inputs: Array) -> tuple[Array, Array]:
        """Means and standard deviations at one input of shape (d,); each of shape (m,)."""
        place = (np.asarray(inputs, dtype=np.float64) - self.lower) / self.extent
        correlation = _correlation(place[None, :], self.points, self.scales)[0]
        spread = solve_triangular(self.factor, correlation, lower=True, check_finite=False)
        unknown = max(0.0, 1.0 - float(spread @ spread))
        return self.mean + correlation @ self.weights, np.sqrt(self.variance * unknown)


@one_blas_thread()
def fit(inputs: Array, outputs: Array) -> GaussianProcess | None:
    """Fit a regression.

    Args:
        inputs: (n, d); a column without spread has no effect.
        outputs: (n, m), smooth functions of the inputs.

    Returns:
        The regression; None where the data have none (fewer than four points more than inputs, or no likelihood).
    """
    data = _Data.of(inputs, outputs)
    if data is None:
        return None
    pairs = _Pairs.of(data.points)
    dimensions = data.points.shape[1]
    bounds = [tuple(np.log(_SCALES))] * dimensions + [tuple(np.log(_NUGGETS))]
    best: tuple[float, Array] | None = None
    for scale, nugget in _STARTS:
        start = np.log([scale] * dimensions + [nugget])
        found = minimize(
            _loss,
            start,
            (pairs, data.normal),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": _STEPS, "ftol": _GAIN},
        )
        if np.isfinite(found.fun) and (best is None or found.fun < best[0]):
            best = float(found.fun), found.x
    if best is None:
        return None
    return _regression(data, np.exp(best[1][:-1]), float(np.exp(best[1][-1])))


@one_blas_thread()
def refitted(inputs: Array, outputs: Array, scales: Array, nugget: float) -> GaussianProcess | None:
    """The regression that ``fit`` gave for the same data, with the kernel that it found; in a hundredth of its time.

    Args:
        inputs, outputs: as of ``fit``.
        scales, nugget: of its result.
    """
    data = _Data.of(inputs, outputs)
    return None if data is None else _regression(data, np.asarray(scales, dtype=np.float64), nugget)


@dataclass(frozen=True, eq=False)
class _Data:
    """What is regressed, scaled: inputs to their box, outputs to mean 0 and deviation 1."""

    lower: Array
    extent: Array
    points: Array
    centre: Array
    size: Array
    normal: Array

    @classmethod
    def of(cls, inputs: Array, outputs: Array) -> _Data | None:
        """None where there are fewer than four points more than inputs."""
        points, values = np.asarray(inputs, dtype=np.float64), np.asarray(outputs, dtype=np.float64)
        count, dimensions = points.shape
        if count < dimensions + 4:
            return None
        lower, extent = points.min(axis=0), np.ptp(points, axis=0)
        extent = np.where(extent > 1e-9 * np.maximum(1.0, np.abs(lower)), extent, np.inf)
        centre = values.mean(axis=0)
        size = np.std(values, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        return cls(lower, extent, (points - lower) / extent, centre, size, (values - centre) / size)


def _regression(data: _Data, scales: Array, nugget: float) -> GaussianProcess | None:
    count, size = len(data.points), data.size
    try:
        factor = cho_factor(_correlation(data.points, data.points, scales) + nugget * np.eye(count), lower=True)
    except LinAlgError:
        return None
    mean, weights, variance = _concentrated(factor, data.normal)
    inverse = cho_solve(factor, np.eye(count), check_finite=False)
    # Without a point the others' mean is another one too.
    sums = inverse.sum(axis=1)
    kept = (np.diag(inverse) - sums**2 / np.sum(sums))[:, None]
    return GaussianProcess(
        lower=data.lower,
        extent=data.extent,
        points=data.points,
        scales=scales,
        nugget=nugget,
        factor=np.tril(factor[0]),
        weights=weights * size,
        mean=data.centre + size * mean,
        variance=variance * size**2,
        held_out=weights / kept * size,
        held_out_deviation=np.sqrt(variance / kept) * size,
    )


def _correlation(first: Array, second: Array, scales: Array) -> Array:
    """Matern's correlation of smoothness 5/2 between (n, d) and (k, d) points, (n, k)."""
    distance = np.sqrt(np.sum(((first[:, None, :] - second[None, :, :]) / scales) ** 2, axis=2))
    return np.asarray((1.0 + _SQRT5 * distance + 5.0 / 3.0 * distance**2) * np.exp(-_SQRT5 * distance))


def _concentrated(factor: tuple[Array, bool], values: Array) -> tuple[Array, Array, Array]:
    """Best means (m,), weights (n, m) and variances (m,) of outputs with given correlations."""
    ones = np.ones(len(values))
    solved_ones, solved = cho_solve(factor, ones, check_finite=False), cho_solve(factor, values, check_finite=False)
    mean = (ones @ solved) / (ones @ solved_ones)
    weights = solved - solved_ones[:, None] * mean
    variance = np.sum((values - mean) * weights, axis=0) / len(values)
    return np.asarray(mean), np.asarray(weights), np.maximum(variance, 1e-300)


@dataclass(frozen=True, eq=False)
class _Pairs:
    """The pairs of points, each once: a matrix of correlations is symmetric, and its parts are summed over them.

    Attributes:
        rows, columns: (p,) the points of each pair, the later one first: places below the diagonal.
        squares: (p, d) of their distance in each input.
    """

    rows: IntArray
    columns: IntArray
    squares: Array

    @classmethod
    def of(cls, points: Array) -> _Pairs:
        rows, columns = np.tril_indices(len(points), -1)
        return cls(rows, columns, (points[rows] - points[columns]) ** 2)


def _loss(logarithms: Array, pairs: _Pairs, values: Array) -> tuple[float, Array]:
    """Minus the concentrated log likelihood of all outputs, and its gradient."""
    scales, nugget = np.exp(logarithms[:-1]), float(np.exp(logarithms[-1]))
    count, outputs = values.shape
    distance = _SQRT5 * np.sqrt(pairs.squares @ scales**-2)
    decay = np.exp(-distance)
    # Below the diagonal alone, as LAPACK reads and writes it.
    matrix = np.zeros((count, count), order="F")
    matrix[pairs.rows, pairs.columns] = (1.0 + distance + distance**2 / 3.0) * decay
    np.fill_diagonal(matrix, 1.0 + nugget)
    lower, failed = dpotrf(matrix, lower=True, overwrite_a=True)
    if failed:
        return 1e12, np.zeros_like(logarithms)
    _, weights, variance = _concentrated((lower, True), values)
    determinant = 2.0 * float(np.sum(np.log(np.diag(lower))))
    loss = 0.5 * count * float(np.sum(np.log(variance))) + 0.5 * outputs * determinant
    # d loss / d matrix; the change of a correlation with its distance is -5/3 r (1 + sqrt 5 r) exp(-sqrt 5 r) dr.
    inverse, _ = dpotri(lower, lower=True, overwrite_c=True)
    slope = outputs * inverse - (weights / variance) @ weights.T
    by_square = slope[pairs.rows, pairs.columns] * (5.0 / 3.0 * (1.0 + distance) * decay)
    gradient = (by_square @ pairs.squares) * scales**-2
    return loss, np.append(gradient, 0.5 * nugget * float(np.trace(slope)))
