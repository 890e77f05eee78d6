"""Triangle meshes of a propeller: blades with fillets, hub and boss cap as one closed surface.

The topology belongs to the number of blades and the resolution and never changes; a design only moves vertices. Metres,
propeller axes; propeller_placement.py puts them behind a hull.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import trimesh

from hpsop_core.geometry.propeller.hub import Hub, check_root_gap, hub_of, pushed_outwards
from hpsop_core.geometry.propeller.nurbs import blade_parameters, blade_surface
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import finite_edge_points, rotate_blade, to_cartesian
from hpsop_core.typing_aliases import Array, IntArray

Resolution = Literal["drag", "view", "export"]


@dataclass(frozen=True)
class _Counts:
    """Intervals: along a chord, along a blade, up a fillet, between two blades, on the ends of the hub."""

    chord: int
    span: int
    fillet: int
    between: int
    ahead: int
    behind: int


_COUNTS: dict[str, _Counts] = {
    "drag": _Counts(14, 12, 3, 8, 3, 6),
    "view": _Counts(24, 24, 4, 12, 4, 10),
    "export": _Counts(48, 72, 5, 24, 6, 20),
}


@dataclass(frozen=True, eq=False)
class PropellerTopology:
    """Faces of the propeller mesh; indices into its vertices.

    Attributes:
        blades: triangles of blades with fillets.
        hub: triangles of the hub.
    """

    blades: IntArray
    hub: IntArray


def propeller_mesh(propeller: Propeller, resolution: Resolution = "view") -> trimesh.Trimesh:
    """The whole propeller as one closed mesh with outward normals, m, propeller axes.

    Raises:
        InputError: the roots of neighbouring blades meet.
    """
    topology = propeller_topology(propeller.blade_count, resolution)
    vertices = _vertices(propeller, _COUNTS[resolution]) * (0.5 * propeller.diameter)
    return trimesh.Trimesh(vertices, np.concatenate([topology.blades, topology.hub]), process=False)


def propeller_view_parts(propeller: Propeller, resolution: Resolution = "view") -> dict[str, tuple[Array, IntArray]]:
    """Vertices (n, 3) and faces (m, 3) of "blades" and "hub" for shading apart, m, propeller axes.

    The faces never change for one number of blades and resolution, so that a page may move vertices in place.

    Raises:
        InputError: the roots of neighbouring blades meet.
    """
    vertices = _vertices(propeller, _COUNTS[resolution]) * (0.5 * propeller.diameter)
    parts = _parts(propeller.blade_count, resolution)
    return {name: (vertices[used], faces) for name, (used, faces) in parts.items()}


@lru_cache(maxsize=32)
def _parts(blade_count: int, resolution: Resolution) -> dict[str, tuple[IntArray, IntArray]]:
    topology = propeller_topology(blade_count, resolution)
    parts = {}
    for name, faces in (("blades", topology.blades), ("hub", topology.hub)):
        used, renumbered = np.unique(faces, return_inverse=True)
        parts[name] = (used, renumbered.reshape(faces.shape).astype(np.int64))
    return parts


def _blade_rings(counts: _Counts) -> int:
    return counts.fillet + counts.span + 1


def _blade_size(counts: _Counts) -> int:
    """Vertices of one blade: rings of 2 n points, and the n - 2 in the middle of the tip's edge."""
    return _blade_rings(counts) * 2 * counts.chord + counts.chord - 2


def _sector_size(counts: _Counts) -> int:
    """Vertices of one sector of the hub that do not belong to a blade."""
    return (counts.ahead + counts.behind) * counts.between + (counts.chord + 1) * (counts.between - 1)


def _vertices(propeller: Propeller, counts: _Counts) -> Array:
    """All vertices in tip radii: blades, sectors of the hub, its two ends on the axis."""
    check_root_gap(propeller)
    hub = hub_of(propeller)
    key, base_x, base_theta = _blade(propeller, hub, counts)
    sector_x, sector_radius, sector_theta = _sector(propeller, hub, counts, base_x, base_theta)
    count = propeller.blade_count
    turn = 2.0 * np.pi * np.arange(count)[:, None] / count
    blades = np.concatenate([rotate_blade(key, k, count) for k in range(count)])
    sectors = to_cartesian(sector_x, sector_radius, sector_theta + turn).reshape(-1, 3)
    ends = np.array([[hub.face_x, 0.0, 0.0], [hub.cap_x, 0.0, 0.0]])
    return np.concatenate([blades, sectors, ends])


