"""Blade and hub as NURBS surfaces, for exchange with CAD.

Metres, propeller axes. The blade's surface runs from a little inside the hub to the finite tip; its trailing edge is
closed and sharp, the fillet at the root is in the meshes only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import make_interp_spline

from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.geometry.propeller.hub import hub_of
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import blade_points, finite_tip_sections, rotate_blade
from hpsop_core.typing_aliases import Array

_DEGREE = 3
_ROOT_DEPTH = 0.9
_SPAN_STATIONS = 49
_CHORD_STATIONS = 33


@dataclass(frozen=True, eq=False)
class BladeSurface:
    """The key blade as a bicubic B-spline surface.

    Attributes:
        surface: u from root to tip, v from the trailing edge over the back to the leading edge and over the face back.
        largest_deviation: normal distance from the sections' own points midway between the interpolated ones, m.
    """

    surface: NurbsSurface
    largest_deviation: float


def _radii(propeller: Propeller, count: int) -> Array:
    """Radii from inside the hub to the tip, denser towards the tip, where the chord is a root of the distance."""
    start = _ROOT_DEPTH * propeller.hub_ratio
    radii = 1.0 - (1.0 - start) * (np.arange(count)[::-1] / (count - 1)) ** 2
    radii[0], radii[-1] = start, 1.0
    return np.asarray(radii)


def blade_outlines(propeller: Propeller, radii: Array, chord_points: int) -> Array:
    """Closed sections of the key blade at r/R = radii (nr,): (nr, 2 nc - 1, 3) in m, propeller axes.

    From the trailing edge along the back to the leading edge and along the face back again.
    """
    sections = finite_tip_sections(propeller.table, radii)
    fractions = cosine_chord_fractions(chord_points)
    back, face = blade_points(sections, fractions, True), blade_points(sections, fractions, False)
    return np.concatenate([back[:, ::-1], face[:, 1:]], axis=1) * (0.5 * propeller.diameter)


def blade_nurbs(propeller: Propeller) -> BladeSurface:
    """Interpolate the key blade by a bicubic B-spline surface and measure how far it is off in between."""
    grid = blade_outlines(propeller, _radii(propeller, _SPAN_STATIONS), _CHORD_STATIONS)
    knots_u, along = _interpolate(grid)
    knots_v, across = _interpolate(np.swapaxes(along, 0, 1))
    control = np.swapaxes(across, 0, 1)
    surface = NurbsSurface(_DEGREE, _DEGREE, knots_u, knots_v, control, np.ones(control.shape[:2]))
    # twice as many sections and points: half of them lie midway between the interpolated ones
    fine = blade_outlines(propeller, _radii(propeller, 2 * _SPAN_STATIONS - 1), 2 * _CHORD_STATIONS - 1)
    u, v = np.linspace(0.0, 1.0, fine.shape[0]), np.linspace(0.0, 1.0, fine.shape[1])
    points, along_u, along_v = surface.derivatives(u, v)
    normal = np.cross(along_u, along_v)
    length = np.linalg.norm(normal, axis=-1)
    # a point that slid along the surface is no error of the shape; at the very tip edge there is no normal
    deviation = np.abs(np.sum((points - fine) * normal, axis=-1)) / np.where(length > 0.0, length, 1.0)
    return BladeSurface(surface, float(np.max(deviation)))


def _interpolate(values: Array) -> tuple[Array, Array]:
    """Clamped cubic spline through ``values`` along axis 0 at equal parameters: knots, control points."""
    spline = make_interp_spline(np.linspace(0.0, 1.0, values.shape[0]), values, k=_DEGREE, axis=0)
    knots = np.array(spline.t, dtype=np.float64)
    return knots, np.asarray(spline.c, dtype=np.float64)


def hub_nurbs(propeller: Propeller) -> NurbsSurface:
    """The hub from its forward face (open) to the tip of the boss cap: u along the shaft, v round it, without error.

    Chamfer, cylinder and elliptic cap are one conic each, the circle round the shaft is four.
    """
    hub = hub_of(propeller)
    face_radius = float(hub.radius_at(np.array(hub.face_x)))
    x = np.array(
        [
            hub.face_x,
            0.5 * (hub.face_x + hub.cylinder_start),
            hub.cylinder_start,
            0.5 * (hub.cylinder_start + hub.cylinder_end),
            hub.cylinder_end,
            hub.cap_x,
            hub.cap_x,
        ]
    )
    radius = np.full(7, hub.radius)
    radius[0], radius[-1] = face_radius, 0.0
    along = np.array([1.0, 1.0, 1.0, 1.0, 1.0, np.sqrt(0.5), 1.0])
    span = hub.cap_x - hub.face_x
    first, second = (hub.cylinder_start - hub.face_x) / span, (hub.cylinder_end - hub.face_x) / span
    knots_u = np.array([0, 0, 0, first, first, second, second, 1, 1, 1])
    # nine points of a square with weights 1 and sqrt(1/2) are a full circle (The NURBS Book, example 7.4)
    square = np.array([[0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1]], dtype=np.float64)
    around = np.where(np.arange(9) % 2 == 1, np.sqrt(0.5), 1.0)
    knots_v = np.array([0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1])
    control = np.zeros((7, 9, 3))
    control[..., 0] = x[:, None]
    control[..., 1:] = radius[:, None, None] * square
    weights = along[:, None] * around
    return NurbsSurface(2, 2, knots_u, knots_v, control * (0.5 * propeller.diameter), weights)


def propeller_surfaces(propeller: Propeller, placement: Array | None = None) -> dict[str, NurbsSurface]:
    """All blades ("blade 1" is the key blade) and the "hub" as NURBS surfaces.

    Args:
        propeller: the propeller.
        placement: a 4 x 4 matrix, for example ``propeller_placement(hull, propeller)``; None leaves propeller axes.
    """
    key = blade_nurbs(propeller).surface
    blades = propeller.blade_count
    surfaces = {
        f"blade {k + 1}": replace(key, control_points=rotate_blade(key.control_points, k, blades))
        for k in range(blades)
    }
    surfaces["hub"] = hub_nurbs(propeller)
    if placement is None:
        return surfaces
    return {
        name: replace(surface, control_points=surface.control_points @ placement[:3, :3].T + placement[:3, 3])
        for name, surface in surfaces.items()
    }
