"""The Pareto chart: archive, fronts, marked designs, and which design a click means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.state.run_picture import ACTIVE, FAILED, GenerationPicture, RunPicture
from hpsop_core.charts.axis import Limits, padded
from hpsop_core.charts.frame import Key
from hpsop_core.charts.looks import Sheet
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.search import COINCIDENT, Cloud, Front, Mark, draw_marks, family_front
from hpsop_core.charts.search import pareto_chart as drawn_chart
from hpsop_core.evaluation.levels import FAST, LEVEL_NUMBERS
from hpsop_core.optimization.families import families, half_widths, narrow

_FRONT_BONUS = 5.0
_REACH = 18.0


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
    if set(x) == set(y) == {1.0}:
        # nothing but the initial design
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
    drawn = drawn_designs(picture, options)
    keep = picture.inside(options.filters or {})
    f = picture.objectives
    archive = drawn.rows[~drawn.front]
    clouds = []
    kept = archive[picture.feasible[archive] & ~picture.by_hand[archive]]
    solved = kept[~picture.predicted[kept]]
    for css, rows in (
        ("infeasible", archive[~picture.feasible[archive]]),
        ("archive predicted", kept[picture.predicted[kept]]),
        *((f"archive level{level}", solved[picture.level[solved] == level]) for level in LEVEL_NUMBERS),
    ):
        for inside, style in ((False, "opacity:.18"), (True, "opacity:.75")):
            clouds.append(Cloud(f[rows[keep[rows] == inside]], css, style=style))
    fronts = _drawn_fronts(picture, options, keep)
    if fronts:
        rows, names, _ = newest_families(picture, options.generation)
        if len(rows) and max(names) < len(rows):
            dots, fronts[-1] = family_front(fronts[-1], names)
            clouds.append(dots)
    limits = options.limits or automatic_limits(picture, options)
    plot = drawn_chart(clouds, fronts, _fixed_marks(picture, options), limits, titles, Sheet(width, height))
    if options.filters and {"f1", "f2"} <= set(options.filters):
        (a, b), (c, d) = options.filters["f1"], options.filters["f2"]
        plot.rectangle(a, b, c, d, "boxed")
    return plot


def _drawn_fronts(picture: RunPicture, options: ParetoOptions, keep: NDArray[np.bool_]) -> list[Front]:
    f = picture.objectives
    fronts = _fronts(picture, options.generation)
    drawn = []
    for item in fronts:
        rows = picture.rows(item.front)
        rows = rows[np.argsort(f[rows, 0], kind="stable")]
        newest = item is fronts[-1]
        whole = "" if newest else "opacity:.55"
        faded = [whole if keep[row] else "opacity:.2" for row in rows]
        line = "" if newest else "opacity:.45"
        drawn.append(Front(f[rows], f"level{item.level}", 4.2 if newest else 3.0, line, faded))
    return drawn


def newest_families(
    picture: RunPicture, generation: int | None = None
) -> tuple[NDArray[np.int64], tuple[int, ...], str]:
    """The newest front's rows ascending in f1, the family of each, and a sentence where it is narrower than its error.

    See ``hpsop_core.optimization.families``.
    """
    shown = _fronts(picture, generation)
    if not shown:
        return np.zeros(0, dtype=np.int64), (), ""
    f, item = picture.objectives, shown[-1]
    rows = picture.rows(item.front)
    rows = rows[np.argsort(f[rows, 0], kind="stable")]
    if not len(rows):
        return rows, (), ""
    known = [picture.comparison.get(int(number), {}) for number in picture.ids[rows]]
    widths = half_widths([item.level] * len(rows), f[rows], known)
    return rows, tuple(int(name) for name in families(f[rows], widths)), narrow(f[rows], widths)


@dataclass(frozen=True)
class Beyond:
    """What a drawn front does not say by itself: no chart may show a design that is better than it without a word.

    Attributes:
        count: feasible designs that dominate a drawn front of their own level.
        most: by how much the best of them is better in both objectives at once, as a part of the initial design's.
        reasons: why they are not on the front, a sentence a level.
        margin: in few words, and why, where level 1's front holds designs that the search avoids; else "", "".
    """

    count: int = 0
    most: float = 0.0
    reasons: tuple[str, ...] = ()
    margin: tuple[str, str] = ("", "")


def beyond_fronts(picture: RunPicture, generation: int | None = None) -> Beyond:
    """What is said of feasible designs that dominate a drawn front of their own level, and of the hand-over margin."""
    count, most, reasons, margin = 0, 0.0, [], ("", "")
    for item in _fronts(picture, generation):
        own = picture.feasible & (picture.level == item.level)
        if generation is not None:
            own &= picture.generation <= generation
        rows = picture.rows(item.front)
        front = picture.objectives[rows]
        found = np.flatnonzero(own)
        if not len(found) or not len(front):
            continue
        if item.level == FAST.number:
            margin = _margin_words(picture, rows)
        # Whom anything on the front could beat: the greatest f2 among the front's designs with no less f1 is no less.
        order = np.argsort(front[:, 0], kind="stable")
        highest = np.append(np.maximum.accumulate(front[order[::-1], 1])[::-1], -np.inf)
        points = picture.objectives[found]
        maybe = points[:, 1] <= highest[np.searchsorted(front[order, 0], points[:, 0])]
        found, points = found[maybe], points[maybe]
        if not len(found):
            continue
        gain = front[None, :, :] - points[:, None, :]
        least, greatest = gain.min(axis=2), gain.max(axis=2)
        better = ((least >= 0.0) & (greatest > 0.0)).any(axis=1)
        if better.any():
            count += int(better.sum())
            most = max(most, float(least.max()))
            reasons.append(_why_beyond(picture, item.level, found[better]))
    return Beyond(count, most, tuple(reasons), margin)


def _why_beyond(picture: RunPicture, level: int, rows: NDArray[np.int64]) -> str:
    hand, predicted = picture.by_hand[rows], picture.predicted[rows]
    begun = ~hand & ~predicted
    reasons = []
    if predicted.any():
        reasons.append(
            f"{int(predicted.sum())} predicted by a learnt surface and not solved: the best of many predictions is too "
            "good by its error, so a front holds solved designs, and predicted ones only while they are the population"
        )
    if hand.any():
        reasons.append(f"{int(hand.sum())} made by hand, which the search does not breed from")
    if begun.any():
        reasons.append(f"{int(begun.sum())} of a generation that is not finished yet")
    found = "1 feasible design" if len(rows) == 1 else f"{len(rows)} feasible designs"
    return f"{found} of level {level} better than its front: {'; '.join(reasons)}."


def _margin_words(picture: RunPicture, front: NDArray[np.int64]) -> tuple[str, str]:
    settings, cavitation = picture.case.optimization, picture.column("g_cavitation")
    margin = settings.handover_margin
    if cavitation is None or margin <= 0.0 or settings.level1_generations >= settings.generations:
        return "", ""
    within = int((cavitation[front] > -margin).sum())
    if not within:
        return "", ""
    return (
        f"{within} of the {len(front)} designs on level 1's front are ones that the search avoids",
        f"They lie within the hand-over margin: before level 2 comes the search keeps {margin:g} of blade area ratio "
        "from the cavitation limit, where level 2 asks for more thrust.",
    )


def _fixed_marks(picture: RunPicture, options: ParetoOptions) -> list[Mark]:
    f = picture.objectives
    marks = [
        Mark(f[row, 0], f[row, 1], "square", 4.0, "hand", f"made by hand: design {picture.ids[row]}")
        for row in np.flatnonzero(picture.by_hand & ~picture.failed)
    ]
    if options.generation is not None:
        return marks
    for design_id, shape, css, size, word in (
        (picture.knee, "diamond", "knee", 6.0, "knee"),
        (picture.compromise, "star", "compromise", 8.0, "compromise"),
    ):
        row = picture.row(design_id) if design_id is not None else None
        if row is not None:
            marks.append(Mark(f[row, 0], f[row, 1], shape, size, css, f"{word}: design {design_id}"))
    return marks


def pareto_chart(picture: RunPicture, background: Plot, marks: Sequence[Mark], keys: Sequence[Key] = ()) -> Plot:
    """The whole chart.

    Args:
        picture: the run.
        background: of ``pareto_background``; it stays as it is.
        marks: drawn last, in order.
        keys: the legend.
    """
    plot = background.copy()
    plot.keys += keys
    draw_marks(plot, marks)
    # a run begins with the initial design, which is no answer yet
    if len(picture.ids) <= 1 and not picture.generations and len(marks) <= 2:
        if picture.status == FAILED:
            words = "The run failed before its first generation."
        elif picture.status in ACTIVE:
            words = "The first designs are being evaluated:\neach generation's front appears here."
        else:
            words = "No designs yet.\nPress Start: each generation's front appears here."
        plot.message(words, numbers=True)
    return plot


PARETO_GESTURES = 'data-drag="pan" data-hover="1" data-click="1" data-box="1" tabindex="0"'
"""What the chart's element says of the gestures that it answers."""


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
    same = np.flatnonzero(apart <= COINCIDENT)
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
