"""Parent hulls from a user's own table of offsets or closed mesh."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
from scipy import ndimage

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.fit_table import parent_from_table
from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.hull.table_stations import HalfBreadths
from hpsop_core.typing_aliases import Array

COLUMNS = ("station_x_m", "waterline_z_m", "half_breadth_m")
UNITS = {"m": 1.0, "mm": 0.001, "cm": 0.01, "ft": 0.3048, "in": 0.0254}
FEWEST_STATIONS, FEWEST_WATERLINES = 7, 5
# Largest distance of a point from the fitted surface, as a part of the breadth; sound tables stay below 0.5 %.
LARGEST_DEVIATION = 0.015
# A reading further than this from all its neighbours, as a part of the greatest half-breadth, is a slip of the pen.
LARGEST_DENT = 0.05
# How far the surface may pass the table's heights and breadths between the points, as a part of the draft.
LARGEST_SWING = 0.03
STL_STATIONS, STL_WATERLINES, STL_ABOVE = 121, 33, 8


def _checked_dimensions(name: str, length: float, draft: float) -> None:
    for field, value in (("length", length), ("draft", draft)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name}: {field} must be a positive number of metres, not {value}")


def _rows(path: Path) -> list[tuple[int, float, float, float]]:
    """Line number, station, waterline and half-breadth of every row, checked one by one."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{path}: cannot be read as a text file ({problem})") from problem
    numbered = enumerate(text.splitlines(), 1)
    lines = [(number, line) for number, line in numbered if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise InputError(f"{path.name}: the file is empty; the first line must be {','.join(COLUMNS)}")
    header = [cell.strip() for cell in next(csv.reader([lines[0][1]]))]
    missing = [column for column in COLUMNS if column not in header]
    if missing:
        raise InputError(
            f"{path.name} row {lines[0][0]}: column '{missing[0]}' is missing; the first line must be "
            f"{','.join(COLUMNS)}"
        )
    places = [header.index(column) for column in COLUMNS]
    rows = []
    for number, line in lines[1:]:
        cells = next(csv.reader([line]))
        values = []
        for column, place in zip(COLUMNS, places, strict=True):
            cell = cells[place].strip() if place < len(cells) else ""
            try:
                value = float(cell)
            except ValueError:
                raise InputError(f"{path.name} row {number}: {column} is '{cell}', a number is needed") from None
            if not math.isfinite(value):
                raise InputError(f"{path.name} row {number}: {column} is {cell}, a finite number is needed")
            values.append(value)
        if values[2] < 0.0:
            raise InputError(
                f"{path.name} row {number}: half_breadth_m is {values[2]:g}; give the port side, zero or positive"
            )
        rows.append((number, values[0], values[1], values[2]))
    return rows


def _grid(name: str, rows: list[tuple[int, float, float, float]]) -> tuple[Array, Array, Array, dict[float, int]]:
    """The rows as a rectangular table; also the line where each station begins."""
    begins: dict[float, int] = {}
    blocks: list[list[tuple[int, float, float, float]]] = []
    for row in rows:
        if not blocks or row[1] != blocks[-1][-1][1]:
            if row[1] in begins:
                raise InputError(
                    f"{name} row {row[0]}: station {row[1]:g} m appears again after another one; sort rows by station"
                )
            if blocks and row[1] < blocks[-1][-1][1]:
                raise InputError(
                    f"{name} row {row[0]}: station {row[1]:g} m comes after {blocks[-1][-1][1]:g} m; "
                    "sort stations rising"
                )
            begins[row[1]] = row[0]
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
    if len(blocks) < FEWEST_STATIONS:
        raise InputError(f"{name}: {len(blocks)} stations; at least {FEWEST_STATIONS} are needed")
    heights = sorted({row[2] for row in rows})
    for block in blocks:
        if len(block) != len(heights):
            present = {row[2] for row in block}
            lacking = next(z for z in heights if z not in present)
            last = block[-1][0]
            raise InputError(
                f"{name} row {last}: station {block[0][1]:g} m has no half-breadth at waterline {lacking:g} m; "
                "every station needs every waterline (0 where there is no hull)"
            )
    if len(heights) < FEWEST_WATERLINES:
        raise InputError(f"{name}: {len(heights)} waterlines; at least {FEWEST_WATERLINES} are needed")
    y = np.array([[row[3] for row in block] for block in blocks])
    return np.array([block[0][1] for block in blocks]), np.array(heights), y, begins


def _check_size(name: str, x: Array, z: Array, y: Array, length: float, draft: float, where: dict[float, int]) -> None:
    """Lengths that cannot belong together: units, draft, length."""

    def row_of(k: int) -> str:
        return f" row {where[float(x[k])]}" if float(x[k]) in where else ""

    whole = float(x[-1] - x[0])
    if not 0.5 * length < whole < 2.0 * length:
        raise InputError(
            f"{name}{row_of(len(x) - 1)}: the stations span {whole:g} m but the length is {length:g} m; the table must "
            "be in metres (no millimetres or feet) and is never scaled"
        )
    if draft > z[-1] * (1.0 + 1e-9):
        raise InputError(f"{name}: the draft {draft:g} m is above the highest waterline {z[-1]:g} m of the table")
    wet = y[:, z <= draft]
    if not np.any(wet > 0.0):
        raise InputError(f"{name}: no half-breadth below the draft {draft:g} m is positive")
    in_water = np.flatnonzero(np.max(wet, axis=1) > 0.0)
    span = float(x[min(in_water[-1] + 1, len(x) - 1)] - x[max(in_water[0] - 1, 0)])
    if not 0.75 * length < span < 1.35 * length:
        raise InputError(
            f"{name}{row_of(int(in_water[-1]))}: the stations in the water span {span:g} m but the length is "
            f"{length:g} m; the table must be in metres and is never scaled: is the draft right?"
        )
    widest = int(np.argmax(np.max(wet, axis=1)))
    half = float(np.max(wet))
    if not 0.005 * length < half < 0.5 * length:
        raise InputError(
            f"{name}{row_of(widest)}: a half-breadth of {half:g} m does not fit a length of {length:g} m; "
            "the table must be in metres"
        )
    if not 0.002 * length < draft < 0.5 * length:
        raise InputError(f"{name}: a draft of {draft:g} m does not fit a length of {length:g} m; both are in metres")
    if abs(z[0]) > 0.25 * draft:
        raise InputError(f"{name}: the lowest waterline is at {z[0]:g} m; heights are counted from the baseline, z = 0")
    if float(x[in_water[0]]) > 0.25 * length or float(x[in_water[0]]) < -0.25 * length:
        raise InputError(
            f"{name}{row_of(int(in_water[0]))}: the hull begins at x = {x[in_water[0]]:g} m; "
            "the aft perpendicular is at x = 0"
        )
    below = int(np.sum(z < draft))
    if below < FEWEST_WATERLINES - 1:
        raise InputError(f"{name}: only {below} waterlines below the draft {draft:g} m; at least 4 are needed")


def _check_points(name: str, x: Array, z: Array, y: Array, begins: dict[float, int]) -> None:
    """Holes in the side and single readings that stand out: what no hull has, told by the row.

    A hole is a region of zero readings with hull all round it; an aperture is open towards the stern. A reading stands
    out where it is larger, or smaller, than all four neighbours by ``LARGEST_DENT`` of the greatest half-breadth.
    """
    regions, count = ndimage.label(y == 0.0)
    border = set(np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]]).tolist())
    for region in range(1, count + 1):
        if region not in border:
            i, k = (int(value[0]) for value in np.nonzero(regions == region))
            raise InputError(
                f"{name} row {begins[float(x[i])] + k}: a hole: half_breadth_m is 0 at station {x[i]:g} m, waterline "
                f"{z[k]:g} m, with hull all round it; give the half-breadth there"
            )
    inner = y[1:-1, 1:-1]
    around = np.stack([y[:-2, 1:-1], y[2:, 1:-1], y[1:-1, :-2], y[1:-1, 2:]])
    out = np.maximum(inner - around.max(axis=0), around.min(axis=0) - inner)
    i, k = (int(value) for value in np.unravel_index(int(np.argmax(out)), out.shape))
    if out[i, k] > LARGEST_DENT * float(np.max(y)):
        raise InputError(
            f"{name} row {begins[float(x[i + 1])] + k + 1}: half_breadth_m {inner[i, k]:g} at station {x[i + 1]:g} m, "
            f"waterline {z[k + 1]:g} m stands out from all its neighbours ({around[:, i, k].min():g} to "
            f"{around[:, i, k].max():g} m); correct it"
        )


