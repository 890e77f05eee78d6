"""Meshes of a design for the 3D view, in ship axes and metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpsop_core.case import Case
from hpsop_core.design import DesignVariables
from hpsop_core.evaluation import design_hull, design_propeller
from hpsop_core.geometry.hull_mesh import hull_view_parts
from hpsop_core.geometry.propeller import Propeller
from hpsop_core.geometry.propeller_clearance import propeller_plane_x
from hpsop_core.geometry.propeller_surface import key_blade, rotate_blade

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


@dataclass(frozen=True)
class SceneGeometry:
    """What the page draws of a design.

    Attributes:
        underwater, topsides: vertices and faces, fixed topology.
        propeller: vertices about the hub's centre, turning about x, and faces.
        propeller_position: of the hub's centre.
        waterline: (n, 3) closed.
        water: a wide sheet at the waterline.
        length, breadth, draft, diameter: m.
    """

    underwater: Mesh
    topsides: Mesh
    propeller: Mesh
    propeller_position: tuple[float, float, float]
    waterline: NDArray[np.float64]
    water: Mesh
    length: float
    breadth: float
    draft: float
    diameter: float


def scene_geometry(case: Case, variables: DesignVariables) -> SceneGeometry:
    """All meshes of a design.

    Raises:
        SolverFailure: the hull or the propeller cannot be made.
    """
    hull = design_hull(case, variables)
    propeller = design_propeller(case, variables)
    parts = hull_view_parts(hull, "view")
    empty = (np.zeros((3, 3)), np.array([[0, 1, 2]]))
    port = hull.waterline()
    line = np.concatenate([port, port[::-1] * np.array([1.0, -1.0])])
    waterline = np.column_stack([line, np.full(len(line), hull.draft)])
    x0, x1, half = -0.35 * hull.length, 1.2 * hull.length, 0.45 * hull.length
    water = np.array([[x0, -half, hull.draft], [x1, -half, hull.draft], [x1, half, hull.draft], [x0, half, hull.draft]])
    return SceneGeometry(
        underwater=parts.get("underwater", empty),
        topsides=parts.get("topsides", empty),
        propeller=propeller_view_mesh(propeller),
        propeller_position=(float(propeller_plane_x(hull, propeller)), 0.0, float(hull.shaft_height)),
        waterline=waterline,
        water=(water, np.array([[0, 1, 2], [0, 2, 3]])),
        length=hull.length,
        breadth=hull.breadth,
        draft=hull.draft,
        diameter=propeller.diameter,
    )


def propeller_view_mesh(propeller: Propeller) -> Mesh:
    """Blades and a plain hub about the shaft, in ship axes with the origin at the hub's centre."""
    radii = propeller.hub_ratio * 0.98 + (1.0 - propeller.hub_ratio * 0.98) * np.sin(np.linspace(0.0, np.pi / 2, 18))
    radii = np.minimum(radii, 0.9995)
    chord = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 15))
    back, face = key_blade(propeller, radii, chord)
    grid = np.concatenate([back, face[:, -2:0:-1]], axis=1)
    rows, columns = grid.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1], index[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    vertices, triangles = [], []
    for blade in range(propeller.blade_count):
        triangles.append(faces + blade * rows * columns)
        vertices.append(rotate_blade(grid, blade, propeller.blade_count).reshape(-1, 3))
    angle = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
    profile = np.array([[-0.32, 0.0], [-0.32, 1.0], [0.32, 0.95], [0.42, 0.8], [0.5, 0.45], [0.52, 0.0]])
    ring = np.stack(
        [
            np.column_stack(
                [
                    np.full_like(angle, x),
                    r * propeller.hub_ratio * np.sin(angle),
                    r * propeller.hub_ratio * np.cos(angle),
                ]
            )
            for x, r in profile
        ]
    )
    index = np.arange(ring.shape[0] * ring.shape[1]).reshape(ring.shape[:2])
    a, b = index[:-1], index[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    hub = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    triangles.append(hub + sum(len(part) for part in vertices))
    vertices.append(ring.reshape(-1, 3))
    # propeller axes: x downstream, y to starboard; ship axes: x forward, y to port
    points = np.concatenate(vertices) * 0.5 * propeller.diameter * np.array([-1.0, -1.0, 1.0])
    return points, np.concatenate(triangles)
