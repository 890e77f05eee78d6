"""Potentials that constant-strength dipole and source panels induce, for bodies with blades.

The kernels stand alone: quadrilaterals in, influence matrices out. What they compute at a point P, for a panel with
outward normal n and a point Q on it,

    dipole  D = integral of n . (P - Q) / |P - Q|^3 dS       (the solid angle; -4 pi inside a closed body, 0 outside)
    source  S = integral of 1 / |P - Q| dS

* Near: D is the solid angle of the four straight edges (Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983,
  eq. 8, on two triangles whose half angles are added as complex numbers). It equals the solid angle of the bilinear
  (hyperboloidal) panel modulo 4 pi, so the branch is chosen by the side of the bilinear panel on which P lies: the
  method's surface is the bilinear one, and neighbouring panels share edges without gap. S is Hess and Smith's
  (1966) formula on the panel's mean plane.
* Far (beyond `FAR_DIAGONALS` diagonals): multipole expansion about the centroid with second moments. Its error at
  the switch is about 1e-5 of the value, so forces stay smooth when a varied geometry carries a pair across it.

Rotational symmetry (blade_count images about the x axis) is summed inside: the point is rotated, not the panels.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, log, pi, sin, sqrt
from typing import Any

import numpy as np

from hpsop_core.compiled import njit
from hpsop_core.typing_aliases import Array, IntArray

FAR_DIAGONALS = 3.0
_SLIVER = 1e-6
_TWO_PI = 2.0 * pi
_FOUR_PI = 4.0 * pi


@dataclass(frozen=True)
class PanelSet:
    """Bilinear quadrilateral panels with the local data that the kernels need.

    Attributes:
        corners: (n, 4, 3), counter-clockwise about the outward normal; a triangle repeats a corner.
        centre: (n, 3) centroid of the projection on the mean plane.
        axes: (n, 3, 3) rows e1, e2, n of the local frame.
        local: (n, 4, 3) corners in the local frame, relative to the centre; the third column is +-twist.
        moments: (n, 10) of the projected panel about its centroid: area, Ixx, Iyy, Ixy, largest diagonal; then what
            twist adds to the far field of the dipoles: the symmetric part of the integral of n (x) Q, Txx + ..., as
            -trace, 3 Txx, 3 Tyy, 3 Tzz, 6 Txy (the xz and yz terms are of higher order in the twist).
    """

    corners: Array
    centre: Array
    axes: Array
    local: Array
    moments: Array

    @property
    def count(self) -> int:
        return int(self.corners.shape[0])

    @property
    def columns(self) -> Array:
        """(22, n) what the far field needs: centre, axes row by row, moments."""
        return np.ascontiguousarray(np.concatenate([self.centre, self.axes.reshape(-1, 9), self.moments], axis=1).T)


def panel_set(corners: Array) -> PanelSet:
    """Local frames and moments of quadrilaterals `corners` (n, 4, 3)."""
    corners = np.ascontiguousarray(corners, dtype=np.float64)
    diagonal_1 = corners[:, 2] - corners[:, 0]
    diagonal_2 = corners[:, 3] - corners[:, 1]
    area_vector = 0.5 * _cross(diagonal_1, diagonal_2)
    area = _length(area_vector)
    size = np.maximum(_length(diagonal_1), _length(diagonal_2))
    safe = np.maximum(area, 1e-300)
    normal = area_vector / safe[:, None]
    along = np.where((_length(diagonal_1) >= 0.5 * size)[:, None], diagonal_1, diagonal_2)
    along = along - np.sum(along * normal, axis=1)[:, None] * normal
    e1 = along / np.maximum(_length(along), 1e-300)[:, None]
    e2 = _cross(normal, e1)
    axes = np.stack([e1, e2, normal], axis=1)
    mean = corners.mean(axis=1)
    flat = np.einsum("nab,nkb->nka", axes, corners - mean[:, None, :])
    # Area, first and second moments of the projected polygon, by Green's theorem.
    x0, y0 = flat[:, :, 0], flat[:, :, 1]
    x1, y1 = np.roll(x0, -1, axis=1), np.roll(y0, -1, axis=1)
    cross = x0 * y1 - x1 * y0
    projected = np.maximum(0.5 * cross.sum(axis=1), 1e-300)
    # A sliver's centroid is lost in rounding: take the mean of its corners.
    solid = projected > _SLIVER * size**2
    cx = np.where(solid, ((x0 + x1) * cross).sum(axis=1) / (6.0 * projected), 0.0)
    cy = np.where(solid, ((y0 + y1) * cross).sum(axis=1) / (6.0 * projected), 0.0)
    ixx = ((x0 * x0 + x0 * x1 + x1 * x1) * cross).sum(axis=1) / 12.0 - projected * cx * cx
    iyy = ((y0 * y0 + y0 * y1 + y1 * y1) * cross).sum(axis=1) / 12.0 - projected * cy * cy
    ixy = ((2 * x0 * y0 + x0 * y1 + x1 * y0 + 2 * x1 * y1) * cross).sum(axis=1) / 24.0 - projected * cx * cy
    centre = mean + cx[:, None] * e1 + cy[:, None] * e2
    local = flat.copy()
    local[:, :, 0] -= cx[:, None]
    local[:, :, 1] -= cy[:, None]
    moments = np.stack([projected, ixx, iyy, ixy, size, *_twist_moments(local)], axis=1)
    return PanelSet(
        corners,
        np.ascontiguousarray(centre),
        np.ascontiguousarray(axes),
        np.ascontiguousarray(local),
        np.ascontiguousarray(moments),
    )


def _cross(a: Array, b: Array) -> Array:
    """Vector products of (n, 3): numpy's takes as long again to look at shapes."""
    return np.stack(
        [
            a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
            a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ],
        axis=1,
    )


