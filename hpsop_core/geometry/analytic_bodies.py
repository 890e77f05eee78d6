"""Panels of bodies whose flow is known: ellipsoids and the Wigley hull."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.hull.panels import HullPanels, clustered, grid_quads
from hpsop_core.typing_aliases import Array

WIGLEY_DRAFT_RATIO = 0.0625


def wigley_half_breadth(x: Array, z: Array, length: float, breadth: float, draft: float) -> Array:
    """Half-breadth of the Wigley hull y = B/2 (1 - (2x/L - 1)^2)(1 - (1 - z/d)^2); z from the keel, x from AP."""
    return np.asarray(0.5 * breadth * (1.0 - (2.0 * x / length - 1.0) ** 2) * (1.0 - (1.0 - z / draft) ** 2))


def wigley_panels(
    lengthwise: int,
    girthwise: int,
    length: float = 1.0,
    breadth: float = 0.1,
    draft: float = WIGLEY_DRAFT_RATIO,
) -> HullPanels:
    """The Wigley hull as panels; its volume is 4/9 L B d, its wetted surface is measured on a fine grid."""
    x = length * clustered(lengthwise, 0.3)
    z = draft * np.linspace(0.0, 1.0, girthwise + 1)
    fine_x, fine_z = length * np.linspace(0.0, 1.0, 401), draft * np.linspace(0.0, 1.0, 201)
    waterline = np.stack([fine_x, wigley_half_breadth(fine_x, np.array(draft), length, breadth, draft)], axis=1)
    return HullPanels(
        quads=grid_quads(_wigley_points(x, z, length, breadth, draft)),
        blocks=(("wigley", lengthwise, girthwise),),
        waterline=waterline,
        length=length,
        draft=draft,
        wetted_surface=2.0 * _area(_wigley_points(fine_x, fine_z, length, breadth, draft)),
        displaced_volume=4.0 / 9.0 * length * breadth * draft,
        vertical_centre_of_buoyancy=0.625 * draft,
    )


def _wigley_points(x: Array, z: Array, length: float, breadth: float, draft: float) -> Array:
    mesh_x, mesh_z = np.meshgrid(x, z, indexing="ij")
    return np.stack([mesh_x, wigley_half_breadth(mesh_x, mesh_z, length, breadth, draft), mesh_z], axis=2)


def _area(points: Array) -> float:
    quads = grid_quads(points)
    cross = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    return float(0.5 * np.sum(np.linalg.norm(cross, axis=1)))


def ellipsoid_quads(
    lengthwise: int, girthwise: int, half_axes: tuple[float, float, float], *, whole: bool = False
) -> Array:
    """Panels (m, 4, 3) of an ellipsoid's quarter y >= 0, z <= 0 (or its half y >= 0), centred on the origin.

    Meridians from bow to stern; the panels at the ends are triangles.
    """
    along = np.pi * np.linspace(1.0, 0.0, lengthwise + 1)
    around = (np.pi if whole else 0.5 * np.pi) * np.linspace(0.0, 1.0, girthwise + 1) - 0.5 * np.pi
    a, b, c = half_axes
    x = a * np.cos(along)[:, None] * np.ones(girthwise + 1)
    y = np.maximum(b * np.sin(along)[:, None] * np.cos(around), 0.0)
    z = c * np.sin(along)[:, None] * np.sin(around)
    points = np.stack([x, y, z], axis=2)
    points[0, :, 1:] = 0.0
    points[-1, :, 1:] = 0.0
    return grid_quads(points)
