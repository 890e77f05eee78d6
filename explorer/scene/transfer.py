"""Values from a coarse surface (a solver's panels) onto a fine one (what the page shows)."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Faces = NDArray[np.int64]
_CANDIDATES = 10


def transferred(vertices: Array, faces: Faces, values: Array, onto: Array, onto_faces: Faces) -> Array:
    """The piecewise linear field of a triangulated surface at the vertices of another one beside it.

    Each vertex takes the value at the nearest point of the triangles around it that face the same way: the two sides of
    a blade lie closer together than a panel is long.

    Args:
        vertices, faces, values: (n, 3), (m, 3) and (n,) of the surface that carries the field; outward normals.
        onto, onto_faces: (k, 3) and (l, 3) of the other surface; outward normals.

    Returns:
        (k,) values, within the range of ``values``.
    """
    triangles = vertices[faces]
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(crossed, axis=1)
    # panels that end in a point leave triangles without area, in which nothing can be interpolated
    whole = area > 1e-9 * area.max()
    triangles, faces, normals = triangles[whole], faces[whole], crossed[whole] / area[whole, None]
    count = min(_CANDIDATES, len(triangles))
    near = cKDTree(triangles.mean(axis=1)).query(onto, k=count)[1].reshape(len(onto), count)
    points = np.repeat(onto, count, axis=0)
    closest = trimesh.triangles.closest_point(triangles[near.ravel()], points)
    distance = np.linalg.norm(closest - points, axis=1).reshape(near.shape)
    facing = trimesh.Trimesh(onto, onto_faces, process=False).vertex_normals
    same = np.einsum("kcj,kj->kc", normals[near], facing) > 0.0
    # where no candidate faces the same way (a sharp edge), the nearest one has to do
    distance = np.where(same, distance, distance + 1e6)
    best = np.argmin(distance, axis=1)
    rows = np.arange(len(onto))
    chosen = near[rows, best]
    at = closest.reshape(*near.shape, 3)[rows, best]
    weights = np.clip(trimesh.triangles.points_to_barycentric(triangles[chosen], at), 0.0, 1.0)
    weights /= weights.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("kj,kj->k", weights, values[faces[chosen]]))
