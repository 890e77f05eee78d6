"""Seams between a hull's patches, given a common tangent plane in the surfaces that leave.

Patches share their edges but were fitted one by one, so that they meet under an angle where the ship has no edge. Here
the strip of the smaller patch next to such a seam is turned into the larger one's tangent plane: knots are inserted
beside the seam, and the row of control points next to it is moved, as little as the tangent plane allows. What the
solvers see is untouched. Where a seam runs out into the centreplane, as at the corners of an aperture, the ship ends in
an edge and the angle stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.nurbs import NurbsSurface, basis_matrix
from hpsop_core.typing_aliases import Array

# Widths of the strip beside a seam in parts of the patch, tried in turn: what moves is in proportion to them.
_WIDTHS = (0.01, 0.005, 0.0025)
# Every span across is parted, so that the strip can follow its neighbour's tangent.
_PARTS_ACROSS = 3
# Half-breadths in parts of the breadth: below the first a seam's end is an edge of the ship, above the second none.
_EDGE = 8e-4, 16e-4
# What a movement along the edge counts beside an angle across it: enough to leave points where they are.
_REST = 0.03
# Parts of the length: a seam that would take more is a real edge and stays.
_FURTHEST = 5e-5


def faired_seams(parent: ParentHull, surfaces: Mapping[str, NurbsSurface]) -> tuple[dict[str, NurbsSurface], float]:
    """The surfaces of a hull with common tangent planes along the seams of its underwater patches.

    Args:
        parent: which patches meet where.
        surfaces: every patch by name, in m, ship axes, x of u alone (``Hull.nurbs_patch``).

    Returns:
        The surfaces, and how far any point of them moved at most, m.
    """
    result = dict(surfaces)
    length = float(np.ptp(np.concatenate([surface.control_points[[0, -1], 0, 0] for surface in surfaces.values()])))
    breadth = 2.0 * max(float(np.max(surface.control_points[..., 1])) for surface in surfaces.values())
    moved = 0.0
    for name, (other, start, end) in parent.girth.items():
        if name not in parent.underwater or other == name:
            continue
        aft = _meets_with_its_last_row(surfaces[name], surfaces[other], length)
        if aft is None:
            continue
        for width in _WIDTHS:
            knots = _beside(width, aft)
            found = _turned(result[name], result[other], (start, end), knots, breadth)
            off = _distance(found, result[name], knots)
            if off > _FURTHEST * length:
                continue
            for above, below in parent.along.items():
                if below == name:
                    result[above] = _with_lower_edge(result[above], found, knots)
            result[name] = found
            moved = max(moved, off)
            break
    return result, moved


def _beside(width: float, aft: bool) -> Array:
    """Knots in u beside the seam, which is the patch's last row (aft) or its first."""
    distances = width * np.array([1.0, 2.0, 3.0])
    return 1.0 - distances if aft else distances


def _meets_with_its_last_row(patch: NurbsSurface, other: NurbsSurface, length: float) -> bool | None:
    """Whether a patch ends (True) or begins (False) where the other begins or ends; None if they do not meet."""
    mine, its = patch.control_points[[0, -1], 0, 0], other.control_points[[0, -1], 0, 0]
    near = 1e-6 * length
    if abs(mine[1] - its[0]) < near:
        return True
    return False if abs(mine[0] - its[1]) < near else None


def _turned(
    patch: NurbsSurface, other: NurbsSurface, part: tuple[float, float], knots: Array, breadth: float
) -> NurbsSurface:
    aft = bool(knots[0] > 0.5)
    breaks = np.unique(patch.knots_v)
    shares = np.arange(1, _PARTS_ACROSS) / _PARTS_ACROSS
    finer = (breaks[:-1, None] + np.diff(breaks)[:, None] * shares).ravel()
    patch = patch.with_knots_u(knots).transposed().with_knots_u(finer).transposed()
    net = patch.control_points.copy()
    edge, row, its_edge, its_row = (-1, -2, 0, 1) if aft else (0, 1, -1, -2)
    v = np.linspace(0.0, 1.0, 12 * len(np.unique(patch.knots_v)))
    basis = basis_matrix(patch.knots_v, patch.degree_v, v)
    step = basis_matrix(other.knots_v, other.degree_v, part[0] + (part[1] - part[0]) * v) @ (
        other.control_points[its_row] - other.control_points[its_edge]
    )
    # The same step in x, so that both are slopes of the same sections.
    wanted = step * ((net[row, 0, 0] - net[edge, 0, 0]) / step[0, 0])
    gap = (wanted - basis @ (net[row] - net[edge]))[:, 1:]
    _, _, along = patch.derivatives(np.array([1.0 if aft else 0.0]), v)
    tangent = along[0, :, 1:] / np.maximum(np.linalg.norm(along[0, :, 1:], axis=1, keepdims=True), 1e-12)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    low, high = _EDGE[0] * breadth, _EDGE[1] * breadth
    share = np.clip(((basis @ net[edge])[:, 1] - low) / (high - low), 0.0, 1.0)
    across = share**2 * (3.0 - 2.0 * share) * np.sum(gap * normal, axis=1)
    # Free are y where it is not in the centreplane, and z but for the ends, which other patches share.
    free_y, free_z = np.flatnonzero(net[row, :, 1] != 0.0), np.arange(1, net.shape[1] - 1)
    columns = np.concatenate([basis[:, free_y], basis[:, free_z]], axis=1)
    counts = (len(free_y), len(free_z))
    equations = np.concatenate(
        [columns * np.repeat(normal, counts, axis=1), _REST * columns * np.repeat(tangent, counts, axis=1)]
    )
    solution = np.linalg.lstsq(equations, np.concatenate([across, np.zeros(len(v))]), rcond=None)[0]
    net[row, free_y, 1] = np.maximum(net[row, free_y, 1] + solution[: counts[0]], 0.0)
    net[row, free_z, 2] += solution[counts[0] :]
    return replace(patch, control_points=net)


def _with_lower_edge(patch: NurbsSurface, below: NurbsSurface, knots: Array) -> NurbsSurface:
    """The patch above the waterline, its lower edge again the upper edge of the one below."""
    patch = patch.with_knots_u(knots)
    net = patch.control_points.copy()
    net[:, 0] = below.control_points[:, -1]
    return replace(patch, control_points=net)


def _distance(new: NurbsSurface, old: NurbsSurface, knots: Array) -> float:
    """How far points near the seam moved at most, m."""
    breaks = np.unique(np.concatenate([old.knots_u, knots]))
    # what a row next to the seam moves: the strip and the two spans beside it
    near = np.sort(breaks)[-4:] if knots[0] > 0.5 else np.sort(breaks)[:4]
    u, v = np.linspace(near[0], near[-1], 61), np.linspace(0.0, 1.0, 301)
    return float(np.max(np.linalg.norm(new.evaluate(u, v) - old.evaluate(u, v), axis=2)))
