"""Surfaces of a hull from CAD: 3dm, and with the extra `hpsop[cad]` STEP and IGES."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.geometry.foreign.apart import read_apart
from hpsop_core.geometry.hull.input.mesh import tidied
from hpsop_core.geometry.hull.input.triangles import TriangleFile

SUFFIXES = (".3dm", ".step", ".stp", ".igs", ".iges")


def read_surfaces(path: Path) -> TriangleFile:
    """The file's surfaces as triangles.

    Raises:
        InputError: the extra is not installed, the file cannot be read or holds no surfaces.
    """
    found = read_apart(path)
    vertices, faces, notes = tidied(found.vertices, found.faces)
    return TriangleFile(path.name, found.layout, vertices, faces, found.unit, False, (*notes, *found.notes))
