"""The hull's paint: deck, boot-top and draught marks, as meshes that lie on the surface; and its shadow on the water.

For looks alone: no solver, no number and no exported file knows of it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpsop_core.geometry.hull.hull import Hull, ParentHull
from hpsop_core.geometry.hull.mesh import Resolution, hull_view_parts

Array = NDArray[np.float64]
Faces = NDArray[np.int64]
Mesh = tuple[Array, Faces]

_NOTHING: Mesh = (np.zeros((3, 3)), np.array([[0, 1, 2]]))
# height of the boot-top over the draft; how far paint stands off the hull, over the breadth
_BOOT_TOP, _OFF = 0.085, 0.0022
_ALONG = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 81))
# rows of the topsides near the waterline, closer together there
_UP = np.linspace(0.0, 1.0, 33) ** 2
_GIRTH = np.linspace(0.0, 1.0, 49)
# draught marks stand at these parts of the parent's length, every second metre of a ship
_MARK_PLACES = (0.045, 0.5, 0.955)
_METRES_APART = 2.0
# and take the hull's slope from so much of the length
_MARK_ROOM = 0.006
# where the sun stands: from port, ahead and high, so that the shadow falls on the side that the page shows
_SHADOW = np.array([-0.35, -0.62])
# strokes of the digits on a grid of 1 by 2: from (x, z) to (x, z)
_SEGMENTS = {
    "a": ((0, 2), (1, 2)),
    "b": ((1, 1), (1, 2)),
    "c": ((1, 0), (1, 1)),
    "d": ((0, 0), (1, 0)),
    "e": ((0, 0), (0, 1)),
    "f": ((0, 1), (0, 2)),
    "g": ((0, 1), (1, 1)),
}
_DIGITS = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgedc", "abc", "abcdefg", "abcdfg")


@lru_cache(maxsize=16)
def _split(parent: ParentHull, resolution: Resolution) -> tuple[tuple[Faces, Faces], tuple[Faces, Faces]]:
    """Of the topsides' mesh: the walls' and the deck's vertices and their faces; the deck looks upwards, high above."""
    vertices, faces = hull_view_parts(_itself(parent), resolution).get("topsides", _NOTHING)
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = 0.5 * (vertices[:, 2].min() + vertices[:, 2].max())
    deck = (normal[:, 2] > 0.9 * np.linalg.norm(normal, axis=1)) & (corners[:, :, 2].min(axis=1) > middle)
    walls, plates = (np.unique(faces[chosen], return_inverse=True) for chosen in (~deck, deck))
    return (walls[0], walls[1].reshape(-1, 3)), (plates[0], plates[1].reshape(-1, 3))


def _itself(parent: ParentHull) -> Hull:
    return parent.transform(parent.length, parent.breadth, parent.draft)


def walls_and_deck(hull: Hull, topsides: Mesh, resolution: Resolution) -> tuple[Mesh, Mesh]:
    """The topsides' mesh in two, each of a topology that is fixed for a parent; a part that is missing is one point."""
    parts = []
    for used, faces in _split(hull.parent, resolution):
        parts.append((topsides[0][used], faces) if len(used) else _NOTHING)
    return parts[0], parts[1]


@lru_cache(maxsize=8)
def _band(parent: ParentHull) -> Array:
    """The parent's boot-top, port side in the parent's frame: (n, 2, 3)."""
    top = parent.draft * (1.0 + _BOOT_TOP)
    rows = []
    for name in sorted(parent.topsides, key=lambda name: parent.extent(name)[0]):
        points = parent.points(name, _ALONG, _UP)
        upper = np.array([[np.interp(top, line[:, 2], line[:, axis]) for axis in range(3)] for line in points])
        rows.append(np.stack([points[:, 0], upper], axis=1))
    return np.concatenate(rows) if rows else np.zeros((0, 2, 3))


def boot_top(hull: Hull) -> Mesh:
    """A band above the waterline all around the ship, of a topology that is fixed for a parent."""
    parent_band = _band(hull.parent)
    count = len(parent_band)
    if not count:
        return _NOTHING
    port = parent_band * np.array(hull.scale)
    # x depends on the station alone: both edges of the band stand at it
    port[:, :, 0] = hull.station_map(parent_band[:, 0, 0])[:, None]
    # outwards in the waterplane: across the line, which runs forward on the port side
    along = np.gradient(port[:, :, :2], axis=0)
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    size = np.linalg.norm(across, axis=-1, keepdims=True)
    port[:, :, :2] += _OFF * hull.breadth * across / np.maximum(size, 1e-12)
    port[:, :, 1] = np.maximum(port[:, :, 1], 0.0)
    index = np.arange(2 * count).reshape(count, 2)
    a, b, c, d = index[:-1, 0], index[1:, 0], index[1:, 1], index[:-1, 1]
    faces = np.concatenate([np.column_stack([a, c, b]), np.column_stack([a, d, c])])
    flat = port.reshape(-1, 3)
    return (
        np.concatenate([flat, flat * np.array([1.0, -1.0, 1.0])]),
        np.concatenate([faces, faces[:, ::-1] + 2 * count]),
    )


