"""The formats of an export, and what they need."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

from hpsop_core.errors import InputError

FORMATS = ("stl", "glb", "3dm", "step", "iges", "dxf", "csv", "json", "vtk", "pff", "openfoam", "gdf", "svg", "pdf")

OF_OPENCASCADE = ("step", "iges")
"""Written by OpenCASCADE, the extra ``hpsop[cad]``."""

ASKED_FOR = ("vtk", "openfoam")
"""VTK needs a solver once more for every condition, which takes seconds; OpenFOAM's case is of no use to most."""

USUAL_FORMATS = tuple(name for name in FORMATS if name not in OF_OPENCASCADE + ASKED_FOR)
"""Written where none is named: the same on every machine, and quickly."""


def checked_formats(formats: Sequence[str]) -> tuple[str, ...]:
    """The formats in their usual order, each once.

    Raises:
        InputError: one that is not known, or none; or one whose program is not installed.
    """
    for name in formats:
        if name not in FORMATS:
            raise InputError(f"--formats: '{name}' is not a format; give any of {','.join(FORMATS)}")
        if name in OF_OPENCASCADE and find_spec("OCP") is None:
            raise InputError(
                f"--formats: '{name}' needs OpenCASCADE; pip install 'hpsop[cad]', or take 3dm, which holds the same "
                "surfaces"
            )
    if not formats:
        raise InputError(f"--formats: name at least one of {','.join(FORMATS)}")
    return tuple(name for name in FORMATS if name in formats)
