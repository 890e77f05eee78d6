"""The command open-water at both levels, with shipped and own propellers, good and bad input."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from hpsop_core.assets import read_asset_text
from hpsop_core.cli.main import main
from tests.two_speeds import TWO_SPEEDS

HEAD = "r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c"


def blade(pitch: float = 1.0, thickness: float = 1.0) -> str:
    """A skewed and raked blade by eight rows."""
    rows = [
        (r, 0.20 + 0.35 * (r - 0.2) - (0.0 if r < 0.7 else 2.8 * (r - 0.7) ** 2), pitch * (1.0 - 0.1 * r))
        for r in (0.2, 0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
    ]
    lines = []
    for r, c, p in rows:
        outward = (r - 0.2) / 0.8
        lines.append(f"{r},{c:.4f},{p:.4f},{25 * outward**2:.3f},{0.04 * outward:.4f},{thickness * 0.05 / r:.4f},0.02")
    return "\n".join(["# a comment", HEAD, *lines])


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert main(["open-water", *arguments, "--json"]) == 0
    captured = capsys.readouterr()
    # The blade of these tests is .61 as broad at the tip as at 0.7 R, and that is all that is said of it.
    assert all("ducts are not computed" in line for line in captured.err.splitlines())
    result: dict[str, Any] = json.loads(captured.out)
    return result


@pytest.mark.parametrize("level", ["1", "2"])
def test_shipped_propeller_as_a_case_and_as_a_table(
    level: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "p4119.csv"
    table.write_text(read_asset_text("propellers", "p4119.csv"), encoding="utf-8")
    of_case = answer(capsys, TWO_SPEEDS, "--advance", "0.5,0.7", "--level", level)
    of_table = answer(capsys, "--geometry", str(table), "--blades", "3", "--advance", "0.5,0.7", "--level", level)
    # a shipped propeller's name is no file to be told of
    by_name = answer(capsys, "--geometry", "p4119", "--blades", "3", "--advance", "0.5,0.7", "--level", level)
    assert by_name["points"] == of_table["points"]
    for a, b in zip(of_case["points"], of_table["points"], strict=True):
        # the case scales the chords to an expanded area ratio of 0.607, the table has 0.6066
        assert a["thrust_coefficient"] == pytest.approx(b["thrust_coefficient"], rel=1e-3)
        assert a["open_water_efficiency"] == pytest.approx(
            a["advance_coefficient"] * a["thrust_coefficient"] / (2.0 * math.pi * a["torque_coefficient"])
        )
    # P4119's test: 0.3048 m, 10 1/s, 1e-6 m2/s; c/D .4622 at 0.7 R
    assert of_table["diameter"] == 0.3048
    assert of_table["reynolds_number_07R"][1] == pytest.approx(
        10.0 * 0.3048**2 / 1e-6 * 0.4622 * math.hypot(0.7, 0.7 * math.pi), rel=1e-3
    )
    assert of_table["solver"].startswith("lifting line" if level == "1" else "blade panels")


@pytest.mark.parametrize("level", ["1", "2"])
def test_own_propeller_with_and_without_viscosity(
    level: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "own.csv"
    table.write_text(blade(), encoding="utf-8")
    common = ("--geometry", str(table), "--blades", "5", "--advance", "0.3,0.6", "--level", level)
    viscous, inviscid = answer(capsys, *common), answer(capsys, *common, "--inviscid")
    small = answer(capsys, *common, "--diameter", "0.15", "--rotation-rate", "5")
    size = answer(capsys, *common, "--inviscid", "--diameter", "9")
    for i in range(2):
        eta = [r["points"][i]["open_water_efficiency"] for r in (small, viscous, inviscid)]
        assert eta[0] < eta[1] < eta[2] < 1.0
        # size means nothing without viscosity
        assert size["points"][i] == inviscid["points"][i]


@pytest.mark.parametrize("level", ["1", "2"])
@pytest.mark.parametrize("blades", ["2", "7"])
def test_fewest_and_most_blades_and_areas(level: str, blades: str, capsys: pytest.CaptureFixture[str]) -> None:
    thrust = []
    for area in ("0.3", "1.1"):
        result = answer(
            capsys, "dtc-p4119", "--advance", "0.1,0.7,1.3", "--level", level, "--set", f"blade_count={blades}",
            f"expanded_area_ratio={area}",
        )  # fmt: skip
        assert result["expanded_area_ratio"] == pytest.approx(float(area))
        curve = [p["thrust_coefficient"] for p in result["points"]]
        assert 0.6 > curve[0] > curve[1] > 0.1 > 0.0 > curve[2]
        thrust.append(curve[1])
    assert thrust[1] > thrust[0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--advance", "0.5,x"], ("--advance", "'x'", "number")),
        (["--advance", "nan"], ("--advance", "finite")),
        (["--advance", "2.5"], ("--advance", "limits")),
        (["--advance", "0.5", "--diameter", "0"], ("--diameter", "0.01")),
        (["--advance", "0.5", "--viscosity", "1"], ("--viscosity", "m2/s")),
        (["--advance", "0.5", "--rotation-rate", "inf"], ("--rotation-rate", "finite")),
        (["--advance", "0.5", "--blades", "3"], ("--blades", "--geometry")),
        (["--advance", "0.5", "--geometry", "x.csv", "--blades", "3"], ("CASE", "--geometry")),
    ],
)
def test_bad_arguments(arguments: list[str], words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["open-water", "dtc-p4119", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    for word in words:
        assert word in captured.err


@pytest.mark.parametrize(
    ("content", "blades", "words"),
    [
        (blade(), "8", ("--blades", "2 to 7")),
        (blade(), "3.5", ("--blades", "whole number")),
        (blade(), None, ("--geometry", "--blades")),
        ("", "3", ("own.csv", "no rows")),
        (HEAD, "3", ("own.csv", "rows")),
        (blade().replace("P_D", "colour"), "3", ("own.csv", "P_D")),
        (blade().replace("0.35,", "nan,"), "3", ("own.csv", "line 4", "finite")),
        (blade(pitch=100.0), "3", ("own.csv", "P_D", "percent")),
    ],
)
def test_bad_tables(
    content: str, blades: str | None, words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "own.csv"
    table.write_text(content, encoding="utf-8")
    count = [] if blades is None else ["--blades", blades]
    assert main(["open-water", "--geometry", str(table), *count, "--advance", "0.5", "--level", "2"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    for word in words:
        assert word in captured.err


@pytest.mark.parametrize(
    ("pitch", "thickness", "level", "reason"),
    [(0.2, 1.0, "1", "does not align"), (1.0, 2.2, "2", "roots of neighbouring blades meet")],
)
def test_what_a_solver_cannot_do_is_one_line_with_the_reason(
    pitch: float, thickness: float, level: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "own.csv"
    table.write_text(blade(pitch, thickness), encoding="utf-8")
    assert main(["open-water", "--geometry", str(table), "--blades", "7", "--advance", "1.2", "--level", level]) != 0
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    assert reason in captured.err
