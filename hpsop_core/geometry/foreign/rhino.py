"""Surfaces and meshes of a Rhino file (3dm): every surface sampled on its own grid."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign.loose import LooseTriangles
from hpsop_core.typing_aliases import Array, IntArray

# What is no hull, by the name of its object or layer.
_APPENDAGES = re.compile(
    r"propeller|screw|rudder|strut|bracket|shaft(?!t)|bilge keel|thruster|appendage", re.IGNORECASE
)
# Points along each side of every knot span of a surface, and the greatest number across a whole surface.
POINTS_PER_SPAN, MOST_POINTS = 4, 400


def read_3dm(path: Path) -> LooseTriangles:
    """The hull's surfaces, polysurfaces, extrusions and meshes, as triangles.

    Trimmed faces are taken with their own render mesh where the file has one, else whole.

    Raises:
        InputError: unreadable, or without surfaces and meshes.
    """
    import rhino3dm

    try:
        file: Any = rhino3dm.File3dm.Read(str(path))
    except Exception as problem:
        raise InputError(f"{path.name}: cannot be read as a 3dm file ({problem})") from problem
    if file is None:
        raise InputError(f"{path.name}: cannot be read as a 3dm file")
    pieces: list[tuple[Array, IntArray]] = []
    whole_trimmed = 0
    layers = {layer.Index: str(layer.FullPath or layer.Name) for layer in file.Layers}
    left_out = set()
    for item in file.Objects:
        words = f"{item.Attributes.Name or ''} {layers.get(item.Attributes.LayerIndex, '')}"
        named = _APPENDAGES.search(words)
        if named is not None:
            shapes = (rhino3dm.Brep, rhino3dm.Mesh, rhino3dm.Surface)
            left_out |= {named.group(0).lower()} if isinstance(item.Geometry, shapes) else set()
            continue
        found, trimmed = _triangles(item.Geometry)
        pieces += found
        whole_trimmed += trimmed
    if not pieces:
        raise InputError(f"{path.name}: holds no surface and no mesh; save the hull's surfaces into it")
    start = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])[:-1]
    vertices = np.concatenate([vertices for vertices, _ in pieces])
    faces = np.concatenate([faces + first for (_, faces), first in zip(pieces, start, strict=True)])
    notes: tuple[str, ...] = ()
    if left_out:
        notes = (*notes, f"left out by the names of their objects or layers: {', '.join(sorted(left_out))}")
    if whole_trimmed:
        notes = (*notes, f"warning: {whole_trimmed} trimmed faces carry no mesh and are read untrimmed")
    unit = {"Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Feet": "ft", "Inches": "in"}.get(
        str(file.Settings.ModelUnitSystem).rsplit(".", 1)[-1]
    )
    return LooseTriangles(f"3dm file with {len(pieces)} surfaces", vertices, faces, unit, notes)


def _triangles(geometry: Any) -> tuple[list[tuple[Array, IntArray]], int]:
    """Triangles of one object, and how many trimmed faces were taken whole."""
    import rhino3dm

    if isinstance(geometry, rhino3dm.Mesh):
        return [_of_mesh(geometry)], 0
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(False)
    if isinstance(geometry, rhino3dm.Brep):
        pieces, whole = [], 0
        faces: Any = geometry.Faces
        for face in (faces[k] for k in range(len(faces))):
            mesh = face.GetMesh(rhino3dm.MeshType.Any)
            if mesh is not None and len(mesh.Faces):
                pieces.append(_of_mesh(mesh))
                continue
            surface = face.UnderlyingSurface()
            nurbs = surface.ToNurbsSurface() if surface is not None else None
            if nurbs is not None:
                pieces.append(_of_surface(nurbs))
                whole += len(faces) > 1 or not geometry.IsSurface
        return pieces, whole
    if isinstance(geometry, rhino3dm.NurbsSurface):
        return [_of_surface(geometry)], 0
    if isinstance(geometry, rhino3dm.Surface):
        nurbs = geometry.ToNurbsSurface()
        return ([_of_surface(nurbs)], 0) if nurbs is not None else ([], 0)
    return [], 0


def _of_mesh(mesh: Any) -> tuple[Array, IntArray]:
    vertices = np.array(
        [[mesh.Vertices[k].X, mesh.Vertices[k].Y, mesh.Vertices[k].Z] for k in range(len(mesh.Vertices))]
    )
    corners = np.array([mesh.Faces[k] for k in range(len(mesh.Faces))], dtype=np.int64)
    second = corners[corners[:, 2] != corners[:, 3]][:, [0, 2, 3]]
    return vertices, np.concatenate([corners[:, :3], second])


def _of_surface(surface: Any) -> tuple[Array, IntArray]:
    """A NURBS surface on a grid that is finer where its knots are."""
    axes = []
    for direction, knots in ((0, surface.KnotsU), (1, surface.KnotsV)):
        values = np.unique([knots[k] for k in range(len(knots))])
        domain = surface.Domain(direction)
        values = values[(values >= domain.T0) & (values <= domain.T1)]
        inner = [np.linspace(a, b, POINTS_PER_SPAN + 1)[:-1] for a, b in pairwise(values)]
        every = np.concatenate([*inner, values[-1:]])
        if len(every) < 40:
            every = np.unique(np.concatenate([every, np.linspace(values[0], values[-1], 40)]))
        axes.append(every if len(every) <= MOST_POINTS else np.linspace(values[0], values[-1], MOST_POINTS))
    return points_at(surface, *axes), grid_faces(len(axes[0]), len(axes[1]))


def points_at(surface: Any, u: Array, v: Array) -> Array:
    """Points (len(u) len(v), 3) of a NURBS surface of rhino3dm on a grid of parameters within its domain.

    As ``surface.PointAt``, which takes a call a point: four fifths of the time of a whole file.
    """
    count = surface.Points.CountU, surface.Points.CountV
    net = [[surface.Points[(i, j)] for j in range(count[1])] for i in range(count[0])]
    # Homogeneous: x, y and z are weighted.
    weighted = np.array([[(p.X, p.Y, p.Z, p.W) for p in row] for row in net])
    bases = []
    for at, knots, order in ((u, surface.KnotsU, surface.OrderU), (v, surface.KnotsV, surface.OrderV)):
        # openNURBS leaves out the first and the last knot, on which nothing within the domain depends.
        inner = [knots[k] for k in range(len(knots))]
        bases.append(BSpline.design_matrix(at, np.array([inner[0], *inner, inner[-1]]), order - 1).toarray())
    found = np.einsum("ui,ijk,vj->uvk", bases[0], weighted, bases[1], optimize=True)
    return np.asarray((found[..., :3] / found[..., 3:]).reshape(-1, 3))


def grid_faces(rows: int, columns: int) -> IntArray:
    """Two triangles for every cell of a grid of points, row by row."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    return np.concatenate(
        [
            np.stack([corner, corner + columns, corner + columns + 1], axis=1),
            np.stack([corner, corner + columns + 1, corner + 1], axis=1),
        ]
    )
