"""A design as a Rhino file: rational NURBS surfaces on named layers, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hpsop_core.export.exchange import rhino3dm, rhino_surface
from hpsop_core.export.surfaces import COLOURS, NamedSurface

FILE_VERSION = 7
"""Of the Rhino format: read by Rhino 7 and later and by every program that uses openNURBS."""

_TOLERANCE = 1e-3


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
            layer.Color = COLOURS[part.group]
            layers[part.group] = model.Layers.Add(layer)
        attributes = rhino3dm.ObjectAttributes()
        attributes.Name = part.name
        attributes.LayerIndex = layers[part.group]
        model.Objects.AddSurface(rhino_surface(part.surface.to_geomdl()), attributes)
    if not model.Write(str(path), FILE_VERSION):
        raise OSError(f"{path}: could not be written")
