"""A user's own hull from a file: one reader a file, one door.

delimited text     ../../delimited_text (shared with propellers)
options            what a user states (Axes, ReadOptions); what every table reader gives (FileTable)
tables             columns (names in use) · cells (numbers, units) · long_table · matrix_table -> ship_table
meshes, surfaces   mesh (STL OBJ PLY OFF GLB) · surfaces (3dm STEP IGES) -> triangles (ship axes) -> slices
after reading      checks (the table) · surface_checks (the fitted surface) · understood (what is told)
and then           normalised (the table as text that needs no understanding) · deviations (reading by reading)
door               read_hull: all of it

The names below are imported when they are first used: a case that names no file needs no reader, and those take a fifth
of a second to load.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hpsop_core.geometry.hull.input.door import (
        HullFile,
        hull_from_table,
        parent_hull_from_offsets,
        parent_hull_from_stl,
        read_hull,
        read_table,
        table_from_text,
    )
    from hpsop_core.geometry.hull.input.normalised import normalised_options, normalised_text
    from hpsop_core.geometry.hull.input.options import UNITS, Axes, ReadOptions
    from hpsop_core.geometry.hull.input.ship_table import ShipTable
    from hpsop_core.geometry.hull.input.understood import UnderstoodHull

__all__ = [
    "UNITS",
    "Axes",
    "HullFile",
    "ReadOptions",
    "ShipTable",
    "UnderstoodHull",
    "hull_from_table",
    "normalised_options",
    "normalised_text",
    "parent_hull_from_offsets",
    "parent_hull_from_stl",
    "read_hull",
    "read_table",
    "table_from_text",
]

_HOMES = {
    **dict.fromkeys(("UNITS", "Axes", "ReadOptions"), "options"),
    **dict.fromkeys(("normalised_options", "normalised_text"), "normalised"),
    "ShipTable": "ship_table",
    "UnderstoodHull": "understood",
}


def __getattr__(name: str) -> Any:
    """One of ``__all__``, from the file that has it."""
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES.get(name, 'door')}"), name)
