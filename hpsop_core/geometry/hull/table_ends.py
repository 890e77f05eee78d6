"""Where a hull given as a table of half-breadths ends in the water, and whether sharp or flat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.hull.table_stations import HalfBreadths, TableStation, closing_place


@dataclass(frozen=True)
class HullEnd:
    """How the hull ends: the station and, for a sharp end, the bottom of its edge; None for a flat open end."""

    x: float
    bottom: float | None


def hull_end(table: HalfBreadths, stations: Sequence[TableStation], forward: bool, draft: float) -> HullEnd:
    """The end of the body beyond its last station with a section."""
    near, next_one = (stations[-1], stations[-2]) if forward else (stations[0], stations[1])
    index = int(np.searchsorted(table.x, near.x)) + (1 if forward else -1)
    if index < 0 or index >= len(table.x):
        return HullEnd(near.x, None)
    rising = _overhang(table, index, near, next_one, draft)
    if rising is not None:
        return HullEnd(rising, draft)
    width, next_width = (float(np.max(s.points[:, 0])) for s in (near, next_one))
    x = closing_place(np.array([table.x[index], near.x, next_one.x]), np.array([width, next_width]))
    slope = (near.points[0, 1] - next_one.points[0, 1]) / (near.x - next_one.x)
    bottom = float(np.clip(near.points[0, 1] + slope * (x - near.x), table.z[0], draft))
    return HullEnd(x, bottom)


def _overhang(
    table: HalfBreadths, index: int, near: TableStation, next_one: TableStation, draft: float
) -> float | None:
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
    above = closing_place(table.z[[first - 1, first, second]], table.y[index, [first, second]])
    if above <= draft or bottom >= draft:
        return None
    return float(near.x + (table.x[index] - near.x) * (draft - bottom) / (above - bottom))
