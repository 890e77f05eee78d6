"""Holtrop and Mennen's formulas beside the worked example that their authors publish."""

from __future__ import annotations

import csv
from collections.abc import Iterator

from hpsop_core.assets import read_asset_text
from hpsop_core.hydro import holtrop
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.validation.check import HELD_OUT, Check, absolute_check, labelled

GROUP = "powering"
SOURCE = "worked example in International Shipbuilding Progress 29 (1982)"
VISCOSITY = 1.188e-6
"""Of sea water at 15 C, which the printed friction coefficient implies, in m2/s."""

# Printed with 2.02 % aft of Lpp/2 on Lpp 200 m, which is 0.75 % of L aft of L/2.
PUBLISHED_SHIP = holtrop.HoltropHull(
    length=205.0,
    breadth=32.0,
    draft=10.0,
    displaced_volume=37500.0,
    midship_coefficient=0.980,
    buoyancy_centre=-0.75,
    wetted_surface=7381.45,
    bulb_area=20.0,
    bulb_centre_height=4.0,
    stern_shape=10.0,
    appendage_area=50.0,
    appendage_form_factor=1.50,
)
EXPANDED_AREA_RATIO = 0.7393


def published_numbers() -> dict[str, float]:
    """The example's printed results by name, see assets/reference/holtrop_1982_example.csv."""
    lines = read_asset_text("reference", "holtrop_1982_example.csv").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return {row["quantity"]: float(row["value"]) for row in rows}


def checks() -> Iterator[Check]:
    """k, C_A, w, t and eta_R, each to one unit of its last printed digit."""
    yield from labelled(HELD_OUT, _worked_example())


def _worked_example() -> Iterator[Check]:
    ship, printed = PUBLISHED_SHIP, published_numbers()
    friction = ittc57_coefficient(printed["speed"] * ship.length / VISCOSITY)
    allowance = holtrop.correlation_allowance(ship)
    viscous = holtrop.viscous_coefficient(holtrop.total_form_factor(ship), friction, allowance)
    diameter = printed["diameter"]
    for quantity, name, computed, digit in (
        ("form factor k1", "form_factor", holtrop.form_factor(ship), 1e-3),
        ("correlation allowance C_A", "correlation_allowance", allowance, 1e-6),
        ("wake fraction w", "wake_fraction", holtrop.wake_fraction(ship, viscous, diameter), 1e-4),
        ("thrust deduction t", "thrust_deduction", holtrop.thrust_deduction(ship, diameter), 1e-4),
        (
            "relative rotative efficiency",
            "relative_rotative_efficiency",
            holtrop.relative_rotative_efficiency(ship, EXPANDED_AREA_RATIO),
            1e-4,
        ),
    ):
        yield absolute_check(GROUP, f"Holtrop and Mennen's {quantity}", computed, printed[name], SOURCE, digit)
