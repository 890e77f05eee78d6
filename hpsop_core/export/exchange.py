"""Surfaces handed between hpsop, geomdl, openNURBS and OpenCASCADE.

geomdl's surface stands in the middle: ``to_geomdl`` gives a hull or a propeller as such, with all of geomdl's
operations (splitting, refining, derivatives, its own exchange files), and the other programs' surfaces are made from it
and read into it. Control points are Cartesian with their weights apart; openNURBS alone wants them multiplied.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rhino3dm as _rhino3dm

from hpsop_core.export.surfaces import hull_surfaces
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.geometry.propeller.nurbs import propeller_surfaces
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.typing_aliases import Array

# Its stubs do not know the setters and overloads that it has.
rhino3dm: Any = _rhino3dm


def to_geomdl(shape: Hull | Propeller) -> dict[str, Any]:
    """A hull or a propeller as ``geomdl.NURBS.Surface`` objects.

    Args:
        shape: a hull gives both sides of every patch with deck and flat ends ("main port", "main deck starboard"), in
            ship axes; a propeller the faces of its blades and hub ("blade 1 back", "hub"), in propeller axes
            (docs/conventions.md).

    Returns:
        Name -> surface over the unit square, m.

    Raises:
        InputError: the roots of a propeller's neighbouring blades meet.
    """
    if isinstance(shape, Hull):
        return {part.name: part.surface.to_geomdl() for part in hull_surfaces(shape)[0]}
    return {name: surface.to_geomdl() for name, surface in propeller_surfaces(shape).items()}


def rhino_surface(surface: Any) -> Any:
    """A geomdl surface as openNURBS has it: homogeneous control points, and knots without the first and the last."""
    ours = NurbsSurface.from_geomdl(surface)
    rows, columns = ours.weights.shape
    made = rhino3dm.NurbsSurface.Create(3, True, ours.degree_u + 1, ours.degree_v + 1, rows, columns)
    for i in range(rows):
        for j in range(columns):
            weight = float(ours.weights[i, j])
            x, y, z = (float(value) * weight for value in ours.control_points[i, j])
            made.Points[i, j] = rhino3dm.Point4d(x, y, z, weight)
    for target, knots in ((made.KnotsU, ours.knots_u), (made.KnotsV, ours.knots_v)):
        for k, value in enumerate(knots[1:-1]):
            target[k] = float(value)
    return made


def from_rhino(surface: Any) -> Any:
    """A clamped ``rhino3dm.NurbsSurface`` over the unit square as a geomdl surface."""
    rows, columns = surface.Points.CountU, surface.Points.CountV
    points = [[surface.Points[i, j] for j in range(columns)] for i in range(rows)]
    homogeneous = np.array([[(p.X, p.Y, p.Z, p.W) for p in row] for row in points])
    u, v = (np.array([knots[k] for k in range(len(knots))]) for knots in (surface.KnotsU, surface.KnotsV))
    return NurbsSurface(
        surface.OrderU - 1,
        surface.OrderV - 1,
        np.concatenate([u[:1], u, u[-1:]]),
        np.concatenate([v[:1], v, v[-1:]]),
        homogeneous[..., :3] / homogeneous[..., 3:],
        homogeneous[..., 3],
    ).to_geomdl()


def opencascade_surface(surface: Any, scale: float = 1.0) -> Any:
    """A geomdl surface as ``OCP.Geom.Geom_BSplineSurface``, lengths times ``scale``."""
    from OCP.collections import Array2_double, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    ours = NurbsSurface.from_geomdl(surface)
    rows, columns = ours.weights.shape
    poles, weights = Array2_gp_Pnt(1, rows, 1, columns), Array2_double(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*(scale * float(value) for value in ours.control_points[i, j])))
            weights.SetValue(i + 1, j + 1, float(ours.weights[i, j]))
    (knots_u, counts_u), (knots_v, counts_v) = (_distinct(knots) for knots in (ours.knots_u, ours.knots_v))
    return Geom_BSplineSurface(poles, weights, knots_u, knots_v, counts_u, counts_v, ours.degree_u, ours.degree_v)


def from_opencascade(surface: Any, scale: float = 1.0) -> Any:
    """A clamped ``OCP.Geom.Geom_BSplineSurface`` over the unit square as a geomdl surface, times ``scale``."""
    rows, columns = range(1, surface.NbUPoles() + 1), range(1, surface.NbVPoles() + 1)
    poles = [[surface.Pole(i, j) for j in columns] for i in rows]
    return NurbsSurface(
        surface.UDegree(),
        surface.VDegree(),
        _repeated([(surface.UKnot(k), surface.UMultiplicity(k)) for k in range(1, surface.NbUKnots() + 1)]),
        _repeated([(surface.VKnot(k), surface.VMultiplicity(k)) for k in range(1, surface.NbVKnots() + 1)]),
        scale * np.array([[(p.X(), p.Y(), p.Z()) for p in row] for row in poles]),
        np.array([[surface.Weight(i, j) for j in columns] for i in rows]),
    ).to_geomdl()


def _distinct(knots: Array) -> tuple[Any, Any]:
    from OCP.collections import Array1_double, Array1_int

    values, counts = np.unique(knots, return_counts=True)
    distinct, multiplicities = Array1_double(1, len(values)), Array1_int(1, len(values))
    for k, (value, count) in enumerate(zip(values, counts, strict=True), start=1):
        distinct.SetValue(k, float(value))
        multiplicities.SetValue(k, int(count))
    return distinct, multiplicities


def _repeated(knots: Sequence[tuple[float, int]]) -> Array:
    return np.repeat(np.array([value for value, _ in knots]), np.array([count for _, count in knots]))
