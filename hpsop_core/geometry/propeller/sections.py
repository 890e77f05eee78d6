"""Blade sections: NACA 66 (DTMB modified) thickness and the a = 0.8 mean line."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from hpsop_core.assets import read_asset_text
from hpsop_core.typing_aliases import Array

MEAN_LINE_LOADING = 0.8
"""Fraction of the chord over which the mean line carries constant load."""

IDEAL_LIFT_PER_CAMBER = 1.0 / 0.06794
"""Ideal lift coefficient of the a = 0.8 mean line for f/c = 1 (Abbott and von Doenhoff: f/c = 0.06794 CLi)."""

ZERO_LIFT_ANGLE_PER_CAMBER = -1.948
"""Zero-lift angle in radians for f/c = 1: alpha_i - CLi/(2 pi) with alpha_i = 1.540 degrees for CLi = 1."""

IDEAL_ANGLE_PER_CAMBER = float(np.radians(1.540)) / 0.06794
"""Ideal angle of attack in radians for f/c = 1."""

_LEADING_EDGE_RADIUS = 0.448
"""Leading-edge radius in t^2/c."""


@lru_cache(maxsize=1)
def _thickness_spline() -> CubicSpline:
    lines = [line for line in read_asset_text("propellers", "naca66mod.csv").splitlines() if line[:1] not in ("#", "")]
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    # Against sqrt(x) the round nose is a straight line whose slope the leading-edge radius gives.
    slope = float(np.sqrt(2.0 * _LEADING_EDGE_RADIUS))
    return CubicSpline(np.sqrt(table[:, 0]), table[:, 1], bc_type=((1, slope), "not-a-knot"))


def half_thickness(chord_fraction: Array, closed: bool = True) -> Array:
    """Half thickness over maximum thickness, y_t/t, at fractions of the chord from the leading edge (any shape).

    The tabulated trailing edge has half thickness 0.0333 t. ``closed`` takes y_t(1) x away, as panel codes do.
    """
    fraction = np.asarray(chord_fraction, dtype=np.float64)
    spline = _thickness_spline()
    value = np.asarray(spline(np.sqrt(np.clip(fraction, 0.0, 1.0))), dtype=np.float64)
    if closed:
        value = value - float(spline(1.0)) * fraction
    return value


def _x_log_x(x: Array) -> Array:
    return x * np.log(np.where(x > 0.0, x, 1.0))


def _square_log(x: Array) -> Array:
    size = np.abs(x)
    return x**2 * np.log(np.where(size > 0.0, size, 1.0))


def _mean_line_unscaled(x: Array) -> Array:
    a = MEAN_LINE_LOADING
    g = -(a**2 * (0.5 * np.log(a) - 0.25) + 0.25) / (1.0 - a)
    h = (0.5 * (1.0 - a) ** 2 * np.log(1.0 - a) - 0.25 * (1.0 - a) ** 2) / (1.0 - a) + g
    bracket = 0.5 * _square_log(a - x) - 0.5 * _square_log(1.0 - x) + 0.25 * (1.0 - x) ** 2 - 0.25 * (a - x) ** 2
    return np.asarray(bracket / (1.0 - a) - _x_log_x(x) + g - h * x) / (2.0 * np.pi * (a + 1.0))


@lru_cache(maxsize=1)
def _mean_line_maximum() -> float:
    x = np.linspace(0.45, 0.6, 1501)
    return float(np.max(_mean_line_unscaled(x)))


def mean_line(chord_fraction: Array) -> Array:
    """Ordinate of the a = 0.8 mean line over its maximum, y_c/f (any shape).

    Source: Abbott and von Doenhoff, Theory of Wing Sections, equation 4.26.
    """
    fraction = np.clip(np.asarray(chord_fraction, dtype=np.float64), 0.0, 1.0)
    return _mean_line_unscaled(fraction) / _mean_line_maximum()


def cosine_chord_fractions(count: int) -> Array:
    """``count`` chord fractions from 0 to 1, dense towards both edges (cosine spacing)."""
    return np.asarray(0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, count))))
