"""The generations under the Pareto chart: a slider, steps, play; and what of the run the chart shows."""

from __future__ import annotations

import math
import threading

import viser

from explorer.server.bridge import PageEvent
from explorer.server.html_slot import Slot
from explorer.server.widgets import set_value
from explorer.state.run_picture import GenerationPicture
from explorer.state.session import Session
from explorer.views.chips import GAP, NOTHING, box, chip, chips, soft
from explorer.views.saving import buttons

_STEP_SECONDS = 0.25


class Scrubber:
    """Slider and buttons of one browser."""

    def __init__(self, session: Session, gui: viser.GuiApi) -> None:
        self._session = session
        self._stopped = threading.Event()
        self._slider = gui.add_slider("Generation", 0, 1, 1, 0, disabled=True)
        self._controls = Slot(gui)
        self._words = Slot(gui)
        self._slider.on_update(self._on_slider)
        session.hub.on(
            ("run", "scrub", "filter", "zoom pareto", "layers", "play", "follow"), self.draw, self._words.failed
        )
        for name, action in (
            ("step", self._step),
            ("play", self._play),
            ("follow", self._follow),
            ("follow_best", self._follow_best),
        ):
            session.gestures.on("act", name, action)
        session.on_close(self._stop)
        self.draw()

    def draw(self) -> None:
        """Draw everything again."""
        session, picture = self._session, self._session.picture
        count = len(picture.generations)
        generation = picture.generation_at(session.scrubbed)
        filtered = NOTHING
        if session.filters:
            inside = int(picture.inside(session.filters).sum())
            filtered = chip("unfilter", f"{inside} of {len(picture.ids)} pass ✕", hint="drop all filters", on=True)
        self._controls.show(
            box(
                chips(
                    chip("step", "‹", "-1", disabled=count == 0, hint="previous generation"),
                    chip(
                        "play",
                        "❚❚ pause" if session.playing else "▶ play",
                        disabled=count < 2,
                        hint="play the generations",
                    ),
                    chip("step", "›", "1", disabled=count == 0, hint="next generation"),
                    chip("follow", "newest", on=session.scrubbed is None, hint="follow the run"),
                    chip(
                        "follow_best",
                        "follow best",
                        on=session.follow,
                        hint="the selection goes on to the newest compromise until you select another design",
                    ),
                    GAP,
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
                    else NOTHING,
                )
            )
        )
        save = buttons("pareto") if count else []
        self._words.show(box(chips(soft(_generation_words(generation, count), "span"), GAP, filtered, *save)))
        if not count:
            # of another run, which had some
            set_value(self._slider, 0)
        self._slider.max = max(count, 1)
        self._slider.min = 1 if count else 0
        self._slider.disabled = count < 2
        if session.scrubbed is None and count:
            set_value(self._slider, count)
        elif session.scrubbed is not None and session.playing:
            set_value(self._slider, session.scrubbed)

    def _on_slider(self, event: viser.GuiEvent[viser.GuiSliderHandle[int]]) -> None:
        if event.client_id is None:
            return
        count = len(self._session.picture.generations)
        value = self._slider.value
        if count and isinstance(value, int | float) and math.isfinite(value):
            self._stop()
            self._session.scrub(min(max(int(value), 1), count))

    def _step(self, event: PageEvent) -> None:
        count = len(self._session.picture.generations)
        if not count:
            return
        self._stop()
        now = self._session.scrubbed or count
        target = min(max(now + (1 if event.arg == "1" else -1), 1), count)
        set_value(self._slider, target)
        self._session.scrub(target)

    def _follow(self, _event: PageEvent) -> None:
        self._stop()
        self._session.scrub(None)

    def _follow_best(self, _event: PageEvent) -> None:
        self._session.set_follow(not self._session.follow)

    # ---- play ------------------------------------------------------------------------------------------------------
    def _play(self, _event: PageEvent) -> None:
        if self._session.playing:
            self._stop()
            return
        count = len(self._session.picture.generations)
        if count < 2:
            return
        start = self._session.scrubbed
        if start is None or start >= count:
            start = 1
        # each play has its own flag: one that was stopped a moment ago cannot come back to life with the next
        self._stopped = threading.Event()
        self._session.play(True)
        threading.Thread(target=self._run_play, args=(start, self._stopped), name="play", daemon=True).start()

    def _stop(self) -> None:
        self._stopped.set()
        self._session.play(False)

    def _run_play(self, generation: int, stopped: threading.Event) -> None:
        while not stopped.is_set():
            self._session.scrub(generation)
            if generation >= len(self._session.picture.generations):
                self._session.play(False)
                return
            generation += 1
            stopped.wait(_STEP_SECONDS)


def _generation_words(generation: GenerationPicture | None, count: int) -> str:
    if generation is None:
        return "no generation yet"
    return f"{generation.number} of {count}, level {generation.level}, {len(generation.front)} on the front"
