"""The Pareto chart, drawn."""

from __future__ import annotations

from collections.abc import Sequence

import viser

from explorer.charts.designs_table import designs_csv
from explorer.charts.pareto import (
    PARETO_GESTURES,
    Beyond,
    ParetoOptions,
    automatic_limits,
    beyond_fronts,
    drawn_designs,
    newest_families,
    pareto_background,
    pareto_chart,
)
from explorer.server.html_slot import Slot
from explorer.services.designs import Designs
from explorer.state.run_picture import RunPicture
from explorer.state.session import Limits, Session
from explorer.state.shown import Shown
from explorer.state.table_options import TableOptions
from explorer.views.chips import NOTHING, box, soft
from explorer.views.saving import Figure, Saving
from hpsop_core.case.constraints import CONSTRAINTS, FEASIBILITY_TOLERANCE
from hpsop_core.charts.frame import Key
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.search import Mark
from hpsop_core.evaluation.levels import LEVEL_NUMBERS
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import objective_title


class ParetoChart:
    """Chart and legend of one browser.

    Attributes:
        limits: that the chart has, or will have as soon as it is drawn again.
    """

    def __init__(self, session: Session, designs: Designs, gui: viser.GuiApi, saving: Saving) -> None:
        self._session = session
        self._designs = designs
        self._saving = saving
        self._background: tuple[tuple[object, ...], Plot] | None = None
        self._html = Slot(gui)
        # apart from the chart, which is drawn at every selection: what was opened stays open; below the generations'
        # slider, which a small screen would not show otherwise
        self._words = Slot(gui, last=True)
        self._said = NOTHING
        self.limits: Limits = ((0.0, 1.0), (0.0, 1.0))
        topics = ("run", "scrub", "filter", "pins", "selection", "zoom pareto", "size", "layers")
        session.hub.on(topics, self.draw, self._html.failed)
        self.draw()

    @property
    def options(self) -> ParetoOptions:
        """What of the run is drawn."""
        session = self._session
        return ParetoOptions(
            session.scrubbed, session.archive, session.infeasible, dict(session.filters), session.limits.get("pareto")
        )

    @property
    def plot_size(self) -> tuple[float, float]:
        """Of the plot area, px."""
        if self._background is None:
            return self._session.chart_width, self._height()
        area = self._background[1].area
        return area.width, area.height

    def draw(self) -> None:
        """Draw everything again."""
        session, picture, options = self._session, self._session.picture, self.options
        self.limits = options.limits or automatic_limits(picture, options)
        objectives = picture.case.objectives
        titles = (objective_title(objectives.first, "f₁"), objective_title(objectives.second, "f₂"))
        # a selection moves a ring; thousands of archive points under it need not be written anew
        key = (picture, options, titles, session.chart_width, self._height())
        if self._background is None or not _same(self._background[0], key):
            self._background = (key, pareto_background(picture, options, titles, session.chart_width, self._height()))
            self._said = _beyond_words(beyond_fronts(picture, options.generation) if session.archive else Beyond())
        keys = [Key("circle", "level1", "level 1 front")]
        if picture.last_of_level(2) is not None:
            keys.append(Key("circle", "level2", "level 2 front"))
        if session.archive:
            keys += [
                Key("dots", f"archive level{level}", f"archive, level {level}")
                for level in LEVEL_NUMBERS
                if bool((picture.feasible & ~picture.predicted & (picture.level == level)).any())
            ]
            if picture.predictions:
                keys.append(Key("dots", "archive predicted", "predicted, not solved"))
        if session.infeasible:
            keys.append(Key("dots", "infeasible", "infeasible"))
        keys.append(Key("square", "initial", "initial"))
        if picture.compromise is not None:
            keys += [Key("star", "compromise", "compromise"), Key("diamond", "knee", "knee")]
        if bool(picture.by_hand.any()):
            keys.append(Key("square", "hand", "by hand"))
        if any(item.opening == picture.opening for item in session.pins):
            keys.append(Key("triangle", "pin1", "pinned"))
        rows, names, sentence = newest_families(picture, options.generation)
        words = fill('<p class="standing" data-narrow="1">{}</p>', sentence) if sentence else NOTHING
        families = NOTHING
        if len(rows) and max(names) < len(rows):
            families = soft(
                f"×n: n designs that the error of their numbers cannot tell apart; {max(names)} such families."
            )
        below = families + self._said
        self._words.show(box(below) if below else NOTHING)
        plot = pareto_chart(picture, self._background[1], self._marks(picture), keys)
        nothing = nothing_feasible(picture)
        if nothing:
            words = fill('<p class="standing" data-infeasible="1">{}</p>', nothing) + words
            if not session.infeasible:
                plot.message("No feasible design yet.\nPress infeasible to see the others.", numbers=True)
        # both are minimised, and the axes do not say so; below the corner, where no design lies
        plot.raw(
            fill('<text x="2" y="{:.1f}" class="note soft">↙ better</text>', plot.area.picture_height - 4), over=True
        )
        self._hint(plot)
        stars = session.stars

        def numbers() -> str:
            return designs_csv(picture, TableOptions(columns=("f1", "f2")), drawn_designs(picture, options).rows, stars)

        self._saving.keep([Figure("pareto", plot, numbers)])
        self._html.show(box(plot.svg("pareto", PARETO_GESTURES), words))

    def _hint(self, plot: Plot) -> None:
        """Where the selected design lies beyond the chart: a mark at the edge, with its numbers."""
        selected = self._session.selected
        f1, f2 = (
            (None, None) if selected is None else (selected.evaluation.objectives.get(name) for name in ("f1", "f2"))
        )
        if selected is None or f1 is None or f2 is None:
            return
        (x0, x1), (y0, y1) = self.limits
        x, y = _edge(f1, (x0, x1)), _edge(f2, (y0, y1))
        if (x, y) == (f1, f2):
            return
        plot.mark(
            x, y, "diamond", 6.0, "selected", title="the selected design lies beyond the chart; a wheel zooms out"
        )
        left = x > 0.5 * (x0 + x1)
        words = f"{selected.label} beyond: f₁ {f1:.3f}, f₂ {f2:.3f}"
        plot.text(
            x, y, words, "selected", "end" if left else "start", -9 if left else 9, 12 if y > 0.5 * (y0 + y1) else -6
        )

    def _height(self) -> float:
        session = self._session
        # what stands below it is seen without scrolling: a narrow panel breaks the legend and the line above in two
        others = 240.0 if session.narrow and not session.phone else 178.0
        return min(max(0.5 * session.size[1] - others, 166.0 if session.narrow else 190.0), 400.0)

    def _marks(self, picture: RunPicture) -> list[Mark]:
        """Designs of the run that is drawn: the next one may come on display meanwhile, and is then drawn anew."""
        session, selected = self._session, self._session.selected
        marks = [_mark(picture, self._designs.first(), "square", 4.5, "initial", "initial design")]
        for index, item in enumerate(session.pins):
            marks.append(_mark(picture, item, "triangle", 5.5, f"pin{index + 1}", f"pinned: {item.label}"))
        if selected is not None:
            marks.append(_mark(picture, selected, "ring", 8.0, "selected", f"selected: {selected.label}"))
        return [mark for mark in marks if mark is not None]


