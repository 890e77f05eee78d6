"""Velocities induced by flat source panels and by raised point sources: the kernels of the hull's panel method.

Elementary solution (Hess and Smith 1967, "Calculation of potential flow about arbitrary bodies", Progress in
Aeronautical Sciences 8): a source of unit density on a flat quadrilateral induces at P

    v(P) = 1/(4 pi) integral (P - Q)/|P - Q|^3 dS(Q)
         = 1/(4 pi) [ Omega n + sum over edges  m_i ln((r1 + r2 + l)/(r1 + r2 - l)) ],

with Omega the solid angle (positive on the side to which the normal n points), m_i the outward normal of edge i in the
panel's plane, l its length and r1, r2 the distances of P from its ends.  Far away (beyond ``FAR_DIAGONALS`` diagonals)
the panel acts as its monopole and quadrupole at the centroid (no dipole there); the next term is below
(diagonal/2r)^3, less than 1e-3 of that one panel's influence, so the switch is not felt by sums over panels.

All symmetries are images: a panel at y > 0 acts together with its reflections in y = 0 and z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hpsop_core.compiled import njit
from hpsop_core.typing_aliases import Array

FAR_DIAGONALS = 4.0
_FOUR_PI = 4.0 * math.pi


@dataclass(frozen=True)
class SourcePanels:
    """Flat quadrilaterals ready for the kernels; m panels.

    Attributes:
        corners: (m, 4, 3), projected onto each panel's mean plane; two corners may coincide (a triangle).
        centre: (m, 3) centroids.
        normal: (m, 3) unit normals, by the right-hand rule of the corners.
        area: (m,).
        diagonal: (m,) the longer diagonal of each panel.
        edge_normal: (m, 4, 3) outward unit normals of the edges in the panel's plane (zero for a collapsed edge).
        edge_length: (m, 4).
        second_moment: (m, 6) area moments xx, yy, zz, xy, xz, yz about the centroid.
    """

    corners: Array
    centre: Array
    normal: Array
    area: Array
    diagonal: Array
    edge_normal: Array
    edge_length: Array
    second_moment: Array

    @property
    def count(self) -> int:
        """Number of panels."""
        return int(self.area.shape[0])


def flat_panels(quads: Array) -> SourcePanels:
    """Flat panels from (m, 4, 3) corner points, which need not lie in one plane.

    The mean plane passes through the mean of the corners, perpendicular to the cross product of the diagonals.
    """
    diagonal_1 = quads[:, 2] - quads[:, 0]
    diagonal_2 = quads[:, 3] - quads[:, 1]
    cross = np.cross(diagonal_1, diagonal_2)
    twice_area = np.linalg.norm(cross, axis=1)
    safe = np.where(twice_area > 0.0, twice_area, 1.0)
    normal = cross / safe[:, None]
    mean = quads.mean(axis=1)
    height = np.einsum("mkc,mc->mk", quads - mean[:, None, :], normal)
    corners = quads - height[:, :, None] * normal[:, None, :]

    # Two triangles that share the first diagonal; signed areas keep a concave quadrilateral right.
    a, b, c, d = (corners[:, k] for k in range(4))
    area_1 = 0.5 * np.einsum("mc,mc->m", np.cross(b - a, c - a), normal)
    area_2 = 0.5 * np.einsum("mc,mc->m", np.cross(c - a, d - a), normal)
    area = area_1 + area_2
    safe_area = np.where(area != 0.0, area, 1.0)
    centre = (area_1[:, None] * (a + b + c) + area_2[:, None] * (a + c + d)) / (3.0 * safe_area[:, None])

    moment = np.zeros((quads.shape[0], 3, 3))
    for weight, triangle in ((area_1, (a, b, c)), (area_2, (a, c, d))):
        # Exact for a triangle: the three edge midpoints, each with a third of the area.
        for k in range(3):
            middle = 0.5 * (triangle[k] + triangle[(k + 1) % 3]) - centre
            moment += (weight / 3.0)[:, None, None] * middle[:, :, None] * middle[:, None, :]
    second_moment = np.stack(
        [moment[:, 0, 0], moment[:, 1, 1], moment[:, 2, 2], moment[:, 0, 1], moment[:, 0, 2], moment[:, 1, 2]], axis=1
    )

    edges = np.roll(corners, -1, axis=1) - corners
    edge_length = np.linalg.norm(edges, axis=2)
    safe_length = np.where(edge_length > 0.0, edge_length, 1.0)
    edge_normal = np.cross(edges, normal[:, None, :]) / safe_length[:, :, None]
    diagonal = np.maximum(np.linalg.norm(diagonal_1, axis=1), np.linalg.norm(diagonal_2, axis=1))
    return SourcePanels(
        corners=np.ascontiguousarray(corners),
        centre=np.ascontiguousarray(centre),
        normal=normal,
        area=area,
        diagonal=diagonal,
        edge_normal=np.ascontiguousarray(edge_normal),
        edge_length=np.ascontiguousarray(edge_length),
        second_moment=second_moment,
    )


@njit(inline="always")
def _solid_angle_triangle(
    ax: float, ay: float, az: float, bx: float, by: float, bz: float, cx: float, cy: float, cz: float,
    ra: float, rb: float, rc: float,
) -> float:  # fmt: skip
    """Solid angle of a triangle seen from the origin, positive on the normal's side (Van Oosterom, Strackee 1983)."""
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    denominator = (
        ra * rb * rc
        + (ax * bx + ay * by + az * bz) * rc
        + (bx * cx + by * cy + bz * cz) * ra
        + (cx * ax + cy * ay + cz * az) * rb
    )
    return -2.0 * math.atan2(triple, denominator)


