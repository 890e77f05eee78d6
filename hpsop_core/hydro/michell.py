"""Michell's thin-ship wave resistance of a table of half-breadths.

With u = tan(theta), s = sqrt(1 + u^2) and k0 = g/U^2,

    Rw = 4 rho g^2/(pi U^2) int_0^inf |F(u)|^2 sqrt(1 + u^2) du,
    F = iint dY/dx exp(k0 s^2 z + i k0 s x) dx dz     (z <= 0 below the waterline).

F is the Kochin function of the hull; ``kochin_by_cell`` is the one place that computes it, for this integral and for
the free waves that carry the resistance away (hydro/kelvin.py).

Between its points the table is bilinear (tent functions) and both inner integrals are exact: in x, dY/dx is constant
over a cell, which gives a sinc; in z, the moments of exp over a cell. The integrand is even and analytic at u = 0 and
its phase is nearly linear in u, so the trapezoidal rule converges exponentially; only the tail matters.
Source: Michell, Phil. Mag. 45 (1898); the substitution and the element moments are ours.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

# The step keeps du k0 L at 3, where the trapezoid's error is 1e-8; the tail beyond 10 holds 0.01 % on a Wigley hull.
PHASE_STEP = 3.0
LARGEST_TANGENT = 10.0


@one_blas_thread()
def wave_coefficients(
    x: Array,
    z: Array,
    half_breadth: Array,
    length: float,
    wetted_surface: float,
    froude_numbers: Sequence[float],
    largest_tangent: float = LARGEST_TANGENT,
) -> Array:
    """Wave coefficients Rw/(1/2 rho U^2 S), shape (froude numbers,), by Michell's integral.

    Args:
        x: stations in m, ascending, shape (nx,).
        z: waterlines in m above the baseline, ascending; the last one is the water surface, shape (nz,).
        half_breadth: Y in m, shape (nx, nz).
        length: Lpp in m; Froude numbers are U/sqrt(g Lpp).
        wetted_surface: S in m2.
        froude_numbers: at which to compute.
        largest_tangent: where the integral over u = tan(theta) ends.

    Raises:
        SolverFailure: a Froude number that is not positive, or a result that is not finite.
    """
    if len(froude_numbers) == 0 or min(froude_numbers) <= 0.0:
        raise SolverFailure("michell", f"Froude numbers {list(froude_numbers)} must be positive")
    # Everything in units of Lpp: with g = 1/Fn^2 and U = 1, k0 = 1/Fn^2.
    stations, depths = x / length, (z - z[-1]) / length
    slopes = np.diff(half_breadth, axis=0) / length
    coefficients = np.array(
        [_wave_resistance(stations, depths, slopes, 1.0 / froude**2, largest_tangent) for froude in froude_numbers]
    )
    result: Array = coefficients * length**2 / wetted_surface
    if not np.all(np.isfinite(result)):
        raise SolverFailure("michell", "the wave integral is not finite; check the table of half-breadths")
    return result


def _wave_resistance(stations: Array, depths: Array, rises: Array, wave_number: float, largest_tangent: float) -> float:
    """Rw/(1/2 rho U^2 Lpp^2); ``rises`` are the differences of Y from station to station, shape (nx - 1, nz)."""
    step = PHASE_STEP / (wave_number * (stations[-1] - stations[0]))
    tangents = np.arange(0.0, largest_tangent + 0.5 * step, step)
    real, imaginary = amplitude(stations, depths, rises, wave_number, tangents)
    return spectrum_resistance(real**2 + imaginary**2, wave_number, tangents, step)


def spectrum_resistance(power: Array, wave_number: float, tangents: Array, step: float) -> float:
    """Rw/(1/2 rho U^2 Lpp^2) that free waves of a spectrum carry away, by the trapezoidal rule.

    Args:
        power: |F|^2 in units of Lpp, shape (tangents,).
        wave_number: k0 Lpp = 1/Fn^2.
        tangents: u from 0 in equal steps.
        step: of ``tangents``.
    """
    integrand = power * np.sqrt(1.0 + tangents**2)
    integral = step * (integrand.sum() - 0.5 * integrand[0])
    return float(8.0 * wave_number**2 / np.pi * integral)


def amplitude(stations: Array, depths: Array, rises: Array, wave_number: float, tangents: Array) -> tuple[Array, Array]:
    """Real and imaginary part of F(u) in units of Lpp, each of shape (tangents,).

    Args:
        stations: x/Lpp, shape (nx,).
        depths: z/Lpp <= 0, ascending to 0, shape (nz,).
        rises: Y(x_{i+1}) - Y(x_i) over Lpp, shape (nx - 1, nz).
        wave_number: k0 Lpp = 1/Fn^2.
        tangents: u.
    """
    real, imaginary = kochin_by_cell(stations, depths, rises, wave_number, tangents)
    return real.sum(axis=1), imaginary.sum(axis=1)


def kochin_by_cell(
    stations: Array, depths: Array, rises: Array, wave_number: float, tangents: Array
) -> tuple[Array, Array]:
    """Real and imaginary part of what each cell between two stations adds to F(u), each of shape (tangents, nx - 1).

    Arguments as for ``amplitude``; in units of Lpp.
    """
    secant = np.sqrt(1.0 + tangents**2)
    weights = _depth_weights(depths, wave_number * secant**2)  # (nu, nz)
    by_cell = weights @ rises.T  # (nu, nx - 1)
    middle = 0.5 * (stations[1:] + stations[:-1])
    half = 0.5 * np.diff(stations)
    phase = wave_number * secant[:, None]
    # (1/h) int exp(i k s x) dx over a cell = exp(i k s middle) sin(k s h/2)/(k s h/2)
    by_cell = by_cell * np.sinc(phase * half / np.pi)
    angle = phase * middle
    return by_cell * np.cos(angle), by_cell * np.sin(angle)


def _depth_weights(depths: Array, decay: Array) -> Array:
    """int hat_j(z) exp(decay z) dz for the tent functions on ``depths``; shape (decay, depths)."""
    thickness = np.diff(depths)
    q = decay[:, None] * thickness
    small = q < 1e-3
    safe = np.where(small, 1.0, q)
    # On a cell, measured downwards from its top: the share of the upper node is (q - 1 + e^-q)/q^2, of the lower one
    # (1 - (1 + q) e^-q)/q^2, each times the thickness and exp(decay z_top).
    fall = np.exp(-safe)
    upper = np.where(small, 0.5 - q / 6.0 + q**2 / 24.0, (safe - 1.0 + fall) / safe**2)
    lower = np.where(small, 0.5 - q / 3.0 + q**2 / 8.0, (1.0 - (1.0 + safe) * fall) / safe**2)
    top = np.exp(decay[:, None] * depths[1:]) * thickness
    weights = np.zeros((decay.size, depths.size))
    weights[:, 1:] += top * upper
    weights[:, :-1] += top * lower
    return weights
