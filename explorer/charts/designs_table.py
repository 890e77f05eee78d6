"""The table of all designs: which rows in which order, as HTML a page at a time, and as CSV."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from explorer.state.run_picture import RunPicture
from explorer.state.table_options import TableOptions
from hpsop_core.errors import InputError
from hpsop_core.markup import Markup, fill, joined, symbol_html, symbol_plain
from hpsop_core.quantities import Quantity, number_text, quantities_of_case, variable_quantities

ROWS = 25
"""Rows of a page: the browser never holds more, however many designs a run has."""

_OF_A_RUN = ("id", "level", "generation")
_USUAL = ("f1", "f2", "delivered_power_1", "length", "breadth", "hull_draft", "propeller_diameter")
_TERM = re.compile(r"\s*(.+?)\s*(<=|>=|<|>|=|≤|≥)\s*([-−+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*")
_DIGITS = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789", "_ ")


def known_columns(picture: RunPicture) -> dict[str, Quantity]:
    """What a column can show of this run, by key."""
    case = picture.case
    declared = (*quantities_of_case(case), *variable_quantities(case))
    held = {"f1", "f2", *picture.columns}
    found: dict[str, Quantity] = {}
    for item in declared:
        if item.key in held:
            found.setdefault(item.key, item)
    return found


def chosen_columns(picture: RunPicture, options: TableOptions) -> list[Quantity]:
    """The columns that are shown."""
    known = known_columns(picture)
    return [known[key] for key in (options.columns or _USUAL) if key in known]


def table_rows(
    picture: RunPicture,
    options: TableOptions,
    filters: Mapping[str, tuple[float, float]],
    stars: frozenset[int],
) -> NDArray[np.int64]:
    """Rows of the picture's arrays that the table holds, in its order: equal ones by number, missing values last."""
    keep = picture.inside(filters) & ~picture.failed
    if options.which == "feasible":
        keep &= picture.feasible
    elif options.which == "starred":
        keep &= np.isin(picture.ids, sorted(stars))
    elif options.which == "front":
        newest = picture.generation_at(None)
        keep &= np.isin(picture.ids, newest.front if newest is not None else ())
    rows = np.flatnonzero(keep)
    values = _values(picture, options.sort)[rows]
    values = np.where(np.isfinite(values), -values if options.descending else values, np.inf)
    ordered: NDArray[np.int64] = rows[np.lexsort((picture.ids[rows], values))]
    return ordered


def page_of(rows: NDArray[np.int64], options: TableOptions) -> int:
    """The page that can be shown: the one asked for, or the last there is."""
    return min(max(options.page, 0), max(math.ceil(len(rows) / ROWS) - 1, 0))


def parse_filter(text: str, picture: RunPicture) -> dict[str, tuple[float, float]]:
    """Ranges by key from words like ``f1 < 0.95, L_PP > 340``.

    Args:
        text: terms between commas; a quantity is named by its symbol or its key.
        picture: the run whose numbers are meant.

    Raises:
        InputError: a term that cannot be understood.
    """
    names = _names(known_columns(picture))
    found: dict[str, tuple[float, float]] = {}
    for term in filter(str.strip, re.split(r"[,;]", text)):
        match = _TERM.fullmatch(term)
        if match is None:
            raise InputError(f"'{term.strip()}' is no condition; write for example f1 < 0.95, L_PP > 340")
        word = match[1].translate(_DIGITS)
        key = names.get(word) or names.get(word.casefold())
        if key is None:
            raise InputError(f"'{match[1]}' is no column of this run; rest on a heading of the table for its name")
        try:
            value = float(match[3].replace("−", "-"))
        except ValueError:
            raise InputError(f"'{match[3]}' is no number; write for example f1 < 0.95") from None
        low, high = found.get(key, (-math.inf, math.inf))
        if match[2] in "<=≤":
            high = min(high, value)
        if match[2] in ">=≥":
            low = max(low, value)
        found[key] = (low, high)
    return found


def range_words(key: str, limits: tuple[float, float], picture: RunPicture) -> Markup:
    """0.9 ≤ f₁ ≤ 0.95, as people write it."""
    quantity = known_columns(picture).get(key)
    name = symbol_html(quantity.symbol) if quantity is not None else Markup.escape(key)
    low, high = limits
    parts = [f"{low:.5g} ≤ " if math.isfinite(low) else "", name, f" ≤ {high:.5g}" if math.isfinite(high) else ""]
    return joined(parts)


