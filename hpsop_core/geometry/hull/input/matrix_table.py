"""An offsets table as a matrix: a row a station and a column a waterline, or the other way round."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.delimited_text import Line, TextTable, extra_cells, is_number
from hpsop_core.geometry.hull.input.cells import are_feet_inches, are_fractions, reading
from hpsop_core.geometry.hull.input.columns import origin_of, role_of, split_unit, stated_in
from hpsop_core.geometry.hull.input.options import UNITS, FileTable, ReadOptions
from hpsop_core.typing_aliases import Array, IntArray

FEWEST_COLUMNS = 4
_BLANKS = ("", "-", "--", "—", "–", "n/a", "na", "nan", "*", "..", "...")
_LABEL = re.compile(r"^(.*?)([+-]?\d+(?:[.,]\d+)?)\s*(?:_|\s|\[|\()*\s*(m|mm|cm|ft|in|t|d)?[\])]*$", re.IGNORECASE)
_STATION_WORDS = ("st", "sta", "station", "stn", "x", "ord", "ordinate", "frame", "spant", "section", "sec")
_HEIGHT_WORDS = ("wl", "waterline", "z", "height", "w", "wasserlinie", "level", "h")


def _label(cell: str) -> tuple[str, float, str | None] | None:
    """A label such as "WL 0.25", "wl_1.5_m" or "7.5" as its word, number and unit; None where there is no number."""
    match = _LABEL.match(cell.strip())
    if match is None:
        return None
    word = re.sub(r"[^a-z]+", " ", match.group(1).lower()).strip()
    unit = (match.group(3) or "").lower() or None
    return word, float(match.group(2).replace(",", ".")), None if unit in ("t", "d") else unit


def is_matrix(table: TextTable) -> bool:
    """Whether the first line labels several columns with numbers and the first column holds numbers."""
    if len(table.lines) < 3:
        return False
    labels = [_label(cell) for cell in table.lines[0].cells[1:] if cell]
    if len(labels) < FEWEST_COLUMNS or sum(label is None for label in labels) > 1:
        return False
    return all(_label(line.cells[0]) is not None for line in table.lines[1:])


def _rows_are_stations(corner: str, across: Sequence[str], down: Sequence[str], columns: Array, lines: Array) -> bool:
    """What the rows of the matrix are, from the words of labels and corner, else from the numbers."""
    for words, answer in ((across, False), (down, True)):
        if any(word in _STATION_WORDS for word in words):
            return answer
        if any(word in _HEIGHT_WORDS for word in words):
            return not answer
    role, _ = role_of(re.split(r"[\\/|]", corner)[0]) if corner else (None, None)
    if role in ("station", "number"):
        return True
    if role == "height":
        return False
    # A ship is longer than it is high, and has more stations than waterlines.
    ranges = float(np.ptp(lines)), float(np.ptp(columns))
    return ranges[0] > ranges[1] if max(ranges) > 1.5 * min(ranges) else len(lines) >= len(columns)


def _filled(table: TextTable, y: Array, blank: Array, z: Array, x: Array, rows: IntArray) -> Array:
    """Blanks below a station's first reading are no hull; above its last one they repeat it (above the deck edge).

    Raises:
        InputError: a blank between readings, or a station without any.
    """
    y = y.copy()
    for i in range(len(x)):
        given = np.flatnonzero(~blank[i])
        if len(given) == 0:
            raise InputError(
                f"{table.name} row {rows[i, 0]}: station {x[i]:g} has no readings; give them or leave it out"
            )
        inside = np.flatnonzero(blank[i, given[0] : given[-1]]) + given[0]
        if len(inside):
            raise InputError(
                f"{table.name} row {rows[i, inside[0]]}: station {x[i]:g} has no half-breadth at waterline "
                f"{z[inside[0]]:g} but has them below and above it; give it (0 where there is no hull)"
            )
        y[i, : given[0]] = 0.0
        y[i, given[-1] + 1 :] = y[i, given[-1]]
    return y


def read_matrix_table(table: TextTable, options: ReadOptions) -> FileTable:
    """A matrix of stations and waterlines as a rectangular table.

    Half-breadths are in metres, in the stated unit, in feet-inches-eighths, or in fractions of B/2 with waterlines in
    fractions of the draft (told by a greatest breadth of exactly 1 and a waterline 1). Blank cells below a station's
    first reading stand for no hull, above its last one for a side that goes on.

    Raises:
        InputError: one line that names the row and the remedy.
    """
    header, body = table.lines[0], list(table.lines[1:])
    labels = [(place, _label(cell)) for place, cell in enumerate(header.cells) if place and cell]
    columns = [(place, label) for place, label in labels if label is not None]
    firsts = [_label(line.cells[0]) for line in body]
    down = [label for label in firsts if label is not None]
    across_values = np.array([label[1] for _, label in columns])
    down_values = np.array([label[1] for label in down])
    corner = header.cells[0]
    stations_down = _rows_are_stations(
        corner,
        [word for _, label in columns for word in label[0].split()],
        [word for label in down for word in label[0].split()],
        across_values,
        down_values,
    )
    notes = list(table.notes)
    cells = [[line.cells[place] if place < len(line.cells) else "" for place, _ in columns] for line in body]
    flat = [cell for row in cells for cell in row]
    shipyard = options.unit in (None, "ft", "ft-in-8") and are_feet_inches(flat)
    label_units = {label[2] for _, label in columns if label[2]} | {label[2] for label in down if label[2]}
    corner_units = {unit for part in re.split(r"[\\/|]", corner) if (unit := split_unit(part)[1])}
    stated_unit = next(iter(sorted(label_units | corner_units)), None)
    unit = options.unit or ("ft-in-8" if shipyard else stated_unit or "m")
    if shipyard:
        notes.append("half-breadths in feet-inches-eighths")
    y, blank, rows = _values(table, header, body, cells, columns, unit)
    axis = {"ft-in-8": "ft"}.get(unit, unit)
    fine = options.unit is None and stated_unit is None and not shipyard
    x, z = (down_values, across_values) if stations_down else (across_values, down_values)
    if not stations_down:
        y, blank, rows = y.T, blank.T, rows.T
    order = np.argsort(z, kind="stable")
    if np.any(np.diff(z[order]) == 0.0):
        twice = float(z[order][:-1][np.diff(z[order]) == 0.0][0])
        raise InputError(f"{table.name} row {header.number}: waterline {twice:g} is given twice; keep one")
    z, y, blank, rows = z[order], y[:, order], blank[:, order], rows[:, order]
    y = _filled(table, y, blank, z, x, rows)
    fractions = fine and are_fractions(z, y)
    stated, comments = stated_in(table.comments)
    words = [word for _, label in columns for word in label[0].split()] if not stations_down else (
        [word for label in down for word in label[0].split()]
    )  # fmt: skip
    role, station_unit = role_of(re.split(r"[\\/|]", corner)[0]) if corner else (None, None)
    # A station in metres is a place, whatever it is called.
    numbered = (role == "number" and station_unit is None) or any(
        word in _STATION_WORDS and word != "x" for word in words
    )
    origin = origin_of(corner) if corner else None
    if origin is not None:
        stated.setdefault("origin", origin)
    factor = 1.0 if fractions else UNITS[axis]
    return FileTable(
        name=table.name,
        layout=f"matrix of {len(x)} stations x {len(z)} waterlines",
        x=x if numbered or fractions else x * factor,
        z=z * factor,
        y=y,
        rows=rows,
        numbered=numbered,
        fractions=fractions,
        stated=stated,
        unit="fractions of draft and B/2" if fractions else unit,
        notes=(*notes, *comments),
    )


def _values(
    table: TextTable,
    header: Line,
    body: Sequence[Line],
    cells: Sequence[Sequence[str]],
    columns: Sequence[tuple[int, tuple[str, float, str | None]]],
    unit: str,
) -> tuple[Array, Array, IntArray]:
    """Readings, which of them are blank, and their rows, each of shape (lines, columns)."""
    y = np.zeros((len(body), len(columns)))
    blank = np.zeros(y.shape, dtype=bool)
    rows = np.zeros(y.shape, dtype=np.int64)
    for i, (line, row) in enumerate(zip(body, cells, strict=True)):
        error = extra_cells(table, line, len(header.cells))
        if error is not None:
            raise error
        for k, cell in enumerate(row):
            rows[i, k] = line.number
            if cell.lower() in _BLANKS:
                blank[i, k] = True
                continue
            name = f"half-breadth in column '{header.cells[columns[k][0]]}'"
            y[i, k] = reading(table, line.number, name, cell, unit)
            if y[i, k] < 0.0:
                raise InputError(
                    f"{table.name} row {line.number}: {name} is {cell}; give the port side, zero or positive"
                )
    return y, blank, rows


def numeric_header(table: TextTable) -> bool:
    """Whether the first line holds numbers only: a table without any header."""
    return bool(table.lines) and all(is_number(cell) for cell in table.lines[0].cells if cell)
