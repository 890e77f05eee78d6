"""Cross-sections of triangles: the table of half-breadths of a mesh."""

from __future__ import annotations

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.fit_table import LEAST_FLAT_END
from hpsop_core.geometry.hull.input.mesh import check_holes, without_appendages
from hpsop_core.geometry.hull.input.ship_table import ShipTable
from hpsop_core.geometry.hull.input.triangles import ShipTriangles
from hpsop_core.typing_aliases import Array

STATIONS, WATERLINES, ABOVE = 121, 33, 8
# A reading this part of the greatest half-breadth below all its neighbours fell into a crack between faces; it is read
# this part of the length beside it.
LEAST_DROP, CRACK = 0.005, 5e-4
# How far inside the end of the mesh a flat end is read, as a part of the length.
END = 1e-6
# Deeper than this part of the draft below the baseline there is a dome or a keel.
LEAST_DOME = 0.01


def slice_axes(low: Array, high: Array, draft: float) -> tuple[Array, Array]:
    """Stations and heights for slicing: denser towards the ends and the keel."""
    t = np.linspace(0.0, 1.0, STATIONS)
    x = low[0] + (high[0] - low[0]) * (t - 0.8 * np.sin(2.0 * np.pi * t) / (2.0 * np.pi))
    part = np.linspace(0.0, 1.0, WATERLINES)
    bottom = float(low[2])
    z = bottom + (draft - bottom) * (0.35 * part**2 + 0.65 * part)
    z[-1] = draft
    if bottom < -LEAST_DOME * draft:
        # The flat of bottom on the baseline, beside a dome or keel that goes deeper.
        z = np.unique(np.append(z, 0.0))
    if high[2] > 1.02 * draft:
        z = np.concatenate([z, np.linspace(draft, float(high[2]) * (1.0 - 1e-6), ABOVE)[1:]])
    return x, z


def sliced(mesh: ShipTriangles) -> ShipTable:
    """Half-breadths of a mesh on a grid of stations and heights.

    Raises:
        InputError: holes under water, sections that cross a height more than once on one side.
    """
    notes = [*mesh.notes, *check_holes(mesh)]
    triangles, left_out = without_appendages(mesh)
    notes += left_out
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    x, z = slice_axes(low, high, mesh.draft)
    order = np.argsort(triangles[:, :, 0].min(axis=1), kind="stable")
    triangles = triangles[order]
    begins, ends = triangles[:, :, 0].min(axis=1), triangles[:, :, 0].max(axis=1)

    def at(station: float, lift: float = 0.0) -> Array:
        candidates = int(np.searchsorted(begins, station, side="left"))
        return _half_breadths(triangles[:candidates][ends[:candidates] >= station], station, z, mesh, lift)

    y = np.array([at(float(station)) for station in x])
    # No triangle crosses the plane of the aftmost station; a transom that lies in it is read a hair before it.
    transom = at(float(x[0]) + END * mesh.length)
    wet = z <= mesh.draft * (1.0 + 1e-9)
    if np.trapezoid(transom[wet], z[wet]) > LEAST_FLAT_END * float(np.max(np.trapezoid(y[:, wet], z[wet], axis=1))):
        y[0] = np.maximum(y[0], transom)
    cracked = _dropouts(y)
    for k in np.flatnonzero(np.any(cracked, axis=1)):
        station, aside, up = float(x[k]), CRACK * mesh.length, CRACK * mesh.draft
        around = np.stack([at(station - aside), at(station + aside), at(station, -up), at(station, up)])
        pairs = np.stack([around[:2], around[2:]])
        means = np.where(pairs.min(axis=1) > 0.0, pairs.mean(axis=1), 0.0).max(axis=0)
        mended = np.where(means > 0.0, means, around.max(axis=0))
        y[k] = np.where(cracked[k], np.maximum(y[k], mended), y[k])
    # Above the water the sides go on over holes, open decks and a sheer line: only their shape near the water counts.
    for k in np.flatnonzero(z > mesh.draft * (1.0 + 1e-9)):
        y[:, k] = np.where((y[:, k] == 0.0) & (y[:, k - 1] > 0.0), y[:, k - 1], y[:, k])
    return ShipTable(
        name=mesh.name, layout=mesh.layout, unit=mesh.unit, x=x, z=z, y=y, rows=None, length=mesh.length,
        draft=mesh.draft, axes=mesh.axes, notes=tuple(notes), station_name=lambda place: f"x = {place:.5g} m",
    )  # fmt: skip


