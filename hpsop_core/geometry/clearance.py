"""Where the propeller stands behind the hull, and how far its blades stay clear of it.

Ship axes: x forward from AP, y to port, z up from the baseline, m. Propeller axes: x downstream, y to starboard, z up.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.hub import hub_of
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.typing_aliases import Array

_ANGLES = 25
_RADII = (0.85, 0.95, 1.0)
# Sample points on a hull patch each way: 0.2 to 0.4 m apart above the propeller of a 355 m ship, so that a clearance of
# 1 m is found 10 mm too large at most.
_SAMPLES = 48


def propeller_plane_x(hull: Hull, propeller: Propeller) -> float:
    """x of the blades' generator lines in ship axes, m: the hub's forward face stands on the end of the boss."""
    return hull.boss_end_x + 0.5 * propeller.diameter * hub_of(propeller).face_x


def propeller_placement(hull: Hull, propeller: Propeller) -> Array:
    """The 4 x 4 matrix that takes points of the propeller (m, propeller axes) to ship axes: a turn about z and a shift.

    It is a proper rotation, so that a right-handed propeller stays one and normals stay outward.
    """
    matrix = np.diag([-1.0, -1.0, 1.0, 1.0])
    matrix[0, 3] = propeller_plane_x(hull, propeller)
    matrix[2, 3] = hull.shaft_height
    return matrix


def swept_points(hull: Hull, propeller: Propeller) -> Array:
    """Points of the body that the turning blade tips sweep, its port half, (n, 3), ship axes, m.

    At each of some radii the circles of the leading edge, the mid-chord and the trailing edge.
    """
    circles = _circles(propeller, propeller_plane_x(hull, propeller))
    return _on_circles(*circles, 0.5 * propeller.diameter, hull.shaft_height)


def _circles(propeller: Propeller, plane_x: float) -> tuple[Array, Array]:
    """The circles about the shaft on which the swept points lie: of each its x in ship axes, m, and r/R."""
    radii = np.array(_RADII)
    sections = propeller.table.at(radii)
    along = radii * sections.skew / np.cos(sections.pitch_angle)
    half = sections.chord_ratio * np.array([[-1.0], [0.0], [1.0]])
    downstream = 2.0 * sections.rake_ratio + (along + half) * np.sin(sections.pitch_angle)
    x = plane_x - 0.5 * propeller.diameter * downstream
    return x.ravel(), np.tile(radii, len(half))


def _on_circles(x: Array, radii: Array, tip_radius: float, shaft_height: float) -> Array:
    angle = np.linspace(0.0, np.pi, _ANGLES)
    points = np.zeros((len(x), _ANGLES, 3))
    points[..., 0] = x[:, None]
    points[..., 1] = radii[:, None] * np.sin(angle) * tip_radius
    points[..., 2] = radii[:, None] * np.cos(angle) * tip_radius + shaft_height
    return points.reshape(-1, 3)


def propeller_clearance(hull: Hull, propeller: Propeller) -> float:
    """Least distance from the swept blade tips (outside 0.85 R) to the underwater hull in m.

    Negative where the blades cut the hull: then the greatest depth of a blade point inside it.

    Args:
        hull: the design's.
        propeller: the design's.
    """
    plane_x = propeller_plane_x(hull, propeller)
    x, radii = _circles(propeller, plane_x)
    swept = _on_circles(x, radii, 0.5 * propeller.diameter, hull.shaft_height)
    near = _hull_points(hull, plane_x, propeller.diameter)
    if not len(near):
        return float(propeller.diameter)
    inside = _inside(hull, swept)
    if not np.any(inside):
        near = _candidates(near, swept, x, 0.5 * propeller.diameter * radii, hull.shaft_height)
    distance = np.asarray(cKDTree(near, balanced_tree=False, compact_nodes=False).query(swept)[0])
    return -float(distance[inside].max()) if np.any(inside) else float(distance.min())


def _hull_points(hull: Hull, x: float, reach: float) -> Array:
    """Sample points of the underwater hull whose stations lie within ``reach`` of x, (n, 3), m."""
    parameters = np.linspace(0.0, 1.0, _SAMPLES)
    parent = np.concatenate([hull.parent.points(name, parameters, parameters) for name in hull.parent.underwater])
    # x depends on u alone: most of a hull need not be looked at, and one call moves the stations of all patches.
    stations = hull.station_map(parent[:, 0, 0])
    rows = np.flatnonzero(np.abs(stations - x) < reach)
    points: Array = parent[rows] * np.array(hull.scale)
    points[..., 0] = stations[rows, None]
    return points.reshape(-1, 3)


def _candidates(samples: Array, swept: Array, x: Array, radii: Array, shaft_height: float) -> Array:
    """The hull's points that can be the nearest: as near to the circles of the swept points as a known distance.

    The circles' x and radii are in m. A tree of what is left costs a tenth of one of all.
    """
    from_shaft = np.sqrt(samples[:, 1] ** 2 + (samples[:, 2] - shaft_height) ** 2)
    square = np.min((samples[:, 0] - x[:, None]) ** 2 + (from_shaft - radii[:, None]) ** 2, axis=0)
    known = np.min(np.sum((swept - samples[np.argmin(square)]) ** 2, axis=1))
    # a circle is not farther than its points, but for rounding
    return np.asarray(samples[square <= known * (1.0 + 1e-9)])


def _inside(hull: Hull, points: Array) -> Array:
    """Which points (n, 3), y >= 0, lie inside the underwater hull, by its table of half-breadths."""
    table = hull.offset_table()
    station = np.clip(np.searchsorted(table.x, points[:, 0]), 1, len(table.x) - 1)
    level = np.clip(np.searchsorted(table.z, points[:, 2]), 1, len(table.z) - 1)
    along = (points[:, 0] - table.x[station - 1]) / (table.x[station] - table.x[station - 1])
    up = (points[:, 2] - table.z[level - 1]) / (table.z[level] - table.z[level - 1])
    lower = (1.0 - along) * table.y[station - 1, level - 1] + along * table.y[station, level - 1]
    upper = (1.0 - along) * table.y[station - 1, level] + along * table.y[station, level]
    half_breadth = (1.0 - up) * lower + up * upper
    within = (along >= 0.0) & (along <= 1.0) & (up >= 0.0) & (up <= 1.0)
    return np.asarray(within & (half_breadth > points[:, 1]))


def baseline_clearance(hull: Hull, propeller: Propeller) -> float:
    """Height of the lowest blade tip above the baseline in m; negative where the blades reach below it."""
    return hull.shaft_height - 0.5 * propeller.diameter
