"""Seams between a hull's patches, given a common tangent plane in the surfaces that leave.

Patches share their edges but were fitted one by one, so that they meet under an angle where the ship has no edge. Here
the strip of the smaller patch next to such a seam is turned into the larger one's tangent plane: knots are inserted
beside the seam, and the row of control points next to it is moved, as little as the tangent plane allows. Across the
design waterline the strip is the topsides'; where topsides meet, that of the patch with the shorter span there, whose
slope the fewer stations held. What the solvers see is untouched. Where a seam runs out into the
centreplane, as at the corners of an aperture, the ship ends in an edge and the angle stays.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.nurbs import NurbsSurface, basis_matrix
from hpsop_core.typing_aliases import Array, IntArray

# Widths of the strip beside a seam in parts of the patch, tried in turn: what moves is in proportion to them.
_WIDTHS = (0.01, 0.005, 0.0025)
# Every span across is parted, so that the strip can follow its neighbour's tangent; the first and the last in twelfths
# up to their middle, where a seam may come out of an edge of the ship within a few decimetres.
_PARTS_ACROSS = 3
_PARTS_AT_ENDS = np.array([1.0, 2.0, 3.0, 5.0, 6.0]) / 12.0
# Half-breadths in parts of the breadth: below the first a seam's end is an edge of the ship, above the second none.
_EDGE = 8e-4, 16e-4
# The same above the waterline, where the shipped hull's bow folds where it comes out of the stem.
_EDGE_ABOVE = 4e-3, 12e-3
# What a movement along the edge counts beside an angle across it: enough to leave points where they are.
_REST = 0.03
# Parts of the length over all: a seam that would take more is a real edge and stays.
_FURTHEST = 5e-5


def faired_seams(parent: ParentHull, surfaces: Mapping[str, NurbsSurface]) -> tuple[dict[str, NurbsSurface], float]:
    """The surfaces of a hull with common tangent planes along its waterline and the seams below and above it.

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
    topsides, off = _over_the_waterline(parent, result, length, breadth)
    result |= topsides
    return result, max(moved, off, _above_the_waterline(parent, surfaces, result, length, breadth))


def _beside(width: float, aft: bool) -> Array:
    """Knots in u beside the seam, which is the patch's last row (aft) or its first."""
    distances = width * np.array([1.0, 2.0, 3.0])
    return _apart(1.0 - distances if aft else distances)


def _apart(knots: Array) -> Array:
    """Further knots without their rounding: two ways to the same knot would end in two, too close for OpenCASCADE."""
    return np.asarray(np.round(knots, 12))


def _meets_with_its_last_row(patch: NurbsSurface, other: NurbsSurface, length: float) -> bool | None:
    """Whether a patch ends (True) or begins (False) where the other begins or ends; None if they do not meet."""
    mine, its = patch.control_points[[0, -1], 0, 0], other.control_points[[0, -1], 0, 0]
    near = 1e-6 * length
    if abs(mine[1] - its[0]) < near:
        return True
    return False if abs(mine[0] - its[1]) < near else None


def _across(knots: Array) -> Array:
    """Knots to be inserted across a patch."""
    breaks = np.unique(knots)
    spans = np.diff(breaks)
    shares = np.arange(1, _PARTS_ACROSS) / _PARTS_ACROSS
    inner = (breaks[:-1, None] + spans[:, None] * shares).ravel()
    first, last = breaks[0] + spans[0] * _PARTS_AT_ENDS, breaks[-1] - spans[-1] * _PARTS_AT_ENDS
    return _apart(np.concatenate([first, inner, last]))


def _turned(
    patch: NurbsSurface,
    other: NurbsSurface,
    part: tuple[float, float],
    knots: Array,
    breadth: float,
    edge_up_to: tuple[float, float] = _EDGE,
    held: int = 0,
) -> NurbsSurface:
    """The patch with its strip in the other's tangent planes; it meets the part of the other's edge, or holds it.

    ``held`` control points from the lower edge on stay.
    """
    aft = bool(knots[0] > 0.5)
    finer = _across(patch.knots_v)
    patch = patch.with_knots_u(knots).transposed().with_knots_u(finer).transposed()
    net = patch.control_points.copy()
    edge, row, its_edge, its_row = (-1, -2, 0, 1) if aft else (0, 1, -1, -2)
    v = np.linspace(0.0, 1.0, 12 * len(np.unique(patch.knots_v)))
    basis = basis_matrix(patch.knots_v, patch.degree_v, v)
    its = np.clip(part[0] + (part[1] - part[0]) * v, 0.0, 1.0)  # beyond the other's edge: in the centreplane, an edge
    step = basis_matrix(other.knots_v, other.degree_v, its) @ (
        other.control_points[its_row] - other.control_points[its_edge]
    )
    # The same step in x, so that both are slopes of the same sections.
    wanted = step * ((net[row, 0, 0] - net[edge, 0, 0]) / step[0, 0])
    gap = (wanted - basis @ (net[row] - net[edge]))[:, 1:]
    _, _, along = patch.derivatives(np.array([1.0 if aft else 0.0]), v)
    tangent = along[0, :, 1:] / np.maximum(np.linalg.norm(along[0, :, 1:], axis=1, keepdims=True), 1e-12)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    across = _no_edge(basis @ net[edge], breadth, edge_up_to) * np.sum(gap * normal, axis=1)
    # Free are y where it is not in the centreplane, and z but for the ends, which other patches share.
    index = np.arange(net.shape[1])
    free_y = np.flatnonzero((net[row, :, 1] != 0.0) & (index >= held))
    free_z = index[max(held, 1) : -1]
    net[row] = _least_moved(net[row], basis, normal, tangent, across, free_y, free_z)
    return replace(patch, control_points=net)


