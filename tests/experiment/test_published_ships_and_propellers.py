"""What ``hpsop validate`` and docs/validation.md say of ships and propellers that nobody here tuned to."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from hpsop_core.cli.main import main
from hpsop_core.validation import miss_studies, published_hulls, published_propellers
from hpsop_core.validation.check import FITTED, HELD_OUT, LABELS, SELF_CONSISTENCY, Check, labelled
from hpsop_core.validation.comparison import Comparison
from hpsop_core.version import __version__

PAGE = Path(__file__).parents[2] / "docs" / "validation.md"


def inside(comparison: Comparison) -> list[bool]:
    return [check.passed for check in comparison.checks()]


def test_series_60_rises_to_its_hump_as_todd_measured() -> None:
    found = published_hulls.series_60()
    assert found.label == HELD_OUT
    # Form factor 0.10 to 0.13 and the measurement's own error; above Fn 0.305 the hump is known to come out low.
    assert all(ok for ok, at in zip(inside(found), found.at, strict=True) if at < 0.305)
    # A solver without waves, or with twice as many, is noticed at every speed: all lower bounds are above zero.
    assert np.all(found.lower > 0.0)
    assert np.all(2.0 * found.computed[found.at > 0.25] > found.upper[found.at > 0.25])


def test_the_wigley_hull_is_within_the_range_of_the_tanks() -> None:
    assert all(inside(published_hulls.wigley()))


def test_the_waves_of_the_dtc_are_compared_and_not_its_total() -> None:
    found = published_hulls.dtc()
    assert found.label == FITTED and all(inside(found))
    assert np.all(found.lower > 0.0)


def test_level_2_at_the_design_point_of_two_propellers_with_and_without_skew() -> None:
    quoted = 0.889
    points = {
        (c.group, c.quantity): c.computed[k] / c.measured[k] - 1.0
        for c in published_propellers.dtmb()
        for k in np.flatnonzero(np.isclose(c.at, quoted))
        if c.quantity.startswith("level 2")
    }
    # Third decimals of the quoted coefficients are 0.5 %; the geometry is from secondary sources.
    assert len(points) == 4
    assert max(abs(error) for error in points.values()) < 0.025, points


def test_b_series_of_five_blades_keeps_three_per_cent_of_efficiency() -> None:
    found = [c for c in published_propellers.b_series() if c.group.startswith("B5")]
    assert len(found) == 2
    assert all(all(inside(c)) for c in found)


def test_every_line_says_what_it_proves() -> None:
    lines = list(published_propellers.checks())
    assert {line.label for line in lines} == {FITTED, HELD_OUT}
    assert all(line.label == HELD_OUT for line in lines if "P4119" not in line.group)
    line = lines[0]
    assert [c.label for c in labelled(SELF_CONSISTENCY, [line])] == [SELF_CONSISTENCY]
    with pytest.raises(ValueError, match="validated"):
        Check("g", "q", 1.0, 1.0, "s", "t", True, "validated")
    assert len(LABELS) == 3


def test_a_point_outside_its_bounds_is_a_miss() -> None:
    one = np.array([1.0])
    found = Comparison("g", "q", "Fn", one, 1.11 * one, one, 0.9 * one, 1.1 * one, "why", "who", HELD_OUT)
    (line,) = found.checks()
    assert not line.passed and line.computed == 1.11 and "0.9 to 1.1: why" in line.tolerance


def test_the_page_tells_todays_numbers() -> None:
    """The page is generated; its DTC and Series 60 tables are what the code computes today."""
    text = PAGE.read_text(encoding="utf-8")
    assert f"hpsop {__version__}." in text
    for found in (published_hulls.series_60(), published_hulls.dtc(), published_hulls.wigley()):
        for at, computed in zip(found.at, found.computed, strict=True):
            row = re.search(
                rf"^\| {at:g} \|[^|]*\|[^|]*\| ([\d.]+) \|", text[text.index(f"\n{found.group}, ") :], re.MULTILINE
            )
            assert row, (found.group, at)
            # Four digits are printed.
            assert float(row[1]) == pytest.approx(computed, rel=1e-3), (found.group, at)
    for picture in re.findall(r"\((pictures/[^)]+)\)", text):
        assert (PAGE.parent / picture).is_file(), picture


def test_the_command_labels_its_lines_and_hides_no_miss(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    good = Check("g", "kept", 1.0, 1.0, "s", "t", True, FITTED)
    bad = Check("g", "lost", 2.0, 1.0, "s", "t", False, HELD_OUT)
    monkeypatch.setattr("hpsop_core.validation.all_checks", lambda: iter([good, bad]))
    assert main(["validate", "--json"]) == 1
    told = capsys.readouterr()
    first, second = json.loads(told.out)["checks"]
    keys = {"group", "quantity", "computed", "reference", "source", "tolerance", "passed", "label"}
    assert set(first) == keys and (first["label"], second["label"]) == (FITTED, HELD_OUT)
    assert "held out: 0 of 1" in told.err and "1 of 2" in told.err
    monkeypatch.setattr("hpsop_core.validation.all_checks", lambda: iter([good]))
    assert main(["validate"]) == 0
    assert "pass  [fitted] g: kept" in capsys.readouterr().out


def test_series_60_floats_deeper_by_what_its_waterplane_carries() -> None:
    fixed, sunk = (miss_studies._series_60(sinkage) for sinkage in (0.0, 0.2))
    before, after = fixed.hydrostatics, sunk.hydrostatics
    # Todd's CB 0.600 and CW 0.706; the waterplane grows a little over 0.2 m.
    assert before.displaced_volume == pytest.approx(0.6 * 121.92 * 16.256 * 6.5024, rel=0.01)
    gained = after.displaced_volume - before.displaced_volume
    assert gained == pytest.approx(0.2 * 0.706 * 121.92 * 16.256, rel=0.03)
