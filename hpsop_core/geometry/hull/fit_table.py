"""A parent hull fitted to any rectangular table of half-breadths.

One patch from the bottom's centreline to the design waterline; where sections end below the waterline at an end of the
hull (a bulb), a second patch that shares the first one's edge. Sharp ends and a sharp keel stay sharp: where the table
closes to zero, the surface's edge lies in the centreplane exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypedDict

import numpy as np
from scipy.interpolate import PchipInterpolator

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.fit import (
    DEGREE,
    PatchFit,
    Section,
    StationMap,
    edge_segment,
    fit_patch,
    free_net,
    knots_at,
    tidy_section,
)
from hpsop_core.geometry.hull.form import ShiftFrame
from hpsop_core.geometry.hull.hull import FitReport, ParentHull, PatchDeviation
from hpsop_core.geometry.hull.hydrostatics import sectional_areas
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array


class FitSettings(TypedDict):
    """What every fit to a table shares."""

    smoothing: float
    rounds: int


MOST_SPANS = 48
FIT: FitSettings = {"smoothing": 5e-3, "rounds": 3}
# Where a closing curve's last two values point to the zero reading of the table or beyond it, that reading is the end.
SNAP = 0.5
# A step of the aft profile by this part of the draft between two stations is a post, not a slope.
LEAST_POST = 0.25
# Flat ends smaller than this part of the largest section are the last slice of a bulb or stem, not worth a warning.
LEAST_FLAT_END = 0.005
# Control points may lie this part of the draft beyond the heights of the points, as those of a rounded edge must.
HEIGHT_ROOM = 0.15
# Without a stern boss in the table: the reference ship's proportions (5.0 m of 14.5 m).
SHAFT_HEIGHT_TO_DRAFT = 5.0 / 14.5
WALL_HEIGHT_TO_DRAFT = 0.5


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


def _closing(at: Array, widths: Array) -> float:
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
class _Station:
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
        points.append((0.0, _closing(heights[[first - 1, first, second]], widths[[first, second]])))
    points += [(float(widths[k]), float(heights[k])) for k in range(first, last + 1)]
    if last < below:
        second = max(last - 1, 0)
        points.append((0.0, _closing(heights[[last + 1, last, second]], widths[[last, second]])))
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


def _station(x: float, z: Array, y: Array, draft: float) -> _Station | None:
    """The section of one station, or None where the hull is not below the waterline there."""
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
    if len(runs) == 2 and last == top and len(runs[0]) > 1:
        lower = _run(heights, widths, int(runs[0][0]), int(runs[0][-1]), top)
        skeg = tidy_section(x, lower, 1e-6 * draft).points
    elif len(runs) > 1:
        points = _run(heights, widths, int(runs[0][0]), last, top)
    return _Station(x, tidy_section(x, points, 1e-6 * draft).points, last == top, skeg)


def _smooth_knots(x: Array, most: int) -> Array:
    """Stations for the knots of x(u): as dense as the data, spacing changing gently."""
    if len(x) < 3:
        return np.linspace(x[0], x[-1], 4)
    count = int(np.clip(len(x) - 1, 3, most))
    chosen = np.interp(np.linspace(0.0, len(x) - 1.0, count + 1), np.arange(len(x)), x)
    spacing = np.log(np.diff(chosen))
    for _ in range(200):
        stations = x[0] + (x[-1] - x[0]) * np.concatenate([[0.0], np.cumsum(np.exp(spacing))]) / np.sum(np.exp(spacing))
        stations[-1] = x[-1]
        gentle = len(spacing) < 2 or float(np.max(np.abs(np.diff(spacing)))) < np.log(1.7)
        if gentle:
            return np.asarray(stations)
        padded = np.concatenate([spacing[:1], spacing, spacing[-1:]])
        spacing = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    return np.linspace(x[0], x[-1], count + 1)


def _line(start: float, end: float, knots: Array) -> Array:
    """Control heights of a straight edge from start to end (Greville points)."""
    count = len(knots) - DEGREE - 1
    greville = np.array([np.mean(knots[k + 1 : k + DEGREE + 1]) for k in range(count)])
    return start + (end - start) * greville


@dataclass(frozen=True)
class _End:
    """How the hull ends: the station and, for a sharp end, the bottom of its edge; None for a flat open end."""

    x: float
    bottom: float | None


def _end(table: HalfBreadths, stations: Sequence[_Station], forward: bool, draft: float) -> _End:
    """The end of the body beyond its last station with a section."""
    near, next_one = (stations[-1], stations[-2]) if forward else (stations[0], stations[1])
    index = int(np.searchsorted(table.x, near.x)) + (1 if forward else -1)
    if index < 0 or index >= len(table.x):
        return _End(near.x, None)
    rising = _overhang(table, index, near, next_one, draft)
    if rising is not None:
        return _End(rising, draft)
    width, next_width = (float(np.max(s.points[:, 0])) for s in (near, next_one))
    x = _closing(np.array([table.x[index], near.x, next_one.x]), np.array([width, next_width]))
    slope = (near.points[0, 1] - next_one.points[0, 1]) / (near.x - next_one.x)
    bottom = float(np.clip(near.points[0, 1] + slope * (x - near.x), table.z[0], draft))
    return _End(x, bottom)


def _overhang(table: HalfBreadths, index: int, near: _Station, next_one: _Station, draft: float) -> float | None:
    """Where a profile that rises out of the water (counter, cruiser stern, raked bow) passes the waterline.

    Args:
        table, draft: the hull.
        index: the station beyond the last one in the water.
        near, next_one: the last two stations in the water.

    Returns:
        x on the straight line between the profile's heights at both stations; None where the profile does not rise to
        that station or the hull does not go on above the water.
    """
    positive = np.flatnonzero(table.y[index] > 0.0)
    bottom = float(near.points[0, 1])
    if len(positive) == 0 or positive[0] == 0 or bottom <= float(next_one.points[0, 1]):
        return None
    first = int(positive[0])
    second = min(first + 1, len(table.z) - 1)
    above = _closing(table.z[[first - 1, first, second]], table.y[index, [first, second]])
    if above <= draft or bottom >= draft:
        return None
    return float(near.x + (table.x[index] - near.x) * (draft - bottom) / (above - bottom))


def _with_post(section: Array, draft: float) -> tuple[Array, float]:
    """A submerged section continued up the centreline to the waterline, and the chord fraction where it closes."""
    top = float(section[-1, 1])
    if top > draft * (1.0 - 2e-3):
        return np.vstack([section[:-1], [[0.0, draft]]]), 1.0
    post = np.column_stack([np.zeros(6), np.linspace(top, draft, 7)[1:]])
    whole = Section(0.0, np.vstack([section, post]))
    return whole.points, float(whole.chord_fractions()[len(section) - 1])


@dataclass(frozen=True, eq=False)
class UnderwaterFit:
    """Patches below the waterline, how their girths correspond, and their flat open ends."""

    fits: dict[str, PatchFit]
    girth: dict[str, tuple[str, float, float]]
    caps: list[tuple[str, str]]


def _present_stations(table: HalfBreadths, draft: float) -> list[_Station]:
    found = [_station(float(x), table.z, row, draft) for x, row in zip(table.x, table.y, strict=True)]
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


def _aperture(stations: Sequence[_Station]) -> int | None:
    """Index of the foremost station with a skeg below an aperture, where at least three of them follow each other."""
    split = [k for k, s in enumerate(stations[: len(stations) // 2]) if s.skeg is not None]
    if len(split) < 3 or split[-1] - split[0] + 1 != len(split):
        return None
    return split[-1]


def _stern_post(stations: Sequence[_Station], aft: int) -> int | None:
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


def _row_zero_from(knots: Array, start: float) -> int:
    """First control point of those whose basis functions live at or above the knot ``start``."""
    if start >= 1.0:
        return len(knots) - DEGREE - 2
    return int(np.searchsorted(knots, start)) - DEGREE


def _pin_end(fixed_y: Array, fixed_z: Array, row: int, end: _End, draft: float, knots: Array) -> bool:
    """Fixes a sharp end's edge on the centreplane; false for a flat open end."""
    if end.bottom is None:
        return False
    fixed_y[row], fixed_z[row] = 0.0, _line(end.bottom, draft, knots)
    return True


