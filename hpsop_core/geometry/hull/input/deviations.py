"""How far each reading of a table lies from the fitted surface."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.input.ship_table import ShipTable
from hpsop_core.typing_aliases import Array, IntArray

_POINTS = 241


def section_deviations(hull: Hull, table: ShipTable, stations: IntArray) -> tuple[Array, ...]:
    """Distances of the readings at some stations from the hull's section there, in the plane of the section.

    Args:
        hull: at the table's own dimensions.
        table: the readings.
        stations: (n,) indices of the table's stations.

    Returns:
        For every station (nz,) m: NaN where the reading is 0 (no hull there) or the surface has no section.
    """
    sections = hull.sections(table.x[stations], _POINTS)
    return tuple(_distances(table, int(k), lines) for k, lines in zip(stations, sections, strict=True))


def _distances(table: ShipTable, station: int, lines: tuple[Array, ...]) -> Array:
    found = np.full(len(table.z), np.nan)
    given = np.flatnonzero(table.y[station] > 0.0)
    if not lines or not len(given):
        return found
    points = np.column_stack([table.y[station, given], table.z[given]])
    found[given] = np.min([_to_line(points, line[:, 1:]) for line in lines], axis=0)
    return found


def _to_line(points: Array, line: Array) -> Array:
    """Distances of points (n, 2) from a polyline (m, 2)."""
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    offset = points[:, None, :] - start
    share = np.clip(np.sum(offset * along, axis=2) / square, 0.0, 1.0)
    return np.asarray(np.min(np.linalg.norm(offset - share[..., None] * along, axis=2), axis=1))
