"""From a file's own axes and numbers to a table of half-breadths in ship axes, in metres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input.options import FileTable, ReadOptions
from hpsop_core.typing_aliases import Array, IntArray

# Without a stated draft: breadth over draft of ships lies between 2 and 4.
ASSUMED_BREADTH_TO_DRAFT = 2.5
# Station numbers count tenths or twentieths of Lpp.
STATION_COUNTS = (20, 10, 40, 100)
# Metres whose span differs from Lpp by less than this part of it are metres; so do numbers and metres agree.
SAME_LENGTH = 5e-3
# LCF aft of LCB by this part of the length is told from rounding: the fuller upper waterlines are at the stern.
CLEAR_CENTRES = 0.008
# A waterline this close to the draft, as a part of it, is the waterline of the draft: numbers are rounded in files.
SAME_HEIGHT = 1e-4


@dataclass(frozen=True, eq=False)
class ShipTable:
    """A table in ship axes (x forward from AP, z up from the baseline), m, before it is checked.

    Attributes:
        name: of the file.
        layout, unit: what the file held, in words.
        x, z: (nx,), (nz,) rising.
        y: (nx, nz) half-breadths.
        rows: (nx, nz) line of the file that holds each reading, or None where there are no lines (a mesh).
        length, draft: Lpp and still water, m.
        axes: how the file's axes lay in the ship, in words.
        notes: what was assumed, one line each.
        station_name: how a station of this file is called by people: of its place in m, the words.
    """

    name: str
    layout: str
    unit: str
    x: Array
    z: Array
    y: Array
    rows: IntArray | None
    length: float
    draft: float
    axes: str
    notes: tuple[str, ...]
    station_name: Callable[[float], str]

    def row(self, station: int, level: int) -> str:
        """ " row 12" of a reading, or "" without rows: goes right behind the file's name."""
        return "" if self.rows is None else f" row {int(self.rows[station, level])}"


def _spacing(table: FileTable, options: ReadOptions, length: float | None) -> tuple[float, str]:
    """Metres between two whole station numbers, and where they come from."""
    stated = table.stated.get("spacing")
    if isinstance(stated, float):
        return stated, f"stations {stated:g} m apart, as the file says"
    last = float(np.max(table.x))
    if length is not None:
        span = float(np.ptp(table.x))
        metres = 0.75 * length < span < 1.35 * length
        count = next(
            (n for n in STATION_COUNTS if abs(last - n) < 1.01 or abs(np.max(np.floor(table.x)) - n) < 1e-9), None
        )
        if count is not None and metres and abs(length - count) > SAME_LENGTH * length:
            # Either could be meant: numbers run from a station 0 to a station 10 or 20, metres span the length.
            metres = abs(span - length) <= SAME_LENGTH * length or not {0.0, float(count)} <= set(table.x.tolist())
            chosen, other = ("metres", length / count) if metres else (f"numbers 0 to {count}", 1.0)
            return 1.0 if metres else length / count, (
                f"warning: stations {float(np.min(table.x)):g} to {last:g} on a length of {length:g} m may be numbers "
                f"or metres: taken as {chosen}; if they are not, write '# spacing = {other:.6g} m' into the file"
            )
        if metres:
            return 1.0, "column of stations taken as metres: they span the length"
        if count is not None:
            return length / count, f"station numbers 0 to {count} over Lpp: {length / count:g} m apart"
    raise InputError(
        f"{table.name}: the stations are numbers ({float(np.min(table.x)):g} to {last:g}), their distance is unknown; "
        "state the length (numbers 0 to 10 or 0 to 20 are then parts of Lpp), or '# spacing = 5.5 m' in the file"
    )


