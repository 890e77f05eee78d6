"""The live Pareto chart with its generation scrubber."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping

import viser

from explorer.charts.pareto import (
    ParetoMark,
    ParetoOptions,
    automatic_limits,
    front_order,
    pareto_background,
    pareto_chart,
    pick,
)
from explorer.charts.plot import Plot, legend
from explorer.server.bridge import PageEvent, tooltip
from explorer.state.run_picture import GenerationPicture
from explorer.state.session import Session
from explorer.views.chips import box, chip, chips
from explorer.views.slot import Slot
from explorer.views.tables import design_card
from hpsop_core.quantities import objective_title

_FRAME = (68.0, 42.0)  # px of the margins, both sides together
_STEP_SECONDS = 0.25


class ParetoView:
    """Chart, legend, scrubber and play of one browser."""

    def __init__(self, session: Session, gui: viser.GuiApi) -> None:
        self._session = session
        self._serial = 0
        self._drawn_limits = ((0.0, 1.0), (0.0, 1.0))
        self._panned: tuple[float, tuple[tuple[float, float], tuple[float, float]]] | None = None
        self._background: tuple[tuple[object, ...], Plot] | None = None
        self._playing = threading.Event()
        self._hovered: tuple[int, ...] = ()
        self._chart = gui.add_html("")
        self._slider = gui.add_slider("Generation", 0, 1, 1, 0, disabled=True)
        self._controls = Slot(gui)
        self._words = Slot(gui)
        self._tip = gui.add_html("")
        self._slider.on_update(self._on_slider)
        session.hub.on(("run", "scrub", "filter", "pins", "selection", "zoom pareto", "size", "pareto"), self.draw)
        for kind, handler in (
            ("click", self._click),
            ("hover", self._hover),
            ("zoom", self._zoom),
            ("pan", self._pan),
            ("box", self._box),
            ("reset", self._reset),
        ):
            session.handle(kind, "pareto", handler)
        session.handle("key", "", self._key)
        for name, action in (
            ("step", self._step),
            ("play", self._play),
            ("follow", self._follow),
            ("layer", self._layer),
            ("unfilter", self._unfilter),
            ("unzoom", self._reset),
        ):
            session.handle("act", name, action)
        session.on_close(self._playing.clear)
        self.draw()

    def _height(self) -> float:
        return min(max(0.5 * self._session.size[1] - 178.0, 190.0), 400.0)

    def _options(self) -> ParetoOptions:
        session = self._session
        return ParetoOptions(
            session.scrubbed, session.archive, session.infeasible, dict(session.filters), session.limits.get("pareto")
        )

    def _marks(self) -> list[ParetoMark]:
        session = self._session
        marks = []
        initial = session.app.initial_shown(session.picture.current_level)
        if initial is not None:
            marks.append(_mark(initial.evaluation.objectives, "square", 4.5, "initial", "initial design"))
        for index, item in enumerate(session.pins):
            marks.append(_mark(item.evaluation.objectives, "triangle", 5.5, f"pin{index + 1}", f"pinned: {item.label}"))
        if session.selected is not None:
            marks.append(
                _mark(
                    session.selected.evaluation.objectives,
                    "ring",
                    8.0,
                    "selected",
                    f"selected: {session.selected.label}",
                )
            )
        return [mark for mark in marks if mark is not None]

    def draw(self) -> None:
        """Draw everything again."""
        session, picture, options = self._session, self._session.picture, self._options()
        self._drawn_limits = options.limits or automatic_limits(picture, options)
        objectives = picture.case.objectives
        titles = (objective_title(objectives.first, "f₁"), objective_title(objectives.second, "f₂"))
        # a selection moves a ring; thousands of archive points under it need not be written anew
        key = (picture, options, titles, session.chart_width, self._height())
        if self._background is None or not _same(self._background[0], key):
            self._background = (key, pareto_background(picture, options, titles, session.chart_width, self._height()))
        svg = pareto_chart(picture, self._background[1], self._marks())
        keys = [("circle", "level1", "level 1 front")]
        if picture.last_of_level(2) is not None:
            keys.append(("circle", "level2", "level 2 front"))
        if session.archive:
            keys.append(("circle", "archive", "archive"))
        if session.infeasible:
            keys.append(("circle", "infeasible", "infeasible"))
        keys.append(("square", "initial", "initial"))
        if picture.compromise is not None:
            keys += [("star", "compromise", "compromise"), ("diamond", "knee", "knee")]
        if bool(picture.by_hand.any()):
            keys.append(("square", "hand", "by hand"))
        if session.pins:
            keys.append(("triangle", "pin1", "pinned"))
        self._chart.content = box(svg + legend(keys))
        count = len(picture.generations)
        generation = picture.generation_at(session.scrubbed)
        filtered = ""
        if session.filters:
            inside = int(picture.inside(session.filters).sum())
            filtered = chip("unfilter", f"{inside} of {len(picture.ids)} pass ✕", hint="drop all filters", on=True)
        self._controls.show(
            box(
                chips(
                    chip("step", "‹", "-1", disabled=count == 0, hint="previous generation"),
                    chip(
                        "play",
                        "❚❚ pause" if self._playing.is_set() else "▶ play",
                        disabled=count < 2,
                        hint="play the generations",
                    ),
                    chip("step", "›", "1", disabled=count == 0, hint="next generation"),
                    chip("follow", "newest", on=session.scrubbed is None, hint="follow the run"),
                    '<span class="gap"></span>',
                    chip("layer", "archive", "archive", on=session.archive, hint="every feasible design evaluated"),
                    chip(
                        "layer",
                        "infeasible",
                        "infeasible",
                        on=session.infeasible,
                        hint="designs that break a constraint",
                    ),
                    chip("unzoom", "all", hint="show the whole chart (double click)")
                    if "pareto" in session.limits
                    else "",
                )
            )
        )
        self._words.show(
            box(
                chips(
                    f'<span class="soft">{_generation_words(generation, count)}</span><span class="gap"></span>',
                    filtered,
                )
            )
        )
        self._slider.max = max(count, 1)
        self._slider.min = 1 if count else 0
        self._slider.disabled = count < 2
        if session.scrubbed is None and self._slider.value != count and count:
            self._slider.value = count
        elif session.scrubbed is not None and self._playing.is_set():
            self._slider.value = session.scrubbed

    # ---- gestures --------------------------------------------------------------------------------------------------
    def _candidates(self, event: PageEvent) -> list[int]:
        x, y = event.numbers.get("x"), event.numbers.get("y")
        if x is None or y is None:
            return []
        size = (self._session.chart_width - _FRAME[0], self._height() - _FRAME[1])
        return pick(self._session.picture, self._options(), x, y, self._drawn_limits, size)

    def _click(self, event: PageEvent) -> None:
        found = self._candidates(event)
        if not found:
            self._click_initial(event)
            return
        selected = self._session.selected
        design_id = found[0]
        # A second click on the same spot goes on to the next of the designs that coincide there.
        if selected is not None and selected.design_id in found:
            design_id = found[(found.index(selected.design_id) + 1) % len(found)]
        self._session.select_id(design_id)

    def _click_initial(self, event: PageEvent) -> None:
        x, y = event.numbers.get("x"), event.numbers.get("y")
        if x is None or y is None:
            return
        (x0, x1), (y0, y1) = self._drawn_limits
        width, height = self._session.chart_width - _FRAME[0], self._height() - _FRAME[1]
        initial = self._session.app.initial_shown(self._session.picture.current_level)
        if initial is None:
            return
        f1, f2 = initial.evaluation.objectives["f1"], initial.evaluation.objectives["f2"]
        if (
            f1 is not None
            and f2 is not None
            and math.hypot((f1 - x) / (x1 - x0) * width, (f2 - y) / (y1 - y0) * height) < 14.0
        ):
            self._session.select(initial)

    def _hover(self, event: PageEvent) -> None:
        found = self._candidates(event)
        if tuple(found) == self._hovered and found:
            return
        self._hovered = tuple(found)
        self._serial += 1
        shown = self._session.app.shown(found[0]) if found else None
        if shown is None:
            self._tip.content = tooltip("pareto", "", self._serial)
            return
        more = (
            f"<p class='soft'>{len(found)} designs coincide here: click again for the next.</p>"
            if len(found) > 1
            else ""
        )
        self._tip.content = tooltip("pareto", design_card(shown) + more, self._serial)

    def _zoom(self, event: PageEvent) -> None:
        fx, fy, factor = (event.numbers.get(name) for name in ("fx", "fy", "factor"))
        if fx is None or fy is None or factor is None or not 0.2 < factor < 5.0:
            return
        # what stays in place is a fraction of the plot: several turns of the wheel may come before it is redrawn
        (x0, x1), (y0, y1) = self._drawn_limits
        x, y = x0 + fx * (x1 - x0), y0 + fy * (y1 - y0)
        limits = ((x + (x0 - x) * factor, x + (x1 - x) * factor), (y + (y0 - y) * factor, y + (y1 - y) * factor))
        if all(1e-6 < high - low < 1e3 for low, high in limits):
            self._drawn_limits = limits
            self._session.zoom("pareto", limits)

    def _pan(self, event: PageEvent) -> None:
        fx, fy, drag = (event.numbers.get(name) for name in ("fx", "fy", "drag"))
        if fx is None or fy is None or drag is None or not max(abs(fx), abs(fy)) < 100.0:
            return
        if self._panned is None or self._panned[0] != drag:
            self._panned = (drag, self._drawn_limits)
        (x0, x1), (y0, y1) = self._panned[1]
        dx, dy = fx * (x1 - x0), fy * (y1 - y0)
        self._session.zoom("pareto", ((x0 - dx, x1 - dx), (y0 - dy, y1 - dy)))

    def _box(self, event: PageEvent) -> None:
        numbers = [event.numbers.get(name) for name in ("x0", "x1", "y0", "y1")]
        if any(value is None for value in numbers):
            return
        x0, x1, y0, y1 = (float(value) for value in numbers if value is not None)
        self._session.filter({"f1": (min(x0, x1), max(x0, x1)), "f2": (min(y0, y1), max(y0, y1))})

    def _reset(self, _event: PageEvent) -> None:
        self._session.zoom("pareto", None)

    def _unfilter(self, _event: PageEvent) -> None:
        self._session.clear_filters()

    def _layer(self, event: PageEvent) -> None:
        if event.arg == "archive":
            self._session.archive = not self._session.archive
        elif event.arg == "infeasible":
            self._session.infeasible = not self._session.infeasible
        self._session.hub.changed("pareto")

    def _key(self, event: PageEvent) -> None:
        session = self._session
        if event.key == "Escape":
            session.clear_filters()
            session.zoom("pareto", None)
            return
        order = front_order(session.picture, session.scrubbed)
        if not order:
            return
        now = session.selected.design_id if session.selected is not None else None
        if event.key == "Home":
            target = 0
        elif event.key == "End":
            target = len(order) - 1
        else:
            step = 1 if event.key in ("ArrowRight", "]") else -1
            target = order.index(now) + step if now in order else (0 if step > 0 else len(order) - 1)
        session.select_id(order[min(max(target, 0), len(order) - 1)])

    # ---- generations -----------------------------------------------------------------------------------------------
    def _on_slider(self, event: viser.GuiEvent[viser.GuiSliderHandle[int]]) -> None:
        if event.client_id is None:
            return
        count = len(self._session.picture.generations)
        value = self._slider.value
        if count and isinstance(value, int | float) and math.isfinite(value):
            self._playing.clear()
            generation = min(max(int(value), 1), count)
            self._session.scrub(generation)

    def _step(self, event: PageEvent) -> None:
        count = len(self._session.picture.generations)
        if not count:
            return
        self._playing.clear()
        now = self._session.scrubbed or count
        target = min(max(now + (1 if event.arg == "1" else -1), 1), count)
        self._slider.value = target
        self._session.scrub(target)

    def _follow(self, _event: PageEvent) -> None:
        self._playing.clear()
        self._session.scrub(None)

    def _play(self, _event: PageEvent) -> None:
        if self._playing.is_set():
            self._playing.clear()
            self._session.hub.changed("pareto")
            return
        count = len(self._session.picture.generations)
        if count < 2:
            return
        start = self._session.scrubbed
        if start is None or start >= count:
            start = 1
        self._playing.set()
        threading.Thread(target=self._run_play, args=(start,), name="play", daemon=True).start()

    def _run_play(self, generation: int) -> None:
        while self._playing.is_set():
            count = len(self._session.picture.generations)
            self._session.scrub(generation)
            if generation >= count:
                break
            generation += 1
            # Event.wait would return at once while it is set; a plain pause is meant here.
            threading.Event().wait(_STEP_SECONDS)
        self._playing.clear()
        self._session.hub.changed("pareto")


def _same(first: tuple[object, ...], second: tuple[object, ...]) -> bool:
    """Whether the very same picture (arrays are not compared) is drawn in the same way."""
    return first[0] is second[0] and first[1:] == second[1:]


def _generation_words(generation: GenerationPicture | None, count: int) -> str:
    if generation is None:
        return "no generation yet"
    return f"{generation.number} of {count}, level {generation.level}, {len(generation.front)} on the front"


def _mark(objectives: Mapping[str, float | None], shape: str, size: float, css: str, title: str) -> ParetoMark | None:
    f1, f2 = objectives.get("f1"), objectives.get("f2")
    if f1 is None or f2 is None:
        return None
    return ParetoMark(float(f1), float(f2), shape, size, css, title)