def _no_edge(seam: Array, breadth: float, edge_up_to: tuple[float, float] = _EDGE) -> Array:
    """How far the ship is smooth at points (n, 3) of a seam: 0 where it ends in an edge to 1."""
    low, high = edge_up_to[0] * breadth, edge_up_to[1] * breadth
    share = np.clip((seam[:, 1] - low) / (high - low), 0.0, 1.0)
    return np.asarray(share**2 * (3.0 - 2.0 * share))


def _least_moved(
    row: Array, basis: Array, normal: Array, tangent: Array, across: Array, free_y: IntArray, free_z: IntArray
) -> Array:
    """A row of control points (n, 3) moved so that its curve goes by ``across`` (m,) along ``normal`` (m, 2).

    Little along ``tangent``; y stays on its side of the centreplane.
    """
    columns = np.concatenate([basis[:, free_y], basis[:, free_z]], axis=1)
    counts = (len(free_y), len(free_z))
    equations = np.concatenate(
        [columns * np.repeat(normal, counts, axis=1), _REST * columns * np.repeat(tangent, counts, axis=1)]
    )
    solution = np.linalg.lstsq(equations, np.concatenate([across, np.zeros(len(across))]), rcond=None)[0]
    moved = row.copy()
    moved[free_y, 1] = np.maximum(moved[free_y, 1] + solution[: counts[0]], 0.0)
    moved[free_z, 2] += solution[counts[0] :]
    return moved


def _over_the_waterline(
    parent: ParentHull, surfaces: Mapping[str, NurbsSurface], length: float, breadth: float
) -> tuple[dict[str, NurbsSurface], float]:
    """Patches above the waterline, turned into the tangent planes of those below, and how far they moved at most, m."""
    joints = {}
    for name, (other, _, _) in parent.girth.items():
        if name == other or not {name, other} <= set(parent.along):
            continue
        aft = _meets_with_its_last_row(surfaces[name], surfaces[other], length)
        if aft is not None and np.array_equal(surfaces[name].knots_v, surfaces[other].knots_v):
            joints[name] = (other, -1 if aft else 0, 0 if aft else -1)
    # Where two of them meet both turn, and a flat end follows its rim; other ends are shared with patches that stay.
    free = {(name, end) for name, (_, end, _) in joints.items()} | {(other, end) for other, _, end in joints.values()}
    free |= {(name, 0 if end == "first" else -1) for name, end in parent.caps}
    # The waterline runs into stem and stern within a span of theirs: both sides of it get the same further knots there.
    near_ends = {above: _where_it_closes(surfaces[below], breadth) for above, below in parent.along.items()}
    finer = {name: surfaces[name].with_knots_u(near_ends[name]) for name in parent.along}
    lower = {below: surfaces[below].with_knots_u(near_ends[above]) for above, below in parent.along.items()}
    for width in _WIDTHS:
        knots = _beside(width, False)
        found = {
            above: _risen(finer[above], lower[below], knots, [end for name, end in free if name == above], breadth)
            for above, below in parent.along.items()
        }
        for name, (other, end, its_end) in joints.items():
            net = found[name].control_points.copy()
            net[end, 1] = found[other].control_points[its_end, 1]
            found[name] = replace(found[name], control_points=net)
        off = max(
            (_distance(found[name].transposed(), surfaces[name].transposed(), knots) for name in found), default=0.0
        )
        if off <= _FURTHEST * length:
            return {**lower, **found}, off
    return {}, 0.0


