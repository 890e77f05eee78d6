"""Numbers are written in the unit of their own size, and nothing that is computed changes with it."""

from __future__ import annotations

import dataclasses

import pytest

from explorer.services.answers import Answers
from explorer.state.shown import Shown
from explorer.views.headline import headline_card
from hpsop_core.case.case import Case
from hpsop_core.quantities import all_quantities, condition_names, quantities_of_case, quantity_of, size_of_case
from hpsop_core.units import SHIP_SIZE, axis_unit, size_of_ship, written
from tests.two_speeds import stated_case


@pytest.fixture(scope="module")
def model() -> Case:
    """A towing-tank model of six metres at 3.3 and 4.1 knots."""
    case = stated_case().replaced("initial", length=6.0, breadth=0.86, draft=0.25, diameter=0.15)
    return case.with_bounds({"draft": (0.2412, 0.25), "diameter": (0.1417, 0.1583)})


def test_a_ship_keeps_the_units_in_which_its_numbers_are_declared() -> None:
    case = stated_case()
    plain = {item.key: (item.unit, item.decimals) for item in all_quantities(condition_names(case))}
    sized = {item.key: (item.unit, item.decimals) for item in quantities_of_case(case)}
    assert sized == plain
    assert plain["delivered_power_1"] == ("MW", 2) and plain["total_resistance_1"] == ("kN", 0)


def test_a_model_reads_in_watts_and_newtons(model: Case) -> None:
    found = Answers().initial(model, 1)
    assert found.ok
    size, condition = size_of_case(model), found.conditions[-1]
    # a model of six metres takes some hundred newtons and watts
    assert 20.0 < condition.total_resistance < 400.0 and 20.0 < condition.delivered_power < 1000.0
    words = {item.key: item for item in quantities_of_case(model)}
    power, force = words["delivered_power_2"], words["total_resistance_2"]
    assert (power.unit, force.unit) == ("W", "N")
    assert power.value(found) == pytest.approx(condition.delivered_power)
    assert force.value(found) == pytest.approx(condition.total_resistance)
    assert float(power.text(found)) == pytest.approx(condition.delivered_power, rel=2e-3)
    assert quantity_of(found, "hull_draft", size) == "0.2500 m"
    assert quantity_of(found, "displacement_mass", size).endswith(" kg")
    # an error is told in the unit of its number: a tenth of the power
    known = dataclasses.replace(found, errors={"delivered_power_2": 0.1 * condition.delivered_power})
    assert power.half_width(known) == pytest.approx(0.1 * condition.delivered_power)
    card = headline_card(model, Shown("Initial design", found, kind="initial"), Shown("Design 7", known, 7))
    assert " W</td>" in card and "MW" not in card
    assert f"± {0.1 * condition.delivered_power:.0f}" in card


@pytest.mark.parametrize(
    ("speed", "unit", "decimals"), [(12.0, "MW", 2), (2.5, "kW", 1), (0.2, "W", 1)], ids=["fast", "slow", "drifting"]
)
def test_power_of_a_ship_follows_its_speed(speed: float, unit: str, decimals: int) -> None:
    # it grows with the cube of the speed: 66 MW at 12 m/s are 600 kW at 2.5 m/s and 310 W at 0.2 m/s
    found = size_of_ship(355.0, 51.0, 14.5, speed).unit("MW", 2)
    assert (found.symbol, found.decimals) == (unit, decimals)


def test_a_number_that_stands_alone_and_an_axis() -> None:
    assert written(65.2, "MW", 2) == "65.20 MW"
    assert written(0.0845, "MW", 2) == "84.50 kW"
    assert written(0.0, "MW", 2) == "0.00 MW"
    assert axis_unit("power", 6e7) == ("MW", 1e-6) and axis_unit("power", 80.0) == ("W", 1.0)
    assert axis_unit("force", 4e6) == ("MN", 1e-6) and axis_unit("force", 5e3) == ("kN", 1e-3)
    assert SHIP_SIZE.unit("m", 2).decimals == 2
