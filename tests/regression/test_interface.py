"""The Python interface: every name is there, its results are frozen, and a command says what it says."""

from __future__ import annotations

import dataclasses
import inspect
import json
import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hpsop_core
from hpsop_core import hydrostatics, load_case, load_hull, load_propeller, open_water, resistance
from hpsop_core.assets import read_asset_text
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError

LENGTH, BREADTH, DRAFT = 100.0, 10.0, 6.25


@pytest.fixture(scope="module")
def wigley(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("table") / "wigley.csv"
    rows = ["station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, 1.0, 41):
        for z in np.linspace(0.0, 1.2, 13):
            half = 0.5 * BREADTH * (1.0 - (2.0 * x - 1.0) ** 2) * (1.0 - max(0.0, 1.0 - z) ** 2)
            rows.append(f"{LENGTH * x},{DRAFT * z},{half}")
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", [name for name in hpsop_core.__all__ if not name.startswith("__")])
def test_every_name_is_callable_and_says_what_it_takes_and_raises(name: str) -> None:
    thing = getattr(hpsop_core, name)
    assert callable(thing)
    told = inspect.getdoc(thing) or ""
    assert "Args:" in told and "Raises:" in told
    arguments = told[told.index("Args:") :]
    assert [word for word in inspect.signature(thing).parameters if not re.search(rf"\b{word}\b", arguments)] == []


def test_the_packages_answer_calls_whichever_comes_first() -> None:
    code = (
        "import sys; {first}; from hpsop_core import export, report; import hpsop_core.export.tables as t; "
        "assert callable(export) and callable(report) and t.__name__ == 'hpsop_core.export.tables'"
    )
    for first in ("pass", "import hpsop_core.export.design_files, hpsop_core.report.report"):
        subprocess.run([sys.executable, "-c", code.format(first=first)], check=True)


def test_nothing_heavy_is_loaded_before_it_is_asked_for() -> None:
    code = "import sys, hpsop_core; assert not {'numpy', 'scipy', 'numba', 'viser'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_hull_at_hand(wigley: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hull = load_hull(wigley, LENGTH, DRAFT)
    own = hydrostatics(hull)
    # Exact for Wigley's hull: 4/9 L B d; the table's 41 stations leave 1e-4.
    assert own.displaced_volume == pytest.approx(4.0 / 9.0 * LENGTH * BREADTH * DRAFT, rel=1e-3)
    answer = resistance(hull, (0.25, 0.3))
    for point in answer.points:
        # No form factor unless asked: friction and waves add up.
        assert point.total_resistance == pytest.approx(point.friction_resistance + point.wave_resistance, rel=1e-12)
    words = ["--offsets", str(wigley), "--length", "100", "--draft", "6.25", "--froude", "0.25,0.3", "--json"]
    assert main(["resistance", *words]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(answer.as_dict()))
    # Fresh water is lighter; the waves' part goes with the density alone.
    fresh = resistance(hull, (0.25, 0.3), density=999.1)
    for point, other in zip(answer.points, fresh.points, strict=True):
        assert other.wave_resistance / point.wave_resistance == pytest.approx(999.1 / 1025.0, rel=1e-12)


def test_a_case_and_its_hull_have_the_same_hydrostatics() -> None:
    case = load_case("dtc-p4119")
    design = case.initial.variables.replaced({"displacement_ratio": 0.98}, "test")
    ratio = hydrostatics(case, design).displaced_volume / hydrostatics(case).displaced_volume
    # The form solver's own tolerance.
    assert ratio == pytest.approx(0.98, rel=1e-6)


def test_a_propeller_at_hand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "blade.csv"
    table.write_text(read_asset_text("propellers", "p4119.csv"), encoding="utf-8")
    test = open_water(load_propeller(table, 3), (0.7, 0.833))
    for point in test.points:
        eta = point.advance_coefficient * point.thrust_coefficient / (2.0 * math.pi * point.torque_coefficient)
        assert point.open_water_efficiency == pytest.approx(eta, rel=1e-12)
    assert main(["open-water", "--geometry", str(table), "--blades", "3", "--advance", "0.7,0.833", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(test.as_dict()))
    assert open_water(load_propeller("p4119"), (0.7, 0.833)).points == test.points
    # Without viscosity size means nothing.
    large = open_water(load_propeller(table, 3, 9.0), (0.7,), inviscid=True)
    small = open_water(load_propeller(table, 3), (0.7,), inviscid=True)
    assert large.propeller.diameter == 9.0 and large.points == small.points


def test_results_are_frozen(wigley: Path) -> None:
    hull = load_hull(wigley, LENGTH, DRAFT)
    for value, field in (
        (resistance(hull, (0.3,)), "level"),
        (open_water(load_propeller("p4119"), (0.7,)), "level"),
        (hydrostatics(hull), "displaced_volume"),
        (hull, "draft"),
    ):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(value, field, 1)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (lambda hull: load_hull("nothing.csv", 100.0, 5.0), "nothing.csv"),
        (lambda hull: load_hull("ship.csv"), "length"),
        (lambda hull: load_hull("ship.stl", 100.0, 5.0), "unit"),
        (lambda hull: load_hull("ship.csv", 100.0, 5.0, "cubit"), "unit"),
        (lambda hull: load_hull("dtc", 355.0), "shipped"),
        (lambda hull: load_propeller("blade.csv"), "blades"),
        (lambda hull: load_propeller("blade.csv", 9), "2 to 7"),
        (lambda hull: load_propeller("p4119", diameter=-1.0), "diameter"),
        (lambda hull: resistance(hull, ()), "froude_numbers"),
        (lambda hull: resistance(hull, (3.0,)), "froude_numbers"),
        (lambda hull: resistance(hull, (float("nan"),)), "finite"),
        (lambda hull: resistance(hull, (0.3,), viscosity=1.0), "viscosity"),
        (lambda hull: open_water(load_propeller("p4119"), (5.0,)), "advance_coefficients"),
        (lambda hull: open_water(load_propeller("p4119"), (0.7,), rotation_rate=0.0), "rotation_rate"),
    ],
)
def test_bad_input_is_one_line_that_names_it(wigley: Path, wrong: Any, told: str) -> None:
    hull = load_hull(wigley, LENGTH, DRAFT)
    with pytest.raises(InputError, match=told) as problem:
        wrong(hull)
    assert "\n" not in str(problem.value)


def test_what_belongs_to_a_case_is_refused_with_a_hull(wigley: Path) -> None:
    hull = load_hull(wigley, LENGTH, DRAFT)
    variables = load_case("dtc-p4119").initial.variables
    for call in (
        lambda: resistance(hull, (0.3,), 1, variables),
        lambda: hydrostatics(hull, variables),
        lambda: open_water(load_propeller("p4119"), (0.7,), 1, variables),
        lambda: resistance(hull, (0.3,), 3),
        lambda: open_water(load_propeller("p4119"), (0.7,), 3),
    ):
        with pytest.raises(ValueError, match=r"level|variables"):
            call()
