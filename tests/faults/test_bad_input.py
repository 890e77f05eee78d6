"""Bad input: one line that names file, field and remedy, exit code 2, never a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest

from hpsop_core.assets import read_asset_text
from hpsop_core.cli.main import main

PAPER = read_asset_text("cases", "dtc-p4119-paper.toml")
HULL, BLADE = 'parent = "dtc"', 'parent = "p4119"'

# (what is replaced in the shipped case, by what, words that the message must hold)
BAD_CASES = {
    "unknown key": ("form_factor = 0.0", "form_facter = 0.0", ("constants", "did you mean 'form_factor'")),
    "unknown table": ("[objectives]", "[objectifs]", ("objectifs", "did you mean 'objectives'")),
    "reversed bounds": ("draft = [14.0, 14.5]", "draft = [14.5, 14.0]", ("bounds", "draft", "reversed")),
    "NaN": ("form_factor = 0.0", "form_factor = nan", ("form_factor", "finite")),
    "infinite": ("diameter = [8.5, 9.5]", "diameter = [8.5, inf]", ("diameter", "finite")),
    "half a blade": ("blade_count = 3\n", "blade_count = 3.5\n", ("initial", "blade_count", "whole number")),
    "half a blade in the bounds": ("[3, 7]", "[3, 6.5]", ("bounds", "blade_count", "whole number")),
    "negative beam": ("breadth = 51.0", "breadth = -51.0", ("initial", "breadth", "from")),
    "a text for a number": ("seed = 1", 'seed = "one"', ("seed", "not a number")),
    "weights": ("[0.65, 0.35]", "[0.65, 0.45]", ("weights", "sum")),
    "same objective twice": ('second = "efficiency"', 'second = "resistance"', ("objectives", "different")),
    "not TOML": ("[hull]", "[hull", ("TOML", "line")),
    "missing table": ("[initial]", "[conditions.x]", ("missing",)),
    "missing file": (HULL, 'offsets = "nowhere.csv"\nlength = 3.0\ndraft = 0.2', ("hull", "offsets", "nowhere.csv")),
    "missing propeller file": (BLADE, 'geometry = "nowhere.csv"', ("propeller", "geometry", "nowhere.csv")),
    "missing mesh": (HULL, 'stl = "nowhere.stl"\nstl_unit = "m"\nlength = 3.0\ndraft = 0.2', ("nowhere.stl",)),
    "mesh without a unit": (HULL, 'stl = "ship.stl"\nlength = 3.0\ndraft = 0.2', ("hull", "unit")),
    "mesh without a draft": (HULL, 'stl = "ship.stl"\nstl_unit = "m"\nlength = 3.0', ("hull", "draft")),
    "table and mesh": (HULL, 'stl = "ship.stl"\noffsets = "a.csv"', ("hull", "both", "keep one")),
    "unknown hull": (HULL, 'parent = "kcs"', ("kcs", "dtc")),
    "unknown propeller": (BLADE, 'parent = "p9999"', ("p9999", "p4119")),
}


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err


@pytest.mark.parametrize("name", BAD_CASES)
def test_bad_case_file(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, words = BAD_CASES[name]
    assert old in PAPER
    path = tmp_path / "my.toml"
    path.write_text(PAPER.replace(old, new), encoding="utf-8")
    assert main(["evaluate", str(path), "--json"]) == 2
    message = one_line(capsys)
    for word in words:
        assert word in message, message
    assert "my.toml" in message


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["evaluate", "no-such-case"], ("no-such-case", "dtc-p4119")),
        (["evaluate", "dtc-p4119", "--set", "diameter"], ("diameter", "NAME=VALUE")),
        (["evaluate", "dtc-p4119", "--set", "diametre=9"], ("diametre", "diameter")),
        (["evaluate", "dtc-p4119", "--set", "blade_count=3.5"], ("blade_count", "whole number")),
        (["evaluate", "dtc-p4119", "--set", "draft=nan"], ("draft", "finite")),
        (["evaluate", "dtc-p4119", "--set", "constants.form_factor=-1"], ("form_factor", "limits")),
        (["resistance", "dtc-p4119", "--froude", "0.9"], ("--froude", "0.9", "0.5")),
        (["resistance", "dtc-p4119", "--froude", "fast"], ("--froude", "fast")),
        (["resistance", "--froude", "0.2"], ("CASE", "--offsets")),
        (["resistance", "--offsets", "x.csv", "--froude", "0.2"], ("--length", "--draft")),
        (["resistance", "dtc-p4119", "--froude", "0.2", "--water", "beer"], ("--water", "salt")),
        (["open-water", "--advance", "0.5"], ("CASE", "--geometry")),
        (["open-water", "dtc-p4119", "--advance", "-1"], ("--advance", "-1")),
        (["open-water", "--geometry", "nowhere.csv", "--blades", "4", "--advance", "0.5"], ("nowhere.csv",)),
    ],
)
def test_bad_arguments(arguments: list[str], words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    message = one_line(capsys)
    for word in words:
        assert word in message, message


def test_mistyped_option_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as leaving:
        main(["evaluate", "dtc-p4119", "--levle", "1"])
    assert leaving.value.code == 2
    assert "--levle" in one_line(capsys)
