"""The Pareto chart: archive, fronts, marked designs, and which design a click means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.charts.plot import Limits, Plot, padded
from explorer.state.run_picture import GenerationPicture, RunPicture

_FRONT_BONUS = 5.0
_REACH = 18.0
_COUNT_SPACE = 26.0
_COINCIDENT = 2.5


@dataclass(frozen=True)
class ParetoMark:
    """A design that stands out: selection, pin, initial design."""

    f1: float
    f2: float
    shape: str
    size: float
    css: str
    title: str


@dataclass(frozen=True)
class ParetoOptions:
    """What the chart shows.

    Attributes:
        generation: the scrubbed generation, or None for the newest.
        archive, infeasible: whether those designs are drawn.
        filters: ranges by quantity; what lies outside is faded.
        limits: (x, y) when zoomed, else None.
    """

    generation: int | None = None
    archive: bool = True
    infeasible: bool = False
    filters: Mapping[str, tuple[float, float]] | None = None
    limits: tuple[Limits, Limits] | None = None


@dataclass(frozen=True)
class Drawn:
    """The designs on the chart: rows of the picture, and which of them are front points."""

    rows: NDArray[np.int64]
    front: NDArray[np.bool_]


def drawn_designs(picture: RunPicture, options: ParetoOptions) -> Drawn:
    """Rows that the chart shows at the scrubbed generation."""
    front_rows = [picture.rows(item.front) for item in _fronts(picture, options.generation)]
    front = np.concatenate(front_rows) if front_rows else np.zeros(0, dtype=np.int64)
    shown = np.zeros(len(picture.ids), dtype=bool)
    if options.archive:
        shown |= picture.feasible
    if options.infeasible:
        shown |= ~picture.feasible & ~picture.failed
    shown |= picture.by_hand & ~picture.failed
    if options.generation is not None:
        shown &= picture.generation <= options.generation
    shown[front] = True
    rows = np.flatnonzero(shown)
    return Drawn(rows, np.isin(rows, front))


def _fronts(picture: RunPicture, generation: int | None) -> list[GenerationPicture]:
    found = [picture.last_of_level(level, generation) for level in (1, 2)]
    return [item for item in found if item is not None]


def automatic_limits(picture: RunPicture, options: ParetoOptions) -> tuple[Limits, Limits]:
    """Limits that show the fronts, the initial design and the better part of the archive."""
    x, y = [1.0], [1.0]
    points = picture.objectives[picture.feasible]
    if len(points):
        low, high = np.nanmin(points, axis=0), np.nanpercentile(points, 80, axis=0)
        x += [float(low[0]), float(high[0])]
        y += [float(low[1]), float(high[1])]
    elif np.isfinite(picture.objectives).any():
        low, high = np.nanpercentile(picture.objectives, (2, 70), axis=0)
        x += [float(low[0]), float(high[0])]
        y += [float(low[1]), float(high[1])]
    for item in _fronts(picture, options.generation):
        front = picture.objectives[picture.rows(item.front)]
        x += front[:, 0].tolist()
        y += front[:, 1].tolist()
    if len(x) == 1:
        return (0.9, 1.05), (0.9, 1.05)
    return padded(x, 0.05), padded(y, 0.07)


def pareto_background(
    picture: RunPicture, options: ParetoOptions, titles: tuple[str, str], width: float, height: float
) -> Plot:
    """All of the chart but the marks that move with the selection: worth keeping while only these move.

    Args:
        picture: the run.
        options: what to show.
        titles: of the axes.
        width, height: px.
    """
    x_limits, y_limits = options.limits or automatic_limits(picture, options)
    plot = Plot(width, height, x_limits, y_limits, *titles, margins=(50, 18, 8, 34))
    drawn = drawn_designs(picture, options)
    keep = picture.inside(options.filters or {})
    f = picture.objectives
    archive = drawn.rows[~drawn.front]
    groups = (
        ("infeasible", archive[~picture.feasible[archive]], 2.0),
        ("archive", archive[picture.feasible[archive] & ~picture.by_hand[archive]], 2.0),
    )
    for css, rows, radius in groups:
        for inside, extra in ((False, "opacity:.18"), (True, "opacity:.75")):
            part = rows[keep[rows] == inside]
            plot.dots(f[part, 0], f[part, 1], radius, css, extra)
    if options.filters and {"f1", "f2"} <= set(options.filters):
        (a, b), (c, d) = options.filters["f1"], options.filters["f2"]
        plot.rectangle(a, b, c, d, "boxed")
    fronts = _fronts(picture, options.generation)
    for item in fronts:
        rows = picture.rows(item.front)
        rows = rows[np.argsort(f[rows, 0], kind="stable")]
        newest = item is fronts[-1]
        css = f"level{item.level}"
        plot.line(f[rows, 0], f[rows, 1], f"{css} thin", "" if newest else "opacity:.45")
        for row in rows:
            fade = "" if keep[row] else "opacity:.2"
            if newest:
                plot.mark(f[row, 0], f[row, 1], "circle", 4.2, css, fade)
            else:
                plot.mark(f[row, 0], f[row, 1], "circle", 3.0, css, fade or "opacity:.55")
    if fronts:
        _count_coincident(plot, f[picture.rows(fronts[-1].front)])
    for row in np.flatnonzero(picture.by_hand & ~picture.failed):
        plot.mark(f[row, 0], f[row, 1], "square", 4.0, "hand", title=f"made by hand: design {picture.ids[row]}")
    if options.generation is None:
        for design_id, shape, css, size, word in (
            (picture.knee, "diamond", "knee", 6.0, "knee"),
            (picture.compromise, "star", "compromise", 8.0, "compromise"),
        ):
            row = picture.row(design_id) if design_id is not None else None
            if row is not None:
                plot.mark(f[row, 0], f[row, 1], shape, size, css, title=f"{word}: design {design_id}")
    return plot


def pareto_chart(picture: RunPicture, background: Plot, marks: Sequence[ParetoMark]) -> str:
    """The chart as SVG.

    Args:
        picture: the run.
        background: of ``pareto_background``; it stays as it is.
        marks: drawn last, in order.
    """
    plot = background.copy()
    for mark in marks:
        plot.mark(mark.f1, mark.f2, mark.shape, mark.size, mark.css, title=mark.title)
    if not len(picture.ids) and len(marks) <= 2:
        plot.message("No designs yet.\nPress Start: each generation's front appears here.", numbers=True)
    return plot.svg("pareto", 'data-drag="pan" data-hover="1" data-click="1" data-box="1" tabindex="0"')


def _count_coincident(plot: Plot, points: NDArray[np.float64]) -> None:
    """A small number beside marks that hide others: "×3" are three designs on one spot."""
    pixels = np.column_stack([plot.px(points[:, 0]), plot.py(points[:, 1])])
    waiting = list(range(len(points)))
    last: NDArray[np.float64] | None = None
    while waiting:
        first = waiting[0]
        same = [index for index in waiting if float(np.hypot(*(pixels[index] - pixels[first]))) <= _COINCIDENT]
        waiting = [index for index in waiting if index not in same]
        # where marks crowd, numbers would only cover one another
        free = last is None or float(np.hypot(*(pixels[first] - last))) >= _COUNT_SPACE
        if len(same) > 1 and free:
            last = pixels[first]
            plot.text(points[first, 0], points[first, 1], f"×{len(same)}", "count", dx=6, dy=-5)


def pick(
    picture: RunPicture,
    options: ParetoOptions,
    x: float,
    y: float,
    limits: tuple[Limits, Limits],
    size: tuple[float, float],
) -> list[int]:
    """Designs that a click at data (x, y) may mean: the nearest first, then those that coincide with it.

    Args:
        picture, options: as drawn.
        x, y: the pointer in data.
        limits: of the drawn chart.
        size: of the plot area in px.

    Returns:
        ids; empty when nothing lies within reach.
    """
    drawn = drawn_designs(picture, options)
    if not len(drawn.rows):
        return []
    points = picture.objectives[drawn.rows]
    (x0, x1), (y0, y1) = limits
    dx = (points[:, 0] - x) / (x1 - x0) * size[0]
    dy = (points[:, 1] - y) / (y1 - y0) * size[1]
    distance = np.hypot(dx, dy)
    distance[~np.isfinite(distance)] = np.inf
    score = distance - _FRONT_BONUS * drawn.front
    best = int(np.argmin(score))
    if distance[best] > _REACH:
        return []
    apart = np.hypot(dx - dx[best], dy - dy[best])
    same = np.flatnonzero(apart <= _COINCIDENT)
    same = same[np.lexsort((same, ~drawn.front[same], apart[same] > 1e-9))]
    ordered = [best, *[int(index) for index in same if index != best]]
    return [int(picture.ids[drawn.rows[index]]) for index in ordered]


def front_order(picture: RunPicture, generation: int | None) -> list[int]:
    """Ids of the scrubbed generation's front from the least f1 to the greatest."""
    item = picture.generation_at(generation)
    if item is None:
        return []
    rows = picture.rows(item.front)
    rows = rows[np.lexsort((picture.ids[rows], picture.objectives[rows, 1], picture.objectives[rows, 0]))]
    return [int(value) for value in picture.ids[rows]]
