"""A design as a Rhino file: rational NURBS surfaces on named layers, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import rhino3dm as _rhino3dm

from hpsop_core.export.surfaces import NamedSurface
from hpsop_core.geometry.nurbs import NurbsSurface

# Its stubs do not know the setters and overloads that it has.
rhino3dm: Any = _rhino3dm

FILE_VERSION = 7
"""Of the Rhino format: read by Rhino 7 and later and by every program that uses openNURBS."""

_TOLERANCE = 1e-3
_COLOURS = {
    "hull underwater": (150, 60, 50, 255),
    "hull topsides": (70, 95, 120, 255),
    "hull flat ends": (120, 120, 120, 255),
    "propeller": (190, 150, 60, 255),
}


def rhino_surface(surface: NurbsSurface) -> Any:
    """The surface as openNURBS has it: homogeneous control points, and knots without the first and the last."""
    rows, columns = surface.weights.shape
    made = rhino3dm.NurbsSurface.Create(3, True, surface.degree_u + 1, surface.degree_v + 1, rows, columns)
    for i in range(rows):
        for j in range(columns):
            weight = float(surface.weights[i, j])
            x, y, z = (float(value) * weight for value in surface.control_points[i, j])
            made.Points[i, j] = rhino3dm.Point4d(x, y, z, weight)
    for target, knots in ((made.KnotsU, surface.knots_u), (made.KnotsV, surface.knots_v)):
        for k, value in enumerate(knots[1:-1]):
            target[k] = float(value)
    return made


def write_3dm(path: Path, surfaces: Sequence[NamedSurface], title: str) -> None:
    """Write the surfaces, a layer a group, each with its name.

    Raises:
        OSError: the file cannot be written.
    """
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Settings.ModelAbsoluteTolerance = _TOLERANCE
    model.ApplicationName = "hpsop"
    model.ApplicationDetails = title
    layers: dict[str, int] = {}
    for part in surfaces:
        if part.group not in layers:
            layer = rhino3dm.Layer()
            layer.Name = part.group
            layer.Color = _COLOURS.get(part.group, (0, 0, 0, 255))
            layers[part.group] = model.Layers.Add(layer)
        attributes = rhino3dm.ObjectAttributes()
        attributes.Name = part.name
        attributes.LayerIndex = layers[part.group]
        model.Objects.AddSurface(rhino_surface(part.surface), attributes)
    if not model.Write(str(path), FILE_VERSION):
        raise OSError(f"{path}: could not be written")