def parent_hull_from_offsets(path: Path | str, length: float, draft: float) -> ParentHull:
    """A parent hull fitted to a table of offsets.

    Args:
        path: CSV with the columns station_x_m, waterline_z_m, half_breadth_m (others are ignored), lines that begin
            with # are comments; metres, x forward from AP, z up from the baseline; every station with every waterline,
            both rising. The lowest row holds the flat of bottom.
        length: between perpendiculars, m; the table is not scaled to it.
        draft: waterline above z = 0, m.

    Raises:
        InputError: one line that names the row and the remedy.
    """
    path = Path(path)
    _checked_dimensions(path.name, length, draft)
    x, z, y, begins = _grid(path.name, _rows(path))
    _check_size(path.name, x, z, y, length, draft, begins)
    _check_points(path.name, x, z, y, begins)
    parent = parent_from_table(HalfBreadths(path.name, x, z, y), length, draft)
    _check_fit(parent, path.name, x, z, begins)
    _check_between(parent, path.name, x, z, begins)
    return parent


def _check_between(parent: ParentHull, name: str, x: Array, z: Array, begins: dict[float, int]) -> None:
    """Between the points, where no reading speaks, the surface must stay within the table's heights and breadths."""
    grid = np.linspace(0.0, 1.0, 101)
    room = LARGEST_SWING * parent.draft
    half = 0.5 * parent.breadth
    for patch, surface in parent.underwater.items():
        points = surface.evaluate(grid, grid)
        for beyond, what in (
            (float(z[0]) - points[..., 2], "below the lowest waterline"),
            (points[..., 2] - parent.draft, "above the draft"),
            (points[..., 1] - half, "outside the greatest half-breadth"),
        ):
            if float(beyond.max()) > room:
                place = points[np.unravel_index(int(np.argmax(beyond)), beyond.shape)]
                station = float(x[np.argmin(np.abs(x - place[0]))])
                row = f" row {begins[station]}" if station in begins else ""
                remedy = "add stations there" if begins else "is x forward, z up, and the draft right?"
                raise InputError(
                    f"{name}{row}: near station {station:g} m the smooth surface ({patch}) swings "
                    f"{float(beyond.max()):.3g} m {what} between the points; {remedy}"
                )