@njit()
def _near(
    px: float, py: float, pz: float, corners: Array, normal: Array, edge_normal: Array, edge_length: Array
) -> tuple[float, float, float]:
    """4 pi times the velocity at P of one unit-density panel, by the closed form."""
    ax, ay, az = corners[0, 0] - px, corners[0, 1] - py, corners[0, 2] - pz
    bx, by, bz = corners[1, 0] - px, corners[1, 1] - py, corners[1, 2] - pz
    cx, cy, cz = corners[2, 0] - px, corners[2, 1] - py, corners[2, 2] - pz
    dx, dy, dz = corners[3, 0] - px, corners[3, 1] - py, corners[3, 2] - pz
    ra = math.sqrt(ax * ax + ay * ay + az * az)
    rb = math.sqrt(bx * bx + by * by + bz * bz)
    rc = math.sqrt(cx * cx + cy * cy + cz * cz)
    rd = math.sqrt(dx * dx + dy * dy + dz * dz)
    omega = _solid_angle_triangle(ax, ay, az, bx, by, bz, cx, cy, cz, ra, rb, rc)
    omega += _solid_angle_triangle(ax, ay, az, cx, cy, cz, dx, dy, dz, ra, rc, rd)
    vx, vy, vz = omega * normal[0], omega * normal[1], omega * normal[2]
    for k in range(4):
        length = edge_length[k]
        if length > 0.0:
            if k == 0:
                total = ra + rb
            elif k == 1:
                total = rb + rc
            elif k == 2:
                total = rc + rd
            else:
                total = rd + ra
            logarithm = math.log((total + length) / max(total - length, 1e-14 * length))
            vx += edge_normal[k, 0] * logarithm
            vy += edge_normal[k, 1] * logarithm
            vz += edge_normal[k, 2] * logarithm
    return vx, vy, vz


@njit(inline="always")
def _far(
    rx: float, ry: float, rz: float, area: float,
    xx: float, yy: float, zz: float, xy: float, xz: float, yz: float,
) -> tuple[float, float, float]:  # fmt: skip
    """4 pi times the velocity at distance (rx, ry, rz) from the centroid: monopole and quadrupole."""
    r2 = rx * rx + ry * ry + rz * rz
    inverse_2 = 1.0 / r2
    inverse_3 = inverse_2 * math.sqrt(inverse_2)
    inverse_5 = inverse_3 * inverse_2
    mx = xx * rx + xy * ry + xz * rz
    my = xy * rx + yy * ry + yz * rz
    mz = xz * rx + yz * ry + zz * rz
    radial = area * inverse_3 + (7.5 * (mx * rx + my * ry + mz * rz) * inverse_2 - 1.5 * (xx + yy + zz)) * inverse_5
    return radial * rx - 3.0 * mx * inverse_5, radial * ry - 3.0 * my * inverse_5, radial * rz - 3.0 * mz * inverse_5


# Products and sums may be contracted into one rounding (a choice of the compiler, the same on one machine for every
# call); nothing else of the arithmetic's order may change.
_CONTRACT = {"contract"}