def _blade(propeller: Propeller, hub: Hub, counts: _Counts) -> tuple[Array, Array, Array]:
    """Vertices of the key blade (m, 3), and the ring on the hub (x, theta), each (2 n,).

    A ring begins in the middle of the trailing edge and goes over the back to the leading edge (point n) and the face.
    """
    n = counts.chord
    fillet = hub.fillet_radius
    # circular fillet: at height h over the hub the outline stands off by d
    angle = 0.5 * np.pi * np.arange(counts.fillet) / counts.fillet
    fillet_radius = hub.radius + fillet * (1.0 - np.cos(angle))
    fine_x, fine_theta = _root_contours(propeller, fillet_radius, fillet * (1.0 - np.sin(angle)), 4 * (n - 1) + 1)
    period = 8 * (n - 1) + 2
    # On the hub the ring's points lie opposite each other in planes x = constant, so that the hub's rows cannot fold
    # round the blunt nose; up the fillet they slide to their places on the blade.
    base = _base_parameters(fine_x[0], n)
    usual = np.concatenate([[0.0], 1.0 + 4.0 * np.arange(2 * n - 1)])
    slide = np.cos(angle)[:, None]
    position = base * slide + usual * (1.0 - slide)
    index = np.arange(-4, period + 5)
    ring_x = np.zeros((counts.fillet, 2 * n))
    ring_theta = np.zeros_like(ring_x)
    for k in range(counts.fillet):
        wrapped = np.mod(index, period)
        ring_x[k] = np.interp(position[k], index, fine_x[k][wrapped])
        ring_theta[k] = np.interp(position[k], index, fine_theta[k][wrapped])
    start = hub.radius + fillet
    outward = np.sqrt(1.0 - start) * np.arange(counts.span, -1, -1) / counts.span
    radii = 1.0 - outward**2
    radii[0], radii[-1] = start, 1.0
    grid = blade_surface(propeller).evaluate(blade_parameters(propeller, radii), np.linspace(0.0, 1.0, 2 * n - 1))
    grid /= 0.5 * propeller.diameter
    rings = np.concatenate([0.5 * (grid[:, :1] + grid[:, -1:]), grid], axis=1)
    tip = 0.5 * (rings[-1, 2:n] + rings[-1, -2:n:-1])
    root = to_cartesian(ring_x, fillet_radius[:, None], ring_theta)
    return np.concatenate([root.reshape(-1, 3), rings.reshape(-1, 3), tip]), ring_x[0], ring_theta[0]


def _root_contours(propeller: Propeller, radius_ratio: Array, offset: Array, points: int) -> tuple[Array, Array]:
    """Closed outlines near the root, each pushed outwards by its own ``offset``: (x, theta), (nr, 2 points + 1).

    From the middle of the trailing edge over the back, ``points`` on each side.
    """
    sections = propeller.table.at(radius_ratio)
    s, back, face = finite_edge_points(sections, cosine_chord_fractions(points))
    middle = 0.5 * (back[:, -1:] + face[:, -1:])
    along = np.concatenate([s[:, -1:], s[:, ::-1], s[:, 1:], s[:, -1:]], axis=1)
    across = np.concatenate([middle, back[:, ::-1], face[:, 1:], middle], axis=1)
    return pushed_outwards(sections, along, across, offset)


def _base_parameters(x: Array, n: int) -> Array:
    """Where on the fine root outline the hub's ring has its points: index positions (2 n,), ascending.

    Ring point 0 is the outline's last along the shaft, point n its first; m and 2 n - m have the same x.
    """
    # the fine outline is closed and begins at the trailing edge, over the back
    count = x.size - 1
    first, last = int(np.argmin(x[:-1])), int(np.argmax(x[:-1]))
    if last > count // 2:
        last -= count
    back = np.arange(last, first + 1)
    face = np.arange(first, last + count + 1)
    stations = x[first] + (x[last % count] - x[first]) * cosine_chord_fractions(n + 1)
    over_back = np.interp(stations[::-1], x[back % count][::-1], back[::-1].astype(np.float64))
    over_face = np.interp(stations, x[face % count], face.astype(np.float64))
    over_back[0], over_back[-1] = last, first
    return np.concatenate([over_back, over_face[1:-1]])


