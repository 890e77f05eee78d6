"""The long form of an offsets table: one reading a row, with its station and its waterline."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.delimited_text import TextTable, extra_cells
from hpsop_core.geometry.hull.input.cells import are_feet_inches, are_fractions, reading
from hpsop_core.geometry.hull.input.columns import origin_of, role_of, stated_in
from hpsop_core.geometry.hull.input.options import FileTable, ReadOptions

COLUMNS = ("station_x_m", "waterline_z_m", "half_breadth_m")
_Reading = tuple[int, float, float, float]


def is_long_form(table: TextTable) -> bool:
    """Whether the header names a station, a height and a breadth."""
    roles = {role_of(cell)[0] for cell in table.lines[0].cells} if table.lines else set()
    return bool({"station", "number"} & roles) and "height" in roles and bool({"half", "full"} & roles)


def _columns(table: TextTable) -> tuple[dict[str, int], dict[str, str | None]]:
    """Places and units of the columns by role; the contract's own names come first."""
    header = table.lines[0]
    places: dict[str, int] = {}
    units: dict[str, str | None] = {}
    for role, own in zip(("station", "height", "half"), COLUMNS, strict=True):
        if own in header.cells:
            places[role] = header.cells.index(own)
            units[role] = "m"
    for place, cell in enumerate(header.cells):
        found, unit = role_of(cell)
        if found is not None and found not in places and not (found == "number" and "station" in places):
            places[found], units[found] = place, unit
    for role, own in zip(("station", "height", "half"), COLUMNS, strict=True):
        other = {"station": "number", "half": "full"}.get(role, role)
        if role not in places and other not in places:
            raise InputError(
                f"{table.name} row {header.number}: column '{own}' is missing; the first line must be "
                f"{','.join(COLUMNS)}"
            )
    if "half" in places:
        places.pop("full", None)
    if "station" in places:
        places.pop("number", None)
    return places, units


def _rows(table: TextTable, places: dict[str, int], units: dict[str, str]) -> list[_Reading]:
    header = table.lines[0]
    order = ("station" if "station" in places else "number", "height", "half" if "half" in places else "full")
    names = [header.cells[places[role]] for role in order]
    rows: list[_Reading] = []
    for line in table.lines[1:]:
        values = []
        for role, column in zip(order, names, strict=True):
            cell = line.cells[places[role]] if places[role] < len(line.cells) else ""
            values.append(reading(table, line.number, column, cell, units[role]))
        error = extra_cells(table, line, len(header.cells))
        if error is not None:
            raise error
        if values[2] < 0.0:
            raise InputError(
                f"{table.name} row {line.number}: {names[2]} is {values[2]:g}; give the port side, zero or positive"
            )
        rows.append((line.number, values[0], values[1], 0.5 * values[2] if order[2] == "full" else values[2]))
    return rows


def _blocks(name: str, rows: Sequence[_Reading], rising: bool) -> list[list[_Reading]]:
    """The rows by station, in the order of the file."""
    seen: set[float] = set()
    blocks: list[list[_Reading]] = []
    for row in rows:
        if not blocks or row[1] != blocks[-1][-1][1]:
            if row[1] in seen:
                raise InputError(
                    f"{name} row {row[0]}: station {row[1]:g} m appears again after another one; sort rows by station"
                )
            if blocks and (row[1] < blocks[-1][-1][1]) == rising:
                raise InputError(
                    f"{name} row {row[0]}: station {row[1]:g} m comes after {blocks[-1][-1][1]:g} m; "
                    "sort stations rising"
                )
            seen.add(row[1])
            blocks.append([row])
            continue
        before = blocks[-1][-1]
        if row[2] == before[2]:
            raise InputError(
                f"{name} row {row[0]}: station {row[1]:g} m, waterline {row[2]:g} m is given twice "
                f"(first in row {before[0]})"
            )
        if row[2] < before[2]:
            raise InputError(
                f"{name} row {row[0]}: waterline {row[2]:g} m comes after {before[2]:g} m; sort waterlines rising at "
                "every station"
            )
        blocks[-1].append(row)
    return blocks


