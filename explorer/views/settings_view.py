"""The design space and the case's settings: shared by all browsers, checked in Python whatever a browser sends."""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import threading
from collections.abc import Callable
from typing import Any

import viser

from explorer.server.html_slot import Slot
from explorer.server.widgets import set_value
from explorer.services.runs import Runs
from explorer.state.app_state import AppState
from explorer.state.draft import Draft, numbers_from_text
from explorer.state.run_picture import ACTIVE
from explorer.views.chips import NOTHING, box, chip, chips, soft
from explorer.views.settings_fields import (
    CASE_FIELDS,
    OPEN_FOLDERS,
    SEARCH_FIELDS,
    STEPS,
    in_words,
    slider_decimals,
    variable_label,
)
from hpsop_core.case.case import SHIPPED_CASES, load_case
from hpsop_core.case.fields import checked_value, rules
from hpsop_core.case.variables import ON_BOUND, SEARCH_TABLE, STANDS_FOR, VARIABLE_NAMES, interchangeable, value_of
from hpsop_core.errors import InputError
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import Quantity, variable_quantity

# A field is typed digit by digit; what cannot be taken is refused when the typing has rested so long.
_TYPING_SECONDS = 1.5


class SettingsView:
    """Presets, range sliders and fields of the case being set up."""

    def __init__(
        self,
        app: AppState,
        runs: Runs,
        gui: viser.GuiApi,
        space: Any,
        case: Any,
        save: Callable[[viser.GuiEvent[Any]], None],
    ) -> None:
        self._app = app
        self._runs = runs
        self._gui = gui
        self._typing: dict[tuple[str, str], int] = {}
        self._serial = itertools.count(1)
        # by the variables that name a design: a stand-in takes over what belongs to the one in whose place it is
        self._readouts: dict[str, Slot] = {}
        self._sliders: dict[str, Any] = {}
        self._ends_for: dict[str, tuple[str, float]] = {}
        self._widgets: dict[tuple[str, str], Any] = {}
        self._labels: dict[tuple[str, str], str] = {}
        with space:
            self._preset = gui.add_dropdown("Case", self._preset_names(), initial_value=app.draft.base.name)
            self._about = Slot(gui)
            for section, name, label in SEARCH_FIELDS:
                self.add_field(section, name, label)
            self._workers = gui.add_number(
                "Workers",
                runs.workers,
                min=1,
                max=64,
                step=1,
                hint="processes of a run; the result is the same",
            )
            for place in VARIABLE_NAMES:
                self._add_slider(place)
            # below the sliders, which must not move away from under the mouse at the first drag
            self._changed = Slot(gui)
            self._around = gui.add_button(
                "Bounds around the initial design",
                color="gray",
                hint="free variables get usual bounds around the initial design's values, fixed ones its values",
            )
            self._reset = gui.add_button("Reset changes to the preset", color="gray")
        with case:
            self._trouble = Slot(gui)
            for title, fields in CASE_FIELDS:
                with gui.add_folder(title, expand_by_default=title in OPEN_FOLDERS):
                    for section, name, label in fields:
                        self.add_field(section, name, label)
            self._save = gui.add_button("Save this case as TOML")
        self._workers.on_update(self._on_workers)
        self._preset.on_update(self._on_preset)
        self._around.on_click(self._on_around)
        self._reset.on_click(self._on_reset)
        self._save.on_click(save)
        app.hub.on(("draft", "run"), self.draw, self._about.failed)
        app.hub.on(("settings",), self.show_all, self._about.failed)
        self.draw()

    def hints(self) -> Markup:
        """The hints by label, for the page to tell them over the labels too; to stand outside the tabs."""
        widgets = (*self._sliders.values(), *self._widgets.values(), self._workers)
        return fill(
            '<div hidden data-hints="{}"></div>', json.dumps({item.label: item.hint for item in widgets if item.hint})
        )

    def _preset_names(self) -> list[str]:
        names = list(SHIPPED_CASES)
        return names if self._app.draft.base.name in names else [self._app.draft.base.name, *names]

    # ---- bounds ----------------------------------------------------------------------------------------------------
    def _key(self, place: str) -> str:
        """The variable that a slider bounds."""
        return self._app.draft.searched()[VARIABLE_NAMES.index(place)]

    def _initial_value(self, key: str) -> float:
        initial = self._app.draft.initial()
        return float(value_of(key, initial, initial))

    def _add_slider(self, place: str) -> None:
        key = self._key(place)
        variable, value = SEARCH_TABLE[key], self._initial_value(key)
        low, high = (variable.typed(bound) for bound in self._app.draft.value("bounds", key))
        least, most = (variable.typed(end) for end in variable.reach_near(value))
        slider = self._gui.add_multi_slider(
            variable_label(variable),
            min(least, low),
            max(most, high),
            variable.typed(variable.step_near(value)),
            (low, high),
            hint=variable.rule.meaning,
            marks=(),
        )
        self._sliders[place], self._readouts[place] = slider, Slot(self._gui)
        self._ends_for[place] = key, value

        def update(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:
                self._on_bounds(place, event)

        slider.on_update(update)

    def _follow_initial(self) -> None:
        """Ends and steps of the sliders for the initial design; they stay while only bounds change under the mouse."""
        for place, slider in self._sliders.items():
            key = self._key(place)
            value = self._initial_value(key)
            if (key, value) == self._ends_for[place]:
                continue
            variable = SEARCH_TABLE[key]
            if key != self._ends_for[place][0]:
                slider.label, slider.hint = variable_label(variable), variable.rule.meaning
            self._ends_for[place] = key, value
            slider.min, slider.max = (variable.typed(end) for end in variable.reach_near(value))
            slider.step = variable.typed(variable.step_near(value))
            slider.precision = slider_decimals(variable, value)
            self._show_bounds(place)

    def _on_bounds(self, place: str, event: viser.GuiEvent[Any]) -> None:
        try:
            self.set_bounds(self._key(place), event.target.value)
        except InputError as error:
            self._app.refuse(event.client_id or 0, in_words(str(error)))
            self._show_bounds(place)

    def _show_bounds(self, place: str) -> None:
        key, slider = self._key(place), self._sliders[place]
        low, high = self._app.draft.value("bounds", key)
        slider.min, slider.max = min(slider.min, low), max(slider.max, high)
        set_value(slider, (self._typed(key, low), self._typed(key, high)))

    def set_bounds(self, key: str, value: Any) -> None:
        """New bounds of a variable from anything a browser may send.

        Raises:
            InputError: not two finite numbers within the slider, or reversed.
        """
        slider, rule = self._sliders[STANDS_FOR.get(key, key)], SEARCH_TABLE[key].rule
        if (
            not isinstance(value, list | tuple)
            or len(value) != 2
            or not all(
                isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item) for item in value
            )
        ):
            raise InputError(f"bounds: {key} needs two finite numbers; drag the slider's thumbs")
        # a browser's slider counts in steps from its end: 6.8500000000000005
        low, high = (round(float(item), 10) for item in value)
        if low > high:
            raise InputError(f"bounds: {key} has reversed bounds {low:g} > {high:g}; give the smaller one first")
        if low < slider.min - 1e-9 or high > slider.max + 1e-9:
            raise InputError(f"bounds: {key} must stay within {slider.min:g} to {slider.max:g}")
        if rule.kind == "integer" and (low != round(low) or high != round(high)):
            raise InputError(f"bounds: {key} must be whole numbers")
        self._app.change_draft(lambda draft: draft.set("bounds", key, (low, high)))

    @staticmethod
    def _typed(key: str, value: float) -> float | int:
        return SEARCH_TABLE[key].typed(value)

    # ---- fields ----------------------------------------------------------------------------------------------------
    def add_field(self, section: str, name: str, label: str) -> None:
        """A widget for one field of the case, as its rule asks."""
        rule = rules(type(getattr(self._app.draft.base, section)))[name]
        value = self._app.draft.value(section, name)
        hint = rule.meaning + (f" [{rule.unit}]" if rule.unit else "")
        widget: Any
        if rule.kind == "choice":
            widget = self._gui.add_dropdown(label, list(rule.choices), initial_value=value, hint=hint)
        elif rule.kind == "numbers":
            widget = self._gui.add_text(label, _list_text(value), hint=hint)
        elif rule.kind == "flag":
            widget = self._gui.add_checkbox(label, value, hint=hint)
        elif rule.optional:
            widget = self._gui.add_text(label, _optional_text(value), hint=f"{hint}; empty: not stated")
        elif rule.kind == "integer":
            widget = self._gui.add_number(label, value, min=int(rule.lower), max=int(rule.upper), step=1, hint=hint)
        else:
            step = STEPS.get(name, 0.001)
            widget = self._gui.add_number(label, value, min=rule.lower, max=rule.upper, step=step, hint=hint)
        self._widgets[(section, name)] = widget
        self._labels[(section, name)] = label

        def update(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is None:
                return
            self._on_field(section, name, event.target.value, event.client_id)

        widget.on_update(update)

    def _on_field(self, section: str, name: str, value: Any, client_id: int) -> None:
        serial = self._typing[(section, name)] = next(self._serial)
        try:
            self.set_field(section, name, value)
        except InputError as error:
            # "1" on the way to "120" is no mistake yet; until the typing rests, Start is refused with this reason.
            why = str(error)
            self._app.change_draft(lambda draft: draft.hold(section, name, why))
            timer = threading.Timer(_TYPING_SECONDS, self._rested, (section, name, serial, why, client_id))
            timer.daemon = True
            timer.start()

    def _rested(self, section: str, name: str, serial: int, why: str, client_id: int) -> None:
        if self._typing.get((section, name)) != serial:
            return
        # taken back before it is told: who reads the words sees the field as it is
        self._show_field(section, name)
        self._app.refuse(client_id, in_words(why))
        self._app.change_draft(lambda draft: draft.release(section, name))

    def set_field(self, section: str, name: str, value: Any) -> None:
        """A new value of a field from anything a browser may send.

        Raises:
            InputError: the field refuses the value.
        """
        rule = rules(type(getattr(self._app.draft.base, section)))[name]
        if rule.kind == "numbers":
            if not isinstance(value, str):
                raise InputError(f"{section}: {name}: write numbers separated by commas")
            value = numbers_from_text(value, f"{section}: {name}")
            # two lists that belong together are changed one after the other: the whole is judged at Start
            self._app.change_draft(lambda draft: draft.set(section, name, value))
        else:
            given = _optional_number(value) if rule.optional else value
            checked = checked_value(given, rule, f"{section}: {name}")
            self._app.change_draft(lambda draft: draft.set(section, name, checked))

    def _show_field(self, section: str, name: str) -> None:
        widget, value = self._widgets[(section, name)], self._app.draft.value(section, name)
        shown = _list_text(value) if isinstance(value, tuple) else value
        if rules(type(getattr(self._app.draft.base, section)))[name].optional:
            shown = _optional_text(value)
        set_value(widget, shown)

    # ---- presets ---------------------------------------------------------------------------------------------------
    def _on_preset(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None:
            return
        name = event.target.value
        if name not in self._preset_names():
            self._app.refuse(event.client_id, f"case: {str(name)[:40]!r} is no option")
            set_value(self._preset, self._app.draft.base.name)
            return
        if name in SHIPPED_CASES:
            self._app.change_draft(lambda draft: draft.begin(load_case(name)), whole=True)
            self._app.worker.every(self._show_set_up)

    def _show_set_up(self) -> None:
        """Another case was asked for: its initial design is shown, and a run of the one before waits in *Runs*."""
        if self._app.picture.status not in ACTIVE:
            with contextlib.suppress(InputError):
                self._runs.close_run()

    def _on_workers(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None:
            return
        try:
            self._runs.set_workers(event.target.value)
        except InputError as error:
            self._app.refuse(event.client_id, str(error))
            set_value(self._workers, self._runs.workers)

    def _on_around(self, _event: viser.GuiEvent[Any]) -> None:
        self._app.change_draft(Draft.search_around_initial, whole=True)

    def _on_reset(self, _event: viser.GuiEvent[Any]) -> None:
        self._app.change_draft(Draft.reset_all, whole=True)

    def show_all(self) -> None:
        """Bring every widget to the draft, which was changed as a whole (a preset, a reset, another run's case)."""
        name, names = self._app.draft.base.name, self._preset_names()
        if tuple(self._preset.options) != tuple(names):
            self._preset.options = names
        set_value(self._preset, name)
        self._follow_initial()
        for place in self._sliders:
            self._show_bounds(place)
        for section, field in self._widgets:
            self._show_field(section, field)
        self.draw()

    def _title(self, section: str, name: str) -> str:
        if section == "bounds":
            return SEARCH_TABLE[name].symbol
        return self._labels.get((section, name), name)

    # ---- drawing ---------------------------------------------------------------------------------------------------
    def draw(self) -> None:
        """Readouts, marks of change, and the preset's two lines."""
        draft = self._app.draft
        self._follow_initial()
        lines = joined(_paragraphs(draft.base.description), "<br>")
        try:
            draft.case()
            trouble = NOTHING
        except InputError as error:
            trouble = fill('<p class="bad">{}</p>', in_words(str(error)))
        count = draft.count()
        changed = NOTHING
        if count:
            words = (
                chip("reset_field", f"{self._title(section, name)} ✕", f"{section}.{name}", hint="back to the preset's")
                for section, fields in draft.changes.items()
                for name in fields
            )
            changed = joined([soft("Changed (●):"), chips(*words)])
        history = self._app.history
        # a run on display keeps its own case
        picture = self._app.picture
        another = count or draft.base.name != picture.case.name
        waiting = ", for the next run" if another and picture.name else ""
        # always there: what lies below must not move away from under the mouse
        steps = chips(
            chip(
                "undo",
                "↶ undo",
                disabled=not history.can_undo,
                hint="take the last change back (Ctrl+Z)",
            ),
            chip("redo", "↷ redo", disabled=not history.can_redo, hint="make it again (Ctrl+Shift+Z)"),
            soft((f"{count} changed" if count else "as the preset") + waiting, "span"),
        )
        self._about.show(box(fill("<p><b>{}</b></p>", draft.base.title), soft(lines), trouble, steps))
        self._changed.show(box(changed) if count else NOTHING)
        self._trouble.show(box(trouble) if trouble else NOTHING)
        self._reset.visible = count > 0
        for (section, name), widget in self._widgets.items():
            label = self._labels[(section, name)] + (" ●" if draft.changed(section, name) else "")
            if widget.label != label:
                widget.label = label
        for key, readout in zip(draft.searched(), self._readouts.values(), strict=True):
            quantity = variable_quantity(key, draft.initial())
            shown = SEARCH_TABLE[quantity.key].shown
            low, high = draft.value("bounds", quantity.key)
            unit = f" {quantity.unit}" if quantity.unit else ""
            mark = " ●" if draft.changed("bounds", quantity.key) else ""
            readout.show(
                fill(
                    '<div class="hp readout" data-variable="{}"><span>{} … {}{}{}</span><span class="level">{}</span>'
                    "{}{}</div>",
                    quantity.key,
                    self._box(quantity, "lower", shown(low)),
                    self._box(quantity, "upper", shown(high)),
                    unit,
                    fill(" {}", "fixed") if low == high else NOTHING,
                    mark,
                    self._pressed(quantity.key),
                    self._stand_in(quantity.key),
                )
            )

    @staticmethod
    def _stand_in(key: str) -> Markup:
        """A button that searches what could stand in a variable's place."""
        others = (SEARCH_TABLE[name] for name in interchangeable(key) if name != key)
        words = [
            chip("search_by", f"search {item.symbol} instead", item.name, hint=f"{item.label}: {item.rule.meaning}")
            for item in others
        ]
        return chips(*words) if words else NOTHING

    def _box(self, quantity: Quantity, side: str, value: float) -> Markup:
        """A number box for one bound: to be typed into, and stepped by the arrow keys."""
        variable = SEARCH_TABLE[quantity.key]
        step = variable.scale * variable.step_near(self._initial_value(quantity.key))
        return fill(
            '<input type="number" class="bound" data-set="bound" data-arg="{}.{}" value="{:.{}f}" step="{:g}" '
            'aria-label="{}, {} bound">',
            quantity.key,
            side,
            value,
            quantity.decimals,
            step,
            quantity.label,
            side,
        )

    def _pressed(self, key: str) -> Markup:
        """How much of the newest front stands on a variable's bounds, with a button that moves the bound out."""
        picture = self._app.picture
        newest = picture.generations[-1] if picture.generations else None
        values = picture.column(key) if newest is not None else None
        bounds = picture.case.bounds.as_dict().get(key)
        if newest is None or values is None or bounds is None or self._app.draft.value("bounds", key) != bounds:
            return NOTHING
        front, (low, high) = values[picture.rows(newest.front)], SEARCH_TABLE[key].shown_pair(bounds)
        near = ON_BOUND * (high - low)
        words = []
        for side, count in (("lower", int((front <= low + near).sum())), ("upper", int((front >= high - near).sum()))):
            if low < high and count:
                said = fill('<span class="standing">{} of {} on the {} bound</span>', count, len(front), side)
                widen = chip(
                    "widen", "widen", f"{key}.{side}", hint=f"move the {side} bound out by a quarter of the range"
                )
                words.append(said + widen)
        return chips(*words) if words else NOTHING


def _paragraphs(text: str) -> list[str]:
    """Lines of a description, of which one that ends within a sentence is only wrapped."""
    found: list[str] = []
    for line in text.strip().split("\n"):
        if found and found[-1] and not found[-1].endswith((".", ":", ";", "!", "?")):
            found[-1] += f" {line.strip()}"
        else:
            found.append(line.strip())
    return found


def _list_text(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.12g}" for value in values)


def _optional_text(value: float | None) -> str:
    return "" if value is None else f"{value:.12g}"


def _optional_number(value: object) -> object:
    """What a browser sent for a number that may be left out: nothing at all, a number, or what it sent."""
    if not isinstance(value, str):
        return value
    try:
        return float(value) if value.strip() else None
    except ValueError:
        return value[:40]
