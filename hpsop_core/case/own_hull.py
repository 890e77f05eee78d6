"""The hull file that a case names, read once."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from hpsop_core.case.sections import HullSection

# The readers of files, and what fits hulls to them, are loaded for the cases that name a file.
if TYPE_CHECKING:
    from hpsop_core.geometry.hull.input import ShipTable


@lru_cache(maxsize=4)
def own_table(section: HullSection) -> ShipTable:
    """The half-breadths of the hull file of a case, in ship axes.

    Raises:
        InputError: the file cannot be used.
    """
    from hpsop_core.geometry.hull.input import read_table

    return read_table(section.own_file, section.read_options)


def own_dimensions(section: HullSection) -> dict[str, float]:
    """Length, breadth and draft of the hull file of a case, m.

    Raises:
        InputError: the file cannot be used.
    """
    from hpsop_core.geometry.hull.fit_table import moulded_breadth
    from hpsop_core.geometry.hull.table_stations import HalfBreadths

    table = own_table(section)
    breadth = moulded_breadth(HalfBreadths(table.name, table.x, table.z, table.y), table.draft)
    return {"length": table.length, "breadth": breadth, "draft": table.draft}