def shadow(waterline: Array, deck_edge_height: float) -> Mesh:
    """The ship's shadow on calm water, at the height of the waterline.

    Args:
        waterline: (n, 3) closed, port side from aft to forward and back on starboard.
        deck_edge_height: of the deck above the waterline, m.
    """
    cast = waterline.copy()
    cast[:, :2] += _SHADOW * deck_edge_height
    count = len(waterline)
    here, ahead = np.arange(count), (np.arange(count) + 1) % count
    faces = np.concatenate(
        [np.column_stack([here, ahead, ahead + count]), np.column_stack([here, ahead + count, here + count])]
    )
    return np.concatenate([waterline, cast]), faces


def draught_marks(hull: Hull) -> Mesh:
    """Figures of the draught in metres at both ends and amidships, on both sides, half a spacing high."""
    # a model's marks stand as on a ship, over its draft
    ship = hull.draft >= 4.0
    step = _METRES_APART if ship else hull.draft / 7.0
    count = int(1.25 * hull.draft / step)
    strokes = _figures(count, round(_METRES_APART) if ship else 1) * step
    pieces = [_laid(strokes, lines, hull) for lines in _sides(hull.parent)]
    if not pieces:
        return _NOTHING
    quads = np.concatenate(pieces)
    first = 4 * np.arange(len(quads))[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    return quads.reshape(-1, 3), faces


@lru_cache(maxsize=8)
def _sides(parent: ParentHull) -> tuple[Array, ...]:
    """The port side where marks stand, in the parent's frame: (2, n, 3) at two near stations, from below upwards."""
    found = []
    for place in _MARK_PLACES:
        x = (place + np.array([-0.5, 0.5]) * _MARK_ROOM) * parent.length
        lines = []
        for names in (parent.underwater, parent.topsides):
            for name in names:
                first, last = parent.extent(name)
                if first <= x[0] and x[1] <= last:
                    lines.append(parent.surface(name).evaluate(parent.parameter(name, x), _GIRTH))
        if lines:
            found.append(np.concatenate(lines, axis=1))
    return tuple(found)


@lru_cache(maxsize=32)
def _figures(count: int, each: int) -> Array:
    """All figures of a column as rectangles (n, 4, 2), for a spacing of 1: their feet at 1, 2, ..., half as high."""
    height = 0.5
    width, pen = 0.5 * height, 0.085 * height
    rectangles = []
    for level in range(1, count + 1):
        figure = str(level * each)
        for place, digit in enumerate(figure):
            left = (place - 0.5 * (len(figure) - 1)) * 1.5 * width - 0.5 * width
            for letter in _DIGITS[int(digit)]:
                (x0, z0), (x1, z1) = _SEGMENTS[letter]
                low = (left + width * x0 - pen, level + 0.5 * height * z0 - pen)
                high = (left + width * x1 + pen, level + 0.5 * height * z1 + pen)
                rectangles.append((low, (high[0], low[1]), high, (low[0], high[1])))
    return np.array(rectangles).reshape(-1, 4, 2)


def _laid(strokes: Array, lines: Array, hull: Hull) -> Array:
    """Strokes laid on both sides of the hull: (n, 4, 3), the same number wherever the hull reaches."""
    scale = hull.scale
    aft, fore = hull.station_map(lines[:, 0, 0])
    middle, z = 0.5 * (aft + fore), strokes[..., 1]
    off = _OFF * hull.breadth
    ends = [np.interp(z, scale[2] * line[:, 2], scale[1] * line[:, 1]) for line in lines]
    found = []
    for side in (1.0, -1.0):
        # read from outside: on the port side the bow is at the left
        x = middle - side * strokes[..., 0]
        part = (x - aft) / (fore - aft)
        y = (1.0 - part) * ends[0] + part * ends[1]
        found.append(np.stack([x, side * (np.maximum(y, 0.0) + off), z], axis=-1))
    return np.concatenate(found)
