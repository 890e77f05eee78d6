"""A closed triangle mesh without slivers, as meshers of volumes want it.

Grids that follow a surface's parameters have needles where the parameters crowd (stem, tips, ends of patches) and
caps, triangles with an angle near 180 degrees. Needles go by collapsing their short edge, caps by flipping their long
one; what is left is split across. Edges between regions and sharp ones stay: a vertex on them moves along them only,
one where they meet not at all.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from hpsop_core.typing_aliases import Array, BoolArray, IntArray

LEAST_ANGLE = math.radians(1.2)
"""What is worked on, a little more than the degree that is promised."""

_ROUNDS = 12
# A triangle that moves may turn by that much; what it replaces was no more exact.
_GREATEST_TURN = math.cos(math.radians(25.0))


def least_angles(vertices: Array, faces: IntArray) -> Array:
    """Least angle of each triangle, (m,), radians; zero where it has no area."""
    corners = vertices[faces]
    angles = []
    for k in range(3):
        one, other = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angles.append(np.arctan2(_length(_cross(one, other)), np.sum(one * other, axis=1)))
    return np.asarray(np.min(angles, axis=0))


def without_slivers(
    vertices: Array, faces: IntArray, regions: IntArray, sharp: float
) -> tuple[Array, IntArray, IntArray]:
    """The same body with its slivers taken away.

    Args:
        vertices: (n, 3), m.
        faces: (m, 3) of a closed mesh with outward normals.
        regions: (m,) number of the region of each face.
        sharp: edges that turn by more stay, radians.

    Returns:
        Vertices, faces and regions; vertices keep their places, some go, a few come on edges.
    """
    work = _Work(vertices, faces, regions, sharp)
    for _ in range(_ROUNDS):
        if not work.round():
            break
    return work.result()


class _Work:
    """The mesh while it changes: faces by vertex are made into sets where they are touched."""

    def __init__(self, vertices: Array, faces: IntArray, regions: IntArray, sharp: float) -> None:
        self.vertices, self.faces, self.regions = vertices, faces.copy(), regions
        self.alive: BoolArray = np.ones(len(faces), dtype=np.bool_)
        self.waiting: set[int] = set(range(len(faces)))
        order = np.argsort(faces.ravel(), kind="stable")
        self._sorted = order // 3
        self._first = np.searchsorted(faces.ravel()[order], np.arange(len(vertices) + 1))
        self._touched: dict[int, set[int]] = {}
        self.feature = _feature_edges(vertices, faces, regions, sharp)
        self.lines = Counter(vertex for edge in self.feature for vertex in edge)

    def around(self, vertex: int) -> set[int]:
        """Faces that meet in a vertex."""
        found = self._touched.get(vertex)
        if found is None:
            found = set(self._sorted[self._first[vertex] : self._first[vertex + 1]].tolist())
            self._touched[vertex] = found
        return found

    def neighbours(self, vertex: int) -> set[int]:
        return {int(other) for face in self.around(vertex) for other in self.faces[face]} - {vertex}

    def round(self) -> bool:
        """Work once through the slivers, worst first; whether anything changed."""
        index = np.array(sorted(face for face in self.waiting if self.alive[face]), dtype=np.int64)
        self.waiting = set()
        angles = least_angles(self.vertices, self.faces[index])
        bad = index[angles < LEAST_ANGLE][np.argsort(angles[angles < LEAST_ANGLE], kind="stable")]
        changed = False
        for face in bad.tolist():
            if not self.alive[face]:
                continue
            corners = [int(vertex) for vertex in self.faces[face]]
            sides = sorted(
                (float(np.linalg.norm(self.vertices[a] - self.vertices[b])), a, b)
                for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
            )
            (shortest, a, b), (_, *middle), (longest, *long) = sides
            done = False
            if shortest < 0.3 * longest:
                done = self.collapse(a, b) or self.collapse(b, a)
            done = done or self.flip(face, long[0], long[1])
            done = done or self.collapse(a, b) or self.collapse(b, a) or self.flip(face, middle[0], middle[1])
            if not done:
                done = self._split_sliver(face, long[0], long[1], shortest < 0.1 * longest)
            if done:
                self.waiting.add(face)
            changed |= done
        return changed

    def collapse(self, gone: int, kept: int) -> bool:
        """Move a vertex onto a neighbour, if the body stays one and the triangles get better."""
        lines = self.lines.get(gone, 0)
        if lines and not (lines == 2 and _edge(gone, kept) in self.feature):
            return False
        both = self.around(gone) & self.around(kept)
        if len(both) != 2 or len(self.neighbours(gone) & self.neighbours(kept)) != 2:
            return False
        after_gone = self._beyond(gone, kept) if lines else []
        moved = sorted(self.around(gone) - both)
        before = self.faces[moved]
        after = np.where(before == gone, kept, before)
        if not self._better(np.concatenate([before, self.faces[sorted(both)]]), before, after):
            return False
        for face in both:
            self.alive[face] = False
            for vertex in self.faces[face]:
                self.around(int(vertex)).discard(face)
        self.faces[moved] = after
        self.waiting.update(moved)
        self.around(kept).update(moved)
        if lines:
            (beyond,) = after_gone
            self.feature -= {_edge(gone, kept), _edge(gone, beyond)}
            self.feature.add(_edge(kept, beyond))
        self._touched[gone] = set()
        return True

    def _beyond(self, vertex: int, side: int) -> list[int]:
        """Where the line that comes from ``side`` goes on after a vertex."""
        near = {int(other) for face in self.around(vertex) for other in self.faces[face]} - {vertex, side}
        return [other for other in near if _edge(vertex, other) in self.feature]

    def flip(self, face: int, a: int, b: int) -> bool:
        """Turn the edge between two triangles of one region, if they get better."""
        if _edge(a, b) in self.feature:
            return False
        both = self.around(a) & self.around(b)
        if len(both) != 2:
            return False
        first, second = face, next(iter(both - {face}))
        corners = self.faces[first].tolist()
        # first runs a -> b or b -> a; c is its third corner, d the other one's
        if corners[(corners.index(a) + 1) % 3] != b:
            a, b = b, a
        (c,) = set(corners) - {a, b}
        (d,) = set(self.faces[second].tolist()) - {a, b}
        if self.around(c) & self.around(d):
            return False
        before = self.faces[[first, second]]
        after = np.array([[c, a, d], [d, b, c]])
        if not self._better(before, before, after):
            return False
        self.faces[[first, second]] = after
        self.waiting |= both
        self.around(b).discard(first)
        self.around(a).discard(second)
        self.around(d).add(first)
        self.around(c).add(second)
        return True

    def _split_sliver(self, face: int, a: int, b: int, needle: bool) -> bool:
        """Halve a needle between two lines that must stay; put the apex of a cap on its long edge."""
        if needle:
            self.split(a, b, 0.5)
            return True
        (apex,) = {int(vertex) for vertex in self.faces[face]} - {a, b}
        line = self.vertices[b] - self.vertices[a]
        place = float(np.dot(self.vertices[apex] - self.vertices[a], line) / np.dot(line, line))
        new = self.split(a, b, place)
        return self.collapse(apex, new) or self.collapse(new, apex) or place > 0.0

    def split(self, a: int, b: int, place: float) -> int:
        """A new vertex on an edge, that part of the way from a to b; its number."""
        new = len(self.vertices)
        point = (1.0 - place) * self.vertices[[a]] + place * self.vertices[[b]]
        self.vertices = np.concatenate([self.vertices, point])
        self._touched[new] = set()
        for face in sorted(self.around(a) & self.around(b)):
            other, number = self.faces[face].copy(), len(self.faces)
            other[other == a] = new
            self.faces[face][self.faces[face] == b] = new
            self.faces = np.concatenate([self.faces, other[None]])
            self.regions = np.append(self.regions, self.regions[face])
            self.alive = np.append(self.alive, True)
            self.around(b).discard(face)
            (apex,) = {int(vertex) for vertex in other} - {new, b}
            for vertex in (b, apex):
                self.around(vertex).add(number)
            self._touched[new] |= {face, number}
            self.waiting |= {face, number}
        if _edge(a, b) in self.feature:
            self.feature.discard(_edge(a, b))
            self.feature |= {_edge(a, new), _edge(new, b)}
            self.lines[new] = 2
        return new

    def _better(self, replaced: IntArray, before: IntArray, after: IntArray) -> bool:
        """Whether the worst angle grows and no triangle of a size turns over."""
        if len(after) == 0:
            return False
        worst = float(np.min(least_angles(self.vertices, after)))
        if worst <= float(np.min(least_angles(self.vertices, replaced))):
            return False
        old, new = _normals(self.vertices, before), _normals(self.vertices, after)
        sound = least_angles(self.vertices, before) > 0.5 * LEAST_ANGLE
        mean = np.sum(old, axis=0)
        mean /= max(float(np.linalg.norm(mean)), 1e-300)
        turned = np.sum(_unit(old) * _unit(new), axis=1)
        return bool(np.all(turned[sound] > _GREATEST_TURN) and np.all(_unit(new) @ mean > 0.0))

    def result(self) -> tuple[Array, IntArray, IntArray]:
        kept = self.faces[self.alive]
        used, local = np.unique(kept, return_inverse=True)
        return self.vertices[used], np.asarray(local.reshape(-1, 3), dtype=np.int64), self.regions[self.alive]


def _edge(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)


def _normals(vertices: Array, faces: IntArray) -> Array:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return _cross(b - a, c - a)


def _cross(one: Array, other: Array) -> Array:
    """As ``numpy.cross``, whose preparations take longer than the three rows that are asked for most."""
    a, b, c = one[:, 0], one[:, 1], one[:, 2]
    d, e, f = other[:, 0], other[:, 1], other[:, 2]
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)


def _length(vectors: Array) -> Array:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(_length(vectors), 1e-300)[:, None])


def _feature_edges(vertices: Array, faces: IntArray, regions: IntArray, angle: float) -> set[tuple[int, int]]:
    """Edges between regions, and those at which the surface turns sharply."""
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, owner = ends[order], owner[order]
    first, second = owner[0::2], owner[1::2]
    normals = _unit(_normals(vertices, faces))
    sound = least_angles(vertices, faces) > 0.5 * LEAST_ANGLE
    sharp = (np.sum(normals[first] * normals[second], axis=1) < math.cos(angle)) & sound[first] & sound[second]
    chosen = sharp | (regions[first] != regions[second])
    return {(int(a), int(b)) for a, b in ends[0::2][chosen]}