def _length(a: Array) -> Array:
    """Lengths (n,) of (n, 3)."""
    return np.asarray(np.sqrt(a[:, 0] ** 2 + a[:, 1] ** 2 + a[:, 2] ** 2))


def _twist_moments(local: Array) -> list[Array]:
    """First moments of the normal over bilinear panels.

    With Q = m + e u + f v + h u v for u, v from -1/2 to 1/2 the normal e x f + u e x h + v h x f is linear, so the
    integral of n (x) Q is (e x f) (x) m + ((e x h) (x) e + (h x f) (x) f)/12.
    """
    a, b, c, d = (local[:, k] for k in range(4))
    middle, twist = 0.25 * (a + b + c + d), a - b + c - d
    along_u, along_v = 0.5 * (b - a + c - d), 0.5 * (d - a + c - b)
    terms = (
        (_cross(along_u, along_v), middle),
        (_cross(along_u, twist) / 12.0, along_u),
        (_cross(twist, along_v) / 12.0, along_v),
    )

    def moment(i: int, j: int) -> Array:
        return np.asarray(sum(normal[:, i] * point[:, j] for normal, point in terms))

    xx, yy, zz = moment(0, 0), moment(1, 1), moment(2, 2)
    return [-(xx + yy + zz), 3.0 * xx, 3.0 * yy, 3.0 * zz, 3.0 * (moment(0, 1) + moment(1, 0))]


@njit()
def _bilinear_height(local: Any, j: int, x: float, y: float) -> float:
    """Height of bilinear panel j at the local point (x, y): Newton on the inverse map, four steps."""
    u = 0.5
    v = 0.5
    x0, y0 = local[j, 0, 0], local[j, 0, 1]
    ax, ay = local[j, 1, 0] - x0, local[j, 1, 1] - y0
    bx, by = local[j, 3, 0] - x0, local[j, 3, 1] - y0
    cx = local[j, 2, 0] - local[j, 1, 0] - bx
    cy = local[j, 2, 1] - local[j, 1, 1] - by
    for _ in range(4):
        fx = x0 + u * ax + v * bx + u * v * cx - x
        fy = y0 + u * ay + v * by + u * v * cy - y
        jux, juy = ax + v * cx, ay + v * cy
        jvx, jvy = bx + u * cx, by + u * cy
        det = jux * jvy - juy * jvx
        if abs(det) < 1e-300:
            break
        u -= (fx * jvy - fy * jvx) / det
        v -= (jux * fy - juy * fx) / det
        u = min(max(u, -0.5), 1.5)
        v = min(max(v, -0.5), 1.5)
    z0, z1, z2, z3 = local[j, 0, 2], local[j, 1, 2], local[j, 2, 2], local[j, 3, 2]
    return float(z0 * (1 - u) * (1 - v) + z1 * u * (1 - v) + z2 * u * v + z3 * (1 - u) * v)