def _by_station(name: str, rows: list[_Reading]) -> list[_Reading]:
    """Rows that are sorted by waterline first, or from the top down, in the order station, height."""
    x, z = np.array([row[1] for row in rows]), np.array([row[2] for row in rows])
    if len(rows) < 3:
        return rows
    runs_of_height = int(np.sum(z[1:] != z[:-1])) + 1
    by_waterline = runs_of_height == len(np.unique(z)) < int(np.sum(x[1:] != x[:-1])) + 1
    same = x[1:] == x[:-1]
    top_down = bool(np.any(same)) and bool(np.all(z[1:][same] < z[:-1][same]))
    if not by_waterline and not top_down:
        return rows
    order = np.lexsort((z, x))
    return [rows[k] for k in order]


def read_long_table(table: TextTable, options: ReadOptions) -> FileTable:
    """The long form as a rectangular table.

    Args:
        table: header with station, height and half-breadth (or full breadth, which is halved) under any of the names in
            use; other columns are ignored.
        options: the unit is used for columns that name none.

    Raises:
        InputError: one line that names the row and the remedy.
    """
    name = table.name
    places, stated_units = _columns(table)
    notes = list(table.notes)
    half = "half" if "half" in places else "full"
    cells = [line.cells[places[half]] for line in table.lines[1:] if places[half] < len(line.cells)]
    shipyard = (
        stated_units.get(half) in (None, "ft") and options.unit in (None, "ft", "ft-in-8") and are_feet_inches(cells)
    )
    units = {role: stated_units.get(role) or options.unit or "m" for role in places}
    if shipyard:
        notes.append("half-breadths in feet-inches-eighths")
        for role in units:
            mine = [line.cells[places[role]] for line in table.lines[1:] if places[role] < len(line.cells)]
            default = "ft" if stated_units.get(role) is None else str(stated_units[role])
            units[role] = "ft-in-8" if are_feet_inches(mine) else default
    elif "ft-in-8" in units.values():
        units = {role: unit if unit != "ft-in-8" or role == half else "ft" for role, unit in units.items()}
    if half == "full":
        notes.append(f"column '{table.lines[0].cells[places['full']]}' holds full breadths: halved")
    # A station in metres is a place, whatever its column is called.
    numbered = "station" not in places and stated_units.get("number") is None
    if numbered:
        units["number"] = "m"
    rows = _by_station(name, _rows(table, places, units))
    if not rows:
        raise InputError(f"{name}: holds no readings below its first line; give one a row")
    rising = len(rows) < 2 or next((b[1] > a[1] for a, b in pairwise(rows) if b[1] != a[1]), True)
    # A table from the bow aft is one that falls all the way; one that falls once is out of order.
    falls = [b[1] < a[1] for a, b in pairwise(rows) if b[1] != a[1]]
    blocks = _blocks(name, rows, rising=rising or not all(falls))
    heights = sorted({row[2] for row in rows})
    for block in blocks:
        if len(block) != len(heights):
            present = {row[2] for row in block}
            lacking = next(z for z in heights if z not in present)
            raise InputError(
                f"{name} row {block[-1][0]}: station {block[0][1]:g} m has no half-breadth at waterline {lacking:g} m; "
                "every station needs every waterline (0 where there is no hull)"
            )
    stated, comments = stated_in(table.comments)
    along = places["station" if "station" in places else "number"]
    origin = None if numbered else origin_of(table.lines[0].cells[along])
    if origin is not None:
        stated.setdefault("origin", origin)
    unit = (
        units[half] if len(set(units.values())) == 1 else ", ".join(f"{role} in {unit}" for role, unit in units.items())
    )
    z, y = np.array(heights), np.array([[row[3] for row in block] for block in blocks])
    unitless = options.unit is None and stated_units.get("height") is None and stated_units.get(half) is None
    return FileTable(
        name=name,
        layout="table of offsets, one reading a row",
        x=np.array([block[0][1] for block in blocks]),
        z=z,
        y=y,
        rows=np.array([[row[0] for row in block] for block in blocks]),
        numbered=numbered,
        fractions=unitless and are_fractions(z, y),
        stated=stated,
        unit=unit,
        notes=(*notes, *comments),
    )