def designs_table(
    picture: RunPicture, options: TableOptions, rows: NDArray[np.int64], selected: int | None, stars: frozenset[int]
) -> Markup:
    """One page as HTML: headings sort, a row selects its design, a star stays with it."""
    columns = chosen_columns(picture, options)
    heads = [
        Markup('<th><span title="a star of your own">★</span></th>'),
        _head("id", "design", "number of the design in the run", "", options),
        _head("level", "lev.", "level", "", options),
        *(
            _head(
                item.key,
                symbol_html(item.symbol),
                f"{item.label}{item.place} ({item.key})",
                joined([word for word in (item.unit, item.condition) if word], "<br>"),
                options,
            )
            for item in columns
        ),
    ]
    page = page_of(rows, options)
    front = picture.generation_at(None)
    on_front = frozenset(front.front) if front is not None else frozenset()
    body = [
        _row(picture, int(row), columns, int(picture.ids[row]) == selected, stars, on_front)
        for row in rows[page * ROWS : (page + 1) * ROWS]
    ]
    return fill(
        '<table class="numbers designs"><thead><tr>{}</tr></thead><tbody>{}</tbody></table>',
        joined(heads),
        joined(body),
    )


def designs_csv(picture: RunPicture, options: TableOptions, rows: NDArray[np.int64], stars: frozenset[int]) -> str:
    """All rows, the columns that are shown, with headings that name the units."""
    columns = chosen_columns(picture, options)
    target = io.StringIO()
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(
        ["design", "level", "generation", "feasible", "star", *(symbol_plain(item.title()) for item in columns)]
    )
    values = [_values(picture, item.key) for item in columns]
    for row in rows:
        design = int(picture.ids[row])
        writer.writerow(
            [
                design,
                int(picture.level[row]),
                int(picture.generation[row]),
                int(picture.feasible[row]),
                int(design in stars),
                *(f"{column[row]:.9g}" if math.isfinite(column[row]) else "" for column in values),
            ]
        )
    return target.getvalue()


def _names(known: Mapping[str, Quantity]) -> dict[str, str]:
    """Words for a key: the key, its symbol, and either in small letters where that is no other's word."""
    names: dict[str, str] = {}
    for spell in (str, str.casefold):
        for item in known.values():
            for word in (item.key, item.symbol):
                names.setdefault(spell(word.translate(_DIGITS)), item.key)
    return names


def _values(picture: RunPicture, key: str) -> NDArray[np.float64]:
    if key in _OF_A_RUN:
        found: NDArray[np.float64] = {"id": picture.ids, "level": picture.level, "generation": picture.generation}[
            key
        ].astype(float)
        return found
    values = picture.column(key)
    return np.full(len(picture.ids), np.nan) if values is None else values


def _head(key: str, words: str | Markup, hint: str, unit: str | Markup, options: TableOptions) -> Markup:
    sorted_by = options.sort == key
    order = ("descending" if options.descending else "ascending") if sorted_by else "none"
    arrow = ("▼" if options.descending else "▲") if sorted_by else ""
    unit = fill('<span class="unit">{}</span>', unit) if unit else ""
    return fill(
        '<th aria-sort="{}"><button type="button" class="plain" data-act="table_sort" data-arg="{}" title="{}">{}{}'
        "</button>{}</th>",
        order, key, f"sort by {hint}", words, arrow, fill("<br>{}", unit) if unit else "",
    )  # fmt: skip


def _row(
    picture: RunPicture,
    row: int,
    columns: list[Quantity],
    selected: bool,
    stars: frozenset[int],
    on_front: frozenset[int],
) -> Markup:
    design = int(picture.ids[row])
    starred = design in stars
    cells = []
    for item in columns:
        values = picture.column(item.key)
        value = None if values is None else float(values[row])
        text = number_text(value, item.decimals)
        violated = item.key.startswith("g_") and value is not None and value > 0.0
        cells.append(fill('<td class="{}">{}</td>', "bad" if violated else "", text))
    marks = [
        word for word, on in (("on the front", design in on_front), ("infeasible", not picture.feasible[row])) if on
    ]
    return fill(
        '<tr data-design="{d}" data-act="table_select" data-arg="{d}" class="{css}" title="{marks}">'
        '<td><button type="button" class="plain star" data-act="star" data-arg="{d}" aria-pressed="{pressed}" '
        'aria-label="star of design {d}">{star}</button></td>'
        '<td><button type="button" class="plain" data-act="table_select" data-arg="{d}">{d}</button></td>'
        "<td>{level}</td>{cells}</tr>",
        d=design,
        css=" ".join(
            word
            for word, on in (("on", selected), ("front", design in on_front), ("broken", not picture.feasible[row]))
            if on
        ),
        marks=", ".join(marks),
        pressed="true" if starred else "false",
        star="★" if starred else "☆",
        level=int(picture.level[row]),
        cells=joined(cells),
    )
