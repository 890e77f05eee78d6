"""The JSON that outsiders rely on: keys may be added, never changed."""

from __future__ import annotations

import json
from typing import Any

import pytest

from hpsop_core import evaluate, load_case
from hpsop_core.cli.main import build_parser, main
from hpsop_core.evaluation.result import evaluation_from_dict

KEYS = {
    "": {"case", "level", "status", "reason", "variables", "hull", "propeller", "conditions", "objectives",
         "constraints", "feasible", "warnings", "open_water", "elapsed", "active_bounds", "fuel_per_hour",
         "carbon_dioxide_per_hour", "errors"},
    "variables": {"length_to_breadth", "breadth_to_draft", "draft", "diameter", "blade_count", "pitch_ratio",
                  "displacement_ratio", "expanded_area_ratio", "buoyancy_centre_shift"},
    "hull": {"length", "breadth", "draft", "block_coefficient", "displaced_volume", "wetted_surface",
             "longitudinal_centre_of_buoyancy", "displacement_mass", "metacentre_height", "metacentric_height",
             "deadweight", "midship_coefficient", "prismatic_coefficient", "waterplane_coefficient"},
    "propeller": {"diameter", "blade_count", "pitch_ratio", "pitch_diameter_ratio_07R", "expanded_area_ratio"},
    "objectives": {"f1", "f2"},
    "constraints": {"displacement", "diameter_to_draft", "cavitation", "form", "propeller_clearance", "back_cavitation",
                    "tip_clearance", "length", "breadth", "metacentric_height", "engine"},
    "open_water": {"advance_coefficient", "thrust_coefficient", "torque_coefficient", "open_water_efficiency"},
}  # fmt: skip
CONDITION_KEYS = {
    "froude_number", "weight", "speed", "friction_resistance", "wave_resistance", "total_resistance",
    "wave_coefficient", "wake_fraction", "thrust_deduction", "advance_coefficient", "rotation_rate_rpm", "thrust",
    "torque", "thrust_coefficient", "torque_coefficient", "open_water_efficiency", "delivered_power",
    "required_expanded_area_ratio", "fuel_rate",
}  # fmt: skip


COMMANDS = (
    "evaluate dtc-p4119 --level 2 --set diameter=9.3 --json",
    "resistance dtc-p4119 --froude 0.22,0.27 --level 1 --form-factor 0.1 --water salt --json",
    "resistance --offsets FILE.csv --length 100 --draft 5 --froude 0.2 --json",
    "open-water dtc-p4119 --advance 0.5,0.7 --level 2 --inviscid --json",
    "open-water --geometry FILE.csv --blades 3 --advance 0.7 --diameter 0.3 --rotation-rate 10 --viscosity 1e-6",
    "optimize dtc-p4119 --run RUN.hpsop --generations 9 --level1-generations 6 --population 8 --seed 1 --workers 1",
    "show RUN.hpsop --front --generation 3 --json",
    "show RUN.hpsop --design compromise --json",
    "export RUN.hpsop --design initial --to FOLDER --formats stl,glb,3dm,dxf,csv,json --force",
    "report RUN.hpsop --to report.html --force",
    "reproduce --to FOLDER",
    "validate --json",
)


@pytest.mark.parametrize("words", COMMANDS)
def test_the_commands_take_what_the_contract_says(words: str) -> None:
    assert callable(build_parser().parse_args(words.split()).handler)