def _dimensions(table: FileTable, options: ReadOptions) -> tuple[float | None, float | None, float | None, list[str]]:
    """Length, breadth and draft as far as they are stated by the user, the file's comments or their proportions."""
    notes: list[str] = []
    values: dict[str, float | None] = {}
    for name in ("length", "breadth", "draft"):
        own = getattr(options, name)
        stated = table.stated.get(name)
        values[name] = own if own is not None else stated if isinstance(stated, float) else None
    slender, flat = (table.stated.get(key) for key in ("length_to_breadth", "breadth_to_draft"))
    if table.fractions:
        for _ in range(2):
            if values["breadth"] is None and values["length"] is not None and isinstance(slender, float):
                values["breadth"] = values["length"] / slender
                notes.append(f"breadth {values['breadth']:g} m from the file's L/B {slender:g}")
            if values["breadth"] is None and values["draft"] is not None and isinstance(flat, float):
                values["breadth"] = values["draft"] * flat
                notes.append(f"breadth {values['breadth']:g} m from the file's B/T {flat:g}")
            if values["draft"] is None and values["breadth"] is not None and isinstance(flat, float):
                values["draft"] = values["breadth"] / flat
                notes.append(f"draft {values['draft']:g} m from the file's B/T {flat:g}")
            if values["length"] is None and values["breadth"] is not None and isinstance(slender, float):
                values["length"] = values["breadth"] * slender
                notes.append(f"length {values['length']:g} m from the file's L/B {slender:g}")
        missing = [name for name in ("breadth", "draft") if values[name] is None]
        if missing:
            raise InputError(
                f"{table.name}: half-breadths and waterlines are fractions of B/2 and the draft; state the "
                f"{' and the '.join(missing)} in metres (or L/B and B/T in a comment)"
            )
    return values["length"], values["breadth"], values["draft"], notes


def bow_of(x: Array, z: Array, y: Array, draft: float) -> str | None:
    """The end of x at which the bow is, "+x" or "-x", from the form; None where the form does not tell.

    Above, a stern is far fuller than below, a bow hardly: the centroid of the waterline lies aft of that of the body
    below half the draft.
    """
    levels = z[z <= draft * (1.0 + 1e-6)]
    if len(levels) < 3:
        return None
    width = np.array([np.interp([0.25 * draft, 0.5 * draft, draft], z, row) for row in y])
    low = width[:, 0] + width[:, 1]
    top = width[:, 2]
    areas = [float(np.trapezoid(w, x)) for w in (low, top)]
    if min(areas) <= 0.0:
        return None
    centres = [float(np.trapezoid(w * x, x)) / area for w, area in zip((low, top), areas, strict=True)]
    apart = (centres[0] - centres[1]) / float(np.ptp(x))
    if abs(apart) < CLEAR_CENTRES:
        return None
    return "+x" if apart > 0.0 else "-x"


def _water_ends(x: Array, y: Array, z: Array, draft: float) -> tuple[float, float]:
    """First and last x of the waterline."""
    width = np.array([float(np.interp(draft, z, row)) for row in y])
    floating = np.flatnonzero(width > 0.0)
    if len(floating) == 0:
        return float(x[0]), float(x[-1])
    return float(x[max(floating[0] - 1, 0)]), float(x[min(floating[-1] + 1, len(x) - 1)])


