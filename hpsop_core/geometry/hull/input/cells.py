"""Readings from cells: one number in metres, or one line that says what is wrong with it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.delimited_text import TextTable, feet_inches_eighths
from hpsop_core.geometry.hull.input.options import UNITS
from hpsop_core.typing_aliases import Array


def are_feet_inches(cells: Iterable[str]) -> bool:
    """Whether every cell that is not empty or a bare 0 is in feet-inches-eighths, and at least one is."""
    some = False
    for cell in cells:
        if cell in ("", "0", "-"):
            continue
        try:
            feet_inches_eighths(cell)
        except ValueError:
            return False
        some = True
    return some


def reading(table: TextTable, row: int, column: str, cell: str, unit: str) -> float:
    """The number in a cell, in metres.

    Raises:
        InputError: no finite number; one line with row and column.
    """
    try:
        if unit == "ft-in-8" and cell.strip() != "0":
            value = feet_inches_eighths(cell)
        else:
            value = table.number(cell)
    except ValueError:
        wanted = "feet-inches-eighths such as 12-3-4" if unit == "ft-in-8" else "a number"
        raise InputError(f"{table.name} row {row}: {column} is '{cell[:40]}', {wanted} is needed") from None
    if not math.isfinite(value):
        raise InputError(f"{table.name} row {row}: {column} is {cell[:40]}, a finite number is needed")
    # A metre stays as it was written, to the last bit.
    return value if unit == "m" else value * UNITS[unit]


def are_fractions(z: Array, y: Array) -> bool:
    """Whether heights and half-breadths are fractions of draft and B/2: breadths up to exactly 1, a waterline at 1."""
    return bool(
        abs(float(np.max(y, initial=0.0)) - 1.0) < 5e-3
        and float(np.max(z, initial=0.0)) <= 3.0
        and np.any(np.abs(z - 1.0) < 1e-9)
    )