@one_blas_thread()
def fit_underwater(table: HalfBreadths, draft: float) -> UnderwaterFit:
    """The patches below the waterline: main, and where the table has them counter with skeg, and bulb.

    Raises:
        InputError: the hull has too few stations in the water.
    """
    stations = _present_stations(table, draft)
    floating = [k for k, station in enumerate(stations) if station.surface]
    aft, forward = floating[0], floating[-1]
    opening = _aperture(stations)
    pillar = _stern_post(stations, aft) if opening is None else None
    border = opening if opening is not None else pillar
    first = aft if border is None else border
    sections = [Section(s.x, s.points) for s in stations[first : forward + 1] if s.surface]
    rows = int(np.sum(table.z < draft))
    interior = list(np.linspace(0.0, 1.0, int(np.clip(rows, 8, 22)) + 1)[1:-1])
    ahead = stations[forward + 1 :]
    bulb_part = 0.0
    if len(ahead) >= 2:
        points, bulb_part = _with_post(ahead[0].points, draft)
        sections.append(Section(ahead[0].x, points))
        fore_end = _End(ahead[0].x, None)
        if bulb_part < 1.0:
            interior = sorted([k for k in interior if abs(k - bulb_part) > 0.02] + [bulb_part])
    else:
        fore_end = _end(table, stations[first : forward + 1], True, draft)
    post = (0.0, 0.0)
    if opening is not None:
        points, post = _with_aperture(stations[opening])
        low, high = post
        interior = sorted([k for k in interior if not low - 0.02 < k < high + 0.02] + [low, high])
    elif pillar is not None:
        points, post = _above_post(stations[pillar], float(stations[pillar + 1].points[0, 1]))
        interior = sorted([k for k in interior if abs(k - post[1]) > 0.02] + [post[1]])
    if border is None:
        aft_end = _end(table, stations[aft : forward + 1], False, draft)
    else:
        sections[0] = Section(stations[border].x, points)
        aft_end = _End(stations[border].x, None)
    knots = knots_at(interior)
    x = np.unique(np.concatenate([[aft_end.x], [s.x for s in sections], [fore_end.x]]))
    station_map = StationMap.through(_smooth_knots(x, MOST_SPANS).tolist(), False, False)
    fixed_y, fixed_z = free_net(station_map, knots)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, draft
    caps: list[tuple[str, str]] = []
    # On a post every basis function is zero in y: the edge lies in the centreplane there, exactly.
    if bulb_part > 0.0:
        fixed_y[-1, _row_zero_from(knots, bulb_part) :] = 0.0
    elif not _pin_end(fixed_y, fixed_z, -1, fore_end, draft, knots):
        caps.append(("main", "last"))
    if opening is not None:
        at = int(np.searchsorted(knots, post[0], side="right")) - 1
        fixed_y[0, at - DEGREE : at + 1] = 0.0
    elif pillar is not None:
        fixed_y[0, : int(np.searchsorted(knots, post[1]))] = 0.0
    elif not _pin_end(fixed_y, fixed_z, 0, aft_end, draft, knots):
        caps.append(("main", "first"))
    least = 1e-7 * float(table.x[-1] - table.x[0])
    heights = (float(table.z[0]) - HEIGHT_ROOM * draft, draft)
    fits = {"main": fit_patch(sections, station_map, knots, fixed_y, fixed_z, **FIT, least_half_breadth=least,
                              heights=heights)}  # fmt: skip
    girth = {"main": ("main", 0.0, 1.0)}
    net = fits["main"].surface.control_points
    if bulb_part > 0.0:
        fits["bulb"], flat = _fit_bulb(table, ahead, draft, knots, net[-1], bulb_part, least)
        girth["bulb"] = ("main", 0.0, bulb_part)
        caps += [("bulb", "last")] if flat else []
    if border is not None:
        girth["counter"] = ("main", post[1], 1.0)
        end = _end(table, stations[aft : border + 2], False, draft)
        above = stations[aft:border] or stations[border : border + 1]
        fits["counter"] = _fit_counter(above, end, draft, knots, net[0], post[1], least)
        caps += [("counter", "first")] if end.bottom is None else []
    if opening is not None:
        girth["skeg"] = ("main", 0.0, post[0])
        fits["skeg"] = _fit_skeg([s for s in stations[:opening] if s.skeg is not None], knots, net[0], post[0], least)
        caps.append(("skeg", "first"))
    return UnderwaterFit(fits, girth, caps)


