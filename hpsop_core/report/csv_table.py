"""A table as values: written as a CSV file, and shown on a page."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

from hpsop_core.markup import Markup, fill, one_line, symbol_html
from hpsop_core.quantities import number_text
from hpsop_core.report.html_page import table

Cell = str | float | int | None

_DIGITS = {
    "L": 2, "B": 2, "d": 2, "CB": 3, "Z": 0, "D": 2, "P/D": 2, "f1": 3, "f2": 3, "J": 3, "KT": 4, "10KQ": 4, "eta": 4,
    "Fn": 2, "weight": 2, "lower": 2, "upper": 2, "off": 1, "Rt": 0, "T": 0, "N": 2, "PD": 1, "PE": 1, "PD1": 1,
    "PD2": 1, "V": 2, "w": 3, "t": 3, "T/Rt": 3, "10^4": 1, "ours": 3,
}  # fmt: skip
_SYMBOLS = {"f1": "f_1", "f2": "f_2", "KT": "K_T", "10KQ": "10K_Q", "CB": "C_B", "eta": "η", "Rt": "R_T", "PD": "P_D",
            "PD1": "P_D1", "PD2": "P_D2", "PE": "P_E", "T/Rt": "T/R_T"}  # fmt: skip


@dataclass(frozen=True)
class Table:
    """A table as it stands in a CSV file.

    Attributes:
        name: of the file, without ``.csv``.
        comment: what it is; the first lines of the file.
        header: columns, with their units.
        rows: cells; None where there is nothing.
        digits: decimals of each column on a page; by the column's name where there are none.
    """

    name: str
    comment: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    digits: tuple[int, ...] = ()

    def csv(self) -> str:
        """The file's text."""
        stream = io.StringIO()
        stream.writelines(f"# {line}\n" for line in self.comment.splitlines())
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(self.header)
        for row in self.rows:
            writer.writerow("" if cell is None else f"{cell:.9g}" if isinstance(cell, float) else cell for cell in row)
        return stream.getvalue()

    def texts(self) -> list[list[str]]:
        """The cells as people read them."""
        digits = self.digits or tuple(_digits(column) for column in self.header)
        return [[cell_text(value, places) for value, places in zip(row, digits, strict=True)] for row in self.rows]


def _digits(column: str) -> int:
    return 1 if " off " in column else _DIGITS.get(column.split(" ")[0], 3)


def cell_text(value: Cell, digits: int) -> str:
    """A cell as people read it; a whole number is a count."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    return number_text(float(value), 0 if isinstance(value, int) else digits)


def heading_html(column: str, between: str = "<br>") -> Markup:
    """A column's name with its symbol and, after ``between`` (markup), its unit."""
    words, _, unit = column.partition(" [")
    first, _, rest = words.partition(" ")
    name = fill("{} {}", symbol_html(_SYMBOLS.get(first, first)), rest)
    if words.startswith("10^4 Cw"):
        name = fill("10<sup>4</sup> C<sub>W</sub>{}", words.removeprefix("10^4 Cw"))
    shown = unit.rstrip("]").replace("-", "–")
    return name + (fill("{}<span class=unit>[{}]</span>", Markup(between), shown) if unit else "")


def caption_html(made: Table, file: bool = True) -> Markup:
    """What a table is, and the name of its file where there is one."""
    words = one_line(made.comment)
    return fill("{} <span class=unit>({}.csv)</span>", words, made.name) if file else words


def table_html(made: Table, wide: bool = False, marked: Sequence[int] = (), file: bool = True) -> Markup:
    """A table on a page; arguments as of ``html_page.table``, and whether its CSV file stands beside the page."""
    header = [heading_html(column) for column in made.header]
    return table(header, made.texts(), caption=caption_html(made, file), wide=wide, marked=marked)
