"""Michell's integral: the Wigley hull's published values and the exact scaling laws."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.hydro.michell import wave_coefficients

LENGTH, BREADTH, DRAFT = 100.0, 10.0, 6.25
SURFACE = 0.14879 * LENGTH**2


def wigley(stations: int = 161, waterlines: int = 41) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    x, z = np.linspace(0.0, LENGTH, stations), np.linspace(0.0, DRAFT, waterlines)
    along, down = (x - LENGTH / 2) / (LENGTH / 2), (z - DRAFT) / DRAFT
    return x, z, BREADTH / 2 * (1 - along[:, None] ** 2) * (1 - down[None, :] ** 2)


@pytest.mark.parametrize(
    ("froude", "expected"), [(0.266, 0.944e-3), (0.313, 1.918e-3), (0.316, 1.832e-3), (0.408, 3.030e-3)]
)
def test_wigley(froude: float, expected: float) -> None:
    # Issue tolerance 0.5 %: the bilinear table of 161 x 41 costs 0.1 %, the tail of the integral 0.01 %.
    x, z, y = wigley()
    computed = wave_coefficients(x, z, y, LENGTH, SURFACE, [froude])[0]
    assert computed == pytest.approx(expected, rel=5e-3)


def test_table_converges_with_the_square_of_its_spacing() -> None:
    errors = []
    exact = wave_coefficients(*wigley(641, 161), LENGTH, SURFACE, [0.316])[0]
    for stations, waterlines in ((41, 11), (81, 21)):
        errors.append(abs(wave_coefficients(*wigley(stations, waterlines), LENGTH, SURFACE, [0.316])[0] / exact - 1))
    # Halving the spacing divides an error of second order by 4; 3 leaves room for the next order.
    assert errors[1] < errors[0] / 3


def test_scaling_laws_are_exact() -> None:
    x, z, y = wigley(41, 11)
    froude = [0.25, 0.316]
    base = wave_coefficients(x, z, y, LENGTH, SURFACE, froude)
    # Rounding only: Rw ~ B^2; geometric scale leaves Cw; going astern leaves Rw.
    np.testing.assert_allclose(wave_coefficients(x, z, 2 * y, LENGTH, SURFACE, froude), 4 * base, rtol=1e-12)
    np.testing.assert_allclose(
        wave_coefficients(0.1 * x, 0.1 * z, 0.1 * y, 0.1 * LENGTH, 0.01 * SURFACE, froude), base, rtol=1e-10
    )
    astern = wave_coefficients(LENGTH - x[::-1], z, y[::-1], LENGTH, SURFACE, froude)
    np.testing.assert_allclose(astern, base, rtol=1e-10)


def test_integral_over_the_wave_angle_has_converged() -> None:
    x, z, y = wigley(81, 21)
    short, full = (wave_coefficients(x, z, y, LENGTH, SURFACE, [0.22], limit)[0] for limit in (10.0, 20.0))
    # The tail beyond tan(theta) = 10 was measured at 0.01 % on this hull.
    assert short == pytest.approx(full, rel=3e-4)
