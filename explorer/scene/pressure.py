"""A pressure of the core on the mesh that the page shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.scene.geometry import SceneGeometry
from explorer.scene.transfer import transferred
from hpsop_core.evaluation.fields import PressureField
from hpsop_core.markup import Markup, fill

Array = NDArray[np.float64]
Faces = NDArray[np.int64]


@dataclass(frozen=True)
class PressureMap:
    """A surface with pressure coefficients.

    Attributes:
        vertices: (n, 3) m in ship axes; faces: (m, 3).
        coefficient: (n,), as the note says.
        note: for the legend.
        reserve: (n,) how far the coefficient lies above the one at which the water evaporates, or None.
    """

    vertices: Array
    faces: Faces
    coefficient: Array
    note: Markup
    reserve: Array | None = None

    def evaporating(self) -> Array:
        """The edge of the area below vapour pressure: (k, 2, 3) segments a little off the surface; none is fine."""
        if self.reserve is None:
            return np.zeros((0, 2, 3))
        return zero_line(self.vertices, self.faces, self.reserve)

    def areas(self) -> Array:
        """(n,) a third of the triangles around each vertex, m2."""
        corners = self.vertices[self.faces]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        shares: Array = np.bincount(self.faces.ravel(), np.repeat(area / 3.0, 3), len(self.vertices)).astype(np.float64)
        return shares


def hull_map(field: PressureField, geometry: SceneGeometry) -> PressureMap:
    """The hull's pressure on its underwater mesh."""
    vertices, faces = geometry.underwater
    coefficient = transferred(field.points, *_nodal(field, field.quads, field.uniform_coefficient), vertices, faces)
    note = fill("level 2, Fn {:.3f}, on ½ρV², no hydrostatic part", field.froude_number)
    return PressureMap(vertices, faces, coefficient, note)


def blade_map(field: PressureField, geometry: SceneGeometry) -> PressureMap:
    """The blades' pressure on their mesh, about the hub's centre."""
    vertices, faces = geometry.blades
    on_blade = field.blade >= 0
    points = field.points - np.array(geometry.propeller_position)
    quads = field.quads[on_blade]

    def moved(values: Array) -> Array:
        return transferred(points, *_nodal(field, quads, values[on_blade]), vertices, faces)

    coefficient = moved(field.uniform_coefficient)
    note = fill("level 2, J {:.3f}, on ½ρ(V<sub>A</sub>² + (0.7πnD)²)", field.advance_coefficient)
    if field.vapour_coefficient is None:
        return PressureMap(vertices, faces, coefficient, note)
    reserve = moved(field.uniform_coefficient - field.vapour_coefficient)
    words = "outlined: below vapour pressure, blade upwards" if reserve.min() < 0.0 else "nowhere below vapour pressure"
    return PressureMap(vertices, faces, coefficient, note + fill("<br>{}", words), reserve)


def _nodal(field: PressureField, quads: Faces, values: Array) -> tuple[Faces, Array]:
    """Triangles of some panels, and at every point the mean of the panels around it (0 where there is none)."""
    count = len(field.points)
    total = np.bincount(quads.ravel(), np.repeat(values, 4), minlength=count)
    around = np.bincount(quads.ravel(), minlength=count)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return faces, total / np.maximum(around, 1)


def zero_line(vertices: Array, faces: Faces, values: Array) -> Array:
    """Where a field that is linear in each triangle passes through zero.

    Args:
        vertices, faces, values: (n, 3), (m, 3) and (n,); outward normals.

    Returns:
        (k, 2, 3) segments, lifted off the surface by a thousandth of its size so that it does not hide them.
    """
    below = values < 0.0
    crossed = faces[below[faces].any(axis=1) & ~below[faces].all(axis=1)]
    if not len(crossed):
        return np.zeros((0, 2, 3))
    # turned round until the corner that is alone on its side comes first
    inside = below[crossed]
    alone = inside == (inside.sum(axis=1) == 1)[:, None]
    turn = (np.argmax(alone, axis=1)[:, None] + np.arange(3)) % 3
    first, second, third = np.take_along_axis(crossed, turn, axis=1).T
    ends = []
    for other in (second, third):
        part = values[first] / (values[first] - values[other])
        ends.append(vertices[first] + part[:, None] * (vertices[other] - vertices[first]))
    normal = np.cross(vertices[second] - vertices[first], vertices[third] - vertices[first])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    lift = 1e-3 * float(np.ptp(vertices, axis=0).max())
    return np.stack(ends, axis=1) + lift * normal[:, None]
