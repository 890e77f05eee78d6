"""Parallel coordinates over variables, objectives and results; brushes filter the Pareto chart too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from explorer.charts.colour_ramp import colour_of, finite_limits
from explorer.state.run_picture import RunPicture
from hpsop_core.case.variables import SEARCH_TABLE
from hpsop_core.markup import Markup, fill, joined, symbol_svg
from hpsop_core.quantities import OBJECTIVES, Quantity, free_variables, number_text, quantities_of_case

_MOST_LINES = 350
_TEXT = '<text x="{:.1f}" y="{:.1f}" text-anchor="middle" class="{}">{}</text>'
_NAME = (
    '<text x="{:.1f}" y="{:.1f}" text-anchor="middle" class="axis-title axis-move" tabindex="0" role="button" '
    'data-axis="{}" aria-label="{}: arrow keys move it" aria-keyshortcuts="ArrowLeft ArrowRight">{}</text>'
)
_RESULTS = ("block_coefficient", "total_resistance_1", "open_water_efficiency_1", "delivered_power_1")


def axes_of(picture: RunPicture, order: Sequence[str] = ()) -> list[Quantity]:
    """Free variables, a few results, and the objectives; those named in ``order`` (keys) first, as it says."""
    chosen = free_variables(picture.case)
    everything = {quantity.key: quantity for quantity in quantities_of_case(picture.case)}
    chosen += [everything[key] for key in _RESULTS if key in everything]
    axes = [*chosen, *OBJECTIVES]
    place = {key: index for index, key in enumerate(order)}
    return sorted(axes, key=lambda quantity: place.get(quantity.key, len(place)))


def moved(picture: RunPicture, order: Sequence[str], start: float, end: float) -> tuple[str, ...] | None:
    """The order of the axes after one was dragged from one fraction of the chart's width to another; None for none."""
    keys = [quantity.key for quantity in axes_of(picture, order)]
    if not max(abs(start), abs(end)) < 10.0:
        return None
    source, target = (round(fx * (len(keys) - 1)) for fx in (start, end))
    if not 0 <= source < len(keys) or source == target:
        return None
    key = keys.pop(source)
    keys.insert(min(max(target, 0), len(keys)), key)
    return tuple(keys)


def stepped(picture: RunPicture, order: Sequence[str], key: str, by: int) -> tuple[str, ...] | None:
    """The order of the axes after one was moved by so many places; None where there is no such axis or place."""
    keys = [quantity.key for quantity in axes_of(picture, order)]
    if key not in keys or not 0 <= (place := keys.index(key) + by) < len(keys):
        return None
    keys.remove(key)
    keys.insert(place, key)
    return tuple(keys)


def _axis_title(quantity: Quantity) -> str:
    # a dozen axes side by side have no room for the unit of a number that has none
    return quantity.title() if quantity.unit else quantity.symbol


