"""Closed forms: ITTC-57, Taylor's wake fit, Schoenherr's t, Keller's criterion."""

from __future__ import annotations

import pytest

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.cavitation import keller_expanded_area_ratio, pressure_margin
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.interaction import TAYLOR_FIT, thrust_deduction, wake_fraction


@pytest.mark.parametrize(
    ("reynolds", "expected"),
    [(1e6, 4.6875e-3), (1e7, 3.0e-3), (1e8, 2.083333333e-3), (1e9, 1.530612245e-3), (9.145e6, 3.04713e-3)],
)
def test_ittc57_line(reynolds: float, expected: float) -> None:
    # The line is a closed form; 1e-6 is the number of digits that the reference prints.
    assert ittc57_coefficient(reynolds) == pytest.approx(expected, rel=2e-6)


def test_friction_refuses_a_reynolds_number_without_meaning() -> None:
    with pytest.raises(SolverFailure, match="Reynolds number"):
        ittc57_coefficient(100.0)
    with pytest.raises(SolverFailure):
        ittc57_coefficient(float("nan"))


def test_wake_fraction_is_what_the_papers_table_4_implies() -> None:
    # Table 4's J, N, D and V imply w = .2611 at CB .661 and .2989 at CB .728; the rounded table limits it to 5e-4.
    assert wake_fraction(0.661) == pytest.approx(0.2611, abs=5e-4)
    assert wake_fraction(0.728) == pytest.approx(0.2989, abs=5e-4)


def test_wake_fraction_is_constant_below_the_parabolas_minimum() -> None:
    a, b, _ = TAYLOR_FIT
    minimum = -b / (2 * a)
    assert minimum == pytest.approx(0.532, abs=1e-3)
    assert wake_fraction(0.50) == wake_fraction(minimum) < wake_fraction(minimum + 0.01)


def test_linear_wake_and_schoenherr() -> None:
    assert wake_fraction(0.7, "linear") == pytest.approx(0.30, abs=1e-12)
    assert thrust_deduction(0.3, 0.6) == pytest.approx(0.18, abs=1e-12)


@pytest.mark.parametrize(
    ("blades", "thrust", "diameter", "immersion", "k", "margin", "expected"),
    [(5, 2.5e6, 8.911, 9.0, 0.2, 190118.25, 0.66368), (4, 1.0e6, 7.9, 6.8, 0.1, 167996.70, 0.33844)],
)
def test_keller(
    blades: int, thrust: float, diameter: float, immersion: float, k: float, margin: float, expected: float
) -> None:
    # Worked by hand with p0 = 101325, pv = 1704, g = 9.81; five printed digits.
    computed = pressure_margin(immersion, 1025.0, 9.81, 101325.0, 1704.0)
    assert computed == pytest.approx(margin, rel=1e-7)
    assert keller_expanded_area_ratio(blades, thrust, diameter, computed, k) == pytest.approx(expected, abs=1e-5)
