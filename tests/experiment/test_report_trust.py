"""What a report says about its own accuracy (the propeller's 4 % are tested by test_blade_panels_p4119)."""

from __future__ import annotations

import csv

import pytest

from hpsop_core import load_case
from hpsop_core.assets import read_asset_text
from hpsop_core.evaluation.hull_answer import solve_waves
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.report.words import trust
from tests.two_speeds import TWO_SPEEDS

FORM_FACTOR = 0.094


def test_the_resistance_is_as_near_to_the_tank_as_it_says() -> None:
    lines = [line for line in read_asset_text("reference", "dtc_resistance.csv").splitlines() if line[:1] != "#"]
    tests = list(csv.DictReader(lines))
    froude = [float(row["froude_number"]) for row in tests]
    case = load_case(TWO_SPEEDS)
    waves = solve_waves(design_hull(case, case.initial.variables), 2, froude)
    words = trust(case, 2)
    assert "within 2 %" in words and "0.174 to 0.218" in words
    assert min(froude) == pytest.approx(0.174, abs=1e-3) and max(froude) == pytest.approx(0.218, abs=1e-3)
    for row, answer in zip(tests, waves, strict=True):
        total = (1.0 + FORM_FACTOR) * ittc57_coefficient(float(row["reynolds_number"])) + answer.wave_coefficient
        assert total == pytest.approx(float(row["total_coefficient"]), rel=0.02)
    assert "3.8 against 3.4" in words
    assert 1e4 * waves[-1].wave_coefficient == pytest.approx(3.8, abs=0.05)
    assert 1e4 * float(tests[-1]["wave_coefficient"]) == pytest.approx(3.4, abs=0.05)
