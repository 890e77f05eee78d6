"""The Rankine solver beside towing tanks."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from hpsop_core.assets import read_asset_text
from hpsop_core.geometry.analytic_bodies import wigley_panels
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.hydro.rankine.solver import RankineResult, RankineSettings, solve, solve_panels

FORM_FACTOR = 0.094


def tank() -> list[dict[str, float]]:
    """The six points of the Duisburg Test Case."""
    lines = [line for line in read_asset_text("reference", "dtc_resistance.csv").splitlines() if line[:1] != "#"]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


@pytest.fixture(scope="module")
def parent_result() -> RankineResult:
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    return solve(hull, [*(row["froude_number"] for row in tank()), 0.218, 0.27])


def test_total_resistance_at_the_six_tank_points(parent_result: RankineResult) -> None:
    # 6 % at every one of the six: with no waves at all .218 would be 8 % off, and must fail here.
    for row, condition in zip(tank(), parent_result.conditions, strict=False):
        total = (1.0 + FORM_FACTOR) * row["friction_coefficient"] + condition.wave_coefficient
        assert total == pytest.approx(row["total_coefficient"], rel=0.06)


def test_wave_coefficient_of_the_parent(parent_result: RankineResult) -> None:
    # The tank gives 3.36e-4 at .218 (with k = .094; dk = .01 is 9 %); above .218 there is no test, only the bracket of
    # what earlier versions of this solver gave.
    at_218, at_27 = parent_result.conditions[-2:]
    assert 2.5e-4 < at_218.wave_coefficient < 4.0e-4
    assert 5e-4 < at_27.wave_coefficient < 9e-4


def test_double_body_drag_of_the_parent(parent_result: RankineResult) -> None:
    # In units of the wave coefficient; it is zero for a perfect mesh.
    assert abs(parent_result.double_body_drag) < 1e-4


def test_wave_resistance_rises_with_speed(parent_result: RankineResult) -> None:
    # The tank: 1.9 to 3.4e-4 from .174 to .218, rising above .19.
    values = np.array([condition.wave_coefficient for condition in parent_result.conditions[:6]])
    assert np.all(np.diff(values) > 0.0)


def test_sinkage_of_the_parent(parent_result: RankineResult) -> None:
    # Ships of this kind squat by 0.1 to 0.2 % of their length at Fn .22, and trim by less than a tenth of a degree.
    condition = parent_result.conditions[-2]
    assert 0.0005 < condition.sinkage / 355.0 < 0.0025
    assert abs(np.degrees(condition.trim)) < 0.2


def test_wigley_hull_at_froude_number_313() -> None:
    # Experiments lie within 1.4 and 1.9e-3, mean 1.70e-3 (Chen and Noblesse 1983); both values at the default mesh.
    settings = RankineSettings()
    hull = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise)
    result = solve_panels(hull, [0.313], settings)
    assert result.unknowns <= 3500
    assert 1.4e-3 < result.conditions[0].wave_coefficient < 1.9e-3
    assert 1.4e-3 < result.conditions[0].wave_coefficient_pressure < 1.9e-3
