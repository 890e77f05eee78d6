"""Triangle meshes: STL, OBJ, PLY, OFF, GLB and glTF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input.triangles import ShipTriangles, TriangleFile
from hpsop_core.typing_aliases import Array, BoolArray, IntArray

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf")
# Vertices closer than this part of the length are one: files in single precision do not repeat them exactly.
MERGE = 2e-7
# Open edges that run this close, as a part of the length, to other open edges are a seam or a crack between patches
# that were meshed apart, not a hole: sections pass over it.
SEAM = 1e-3
# Open edges within this part of the draft of the waterline are the mesh's upper rim.
RIM = 5e-3
# A separate piece smaller than this part of the whole, in area, is an appendage.
APPENDAGE_SHARE = 0.05


def read_mesh(path: Path) -> TriangleFile:
    """The triangles of a mesh file; faces of a scene are placed by its transformations.

    Raises:
        InputError: unreadable, or no triangles.
    """
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh")
    except Exception as problem:
        raise InputError(f"{path.name}: cannot be read as a mesh ({problem})") from problem
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise InputError(f"{path.name}: holds no triangles; give a mesh of the hull's surface")
    vertices, faces, notes = tidied(np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64))
    if len(faces) == 0:
        raise InputError(f"{path.name}: holds no triangles; give a mesh of the hull's surface")
    layout = f"{path.suffix[1:].upper()} mesh of {len(faces):,} triangles"
    unit = "m" if path.suffix.lower() in (".glb", ".gltf") else None
    return TriangleFile(path.name, layout, vertices, faces, unit, True, notes)


def tidied(vertices: Array, faces: IntArray) -> tuple[Array, IntArray, tuple[str, ...]]:
    """One vertex a place, no face without area, no face twice; pairs of faces back to back vanish together."""
    size = float(np.max(np.ptp(vertices, axis=0)))
    if not np.isfinite(size) or size <= 0.0:
        return vertices, faces[:0], ()
    keys = np.round(vertices / (MERGE * size)).astype(np.int64)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    merged, faces = vertices[first], place.reshape(-1)[faces]
    sound = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[sound]
    # A face's vertices in rising order, and the parity of the order that they stand in.
    order = np.argsort(faces, axis=1)
    ordered = np.take_along_axis(faces, order, axis=1)
    even = np.isin(
        order[:, 0] * 9 + order[:, 1] * 3 + order[:, 2], (0 * 9 + 1 * 3 + 2, 1 * 9 + 2 * 3 + 0, 2 * 9 + 0 * 3 + 1)
    )
    _, first, same, counts = np.unique(ordered, axis=0, return_index=True, return_inverse=True, return_counts=True)
    same = same.reshape(-1)
    balance = np.abs(np.bincount(same, weights=np.where(even, 1.0, -1.0), minlength=len(counts)))
    kept = np.sort(first[(counts == 1) | (balance > 0.0)])
    twice = int(np.sum((counts > 1) & (balance > 0.0)))
    flat = int(np.sum((counts > 1) & (balance == 0.0)))
    notes = []
    if twice:
        notes.append(f"{twice:,} faces are stored more than once: read once")
    if flat:
        notes.append(f"{flat} pairs of faces lie back to back without thickness: left out")
    return merged, faces[kept], tuple(notes)


def _components(count: int, faces: IntArray) -> tuple[int, IntArray]:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    pieces, of_vertex = connected_components(graph, directed=False)
    return int(pieces), np.asarray(of_vertex[faces[:, 0]])


def without_appendages(mesh: ShipTriangles) -> tuple[Array, tuple[str, ...]]:
    """Triangles (m, 3, 3) of the hull itself, and a note for every separate small piece that was left out."""
    corners = np.asarray(mesh.vertices[mesh.faces])
    _, of_face = _components(len(mesh.vertices), mesh.faces)
    # Vertices without faces are pieces too; only those with faces count.
    names, of_face = np.unique(of_face, return_inverse=True)
    pieces, of_face = len(names), of_face.reshape(-1)
    if pieces == 1:
        return corners, ()
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    share = np.bincount(of_face, weights=area, minlength=pieces) / float(area.sum())
    kept, notes = [], []
    for piece in range(pieces):
        part = corners[of_face == piece].reshape(-1, 3)
        low, high = part.min(axis=0), part.max(axis=0)
        # An appendage is a small solid of its own; a patch of the shell that shares no vertices with others is open.
        if share[piece] > APPENDAGE_SHARE or not _is_solid(mesh, mesh.faces[of_face == piece]):
            kept.append(piece)
        elif low[2] < mesh.draft:
            notes.append(f"left out: {looks_like(low, high, mesh.length, mesh.draft)}")
    return corners[np.isin(of_face, kept)], tuple(dict.fromkeys(notes))


def _is_solid(mesh: ShipTriangles, faces: IntArray) -> bool:
    """Whether faces have no open edges but those in the centreplane of a half hull."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    ends = mesh.vertices[unique[counts % 2 == 1]]
    return len(ends) == 0 or (mesh.half and bool(np.abs(ends[:, :, 1]).max() < 1e-3 * mesh.length))


