"""Holtrop and Mennen's method against the worked example that its authors publish with it.

International Shipbuilding Progress 29 (1982), section 5: a ship of 205 m on the waterline at 25 knots. Speed is 25
international knots; the viscosity is that of sea water at 15 C, which the printed friction coefficient implies.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro import holtrop
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.operating_point import PropellerCurve, match
from hpsop_core.hydro.powering import ResistanceFactors, powers, resistance_parts
from hpsop_core.validation.powering import EXPANDED_AREA_RATIO, VISCOSITY, checks, published_numbers
from hpsop_core.validation.powering import PUBLISHED_SHIP as SHIP

SPEED = 25.0 * 1852.0 / 3600.0
DENSITY = 1025.0
DIAMETER = 8.0
FRICTION = ittc57_coefficient(SPEED * SHIP.length / VISCOSITY)
ALLOWANCE = holtrop.correlation_allowance(SHIP)
VISCOUS = holtrop.viscous_coefficient(holtrop.total_form_factor(SHIP), FRICTION, ALLOWANCE)
DYNAMIC = 0.5 * DENSITY * SPEED**2


@pytest.mark.parametrize(
    ("name", "value", "printed", "last_digit"),
    [
        # Each is held to one unit of the last printed digit: half of it is the rounding of the print itself, the rest
        # that of the authors' own intermediate results.
        ("Fn", SPEED / math.sqrt(9.81 * SHIP.length), 0.2868, 1e-4),
        ("C_P", SHIP.prismatic_coefficient, 0.5833, 1e-4),
        ("L_R", holtrop.run_length(SHIP), 81.385, 1e-3),
        ("1 + k1", 1.0 + holtrop.form_factor(SHIP), 1.156, 1e-3),
        ("C_F", FRICTION, 0.001390, 1e-6),
        ("c2", holtrop.bulb_factor(SHIP), 0.7595, 1e-4),
        ("C_A", ALLOWANCE, 0.000352, 1e-6),
        ("C_V", VISCOUS, 0.001963, 1e-6),
        ("C_P1", SHIP.stern_prismatic_coefficient, 0.5477, 1e-4),
        ("w", holtrop.wake_fraction(SHIP, VISCOUS, DIAMETER), 0.2584, 1e-4),
        ("t", holtrop.thrust_deduction(SHIP, DIAMETER), 0.1747, 1e-4),
        ("eta_R", holtrop.relative_rotative_efficiency(SHIP, EXPANDED_AREA_RATIO), 0.9931, 1e-4),
    ],
)
def test_printed_coefficients(name: str, value: float, printed: float, last_digit: float) -> None:
    assert value == pytest.approx(printed, abs=last_digit), name


@pytest.mark.parametrize(
    ("name", "value", "printed"),
    [
        # kN. The authors multiplied rounded coefficients: 0.05 % is what half a digit of 1.156 or .000352 may move.
        ("R_F", DYNAMIC * SHIP.wetted_surface * FRICTION / 1e3, 869.63),
        ("R_APP", DYNAMIC * SHIP.appendage_area * SHIP.appendage_form_factor * FRICTION / 1e3, 8.83),
        ("R_A", DYNAMIC * SHIP.total_wetted_surface * ALLOWANCE / 1e3, 221.98),
    ],
)
def test_printed_resistances(name: str, value: float, printed: float) -> None:
    # R_APP has three printed digits, the last one cut off: 8.836 kN, hence one unit of it beside.
    assert value == pytest.approx(printed, rel=5e-4, abs=1e-2 if printed < 10.0 else 0.0), name


def test_the_allowance_counts_on_hull_and_appendages() -> None:
    # Which surface the printed 221.98 kN means is not said: the hull's alone misses it by 0.6 %, c9 14.500 by 0.7 %.
    assert DYNAMIC * SHIP.wetted_surface * ALLOWANCE / 1e3 < 221.0
    c9 = SHIP.breadth * SHIP.total_wetted_surface / (SHIP.length * DIAMETER * SHIP.draft)
    assert c9 == pytest.approx(14.500, abs=1e-3)


def test_the_published_ship_is_inside_the_range() -> None:
    assert holtrop.outside(SHIP, 0.2868) == ()


@pytest.mark.parametrize(
    ("changes", "froude_number", "word"),
    [
        ({"breadth": 48.0, "displaced_volume": 56250.0}, 0.2, "B/T 4.80 (2.1 to 4)"),
        ({"displaced_volume": 56000.0}, 0.2, "C_P 0.87 (0.55 to 0.85)"),
        ({}, 0.47, "Fn 0.470 (up to 0.45)"),
    ],
)
def test_a_ship_outside_is_named_with_its_number(changes: dict[str, float], froude_number: float, word: str) -> None:
    assert word in holtrop.outside(dataclasses.replace(SHIP, **changes), froude_number)


def test_a_form_where_the_formulas_have_no_value_is_refused() -> None:
    with pytest.raises(SolverFailure, match=r"C_P 0\.963"):
        dataclasses.replace(SHIP, displaced_volume=61900.0)


@pytest.mark.parametrize(("draft", "c12"), [(3.0, 0.479948), (10.24, 0.05**0.2228446)])
def test_the_branches_of_c12_meet(draft: float, c12: float) -> None:
    """The three pieces of c12 join: at T/L .05 the authors' own power and parabola agree to 1e-3."""
    length = 205.0
    near = 48.20 * max(draft / length - 0.02, 0.0) ** 2.078 + 0.479948
    assert near == pytest.approx(c12, abs=1e-3)


