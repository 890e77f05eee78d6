"""The hull below the waterline as quadrilateral panels of fixed topology: the one door into the panel method.

Every hull comes through `HullPanels`: the patches of a transformed parent, a table of offsets turned into patches, or
an analytic body. Panel corners sit at fixed parameters of the parent's patches, so that two designs of one family have
the same panels, moved; nothing switches with the design.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.typing_aliases import Array

# Panels are this much shorter at the ends of a long patch: x = t - a sin(2 pi t)/(2 pi).
END_CLUSTERING = 0.6
FEWEST_PANELS = 4
WATERLINE_POINTS = 801
# A part whose upper edge is submerged stays this far below the waterline, in drafts: its panels must not meet their
# own images. (The reference ship's bulb is 0.8 % below.)
CROWN_COVER = 0.005
# A wet transom is closed by a tail of this many half-breadths, ending no further aft of AP than a part of the length.
# Blunter than the least slenderness it would make more waves than the hull.
TAIL_SLENDERNESS, TAIL_REACH, LEAST_TAIL_SLENDERNESS = 6.0, 0.3, 4.0
TAIL_PANELS = 8
# From this V/sqrt(g h) on a transom immersed by h is dry (towing tests of transom sterns lie between 2.2 and 2.8). Then
# blunter tails will do: other closures of such hulls change the wave coefficient by 8 % at Fn 0.30, 2 % from 0.35 on.
DRY_TRANSOM, LEAST_DRY_SLENDERNESS = 2.5, 1.8


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
        tail_panels: how many of the last ``quads`` are no hull but the closure behind a wet transom.
        warnings: one line each.
    """

    quads: Array
    blocks: tuple[tuple[str, int, int], ...]
    waterline: Array
    length: float
    draft: float
    wetted_surface: float
    displaced_volume: float
    vertical_centre_of_buoyancy: float
    tail_panels: int = 0
    warnings: tuple[str, ...] = ()


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


def _cap_quads(edge: Array, end: str) -> Array:
    """Panels that close a flat open end: from the edge curve (n, 3) to the centreplane at the same height.

    Panels without area, where the edge itself lies in the centreplane, are left out.
    """
    centreline = edge * np.array([1.0, 0.0, 1.0])
    ends = (centreline, edge) if end == "first" else (edge, centreline)
    quads = grid_quads(np.stack(ends, axis=0))
    breadth = np.abs(quads[:, :, 1]).max(axis=1)
    solid: Array = quads[breadth > 1e-9 * float(np.ptp(edge[:, 2]) + np.max(edge[:, 1]))]
    return solid


def transom_froude_number(froude_number: float, length: float, depth: float) -> float:
    """V/sqrt(g h) of a transom immersed by h = ``depth`` m, from V/sqrt(g L)."""
    return float(froude_number * np.sqrt(length / depth))


def _transom_depth(edge: Array, draft: float) -> float:
    """How deep a transom's section (n, 3) is in the water, m; a post below it, in the centreplane, is no transom."""
    first = int(np.argmax(edge[:, 1] > 1e-3 * float(np.max(edge[:, 1]))))
    return draft - float(np.min(edge[max(first - 1, 0) :, 2]))


def _tail_points(edge: Array, draft: float, length: float, slowest: float | None) -> Array:
    """The closure behind a transom in the water: its section shrinks like 1 - s^2 towards a point in the waterline.

    Args:
        edge: (n, 3) the transom's section from keel to waterline.
        draft, length: of the hull, m.
        slowest: the least Froude number that is asked; None: not known.

    Returns:
        (TAIL_PANELS + 1, n, 3), from the point forward to the transom.

    Raises:
        SolverFailure: the transom is too wide for a tail of this hull's length, and not dry at the least speed.
    """
    half_breadth = float(edge[-1, 1])
    depth = _transom_depth(edge, draft)
    room = float(edge[-1, 0]) + TAIL_REACH * length
    clears = 0.0 if slowest is None else transom_froude_number(slowest, length, depth)
    least = LEAST_TAIL_SLENDERNESS if clears < DRY_TRANSOM else LEAST_DRY_SLENDERNESS
    if room < least * half_breadth:
        dry = DRY_TRANSOM * (depth / length) ** 0.5
        raise SolverFailure(
            "rankine",
            f"the wet transom is {2.0 * half_breadth:.4g} m wide and {depth:.4g} m deep: the water behind it cannot be "
            f"closed smoothly within {room:.4g} m; this solver takes transoms up to "
            f"{2.0 * room / LEAST_TAIL_SLENDERNESS:.4g} m wide on this length, and up to "
            f"{2.0 * room / LEAST_DRY_SLENDERNESS:.4g} m where they are dry (V/sqrt(g h) of {DRY_TRANSOM:g}, here from "
            f"Froude number {dry:.3f}{'' if slowest is None else f'; asked {slowest:.3f}'})",
        )
    reach = max(min(TAIL_SLENDERNESS * half_breadth, room), 1e-3 * length)
    s = np.linspace(1.0, 0.0, TAIL_PANELS + 1)[:, None]
    shrink = 1.0 - s**2
    return np.stack(
        [edge[:, 0] - reach * s, edge[:, 1] * shrink, draft - (draft - edge[:, 2]) * shrink],
        axis=2,
    )