# Rows of the panels' data as the far field reads them, each contiguous over the panels (``PanelSet.columns``): the
# centre, the local frame, and the moments from _AREA on.
_AREA, _IXX, _IYY, _IXY, _SIZE, _TRACE, _TXX, _TYY, _TZZ, _TXY = range(12, 22)


# A division by zero is a near panel's, whose far field nobody uses; looked for, it would keep the loop from running on
# several panels at once.
@njit(error_model="numpy")
def _far_field(m: Any, px: float, py: float, pz: float, far2: float, dipole: Any, source: Any, beyond: Any) -> None:
    """Unit dipoles and sources on all panels at a point, by moments up to the second order, sources on flat panels.

    Writes both, each (n,), and ``beyond``: below zero where the point lies as far away as this needs. ``source`` may be
    empty: then dipoles alone.
    """
    count = m.shape[1]
    for j in range(count):
        rx = px - m[0, j]
        ry = py - m[1, j]
        rz = pz - m[2, j]
        r2 = rx * rx + ry * ry + rz * rz
        x = m[3, j] * rx + m[4, j] * ry + m[5, j] * rz
        y = m[6, j] * rx + m[7, j] * ry + m[8, j] * rz
        z = m[9, j] * rx + m[10, j] * ry + m[11, j] * rz
        q = 1.0 / r2
        area, ixx, iyy, ixy = m[_AREA, j], m[_IXX, j], m[_IYY, j], m[_IXY, j]
        form = ixx * x * x + 2.0 * ixy * x * y + iyy * y * y
        flat = area + q * (-1.5 * (ixx + iyy) + 7.5 * q * form)
        twist = m[_TRACE, j] + q * (m[_TXX, j] * x * x + m[_TYY, j] * y * y + m[_TZZ, j] * z * z + m[_TXY, j] * x * y)
        dipole[j] = (z * flat + twist) * q * sqrt(q)
        size = m[_SIZE, j]
        beyond[j] = far2 * size * size - r2
    if source.size == 0:
        return
    for j in range(count):
        rx = px - m[0, j]
        ry = py - m[1, j]
        rz = pz - m[2, j]
        q = 1.0 / (rx * rx + ry * ry + rz * rz)
        x = m[3, j] * rx + m[4, j] * ry + m[5, j] * rz
        y = m[6, j] * rx + m[7, j] * ry + m[8, j] * rz
        area, ixx, iyy, ixy = m[_AREA, j], m[_IXX, j], m[_IYY, j], m[_IXY, j]
        form = ixx * x * x + 2.0 * ixy * x * y + iyy * y * y
        source[j] = sqrt(q) * (area + q * (-0.5 * (ixx + iyy) + 1.5 * q * form))


@njit()
def _flat_solid_angle(local: Any, j: int, x: float, y: float, z: float) -> float:
    """Size of the solid angle of panel j projected on its mean plane (what the source potential needs)."""
    ax, ay = local[j, 0, 0] - x, local[j, 0, 1] - y
    bx, by = local[j, 1, 0] - x, local[j, 1, 1] - y
    cx, cy = local[j, 2, 0] - x, local[j, 2, 1] - y
    dx, dy = local[j, 3, 0] - x, local[j, 3, 1] - y
    z2 = z * z
    ra = sqrt(ax * ax + ay * ay + z2)
    rb = sqrt(bx * bx + by * by + z2)
    rc = sqrt(cx * cx + cy * cy + z2)
    rd = sqrt(dx * dx + dy * dy + z2)
    common = ra * rc + ax * cx + ay * cy + z2
    # With every corner at height -z the triple product is -z times twice the triangle's area.
    triple_1 = z * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    triple_2 = z * ((cx - ax) * (dy - ay) - (cy - ay) * (dx - ax))
    real_1 = rb * common + (ax * bx + ay * by + z2) * rc + (bx * cx + by * cy + z2) * ra
    real_2 = rd * common + (cx * dx + cy * dy + z2) * ra + (dx * ax + dy * ay + z2) * rc
    return float(abs(2.0 * atan2(triple_1 * real_2 + triple_2 * real_1, real_1 * real_2 - triple_1 * triple_2)))


