"""Knuckle lines and chines of a table: where its sections turn sharply, one after the other.

A bilge that is read at few waterlines turns at several readings; a knuckle turns at one, and its neighbours hardly. The
edge of the flat of bottom is no knuckle: a bilge begins there, whose radius a table seldom tells.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.geometry.hull.fit import Section
from hpsop_core.typing_aliases import Array

# Least turn at a knuckle, and the neighbours' greatest as a part of it.
LEAST_TURN, NEIGHBOURS = np.radians(15.0), 0.35
# Share of the stations between these parts of the patch that must have it.
LEAST_SHARE, MIDDLE = 0.75, (0.2, 0.8)
# A knuckle line rises between two stations by less than this part of the section's height.
LARGEST_STEP = 0.2
# Its v is a whole multiple of this, where sections are resampled, and keeps this distance from both edges.
GRID, ROOM = 1.0 / 80.0, 0.1


def _knuckle(section: Section) -> int | None:
    """Index of the point where one section has its knuckle, or None."""
    steps = np.diff(section.points, axis=0)
    if len(steps) < 3:
        return None
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.abs((np.diff(angle) + np.pi) % (2.0 * np.pi) - np.pi)
    at = int(np.argmax(turn))
    if at == 0:
        return None
    beside = [turn[k] for k in (at - 1, at + 1) if 0 <= k < len(turn)]
    return at + 1 if turn[at] >= LEAST_TURN and max(beside) <= NEIGHBOURS * turn[at] else None


def with_knuckle(sections: Sequence[Section]) -> tuple[list[Section], float] | None:
    """The sections with their knuckle marked, and its v; None where the table has no knuckle line.

    Between stations that have it, and beyond them, a point is put where the line goes on.
    """
    found = [_knuckle(section) for section in sections]
    x = np.array([section.x for section in sections])
    low, high = x[0] + MIDDLE[0] * (x[-1] - x[0]), x[0] + MIDDLE[1] * (x[-1] - x[0])
    middle = [k for k, place in enumerate(x) if low <= place <= high]
    told = [(k, at) for k, at in enumerate(found) if at is not None]
    if len(middle) < 4 or sum(found[k] is not None for k in middle) < LEAST_SHARE * len(middle):
        return None
    fractions = np.array([sections[k].chord_fractions()[at] for k, at in told])
    heights = np.array([sections[k].points[at, 1] for k, at in told])
    places = x[[k for k, _ in told]]
    size = max(float(np.ptp(section.points[:, 1])) for section in sections)
    if float(np.max(np.abs(np.diff(heights)))) > LARGEST_STEP * size:
        return None
    v = float(np.clip(np.round(np.median(fractions) / GRID) * GRID, ROOM, 1.0 - ROOM))
    marked = []
    for k, section in enumerate(sections):
        at = found[k]
        if at is not None:
            marked.append(Section(section.x, section.points, (at, v)))
        else:
            marked.append(_with_point(section, float(np.interp(section.x, places, fractions)), v))
    return marked, v


def _with_point(section: Section, fraction: float, v: float) -> Section:
    """A section with a further point on its polyline at a fraction of the chord, which is the knuckle's place."""
    chord = section.chord_fractions()
    near = int(np.argmin(np.abs(chord[1:-1] - fraction))) + 1 if len(chord) > 2 else 0
    if near and abs(chord[near] - fraction) < 1e-3:
        return Section(section.x, section.points, (near, v))
    at = int(np.searchsorted(chord, fraction))
    point: Array = np.array([np.interp(fraction, chord, section.points[:, axis]) for axis in (0, 1)])
    return Section(section.x, np.insert(section.points, at, point, axis=0), (at, v))
