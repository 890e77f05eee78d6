"""The longitudinal shift in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.geometry.hull.form import FormSolver, LongitudinalShift, ShiftFrame

FRAME = ShiftFrame(18.0, 168.0, 348.0, 355.0)


@pytest.mark.parametrize(("forward", "aft"), [(0.0, 0.0), (20.0, -15.0), (-30.0, 40.0)])
def test_stretch_is_the_derivative_of_the_shift(forward: float, aft: float) -> None:
    shift = LongitudinalShift(FRAME, forward, aft)
    x = np.linspace(-5.0, 366.0, 100_001)
    moved, stretch = shift.evaluate(x)
    # Central differences of a C2 function: h^2 times its third derivative, about 1e-6 here.
    assert float(np.max(np.abs(np.gradient(moved, x) - stretch)[1:-1])) < 1e-4


def test_nothing_moves_outside_and_the_ends_are_smooth() -> None:
    shift = LongitudinalShift(FRAME, 30.0, -20.0)
    outside = np.array([-7.0, 9.2, 18.0, 348.0, 355.0, 366.0])
    moved, stretch = shift.evaluate(outside)
    assert np.array_equal(moved, outside)
    assert np.all(stretch == 1.0)
    near = np.array([18.0 + 1e-6, 168.0 - 1e-6, 168.0 + 1e-6, 348.0 - 1e-6])
    assert shift.evaluate(near)[1] == pytest.approx(np.ones(4), abs=1e-6)


@pytest.mark.parametrize(("forward", "aft"), [(60.0, 50.0), (-30.0, -25.0), (5.0, -3.0)])
def test_least_stretch_is_the_minimum(forward: float, aft: float) -> None:
    shift = LongitudinalShift(FRAME, forward, aft)
    _, stretch = shift.evaluate(np.linspace(18.0, 348.0, 200_001))
    assert shift.least_stretch() == pytest.approx(float(np.min(stretch)), abs=1e-9)


def test_solver_on_a_parabolic_body() -> None:
    # A(x) = 1 - ((x - m)/h)^2 over the whole length; volume and centre follow from a fine quadrature of the same map.
    x, weight = np.polynomial.legendre.leggauss(2000)
    x, weight = 183.0 + 183.0 * x, 183.0 * weight
    area = 1.0 - ((x - 183.0) / 183.0) ** 2
    solver = FormSolver(FRAME, x, area * weight)
    assert solver.volume == pytest.approx(183.0 * 4.0 / 3.0, rel=1e-12)
    found = solver.solve(1.04 * solver.volume, solver.centre + 2.0)
    assert not found.clipped
    moved, stretch = found.shift.evaluate(x)
    volume = float(np.sum(area * weight * stretch))
    assert volume == pytest.approx(1.04 * solver.volume, rel=1e-11)
    assert float(np.sum(area * weight * stretch * moved)) / volume == pytest.approx(solver.centre + 2.0, rel=1e-11)
