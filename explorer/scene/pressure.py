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
    """

    vertices: Array
    faces: Faces
    coefficient: Array
    note: Markup

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
    coefficient = transferred(
        points, *_nodal(field, field.quads[on_blade], field.uniform_coefficient[on_blade]), vertices, faces
    )
    note = fill("level 2, J {:.3f}, on ½ρ(V<sub>A</sub>² + (0.7πnD)²)", field.advance_coefficient)
    return PressureMap(vertices, faces, coefficient, note)


def _nodal(field: PressureField, quads: Faces, values: Array) -> tuple[Faces, Array]:
    """Triangles of some panels, and at every point the mean of the panels around it (0 where there is none)."""
    count = len(field.points)
    total = np.bincount(quads.ravel(), np.repeat(values, 4), minlength=count)
    around = np.bincount(quads.ravel(), minlength=count)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return faces, total / np.maximum(around, 1)
