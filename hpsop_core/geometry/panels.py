"""The hull below the waterline as quadrilateral panels of fixed topology: the one door into the panel method.

Every hull comes through `HullPanels`: the patches of a transformed parent, a table of offsets turned into patches, or
an analytic body. Panel corners sit at fixed parameters of the parent's patches, so that two designs of one family have
the same panels, moved; nothing switches with the design.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.hull import Hull
from hpsop_core.typing_aliases import Array

# Panels are this much shorter at the ends of a long patch: x = t - a sin(2 pi t)/(2 pi).
END_CLUSTERING = 0.6
FEWEST_PANELS = 4
WATERLINE_POINTS = 801


@dataclass(frozen=True, eq=False)
class HullPanels:
    """Panels of the port half below the waterline in ship axes (x forward from AP, y to port, z up), metres.

    Attributes:
        quads: (m, 4, 3) corners; the right-hand rule gives the normal out of the hull. Two corners may coincide.
        blocks: (name, panels along u, panels along v) in the order of ``quads``, v fastest.
        waterline: (n, 2) x and y >= 0 of the static waterline from stern to bow, ascending in x.
        length: between perpendiculars; AP at x = 0.
        draft: height of the waterline above z = 0.
        wetted_surface: both sides, m2; resistance coefficients refer to it.
        displaced_volume: both sides, m3.
        vertical_centre_of_buoyancy: m above z = 0.
    """

    quads: Array
    blocks: tuple[tuple[str, int, int], ...]
    waterline: Array
    length: float
    draft: float
    wetted_surface: float
    displaced_volume: float
    vertical_centre_of_buoyancy: float


def grid_quads(points: Array) -> Array:
    """Panels (nu nv, 4, 3) between the points (nu + 1, nv + 1, 3) of a patch, v fastest.

    With u forward and v upward on the port side (the convention of the hull's patches) the normals point outward.
    """
    return np.stack([points[1:, :-1], points[:-1, :-1], points[:-1, 1:], points[1:, 1:]], axis=2).reshape(-1, 4, 3)


def clustered(count: int, clustering: float = END_CLUSTERING) -> Array:
    """count + 1 values from 0 to 1, closer together at both ends."""
    t = np.linspace(0.0, 1.0, count + 1)
    values: Array = t - clustering * np.sin(2.0 * np.pi * t) / (2.0 * np.pi)
    values[0], values[-1] = 0.0, 1.0
    return values


def _divisions(hull: Hull, name: str, lengthwise: int, girthwise: int) -> tuple[Array, Array]:
    """Parameters u and v of a patch's panel corners, from the parent's geometry alone."""
    parent = hull.parent
    first, last = parent.extent(name)
    share = abs(last - first) / parent.length
    if share > 0.5:
        fractions, across = clustered(lengthwise), girthwise
    else:
        along = max(FEWEST_PANELS, round(share * lengthwise / (1.0 - END_CLUSTERING)))
        middle = parent.points(name, np.array([0.5]), np.linspace(0.0, 1.0, 41))[0]
        girth = float(np.sum(np.linalg.norm(np.diff(middle, axis=0), axis=1)))
        whole = 0.5 * parent.breadth + parent.draft
        across = min(girthwise, max(FEWEST_PANELS, round(1.7 * girthwise * girth / whole)))
        fractions = clustered(along, 0.4)
    u = parent.parameter(name, first + (last - first) * fractions)
    u[0], u[-1] = 0.0, 1.0
    return u, np.linspace(0.0, 1.0, across + 1)


def _cap_quads(edge: Array) -> Array:
    """Panels that close a flat open end: from the edge curve (n, 3) to the centreplane at the same height."""
    centreline = edge * np.array([1.0, 0.0, 1.0])
    return grid_quads(np.stack([centreline, edge], axis=0))


def hull_panels(hull: Hull, lengthwise: int, girthwise: int) -> HullPanels:
    """Panels of a hull's underwater patches.

    Args:
        hull: the hull.
        lengthwise: panels along a patch that spans more than half of the length; short patches get their share.
        girthwise: panels from keel to waterline of such a patch.
    """
    quads: list[Array] = []
    blocks: list[tuple[str, int, int]] = []
    for name in hull.parent.underwater:
        u, v = _divisions(hull, name, lengthwise, girthwise)
        points = hull.patch_points(name, u, v)
        quads.append(grid_quads(points))
        blocks.append((name, len(u) - 1, len(v) - 1))
        if (name, "first") in hull.parent.caps:
            quads.append(_cap_quads(points[0]))
            blocks.append((f"{name} end", 1, len(v) - 1))
    measured = hull.hydrostatics
    return HullPanels(
        quads=np.concatenate(quads),
        blocks=tuple(blocks),
        waterline=hull.waterline(WATERLINE_POINTS),
        length=hull.length,
        draft=hull.draft,
        wetted_surface=measured.wetted_surface,
        displaced_volume=measured.displaced_volume,
        vertical_centre_of_buoyancy=measured.vertical_centre_of_buoyancy,
    )


def block_points(quads: Array, blocks: Sequence[tuple[str, int, int]]) -> list[Array]:
    """The corner grids (nu + 1, nv + 1, 3) of every block, for showing."""
    grids: list[Array] = []
    start = 0
    for _, along, across in blocks:
        part = quads[start : start + along * across].reshape(along, across, 4, 3)
        grid = np.zeros((along + 1, across + 1, 3))
        grid[:-1, :-1] = part[:, :, 1]
        grid[1:, :-1] = part[:, :, 0]
        grid[:-1, 1:] = part[:, :, 2]
        grid[1:, 1:] = part[:, :, 3]
        grids.append(grid)
        start += along * across
    return grids
