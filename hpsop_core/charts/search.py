"""Charts of a search: Pareto chart, convergence, best objectives, evolution of fronts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hpsop_core.charts.axis import Axis, Limits, padded
from hpsop_core.charts.looks import Published, Sheet, draw_published
from hpsop_core.charts.plot import Plot
from hpsop_core.evaluation.levels import LEVEL_NUMBERS
from hpsop_core.typing_aliases import Array

COINCIDENT = 2.5
"""Marks closer than this many px are one spot."""

_COUNT_SPACE = 26.0


@dataclass(frozen=True, eq=False)
class Cloud:
    """Many designs drawn alike.

    Attributes:
        points: (n, 2) objectives.
        css: role.
        radius: px.
        style: CSS of their own.
        key: words of the legend, and name in the CSV.
    """

    points: Array
    css: str
    radius: float = 2.0
    style: str = ""
    key: str = ""


@dataclass(frozen=True, eq=False)
class Front:
    """A front: marks joined by a line.

    Attributes:
        points: (n, 2), ascending in the first objective.
        css: role.
        radius: of the marks in px.
        line_style: CSS of the line.
        mark_styles: CSS of each mark; none means no own style.
        key: words of the legend, and name in the CSV.
        counts: how many designs each mark stands for; none means one each.
        line: (m, 2) points of the line; None for those of the marks.
    """

    points: Array
    css: str
    radius: float = 4.2
    line_style: str = ""
    mark_styles: Sequence[str] = ()
    key: str = ""
    counts: Sequence[int] = ()
    line: Array | None = None


@dataclass(frozen=True)
class Mark:
    """A design that stands out.

    Attributes:
        x, y: its objectives.
        shape, size, css: of its mark.
        title: shown at the pointer.
        key: words of the legend, and name in the CSV.
    """

    x: float
    y: float
    shape: str
    size: float
    css: str
    title: str = ""
    key: str = ""


def family_front(front: Front, names: Sequence[int]) -> tuple[Cloud, Front]:
    """A front whose families are one mark each: the members as small dots, and the marks with their counts.

    Args:
        front: every design a mark.
        names: of each design's family.

    Returns:
        The dots, and the marks: of each family the member in the middle.
    """
    rows = [np.flatnonzero(np.asarray(names) == name) for name in dict.fromkeys(names)]
    middle = [int(row[len(row) // 2]) for row in rows]
    marked = replace(
        front,
        points=front.points[middle],
        mark_styles=[front.mark_styles[row] for row in middle] if front.mark_styles else (),
        counts=[len(row) for row in rows],
        line=front.points,
    )
    return Cloud(front.points, front.css, 1.7, "opacity:.55"), marked


def window(core: Array, cloud: Array) -> tuple[Limits, Limits]:
    """Limits of a Pareto chart: all of ``core`` (n, 2), the better three quarters of a cloud (n, 2), air round them."""
    limits = []
    for axis in (0, 1):
        values = core[:, axis].tolist()
        if len(cloud):
            values += [float(np.nanmin(cloud[:, axis])), float(np.nanquantile(cloud[:, axis], 0.75))]
        limits.append(padded(values, 0.06))
    return limits[0], limits[1]


def pareto_chart(
    clouds: Sequence[Cloud],
    fronts: Sequence[Front],
    marks: Sequence[Mark],
    limits: tuple[Limits, Limits],
    titles: tuple[str, str],
    sheet: Sheet,
) -> Plot:
    """Everything evaluated, and what stands out.

    Args:
        clouds, fronts, marks: drawn in this order; the last front counts designs that coincide, or its own counts.
        limits: of both objectives.
        titles: of the axes.
        sheet: size and style.
    """
    x, y = Axis(titles[0], limits[0]), Axis(titles[1], limits[1], 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(50, 18, 8, 34), style=sheet.style)
    for cloud in clouds:
        f = cloud.points
        plot.dots(f[:, 0], f[:, 1], cloud.radius, cloud.css, cloud.style, name=cloud.key, key=cloud.key)
    for front in fronts:
        f, path = front.points, front.points if front.line is None else front.line
        plot.line(path[:, 0], path[:, 1], f"{front.css} thin", front.line_style, name=front.key)
        for row in range(len(f)):
            style = front.mark_styles[row] if front.mark_styles else ""
            key = front.key if row == 0 else ""
            plot.mark(f[row, 0], f[row, 1], "circle", front.radius, front.css, style, key=key)
    if fronts and fronts[-1].counts:
        for point, count in zip(fronts[-1].points, fronts[-1].counts, strict=True):
            if count > 1:
                plot.text(float(point[0]), float(point[1]), f"×{count}", "count", dx=6, dy=-5)
    elif fronts:
        count_coincident(plot, fronts[-1].points)
    draw_marks(plot, marks)
    return plot


def draw_marks(plot: Plot, marks: Sequence[Mark]) -> None:
    """Marks on top of a chart."""
    for mark in marks:
        plot.mark(mark.x, mark.y, mark.shape, mark.size, mark.css, title=mark.title, name=mark.key, key=mark.key)


def count_coincident(plot: Plot, points: Array) -> None:
    """A small number beside marks that hide others: "×3" are three designs on one spot; points (n, 2)."""
    pixels = np.column_stack([plot.px(points[:, 0]), plot.py(points[:, 1])])
    waiting = list(range(len(points)))
    last: NDArray[np.float64] | None = None
    while waiting:
        first = waiting[0]
        same = [index for index in waiting if float(np.hypot(*(pixels[index] - pixels[first]))) <= COINCIDENT]
        waiting = [index for index in waiting if index not in same]
        # where marks crowd, numbers would only cover one another
        free = last is None or float(np.hypot(*(pixels[first] - last))) >= _COUNT_SPACE
        if len(same) > 1 and free:
            last = pixels[first]
            plot.text(float(points[first, 0]), float(points[first, 1]), f"×{len(same)}", "count", dx=6, dy=-5)


def convergence_chart(
    numbers: Sequence[int],
    levels: Sequence[int],
    hypervolume: Sequence[float],
    total: int,
    sheet: Sheet,
    feasible: Sequence[float] | None = None,
) -> Plot:
    """Hypervolume of the feasible front, one line a level.

    Args:
        numbers, levels, hypervolume: of each generation.
        total: generations asked for.
        sheet: size and style.
        feasible: share of the population (0 to 1) of each generation, on a second axis, or none.
    """
    shown = [value for value in hypervolume if np.isfinite(value)]
    x = Axis("generation [–]", (0.0, float(max(total, 1))))
    # an area: never negative, and none at all while no design is feasible
    low, high = padded(shown, 0.08) if any(shown) else (0.0, 1.0)
    y = Axis("hypervolume [–]", (max(low, 0.0), high), 5)
    second = None if feasible is None else Axis("feasible [%]", (0.0, 104.0), 5)
    plot = Plot(sheet.width, sheet.height, x, y, second, margins=(56, 14, 8, 34), style=sheet.style)
    if not shown:
        plot.message("no generation yet")
    for level in LEVEL_NUMBERS:
        at = [index for index, item in enumerate(levels) if item == level]
        if not at:
            continue
        css, own = f"level{level}", [numbers[i] for i in at]
        if feasible is not None:
            shares = [100.0 * feasible[i] for i in at]
            name = f"feasible, level {level}"
            plot.line(own, shares, f"{css} dot thin", name=name, second=True)
        plot.line(own, [hypervolume[i] for i in at], css, name=f"level {level}", key=f"level {level}")
        plot.mark(float(own[-1]), float(hypervolume[at[-1]]), "circle", 3.4, css)
    if feasible is not None and shown:
        plot.line([], [], "soft dot thin", key="feasible share of the population")
    return plot


def best_chart(
    numbers: Sequence[int], levels: Sequence[int], best: Sequence[tuple[float, float]], total: int, sheet: Sheet
) -> Plot:
    """The least feasible f1 and f2 of each generation's front; each level divides by its own initial design."""
    values = np.asarray(best, dtype=float).reshape(-1, 2)
    x = Axis("generation [–]", (0.0, float(max(total, 1))))
    y = Axis("least objective on the front [–]", padded(values, 0.08), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(56, 14, 8, 34), style=sheet.style)
    for column, css in ((0, "pin1"), (1, "pin2")):
        plot.line([], [], css, key=f"least f_{column + 1}")
        for level in LEVEL_NUMBERS:
            at = np.flatnonzero(np.asarray(levels) == level)
            if at.size:
                plot.line(np.asarray(numbers)[at], values[at, column], css, name=f"least f{column + 1}, level {level}")
    return plot


def evolution_chart(
    fronts: Sequence[Front], titles: tuple[str, str], sheet: Sheet, published: Sequence[Published] = ()
) -> Plot:
    """Fronts of several generations, and published designs."""
    shown = [*(front.points for front in fronts), *(np.column_stack([item.x, item.y]) for item in published)]
    both = np.concatenate(shown) if shown else np.zeros((0, 2))
    limits = (padded(both[:, 0], 0.06), padded(both[:, 1], 0.06))
    x, y = Axis(titles[0], limits[0]), Axis(titles[1], limits[1], 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(50, 18, 8, 34), style=sheet.style)
    for front in fronts:
        f = front.points
        plot.line(f[:, 0], f[:, 1], f"{front.css} thin", front.line_style, name=front.key, key=front.key)
        for point in f:
            plot.mark(float(point[0]), float(point[1]), "circle", front.radius, front.css, front.line_style)
    draw_published(plot, published)
    return plot
