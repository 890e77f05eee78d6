"""Where the propeller stands behind the hull, and how far its blade tips stay clear of it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from hpsop_core.geometry.hull import Hull
from hpsop_core.geometry.propeller import Propeller
from hpsop_core.typing_aliases import Array

# Half the hub's length over D: it holds the axial extent of P4119's root sections (0.28 D) with a little to spare.
HUB_HALF_LENGTH = 0.16
TIP_POINTS = 72
# Distances are to sample points of the hull; this spacing keeps them within about 1 % of D of the true surface.
SAMPLES = 48


def propeller_plane_x(hull: Hull, propeller: Propeller) -> float:
    """x of the blades' reference plane in ship axes, m: the hub's forward face stands on the end of the boss."""
    return hull.boss_end_x - HUB_HALF_LENGTH * propeller.diameter


def tip_circle(hull: Hull, propeller: Propeller) -> Array:
    """Points of the circle that the blade tips describe, shape (n, 3), ship axes, m."""
    angle = np.linspace(0.0, 2.0 * np.pi, TIP_POINTS, endpoint=False)
    radius = 0.5 * propeller.diameter
    x = np.full_like(angle, propeller_plane_x(hull, propeller))
    return np.stack([x, radius * np.cos(angle), hull.shaft_height + radius * np.sin(angle)], axis=1)


def propeller_clearance(hull: Hull, propeller: Propeller) -> float:
    """Least distance from the blade tips' circle to the underwater hull in m, negative where the circle is inside it.

    Args:
        hull: the design's.
        propeller: the design's.
    """
    circle = tip_circle(hull, propeller)
    table = hull.offset_table()
    station = int(np.clip(np.searchsorted(table.x, circle[0, 0]), 1, len(table.x) - 1))
    share = (circle[0, 0] - table.x[station - 1]) / (table.x[station] - table.x[station - 1])
    section = (1.0 - share) * table.y[station - 1] + share * table.y[station]
    half_breadth = np.interp(circle[:, 2], table.z, section, left=0.0, right=section[-1])
    inside = (half_breadth > np.abs(circle[:, 1])) & (circle[:, 2] > 0.0)
    parameters = np.linspace(0.0, 1.0, SAMPLES)
    samples = np.concatenate([
        patch.evaluate(parameters, parameters).reshape(-1, 3) for patch in hull.patches if patch.underwater
    ])
    near = samples[np.abs(samples[:, 0] - circle[0, 0]) < propeller.diameter]
    # The hull is symmetric: its port half and the tip's mirror image give the same distances.
    mirrored = np.stack([circle[:, 0], np.abs(circle[:, 1]), circle[:, 2]], axis=1)
    nearest = float(cKDTree(near).query(mirrored)[0].min()) if len(near) else float(propeller.diameter)
    return -nearest if np.any(inside) else nearest


def baseline_clearance(hull: Hull, propeller: Propeller) -> float:
    """Height of the lowest blade tip above the baseline in m; negative where the blades reach below it."""
    return hull.shaft_height - 0.5 * propeller.diameter
