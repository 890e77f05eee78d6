"""Hydrostatics of a hull made of section patches, exact on the surface.

Every patch has x = X(u), so that volume integrals are integrals of polynomials over knot spans: Gauss points integrate
them to rounding. A new design scales and shifts what was integrated once on its parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.hull.form import LongitudinalShift
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, IntArray

GAUSS_POINTS = 5
SURFACE_POINTS_U, SURFACE_POINTS_V = 2, 4
# The shift bends within metres near midships, where knots are far apart: spans are cut to this part of the length.
LONGEST_SPAN = 1.0 / 140.0


@dataclass(frozen=True, eq=False)
class Hydrostatics:
    """Upright, even keel, at the design draft; SI units, x from the aft perpendicular.

    Attributes:
        displaced_volume: m3, moulded.
        wetted_surface: m2, static.
        longitudinal_centre_of_buoyancy, vertical_centre_of_buoyancy: m, from AP and from the baseline.
        block_coefficient: volume over length x breadth x draft.
        prismatic_coefficient: block over midship coefficient.
        midship_coefficient: largest sectional area over breadth x draft.
        waterplane_coefficient: waterplane area over length x breadth.
        waterplane_area: m2.
        transverse_metacentric_radius: BM in m.
        sectional_area_x, sectional_area: the sectional-area curve, m and m2, both sides.
    """

    displaced_volume: float
    wetted_surface: float
    longitudinal_centre_of_buoyancy: float
    vertical_centre_of_buoyancy: float
    block_coefficient: float
    prismatic_coefficient: float
    midship_coefficient: float
    waterplane_coefficient: float
    waterplane_area: float
    transverse_metacentric_radius: float
    sectional_area_x: Array
    sectional_area: Array

    @property
    def metacentre_height(self) -> float:
        """KM = KB + BM in m above the baseline, transverse, for small angles of heel."""
        return self.vertical_centre_of_buoyancy + self.transverse_metacentric_radius


@dataclass(frozen=True, eq=False)
class HullQuadrature:
    """The parent's integrands at Gauss points, all in the parent's frame.

    Attributes:
        x, width: (n,) positions of sections and their dx weights, m.
        area, height_moment: (n,) sectional area (m2) and its moment about the baseline (m3).
        waterline: (n,) half-breadth at the design waterline, m.
        surface_x: (k,) positions of the sections of the surface points, m.
        section_of: (m,) index into ``surface_x`` of every surface point.
        normal_x2, normal_y2, normal_z2: (m,) squares of the weighted area vector of both sides, m4.
        curve_x, curve_area: sectional-area curve.
    """

    x: Array
    width: Array
    area: Array
    height_moment: Array
    waterline: Array
    surface_x: Array
    section_of: IntArray
    normal_x2: Array
    normal_y2: Array
    normal_z2: Array
    curve_x: Array
    curve_area: Array
    largest_area: float


def _cut_spans(surface: NurbsSurface, longest: float) -> Array:
    """The distinct knots in u with further breaks, so that no span is longer than ``longest`` metres in x."""
    knots = np.unique(surface.knots_u)
    x = surface.evaluate(knots, np.array([0.0]))[:, 0, 0]
    parts = np.maximum(1, np.ceil(np.diff(x) / longest)).astype(int)
    pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(knots[:-1], knots[1:], parts, strict=True)]
    return np.concatenate([*pieces, knots[-1:]])


def _gauss(knots: Array, count: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights over every span between distinct knots."""
    breaks = np.unique(knots)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = 0.5 * np.diff(breaks)
    middle = 0.5 * (breaks[1:] + breaks[:-1])
    return (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()


@one_blas_thread()
def sectional_areas(surface: NurbsSurface, u: Array) -> Array:
    """Area of both sides of the sections at u, between the section and the centreplane, m2."""
    v, weight = _gauss(surface.knots_v, GAUSS_POINTS)
    points, _, across = surface.derivatives(u, v)
    return np.asarray(2.0 * (points[..., 1] * across[..., 2]) @ weight)


@one_blas_thread()
def integrate_parent(
    surfaces: Sequence[NurbsSurface], length: float, draft: float, curve_x: Array, curve_area: Array
) -> HullQuadrature:
    """Integrands of the underwater patches of a parent.

    Args:
        surfaces: underwater patches (port side), v from keel or sole to waterline or crown.
        length, draft: of the parent, m.
        curve_x, curve_area: the sectional-area curve for display.
    """
    sections: list[Array] = []
    surface_x: list[Array] = []
    normals: list[Array] = []
    owners: list[IntArray] = []
    first = 0
    for surface in surfaces:
        spans = _cut_spans(surface, LONGEST_SPAN * length)
        u, weight_u = _gauss(spans, GAUSS_POINTS)
        v, weight_v = _gauss(surface.knots_v, GAUSS_POINTS)
        points, along, across = surface.derivatives(u, v)
        area = 2.0 * (points[..., 1] * across[..., 2]) @ weight_v
        moment = 2.0 * (points[..., 1] * points[..., 2] * across[..., 2]) @ weight_v
        edge = surface.evaluate(u, np.array([1.0]))[:, 0]
        waterline = np.where(np.abs(edge[:, 2] - draft) < 1e-6 * draft, edge[:, 1], 0.0)
        sections.append(np.stack([points[:, 0, 0], along[:, 0, 0] * weight_u, area, moment, waterline]))
        v, weight_v = _gauss(surface.knots_v, SURFACE_POINTS_V)
        u, weight_u = _gauss(spans, SURFACE_POINTS_U)
        points, along, across = surface.derivatives(u, v)
        surface_x.append(points[:, 0, 0])
        vector = np.cross(along, across) * (2.0 * weight_u[:, None] * weight_v)[..., None]
        normals.append((vector**2).reshape(-1, 3))
        owners.append(np.repeat(first + np.arange(len(u)), len(v)))
        first += len(u)
    x, width, area, moment, waterline = np.concatenate(sections, axis=1)
    normal = np.concatenate(normals)
    return HullQuadrature(
        x, width, area, moment, waterline, np.concatenate(surface_x), np.concatenate(owners),
        np.ascontiguousarray(normal[:, 0]), np.ascontiguousarray(normal[:, 1]), np.ascontiguousarray(normal[:, 2]),
        curve_x, curve_area, float(np.max(curve_area)),
    )  # fmt: skip


@one_blas_thread()
def hydrostatics(
    quadrature: HullQuadrature,
    shift: LongitudinalShift,
    scale: tuple[float, float, float],
    dimensions: tuple[float, float, float],
) -> Hydrostatics:
    """Hydrostatics of the shifted and scaled parent.

    Args:
        quadrature: the parent's integrands.
        shift: longitudinal shift in the parent's frame.
        scale: factors in x, y, z.
        dimensions: length, breadth, draft of the new hull, m.
    """
    sx, sy, sz = scale
    length, breadth, draft = dimensions
    moved, stretch = shift.evaluate(quadrature.x)
    width = quadrature.width * stretch
    slices = quadrature.area * width
    volume = float(np.sum(slices))
    centre = float(slices @ moved) / volume
    height = float(quadrature.height_moment @ width) / volume
    plane = 2.0 * float(quadrature.waterline @ width)
    inertia = 2.0 / 3.0 * float(quadrature.waterline**3 @ width)
    along = (shift.evaluate(quadrature.surface_x)[1] * sx)[quadrature.section_of] ** 2
    wetted = float(
        np.sum(
            np.sqrt(
                (sy * sz) ** 2 * quadrature.normal_x2
                + along * (sz**2 * quadrature.normal_y2 + sy**2 * quadrature.normal_z2)
            )
        )
    )
    displaced = volume * sx * sy * sz
    block = displaced / (length * breadth * draft)
    midship = quadrature.largest_area * sy * sz / (breadth * draft)
    return Hydrostatics(
        displaced_volume=displaced,
        wetted_surface=wetted,
        longitudinal_centre_of_buoyancy=centre * sx,
        vertical_centre_of_buoyancy=height * sz,
        block_coefficient=block,
        prismatic_coefficient=block / midship,
        midship_coefficient=midship,
        waterplane_coefficient=plane * sx * sy / (length * breadth),
        waterplane_area=plane * sx * sy,
        transverse_metacentric_radius=inertia * sx * sy**3 / displaced,
        sectional_area_x=shift.evaluate(quadrature.curve_x)[0] * sx,
        sectional_area=quadrature.curve_area * (sy * sz),
    )
