"""A table as it was understood, kept and read again, is the same ship to the bit; deviations are distances."""

from __future__ import annotations

import functools
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from explorer.services.own_ships import OwnShips
from explorer.state.own_ship import OwnShip, UserFile
from hpsop_core.assets import asset_path
from hpsop_core.geometry.hull.input import HullFile, ReadOptions, normalised_options, normalised_text, read_hull
from hpsop_core.geometry.hull.input.deviations import section_deviations
from hpsop_core.geometry.propeller.input import read_propeller
from hpsop_core.geometry.propeller.input.normalised import normalised_text as propeller_text

HULLS = Path(__file__).resolve().parents[1] / "data" / "hulls"


OPTIONS = {
    "s60_cb060.csv": ReadOptions(length=121.92),
    "kvlcc2.csv": ReadOptions(),
    "dtc_boss_tip.csv": ReadOptions(length=355.0, draft=14.5),
}


@functools.cache
def given_hull(name: str) -> HullFile:
    return read_hull(HULLS / name, OPTIONS[name])


@pytest.mark.parametrize("name", OPTIONS)
def test_a_kept_hull_is_the_same_to_the_bit(name: str, tmp_path: Path) -> None:
    given = given_hull(name)
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


@pytest.mark.parametrize("name", ["kvlcc2.csv", "dtc_boss_tip.csv"])
def test_sides_meet_their_readings_at_the_ends_of_patches_too(name: str) -> None:
    """Where the table has a station at the border of two patches, and where the waterline ends below an overhang."""
    file = given_hull(name)
    parent, table = file.parent, file.table
    widest = float(np.max(table.y))
    for patch, surface in parent.topsides.items():
        points = surface.evaluate(np.linspace(0.0, 1.0, 401), np.linspace(0.0, 1.0, 101))
        # no side swings out between or beyond its stations: 36 m instead of 25.5 before
        assert np.max(points[..., 1]) < 1.02 * widest
        for end in (0, -1):
            x = points[end, 0, 0]
            if not np.any(np.isclose(table.x, x, rtol=0.0, atol=1e-6)):
                continue
            high = (table.z > 1.15 * parent.draft) & (table.z < points[end, -1, 2])
            found = np.interp(table.z[high], points[end, :, 2], points[end, :, 1])
            read = table.y[int(np.argmin(np.abs(table.x - x))), high]
            # four spans of a spline over the height of a side; 1.5 m where the station itself was left out
            assert np.max(np.abs(found - read), initial=0.0) < 0.3, (patch, x)


def test_the_page_says_as_the_command_does_that_a_slow_ship_has_speeds_above_its_own(tmp_path: Path) -> None:
    told = {}
    for name in ("kvlcc2.csv", "s60_cb060.csv"):
        desk = Mock(ship=OwnShip(hull=UserFile(name, b""), read=given_hull(name)))
        ships = OwnShips(desk, tmp_path, Mock())
        told[name] = ships.case().description
        ships.close()
        assert told[name].startswith(f"Made on the page of {name}: ")
    assert "at the froude number of 0.16" in told["kvlcc2.csv"].lower() and "slowest that can" in told["kvlcc2.csv"]
    assert "Froude numbers that suit CB 0.8" not in told["kvlcc2.csv"]
    assert "Froude numbers that suit CB 0.598" in told["s60_cb060.csv"] and "slowest" not in told["s60_cb060.csv"]


def test_a_kept_propeller_is_the_same(tmp_path: Path) -> None:
    given = read_propeller(str(asset_path("propellers", "p4119.csv")), 3).table
    kept = tmp_path / "kept.csv"
    kept.write_text(propeller_text(given), encoding="utf-8")
    again = read_propeller(kept, 3).table
    for column in ("radius_ratio", "chord_ratio", "pitch_ratio", "rake_ratio", "thickness_ratio", "camber_ratio"):
        assert np.array_equal(getattr(again, column), getattr(given, column)), column
    # radians to degrees and back: the last bit of a double
    np.testing.assert_allclose(again.skew, given.skew, rtol=4e-16, atol=0.0)


@pytest.mark.parametrize("name", ["s60_cb060.csv", "kvlcc2.csv"])
def test_the_largest_deviation_is_the_fit_s_at_its_place(name: str) -> None:
    file = given_hull(name)
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
    file = read_hull(HULLS / "s60_cb060.csv", OPTIONS["s60_cb060.csv"])
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