@njit(fastmath=_CONTRACT, error_model="numpy")
def _far_row(
    px: float, py: float, pz: float, image_z: bool, columns: Array, out_x: Array, out_y: Array, out_z: Array, gap: Array
) -> None:
    """One row of velocities by the far expansion alone, and by how much the nearest image is beyond its limit.

    Without a branch inside, and over contiguous columns: the compiler makes it four or eight panels at a time. What
    the expansion gives near a panel is replaced afterwards.
    """
    centre_x, centre_y, centre_z, area, limit = columns[0], columns[1], columns[2], columns[3], columns[4]
    xx, yy, zz, xy, xz, yz = columns[5], columns[6], columns[7], columns[8], columns[9], columns[10]
    scale = 1.0 / _FOUR_PI
    for j in range(area.shape[0]):
        rx, ry, rz = px - centre_x[j], py - centre_y[j], pz - centre_z[j]
        sy = -py - centre_y[j]
        vx, vy, vz = _far(rx, ry, rz, area[j], xx[j], yy[j], zz[j], xy[j], xz[j], yz[j])
        wx, wy, wz = _far(rx, sy, rz, area[j], xx[j], yy[j], zz[j], xy[j], xz[j], yz[j])
        out_x[j] = scale * (vx + wx)
        out_y[j] = scale * (vy - wy)
        out_z[j] = scale * (vz + wz)
        gap[j] = rx * rx + min(ry * ry, sy * sy) + rz * rz - limit[j]
    if image_z:
        for j in range(area.shape[0]):
            rx, ry, rz = px - centre_x[j], py - centre_y[j], -pz - centre_z[j]
            sy = -py - centre_y[j]
            vx, vy, vz = _far(rx, ry, rz, area[j], xx[j], yy[j], zz[j], xy[j], xz[j], yz[j])
            wx, wy, wz = _far(rx, sy, rz, area[j], xx[j], yy[j], zz[j], xy[j], xz[j], yz[j])
            out_x[j] += scale * (vx + wx)
            out_y[j] += scale * (vy - wy)
            out_z[j] -= scale * (vz + wz)
            gap[j] = min(gap[j], rx * rx + min(ry * ry, sy * sy) + rz * rz - limit[j])


@njit(fastmath=_CONTRACT, error_model="numpy")
def _panel_velocities(
    points: Array,
    image_z: bool,
    columns: Array,
    corners: Array,
    normal: Array,
    edge_normal: Array,
    edge_length: Array,
    out_x: Array,
    out_y: Array,
    out_z: Array,
) -> None:
    """Fill (n, m) velocities of m panels (each with its y-image, and its z-images when asked) at n points.

    Args:
        columns: (11, m) of the panels: centroid, area, square of the distance up to which the closed form is taken,
            second moments.
    """
    scale = 1.0 / _FOUR_PI
    gap = np.zeros(columns.shape[1])
    for i in range(points.shape[0]):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        _far_row(px, py, pz, image_z, columns, out_x[i], out_y[i], out_z[i], gap)
        for j in range(gap.shape[0]):
            if gap[j] > 0.0:
                continue
            sx = 0.0
            sy = 0.0
            sz = 0.0
            # The image of the panel seen from P is the panel seen from the image of P, reflected back.
            for image in range(4 if image_z else 2):
                sign_y = 1.0 if image % 2 == 0 else -1.0
                sign_z = 1.0 if image < 2 else -1.0
                qy = sign_y * py
                qz = sign_z * pz
                rx, ry, rz = px - columns[0, j], qy - columns[1, j], qz - columns[2, j]
                if rx * rx + ry * ry + rz * rz > columns[4, j]:
                    vx, vy, vz = _far(
                        rx, ry, rz, columns[3, j], columns[5, j], columns[6, j], columns[7, j],
                        columns[8, j], columns[9, j], columns[10, j],
                    )  # fmt: skip
                else:
                    vx, vy, vz = _near(px, qy, qz, corners[j], normal[j], edge_normal[j], edge_length[j])
                sx += vx
                sy += sign_y * vy
                sz += sign_z * vz
            out_x[i, j] = scale * sx
            out_y[i, j] = scale * sy
            out_z[i, j] = scale * sz