def _with_aperture(station: _Station) -> tuple[Array, tuple[float, float]]:
    """Skeg, post and counter of one station as one section, and the chord fractions where the post begins and ends."""
    if station.skeg is None:
        raise ValueError("no aperture here")
    low, high = station.skeg[-1, 1], station.points[0, 1]
    post = np.column_stack([np.zeros(5), np.linspace(low, high, 7)[1:-1]])
    whole = Section(station.x, np.vstack([station.skeg, post, station.points]))
    fractions = whole.chord_fractions()
    first = len(station.skeg) - 1
    return whole.points, (float(fractions[first]), float(fractions[first + 6]))


def _above_post(station: _Station, keel: float) -> tuple[Array, tuple[float, float]]:
    """A post from the keel up to the station's section, both as one section, and the chord fractions of the post."""
    high = float(station.points[0, 1])
    post = np.column_stack([np.zeros(6), np.linspace(keel, high, 7)[:-1]])
    whole = Section(station.x, np.vstack([post, station.points]))
    return whole.points, (0.0, float(whole.chord_fractions()[6]))


def _fit_counter(
    stations: Sequence[_Station], end: _End, draft: float, knots: Array, edge: Array, start: float, least: float
) -> PatchFit:
    """The patch above the aperture, on to the aft end of the waterline."""
    knots_c, border = edge_segment(knots, edge, start, 1.0, np.array([]))
    x = np.unique([end.x, *(s.x for s in stations), float(border[0, 0])])
    station_map = StationMap.through(_smooth_knots(x, MOST_SPANS).tolist(), False, False)
    fixed_y, fixed_z = free_net(station_map, knots_c)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, draft
    _pin_end(fixed_y, fixed_z, 0, end, draft, knots_c)
    fixed_y[-1], fixed_z[-1] = border[:, 1], border[:, 2]
    sections = [Section(s.x, s.points) for s in stations]
    lowest = min(float(np.min(border[:, 2])), *(float(np.min(s.points[:, 1])) for s in stations))
    return fit_patch(sections, station_map, knots_c, fixed_y, fixed_z, **FIT, least_half_breadth=least, edge=border,
                     heights=(lowest - HEIGHT_ROOM * draft, draft))  # fmt: skip