@pytest.mark.parametrize("slope", [-0.35, -0.45, -0.55])
def test_stated_numbers_give_the_printed_shaft_power(slope: float) -> None:
    """With allowance, w, t and eta_R stated, resistance, thrust, rate, efficiency and shaft power are the printed ones.

    Of the authors' propeller one point is printed; a straight curve through it stands for the rest, and its slope may
    not matter, for the ship works there.
    """
    ship = published_numbers()
    dynamic = 0.5 * ship["density"] * ship["speed"] ** 2
    surface = SHIP.total_wetted_surface
    parts = resistance_parts(
        ResistanceFactors(
            form_factor=ship["form_factor"],
            correlation_allowance=1e3 * ship["correlation_resistance"] / (dynamic * surface),
            appendage_factor=ship["appendage_resistance"] / ship["friction_resistance"],
        ),
        speed=ship["speed"],
        density=ship["density"],
        wetted_surface=surface,
        friction=1e3 * ship["friction_resistance"],
        wave=1e3 * (ship["wave_resistance"] + ship["bulb_resistance"]),
    )
    assert parts.total == pytest.approx(1e3 * ship["total_resistance"], rel=1e-5)
    wake, deduction = ship["wake_fraction"], ship["thrust_deduction"]
    advance = (1.0 - wake) * ship["speed"] / (ship["rotation_rate"] * ship["diameter"])
    nodes = np.array([0.4, 0.7, 1.0])
    curve = PropellerCurve(
        nodes,
        ship["thrust_coefficient"] + slope * (nodes - advance),
        ship["torque_coefficient"] + 0.12 * slope * (nodes - advance),
    )
    point = match(
        curve, parts.total, wake, deduction, ship["density"], ship["speed"], ship["diameter"],
        ship["relative_rotative_efficiency"],
    )  # fmt: skip
    power = powers(
        total_resistance=parts.total,
        speed=ship["speed"],
        wake=wake,
        deduction=deduction,
        delivered_power=point.delivered_power,
        sea_margin=0.0,
        shaft_efficiency=ship["shaft_efficiency"],
    )
    # w and t are printed in four digits: half of the last one moves thrust, rate and power by less than 2e-4.
    assert power.effective == pytest.approx(1e3 * ship["effective_power"], rel=2e-4)
    assert point.thrust == pytest.approx(1e3 * ship["thrust"], rel=2e-4)
    assert point.rotation_rate == pytest.approx(ship["rotation_rate"], rel=2e-4)
    assert point.open_water_efficiency == pytest.approx(ship["open_water_efficiency"], rel=2e-4)
    assert power.brake == pytest.approx(1e3 * ship["shaft_power"], rel=2e-4)


def test_the_command_that_validates_shows_them() -> None:
    shown = list(checks())
    assert len(shown) == 5
    assert all(check.passed for check in shown)
