"""Parent hulls from a user's own table of offsets or closed mesh."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull import ParentHull


def parent_hull_from_offsets(path: Path, length: float, draft: float) -> ParentHull:
    """A parent hull fitted to a table of offsets."""
    raise InputError(f"{path}: own hulls are not read yet")


def parent_hull_from_stl(path: Path, unit: str, draft: float, length: float) -> ParentHull:
    """A parent hull fitted to slices of a closed mesh."""
    raise InputError(f"{path}: own hulls are not read yet")