def _fit_skeg(stations: Sequence[_Station], knots: Array, edge: Array, end: float, least: float) -> PatchFit:
    """The patch below the aperture; its aft end is flat."""
    knots_s, border = edge_segment(knots, edge, 0.0, end, np.linspace(0.15, 0.85, 6))
    sections = [Section(s.x, s.skeg) for s in stations if s.skeg is not None]
    x = np.array([*(s.x for s in sections), float(border[0, 0])])
    station_map = StationMap.through(_smooth_knots(x, MOST_SPANS).tolist(), False, False)
    fixed_y, fixed_z = free_net(station_map, knots_s)
    fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
    fixed_y[-1], fixed_z[-1] = border[:, 1], border[:, 2]
    return fit_patch(sections, station_map, knots_s, fixed_y, fixed_z, **FIT, least_half_breadth=least, edge=border)


def _fit_bulb(
    table: HalfBreadths, rest: Sequence[_Station], draft: float, knots: Array, edge: Array, part: float, least: float
) -> tuple[PatchFit, bool]:
    """The patch of the submerged stations at the bow; true where it ends flat instead of in a point."""
    knots_b, border = edge_segment(knots, edge, 0.0, part, np.array([]))
    near = rest[-1]
    index = int(np.searchsorted(table.x, near.x)) + 1
    pointed = index < len(table.x)
    x = [s.x for s in rest]
    if pointed:
        x.append(float(table.x[index]))
    station_map = StationMap.through(_smooth_knots(np.array(x), MOST_SPANS).tolist(), False, pointed)
    fixed_y, fixed_z = free_net(station_map, knots_b)
    fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
    fixed_y[0], fixed_z[0] = border[:, 1], border[:, 2]
    if pointed:
        fixed_y[-1], fixed_z[-1] = 0.0, near.points[int(np.argmax(near.points[:, 0])), 1]
    sections = [Section(s.x, s.points) for s in rest]
    lowest, highest = (find(float(find(s.points[:, 1])) for s in rest) for find in (min, max))
    room = HEIGHT_ROOM * draft
    fit = fit_patch(sections, station_map, knots_b, fixed_y, fixed_z, **FIT, least_half_breadth=least, edge=border,
                    heights=(lowest - room, min(highest + room, draft)))  # fmt: skip
    return fit, not pointed


