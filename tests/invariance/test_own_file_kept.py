"""A table as it was understood, kept and read again, is the same ship to the bit; deviations are distances."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hpsop_core.assets import asset_path
from hpsop_core.geometry.hull.input import ReadOptions, normalised_options, normalised_text, read_hull
from hpsop_core.geometry.hull.input.deviations import section_deviations
from hpsop_core.geometry.propeller.input import read_propeller
from hpsop_core.geometry.propeller.input.normalised import normalised_text as propeller_text

HULLS = Path(__file__).resolve().parents[1] / "data" / "hulls"


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("s60_cb060.csv", ReadOptions(length=121.92)),
        ("kvlcc2.csv", ReadOptions()),
        ("dtc_boss_tip.csv", ReadOptions(length=355.0, draft=14.5)),
    ],
)
def test_a_kept_hull_is_the_same_to_the_bit(name: str, options: ReadOptions, tmp_path: Path) -> None:
    given = read_hull(HULLS / name, options)
    kept = tmp_path / "kept.csv"
    kept.write_text(normalised_text(given.table), encoding="utf-8")
    again = read_hull(kept, normalised_options(given.table))
    assert again.parent.underwater.keys() == given.parent.underwater.keys()
    for patch in (*given.parent.underwater, *given.parent.topsides):
        for net in ("control_points", "knots_u", "knots_v"):
            one, other = (getattr(file.parent.surface(patch), net, None) for file in (given, again))
            assert (one is None and other is None) or np.array_equal(one, other)
    assert (again.parent.length, again.parent.breadth, again.parent.draft) == (
        given.parent.length,
        given.parent.breadth,
        given.parent.draft,
    )
    assert (again.parent.shaft_height, again.parent.boss_end_x) == (given.parent.shaft_height, given.parent.boss_end_x)
    # nothing that was understood has to be assumed again; the shaft's place is found, or assumed, as before
    assert not [line for line in again.understood.assumed if "shaft" not in line and "hub" not in line]


def test_a_kept_propeller_is_the_same(tmp_path: Path) -> None:
    given = read_propeller(str(asset_path("propellers", "p4119.csv")), 3).table
    kept = tmp_path / "kept.csv"
    kept.write_text(propeller_text(given), encoding="utf-8")
    again = read_propeller(kept, 3).table
    for column in ("radius_ratio", "chord_ratio", "pitch_ratio", "rake_ratio", "thickness_ratio", "camber_ratio"):
        assert np.array_equal(getattr(again, column), getattr(given, column)), column
    # radians to degrees and back: the last bit of a double
    np.testing.assert_allclose(again.skew, given.skew, rtol=4e-16, atol=0.0)


@pytest.mark.parametrize(("name", "options"), [("s60_cb060.csv", ReadOptions(length=121.92)), ("kvlcc2.csv", None)])
def test_the_largest_deviation_is_the_fit_s_at_its_place(name: str, options: ReadOptions | None) -> None:
    file = read_hull(HULLS / name, options)
    parent, table = file.parent, file.table
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    rows = np.array(section_deviations(hull, table, np.arange(len(table.x))))
    rows[:, table.z > table.draft * (1.0 + 1e-9)] = np.nan
    station, level = np.unravel_index(int(np.nanargmax(rows)), rows.shape)
    assert file.understood.fit is not None
    worst = max(file.understood.fit.patches, key=lambda patch: patch.max_m)
    assert table.x[station] == pytest.approx(worst.max_at_x_m)
    assert table.z[level] == pytest.approx(worst.max_at_z_m)
    # the fit measures to the surface in space and at its own points, here within the section and to its chords
    assert rows[station, level] == pytest.approx(worst.max_m, rel=0.02)


def test_a_reading_that_is_moved_lies_off_by_that_much() -> None:
    file = read_hull(HULLS / "s60_cb060.csv", ReadOptions(length=121.92))
    parent, table = file.parent, file.table
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    # amidships the side is upright: what is added to a half-breadth is the distance from it
    middle = int(np.argmin(np.abs(table.x - 0.5 * table.length)))
    level = int(np.argmin(np.abs(table.z - 0.75 * table.draft)))
    (before,) = section_deviations(hull, table, np.array([middle]))
    table.y[middle, level] += 0.25
    table.y[middle, 0] = 0.0
    (moved,) = section_deviations(hull, table, np.array([middle]))
    assert moved[level] == pytest.approx(0.25, abs=before[level] + 1e-4)
    # no reading, no distance
    assert np.isnan(moved[0])
