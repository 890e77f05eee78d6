"""What a table of half-breadths must be before a surface is fitted to it: sizes that fit each other, sound readings."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input.ship_table import ShipTable
from hpsop_core.typing_aliases import Array, BoolArray

FEWEST_STATIONS, FEWEST_WATERLINES = 7, 5
# Stations closer than this part of the table's length are one.
LEAST_STEP = 1e-6
# A reading further than this from all its neighbours, as a part of the greatest half-breadth, is a slip of the pen.
LARGEST_DENT = 0.05
# A bottom that begins this part of the draft above z = 0 is worth a word, and beyond the second number a wrong volume.
NOTED_GAP, LARGEST_GAP = 0.001, 0.02
# Within this part of the length from either end of the hull a region without breadth may be a gap or an aperture.
END_REACH = 0.1
# Deepest part below the baseline (a dome, a keel fin) as a part of the draft.
DEEPEST = 0.6
# Proportions that ships have, and those beyond which a unit or a full breadth must be wrong.
USUAL_SLENDER, USUAL_FLAT = (4.0, 11.0), (1.5, 6.0)
POSSIBLE_SLENDER, POSSIBLE_FLAT = (2.0, 25.0), (0.9, 14.0)
# A waterplane smaller than this part of the plane at that part of the draft belongs to a hull upside down.
NARROWER, LOW_PART = 0.98, 0.1


def check_counts(table: ShipTable) -> None:
    """Enough stations and waterlines.

    Raises:
        InputError: too few.
    """
    if len(table.x) < FEWEST_STATIONS:
        raise InputError(f"{table.name}: {len(table.x)} stations; at least {FEWEST_STATIONS} are needed")
    if len(table.z) < FEWEST_WATERLINES:
        raise InputError(f"{table.name}: {len(table.z)} waterlines; at least {FEWEST_WATERLINES} are needed")
    k = int(np.argmin(np.diff(table.x)))
    if float(table.x[k + 1] - table.x[k]) < LEAST_STEP * float(np.ptp(table.x)):
        raise InputError(
            f"{table.name}{table.row(k + 1, 0)}: {table.station_name(float(table.x[k + 1]))} is given twice or lies on "
            "its neighbour; keep one"
        )


def check_size(table: ShipTable) -> tuple[str, ...]:
    """Lengths that belong together; returns what is unusual.

    Raises:
        InputError: a unit, the draft, the length or the origin cannot be right; names row and remedy.
    """
    name, x, z, y, length, draft = table.name, table.x, table.z, table.y, table.length, table.draft
    units = "the table must be in metres: state its unit (mm, cm, ft, in)" if table.unit == "m" else (
        f"is its unit really {table.unit}?"
    )  # fmt: skip
    whole = float(x[-1] - x[0])
    if not 0.5 * length < whole < 2.0 * length:
        raise InputError(
            f"{name}{table.row(len(x) - 1, 0)}: the stations span {whole:g} m but the length is {length:g} m; {units} "
            "(it is never scaled)"
        )
    if draft > z[-1] * (1.0 + 1e-9):
        raise InputError(
            f"{name}: the draft {draft:g} m is above the highest waterline {z[-1]:g} m of the table; give a draft up "
            f"to {z[-1]:g} m, or add the waterlines above it"
        )
    wet = y[:, z <= draft * (1.0 + 1e-9)]
    if wet.shape[1] == 0 or not np.any(wet > 0.0):
        raise InputError(f"{name}: no half-breadth below the draft {draft:g} m is positive")
    in_water = np.flatnonzero(np.max(wet, axis=1) > 0.0)
    span = float(x[min(in_water[-1] + 1, len(x) - 1)] - x[max(in_water[0] - 1, 0)])
    if not 0.75 * length < span < 1.35 * length:
        raise InputError(
            f"{name}{table.row(int(in_water[-1]), 0)}: the stations in the water span {span:g} m but the length is "
            f"{length:g} m; {units}; is the draft right?"
        )
    widest = int(np.argmax(np.max(wet, axis=1)))
    half = float(np.max(wet))
    if not 0.005 * length < half < 0.5 * length:
        raise InputError(
            f"{name}{table.row(widest, 0)}: a half-breadth of {half:g} m does not fit a length of {length:g} m; {units}"
        )
    if not 0.002 * length < draft < 0.5 * length:
        raise InputError(f"{name}: a draft of {draft:g} m does not fit a length of {length:g} m; both are in metres")
    if float(x[in_water[0]]) > 0.25 * length or float(x[in_water[0]]) < -0.25 * length:
        raise InputError(
            f"{name}{table.row(int(in_water[0]), 0)}: the hull begins at x = {x[in_water[0]]:g} m; "
            f"the aft perpendicular is at x = 0 (read as: {table.axes}); state origin (ap, midship, fp) and bow"
        )
    below = int(np.sum(z < draft))
    if below < FEWEST_WATERLINES - 1:
        raise InputError(f"{name}: only {below} waterlines below the draft {draft:g} m; at least 4 are needed")
    return (*_bottom(table), *_proportions(table, half), *_way_up(table))


def _bottom(table: ShipTable) -> tuple[str, ...]:
    """The lowest waterline belongs to the keel: a gap below it is an unknown bottom."""
    name, z, draft = table.name, table.z, table.draft
    positive = np.flatnonzero(np.max(table.y, axis=0) > 0.0)
    lowest = float(z[max(int(positive[0]) - 1, 0)] if positive[0] > 0 else z[0])
    if lowest < -DEEPEST * draft:
        raise InputError(
            f"{name}: the lowest point is {-lowest:g} m below z = 0 with a draft of {draft:g} m; heights are counted "
            "from the baseline: state waterline=z0 if z = 0 is the still water"
        )
    if lowest <= NOTED_GAP * draft:
        return ()
    plane = 2.0 * float(np.trapezoid(table.y[:, int(np.argmax(z >= lowest))], table.x))
    lost = lowest * plane
    text = (
        f"the lowest waterline is {lowest:g} m above the baseline: the bottom below it is unknown and would be left "
        f"out (up to {lost:.4g} m3)"
    )
    if lowest > LARGEST_GAP * draft:
        raise InputError(
            f"{name}: {text}; add the row z = 0 with the half-breadths of the flat of bottom, or count z and the draft "
            "from the hull's lowest point"
        )
    return (f"warning: {text}",)


def _way_up(table: ShipTable) -> tuple[str, ...]:
    """A hull that stands on its head is broad where its bottom should be."""
    low, top = (
        float(np.trapezoid([np.interp(part * table.draft, table.z, row) for row in table.y], table.x))
        for part in (LOW_PART, 1.0)
    )
    if top > NARROWER * low:
        return ()
    remedy = "state up=-z" if table.rows is None else "count the heights from the keel up"
    return (
        f"warning: the hull is broader at {100.0 * LOW_PART:g} % of the draft than at its waterline, as if it stood on "
        f"its head; if it does, {remedy}",
    )


def _proportions(table: ShipTable, half: float) -> tuple[str, ...]:
    slender, flat = table.length / (2.0 * half), 2.0 * half / table.draft
    question = "are the half-breadths full breadths, or in another unit?"
    both = slender < 3.2 and flat > 6.0
    for value, words, (low, high) in ((slender, "L/B", POSSIBLE_SLENDER), (flat, "B/T", POSSIBLE_FLAT)):
        if not low < value < high or both:
            raise InputError(
                f"{table.name}: length {table.length:g} m, breadth {2.0 * half:g} m, draft {table.draft:g} m give "
                f"{words} = {value:.3g}, which no ship has; {question}"
            )
    return tuple(
        f"warning: {words} = {value:.3g} is outside what ships have ({low:g} to {high:g}); {question}"
        for value, words, (low, high) in ((slender, "L/B", USUAL_SLENDER), (flat, "B/T", USUAL_FLAT))
        if not low <= value <= high
    )


def check_points(table: ShipTable) -> None:
    """Holes in the side and single readings that stand out: what no hull has, told by the row.

    A hole is a region of zero readings with hull all round it; an aperture is open towards the stern. A reading stands
    out where it is larger, or smaller, than all four neighbours by ``LARGEST_DENT`` of the greatest half-breadth.

    Raises:
        InputError: the first such place.
    """
    name, x, z, y = table.name, table.x, table.z, table.y
    regions, count = ndimage.label(y == 0.0)
    border = set(np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]]).tolist())
    for region in range(1, count + 1):
        if region not in border and not _at_an_end(table, regions == region):
            i, k = (int(value[0]) for value in np.nonzero(regions == region))
            raise InputError(
                f"{name}{table.row(i, k)}: a hole: half_breadth_m is 0 at {table.station_name(float(x[i]))}, waterline "
                f"{z[k]:g} m, with hull all round it; give the half-breadth there"
            )
    inner = y[1:-1, 1:-1]
    around = np.stack([y[:-2, 1:-1], y[2:, 1:-1], y[1:-1, :-2], y[1:-1, 2:]])
    out = np.maximum(inner - around.max(axis=0), around.min(axis=0) - inner)
    # Around an opening a reading has zero neighbours; a hull's narrow posts and bosses stand there.
    worst = np.where(_beside_opening(inner, around), 0.0, out)
    i, k = (int(value) for value in np.unravel_index(int(np.argmax(worst)), worst.shape))
    if worst[i, k] > LARGEST_DENT * float(np.max(y)):
        raise InputError(
            f"{name}{table.row(i + 1, k + 1)}: half_breadth_m {inner[i, k]:g} at "
            f"{table.station_name(float(x[i + 1]))}, waterline {z[k + 1]:g} m stands out from all its "
            f"neighbours ({around[:, i, k].min():g} to {around[:, i, k].max():g} m); correct it"
        )


def _at_an_end(table: ShipTable, region: BoolArray) -> bool:
    """Whether a closed region of zeros lies in the narrow stations of either end: the gap between bulb and stem, or an
    aperture behind which the table goes on, not a hole in the side."""
    stations = np.flatnonzero(np.any(region, axis=1))
    wet = table.x[np.max(table.y, axis=1) > 0.0]
    room = END_REACH * float(wet[-1] - wet[0])
    at_end = bool(table.x[stations[0]] >= wet[-1] - room or table.x[stations[-1]] <= wet[0] + room)
    below = table.y[:, table.z <= table.draft * (1.0 + 1e-9)]
    return at_end and float(np.max(below[stations])) < 0.3 * float(np.max(below))


def _beside_opening(inner: Array, around: Array) -> BoolArray:
    return np.asarray((around.min(axis=0) == 0.0) & (inner < 0.15 * float(np.max(inner, initial=0.0))))
