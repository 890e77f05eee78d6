"""The case while it is being set up: a preset and what was changed of it, checked as a whole."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hpsop_core.case.case import SECTIONS, SHIPPED_CASES, Case, case_from_toml, load_case
from hpsop_core.case.fields import checked_value, rules
from hpsop_core.case.variables import SEARCH_TABLE, DesignSpace, DesignVariables, interchangeable, value_of
from hpsop_core.errors import InputError


@dataclass(frozen=True)
class DraftSnapshot:
    """The settings at one moment: a preset and what was changed of it."""

    base: Case
    changes: Mapping[str, Mapping[str, Any]]

    def differing(self, other: DraftSnapshot) -> frozenset[tuple[str, str]]:
        """The (section, field) in which two of them differ; ("", "") where they stand on different presets."""
        if self.base != other.base:
            return frozenset({("", "")})
        sections = {*self.changes, *other.changes}
        pairs = {
            (section, name)
            for section in sections
            for name in {*self.changes.get(section, {}), *other.changes.get(section, {})}
        }
        return frozenset(
            (section, name)
            for section, name in pairs
            if self.changes.get(section, {}).get(name) != other.changes.get(section, {}).get(name)
        )


class Draft:
    """A case with changes that may, for a moment, not fit together.

    Attributes:
        base: the preset.
        changes: {section: {field: value}}; the section "bounds" holds (lower, upper) by variable.
        held: why what stands in a field at this moment cannot be taken, by (section, field); then there is no case.
    """

    def __init__(self, base: Case) -> None:
        self.base = base
        self.changes: dict[str, dict[str, Any]] = {}
        self.held: dict[tuple[str, str], str] = {}

    def set(self, section: str, name: str, value: Any) -> None:
        """Change one field; the base's own value takes the change back."""
        self.held.pop((section, name), None)
        if value == self.base_value(section, name):
            self.reset(section, name)
        else:
            self.changes.setdefault(section, {})[name] = value

    def hold(self, section: str, name: str, why: str) -> None:
        """A field shows something that cannot be taken (somebody may still be typing)."""
        self.held[(section, name)] = why

    def release(self, section: str, name: str) -> None:
        """The field shows again what the draft holds."""
        self.held.pop((section, name), None)

    def reset(self, section: str, name: str) -> None:
        """Take a change back."""
        self.held.pop((section, name), None)
        fields = self.changes.get(section, {})
        fields.pop(name, None)
        if not fields:
            self.changes.pop(section, None)

    def reset_all(self) -> None:
        """Back to the preset."""
        self.changes = {}
        self.held = {}

    def begin(self, base: Case) -> None:
        """Set up from this case: a shipped preset and its changes where the case descends from one."""
        self.base = base
        self.reset_all()
        if base.name not in SHIPPED_CASES:
            return
        preset = load_case(base.name)
        if (preset.title, preset.description) != (base.title, base.description):
            return
        self.base = preset
        for section in SECTIONS:
            for name in rules(SECTIONS[section]):
                self.set(section, name, getattr(getattr(base, section), name))
        for name, pair in base.bounds.as_dict().items():
            self.set("bounds", name, pair)

    def base_value(self, section: str, name: str) -> Any:
        """What the preset says; None of bounds that it does not have."""
        if section == "bounds":
            return self.base.bounds.as_dict().get(name)
        return getattr(getattr(self.base, section), name)

    def value(self, section: str, name: str) -> Any:
        """What stands now."""
        return self.changes.get(section, {}).get(name, self.base_value(section, name))

    def changed(self, section: str, name: str) -> bool:
        """Whether a field differs from the preset."""
        return name in self.changes.get(section, {})

    def count(self) -> int:
        """How many fields differ from the preset."""
        return sum(len(fields) for fields in self.changes.values())

    def snapshot(self) -> DraftSnapshot:
        """What stands now, to come back to."""
        return DraftSnapshot(self.base, {section: dict(fields) for section, fields in self.changes.items()})

    def come_back(self, snapshot: DraftSnapshot) -> None:
        """Let stand again what stood then."""
        self.base, self.held = snapshot.base, {}
        self.changes = {section: dict(fields) for section, fields in snapshot.changes.items()}

    def initial(self) -> DesignVariables:
        """The initial design as it stands; the preset's while the fields make no design."""
        try:
            return dataclasses.replace(self.base.initial, **self.changes.get("initial", {})).variables
        except InputError:
            return self.base.initial.variables

    def searched(self) -> tuple[str, ...]:
        """The variables that are searched, as they stand."""
        return self.base.bounds.names_with(self.changes.get("bounds", {}))

    def search_by(self, name: str) -> None:
        """Search this variable in the place of its stand-in, or the other way round, within its usual bounds."""
        for other in interchangeable(name):
            self.reset("bounds", other)
        if name not in self.searched():
            initial = self.initial()
            self.set("bounds", name, SEARCH_TABLE[name].bounds_near(value_of(name, initial, initial)))

    def search_around_initial(self) -> None:
        """Usual bounds around the initial design for what is searched; what is fixed stays so, at its value."""
        initial = self.initial()
        for name, (low, high) in DesignSpace.around(initial, self.searched()).as_dict().items():
            value = float(value_of(name, initial, initial))
            lower, upper = self.value("bounds", name)
            if lower == upper:
                low, high = value, value
            elif low == high:
                # cases usually fix this one, and this case frees it: as far as its slider goes
                low, high = SEARCH_TABLE[name].reach_near(value)
            self.set("bounds", name, (low, high))

    def widen(self, name: str, side: str) -> None:
        """Move a variable's "lower" or "upper" bound out by a quarter of its range, in whole steps, within its rule."""
        variable = SEARCH_TABLE[name]
        lower, upper = self.value("bounds", name)
        initial = self.initial()
        step = variable.step_near(value_of(name, initial, initial))
        reach = max(1.0, math.ceil(round(0.25 * (upper - lower) / step, 6))) * step
        if side == "lower":
            lower = max(round(lower - reach, 10), variable.rule.lower)
        else:
            upper = min(round(upper + reach, 10), variable.rule.upper)
        self.set("bounds", name, (variable.typed(lower), variable.typed(upper)))

    def set_bound(self, name: str, side: str, value: float) -> None:
        """Set a variable's "lower" or "upper" bound.

        Raises:
            InputError: not within the variable's rule, or beyond the other bound.
        """
        variable = SEARCH_TABLE[name]
        lower, upper = self.value("bounds", name)
        whole = variable.whole and math.isfinite(value) and value == round(value)
        new = checked_value(variable.typed(value) if whole else value, variable.rule, variable.symbol)
        if (side == "lower" and new > upper) or (side == "upper" and new < lower):
            shown = variable.shown(upper if side == "lower" else lower)
            raise InputError(
                f"{variable.symbol}: the lower bound cannot lie above the upper one, which needs "
                f"{'at most' if side == 'lower' else 'at least'} {shown:g}"
            )
        self.set("bounds", name, (new, upper) if side == "lower" else (lower, new))

    def case(self) -> Case:
        """The whole case.

        Raises:
            InputError: the changes do not make a case; the text says which field and what to do.
        """
        for why in list(self.held.values()):
            raise InputError(why)
        fields = {section: changes for section, changes in self.changes.items() if section != "bounds"}
        case = self.base.changed(fields)
        bounds = self.changes.get("bounds")
        return case.with_bounds(bounds) if bounds else case

    # ---- over a restart of the server --------------------------------------------------------------------------------
    def saved(self) -> dict[str, Any]:
        """The draft as JSON."""
        return {
            "base": self.base.to_toml(),
            "changes": {section: dict(fields) for section, fields in self.changes.items()},
        }

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Come back to what ``saved`` described; what no longer fits is left at the preset's own value."""
        try:
            stored = case_from_toml(str(saved["base"]), "page.json")
            changes = {section: dict(fields) for section, fields in dict(saved["changes"]).items()}
        except (InputError, KeyError, TypeError, ValueError):
            return
        base = self.base = stored
        self.reset_all()
        known = base.bounds.as_dict()
        for section, fields in changes.items():
            for name, value in fields.items():
                try:
                    if section == "bounds":
                        low, high = value
                        base.with_bounds({name: (low, high)})
                        like = type(known[name][0]) if name in known else float
                        taken: Any = (like(low), like(high))
                    else:
                        taken = checked_value(value, rules(SECTIONS[section])[name], f"{section}: {name}")
                except (InputError, KeyError, TypeError, ValueError):
                    continue
                self.set(section, name, taken)


def numbers_from_text(text: str, where: str) -> tuple[float, ...]:
    """Numbers from "0.22, 0.27".

    Raises:
        InputError: a part is no number.
    """
    parts: Sequence[str] = [part for part in text.replace(";", ",").replace(" ", ",").split(",") if part]
    try:
        found = tuple(float(part) for part in parts)
        if not all(math.isfinite(value) for value in found):
            raise ValueError
        return found
    except ValueError:
        raise InputError(f"{where}: '{text}' is not a list of numbers; write for example 0.22, 0.27") from None