@njit()
def _solid_angle(local: Any, j: int, x: float, y: float, z: float) -> float:
    """Dipole influence of bilinear panel j at the local point (x, y, z)."""
    ax, ay, az = local[j, 0, 0] - x, local[j, 0, 1] - y, local[j, 0, 2] - z
    bx, by, bz = local[j, 1, 0] - x, local[j, 1, 1] - y, local[j, 1, 2] - z
    cx, cy, cz = local[j, 2, 0] - x, local[j, 2, 1] - y, local[j, 2, 2] - z
    dx, dy, dz = local[j, 3, 0] - x, local[j, 3, 1] - y, local[j, 3, 2] - z
    ra = sqrt(ax * ax + ay * ay + az * az)
    rb = sqrt(bx * bx + by * by + bz * bz)
    rc = sqrt(cx * cx + cy * cy + cz * cz)
    rd = sqrt(dx * dx + dy * dy + dz * dz)
    # The diagonal a-c is shared: its cross product serves both triangles.
    kx, ky, kz = ay * cz - az * cy, az * cx - ax * cz, ax * cy - ay * cx
    ac = ax * cx + ay * cy + az * cz
    triple_1 = -(kx * bx + ky * by + kz * bz)
    triple_2 = kx * dx + ky * dy + kz * dz
    common = ra * rc + ac
    real_1 = rb * common + (ax * bx + ay * by + az * bz) * rc + (bx * cx + by * cy + bz * cz) * ra
    real_2 = rd * common + (cx * dx + cy * dy + cz * dz) * ra + (dx * ax + dy * ay + dz * az) * rc
    omega = -2.0 * atan2(triple_1 * real_2 + triple_2 * real_1, real_1 * real_2 - triple_1 * triple_2)
    if abs(omega) > pi:
        above = z > _bilinear_height(local, j, x, y)
        if above and omega < 0.0:
            omega += _FOUR_PI
        elif (not above) and omega > 0.0:
            omega -= _FOUR_PI
    return float(omega)


@njit()
def _own_solid_angle(local: Any, m: Any, j: int, x: float, y: float) -> float:
    """Principal value of the dipole influence of bilinear panel j at its own point (x, y).

    It is half way between the two sides of the panel. The point is lifted a little towards the outside: on the
    diagonal that the two triangles share, their half angles are undefined.
    """
    lift = 1e-6 * m[_AREA, j] / max(m[_SIZE, j], 1e-300)
    return float(_solid_angle(local, j, x, y, _bilinear_height(local, j, x, y) + lift) - _TWO_PI)


@njit()
def _source_potential(local: Any, j: int, x: float, y: float, z: float) -> float:
    """Source influence of panel j, taken flat in its mean plane, at the local point (x, y, z)."""
    total = 0.0
    z2 = z * z
    x1, y1 = local[j, 3, 0], local[j, 3, 1]
    r1 = sqrt((x - x1) * (x - x1) + (y - y1) * (y - y1) + z2)
    for k in range(4):
        x2, y2 = local[j, k, 0], local[j, k, 1]
        r2 = sqrt((x - x2) * (x - x2) + (y - y2) * (y - y2) + z2)
        ex, ey = x2 - x1, y2 - y1
        length = sqrt(ex * ex + ey * ey)
        if length > 1e-14:
            gap = r1 + r2 - length
            if gap > 1e-14 * length:
                total += (ex * (y - y1) - ey * (x - x1)) / length * log((r1 + r2 + length) / gap)
        x1, y1, r1 = x2, y2, r2
    return float(total - abs(z) * _flat_solid_angle(local, j, x, y, z))


@njit()
def _local(m: Any, j: int, px: float, py: float, pz: float) -> tuple[float, float, float]:
    """A point in the local frame of panel j."""
    rx = px - m[0, j]
    ry = py - m[1, j]
    rz = pz - m[2, j]
    return (
        m[3, j] * rx + m[4, j] * ry + m[5, j] * rz,
        m[6, j] * rx + m[7, j] * ry + m[8, j] * rz,
        m[9, j] * rx + m[10, j] * ry + m[11, j] * rz,
    )


