"""The scatter chart: every design over any two quantities, a third as colour and a fourth as size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.charts.colour_ramp import COLOURS, finite_limits, ramp, steps
from explorer.charts.designs_table import known_columns
from explorer.state.chart_options import ChartOptions
from explorer.state.run_picture import RunPicture
from hpsop_core.charts.axis import Axis, Limits, padded
from hpsop_core.charts.frame import Key
from hpsop_core.charts.looks import Sheet
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.search import Mark, draw_marks
from hpsop_core.markup import Markup, fill, joined, symbol_html
from hpsop_core.quantities import Quantity, number_text

GESTURES = 'data-drag="pan" data-hover="1" data-click="1" tabindex="0"'
"""What the chart's element says of the gestures that it answers."""

_RADII = (1.3, 2.1, 3.0, 4.2)
_PLAIN_RADIUS = 1.9
_REACH = 14.0


@dataclass(frozen=True)
class Chosen:
    """The quantities of a scatter chart, of those that a run has; None where colour or size tell nothing."""

    x: Quantity
    y: Quantity
    colour: Quantity | None
    size: Quantity | None


def chosen(picture: RunPicture, options: ChartOptions) -> Chosen:
    """What is shown; a quantity that this run does not have makes room for an objective, or for nothing."""
    known = known_columns(picture)
    return Chosen(
        known.get(options.x, known["f1"]), known.get(options.y, known["f2"]),
        known.get(options.colour), known.get(options.size),
    )  # fmt: skip


def scatter_rows(picture: RunPicture, generation: int | None, infeasible: bool) -> NDArray[np.int64]:
    """Rows of the designs that are drawn: solved or predicted, up to a generation, feasible ones or all."""
    shown = ~picture.failed & (picture.feasible | infeasible)
    if generation is not None:
        shown &= picture.generation <= generation
    return np.flatnonzero(shown)


def scatter_limits(picture: RunPicture, options: ChartOptions, rows: NDArray[np.int64]) -> tuple[Limits, Limits]:
    """Limits that show all of these designs."""
    wanted = chosen(picture, options)
    return padded(_values(picture, wanted.x)[rows], 0.05), padded(_values(picture, wanted.y)[rows], 0.07)


def scatter_chart(
    picture: RunPicture,
    options: ChartOptions,
    rows: NDArray[np.int64],
    filters: Mapping[str, tuple[float, float]],
    limits: tuple[Limits, Limits],
    marks: Sequence[Mark],
    sheet: Sheet,
) -> Plot:
    """The chart.

    Args:
        picture: the run.
        options: what is shown.
        rows: of ``scatter_rows``.
        filters: what lies outside is faded.
        limits: of both axes.
        marks: drawn last.
        sheet: size and style.
    """
    wanted = chosen(picture, options)
    plot = Plot(
        sheet.width, sheet.height, Axis(wanted.x.title() + wanted.x.place, limits[0]),
        Axis(wanted.y.title() + wanted.y.place, limits[1], 5),
        margins=(52, 14, 8, 36), style=sheet.style,
    )  # fmt: skip
    x, y = _values(picture, wanted.x), _values(picture, wanted.y)
    keep = picture.inside(filters)
    colour = _steps(picture, wanted.colour, rows, len(COLOURS))
    size = _steps(picture, wanted.size, rows, len(_RADII))
    for inside, fade in ((False, "opacity:.15"), (True, "opacity:.75")):
        for step in sorted(set(colour.tolist())):
            for large in sorted(set(size.tolist()), reverse=True):
                own = rows[(colour == step) & (size == large) & (keep[rows] == inside)]
                if not own.size:
                    continue
                radius = _RADII[large] if large >= 0 else _PLAIN_RADIUS
                paint = f"stroke:{COLOURS[step]};{fade}" if step >= 0 else fade
                plot.dots(x[own], y[own], radius, "archive", paint)
    newest = picture.generation_at(None)
    front = np.intersect1d(picture.rows(newest.front), rows) if newest is not None else rows[:0]
    for row in front:
        plot.mark(float(x[row]), float(y[row]), "circle", 3.6, f"level{picture.level[row]} open")
    if front.size and newest is not None:
        plot.keys.append(Key("ring", f"level{newest.level} open", f"front of level {newest.level}"))
    if rows.size:
        draw_marks(plot, marks)
    else:
        plot.message(
            "No feasible design yet.\nPress infeasible above to see the others."
            if len(picture.ids)
            else "No designs yet."
        )
    return plot


def scatter_words(picture: RunPicture, options: ChartOptions, rows: NDArray[np.int64]) -> Markup:
    """What colour and size tell."""
    wanted = chosen(picture, options)
    parts = []
    if wanted.colour is not None:
        parts.append(ramp(wanted.colour, finite_limits(_values(picture, wanted.colour)[rows])))
    if wanted.size is not None:
        low, high = finite_limits(_values(picture, wanted.size)[rows])
        parts.append(
            fill(
                '<p class="soft">size: {} from {} to {} {}</p>',
                wanted.size.label + wanted.size.place,
                number_text(low, wanted.size.decimals),
                number_text(high, wanted.size.decimals),
                wanted.size.unit,
            )
        )
    return fill('<div class="scales">{}</div>', joined(parts)) if parts else Markup("")


def pick_scatter(
    picture: RunPicture,
    options: ChartOptions,
    rows: NDArray[np.int64],
    place: tuple[float, float],
    limits: tuple[Limits, Limits],
    size: tuple[float, float],
) -> list[int]:
    """Designs near a place of the data, the nearest first; none where nothing lies within reach.

    Args:
        picture, options, rows, limits: as drawn.
        place: (x, y) of the pointer in data.
        size: of the plot area in px.
    """
    if not rows.size:
        return []
    wanted = chosen(picture, options)
    away = np.hypot(
        *(
            (_values(picture, quantity)[rows] - at) / (high - low) * length
            for quantity, at, (low, high), length in zip((wanted.x, wanted.y), place, limits, size, strict=True)
        )
    )
    away[~np.isfinite(away)] = np.inf
    near = np.argsort(away, kind="stable")[:5]
    return [int(picture.ids[rows[index]]) for index in near if away[index] <= _REACH]


def choices(name: str, picture: RunPicture, now: str, word: str, optional: bool) -> Markup:
    """A list of the quantities of a run, to choose one of them.

    Args:
        name: of the list, for its event.
        picture: the run.
        now: the chosen key.
        word: its label.
        optional: whether nothing may be chosen.
    """
    groups: dict[str, list[Markup]] = {}
    for item in known_columns(picture).values():
        unit = f" [{item.unit}]" if item.unit else ""
        selected = Markup(" selected") if item.key == now else Markup("")
        option = fill('<option value="{}"{}>{}{}</option>', item.key, selected, item.label, unit)
        groups.setdefault(item.group, []).append(option)
    parts = [fill('<optgroup label="{}">{}</optgroup>', group, joined(own)) for group, own in groups.items()]
    none = Markup('<option value="">–</option>') if optional else Markup("")
    return fill(
        '<label class="choose">{} <select data-set="chart_choice" data-arg="{}">{}{}</select></label>',
        symbol_html(word),
        name,
        none,
        joined(parts),
    )


def _values(picture: RunPicture, quantity: Quantity) -> NDArray[np.float64]:
    values = picture.column(quantity.key)
    return np.full(len(picture.ids), np.nan) if values is None else values


def _steps(picture: RunPicture, quantity: Quantity | None, rows: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    if quantity is None:
        return np.full(rows.shape, -1, dtype=np.int64)
    values = _values(picture, quantity)[rows]
    return steps(values, finite_limits(values), count)
