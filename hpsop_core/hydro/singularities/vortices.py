"""Velocities of helical and straight vortices: Wrench's closed form and the Biot-Savart law.

Everything is for circulation 1, lengths in any one unit (velocity is circulation over length).
"""

from __future__ import annotations

import numpy as np

from hpsop_core.typing_aliases import Array, IntArray

_BLOCK = 1024


def wrench_velocities(
    control_radius: Array, vortex_radius: Array, wake_advance: Array, blade_count: int
) -> tuple[Array, Array]:
    """Axial and tangential velocity at a lifting line of ``blade_count`` semi-infinite helical vortices.

    The helices start at the radial lifting lines (x = 0) at ``vortex_radius``, one on each blade, and advance
    ``wake_advance`` = r tan(beta_i) downstream for each radian; the velocity is at ``control_radius`` on a lifting
    line.

    Source: Wrench, DTMB report 1116 (1957), asymptotic closed form; relative difference to the Biot-Savart integral
    below 5e-4 of the largest velocities.

    Args:
        control_radius, vortex_radius, wake_advance: broadcast; control and vortex radii must differ.

    Returns:
        (axial, downstream positive, of a vortex whose circulation points downstream seen from inside;
        tangential, positive with the rotation): a horseshoe between r_m and r_m+1 has
        u_axial(r_m+1) - u_axial(r_m) and u_tangential(r_m) - u_tangential(r_m+1).
    """
    z = float(blade_count)
    y, y0 = np.broadcast_arrays(control_radius / wake_advance, vortex_radius / wake_advance)
    radius = np.broadcast_to(control_radius, y.shape)
    s, s0 = np.sqrt(1.0 + y**2), np.sqrt(1.0 + y0**2)
    # s - 1 loses digits for small y
    log_u = z * (np.log(y * (s0 + 1.0) / (y0 * (s + 1.0))) + s - s0)
    q = np.sqrt(s0 / s)
    g = (9.0 * y0**2 + 2.0) / s0**3 + (3.0 * y**2 - 2.0) / s**3
    inside = log_u < 0.0
    w = 1.0 / np.expm1(np.minimum(np.abs(log_u), 700.0))
    sign = np.where(inside, 1.0, -1.0)
    f = q / (2.0 * z * y0) * (w + sign * g * np.log1p(w) / (24.0 * z))
    product = 2.0 * z * y0 * f
    quarter = z / (4.0 * np.pi * radius)
    axial = quarter * y * np.where(inside, 1.0 + product, -product)
    tangential = quarter * np.where(inside, -product, 1.0 + product)
    return np.asarray(axial), np.asarray(tangential)


def polyline_normal_velocity(points: Array, first: IntArray, control_points: Array, normals: Array) -> Array:
    """Normal velocity of vortex polylines at control points, by the Biot-Savart law for straight segments.

    Args:
        points: the polylines one after the other, (n, 3); circulation 1 in the direction of the points.
        first: index of each polyline's first point, ascending from 0, (p,).
        control_points: (m, 3).
        normals: (m, 3).

    Returns:
        (p, m): the velocity at each control point along its normal, summed over each polyline's segments.
    """
    # n . ((P-A) x (P-B)) = n . (A x B) + (B-A) . (P x n): matrix products over all segments instead of a cross product
    # for each pair. The segments that join one polyline to the next are computed too, and dropped.
    along = np.ascontiguousarray(points.T)
    control = control_points.T
    directions = np.concatenate([normals, _cross(control, normals.T).T], axis=1)
    control_square = np.sum(control * control, axis=0)[:, None]
    velocity = np.zeros((control_points.shape[0], points.shape[0]))
    # Blocks whose arrays stay in the processor's cache are twice as fast as one sweep over everything.
    for begin in range(0, points.shape[0] - 1, _BLOCK):
        block = along[:, begin : begin + _BLOCK + 1]
        start, end = block[:, :-1], block[:, 1:]
        element = end - start
        triple = directions @ np.concatenate([_cross(start, end), element])
        square = (-2.0 * control_points) @ block
        square += np.sum(block * block, axis=0)
        square += control_square
        distance = np.sqrt(np.maximum(square, 0.0))
        near, far = distance[:, :-1], distance[:, 1:]
        denominator = square[:, :-1] + square[:, 1:]
        denominator -= np.sum(element * element, axis=0)
        denominator *= 0.5
        product = near * far
        denominator += product
        denominator *= product
        triple *= near + far
        np.divide(triple, denominator, out=velocity[:, begin : begin + start.shape[1]])
    velocity[:, first[1:] - 1] = 0.0
    return np.asarray(np.add.reduceat(velocity, first, axis=1).T / (4.0 * np.pi))


def _cross(a: Array, b: Array) -> Array:
    """Cross products of (3, n) arrays; numpy.cross costs several times its arithmetic on small ones."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def helix_tail_velocity(
    control_radius: Array, vortex_radius: Array, distance: Array, wake_advance: Array, blade_count: int
) -> tuple[Array, Array]:
    """Axial and tangential velocity of Z helices that begin far downstream, ``distance`` behind the point.

    Far away the Z helices are a vortex cylinder: its rings act like a flux that leaves through the open end, its axial
    lines like a line charge of vorticity. Both fall with the square of the distance; the error is of the fourth power.
    The sign is that of a helix that runs downstream. All arguments broadcast.
    """
    ring = blade_count / (2.0 * np.pi * wake_advance)
    reach = distance**2 + control_radius**2 + 0.75 * vortex_radius**2
    axial = ring * vortex_radius**2 * distance / (4.0 * reach**1.5)
    tangential = -blade_count * control_radius / (8.0 * np.pi * reach)
    return np.asarray(axial), np.asarray(tangential)
