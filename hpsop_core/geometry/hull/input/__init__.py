"""A user's own hull from a file: one reader a file, one door.

delimited text     ../../delimited_text (shared with propellers)
options            what a user states (Axes, ReadOptions); what every table reader gives (FileTable)
tables             columns (names in use) · cells (numbers, units) · long_table · matrix_table -> ship_table
meshes, surfaces   mesh (STL OBJ PLY OFF GLB) · surfaces (3dm STEP IGES) -> triangles (ship axes) -> slices
after reading      checks (the table) · surface_checks (the fitted surface) · understood (what is told)
and then           normalised (the table as text that needs no understanding) · deviations (reading by reading)
door               read_hull: all of it
"""

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