def output(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> Any:
    assert main(arguments) == 0
    return json.loads(capsys.readouterr().out)


def test_evaluate(capsys: pytest.CaptureFixture[str]) -> None:
    document = output(["evaluate", "dtc-p4119-paper", "--set", "diameter=9.2", "blade_count=4", "--json"], capsys)
    for part, keys in KEYS.items():
        assert keys <= set(document[part] if part else document), part
    assert len(document["conditions"]) == 2
    for condition in document["conditions"]:
        assert set(condition) >= CONDITION_KEYS
    assert document["variables"]["diameter"] == document["propeller"]["diameter"] == 9.2
    assert document["propeller"]["blade_count"] == 4
    assert document["constraints"]["cavitation"] is None  # the paper applies Keller at level 2 only
    assert {"booked_block_coefficient", "booked_volume"} <= set(document["hull"])
    assert evaluation_from_dict(document).as_dict() == document
    lengths = {len(values) for values in document["open_water"].values()}
    assert len(lengths) == 1
    assert lengths.pop() > 10


def test_efficiency_ends_with_the_thrust(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "dtc-p4119-paper", "--set", "blade_count=5", "pitch_ratio=0.95", "--json"]
    curve = output(words, capsys)["open_water"]
    thrust, efficiency = curve["thrust_coefficient"], curve["open_water_efficiency"]
    assert thrust[-1] < 0.0 < thrust[-5]
    # Past zero thrust, J KT/(2 pi KQ) is -0.2 and then 6.8.
    assert all((eta > 0.0) == (kt > 0.0) and 0.0 <= eta < 1.0 for kt, eta in zip(thrust, efficiency, strict=True))


def test_keys_of_a_later_version_are_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    document = output(["evaluate", "dtc-p4119-paper", "--json"], capsys)
    later = {**document, "seakeeping": {}, "hull": {**document["hull"], "metacentre": 1.0}}
    later["propeller"] = {**document["propeller"], "noise": 1.0}
    later["conditions"] = [{**condition, "added_resistance": 1.0} for condition in document["conditions"]]
    later["open_water"] = {**document["open_water"], "slip": [0.0]}
    assert evaluation_from_dict(later).as_dict() == document


def test_resistance(capsys: pytest.CaptureFixture[str]) -> None:
    document = output(["resistance", "dtc-p4119-paper", "--froude", "0.2,0.218", "--json"], capsys)
    assert {"length", "wetted_surface", "displaced_volume"} <= set(document["hull"])
    keys = {"froude_number", "speed", "wave_coefficient", "friction_coefficient", "total_resistance", "wave_resistance",
            "wave_coefficient_pressure"}  # fmt: skip
    assert [point["froude_number"] for point in document["points"]] == [0.2, 0.218]
    assert all(keys <= set(point) for point in document["points"])


def test_open_water(capsys: pytest.CaptureFixture[str]) -> None:
    document = output(["open-water", "dtc-p4119", "--advance", "0.7,0.833", "--json"], capsys)
    assert [set(point) for point in document["points"]] == [KEYS_OF_A_POINT] * 2
    for point in document["points"]:
        j, kt, kq = (point[key] for key in ("advance_coefficient", "thrust_coefficient", "torque_coefficient"))
        assert point["open_water_efficiency"] == pytest.approx(j * kt / (2 * 3.14159265358979 * kq), rel=1e-12)


KEYS_OF_A_POINT = {"advance_coefficient", "thrust_coefficient", "torque_coefficient", "open_water_efficiency"}


def test_python_interface_gives_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    document = output(["evaluate", "dtc-p4119-paper", "--json"], capsys)
    result = evaluate(load_case("dtc-p4119-paper")).as_dict()
    del document["elapsed"], result["elapsed"]
    assert document == json.loads(json.dumps(result))


def test_initial_design_normalises_itself() -> None:
    result = evaluate(load_case("dtc-p4119-paper"))
    assert result.objectives == pytest.approx({"f1": 1.0, "f2": 1.0}, abs=1e-12)
    assert result.all_objectives["delivered_power"] == pytest.approx(1.0, abs=1e-12)
    # The paper's operating points lie near J .65 and .56 with its own resistances; with T = Rt/(1 - t) and plain
    # Michell the propeller of the initial design works near J .42 at Fn .27; both conditions find one.
    assert result.conditions[1].advance_coefficient == pytest.approx(0.42, abs=0.03)
