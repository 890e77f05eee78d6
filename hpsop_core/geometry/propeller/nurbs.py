"""Blade and hub as NURBS surfaces: what is drawn, meshed, panelled and exchanged with CAD.

Metres, propeller axes. The blade's surface runs from a little inside the hub to the tip. Tip and trailing edge have a
thickness (``EDGE_THICKNESS_RATIO``), which `closed.py` takes away for the solvers' panels. The fillet at the root is in
the meshes only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.interpolate import make_interp_spline

from hpsop_core.geometry.nurbs import NurbsSurface, basis_matrix, clamped_knots
from hpsop_core.geometry.propeller.hub import hub_of
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import (
    cylinder_points,
    finite_edge_points,
    finite_tip_sections,
    rotate_blade,
    to_cartesian,
)
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

_DEGREE = 3
_ROOT_DEPTH = 0.9
_SPAN_STATIONS = 61
_CHORD_STATIONS = 49


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
    """Sections of the key blade at r/R = radii (nr,): (nr, 2 nc - 1, 3) in m, propeller axes.

    From the back's corner of the trailing edge along the back to the leading edge and along the face to its corner.
    """
    sections = finite_tip_sections(propeller.table, radii)
    along, back, face = finite_edge_points(sections, cosine_chord_fractions(chord_points))
    x, theta = cylinder_points(
        radii[:, None],
        sections.pitch_angle[:, None],
        sections.skew[:, None],
        sections.rake_ratio[:, None],
        np.concatenate([along[:, ::-1], along[:, 1:]], axis=1),
        np.concatenate([back[:, ::-1], face[:, 1:]], axis=1),
    )
    return to_cartesian(x, radii[:, None], theta) * (0.5 * propeller.diameter)


@lru_cache(maxsize=64)
def blade_surface(propeller: Propeller) -> NurbsSurface:
    """The key blade, m, propeller axes: a bicubic B-spline through 61 sections of 97 points.

    u runs from inside the hub to the tip with r/R = 1 - (1 - r0)(1 - u)^2, v from the trailing edge over the back to
    the leading edge (v = 1/2) and over the face to the trailing edge, even in the angle of the cosine spacing.
    """
    grid = blade_outlines(propeller, _radii(propeller, _SPAN_STATIONS), _CHORD_STATIONS)
    knots_u, inverse_u = _interpolation(_SPAN_STATIONS)
    knots_v, inverse_v = _interpolation(2 * _CHORD_STATIONS - 1)
    with one_blas_thread():
        control = np.einsum("iu,uvk,jv->ijk", inverse_u, grid, inverse_v, optimize=True)
    return NurbsSurface(_DEGREE, _DEGREE, knots_u, knots_v, control, np.ones(control.shape[:2]))


def blade_parameters(propeller: Propeller, radius_ratio: Array) -> Array:
    """u of ``blade_surface`` at r/R."""
    start = _ROOT_DEPTH * propeller.hub_ratio
    return 1.0 - np.sqrt(np.clip((1.0 - radius_ratio) / (1.0 - start), 0.0, 1.0))


def blade_nurbs(propeller: Propeller) -> BladeSurface:
    """The key blade's surface, and how far it is from the sections midway between the interpolated ones."""
    surface = blade_surface(propeller)
    # twice as many sections and points: half of them lie midway between the interpolated ones
    fine = blade_outlines(propeller, _radii(propeller, 2 * _SPAN_STATIONS - 1), 2 * _CHORD_STATIONS - 1)
    u, v = np.linspace(0.0, 1.0, fine.shape[0]), np.linspace(0.0, 1.0, fine.shape[1])
    points, along_u, along_v = surface.derivatives(u, v)
    normal = np.cross(along_u, along_v)
    length = np.linalg.norm(normal, axis=-1)
    # a point that slid along the surface is no error of the shape
    deviation = np.abs(np.sum((points - fine) * normal, axis=-1)) / np.where(length > 0.0, length, 1.0)
    return BladeSurface(surface, float(np.max(deviation)))


@lru_cache(maxsize=8)
def _interpolation(count: int) -> tuple[Array, Array]:
    """Knots of the clamped cubic spline through ``count`` values at equal parameters, and the matrix to its control."""
    at = np.linspace(0.0, 1.0, count)
    knots = np.array(make_interp_spline(at, at, k=_DEGREE).t, dtype=np.float64)
    inverse = np.asarray(np.linalg.inv(basis_matrix(knots, _DEGREE, at)), dtype=np.float64)
    inverse.setflags(write=False)
    return knots, inverse


def blade_faces(propeller: Propeller) -> dict[str, NurbsSurface]:
    """The key blade as the faces of a closed body: "back", "face", "trailing edge", "tip" and, in the hub, "root"."""
    from geomdl.operations import split_surface_v

    halves = split_surface_v(blade_surface(propeller).to_geomdl(), 0.5)
    first, second = (NurbsSurface.from_geomdl(half) for half in halves)
    # From the trailing edge to the leading one on both sides: the knots are the same but for rounding.
    face = replace(second, control_points=second.control_points[:, ::-1], knots_v=first.knots_v)
    edge, last = first.control_points[:, 0], face.control_points[:, 0]
    return {
        "back": first,
        "face": face,
        "trailing edge": _ruled(edge, last, first.knots_u),
        "tip": _ruled(first.control_points[-1], face.control_points[-1], first.knots_v),
        "root": _ruled(first.control_points[0], face.control_points[0], first.knots_v),
    }


def _ruled(first: Array, second: Array, knots: Array) -> NurbsSurface:
    """Straight lines between two cubic splines on the same knots."""
    control = np.stack([first, second], axis=1)
    return NurbsSurface(_DEGREE, 1, knots, clamped_knots([], 1), control, np.ones(control.shape[:2]))


def hub_nurbs(propeller: Propeller) -> NurbsSurface:
    """The hub from the rim of its forward face to the tip of the boss cap: u along the shaft, v round it, exact.

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
    """All blades ("blade 1 back" is of the key blade) and the "hub" with its "hub forward face" as NURBS surfaces.

    Args:
        propeller: the propeller.
        placement: a 4 x 4 matrix, for example ``propeller_placement(hull, propeller)``; None leaves propeller axes.
    """
    blades, key = propeller.blade_count, blade_faces(propeller)
    surfaces = {
        f"blade {k + 1} {name}": replace(part, control_points=rotate_blade(part.control_points, k, blades))
        for k in range(blades)
        for name, part in key.items()
    }
    hub = hub_nurbs(propeller)
    # the forward face: straight lines from its rim to the axis
    rim, weights = hub.control_points[0], hub.weights[0]
    disc = np.stack([rim, rim * np.array([1.0, 0.0, 0.0])], axis=1)
    both = np.stack([weights, weights], axis=1)
    surfaces["hub"] = hub
    surfaces["hub forward face"] = NurbsSurface(2, 1, hub.knots_v, clamped_knots([], 1), disc, both)
    if placement is None:
        return surfaces
    return {
        name: replace(surface, control_points=surface.control_points @ placement[:3, :3].T + placement[:3, 3])
        for name, surface in surfaces.items()
    }
