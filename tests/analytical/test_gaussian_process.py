"""The regression behind the learnt surface, on functions and formulas that are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve

from hpsop_core.evaluation.gaussian_process import GaussianProcess, _correlation, _loss, _Pairs, fit
from hpsop_core.typing_aliases import Array


def smooth(points: Array) -> Array:
    """Two smooth functions of two variables."""
    x, y = points[:, 0], points[:, 1]
    return np.stack([np.sin(3.0 * x) + y**2, np.exp(-x) * np.cos(2.0 * y)], axis=1)


@pytest.fixture(scope="module")
def process() -> GaussianProcess:
    points = np.random.default_rng(3).random((60, 2))
    fitted = fit(points, smooth(points))
    assert fitted is not None
    return fitted


def test_a_smooth_function_is_found_between_its_points(process: GaussianProcess) -> None:
    fresh = 0.05 + 0.9 * np.random.default_rng(4).random((50, 2))
    errors, deviations = [], []
    for point, value in zip(fresh, smooth(fresh), strict=True):
        mean, deviation = process.predict(point)
        errors.append(mean - value)
        deviations.append(deviation)
    # Sixty points on functions of half a wave: a thousandth of their range.
    assert np.max(np.abs(errors)) < 2e-3
    # Of a normal distribution three in a thousand lie beyond three deviations.
    assert np.mean(np.abs(errors) <= 3.0 * np.array(deviations)) >= 0.97


def test_far_from_its_points_it_knows_that_it_does_not_know(process: GaussianProcess) -> None:
    inside, outside = process.predict(np.array([0.5, 0.5]))[1], process.predict(np.array([2.5, -1.5]))[1]
    assert np.all(outside > 30.0 * inside)


def test_the_likelihoods_gradient() -> None:
    generator = np.random.default_rng(5)
    points, logarithms = generator.random((15, 3)), np.log([0.4, 0.8, 2.0, 1e-3])
    pairs = _Pairs.of(points)
    values = generator.normal(size=(15, 2))
    gradient = _loss(logarithms, pairs, values)[1]
    for place in range(4):
        step = np.zeros(4)
        step[place] = 1e-5
        higher, lower = (_loss(logarithms + sign * step, pairs, values)[0] for sign in (1.0, -1.0))
        assert gradient[place] == pytest.approx((higher - lower) / 2e-5, rel=1e-5, abs=1e-7)


def test_held_out_is_what_the_others_say(process: GaussianProcess) -> None:
    """Each point left out in turn, the equations of the others solved anew."""
    values = smooth(process.points * process.extent + process.lower)
    for left_out in (0, 17, 59):
        others = np.arange(60) != left_out
        points = process.points[others]
        factor = cho_factor(_correlation(points, points, process.scales) + process.nugget * np.eye(59))
        ones, rest = np.ones(59), values[others]
        mean = (ones @ cho_solve(factor, rest)) / (ones @ cho_solve(factor, ones))
        to_it = _correlation(process.points[left_out : left_out + 1], points, process.scales)[0]
        predicted = mean + to_it @ cho_solve(factor, rest - mean)
        missed = values[left_out] - predicted
        # Correlations of smooth functions are nearly singular: condition 1e10 leaves six digits.
        assert process.held_out[left_out] == pytest.approx(missed, rel=1e-3, abs=1e-8)


def test_a_constant_input_changes_nothing() -> None:
    points = np.random.default_rng(6).random((30, 2))
    with_constant = np.column_stack([points, np.full(30, 7.0)])
    plain, more = fit(points, smooth(points)), fit(with_constant, smooth(points))
    assert plain is not None and more is not None
    one, two = plain.predict(np.array([0.3, 0.6])), more.predict(np.array([0.3, 0.6, 7.0]))
    # The optimiser takes other steps with one more dimension.
    assert two[0] == pytest.approx(one[0], abs=1e-4)


def test_too_few_points_are_no_surface() -> None:
    points = np.random.default_rng(7).random((5, 2))
    assert fit(points, smooth(points)) is None
