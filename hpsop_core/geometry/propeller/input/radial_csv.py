"""Radial tables of propellers from text files, checked row by row."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hpsop_core.errors import InputError, shown
from hpsop_core.geometry.delimited_text import LARGEST_TEXT, Line, TextTable, decoded, is_number, text_table
from hpsop_core.geometry.propeller.input.columns import (
    COLUMNS,
    MARKS,
    SKEW_RADIANS,
    THICKNESS_TO_DIAMETER,
    column_of,
    wrong_unit,
)
from hpsop_core.geometry.propeller.radial_table import RadialTable
from hpsop_core.reading import check_regular

# What a blade can have, and what the remedy is where it does not: a value outside is nearly always a unit.
_LIMITS = {
    "r_R": (0.0, 1.0, "radii are fractions of the tip radius, 0 to 1"),
    "c_D": (0.0, 1.5, "chords are fractions of the diameter, not percent or millimetres"),
    "P_D": (0.05, 4.0, "pitch is a fraction of the diameter, not percent, metres or degrees"),
    "skew_deg": (-120.0, 120.0, "skew is in degrees"),
    "rake_D": (-0.5, 0.5, "rake is a fraction of the diameter, not degrees or percent"),
    "t_c": (0.001, 0.6, "thickness is a fraction of the chord, not percent"),
    "f_c": (-0.15, 0.15, "camber is a fraction of the chord, not percent"),
    THICKNESS_TO_DIAMETER: (0.0, 0.2, "thickness is a fraction of the diameter, not percent or millimetres"),
    SKEW_RADIANS: (-2.1, 2.1, "skew is in radians here"),
}
_TO_RATIO = {
    "r_R": "divide the radii by the tip radius and call the column r_R",
    "c_D": "divide the chords by the diameter and call the column c_D",
    "P_D": "divide the pitch by the diameter, or take pi r_R tan(angle) of a pitch angle, and call the column P_D",
    "rake_D": "divide the rake by the diameter, or take r_R tan(angle)/2 of a rake angle, and call the column rake_D",
    "t_c": "divide the thickness by the chord and call the column t_c",
    "f_c": "divide the camber by the chord and call the column f_c",
    THICKNESS_TO_DIAMETER: "divide the thickness by the diameter and call the column t_D",
}
_OPTIONAL = {"skew_deg": "skew", "rake_D": "rake"}
# What a tip without chord may leave blank: of a point they say nothing, and its row goes on as the one before.
_NOTHING_AT_A_POINT = ("P_D", "skew_deg", "rake_D", "t_c", "f_c", THICKNESS_TO_DIAMETER, SKEW_RADIANS)
_BLANK = ("", "-", "\N{EN DASH}")
_LEFT_HANDED = (
    "a left-handed propeller is given as its right-handed mirror image: pitch without the minus, skew and rake as "
    "they are"
)
_MINIMUM_ROWS = 5


@dataclass(frozen=True, eq=False)
class RadialFile:
    """A radial table as it was read.

    Attributes:
        table: the blade.
        columns: title in the file of every column that was used, in the order of ``COLUMNS``.
        notes: what was assumed or noticed, one line each.
    """

    table: RadialTable
    columns: tuple[str, ...]
    notes: tuple[str, ...]


def read_radial_table(path: str | Path, blade_count: int = 3, name: str | None = None) -> RadialFile:
    """Read a radial table from a text file.

    The file has a line of column names ``r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c`` (any order, and other names in use such
    as OpenProp's r/R, P/D, Xs/D, f0/c, t0/c; t/D for t/c), then one row a radius from the hub to the tip (r/R = 1).
    Lines that start with # are comments, lines before the names are a title. Without skew or rake they are 0. A tip
    chord of zero is allowed, and leaves blank what a point does not have. Rows may come from the tip to the hub.

    Args:
        path: the file.
        blade_count: the number of blades that the table was drawn for.
        name: the table's name; the file's stem unless given.

    Raises:
        InputError: one line that names the file, the line and the remedy.
    """
    file = Path(path)
    wanted = ",".join(COLUMNS)
    check_regular(file, LARGEST_TEXT, f"a CSV file with {wanted}")
    try:
        text, notes = decoded(file)
    except InputError as error:
        raise InputError(f"{path}: is not a text file; give a CSV file with {wanted}") from error
    return _read(text_table(text, file.name, notes), str(path), name or file.stem, blade_count)


def radial_table_from_csv(path: str | Path, blade_count: int = 3, name: str | None = None) -> RadialTable:
    """The table of ``read_radial_table`` alone."""
    return read_radial_table(path, blade_count, name).table


def radial_table_from_text(text: str, source: str, name: str, blade_count: int = 3) -> RadialTable:
    """The same from text; ``source`` is how errors call it.

    Raises:
        InputError: one line that names the source, the line and the remedy.
    """
    return _read(text_table(text, source), source, name, blade_count).table


def _header(lines: Sequence[Line], source: str) -> int:
    """Index of the line of column names: the first that names radius and chord."""
    for k, line in enumerate(lines):
        if set(MARKS) <= {column_of(cell) for cell in line.cells}:
            return k
    if not lines:
        raise InputError(f"{source}: holds no rows; give a CSV file with {','.join(COLUMNS)}")
    return 0


def _places(header: Line, source: str) -> dict[str, int]:
    """Where the columns stand.

    Raises:
        InputError: one is missing or stands there twice.
    """
    found = [column_of(cell) for cell in header.cells]
    for cell in header.cells:
        unit = wrong_unit(cell)
        if unit is not None:
            column = column_of(cell) or cell
            raise InputError(f"{source}, line {header.number}: column {shown(cell)} is in {unit}; {_TO_RATIO[column]}")
    # an unknown name stands for no column at all
    has = {column for column in found if column is not None}
    for column in COLUMNS:
        other = {"t_c": THICKNESS_TO_DIAMETER, "skew_deg": SKEW_RADIANS}.get(column)
        if column not in has and column not in _OPTIONAL and other not in has:
            raise InputError(
                f"{source}, line {header.number}: column {column} is missing; the first line must be "
                f"{','.join(COLUMNS)}"
            )
    for column in (*COLUMNS, THICKNESS_TO_DIAMETER, SKEW_RADIANS):
        if found.count(column) > 1:
            raise InputError(f"{source}, line {header.number}: column {column} stands there twice; keep one")
    return {column: place for place, column in enumerate(found) if column is not None}


def _read(table: TextTable, source: str, name: str, blade_count: int) -> RadialFile:
    start = _header(table.lines, source)
    header = table.lines[start]
    places = _places(header, source)
    notes = list(table.notes)
    if start:
        notes.append(f"{start} lines before the line of column names left out")
    lines = _from_hub_to_tip(table, _table_lines(table, start + 1, notes), places["r_R"], notes)
    rows = _rows(table, lines, header, places, source, notes)
    if len(rows) < _MINIMUM_ROWS:
        raise InputError(f"{source}: has {len(rows)} rows; a blade needs at least {_MINIMUM_ROWS} radii")
    _check_ends(rows, source, lines[-1].number, lines[0].number)
    for line, row in zip(lines[:-1], rows[:-1], strict=True):
        if row["c_D"] <= 0.0:
            raise InputError(f"{source}, line {line.number}: c_D is zero; only the tip (r_R = 1) may have no chord")
    if "t_c" not in places:
        notes.append(f"t/c from column '{header.cells[places[THICKNESS_TO_DIAMETER]]}' over the chord")
        _thickness_of_chord(rows, lines, source)
    for column, word in _OPTIONAL.items():
        if column in places:
            continue
        if column == "skew_deg" and SKEW_RADIANS in places:
            notes.append(f"skew in radians from column '{header.cells[places[SKEW_RADIANS]]}'")
        else:
            notes.append(f"no column of {word}: 0")
    columns = {column: np.array([row.get(column, 0.0) for row in rows], dtype=np.float64) for column in COLUMNS}
    columns["r_R"][-1] = 1.0
    skew = np.array([row[SKEW_RADIANS] for row in rows]) if "skew_deg" not in places and SKEW_RADIANS in places else (
        np.radians(columns["skew_deg"])
    )  # fmt: skip
    radial = RadialTable(
        name=name,
        radius_ratio=columns["r_R"],
        chord_ratio=columns["c_D"],
        pitch_ratio=columns["P_D"],
        skew=skew,
        rake_ratio=columns["rake_D"],
        thickness_ratio=columns["t_c"],
        camber_ratio=columns["f_c"],
        blade_count=blade_count,
    )
    return RadialFile(radial, tuple(header.cells[place] for place in sorted(places.values())), tuple(notes))


def _table_lines(table: TextTable, start: int, notes: list[str]) -> list[Line]:
    """The rows below the names; a legend behind them (lines of words after the last row) is left out."""
    lines = list(table.lines[start:])
    last = max((k for k, line in enumerate(lines) if line.cells and is_number(line.cells[0])), default=-1)
    if 0 <= last < len(lines) - 1 and not any(is_number(cell) for line in lines[last + 1 :] for cell in line.cells[:2]):
        notes.append(f"{len(lines) - 1 - last} lines behind the table left out")
        lines = lines[: last + 1]
    return lines


def _from_hub_to_tip(table: TextTable, lines: list[Line], place: int, notes: list[str]) -> list[Line]:
    """The rows turned round where all their radii descend; what is no number is left to be told with its line."""
    try:
        radii = [table.number(line.cells[place]) for line in lines]
    except (ValueError, IndexError):
        return lines
    if len(radii) < _MINIMUM_ROWS or any(after >= before for before, after in itertools.pairwise(radii)):
        return lines
    notes.append("rows from the tip to the hub turned round")
    return lines[::-1]


def _rows(
    table: TextTable, lines: Sequence[Line], header: Line, places: dict[str, int], source: str, notes: list[str]
) -> list[dict[str, float]]:
    rows: list[dict[str, float]] = []
    left_blank = []
    for line in lines:
        where = f"{source}, line {line.number}"
        if len(line.cells) != len(header.cells):
            raise InputError(
                f"{where}: has {len(line.cells)} values for {len(header.cells)} columns; give one value for each column"
            )
        row: dict[str, float] = {}
        for column in (*COLUMNS, THICKNESS_TO_DIAMETER, SKEW_RADIANS):
            if column not in places:
                continue
            cell = line.cells[places[column]]
            of_a_point = bool(rows) and line is lines[-1] and row.get("c_D") == 0.0 and column in _NOTHING_AT_A_POINT
            if of_a_point and _says_nothing(table, cell, column):
                row[column] = rows[-1][column]
                left_blank.append(column)
            else:
                row[column] = _value(table, cell, column, where)
        if rows and row["r_R"] <= rows[-1]["r_R"]:
            raise InputError(
                f"{where}: r_R {row['r_R']:g} does not ascend from {rows[-1]['r_R']:g}; "
                "sort the rows from the hub to the tip"
            )
        rows.append(row)
    if left_blank:
        notes.append(f"at the tip, which has no chord, as in the row before: {', '.join(left_blank)}")
    return rows


def _says_nothing(table: TextTable, cell: str, column: str) -> bool:
    """Whether a cell of a tip without chord is blank, or the thickness 0 that stands for 0/0."""
    if cell.strip() in _BLANK:
        return True
    try:
        return column == "t_c" and table.number(cell) == 0.0
    except ValueError:
        return False


def _value(table: TextTable, cell: str, column: str, where: str) -> float:
    if cell.strip() in _BLANK:
        raise InputError(f"{where}: {column} is blank; give a number (a tip with chord 0 alone may leave it away)")
    try:
        value = table.number(cell)
    except ValueError as error:
        raise InputError(f"{where}: {column} '{cell[:40]}' is not a number; use a decimal point") from error
    if not math.isfinite(value):
        raise InputError(f"{where}: {column} is {cell[:40]}; give a finite number")
    low, high, remedy = _LIMITS[column]
    if column == "P_D" and -high <= value < 0.0:
        remedy = _LEFT_HANDED
    if column == "t_c" and value < low:
        remedy = f"a blade has some thickness everywhere: give at least {low:g}, at a tip with chord 0 none"
    if not low <= value <= high:
        raise InputError(f"{where}: {column} {value:g} is outside {low:g} to {high:g}; {remedy}")
    return value


def _thickness_of_chord(rows: list[dict[str, float]], lines: Sequence[Line], source: str) -> None:
    """t/c of every row from its t/D; a tip without chord continues the ratio of the row before."""
    for k, (row, line) in enumerate(zip(rows, lines, strict=True)):
        ratio = row[THICKNESS_TO_DIAMETER] / row["c_D"] if row["c_D"] > 0.0 else rows[k - 1]["t_c"]
        low, high, _ = _LIMITS["t_c"]
        if not low <= ratio <= high:
            raise InputError(
                f"{source}, line {line.number}: t/D {row[THICKNESS_TO_DIAMETER]:g} over c/D {row['c_D']:g} gives t/c "
                f"{ratio:.3g}, outside {low:g} to {high:g}; is the column really t/D?"
            )
        row["t_c"] = ratio


def _check_ends(rows: Sequence[dict[str, float]], source: str, last_line: int, first_line: int) -> None:
    if not 0.05 <= rows[0]["r_R"] <= 0.6:
        raise InputError(
            f"{source}, line {first_line}: the first r_R {rows[0]['r_R']:g} is the hub ratio and must be 0.05 to 0.6; "
            "start the table at the hub"
        )
    if abs(rows[-1]["r_R"] - 1.0) > 1e-6:
        raise InputError(
            f"{source}, line {last_line}: the last r_R is {rows[-1]['r_R']:g}; add the row of the tip, r_R = 1 "
            "(its chord may be 0)"
        )