def fit_topsides(
    table: HalfBreadths, main: NurbsSurface, draft: float, neighbour: Array | None = None
) -> tuple[PatchFit, float]:
    """Sides above the waterline over one patch: from the table where it reaches higher, else upright walls.

    Args:
        table, draft: the hull.
        main: the patch below, whose edge v = 1 the sides continue.
        neighbour: control points of the edge at the patch's fore end, where another patch of sides begins.

    Returns:
        The fit and the height of the deck.
    """
    station_map = StationMap(main.knots_u, main.control_points[:, 0, 0])
    knots = knots_at([0.25, 0.5, 0.75])
    fixed_y, fixed_z = free_net(station_map, knots)
    edge = main.control_points[:, -1, 1]
    above = table.z[table.z > draft * 1.001]
    walls = len(above) < 2
    height = draft * (1.0 + WALL_HEIGHT_TO_DRAFT) if walls else float(above[-1])
    fixed_y[:, 0], fixed_z[:] = edge, _line(draft, height, knots)[None, :]
    if walls:
        fixed_y[:] = edge[:, None]
    low, high = float(main.control_points[0, 0, 0]), float(main.control_points[-1, 0, 0])
    sections = []
    # A patch shorter than the spacing has only the stations at its ends.
    inside = (table.x > low) & (table.x < high)
    if not np.any(inside):
        inside = np.abs(table.x - high) < 1e-9 * (table.x[-1] - table.x[0])
    for x, row, taken in zip(table.x, table.y, inside, strict=True):
        if taken:
            at = float(main.evaluate(station_map.u(np.array([x])), np.array([1.0]))[0, 0, 1])
            widths = np.interp(above, table.z, row) if not walls else np.array([at])
            heights = above if not walls else np.array([height])
            sections.append(Section(float(x), np.vstack([[at, draft], np.column_stack([widths, heights])])))
    for end in (0, -1):
        if np.all(main.control_points[end, :, 1] == 0.0):
            fixed_y[end] = 0.0
    if neighbour is not None:
        fixed_y[-1] = neighbour[:, 1]
    fit = fit_patch(sections, station_map, knots, fixed_y, fixed_z, smoothing=5e-3,
                    least_half_breadth=0.0, rounds=0)  # fmt: skip
    return fit, height


def _boss(main: dict[str, PatchFit], height: float) -> float:
    """Where the aft profile meets the shaft's height: the foremost place for a hub without cutting the hull."""
    best = np.inf
    for fit in main.values():
        u = np.linspace(0.0, 1.0, 401)
        points = fit.surface.evaluate(u, np.linspace(0.0, 1.0, 81))
        inside = (points[:, 0, 2] <= height) & (points[:, -1, 2] >= height)
        if np.any(inside):
            best = min(best, float(points[inside][0, 0, 0]))
    return best if np.isfinite(best) else float(min(f.surface.control_points[0, 0, 0] for f in main.values()))