def hull_panels(
    hull: Hull, lengthwise: int, girthwise: int, slowest: float | None = None, tail_wanted: bool = True
) -> HullPanels:
    """Panels of a hull's underwater patches.

    Flat ends (a boss, a blunt nose) are closed by flat panels. A transom in the water, whose flow leaves the hull at
    its edge, is closed by a short tail that carries on the waterline; the tail is no part of the hull's wetted surface.

    Args:
        hull: the hull.
        lengthwise: panels along a patch that spans more than half of the length; short patches get their share.
        girthwise: panels from keel to waterline of such a patch.
        slowest: the least Froude number that will be asked: it decides whether a wide transom is dry.
        tail_wanted: False leaves a transom in the water open: the hull's own panels, of any transom.

    Raises:
        SolverFailure: a wet transom too wide to be closed.
    """
    quads: list[Array] = []
    blocks: list[tuple[str, int, int]] = []
    tail: Array | None = None
    waterline = hull.waterline(WATERLINE_POINTS)
    for name in hull.parent.underwater:
        u, v = _divisions(hull, name, lengthwise, girthwise)
        points = np.array(hull.patch_points(name, u, v))
        if np.max(points[:, -1, 1]) == 0.0:
            points[..., 2] = np.minimum(points[..., 2], (1.0 - CROWN_COVER) * hull.draft)
        quads.append(grid_quads(points))
        blocks.append((name, len(u) - 1, len(v) - 1))
        for end, edge in (("first", points[0]), ("last", points[-1])):
            if (name, end) not in hull.parent.caps:
                continue
            if end == "first" and edge[-1, 1] > 0.0 and edge[-1, 2] >= (1.0 - 1e-9) * hull.draft:
                tail = _tail_points(edge, hull.draft, hull.length, slowest) if tail_wanted else None
            else:
                cap = _cap_quads(edge, end)
                quads.append(cap)
                blocks.append((f"{name} end", 1, len(cap)))
    warnings: tuple[str, ...] = ()
    if tail is not None:
        quads.append(grid_quads(tail))
        blocks.append(("tail", tail.shape[0] - 1, tail.shape[1] - 1))
        fine = np.linspace(1.0, 0.0, 41)[:-1]
        start, stop = tail[-1, -1], tail[0, -1]
        aft = np.stack([start[0] + (stop[0] - start[0]) * fine, start[1] * (1.0 - fine**2)], axis=1)
        waterline = np.concatenate([aft, waterline])
        warnings = (_transom_line(float(start[1]), tail, hull, slowest),)
    measured = hull.hydrostatics
    return HullPanels(
        quads=np.concatenate(quads),
        blocks=tuple(blocks),
        waterline=waterline,
        length=hull.length,
        draft=hull.draft,
        wetted_surface=measured.wetted_surface,
        displaced_volume=measured.displaced_volume,
        vertical_centre_of_buoyancy=measured.vertical_centre_of_buoyancy,
        tail_panels=0 if tail is None else (tail.shape[0] - 1) * (tail.shape[1] - 1),
        warnings=warnings,
    )


def _transom_line(half_breadth: float, tail: Array, hull: Hull, slowest: float | None) -> str:
    """What is said of a transom in the water: its size, how it is closed, and whether it is dry."""
    depth = _transom_depth(tail[-1], hull.draft)
    line = (
        f"transom {2 * half_breadth:.4g} m wide and {depth:.4g} m deep in the water: closed by a tail of "
        f"{float(tail[-1, -1, 0] - tail[0, -1, 0]):.4g} m in the wave calculation, whose waves count: another tail "
        "changes Rw by a factor of two and more, which no stated error holds, so compare sterns by it, not ships"
    )
    if slowest is None:
        return f"{line}; the transom's own drag does not"
    clears = transom_froude_number(slowest, hull.length, depth)
    if clears >= DRY_TRANSOM:
        return f"{line}; dry at all these speeds (V/sqrt(g h) from {clears:.2f}, dry from {DRY_TRANSOM:g})"
    return (
        f"{line}; wet below Froude number {DRY_TRANSOM * (depth / hull.length) ** 0.5:.3f} (V/sqrt(g h) {clears:.2f} "
        f"at {slowest:.3f}): there the transom's own drag is missing"
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