@njit()
def _body_influence(points: Any, own: Any, blade_count: int, m: Any, local: Any, far: float) -> Any:
    n_points = points.shape[0]
    n_panels = m.shape[1]
    dipole = np.zeros((n_points, n_panels))
    source = np.zeros((n_points, n_panels))
    beyond = np.zeros(n_panels)
    far_dipole = np.zeros(n_panels)
    far_source = np.zeros(n_panels)
    for k in range(blade_count):
        c = cos(_TWO_PI * k / blade_count)
        s = sin(_TWO_PI * k / blade_count)
        for i in range(n_points):
            px = points[i, 0]
            py = c * points[i, 1] + s * points[i, 2]
            pz = -s * points[i, 1] + c * points[i, 2]
            _far_field(m, px, py, pz, far * far, far_dipole, far_source, beyond)
            for j in range(n_panels):
                if beyond[j] < 0.0:
                    dipole[i, j] += far_dipole[j]
                    source[i, j] += far_source[j]
                else:
                    x, y, z = _local(m, j, px, py, pz)
                    if k == 0 and own[i] == j:
                        dipole[i, j] += _own_solid_angle(local, m, j, x, y)
                    else:
                        dipole[i, j] += _solid_angle(local, j, x, y, z)
                    source[i, j] += _source_potential(local, j, x, y, z)
    return dipole, source


@njit()
def _strip_influence(
    points: Any, blade_count: int, strip: Any, strip_count: int, m: Any, local: Any, far: float
) -> Any:
    n_points = points.shape[0]
    n_panels = m.shape[1]
    dipole = np.zeros((n_points, strip_count))
    beyond = np.zeros(n_panels)
    far_dipole = np.zeros(n_panels)
    none = np.zeros(0)
    for k in range(blade_count):
        c = cos(_TWO_PI * k / blade_count)
        s = sin(_TWO_PI * k / blade_count)
        for i in range(n_points):
            px = points[i, 0]
            py = c * points[i, 1] + s * points[i, 2]
            pz = -s * points[i, 1] + c * points[i, 2]
            _far_field(m, px, py, pz, far * far, far_dipole, none, beyond)
            for j in range(n_panels):
                if beyond[j] < 0.0:
                    dipole[i, strip[j]] += far_dipole[j]
                else:
                    x, y, z = _local(m, j, px, py, pz)
                    dipole[i, strip[j]] += _solid_angle(local, j, x, y, z)
    return dipole


def body_influence(
    points: Array, panels: PanelSet, blade_count: int = 1, own_panel: IntArray | None = None, far: float = FAR_DIAGONALS
) -> tuple[Array, Array]:
    """Dipole and source influence matrices of panels and their rotational images.

    Args:
        points: (m, 3) points where the potential is wanted.
        panels: n panels of one blade's share of the body.
        blade_count: number of images about the x axis, 1 for none.
        own_panel: (m,) index of the panel on which point i lies, -1 for none: its dipole value is the principal
            value. None: no point lies on a panel.
        far: distance in panel diagonals beyond which the multipole expansion is used.

    Returns:
        dipole (m, n), source (m, n); on a closed body every row of `dipole` sums to -2 pi at points on the surface.
    """
    own = np.full(points.shape[0], -1, dtype=np.int64) if own_panel is None else own_panel.astype(np.int64)
    dipole, source = _body_influence(
        np.ascontiguousarray(points, dtype=np.float64),
        own,
        blade_count,
        panels.columns,
        panels.local,
        far,
    )
    return dipole, source


def strip_influence(
    points: Array, panels: PanelSet, strip: IntArray, strip_count: int, blade_count: int = 1, far: float = FAR_DIAGONALS
) -> Array:
    """Dipole influence of wake panels summed over strips (and images): (m, strip_count).

    `strip` (n,) names the strip of each wake panel; all panels of a strip carry the same dipole strength.
    """
    result: Array = _strip_influence(
        np.ascontiguousarray(points, dtype=np.float64),
        blade_count,
        strip.astype(np.int64),
        strip_count,
        panels.columns,
        panels.local,
        far,
    )
    return result