def _above_the_waterline(
    parent: ParentHull,
    fitted: Mapping[str, NurbsSurface],
    surfaces: dict[str, NurbsSurface],
    length: float,
    breadth: float,
) -> float:
    """Turns topsides where they meet each other, in ``surfaces``, and says how far they moved at most, m.

    What moves is found on the patches as they were ``fitted``: the knots that the waterline has got since would make
    the strip a few centimetres wide.
    """
    moved = 0.0
    for name, (other, start, end) in parent.girth.items():
        if name == other or name in parent.underwater:
            continue
        aft = _meets_with_its_last_row(surfaces[name], surfaces[other], length)
        if aft is None:
            continue
        mine, its, part = name, other, (start, end)
        if _first_step(fitted[other], not aft) < _first_step(fitted[name], aft):
            # seen from it, its own edge goes on beyond that of the patch which meets a part of it
            mine, its, part, aft = other, name, (-start / (end - start), (1.0 - start) / (end - start)), not aft
        # two rows of control points hold the waterline's tangent plane
        held = 2 if mine in parent.along else 0
        for width in _WIDTHS:
            knots = _beside(width, aft)
            turned = _turned(fitted[mine], fitted[its], part, knots, breadth, _EDGE_ABOVE, held)
            off = _distance(turned, fitted[mine], knots)
            if off > _FURTHEST * length:
                continue
            surfaces[mine] = _moved_like(surfaces[mine], fitted[mine], turned)
            if mine in parent.along:
                below = surfaces[parent.along[mine]]
                below = below.with_knots_u(_further(surfaces[mine].knots_u, below.knots_u))
                surfaces[parent.along[mine]] = below
                surfaces[mine] = _with_edge_of(surfaces[mine], below)
            moved = max(moved, off)
            break
    return moved


def _first_step(patch: NurbsSurface, aft: bool) -> float:
    """From a patch's last row of control points (aft) or its first to the next, m: a third of the span there."""
    x = patch.control_points[:, 0, 0]
    return float(x[-1] - x[-2] if aft else x[1] - x[0])


def _moved_like(patch: NurbsSurface, old: NurbsSurface, new: NurbsSurface) -> NurbsSurface:
    """A patch plus the difference of two others; each has the old one's knots and further ones."""
    old, patch = _on_knots_of(old, new), _on_knots_of(patch, new)
    difference = _on_knots_of(replace(new, control_points=new.control_points - old.control_points), patch)
    return replace(patch, control_points=patch.control_points + difference.control_points)


def _on_knots_of(patch: NurbsSurface, other: NurbsSurface) -> NurbsSurface:
    patch = patch.with_knots_u(_further(other.knots_u, patch.knots_u))
    return patch.transposed().with_knots_u(_further(other.knots_v, patch.knots_v)).transposed()


def _further(knots: Array, present: Array) -> Array:
    """Knots that are not among those present, each as often as it is missing."""
    return np.array(sorted((Counter(knots.tolist()) - Counter(present.tolist())).elements()))


def _where_it_closes(below: NurbsSurface, breadth: float) -> Array:
    """Knots to be inserted in u beside the ends at which the upper edge of a patch runs into the centreplane."""
    breaks = np.unique(below.knots_u)
    closed = below.control_points[[0, -1], -1, 1] < _EDGE[0] * breadth
    fore, aft = breaks[-1] - (breaks[-1] - breaks[-2]) * _PARTS_AT_ENDS, breaks[1] * _PARTS_AT_ENDS
    return _apart(np.sort(np.concatenate([aft[: len(aft) * int(closed[0])], fore[: len(fore) * int(closed[1])]])))


def _risen(
    patch: NurbsSurface, below: NurbsSurface, knots: Array, free_ends: list[int], breadth: float
) -> NurbsSurface:
    patch = patch.transposed().with_knots_u(knots).transposed()
    net = patch.control_points.copy()
    net[:, 0] = below.control_points[:, -1]
    u = np.linspace(0.0, 1.0, 12 * len(np.unique(patch.knots_u)))
    basis = basis_matrix(patch.knots_u, patch.degree_u, u)
    _, _, rising = below.derivatives(u, np.array([1.0]))
    tangent = rising[:, 0, 1:] / np.maximum(np.linalg.norm(rising[:, 0, 1:], axis=1, keepdims=True), 1e-12)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    gap = np.sum(basis @ (net[:, 1] - net[:, 0])[:, 1:] * normal, axis=1)
    inner = np.ones(len(net), dtype=np.bool_)
    inner[[0, -1]] = False
    inner[free_ends] = True
    free_y, free_z = np.flatnonzero(inner & (net[:, 1, 1] != 0.0)), np.flatnonzero(inner)
    net[:, 1] = _least_moved(
        net[:, 1], basis, normal, tangent, -_no_edge(basis @ net[:, 0], breadth) * gap, free_y, free_z
    )
    return replace(patch, control_points=net)


def _with_lower_edge(patch: NurbsSurface, below: NurbsSurface, knots: Array) -> NurbsSurface:
    """The patch above the waterline with further knots, its lower edge again the upper edge of the one below."""
    return _with_edge_of(patch.with_knots_u(knots), below)


def _with_edge_of(patch: NurbsSurface, below: NurbsSurface) -> NurbsSurface:
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