def panel_velocities(
    points: Array, panels: SourcePanels, *, image_z: bool, far_diagonals: float = FAR_DIAGONALS
) -> tuple[Array, Array, Array]:
    """Velocity components, each (n, m), that m unit-density panels with their y-images induce at n points.

    Args:
        points: (n, 3).
        panels: m panels at y >= 0.
        image_z: whether the reflections in z = 0 are added (the double body).
        far_diagonals: distance in panel diagonals beyond which the expansion replaces the closed form.
    """
    shape = (points.shape[0], panels.count)
    out = (np.zeros(shape), np.zeros(shape), np.zeros(shape))
    limit = (far_diagonals * panels.diagonal) ** 2
    # vstack keeps the order of its parts: transposed parts would give strided columns
    columns = np.ascontiguousarray(np.vstack([panels.centre.T, panels.area, limit, panels.second_moment.T]))
    _panel_velocities(
        points, image_z, columns, panels.corners, panels.normal, panels.edge_normal, panels.edge_length, *out
    )
    return out


@njit(fastmath=_CONTRACT, error_model="numpy")
def _point_velocities(points: Array, columns: Array, out_x: Array, out_y: Array, out_z: Array) -> None:
    """Fill (n, m) velocities of m point sources, with their y-images, at n points; columns: x, y, z, weight/4 pi."""
    x, y, z, strength = columns[0], columns[1], columns[2], columns[3]
    for i in range(points.shape[0]):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        row_x, row_y, row_z = out_x[i], out_y[i], out_z[i]
        for j in range(x.shape[0]):
            rx = px - x[j]
            ry = py - y[j]
            sy = py + y[j]
            rz = pz - z[j]
            plane = rx * rx + rz * rz
            r2 = plane + ry * ry
            s2 = plane + sy * sy
            near = strength[j] / (r2 * math.sqrt(r2))
            image = strength[j] / (s2 * math.sqrt(s2))
            row_x[j] = (near + image) * rx
            row_y[j] = near * ry + image * sy
            row_z[j] = (near + image) * rz


def _columns(sources: Array, weight: Array) -> Array:
    """(4, m) contiguous x, y, z and weight/4 pi of point sources."""
    return np.ascontiguousarray(np.vstack([sources.T, weight / _FOUR_PI]))


def point_velocities(points: Array, sources: Array, weight: Array) -> tuple[Array, Array, Array]:
    """Velocity components, each (n, m), of m point sources and their y-images at n points.

    Args:
        points: (n, 3).
        sources: (m, 3) positions, none of which may coincide with a point.
        weight: (m,) volume flux of each source for unit unknown (the cell's area).
    """
    shape = (points.shape[0], sources.shape[0])
    out = (np.zeros(shape), np.zeros(shape), np.zeros(shape))
    _point_velocities(points, _columns(sources, weight), *out)
    return out


@njit(fastmath=_CONTRACT, error_model="numpy")
def _surface_influence(points: Array, columns: Array, u: Array, v: Array, along: Array, vertical: Array) -> None:
    """Fill (n, m): U.grad(p) and p_z at points on z = 0 for unit point sources with their y-images."""
    x, y, height, strength = columns[0], columns[1], columns[2], columns[3]
    for i in range(points.shape[0]):
        px, py, ui, vi = points[i, 0], points[i, 1], u[i], v[i]
        row, down = along[i], vertical[i]
        for j in range(x.shape[0]):
            rx = px - x[j]
            ry = py - y[j]
            sy = py + y[j]
            plane = rx * rx + height[j] * height[j]
            r2 = plane + ry * ry
            s2 = plane + sy * sy
            near = strength[j] / (r2 * math.sqrt(r2))
            image = strength[j] / (s2 * math.sqrt(s2))
            row[j] = ui * (near + image) * rx + vi * (near * ry + image * sy)
            down[j] = -(near + image) * height[j]


def surface_influence(points: Array, sources: Array, weight: Array, u: Array, v: Array) -> tuple[Array, Array]:
    """What raised point sources with their y-images do on the water surface.

    Args:
        points: (n, 3) on z = 0.
        sources: (m, 3) above it.
        weight: (m,) cell areas.
        u, v: (n,) horizontal base velocity at the points.

    Returns:
        U.grad(p) and p_z, each (n, m).
    """
    shape = (points.shape[0], sources.shape[0])
    along, vertical = np.zeros(shape), np.zeros(shape)
    _surface_influence(points, _columns(sources, weight), u, v, along, vertical)
    return along, vertical
