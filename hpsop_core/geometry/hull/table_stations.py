"""What a table of half-breadths says of every station below the waterline: its section, skeg, bulb or post.

Where the table closes to zero, the section ends on the centreline, at the place to which its last readings point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.fit import tidy_section
from hpsop_core.typing_aliases import Array

# Where a closing curve's last two values point to the zero reading of the table or beyond it, that reading is the end.
SNAP = 0.5
# A step of the aft profile by this part of the draft between two stations is a post, not a slope.
LEAST_POST = 0.25


@dataclass(frozen=True, eq=False)
class HalfBreadths:
    """A checked rectangular table.

    Attributes:
        name: for messages and reports.
        x, z: (nx,), (nz,) rising, m.
        y: (nx, nz) half-breadths >= 0, m.
    """

    name: str
    x: Array
    z: Array
    y: Array


def closing_place(at: Array, widths: Array) -> float:
    """Where a curve closes between a zero reading and its first positive one, by the line through two readings.

    Args:
        at: (3,) places of the zero reading, the first positive one and the next.
        widths: (2,) the two positive readings.
    """
    zero, first, second = (float(value) for value in at)
    width, next_width = (float(value) for value in widths)
    if next_width <= width * (1.0 + 1e-12):
        return zero
    target = first - width * (second - first) / (next_width - width)
    part = (target - zero) / (first - zero)
    return zero if part < SNAP else zero + min(part, 1.0 - 1e-3) * (first - zero)


@dataclass(frozen=True, eq=False)
class TableStation:
    """One station below the waterline.

    Attributes:
        x: m.
        points: its section up to the waterline or, submerged, to its crown; above an aperture only the upper piece.
        surface: it reaches the waterline.
        skeg: the piece below an aperture, closed at its top, or None.
    """

    x: float
    points: Array
    surface: bool
    skeg: Array | None


def _run(heights: Array, widths: Array, first: int, last: int, below: int) -> Array:
    """Points of the positive readings first..last, closed on the centreline where zero readings follow.

    Args:
        heights, widths: readings of one station, rising.
        first, last: the run.
        below: readings up to this index are below or at the waterline; a run that ends there stays open at its top.
    """
    points: list[tuple[float, float]] = []
    if first == 0:
        points.append((0.0, float(heights[0])))
    else:
        second = min(first + 1, len(heights) - 1)
        place = closing_place(heights[[first - 1, first, second]], widths[[first, second]])
        # Where a dome or keel elsewhere needs rows below it, the row of the baseline still holds the flat of bottom.
        on_baseline = heights[first] == 0.0 and place == heights[first - 1]
        points.append((0.0, 0.0 if on_baseline else place))
    points += [(float(widths[k]), float(heights[k])) for k in range(first, last + 1)]
    if last < below:
        second = max(last - 1, 0)
        points.append((0.0, closing_place(heights[[last + 1, last, second]], widths[[last, second]])))
    return np.array(points)


def _at_draft(z: Array, y: Array, draft: float) -> float:
    """Half-breadth at the draft; none where the line through the readings above it closes above it (a counter).

    Args:
        z, y: readings of one station.
        draft: m, between the first and the last of them.
    """
    value = max(float(PchipInterpolator(z, y)(draft)), 0.0)
    over = int(np.searchsorted(z, draft * (1.0 + 1e-9), side="right"))
    if over == 0 or over + 1 >= len(z) or y[over - 1] > 0.0 or z[over - 1] > draft * (1.0 - 1e-9):
        return value
    width, next_width, height, next_height = (float(one) for one in (*y[over : over + 2], *z[over : over + 2]))
    if width <= 0.0 or next_width <= width:
        return value
    closes = max(height - width * (next_height - height) / (next_width - width), float(z[over - 1]))
    return max(0.0, width * (draft - closes) / (height - closes))


def table_station(x: float, z: Array, y: Array, draft: float, forward: bool = False) -> TableStation | None:
    """The section of one station, or None where the hull is not below the waterline there.

    Args:
        x: m.
        z, y: its readings.
        draft: m.
        forward: in the fore body two pieces are a bulb and the stem above it: one section with a piece of the
            centreplane between them. In the after body the lower one is a skeg or boss; one that a single reading tells
            is smaller than the table resolves and is left out.
    """
    below = z < draft * (1.0 - 1e-9)
    above = z > draft * (1.0 + 1e-9)
    at_draft = _at_draft(z, y, draft)
    heights = np.concatenate([z[below], [draft], z[above]])
    widths = np.concatenate([y[below], [at_draft], y[above]])
    top = int(np.sum(below))
    positive = np.flatnonzero(widths[: top + 1] > 0.0)
    if len(positive) == 0:
        return None
    runs = np.split(positive, np.flatnonzero(np.diff(positive) > 1) + 1)
    last = int(runs[-1][-1])
    points = _run(heights, widths, int(runs[-1][0]), last, top)
    if points[0, 1] > draft * (1.0 - 1e-6):
        return None
    skeg = None
    if forward and len(runs) > 1:
        points = _joined([_run(heights, widths, int(run[0]), int(run[-1]), top) for run in runs])
    elif len(runs) == 2 and last == top and len(runs[0]) == 1:
        pass
    elif len(runs) == 2 and last == top:
        lower = _run(heights, widths, int(runs[0][0]), int(runs[0][-1]), top)
        skeg = tidy_section(x, lower, 1e-6 * draft).points
    elif len(runs) > 1:
        points = _run(heights, widths, int(runs[0][0]), last, top)
    return TableStation(x, tidy_section(x, points, 1e-6 * draft).points, last == top, skeg)


def _joined(pieces: Sequence[Array]) -> Array:
    """Pieces of one station from below as one section, with straight stretches of the centreplane between them."""
    points = [pieces[0]]
    for lower, upper in pairwise(pieces):
        low, high = float(lower[-1, 1]), float(upper[0, 1])
        points += [np.column_stack([np.zeros(3), np.linspace(low, high, 5)[1:-1]]), upper]
    return np.vstack(points)


def stations_in_water(table: HalfBreadths, draft: float) -> list[TableStation]:
    """The stations with a section below the waterline, from aft.

    Raises:
        InputError: too few of them, or a gap between them.
    """
    middle = 0.5 * float(table.x[0] + table.x[-1])
    found = [
        table_station(float(x), table.z, row, draft, bool(x > middle)) for x, row in zip(table.x, table.y, strict=True)
    ]
    present = [k for k, station in enumerate(found) if station is not None]
    stations = [station for station in found if station is not None]
    if len(stations) < 5:
        raise InputError(f"{table.name}: only {len(stations)} stations are below the draft, at least 5 are needed")
    if present[-1] - present[0] + 1 != len(present):
        gap = next(k for k in range(present[0], present[-1]) if k not in present)
        raise InputError(f"{table.name}: station {table.x[gap]:g} m has no breadth below the draft, its neighbours do")
    floating = sum(station.surface for station in stations)
    if floating < 4:
        raise InputError(f"{table.name}: the hull reaches the draft at {floating} stations only; check the draft")
    return stations


def aperture_station(stations: Sequence[TableStation]) -> int | None:
    """Index of the foremost station with a skeg below an aperture, where at least three of them follow each other."""
    split = [k for k, s in enumerate(stations[: len(stations) // 2]) if s.skeg is not None]
    if len(split) < 3 or split[-1] - split[0] + 1 != len(split):
        return None
    return split[-1]


def post_station(stations: Sequence[TableStation], aft: int) -> int | None:
    """Index of the station where the profile steps down to the keel: a post below a counter, without an aperture.

    The step is taken for a post where it is a quarter of the draft or more and steeper than 45 degrees.
    """
    half = stations[aft : max(aft + 2, len(stations) // 2)]
    bottoms = [float(station.points[0, 1]) for station in half]
    top = float(half[0].points[-1, 1])
    for k in range(len(half) - 1):
        step = bottoms[k] - bottoms[k + 1]
        if step > LEAST_POST * top and step > half[k + 1].x - half[k].x:
            return aft + k
    return None
