"""Identities of matching: required and available thrust, torque, power (closed forms F3 to F5)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.operating_point import PropellerCurve, chebyshev_nodes, match

RHO, SPEED, DIAMETER, WAKE, DEDUCTION = 1025.0, 12.9, 9.0, 0.26, 0.16
NODES = chebyshev_nodes(0.2, 1.1, 7)
CURVE = PropellerCurve(NODES, 0.45 - 0.3 * NODES - 0.08 * NODES**2, 0.07 - 0.04 * NODES)


def test_polynomial_through_the_nodes_is_the_curve() -> None:
    advance = np.linspace(0.2, 1.1, 31)
    thrust, torque = CURVE.coefficients(advance)
    # A polynomial of lower degree is reproduced to rounding.
    np.testing.assert_allclose(thrust, 0.45 - 0.3 * advance - 0.08 * advance**2, atol=1e-14)
    np.testing.assert_allclose(torque, 0.07 - 0.04 * advance, atol=1e-14)


def test_thrust_at_one_j_is_the_curves_to_the_bit() -> None:
    thrust, _ = CURVE.coefficients(np.linspace(0.2, 1.1, 101))
    assert [CURVE.thrust_at(advance) for advance in np.linspace(0.2, 1.1, 101).tolist()] == thrust.tolist()


@pytest.mark.parametrize("resistance", [0.8e6, 2.5e6, 6.0e6])
def test_identities_at_the_operating_point(resistance: float) -> None:
    point = match(CURVE, resistance, WAKE, DEDUCTION, RHO, SPEED, DIAMETER)
    j, n = point.advance_coefficient, point.rotation_rate
    # Every identity is exact; 1e-9 leaves room for rounding of a root found to 1e-12.
    assert point.open_water_efficiency == pytest.approx(
        j * point.thrust_coefficient / (2 * math.pi * point.torque_coefficient), rel=1e-12
    )
    required = resistance / ((1 - DEDUCTION) * (1 - WAKE) ** 2 * RHO * DIAMETER**2 * SPEED**2)
    assert point.thrust_coefficient / j**2 == pytest.approx(required, rel=1e-9)
    assert point.thrust == pytest.approx(resistance / (1 - DEDUCTION), rel=1e-9)
    assert j * n * DIAMETER == pytest.approx((1 - WAKE) * SPEED, rel=1e-12)
    assert point.delivered_power * point.open_water_efficiency * (1 - DEDUCTION) / (1 - WAKE) == pytest.approx(
        resistance * SPEED, rel=1e-9
    )


def test_relative_rotative_efficiency_divides_the_torque() -> None:
    plain, better = (match(CURVE, 2e6, WAKE, DEDUCTION, RHO, SPEED, DIAMETER, eta) for eta in (1.0, 1.05))
    assert better.advance_coefficient == plain.advance_coefficient
    assert better.delivered_power == pytest.approx(plain.delivered_power / 1.05, rel=1e-12)


def test_no_intersection_is_a_failure_with_numbers() -> None:
    with pytest.raises(SolverFailure, match="cannot give the thrust"):
        match(CURVE, 1e9, WAKE, DEDUCTION, RHO, SPEED, DIAMETER)
    with pytest.raises(SolverFailure, match="hardly any load"):
        match(CURVE, 1e3, WAKE, DEDUCTION, RHO, SPEED, DIAMETER)
    with pytest.raises(SolverFailure, match="not finite"):
        PropellerCurve(NODES, NODES * np.nan, NODES)
