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
from hpsop_core.geometry.form import ShiftFrame
from hpsop_core.geometry.hull import FitReport, ParentHull, PatchDeviation
from hpsop_core.geometry.hull_fit import (
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
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.typing_aliases import Array


class FitSettings(TypedDict):
    """What every fit to a table shares."""

    smoothing: float
    rounds: int


MOST_SPANS = 48
FIT: FitSettings = {"smoothing": 5e-3, "rounds": 3}
# Where a closing curve's last two values point to the zero reading of the table or beyond it, that reading is the end.
SNAP = 0.5
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
    """One station below the waterline: its section and whether it reaches the surface."""

    x: float
    points: Array
    surface: bool


def _station(x: float, z: Array, y: Array, draft: float) -> _Station | None:
    """The section of one station, or None where the hull is not below the waterline there."""
    below = z < draft * (1.0 - 1e-9)
    above = z > draft * (1.0 + 1e-9)
    at_draft = max(float(PchipInterpolator(z, y)(draft)), 0.0)
    heights = np.concatenate([z[below], [draft], z[above]])
    widths = np.concatenate([y[below], [at_draft], y[above]])
    count = int(np.sum(below)) + 1
    positive = np.flatnonzero(widths[:count] > 0.0)
    if len(positive) == 0:
        return None
    first, last = int(positive[0]), int(positive[-1])
    points: list[tuple[float, float]] = []
    if first == 0:
        points.append((0.0, float(heights[0])))
    else:
        second = min(first + 1, len(heights) - 1)
        points.append((0.0, _closing(heights[[first - 1, first, second]], widths[[first, second]])))
        if points[0][1] > draft * (1.0 - 1e-6):
            return None
    points += [(float(widths[k]), float(heights[k])) for k in range(first, last + 1)]
    surface = last == count - 1
    if not surface:
        second = max(last - 1, 0)
        points.append((0.0, _closing(heights[[last + 1, last, second]], widths[[last, second]])))
    return _Station(x, tidy_section(x, np.array(points), 1e-6 * draft).points, surface)


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
    width, next_width = (float(np.max(s.points[:, 0])) for s in (near, next_one))
    x = _closing(np.array([table.x[index], near.x, next_one.x]), np.array([width, next_width]))
    slope = (near.points[0, 1] - next_one.points[0, 1]) / (near.x - next_one.x)
    bottom = float(np.clip(near.points[0, 1] + slope * (x - near.x), table.z[0], draft))
    return _End(x, bottom)


def _with_post(section: Array, draft: float) -> tuple[Array, float]:
    """A submerged section continued up the centreline to the waterline, and the chord fraction where it closes."""
    top = float(section[-1, 1])
    if top > draft * (1.0 - 2e-3):
        return np.vstack([section[:-1], [[0.0, draft]]]), 1.0
    post = np.column_stack([np.zeros(6), np.linspace(top, draft, 7)[1:]])
    whole = Section(0.0, np.vstack([section, post]))
    return whole.points, float(whole.chord_fractions()[len(section) - 1])


def fit_underwater(table: HalfBreadths, draft: float) -> tuple[dict[str, PatchFit], dict[str, tuple[str, float, float]],
                                                               list[tuple[str, str]]]:  # fmt: skip
    """The patches below the waterline, how their girths correspond, and their flat open ends.

    Raises:
        InputError: the hull has too few stations in the water.
    """
    found = [_station(float(x), table.z, row, draft) for x, row in zip(table.x, table.y, strict=True)]
    present = [k for k, station in enumerate(found) if station is not None]
    stations = [station for station in found if station is not None]
    if len(stations) < 5:
        raise InputError(f"{table.name}: only {len(stations)} stations are below the draft, at least 5 are needed")
    if present[-1] - present[0] + 1 != len(present):
        gap = next(k for k in range(present[0], present[-1]) if k not in present)
        raise InputError(f"{table.name}: station {table.x[gap]:g} m has no breadth below the draft, its neighbours do")
    floating = [k for k, station in enumerate(stations) if station.surface]
    if len(floating) < 4:
        raise InputError(f"{table.name}: the hull reaches the draft at {len(floating)} stations only; check the draft")
    aft, forward = floating[0], floating[-1]
    ahead = stations[forward + 1 :]
    behind = stations[:aft]
    sections = [Section(s.x, s.points) for s in stations[aft : forward + 1] if s.surface]
    ends: dict[bool, _End] = {}
    posts: dict[bool, float] = {}
    for side, rest in ((True, ahead), (False, behind)):
        if len(rest) >= 2:
            border = rest[0] if side else rest[-1]
            points, part = _with_post(border.points, draft)
            posts[side] = part
            sections = [*sections, Section(border.x, points)] if side else [Section(border.x, points), *sections]
            ends[side] = _End(border.x, None)
        else:
            ends[side] = _end(table, stations[aft : forward + 1], side, draft)
    rows = int(np.sum(table.z < draft))
    interior = list(np.linspace(0.0, 1.0, int(np.clip(rows, 8, 22)) + 1)[1:-1])
    for part in [value for value in posts.values() if value < 1.0]:
        interior = sorted([k for k in interior if abs(k - part) > 0.02] + [part])
    knots = knots_at(interior)
    x = np.unique(np.concatenate([[ends[False].x], [s.x for s in sections], [ends[True].x]]))
    stations_map = StationMap.through(_smooth_knots(x, MOST_SPANS).tolist(), False, False)
    fixed_y, fixed_z = free_net(stations_map, knots)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, draft
    caps: list[tuple[str, str]] = []
    for side, row in ((True, -1), (False, 0)):
        bottom = ends[side].bottom
        if bottom is not None:
            fixed_y[row], fixed_z[row] = 0.0, _line(bottom, draft, knots)
        elif side in posts:
            # Every basis function that lives on the post is zero: the edge is in the centreplane there, exactly.
            first = len(knots) - DEGREE - 2 if posts[side] == 1.0 else int(np.searchsorted(knots, posts[side])) - DEGREE
            fixed_y[row, first:] = 0.0
        else:
            caps.append(("main", "last" if side else "first"))
    length = float(table.x[-1] - table.x[0])
    least = 1e-7 * length
    fits = {"main": fit_patch(sections, stations_map, knots, fixed_y, fixed_z, **FIT, least_half_breadth=least)}
    girth = {"main": ("main", 0.0, 1.0)}
    for side, rest, name in ((True, ahead, "bulb"), (False, behind, "stern_bulb")):
        if side in posts:
            edge = fits["main"].surface.control_points[-1 if side else 0]
            fit, cap = _fit_submerged(table, rest, side, knots, edge, posts[side], least)
            fits[name] = fit
            girth[name] = ("main", 0.0, posts[side])
            caps += [(name, "last" if side else "first")] if cap else []
    return fits, girth, caps


def _fit_submerged(
    table: HalfBreadths, rest: Sequence[_Station], forward: bool, knots: Array, edge: Array, part: float, least: float
) -> tuple[PatchFit, bool]:
    """The patch of the submerged stations at one end; true where it ends flat instead of in a point."""
    knots_b, border = edge_segment(knots, edge, 0.0, part, np.array([]))
    stations = [Section(s.x, s.points) for s in rest]
    near = rest[-1] if forward else rest[0]
    index = int(np.searchsorted(table.x, near.x)) + (1 if forward else -1)
    pointed = 0 <= index < len(table.x)
    x = [s.x for s in stations]
    if pointed:
        x = [*x, float(table.x[index])] if forward else [float(table.x[index]), *x]
    knot_stations = _smooth_knots(np.array(x), MOST_SPANS).tolist()
    station_map = StationMap.through(knot_stations, pointed and not forward, pointed and forward)
    fixed_y, fixed_z = free_net(station_map, knots_b)
    fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
    shared, end = (0, -1) if forward else (-1, 0)
    fixed_y[shared], fixed_z[shared] = border[:, 1], border[:, 2]
    if pointed:
        widest = near.points[int(np.argmax(near.points[:, 0])), 1]
        fixed_y[end], fixed_z[end] = 0.0, widest
    fit = fit_patch(stations, station_map, knots_b, fixed_y, fixed_z, **FIT, least_half_breadth=least, edge=border)
    return fit, not pointed


def fit_topsides(table: HalfBreadths, main: NurbsSurface, draft: float) -> tuple[PatchFit, float]:
    """Sides above the waterline over the main patch: from the table where it reaches higher, else upright walls."""
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
    for x, row in zip(table.x, table.y, strict=True):
        if low < x < high:
            at = float(main.evaluate(station_map.u(np.array([x])), np.array([1.0]))[0, 0, 1])
            widths = np.interp(above, table.z, row) if not walls else np.array([at])
            heights = above if not walls else np.array([height])
            sections.append(Section(float(x), np.vstack([[at, draft], np.column_stack([widths, heights])])))
    for end in (0, -1):
        if np.all(main.control_points[end, :, 1] == 0.0):
            fixed_y[end] = 0.0
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


def parent_from_table(table: HalfBreadths, length: float, draft: float) -> ParentHull:
    """A parent hull with its fit report.

    The shaft stands at 5.0/14.5 of the draft, the boss ends where the aft profile meets that height. Sections may move
    between 2.5 % of the body's length forward of the boss and 2 % aft of the fore end of the waterline, about the
    middle of the fullest sections.

    Raises:
        InputError: the table cannot be made into a hull.
    """
    try:
        fits, girth, caps = fit_underwater(table, draft)
        topsides, deck = fit_topsides(table, fits["main"].surface, draft)
    except (ValueError, np.linalg.LinAlgError) as problem:
        raise InputError(f"{table.name}: no smooth surface through these stations ({problem})") from problem
    main = fits["main"].surface
    for end, row in (("first", 0), ("last", -1)):
        if float(np.max(topsides.surface.control_points[row, :, 1])) > 1e-6 * length:
            caps.append(("topsides", end))
    underwater = {name: fit.surface for name, fit in fits.items()}
    shaft = SHAFT_HEIGHT_TO_DRAFT * draft
    boss = _boss(fits, shaft)
    breadth = 2.0 * float(np.max(table.y[:, table.z <= draft * (1.0 + 1e-9)]))
    first, last = float(main.control_points[0, 0, 0]), float(main.control_points[-1, 0, 0])
    body = last - first
    aft, forward = max(boss, first) + 0.025 * body, last - 0.02 * body
    rough = ParentHull(
        name=table.name, length=length, breadth=breadth, draft=draft, deck_height=deck, shaft_height=shaft,
        boss_end_x=boss, shift_frame=ShiftFrame(aft, 0.5 * (aft + forward), forward, length),
        underwater=underwater, topsides={"topsides": topsides.surface}, caps=tuple(caps),
        girth=girth, along={"topsides": "main"}, source=f"fitted to {table.name}",
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
    return replace(rough, shift_frame=frame, fit_report=report, _points={})


def _table_volume(table: HalfBreadths, draft: float) -> float:
    """Displaced volume of the bare table by the trapezoidal rule, m3."""
    z = np.append(table.z[table.z < draft], draft)
    y = np.array([np.interp(z, table.z, row) for row in table.y])
    return float(2.0 * np.trapezoid(np.trapezoid(y, z, axis=1), table.x))
