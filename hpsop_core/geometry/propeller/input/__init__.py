"""A user's own propeller from a file.

A file for a thought: columns (names in use), radial_csv (the reader), understood (what is told), normalised (the
table as text that needs no understanding).
"""

from hpsop_core.geometry.propeller.input.columns import COLUMNS
from hpsop_core.geometry.propeller.input.radial_csv import (
    RadialFile,
    radial_table_from_csv,
    radial_table_from_text,
    read_radial_table,
)
from hpsop_core.geometry.propeller.input.understood import UnderstoodPropeller, read_propeller

__all__ = [
    "COLUMNS",
    "RadialFile",
    "UnderstoodPropeller",
    "radial_table_from_csv",
    "radial_table_from_text",
    "read_propeller",
    "read_radial_table",
]
