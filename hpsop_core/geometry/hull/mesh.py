"""Triangle meshes of a hull: for the page, for export and for checking volumes.

The topology belongs to the parent and the resolution and never changes; a design only moves vertices. Neighbouring
patches share the parameters along their common edge, so that the merged mesh is watertight.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import Hull, ParentHull
from hpsop_core.typing_aliases import Array, BoolArray, IntArray

Resolution = Literal["drag", "view", "export"]
# Cells along and across a whole hull side below and above the waterline: main length, short patches, girths; and from
# the side to the centreplane on deck and flat ends, where one long cell would be a sliver in a fine mesh.
_COUNTS: dict[str, tuple[int, int, int, int, int]] = {
    "drag": (64, 14, 26, 8, 1),
    "view": (112, 24, 36, 22, 1),
    "export": (280, 60, 96, 32, 6),
}
REGIONS = ("hull", "deck", "transom")
"""Named parts of a whole hull's surface; the boss's flat end belongs to the hull."""
# Parts of the length: neighbours agree to the rounding of the stored control points; the centreplane is met exactly.
_MERGE, _CENTREPLANE = 6e-8, 3e-10


@dataclass(frozen=True, eq=False)
class HullTopology:
    """A parent's mesh at one resolution, both sides, outward normals.

    Attributes:
        vertices: (n, 3) in the parent's frame, m.
        faces: (m, 3) indices.
        underwater: (m,) true for faces below the design waterline.
        regions: (m,) place in ``REGIONS``.
        parts: name -> (indices of the part's vertices, faces in those indices).
    """

    vertices: Array
    faces: IntArray
    underwater: BoolArray
    regions: IntArray
    parts: dict[str, tuple[IntArray, IntArray]]


@dataclass(frozen=True, eq=False)
class _Piece:
    """One grid of the port side; ``outward`` tells whether (u, v) runs so that r_u x r_v points outwards."""

    points: Array
    outward: bool
    underwater: bool
    region: str = "hull"
    hard: bool = False


def _girth_breaks(parent: ParentHull) -> dict[str, list[float]]:
    breaks: dict[str, list[float]] = {}
    for other, start, end in parent.girth.values():
        breaks.setdefault(other, []).extend([start, end])
    return breaks


def _girth_grid(breaks: list[float], cells: int) -> Array:
    """v from 0 to 1 with the breaks among the values."""
    ends = np.unique(np.array([0.0, 1.0, *breaks]))
    pieces = [np.linspace(a, b, max(2, round(cells * (b - a))) + 1)[:-1] for a, b in pairwise(ends)]
    return np.concatenate([*pieces, [1.0]])


def patch_grids(parent: ParentHull, resolution: Resolution) -> dict[str, tuple[Array, Array]]:
    """Parameters (u, v) of every patch's mesh at a resolution, agreeing along shared edges.

    Raises:
        InputError: an unknown resolution.
    """
    if resolution not in _COUNTS:
        raise InputError(f"mesh resolution '{resolution}': choose one of {', '.join(_COUNTS)}")
    main, short, below, above, _ = _COUNTS[resolution]
    breaks = _girth_breaks(parent)
    grids: dict[str, tuple[Array, Array]] = {}
    for name in [*parent.underwater, *parent.topsides]:
        base, start, end = parent.girth.get(name, (name, 0.0, 1.0))
        cells = below if name in parent.underwater else above
        whole = _girth_grid(breaks.get(base, []), cells)
        v = (whole[(whole >= start) & (whole <= end)] - start) / (end - start)
        first, last = parent.extent(parent.along.get(name, name))
        long = last - first > 0.3 * parent.length
        u = np.linspace(0.0, 1.0, (main if long else short) + 1)
        grids[name] = (u, v)
    return grids


def _flat_face(edge: Array, axis_height: Array, resolution: Resolution) -> Array:
    """Grid between an edge (k, 3) and the centreplane straight inboard of it, (k, n, 3)."""
    inner = edge.copy()
    inner[:, 1] = 0.0
    inner[:, 2] = axis_height
    cells = _COUNTS[resolution][4]
    part = np.linspace(0.0, 1.0, cells + 1)[:, None]
    return np.asarray(np.where(part < 1.0, edge[:, None] + part * (inner - edge)[:, None], inner[:, None]))


def _pieces(parent: ParentHull, resolution: Resolution) -> list[_Piece]:
    pieces: list[_Piece] = []
    points: dict[str, Array] = {}
    for name, (u, v) in patch_grids(parent, resolution).items():
        grid = parent.surface(name).evaluate(u, v)
        grid[..., 1] = np.where(np.abs(grid[..., 1]) < _CENTREPLANE * parent.length, 0.0, np.maximum(grid[..., 1], 0.0))
        points[name] = grid
        # u forward, v up on the port side: r_u x r_v points to port is (x) x (z) = -y: turned round.
        pieces.append(_Piece(grid, False, name in parent.underwater))
    for name, end in parent.caps:
        edge = points[name][0 if end == "first" else -1]
        face = _flat_face(edge, edge[:, 2], resolution)
        # Along the edge upwards, then inboard: z x (-y) = +x; an aft-facing cap is turned round.
        region = "hull" if name == "skeg" else "transom"
        pieces.append(_Piece(face, end == "last", name in parent.underwater, region, True))
    for name in parent.topsides:
        edge = points[name][:, -1]
        pieces.append(_Piece(_flat_face(edge, edge[:, 2], resolution), False, False, "deck", True))
    return pieces


def _lid(parent: ParentHull, resolution: Resolution) -> list[_Piece]:
    """The waterplane of the underwater body."""
    lids = []
    for name, (u, _) in patch_grids(parent, resolution).items():
        edge = parent.surface(name).evaluate(u, np.array([1.0]))[:, 0]
        if name in parent.underwater and np.all(np.abs(edge[:, 2] - parent.draft) < 1e-6 * parent.draft):
            edge[:, 1] = np.where(np.abs(edge[:, 1]) < _CENTREPLANE * parent.length, 0.0, np.maximum(edge[:, 1], 0.0))
            lids.append(_Piece(_flat_face(edge, edge[:, 2], resolution), False, True, "deck", True))
    return lids


def _triangles(rows: int, columns: int, outward: bool) -> IntArray:
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    a, b, c, d = corner, corner + columns, corner + columns + 1, corner + 1
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return faces if outward else faces[:, ::-1]


def _assembled(pieces: list[_Piece], length: float, merge_hard_edges: bool) -> HullTopology:
    """Both sides of the pieces as one mesh; hard edges keep their own vertices unless merged."""
    vertices, faces, flags, regions, groups = [], [], [], [], []
    first = 0
    for index, piece in enumerate(pieces):
        flat = piece.points.reshape(-1, 3)
        local = _triangles(piece.points.shape[0], piece.points.shape[1], piece.outward)
        group = index + 1 if piece.hard and not merge_hard_edges else 0
        for side in (1.0, -1.0):
            vertices.append(flat * np.array([1.0, side, 1.0]))
            faces.append((local if side > 0.0 else local[:, ::-1]) + first)
            flags.append(np.full(len(local), piece.underwater))
            regions.append(np.full(len(local), REGIONS.index(piece.region)))
            groups.append(np.full(len(flat), group))
            first += len(flat)
    points, group_of = np.concatenate(vertices), np.concatenate(groups)
    # Vertices of different groups are kept apart by a fourth coordinate.
    keyed = np.column_stack([points, group_of * length])
    pairs = cKDTree(keyed).query_pairs(_MERGE * length, output_type="ndarray")
    owner = _merged(len(points), pairs)
    kept, index_of = np.unique(owner, return_inverse=True)
    corners, triangles = points[kept], index_of[np.concatenate(faces)]
    proper = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    # A face within the centreplane is there twice, back to back, and encloses nothing.
    proper &= np.any(corners[triangles, 1] != 0.0, axis=1)
    triangles, below, region = triangles[proper], np.concatenate(flags)[proper], np.concatenate(regions)[proper]
    parts: dict[str, tuple[IntArray, IntArray]] = {}
    for name, chosen in (("underwater", below), ("topsides", ~below)):
        if np.any(chosen):
            used, local = np.unique(triangles[chosen], return_inverse=True)
            parts[name] = (used, np.asarray(local.reshape(-1, 3), dtype=np.int64))
    return HullTopology(corners, triangles, below, region, parts)


def _merged(count: int, pairs: IntArray) -> IntArray:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    lowest = np.full(int(label.max()) + 1, count)
    np.minimum.at(lowest, label, np.arange(count))
    return np.asarray(lowest[label])


_TOPOLOGIES: dict[tuple[int, str, str], tuple[ParentHull, HullTopology]] = {}


def _topology(parent: ParentHull, resolution: Resolution, kind: str) -> HullTopology:
    key = (id(parent), resolution, kind)
    found = _TOPOLOGIES.get(key)
    if found is None or found[0] is not parent:
        pieces = _pieces(parent, resolution)
        if kind == "underwater":
            pieces = [piece for piece in pieces if piece.underwater] + _lid(parent, resolution)
        found = (parent, _assembled(pieces, parent.length, merge_hard_edges=kind != "view"))
        if len(_TOPOLOGIES) > 24:
            _TOPOLOGIES.clear()
        _TOPOLOGIES[key] = found
    return found[1]


def _placed(hull: Hull, vertices: Array) -> Array:
    result: Array = vertices * np.array(hull.scale)
    result[:, 0] = hull.station_map(vertices[:, 0])
    return result


def hull_mesh(hull: Hull, resolution: Resolution = "view") -> trimesh.Trimesh:
    """The whole hull to the deck: one closed mesh, outward normals, m, ship axes.

    ``mesh.face_attributes`` tells with "underwater" the faces below the design waterline, with "region" the place of
    each in ``REGIONS``.
    """
    topology = _topology(hull.parent, resolution, "closed")
    mesh = trimesh.Trimesh(_placed(hull, topology.vertices), topology.faces, process=False)
    mesh.face_attributes["underwater"] = topology.underwater
    mesh.face_attributes["region"] = topology.regions
    return mesh


def underwater_mesh(hull: Hull, resolution: Resolution = "export") -> trimesh.Trimesh:
    """The displaced volume as a closed mesh with the waterplane as its lid, m, ship axes."""
    topology = _topology(hull.parent, resolution, "underwater")
    return trimesh.Trimesh(_placed(hull, topology.vertices), topology.faces, process=False)


def hull_view_parts(hull: Hull, resolution: Resolution = "view") -> dict[str, tuple[Array, IntArray]]:
    """Vertices (n, 3) and faces (m, 3) of "underwater" and "topsides" (with deck and transom) for smooth shading.

    The faces never change for one parent and resolution, so that a page may move vertices in place. Deck, transom and
    boss end have vertices of their own, so that their edges stay sharp under averaged normals.
    """
    topology = _topology(hull.parent, resolution, "view")
    placed = _placed(hull, topology.vertices)
    return {name: (placed[used], faces) for name, (used, faces) in topology.parts.items()}