def parallel_chart(
    picture: RunPicture,
    filters: Mapping[str, tuple[float, float]],
    selected: int | None,
    generation: int | None,
    width: float,
    height: float,
    order: Sequence[str] = (),
    colour: Quantity | None = None,
) -> Markup:
    """The chart as SVG: the archive thin, the front thick, what a brush keeps out faded.

    Args:
        picture: the run.
        filters: of the brushes.
        selected: a design's id, drawn on top.
        generation: up to which one, or None for all.
        width, height: px.
        order: of the axes, by key.
        colour: what the colour of a line tells; the level where it is None.
    """
    axes = [(quantity, picture.column(quantity.key)) for quantity in axes_of(picture, order)]
    tints = picture.column(colour.key) if colour is not None else None
    left, right, top, bottom = 26.0, 26.0, 46.0, 20.0
    count = len(axes)
    gap = (width - left - right) / max(count - 1, 1)
    plot_height = height - top - bottom
    parts: list[Markup] = []
    usable = picture.feasible & ~picture.failed
    if generation is not None:
        usable &= picture.generation <= generation
    newest = picture.generation_at(generation)
    front_rows = picture.rows(newest.front) if newest is not None else np.zeros(0, dtype=np.int64)
    rows = np.flatnonzero(usable)
    if len(rows) > _MOST_LINES:
        rows = rows[np.linspace(0, len(rows) - 1, _MOST_LINES).astype(int)]
    rows = np.union1d(rows, front_rows)
    limits = [_axis_limits(picture, quantity, values) for quantity, values in axes]
    keep = picture.inside(filters)
    tint_limits = finite_limits(tints[rows]) if tints is not None else (0.0, 1.0)
    selected_row = picture.row(selected) if selected is not None else None
    for group, css in ((rows, "archive"), (front_rows, f"level{newest.level if newest else 1}")):
        for row in group:
            points: list[str] = []
            for index, (_, values) in enumerate(axes):
                value = values[row] if values is not None else np.nan
                if not np.isfinite(value):
                    points = []
                    break
                low, high = limits[index]
                points.append(f"{left + index * gap:.0f} {top + (1 - (value - low) / (high - low)) * plot_height:.1f}")
            if points:
                fade = "opacity:.06" if not keep[row] else "opacity:.35" if css == "archive" else "opacity:.9"
                if tints is not None:
                    tint = colour_of(float(tints[row]), tint_limits)
                    fade += f";stroke:{tint};stroke-width:{1.0 if css == 'archive' else 2.0}" if tint else ""
                path = "M" + "L".join(points)
                parts.append(fill('<path d="{}" class="line thin {}" style="{}"/>', path, css, fade))
                if row == selected_row:
                    parts.append(fill('<path d="{}" class="line selected" style="stroke-width:2.6"/>', path))
    for index, (quantity, _) in enumerate(axes):
        x = left + index * gap
        low, high = limits[index]
        title_y = 11 if index % 2 == 0 else 25
        parts.append(fill('<path d="M{:.1f} {:.1f}V{:.1f}" class="axis"/>', x, top, top + plot_height))
        hint = f"{quantity.label}{quantity.place}; drag the name sideways to move its axis, or use ← → on it"
        title = fill("<title>{}</title>{}", hint, symbol_svg(_axis_title(quantity)))
        parts.append(fill(_NAME, x, title_y, quantity.key, f"axis of {quantity.label}{quantity.place}", title))
        for value, y in ((high, top - 4), (low, top + plot_height + 12)):
            parts.append(fill(_TEXT, x, y, "note", number_text(value, min(quantity.decimals, 3))))
        if quantity.key in filters:
            a, b = filters[quantity.key]
            y0 = top + (1 - (min(b, high) - low) / (high - low)) * plot_height
            y1 = top + (1 - (max(a, low) - low) / (high - low)) * plot_height
            box = '<rect x="{:.1f}" y="{:.1f}" width="12" height="{:.1f}" class="brush"/>'
            parts.append(fill(box, x - 6, y0, max(y1 - y0, 2)))
    if not len(rows):
        words = "no feasible design yet" if len(picture.ids) else "no designs yet"
        parts.append(fill(_TEXT, width / 2, height / 2, "empty", words))
    return fill(
        '<svg class="chart" data-chart="parallel" data-plot="{left:g},{top:g},{wide:g},{high:g}" '
        'data-limits="0,1,0,1" data-drag="brush" data-click="1" viewBox="0 0 {width:g} {height:g}" role="group" '
        'aria-label="parallel coordinates">{parts}</svg><p class="soft">Drag along an axis to keep a range (it filters '
        "the Pareto chart too); click an axis to drop its range; drag the name of an axis sideways to move it, or use "
        "← → on it.</p>",
        left=left,
        top=top,
        wide=width - left - right,
        high=plot_height,
        width=width,
        height=height,
        parts=joined(parts),
    )


def brushed(
    picture: RunPicture, order: Sequence[str], fx: float, fy0: float, fy1: float
) -> tuple[str, tuple[float, float] | None] | None:
    """The axis and range that a drag means: fractions of the plot area, upwards; a mere click drops the range.

    Returns:
        (quantity key, range or None), or None when the drag began far from every axis.
    """
    axes = axes_of(picture, order)
    position = fx * (len(axes) - 1)
    index = round(position)
    if not 0 <= index < len(axes) or abs(position - index) > 0.45:
        return None
    quantity = axes[index]
    if abs(fy1 - fy0) < 0.015:
        return quantity.key, None
    values = picture.column(quantity.key)
    low, high = _axis_limits(picture, quantity, values)
    a, b = sorted((min(max(fy0, 0.0), 1.0), min(max(fy1, 0.0), 1.0)))
    return quantity.key, (low + a * (high - low), low + b * (high - low))


def _axis_limits(picture: RunPicture, quantity: Quantity, values: NDArray[np.float64] | None) -> tuple[float, float]:
    """From the feasible designs, widened to a variable's bounds; the same for drawing and brushing."""
    usable = values[picture.feasible] if values is not None else np.zeros(0)
    usable = usable[np.isfinite(usable)]
    low, high = (float(usable.min()), float(usable.max())) if usable.size else (np.inf, -np.inf)
    bounds = picture.case.bounds.as_dict().get(quantity.key)
    if bounds is not None:
        shown = SEARCH_TABLE[quantity.key].shown
        low, high = min(low, shown(bounds[0])), max(high, shown(bounds[1]))
    if not low <= high:
        return 0.0, 1.0
    if high - low < 1e-12:
        return low - 0.5, high + 0.5
    return low, high
