"""Bad tables and meshes of a user's own hull: one line that names the row and what to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.input import (
    ReadOptions,
    parent_hull_from_offsets,
    parent_hull_from_stl,
    read_table,
)
from hpsop_core.geometry.hull.input.surface_checks import check_between

LENGTH, DRAFT = 100.0, 6.25


def good_lines() -> list[str]:
    lines = ["station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, LENGTH, 11):
        for z in np.linspace(0.0, 8.0, 9):
            down = max(DRAFT - z, 0.0) / DRAFT
            lines.append(f"{x:.2f},{z:.2f},{5.0 * (1 - (2 * x / LENGTH - 1) ** 2) * (1 - down**2):.4f}")
    return lines


def _replaced(row: int, text: str) -> Callable[[list[str]], list[str]]:
    def change(lines: list[str]) -> list[str]:
        return [*lines[: row - 1], text, *lines[row:]]

    return change


def _swapped(lines: list[str]) -> list[str]:
    return [*lines[:11], lines[12], lines[11], *lines[13:]]


def _stations_swapped(lines: list[str]) -> list[str]:
    return [lines[0], *lines[10:19], *lines[1:10], *lines[19:]]


def _millimetres(lines: list[str]) -> list[str]:
    return [lines[0], *(",".join(f"{1000 * float(cell):.1f}" for cell in line.split(",")) for line in lines[1:])]


def _feet_across(lines: list[str]) -> list[str]:
    return [lines[0], *(line.rsplit(",", 1)[0] + f",{1000 * float(line.rsplit(',', 1)[1]):.1f}" for line in lines[1:])]


def _shifted(lines: list[str]) -> list[str]:
    return [lines[0], *(f"{float(line.split(',')[0]) + 500:.2f},{line.split(',', 1)[1]}" for line in lines[1:])]


CASES: dict[str, tuple[Callable[[list[str]], list[str]], str]] = {
    "nan": (_replaced(7, "0.00,5.00,nan"), r"row 7: half_breadth_m is nan"),
    "inf": (_replaced(7, "0.00,inf,0.1"), r"row 7: waterline_z_m is inf"),
    "text": (_replaced(7, "0.00,5.00,abc"), r"row 7: half_breadth_m is 'abc'"),
    "blank": (_replaced(7, "0.00,5.00"), r"row 7: half_breadth_m is ''"),
    "negative": (_replaced(30, "30.00,2.00,-1.0"), r"row 30: half_breadth_m is -1"),
    "unsorted waterlines": (_swapped, r"row 13: waterline .* sort waterlines"),
    "unsorted stations": (_stations_swapped, r"row 11: station 0 m comes after 10 m"),
    "twice": (lambda lines: [*lines[:12], lines[11], *lines[12:]], r"row 13: .* is given twice"),
    "station again": (lambda lines: [*lines, lines[1]], r"row 101: station 0 m appears again"),
    "gap": (lambda lines: [*lines[:30], *lines[31:]], r"row \d+: station 30 m has no half-breadth at waterline 2 m"),
    "millimetres": (_millimetres, r"row \d+: .* must be in metres"),
    "breadth in other units": (_feet_across, r"row \d+: a half-breadth of .* must be in metres"),
    "no header": (lambda lines: lines[1:], r"row 1: column 'station_x_m' is missing"),
    "empty": (lambda lines: ["# nothing"], r"empty"),
    "few stations": (lambda lines: lines[:28], r"3 stations; at least 7"),
    "all zero": (lambda lines: [lines[0], *(line.rsplit(",", 1)[0] + ",0" for line in lines[1:])], r"no half-breadth"),
    # Row 1 is the header, station 50 m begins in row 47: waterline 3 m stands in row 50, station 40 m's in row 41.
    "hole in the side": (_replaced(50, "50.00,3.00,0"), r"row 50: a hole: .* station 50 m, waterline 3 m"),
    "long hole": (
        lambda lines: _replaced(41, "40.00,3.00,0")(_replaced(50, "50.00,3.00,0")(lines)),
        r"row 41: a hole: .* station 40 m, waterline 3 m",
    ),
    "too wide": (_replaced(50, "50.00,3.00,9.0"), r"row 50: half_breadth_m 9 .* stands out .* correct it"),
    "hole along the ship": (
        lambda lines: [line if not line.startswith("50.00") else line.rsplit(",", 1)[0] + ",0" for line in lines],
        r"station 50 m has no breadth below the draft",
    ),
    # 3.1 m where the neighbours have 4.9 m: row 1 is the header, station 50 m begins in row 47.
    "slip of the pen": (_replaced(50, "50.00,3.00,1.10"), r"row 50: half_breadth_m 1.1 .* stands out"),
    # On the border of the table no four neighbours speak; the smooth surface does.
    "slip at the deepest waterline": (_replaced(47, "50.00,0.00,3.5"), r"row 4[78]: .* off the smooth surface"),
    "shifted": (_shifted, r"aft perpendicular is at x = 0"),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_tables(tmp_path: Path, case: str) -> None:
    change, message = CASES[case]
    path = tmp_path / "hull.csv"
    path.write_text("\n".join(change(good_lines())) + "\n")
    with pytest.raises(InputError, match=message) as caught:
        parent_hull_from_offsets(path, LENGTH, DRAFT)
    assert "\n" not in str(caught.value)


def test_the_good_table_is_good(tmp_path: Path) -> None:
    path = tmp_path / "hull.csv"
    path.write_text("# a comment\n" + "\n".join(good_lines()) + "\n\n")
    parent = parent_hull_from_offsets(path, LENGTH, DRAFT)
    assert parent.hydrostatics.displaced_volume > 0.0


@pytest.mark.parametrize(
    ("length", "draft", "message"),
    [(LENGTH, 9.0, "highest waterline .* a draft up to"), (LENGTH, -1.0, "draft must be"),
     (0.0, DRAFT, "length must be"),
     (float("nan"), DRAFT, "length must be"), (300.0, DRAFT, "span"), (LENGTH, 0.05, "draft")],
)  # fmt: skip
def test_bad_dimensions(tmp_path: Path, length: float, draft: float, message: str) -> None:
    path = tmp_path / "hull.csv"
    path.write_text("\n".join(good_lines()) + "\n")
    with pytest.raises(InputError, match=message):
        parent_hull_from_offsets(path, length, draft)


def test_a_surface_that_swings_between_the_points_is_refused(tmp_path: Path) -> None:
    """Between stations no reading speaks; the surface of a sound table is held against a table that ends higher."""
    path = tmp_path / "hull.csv"
    path.write_text("\n".join(good_lines()) + "\n")
    parent = parent_hull_from_offsets(path, LENGTH, DRAFT)
    table = read_table(path, ReadOptions(length=LENGTH, draft=DRAFT))
    check_between(parent, table)
    with pytest.raises(InputError, match=r"row \d+: near station .* below the lowest waterline .* add stations"):
        check_between(parent, replace(table, z=table.z + 1.0))
    table = replace(table, rows=None)
    with pytest.raises(InputError, match="above the draft"):
        check_between(replace(parent, draft=0.9 * DRAFT), table)
    with pytest.raises(InputError, match="outside the greatest half-breadth"):
        check_between(replace(parent, breadth=0.9 * parent.breadth), table)


def test_missing_and_binary_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        parent_hull_from_offsets(tmp_path / "none.csv", LENGTH, DRAFT)
    (tmp_path / "b.csv").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="cannot be read"):
        parent_hull_from_offsets(tmp_path / "b.csv", LENGTH, DRAFT)


def test_bad_meshes(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=(100.0, 10.0, 8.0))
    box.apply_translation([50.0, 0.0, 4.0])
    open_box = trimesh.Trimesh(box.vertices, box.faces[2:], process=False)
    open_box.export(tmp_path / "open.stl")
    with pytest.raises(InputError, match="holes"):
        parent_hull_from_stl(tmp_path / "open.stl", "m", 4.0, 100.0)
    box.export(tmp_path / "box.stl")
    with pytest.raises(InputError, match="unit"):
        parent_hull_from_stl(tmp_path / "box.stl", "yard", 4.0, 100.0)
    with pytest.raises(InputError, match="long in unit 'mm'"):
        parent_hull_from_stl(tmp_path / "box.stl", "mm", 4.0, 100.0)
    with pytest.raises(InputError, match="above the mesh's top"):
        parent_hull_from_stl(tmp_path / "box.stl", "m", 9.0, 100.0)
    box.apply_translation([0.0, 30.0, 0.0])
    box.export(tmp_path / "aside.stl")
    with pytest.raises(InputError, match="symmetric"):
        parent_hull_from_stl(tmp_path / "aside.stl", "m", 4.0, 100.0)
    (tmp_path / "no.stl").write_text("no mesh at all")
    with pytest.raises(InputError):
        parent_hull_from_stl(tmp_path / "no.stl", "m", 4.0, 100.0)


def test_crossing_sections_are_refused(tmp_path: Path) -> None:
    """Two hulls side by side: sections cross a height several times on one side."""
    parts = []
    for y in (-12.0, 12.0):
        box = trimesh.creation.box(extents=(100.0, 6.0, 8.0))
        box.apply_translation([50.0, y, 4.0])
        parts.append(box)
    trimesh.util.concatenate(parts).export(tmp_path / "cat.stl")
    with pytest.raises(InputError, match="times on one side"):
        parent_hull_from_stl(tmp_path / "cat.stl", "m", 4.0, 100.0)


def test_unknown_shipped_hull_and_patch() -> None:
    with pytest.raises(InputError, match="available: dtc"):
        load_parent_hull("kcs")
    with pytest.raises(InputError, match="no patch"):
        load_parent_hull().surface("rudder")