def _dropouts(y: Array) -> Array:
    """Readings that fell into a crack between faces: far smaller than the neighbours on all four sides."""
    found = np.zeros(y.shape, dtype=bool)
    around = np.stack([y[:-2, 1:-1], y[2:, 1:-1], y[1:-1, :-2], y[1:-1, 2:]])
    found[1:-1, 1:-1] = y[1:-1, 1:-1] < around.min(axis=0) - LEAST_DROP * float(np.max(y))
    ends = np.minimum(y[:-2], y[2:]) - LEAST_DROP * float(np.max(y))
    for column in (0, -1):
        found[1:-1, column] = (y[1:-1, column] == 0.0) & (ends[:, column] > 0.0)
    return found


def _half_breadths(cut: Array, x: float, z: Array, mesh: ShipTriangles, lift: float) -> Array:
    """Half-breadths of the triangles (n, 3, 3) that the station cuts, at heights z + lift, 0 outside."""
    draft = mesh.draft
    along = cut[:, :, 0] - x
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        crosses = (along[:, a] < 0.0) != (along[:, b] < 0.0)
        part = np.where(crosses, along[:, a] / np.where(crosses, along[:, a] - along[:, b], 1.0), np.nan)
        ends.append(cut[:, a, 1:] + part[:, None] * (cut[:, b, 1:] - cut[:, a, 1:]))
    result = np.zeros_like(z)
    if len(cut) == 0:
        return result
    # A plane cuts exactly two edges of a triangle; the third entry is NaN.
    pairs = np.stack(ends, axis=1)
    order = np.argsort(np.isnan(pairs[:, :, 0]), axis=1, kind="stable")[:, :2]
    segments = np.take_along_axis(pairs, order[:, :, None], axis=1)
    start, end = segments[:, 0], segments[:, 1]
    # The lowest row stands for the flat of bottom and is read just above it.
    reading = np.maximum(z, z[0] + 1e-3 * draft)
    reading = np.where((z == 0.0) & (z[0] < 0.0), 1e-3 * draft, reading)
    reading = np.where(z >= 0.999 * float(np.max(z)), float(np.max(z)) - 1e-5 * draft, reading)
    # Patches often meet at the still water itself: a hair beside it no crossing falls between them.
    for k, height in enumerate(reading + (lift - 2e-6 * draft)):
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
                f"{mesh.name}: the section at x = {x:.4g} m crosses z = {height:.4g} m {len(port)} times on one side, "
                f"at y = {', '.join(f'{value:.3g}' for value in port[:5])} m: {_crossed_twice(port, x, mesh)}"
            )
        result[k] = port[-1]
    return result


def _crossed_twice(port: Array, x: float, mesh: ShipTriangles) -> str:
    """What a section that is crossed several times looks like, and what to do."""
    part = x / mesh.length
    half = float(np.max(np.abs(mesh.vertices[:, 1])))
    gap = float(np.max(np.diff(port)))
    if float(port[0]) > 0.25 * half and len(port) % 2 == 0:
        return "two hulls side by side or a tunnel along the centreline are not supported"
    if len(port) % 2 == 0 and gap < 0.05 * half:
        return "a second shell inside the hull (plating, a tank): leave it out"
    if part < 0.3:
        return f"twin skegs, a shaft bossing or a strut at x = {x:.3g} m: leave it out"
    if part > 0.8:
        return f"a thruster tunnel or a fin at x = {x:.3g} m: close it or leave it out"
    if float(port[-1] - port[-2]) < 0.2 * half:
        return f"a bilge keel or fin at x = {x:.3g} m: leave it out"
    return f"a tunnel, a fin or crossing faces at x = {x:.3g} m: leave it out"
