"""Run control and progress: shared by all browsers."""

from __future__ import annotations

import viser

from explorer.server.html_slot import Slot
from explorer.server.widgets import set_value
from explorer.services.runs import Runs
from explorer.state.app_state import AppState
from explorer.state.run_picture import ACTIVE, FAILED, FINISHED, IDLE, PAUSED, RUNNING, STARTING, STOPPED, STOPPING
from explorer.views.chips import NOTHING, box, chip, chips, soft
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import number_text

_WORDS = {
    IDLE: "Ready",
    STARTING: "Starting …",
    RUNNING: "Running",
    PAUSED: "Paused",
    STOPPING: "Stopping …",
    STOPPED: "Stopped",
    FINISHED: "Finished",
    FAILED: "Failed",
}


_EXTENSIONS = (10, 25, 100)


class RunView:
    """Status, buttons, progress bar and figures."""

    def __init__(self, app: AppState, runs: Runs, gui: viser.GuiApi) -> None:
        self._app = app
        self._runs = runs
        self._status = Slot(gui)
        self._buttons = Slot(gui)
        self._facts_slot = Slot(gui)
        self._bar = gui.add_progress_bar(0.0)
        app.hub.on(("run", "people", "library"), self.draw, self._facts_slot.failed)
        self.draw()

    def draw(self) -> None:
        """Draw everything again."""
        picture, runs = self._app.picture, self._runs
        status = picture.status
        driven = picture.live
        active = status in ACTIVE and driven
        numbers = sorted(session.number for session in list(self._app.sessions.values()) if session.number)
        people = NOTHING
        if len(numbers) > 1:
            names = joined((fill('<span data-person="{0}">browser {0}</span>', number) for number in numbers), ", ")
            people = soft(fill("{} watching: {}", len(numbers), names))
        word = _WORDS.get(status, status)
        if status in ACTIVE and not driven:
            word = "Running elsewhere" if status != PAUSED else "Paused elsewhere"
        buttons = [chip("run_start", "▶ Start", css="big primary", hint="start a new run of the case as set up")]
        if active:
            buttons = [
                chip("run_resume", "▶ Resume", css="big primary")
                if status == PAUSED
                else chip("run_pause", "❚❚ Pause", css="big", disabled=status != RUNNING),
                chip("run_stop", "■ Stop", css="big danger", disabled=status == STOPPING),
            ]
        elif picture.name and runs.can_continue():
            buttons.append(chip("run_continue", "▶▶ Continue", css="big", hint="go on with this run"))
        more = NOTHING
        if picture.name and runs.can_extend():
            more = chips(
                soft("extend by", "span"),
                *(
                    chip("run_extend", f"+{count}", str(count), hint=f"{count} more generations")
                    for count in _EXTENSIONS
                ),
            )
        message = NOTHING
        if picture.message:
            message = fill('<p class="{}">{}</p>', "bad" if status == FAILED else "soft", picture.message)
        label = runs.label()
        if self._app.coming not in ("", picture.name):
            message = fill('<p class="soft" role="status">opening {} …</p>', _short(self._app.coming))
        name = fill(
            '<span class="soft" title="{}">{}</span>',
            f"{picture.name} {label.note}".strip(),
            label.name or _short(picture.name),
        )
        self._status.show(
            box(
                fill(
                    '<div class="status" data-run-name="{file}" data-run-title="{title}" data-run-status="{status}" '
                    'data-generation="{count}">'
                    '<b class="state-{status}">{word}</b> {name}<span class="gap"></span></div>',
                    file=picture.name,
                    title=label.name,
                    status=status,
                    count=len(picture.generations),
                    word=word,
                    name=name,
                )
            )
        )
        self._buttons.show(box(chips(*buttons), more))
        doings = soft(self._app.doings) if self._app.doings and people else NOTHING
        self._facts_slot.show(box(message, self._facts(), people, doings))
        total = max(picture.total_generations, 1)
        set_value(self._bar, min(100.0, 100.0 * (len(picture.generations) + runs.part_of_generation()) / total))
        self._bar.visible = bool(picture.generations) or active

    def _facts(self) -> Markup:
        picture = self._app.picture
        if not picture.generations and picture.status == IDLE:
            return soft("Set bounds below and press Start.")
        newest = picture.generations[-1] if picture.generations else None
        level = newest.level if newest else 1
        predicted = f", {number_text(picture.predictions, 0)} predicted" if picture.predictions else ""
        facts = [
            ("generation", f"{len(picture.generations)} of {picture.total_generations}, level {level}"),
            ("evaluations", f"{number_text(len(picture.ids), 0)}{predicted}, {int(picture.failed.sum())} failed"),
            ("hypervolume", number_text(newest.hypervolume, 5) if newest else "–"),
        ]
        if picture.status in ACTIVE and picture.seconds_left is not None:
            facts.append(("time left", _duration(picture.seconds_left)))
        elif picture.elapsed > 0.0:
            facts.append(("time used", _duration(picture.elapsed)))
        rows = (fill('<span class="soft">{}</span><span>{}</span>', name, value) for name, value in facts)
        return fill('<div class="facts">{}</div>', joined(rows))


def _short(name: str) -> str:
    return name if len(name) <= 34 else name[:20] + "…" + name[-13:]


def _duration(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    if seconds < 5400.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