def _check_fit(parent: ParentHull, name: str, x: Array, z: Array, begins: dict[float, int]) -> None:
    """A half-breadth far off the smooth surface through its neighbours is a slip of the pen, not a hull."""
    if parent.fit_report is None:
        return
    worst = max(parent.fit_report.patches, key=lambda patch: patch.max_m)
    if worst.max_m > LARGEST_DEVIATION * parent.breadth:
        station = float(x[np.argmin(np.abs(x - worst.max_at_x_m))])
        level = int(np.argmin(np.abs(z - worst.max_at_z_m)))
        raise InputError(
            f"{name} row {begins[station] + level}: the point at station {station:g} m, waterline {z[level]:g} m lies "
            f"{worst.max_m:.3g} m off the smooth surface through its neighbours; correct it or add stations there"
        )


def parent_hull_from_stl(path: Path | str, unit: str, draft: float, length: float) -> ParentHull:
    """A parent hull fitted to slices of a closed mesh.

    Args:
        path: an STL in ship axes: x forward from AP, y to port, z up from the baseline.
        unit: m, mm, cm, ft or in.
        draft, length: of the hull in metres, as for `parent_hull_from_offsets`.

    Raises:
        InputError: not a mesh, open, of another size, or with sections that are not single-valued.
    """
    import trimesh

    path = Path(path)
    if unit not in UNITS:
        raise InputError(f"{path.name}: unit '{unit}' is unknown; choose one of {', '.join(UNITS)}")
    _checked_dimensions(path.name, length, draft)
    try:
        mesh = trimesh.load(path, force="mesh")
    except Exception as problem:
        raise InputError(f"{path.name}: cannot be read as a mesh ({problem})") from problem
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise InputError(f"{path.name}: holds no triangles; give a closed STL of the hull")
    mesh.merge_vertices()
    if not mesh.is_watertight:
        edges = np.sort(mesh.edges, axis=1)
        _, counts = np.unique(edges, axis=0, return_counts=True)
        raise InputError(f"{path.name}: the mesh has holes ({int(np.sum(counts != 2))} open edges); close it first")
    mesh = trimesh.Trimesh(mesh.vertices * UNITS[unit], mesh.faces, process=False)
    low, high = mesh.bounds
    if abs(low[1] + high[1]) > 0.02 * (high[1] - low[1]):
        raise InputError(
            f"{path.name}: y runs from {low[1]:g} to {high[1]:g} m; it must be symmetric about y = 0 "
            "(x forward, y to port, z up)"
        )
    if not 0.75 * length < high[0] - low[0] < 1.5 * length:
        raise InputError(
            f"{path.name}: the mesh is {high[0] - low[0]:g} m long in unit '{unit}' but the length is {length:g} m; "
            "state the mesh's own unit, or its length between perpendiculars"
        )
    if draft > high[2]:
        raise InputError(f"{path.name}: the draft {draft:g} m is above the mesh's top at {high[2]:g} m")
    x, z = _slice_axes(low, high, draft)
    triangles = np.asarray(mesh.triangles, dtype=np.float64)
    y = np.array([_half_breadths(triangles, float(station), z, draft, path.name) for station in x])
    _check_size(path.name, x, z, y, length, draft, {})
    parent = parent_from_table(HalfBreadths(path.name, x, z, y), length, draft)
    _check_between(parent, path.name, x, z, {})
    return parent