def looks_like(low: Array, high: Array, length: float, draft: float) -> str:
    """What a piece between two corners is taken for, in words with its place."""
    size = np.maximum(high - low, 1e-12)
    middle = 0.5 * (low + high)
    at = f"at x = {middle[0]:.3g} m"
    across = float(size[1])
    centred = abs(middle[1]) < 0.02 * length and low[1] <= 0.0 <= high[1] + 1e-9
    if centred and middle[0] < 0.06 * length and across < 0.35 * size[0] and size[2] > 0.25 * draft:
        return f"a rudder {at}"
    if centred and middle[0] < 0.1 * length and across > 1.5 * size[0]:
        return f"a propeller {at}"
    if size[0] > 0.15 * length and max(across, size[2]) < 0.15 * size[0]:
        return f"a bilge keel or rail {at}"
    if middle[0] < 0.25 * length:
        return f"a shaft, strut or bossing {at}"
    if middle[0] > 0.75 * length and size[0] < 0.1 * length:
        return f"a thruster or fin {at}"
    return f"a separate piece {at}, y = {middle[1]:.3g} m, z = {middle[2]:.3g} m"


def check_holes(mesh: ShipTriangles) -> tuple[str, ...]:
    """Notes about open edges above the water; a real open edge under water is a hole.

    Edges along the mesh's rim at the waterline, along the centreplane of a half hull, and pairs of open edges that lie
    on each other (seams between pieces that do not share vertices) are none.

    Raises:
        InputError: where the hole is and how long its edge.
    """
    if not mesh.closed:
        return ()
    edges = np.sort(np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    unique = unique[counts % 2 == 1]
    if len(unique) == 0:
        return ()
    ends = mesh.vertices[unique]
    top = mesh.draft * (1.0 - RIM)
    wet = ends[:, :, 2].min(axis=1) < top
    on_centreplane = np.abs(ends[:, :, 1]).max(axis=1) < 2e-4 * mesh.length
    suspect = ends[wet & ~on_centreplane] if mesh.half else ends[wet]
    if len(suspect) == 0:
        return (f"{len(unique):,} open edges, none of them under water",)
    real = suspect[~_seams(suspect, ends, mesh.length)]
    if len(real) == 0:
        return (f"{len(suspect):,} open edges under water lie on each other: seams, not holes",)
    rest, notes = _without_open_ends(real, mesh)
    if len(rest) == 0:
        return notes
    size = float(np.sum(np.linalg.norm(real[:, 1] - real[:, 0], axis=1)))
    low, high = real.reshape(-1, 3).min(axis=0), real.reshape(-1, 3).max(axis=0)
    raise InputError(
        f"{mesh.name}: the mesh has holes under water: {len(real)} open edges, {size:.3g} m in all, from x = "
        f"{low[0]:.4g} to {high[0]:.4g} m, z = {low[2]:.3g} to {high[2]:.3g} m; close them (or is the draft of "
        f"{mesh.draft:g} m right?)"
    )


def _without_open_ends(real: Array, mesh: ShipTriangles) -> tuple[Array, tuple[str, ...]]:
    """Open edges (n, 2, 3) without those of a flat of bottom or a transom left open: sections are whole there."""
    low = mesh.vertices.min(axis=0)
    bottom = real[:, :, 2].max(axis=1) < low[2] + 0.005 * mesh.draft
    transom = real[:, :, 0].max(axis=1) < low[0] + 1e-3 * mesh.length
    notes = []
    if np.any(bottom):
        notes.append(f"the bottom is open at z = {low[2]:.3g} m: closed flat")
    if np.any(transom):
        notes.append(f"the transom is open at x = {low[0]:.4g} m: closed flat")
    return real[~bottom & ~transom], tuple(notes)


def _seams(suspect: Array, ends: Array, length: float) -> BoolArray:
    """Which of the suspect edges (n, 2, 3) lie on other open edges: their middles are close to another one."""
    from scipy.spatial import cKDTree

    step = 2.0 * SEAM * length
    points, owner = [], []
    for k, (a, b) in enumerate(ends):
        count = min(2 + int(np.linalg.norm(b - a) / step), 500)
        points.append(a + np.linspace(0.0, 1.0, count)[:, None] * (b - a))
        owner.append(np.full(count, k))
    cloud, of_edge = np.concatenate(points), np.concatenate(owner)
    tree = cKDTree(cloud)
    result = np.zeros(len(suspect), dtype=bool)
    for k, (a, b) in enumerate(suspect):
        places = a + np.array([0.25, 0.5, 0.75])[:, None] * (b - a)
        result[k] = all(_on_another(place, suspect[k], ends, of_edge, tree, length) for place in places)
    return result


def _on_another(place: Array, own: Array, ends: Array, of_edge: IntArray, tree: Any, length: float) -> bool:
    """Whether a place (3,) on an open edge lies on another open edge."""
    for near in np.unique(of_edge[tree.query_ball_point(place, 2.5 * SEAM * length)]):
        other = ends[near]
        if np.array_equal(other, own):
            continue
        along = other[1] - other[0]
        part = float(np.clip((place - other[0]) @ along / max(float(along @ along), 1e-30), 0.0, 1.0))
        if float(np.linalg.norm(other[0] + part * along - place)) < SEAM * length:
            return True
    return False
