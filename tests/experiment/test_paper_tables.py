"""The paper's printed tables as shipped, and what they imply by themselves."""

from __future__ import annotations

import math

import pytest

from hpsop_core import load_case
from hpsop_core.reproduction import paper


def test_bounds_and_conditions_are_those_of_the_shipped_case() -> None:
    case = load_case("dtc-p4119-paper")
    assert paper.table1() == tuple(zip(case.conditions.froude_numbers, case.conditions.weights, strict=True))
    bounds = case.bounds.as_dict()
    assert len(paper.table2()) == 6
    for name, limits in paper.table2().items():
        assert tuple(float(value) for value in bounds[name]) == limits, name


def test_table3_as_printed() -> None:
    designs = {design.name: design for design in paper.table3()}
    assert list(designs) == ["IS", "OP1", "OP2", "OP3", "OP4", "OP5"]
    # Sums of the printed columns: a slip in a digit would show.
    assert math.fsum(d.length for d in designs.values()) == pytest.approx(2181.27)
    assert math.fsum(d.breadth for d in designs.values()) == pytest.approx(269.77)
    assert math.fsum(d.draft for d in designs.values()) == pytest.approx(85.10)
    assert math.fsum(d.block_coefficient for d in designs.values()) == pytest.approx(4.36)
    assert math.fsum(d.diameter for d in designs.values()) == pytest.approx(56.06)
    assert math.fsum(d.pitch_ratio for d in designs.values()) == pytest.approx(5.97)
    assert math.fsum(d.f1 for d in designs.values()) == pytest.approx(4.56)
    assert math.fsum(d.f2 for d in designs.values()) == pytest.approx(5.596)
    assert [d.blade_count for d in designs.values()] == [3, 4, 5, 5, 4, 5]


def test_printed_efficiency_follows_from_the_other_columns() -> None:
    for point in paper.table4():
        # Six printed digits in each factor.
        assert point.recomputed_efficiency == pytest.approx(point.open_water_efficiency, abs=5e-6)


def test_one_wake_fraction_a_hull_taylors() -> None:
    for name, wake in (("IS", 0.2611), ("OP3", 0.2989)):
        first, second = paper.points_of(name)
        # J has three printed digits.
        assert first.implied_wake == pytest.approx(second.implied_wake, abs=1e-5)
        assert first.implied_wake == pytest.approx(wake, abs=1e-4)
        assert first.fitted_wake == pytest.approx(first.implied_wake, rel=2e-3)
        assert abs(0.5 * first.design.block_coefficient - 0.05 - first.implied_wake) > 0.01


def test_thrust_is_less_than_resistance() -> None:
    ratios = [point.thrust(1025.0) / point.total_resistance for point in paper.table4()]
    assert ratios == pytest.approx([0.7333, 0.7321, 0.7714, 0.7616], abs=1e-4)
    assert all(point.implied_deduction(1025.0) < -0.29 for point in paper.table4())
    assert all(point.delivered_power(1025.0) < point.effective_power for point in paper.table4())
    assert paper.table4()[0].delivered_power(1025.0) == pytest.approx(66.4525e6, rel=1e-5)


def test_objectives_of_table4_and_table3() -> None:
    f1, f2 = paper.objectives_from_table4()
    printed = next(design for design in paper.table3() if design.name == "OP3")
    assert f1 == pytest.approx(0.6874, abs=1e-4) and abs(f1 - printed.f1) < 0.01
    assert f2 == pytest.approx(0.8763, abs=1e-4) and abs(f2 - printed.f2) > 0.04


def test_our_propeller_at_the_papers_advance_coefficients() -> None:
    """The initial propeller: P/D of the paper is a multiplier on P4119's pitch."""
    from hpsop_core.evaluation.propeller_answer import blade_drag, propeller_answer, propeller_variables

    case = load_case("dtc-p4119-paper")
    key = propeller_variables(case.propeller, case.initial.variables)
    for point in paper.points_of("IS"):
        for level in (1, 2):
            curve = propeller_answer(key, level, blade_drag(case.constants)).curve
            kt, kq = (float(value) for value in curve.coefficients(point.advance_coefficient))
            # The paper's solvers are others of the same kinds: 5 % in the coefficients, 2 % in their ratio.
            assert kt == pytest.approx(point.thrust_coefficient, rel=0.05)
            assert 10.0 * kq == pytest.approx(point.ten_torque_coefficient, rel=0.05)
            efficiency = point.advance_coefficient * kt / (2.0 * math.pi * kq)
            assert efficiency == pytest.approx(point.open_water_efficiency, rel=0.02)
