"""Radial tables of propellers from CSV files, checked row by row."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.propeller.radial_table import RadialTable

COLUMNS = ("r_R", "c_D", "P_D", "skew_deg", "rake_D", "t_c", "f_c")

# What a blade can have, and what the remedy is where it does not: a value outside is nearly always a unit.
_LIMITS = {
    "r_R": (0.0, 1.0, "radii are fractions of the tip radius, 0 to 1"),
    "c_D": (0.0, 1.5, "chords are fractions of the diameter, not percent or millimetres"),
    "P_D": (0.05, 4.0, "pitch is a fraction of the diameter, not percent or metres"),
    "skew_deg": (-120.0, 120.0, "skew is in degrees"),
    "rake_D": (-0.5, 0.5, "rake is a fraction of the diameter, not degrees or percent"),
    "t_c": (0.001, 0.6, "thickness is a fraction of the chord, not percent"),
    "f_c": (-0.15, 0.15, "camber is a fraction of the chord, not percent"),
}
_MINIMUM_ROWS = 5


def radial_table_from_csv(path: str | Path, blade_count: int = 3, name: str | None = None) -> RadialTable:
    """Read a radial table from a CSV file.

    The file has a line of column names ``r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c`` (any order), then one row a radius from
    the hub to the tip (r/R = 1). Lines that start with # are comments. A tip chord of zero is allowed.

    Args:
        path: the file.
        blade_count: the number of blades that the table was drawn for.
        name: the table's name; the file's stem unless given.

    Raises:
        InputError: one line that names the file, the line and the remedy.
    """
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8-sig")
    except OSError as error:
        wanted = ",".join(COLUMNS)
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a CSV file with {wanted}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not a text file; give a CSV file with {','.join(COLUMNS)}") from error
    return radial_table_from_text(text, str(path), name or file.stem, blade_count)


def radial_table_from_text(text: str, source: str, name: str, blade_count: int = 3) -> RadialTable:
    """The same from text; ``source`` is how errors call it.

    Raises:
        InputError: one line that names the source, the line and the remedy.
    """
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1)]
    lines = [(number, line.strip()) for number, line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise InputError(f"{source}: holds no rows; give a CSV file with {','.join(COLUMNS)}")
    header = [cell.strip() for cell in lines[0][1].split(",")]
    missing = [column for column in COLUMNS if column not in header]
    if missing:
        raise InputError(
            f"{source}, line {lines[0][0]}: column {missing[0]} is missing; the first line must be {','.join(COLUMNS)}"
        )
    repeated = [column for column in COLUMNS if header.count(column) > 1]
    if repeated:
        raise InputError(f"{source}, line {lines[0][0]}: column {repeated[0]} stands there twice; keep one")
    rows: list[list[float]] = []
    for number, line in lines[1:]:
        rows.append(_row(line, header, f"{source}, line {number}"))
        if len(rows) > 1 and rows[-1][0] <= rows[-2][0]:
            raise InputError(
                f"{source}, line {number}: r_R {rows[-1][0]:g} does not ascend from {rows[-2][0]:g}; "
                "sort the rows from the hub to the tip"
            )
    if len(rows) < _MINIMUM_ROWS:
        raise InputError(f"{source}: has {len(rows)} rows; a blade needs at least {_MINIMUM_ROWS} radii")
    _check_ends(rows, source, lines[-1][0], lines[1][0])
    for (number, _), row in zip(lines[1:-1], rows[:-1], strict=True):
        if row[1] <= 0.0:
            raise InputError(f"{source}, line {number}: c_D is zero; only the tip (r_R = 1) may have no chord")
    columns = np.array(rows, dtype=np.float64).T
    columns[0, -1] = 1.0
    return RadialTable(
        name=name,
        radius_ratio=columns[0],
        chord_ratio=columns[1],
        pitch_ratio=columns[2],
        skew=np.radians(columns[3]),
        rake_ratio=columns[4],
        thickness_ratio=columns[5],
        camber_ratio=columns[6],
        blade_count=blade_count,
    )


def _row(line: str, header: list[str], where: str) -> list[float]:
    """The seven values of one line in the order of COLUMNS."""
    cells = [cell.strip() for cell in line.split(",")]
    if len(cells) != len(header):
        raise InputError(f"{where}: has {len(cells)} values for {len(header)} columns; give one value for each column")
    values: list[float] = []
    for column in COLUMNS:
        cell = cells[header.index(column)]
        try:
            value = float(cell)
        except ValueError as error:
            raise InputError(f"{where}: {column} '{cell[:40]}' is not a number; use a decimal point") from error
        if not math.isfinite(value):
            raise InputError(f"{where}: {column} is {cell[:40]}; give a finite number")
        low, high, remedy = _LIMITS[column]
        if not low <= value <= high:
            raise InputError(f"{where}: {column} {value:g} is outside {low:g} to {high:g}; {remedy}")
        values.append(value)
    return values


def _check_ends(rows: list[list[float]], source: str, last_line: int, first_line: int) -> None:
    if not 0.05 <= rows[0][0] <= 0.6:
        raise InputError(
            f"{source}, line {first_line}: the first r_R {rows[0][0]:g} is the hub ratio and must be 0.05 to 0.6; "
            "start the table at the hub"
        )
    if abs(rows[-1][0] - 1.0) > 1e-6:
        raise InputError(
            f"{source}, line {last_line}: the last r_R is {rows[-1][0]:g}; add the row of the tip, r_R = 1 "
            "(its chord may be 0)"
        )
