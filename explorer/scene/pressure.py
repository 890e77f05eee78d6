"""The pressure on a hull at a condition, by level 2's panels, on the mesh that the page shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.scene.transfer import transferred
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.mesh import hull_view_parts
from hpsop_core.geometry.hull.panels import block_points
from hpsop_core.hydro.rankine.solver import RankineFields, solve

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PressureMap:
    """A surface with pressure coefficients.

    Attributes:
        vertices: (n, 3) m in ship axes; faces: (m, 3).
        coefficient: (n,), as the note says.
        note: for the legend.
    """

    vertices: Array
    faces: NDArray[np.int64]
    coefficient: Array
    note: str

    def areas(self) -> Array:
        """(n,) a third of the triangles around each vertex, m2."""
        corners = self.vertices[self.faces]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        return np.bincount(self.faces.ravel(), np.repeat(area / 3.0, 3), minlength=len(self.vertices))


def hull_pressure(hull: Hull, froude_number: float) -> PressureMap:
    """(p - p0)/(1/2 rho V^2) without the hydrostatic part, on the underwater part of the "view" mesh.

    Raises:
        SolverFailure: the Rankine solver gives no answer.
    """
    fields = solve(hull, (froude_number,), fields=True).conditions[0].fields
    if fields is None:
        raise ValueError("the solver was asked for fields")
    vertices, faces, values = _smooth(fields)
    mirrored = vertices * np.array([1.0, -1.0, 1.0])
    shown, shown_faces = hull_view_parts(hull, "view")["underwater"]
    coefficient = transferred(
        np.concatenate([vertices, mirrored]),
        np.concatenate([faces, faces[:, ::-1] + len(vertices)]),
        np.concatenate([values, values]),
        shown,
        shown_faces,
    )
    note = f"level 2, Fn {froude_number:.3f}, on ½ρV², no hydrostatic part"
    return PressureMap(shown, shown_faces, coefficient, note)


def _smooth(fields: RankineFields) -> tuple[Array, NDArray[np.int64], Array]:
    """Panels of each block as a grid whose nodes take the mean of the panels around them."""
    vertices, faces, values = [], [], []
    start = first = 0
    for points, (_, along, across) in zip(block_points(fields.quads, fields.blocks), fields.blocks, strict=True):
        panel = fields.pressure_coefficient[start : start + along * across].reshape(along, across)
        start += along * across
        weight = np.zeros((along + 1, across + 1))
        total = np.zeros((along + 1, across + 1))
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
            total[i : i + along, j : j + across] += panel
            weight[i : i + along, j : j + across] += 1.0
        index = np.arange(weight.size).reshape(weight.shape) + first
        first += weight.size
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        # u forward, v up on the port side: turned round, so that the faces look outwards
        faces.append(np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]))
        vertices.append(points.reshape(-1, 3))
        values.append((total / weight).ravel())
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(values)