def nothing_feasible(picture: RunPicture) -> str:
    """Why a run has no front: which constraints its designs break, the most often broken first; "" where it has one."""
    solved = ~picture.failed
    if not bool(solved.any()) or bool(picture.feasible.any()):
        return ""
    broken = [
        (int((values[solved] > FEASIBILITY_TOLERANCE).sum()), item.label)
        for item in CONSTRAINTS
        if (values := picture.column(f"g_{item.name}")) is not None
    ]
    most = ", ".join(f"{label} by {count}" for count, label in sorted(broken, reverse=True)[:2] if count)
    return f"None of {int(solved.sum())} designs keeps all constraints" + (
        f". Broken: {most} of them." if most else "."
    )


def _edge(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])


def _beyond_words(beyond: Beyond) -> Markup:
    said = []
    if beyond.count:
        who = "1 design" if beyond.count == 1 else f"{beyond.count} designs"
        words = f"{who} better than a drawn front (by {100.0 * beyond.most:.2g} % in both at most)"
        said.append(_folded(words, beyond.reasons, beyond.count))
    if beyond.margin[0]:
        said.append(_folded(beyond.margin[0], beyond.margin[1:], 0))
    return joined(said)


def _folded(words: str, reasons: Sequence[str], count: int) -> Markup:
    return fill(
        '<details class="soft" data-beyond="{}"><summary>{}: why?</summary>{}</details>',
        count,
        words,
        joined(fill("<p>{}</p>", reason) for reason in reasons),
    )


def _same(first: tuple[object, ...], second: tuple[object, ...]) -> bool:
    """Whether the very same picture (arrays are not compared) is drawn in the same way."""
    return first[0] is second[0] and first[1:] == second[1:]


def _mark(picture: RunPicture, item: Shown, shape: str, size: float, css: str, title: str) -> Mark | None:
    objectives = item.evaluation.objectives
    f1, f2 = objectives.get("f1"), objectives.get("f2")
    if f1 is None or f2 is None or item.opening != picture.opening:
        return None
    return Mark(float(f1), float(f2), shape, size, css, title)