@one_blas_thread()
def parent_from_table(table: HalfBreadths, length: float, draft: float) -> ParentHull:
    """A parent hull with its fit report.

    The shaft stands at 5.0/14.5 of the draft, the boss ends where the aft profile meets that height. Sections may move
    between 2.5 % of the body's length forward of the boss and 2 % aft of the fore end of the waterline, about the
    middle of the fullest sections.

    Raises:
        InputError: the table cannot be made into a hull.
    """
    try:
        under = fit_underwater(table, draft)
        fits, girth, caps = under.fits, dict(under.girth), list(under.caps)
        sides, deck = fit_topsides(table, fits["main"].surface, draft)
        topsides = {"topsides": sides.surface}
        along = {"topsides": "main"}
        if "counter" in fits:
            edge = sides.surface.control_points[0]
            topsides["topsides_aft"] = fit_topsides(table, fits["counter"].surface, draft, edge)[0].surface
            along["topsides_aft"] = "counter"
            girth["topsides_aft"] = ("topsides", 0.0, 1.0)
    except (ValueError, np.linalg.LinAlgError) as problem:
        raise InputError(f"{table.name}: no smooth surface through these stations ({problem})") from problem
    main = fits["main"].surface
    aftmost = "topsides_aft" if "counter" in fits else "topsides"
    for name, end, row in ((aftmost, "first", 0), ("topsides", "last", -1)):
        if float(np.max(topsides[name].control_points[row, :, 1])) > 1e-6 * length:
            caps.append((name, end))
    underwater = {name: fit.surface for name, fit in fits.items()}
    shaft = SHAFT_HEIGHT_TO_DRAFT * draft
    boss = _boss(fits, shaft) if "skeg" not in fits else float(fits["skeg"].surface.control_points[0, 0, 0])
    # At the draft itself too, which may lie between two waterlines of the table.
    found = [_station(float(x), table.z, row, draft) for x, row in zip(table.x, table.y, strict=True)]
    breadth = 2.0 * max(float(np.max(station.points[:, 0])) for station in found if station is not None)
    first = min(float(fit.surface.control_points[0, 0, 0]) for fit in fits.values())
    last = float(main.control_points[-1, 0, 0])
    body = last - first
    aft, forward = max(boss, float(main.control_points[0, 0, 0])) + 0.025 * body, last - 0.02 * body
    rough = ParentHull(
        name=table.name, length=length, breadth=breadth, draft=draft, deck_height=deck, shaft_height=shaft,
        boss_end_x=boss, shift_frame=ShiftFrame(aft, 0.5 * (aft + forward), forward, length),
        underwater=underwater, topsides=topsides, caps=tuple(caps),
        girth=girth, along=along, source=f"fitted to {table.name}",
    )  # fmt: skip
    quadrature = rough.quadrature
    full = quadrature.curve_x[quadrature.curve_area > 0.995 * quadrature.largest_area]
    middle = float(np.clip(0.5 * (full[0] + full[-1]), aft + 0.3 * (forward - aft), aft + 0.7 * (forward - aft)))
    report = FitReport(
        table.name,
        tuple(PatchDeviation(name, fit.surface.weights.shape, **fit.summary()) for name, fit in fits.items()),
        _table_volume(table, draft),
        float(np.sum(quadrature.area * quadrature.width)),
    )
    frame = ShiftFrame(aft, middle, forward, length)
    return replace(rough, shift_frame=frame, fit_report=report, warnings=_flat_ends(rough), _points={})


def _flat_ends(parent: ParentHull) -> tuple[str, ...]:
    """A line for every flat end in the water that is no boss: what level 1 cannot see there."""
    lines = []
    least = LEAST_FLAT_END * parent.quadrature.largest_area
    for name, end in parent.caps:
        if name in parent.topsides or name == "skeg":
            continue
        u = np.array([0.0 if end == "first" else 1.0])
        area = float(sectional_areas(parent.surface(name), u)[0])
        if area < least:
            continue
        x = parent.extent(name)[0 if end == "first" else 1]
        lines.append(
            f"{parent.name} ends in a flat face of {area:.3g} m2 in the water at x = {x:.4g} m: thin-ship theory "
            "(level 1) takes no waves from it, and it is no part of the wetted surface"
        )
    return tuple(lines)


def _table_volume(table: HalfBreadths, draft: float) -> float:
    """Displaced volume of the bare table by the trapezoidal rule, m3."""
    z = np.append(table.z[table.z < draft], draft)
    y = np.array([np.interp(z, table.z, row) for row in table.y])
    return float(2.0 * np.trapezoid(np.trapezoid(y, z, axis=1), table.x))