def in_ship_axes(table: FileTable, options: ReadOptions, rows: bool = True) -> ShipTable:
    """The table in ship axes.

    What is not stated is taken from the file (its comments, its column names), else assumed and noted: the bow at +x,
    x = 0 at AP, z = 0 on the baseline.

    Args:
        table: as a reader gives it.
        options: what the user states; it wins over the file.
        rows: whether the table's rows are lines of a file.

    Raises:
        InputError: a dimension is missing that cannot be assumed.
    """
    length, breadth, draft, notes = _dimensions(table, options)
    x, z, y = table.x, table.z, table.y
    axes = options.axes
    if table.fractions:
        z, y = z * float(draft or 0.0), y * (0.5 * float(breadth or 0.0))
    spacing = 1.0
    if table.numbered:
        spacing, note = _spacing(table, options, length)
        notes.append(note)
    numbers, x = x, x if spacing == 1.0 else x * spacing
    waterline = axes.waterline if axes.waterline != "auto" else str(table.stated.get("waterline", "draft"))
    if draft is None:
        if waterline == "z0":
            draft = -float(z.min())
            notes.append(f"draft not stated: the lowest point lies {draft:g} m below the still water")
        else:
            draft = min(float(z.max()), 2.0 * float(np.max(y)) / ASSUMED_BREADTH_TO_DRAFT)
            notes.append(
                f"draft not stated: {draft:.4g} m assumed (B/{ASSUMED_BREADTH_TO_DRAFT:g}, or the highest waterline); "
                "state it"
            )
    if waterline == "z0":
        z = z + draft
    at = int(np.argmin(np.abs(z - draft)))
    if 0.0 < abs(float(z[at]) - draft) < SAME_HEIGHT * draft:
        # A height written with four decimals is the draft that was stated with more.
        z = np.where(np.arange(len(z)) == at, draft, z)
    origin = axes.origin if axes.origin != "auto" else str(table.stated.get("origin", "auto"))
    bow = axes.bow if axes.bow != "auto" else str(table.stated.get("bow", "auto"))
    order = np.argsort(x, kind="stable")
    x, y, line_of = x[order], y[order], table.rows[order]
    numbers = numbers[order]
    looks = bow_of(x, z, y, draft)
    middle = 0.5 * float(x[0] + x[-1])
    if bow == "auto":
        # From FP a table runs aft, from AP it runs forward; only the sign of x could say otherwise.
        if origin == "fp":
            bow = "-x" if middle > 0.0 else "+x"
        elif origin == "ap":
            bow = "+x" if middle > 0.0 else "-x"
        elif table.numbered and spacing != 1.0 and looks is not None:
            bow = looks
            notes.append(f"bow at {bow} of the station numbers: there the upper waterlines are finer")
        else:
            bow = "+x"
            if table.numbered and spacing != 1.0 and origin == "auto":
                notes.append(
                    "warning: neither the file nor its form tells which end station 0 is: AP assumed; if it is FP, "
                    "state bow=-x"
                )
        if origin in ("ap", "fp"):
            notes.append(f"bow at {bow}: x = 0 is at {origin.upper()}")
    if origin == "auto":
        origin = "ap"
        if table.numbered and spacing != 1.0 and bow == "-x":
            origin = "fp"
            notes.append("station 0 at FP, since the bow is there")
    if looks is not None and looks != bow and axes.bow == "auto":
        notes.append(
            f"warning: the form looks as if the bow were at {looks} (its upper waterlines are finer there); if it is, "
            f"state bow={looks} and the origin"
        )
    if length is None:
        first, last = _water_ends(x, y, z, draft)
        reach = {"ap": last if bow == "+x" else -first, "fp": last if bow == "-x" else -first}.get(origin, last - first)
        length = reach if reach > 0.2 * (last - first) else last - first
        notes.append(f"length not stated: {length:.5g} m assumed, from AP to the fore end of the waterline; state it")
    forward = x if bow == "+x" else -x
    shift = {"ap": 0.0, "midship": 0.5 * length, "fp": length}[origin]
    placed = forward + shift if shift != 0.0 else forward
    if bow == "-x":
        placed, y, line_of, numbers = placed[::-1], y[::-1], line_of[::-1], numbers[::-1]
    words = f"bow at {bow}, x = 0 at {origin.upper() if origin != 'midship' else 'midship'}, z = 0 at the " + (
        "still water" if waterline == "z0" else "baseline"
    )
    return ShipTable(
        name=table.name,
        layout=table.layout,
        unit=table.unit,
        x=np.ascontiguousarray(placed),
        z=z,
        y=np.ascontiguousarray(y),
        rows=np.ascontiguousarray(line_of) if rows else None,
        length=length,
        draft=draft,
        axes=words,
        notes=(*table.notes, *notes),
        station_name=_namer(placed, numbers, table.numbered and spacing != 1.0, bow, origin),
    )


def _namer(placed: Array, numbers: Array, numbered: bool, bow: str, origin: str) -> Callable[[float], str]:
    """How people find a station in their file: its number, or its x where the file counts from elsewhere."""
    if not numbered and bow == "+x" and origin == "ap":
        return lambda x: f"station {x:g} m"

    def name(x: float) -> str:
        nearest = int(np.argmin(np.abs(placed - x)))
        own = f"number {numbers[nearest]:g}" if numbered else f"x = {numbers[nearest]:g} m in the file"
        return f"station {own} ({placed[nearest]:.5g} m from AP)"

    return name