def _sector(
    propeller: Propeller, hub: Hub, counts: _Counts, base_x: Array, base_theta: Array
) -> tuple[Array, Array, Array]:
    """Vertices of the hub between the key blade's face and the next blade's back."""
    n, between = counts.chord, counts.between
    sector = 2.0 * np.pi / propeller.blade_count
    fraction = np.arange(between + 1) / between
    back_theta = base_theta[n - np.arange(n + 1)]
    face_theta = base_theta[(n + np.arange(n + 1)) % (2 * n)]
    rows = face_theta[:, None] + (back_theta[:, None] + sector - face_theta[:, None]) * fraction
    row_x = np.broadcast_to(base_x[n - np.arange(n + 1)][:, None], rows.shape)
    ahead_x = _graded(hub.root_start, hub.face_x, counts.ahead)
    cap = np.sin(0.5 * np.pi * np.arange(counts.behind) / counts.behind)
    behind_x = hub.cylinder_end + (hub.cap_x - hub.cylinder_end) * cap
    seams = fraction[:-1] * sector
    ends_x = np.concatenate([ahead_x, behind_x])
    ends_theta = np.concatenate(
        [
            np.broadcast_to(seams + base_theta[n], (counts.ahead, between)),
            np.broadcast_to(seams + base_theta[0], (counts.behind, between)),
        ]
    )
    x = np.concatenate([np.repeat(ends_x, between), row_x[:, 1:-1].ravel()])
    radius = np.concatenate([np.repeat(hub.radius_at(ends_x), between), np.full((n + 1) * (between - 1), hub.radius)])
    theta = np.concatenate([ends_theta.ravel(), rows[:, 1:-1].ravel()])
    return x, radius, theta


def _graded(start: float, end: float, count: int) -> Array:
    """``count`` positions after ``start``, the last is ``end``."""
    return start + (end - start) * np.arange(1, count + 1) / count


@lru_cache(maxsize=32)
def propeller_topology(blade_count: int, resolution: Resolution = "view") -> PropellerTopology:
    """Faces of the propeller mesh, the same for every design of that number of blades."""
    counts = _COUNTS[resolution]
    n, between = counts.chord, counts.between
    ring = 2 * n
    blade_size, sector_size = _blade_size(counts), _sector_size(counts)
    sectors_start = blade_count * blade_size
    end_start = sectors_start + blade_count * sector_size
    blades, hub = [], []

    rings = _blade_rings(counts)
    grid = np.arange(rings * ring).reshape(rings, ring)
    # the middle of the tip's edge closes the last ring, with the ring's own points 0 and n at its ends
    m = np.arange(ring)
    inwards = np.minimum(m, ring - m)
    tip = np.where(m == n, (rings - 1) * ring + n, rings * ring - 2 + inwards)
    tip[inwards < 2] = (rings - 1) * ring
    grid = np.concatenate([grid, tip[None, :]])
    grid = np.concatenate([grid, grid[:, :1]], axis=1)
    one_blade = _quads(grid)
    for k in range(blade_count):
        blades.append(one_blade + k * blade_size)
        here, following = k * blade_size, ((k + 1) % blade_count) * blade_size
        sector = sectors_start + k * sector_size
        sector_after = sectors_start + ((k + 1) % blade_count) * sector_size
        ends = (counts.ahead + counts.behind) * between
        cells = np.arange((counts.ahead + counts.behind) * between).reshape(-1, between)
        end_rows = np.concatenate([cells + sector, cells[:, :1] + sector_after], axis=1)
        j = np.arange(n + 1)
        inner = sector + ends + np.arange((n + 1) * (between - 1)).reshape(n + 1, between - 1)
        rows = np.concatenate([(here + (n + j) % ring)[:, None], inner, (following + n - j)[:, None]], axis=1)
        surface = np.concatenate([end_rows[: counts.ahead][::-1], rows, end_rows[counts.ahead :]])
        hub.append(_quads(surface))
        hub.append(_fan(surface[0], end_start)[:, ::-1])
        hub.append(_fan(surface[-1], end_start + 1))
    return PropellerTopology(np.concatenate(blades), np.concatenate(hub))


def _quads(grid: IntArray) -> IntArray:
    """Two triangles for each cell of an index grid; cells squeezed to a triangle or less lose what has no area."""
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return np.asarray(faces[distinct], dtype=np.int64)


def _fan(edge: IntArray, centre: int) -> IntArray:
    """Triangles from an edge to one point."""
    return np.stack([edge[:-1], np.full(edge.size - 1, centre), edge[1:]], axis=1).astype(np.int64)
