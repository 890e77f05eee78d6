"""What-if: the selection's variables as sliders, level 1 answering live."""

from __future__ import annotations

import math
import time
from typing import Any

import viser

from explorer.server.html_slot import Slot
from explorer.server.widgets import set_value
from explorer.services.services import Services
from explorer.state.history import History
from explorer.state.session import Session
from explorer.state.shown import Shown
from explorer.views.chips import NOTHING, box, chip, chips, soft
from explorer.views.on_display import select_design
from explorer.views.settings_fields import shown_decimals, standing_hint, standing_label
from explorer.views.tables import headline, warnings_html
from hpsop_core.case.declared_variable import Variable
from hpsop_core.case.variables import SEARCH_TABLE, VARIABLE_NAMES, DesignVariables
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import conditions_of, number_text, quantity_of, size_of_case

_LEVEL2 = "Evaluate at level 2"
_UNDO, _REDO = "the design before (Ctrl+Z)", "take undo back (Ctrl+Shift+Z)"


class WhatIfView:
    """Sliders that follow the selection until they are moved, and then lead it."""

    def __init__(self, session: Session, services: Services, gui: viser.GuiApi) -> None:
        self._session = session
        self._designs, self._runs = services.designs, services.runs
        self._answered: list[float] = []
        self._own: Shown | None = None
        self._history: History[Shown] = History()
        self._html = Slot(gui)
        self._steps = Slot(gui)
        # by the variables that name a design: a stand-in takes over what belongs to the one in whose place it is
        self._sliders: dict[str, Any] = {}
        # what a slider was put at to show a design, in digits that can be read, and the design's own number
        self._exact: dict[str, tuple[float, float]] = {}
        self._space = session.picture.case.bounds
        self._initial = session.picture.case.initial.variables
        for place, (key, value) in zip(VARIABLE_NAMES, self._space.values(self._initial).items(), strict=True):
            variable = SEARCH_TABLE[key]
            low, high, step = _track(variable, value)
            label, hint = standing_label(variable, None), standing_hint(variable, None)
            slider = gui.add_slider(label, low, high, step, variable.typed(variable.shown(value)), hint=hint)
            slider.on_update(self._moved)
            self._sliders[place] = slider
        self._level2 = gui.add_button(_LEVEL2, hint="Rankine panels and blade panels, about a second")
        self._add = gui.add_button("Add to the run's archive as a hand-made design", color="gray")
        self._level2.on_click(self._on_level2)
        self._add.on_click(self._on_add)
        session.gestures.on("act", "whatif_turn", lambda event: self._turn(event.arg == "back"))
        session.hub.on(("selection",), self._follow, self._html.failed)
        session.hub.on(("selection", "run"), self._show_buttons)
        session.hub.on(("left",), self._history.clear)
        self._follow()
        self._show_buttons()

    def _variables(self) -> DesignVariables:
        values: list[float] = []
        for key, (place, slider) in zip(self._space.names, self._sliders.items(), strict=True):
            value = slider.value
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise InputError(f"what-if: {key} is not a finite number; move its slider")
            # A browser may send anything; the slider's own range is the limit.
            clamped = min(max(value, slider.min), slider.max)
            displayed, exact = self._exact.get(place, (math.nan, math.nan))
            # a design does not change by being shown
            variable = SEARCH_TABLE[key]
            values.append(variable.typed(exact if clamped == displayed else variable.from_shown(clamped)))
        return DesignVariables.from_dict(self._space.design(values).as_dict(), "what-if")

    def _reach(self) -> None:
        """What the sliders move, their ends and steps, for the run on display."""
        case = self._session.picture.case
        same = (case.initial.variables, case.bounds.names) == (self._initial, self._space.names)
        self._space, self._initial = case.bounds, case.initial.variables
        if same:
            return
        for slider, (key, value) in zip(self._sliders.values(), self._space.values(self._initial).items(), strict=True):
            variable = SEARCH_TABLE[key]
            slider.min, slider.max, slider.step = _track(variable, value)
            slider.precision = shown_decimals(variable, value)

    def _follow(self) -> None:
        shown = self._session.selected
        if shown is None:
            return
        # the sliders' own answer must not move them: they may be further on already
        if shown is not self._own:
            self._reach()
            values = self._space.values(shown.evaluation.variables)
            initial = self._space.values(self._initial)
            for (place, slider), (key, number) in zip(self._sliders.items(), values.items(), strict=True):
                variable = SEARCH_TABLE[key]
                value = variable.typed(round(variable.shown(number), shown_decimals(variable, initial[key])))
                self._exact[place] = (value, number)
                if value < slider.min:
                    slider.min = value
                if value > slider.max:
                    slider.max = value
                set_value(slider, value)
        self._mark_bounds(shown)
        self._draw(shown)

    def _mark_bounds(self, shown: Shown) -> None:
        """An arrow at every slider whose variable stands on a bound of the case, and words under the pointer."""
        for key, slider in zip(self._space.names, self._sliders.values(), strict=True):
            variable, side = SEARCH_TABLE[key], shown.evaluation.active_bounds.get(key)
            label = standing_label(variable, side)
            if slider.label != label:
                slider.label, slider.hint = label, standing_hint(variable, side)

    def _draw(self, shown: Shown) -> None:
        history = self._history
        self._steps.show(
            box(
                chips(
                    chip(
                        "whatif_turn",
                        "↶ undo",
                        "back",
                        disabled=not history.can_undo,
                        hint=_UNDO,
                    ),
                    chip(
                        "whatif_turn",
                        "↷ redo",
                        "again",
                        disabled=not history.can_redo,
                        hint=_REDO,
                    ),
                )
            )
        )
        if shown.kind != "whatif":
            self._html.show(
                _answer(
                    fill("<p>{}</p>", headline(shown)),
                    soft(
                        "Move a slider: level 1 answers at once, and the hull, the propeller, the curves and the table "
                        "follow."
                    ),
                )
            )
            return
        evaluation, size = shown.evaluation, size_of_case(self._session.picture.case)
        numbers = (
            ("f₁", number_text(evaluation.objectives.get("f1"), 4)),
            ("f₂", number_text(evaluation.objectives.get("f2"), 4)),
            *(
                (
                    f"at {name}: Rt, PD",
                    f"{quantity_of(evaluation, f'total_resistance_{number}', size)}, "
                    f"{quantity_of(evaluation, f'delivered_power_{number}', size)}",
                )
                for number, name in enumerate(conditions_of(evaluation), 1)
            ),
        )
        facts = joined(fill("<span>{}</span><span>{}</span>", name, text) for name, text in numbers)
        recent = [moment for moment in self._answered if moment > time.monotonic() - 2.0]
        rate = soft(f"{len(recent) / 2.0:.0f} answers a second") if len(recent) > 4 else NOTHING
        self._html.show(
            _answer(
                fill("<p>{}</p>", headline(shown)),
                fill("<div class='facts'>{}</div>", facts),
                rate,
                warnings_html(shown),
            )
        )

    def _moved(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is not None:
            self._session.worker.latest("what-if", self._answer, first=True)

    def _answer(self, level: int = 1) -> None:
        try:
            variables = self._variables()
            shown = self._designs.whatif(variables, level)
            # level 2 takes a second; what the sliders said meanwhile has been answered since
            if level == 2 and self._variables() != variables:
                return
        except HpsopError as error:
            self._session.notify("What-if", str(error), "yellow")
            return
        self._answered = [*self._answered[-40:], time.monotonic()]
        before = self._session.selected
        if before is not None and before.key != shown.key:
            values, old = shown.evaluation.variables.as_dict(), before.evaluation.variables.as_dict()
            self._history.record(before, frozenset(name for name in values if values[name] != old[name]))
        self._own = shown
        self._session.select(shown)

    def _turn(self, back: bool) -> None:
        """The design before the last move of a slider, or the one that was left by that."""
        present = self._session.selected
        if present is None:
            return
        found = self._history.undo(present) if back else self._history.redo(present)
        if found is not None:
            # the sliders follow it, as they follow any selection
            self._own = None
            self._session.select(found)

    def _on_level2(self, _event: viser.GuiEvent[Any]) -> None:
        def work() -> None:
            self._level2.disabled, self._level2.label = True, "Evaluating at level 2 …"
            try:
                self._answer(2)
            finally:
                self._level2.disabled, self._level2.label = False, _LEVEL2

        self._session.heavy.latest("what-if level 2", work)

    def _on_add(self, _event: viser.GuiEvent[Any]) -> None:
        session, shown = self._session, self._session.selected
        if shown is None or shown.kind != "whatif":
            session.notify("Not added", "Move a slider first: only a design of your own making is added.", "yellow")
            return

        def work() -> None:
            try:
                design_id = self._runs.add_by_hand(shown.evaluation)
            except HpsopError as error:
                session.notify("Not added", str(error), "yellow")
                return
            session.notify("Added", f"Design {design_id} stands in the archive, marked as made by hand.", "green")
            select_design(session, self._designs, design_id)

        session.worker.every(work)

    def _show_buttons(self) -> None:
        shown = self._session.selected
        own = shown is not None and shown.kind == "whatif" and shown.evaluation.ok
        disabled = not (own and self._runs.can_add_by_hand())
        if self._add.disabled != disabled:
            self._add.disabled = disabled


def _track(variable: Variable, value: float) -> tuple[float, float, float]:
    """Ends and step of a slider around an initial design's value, as shown numbers."""
    low, high = variable.reach_near(value)
    low, high, step = (round(variable.shown(number), 12) for number in (low, high, variable.step_near(value)))
    return variable.typed(low), variable.typed(high), variable.typed(step)


def _answer(*parts: Markup) -> Markup:
    """What stays in sight while the sliders below are scrolled, and never takes their place."""
    return fill(
        '<div class="hp answer" tabindex="0" role="region" aria-label="the what-if\'s answer">{}</div>', joined(parts)
    )
