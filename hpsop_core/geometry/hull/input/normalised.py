"""A table as it was understood, written in the layout that needs no understanding: ship axes, metres, a row a point."""

from __future__ import annotations

from hpsop_core.geometry.hull.input.long_table import COLUMNS
from hpsop_core.geometry.hull.input.options import Axes, ReadOptions
from hpsop_core.geometry.hull.input.ship_table import ShipTable


def normalised_text(table: ShipTable) -> str:
    """The table as text that reads back to the bit (numbers with as many digits as they have)."""
    lines = [",".join(COLUMNS)]
    for x, row in zip(table.x.tolist(), table.y.tolist(), strict=True):
        lines += [f"{x!r},{z!r},{y!r}" for z, y in zip(table.z.tolist(), row, strict=True)]
    return "\n".join(lines) + "\n"


def normalised_options(table: ShipTable) -> ReadOptions:
    """With which ``normalised_text`` is to be read."""
    return ReadOptions(table.length, table.draft, None, "m", Axes("+x", "ap", "draft"))