def _slice_axes(low: Array, high: Array, draft: float) -> tuple[Array, Array]:
    """Stations and heights for slicing: denser towards the ends and the keel."""
    t = np.linspace(0.0, 1.0, STL_STATIONS)
    x = low[0] + (high[0] - low[0]) * (t - 0.8 * np.sin(2.0 * np.pi * t) / (2.0 * np.pi))
    part = np.linspace(0.0, 1.0, STL_WATERLINES)
    z = max(float(low[2]), 0.0) + (draft - max(float(low[2]), 0.0)) * (0.35 * part**2 + 0.65 * part)
    if high[2] > 1.02 * draft:
        z = np.concatenate([z, np.linspace(draft, float(high[2]) * (1.0 - 1e-6), STL_ABOVE)[1:]])
    return x, z


def _half_breadths(triangles: Array, x: float, z: Array, draft: float, name: str) -> Array:
    """Half-breadths of one slice of triangles (n, 3, 3) at heights z, 0 outside."""
    along = triangles[:, :, 0] - x
    cut = triangles[(np.min(along, axis=1) < 0.0) & (np.max(along, axis=1) >= 0.0)]
    along = cut[:, :, 0] - x
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        crosses = (along[:, a] < 0.0) != (along[:, b] < 0.0)
        part = np.where(crosses, along[:, a] / np.where(crosses, along[:, a] - along[:, b], 1.0), np.nan)
        ends.append(cut[:, a, 1:] + part[:, None] * (cut[:, b, 1:] - cut[:, a, 1:]))
    # A plane cuts exactly two edges of a triangle; the third entry is NaN.
    pairs = np.stack(ends, axis=1)
    order = np.argsort(np.isnan(pairs[:, :, 0]), axis=1, kind="stable")[:, :2]
    segments = np.take_along_axis(pairs, order[:, :, None], axis=1)
    result = np.zeros_like(z)
    if len(segments) == 0:
        return result
    start, end = segments[:, 0], segments[:, 1]
    # The lowest row stands for the flat of bottom and is read just above it.
    reading = np.maximum(z, z[0] + 1e-3 * draft)
    reading = np.where(z >= 0.999 * float(np.max(z)), float(np.max(z)) - 1e-5 * draft, reading)
    for k, height in enumerate(reading):
        crossing = (start[:, 1] <= height) != (end[:, 1] <= height)
        if not np.any(crossing):
            continue
        a, b = start[crossing], end[crossing]
        y = a[:, 0] + (height - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        port = np.sort(y[y > 1e-6 * draft])
        if len(port) == 0:
            continue
        if len(port) > 1 and z[0] + 0.01 * draft < height <= draft and port[-1] - port[0] > 0.02 * draft:
            raise InputError(
                f"{name}: the section at x = {x:.4g} m crosses z = {height:.4g} m {len(port)} times on one side; "
                "tunnels, twin skegs and crossing faces are not supported"
            )
        result[k] = port[-1]
    return result
