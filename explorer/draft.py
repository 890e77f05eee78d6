"""The case while it is being set up: a preset and what was changed of it, checked as a whole."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hpsop_core.case import Case
from hpsop_core.errors import InputError


class Draft:
    """A case with changes that may, for a moment, not fit together.

    Attributes:
        base: the preset.
        changes: {section: {field: value}}; the section "bounds" holds (lower, upper) by variable.
    """

    def __init__(self, base: Case) -> None:
        self.base = base
        self.changes: dict[str, dict[str, Any]] = {}

    def set(self, section: str, name: str, value: Any) -> None:
        """Change one field; the base's own value takes the change back."""
        if value == self.base_value(section, name):
            self.reset(section, name)
        else:
            self.changes.setdefault(section, {})[name] = value

    def reset(self, section: str, name: str) -> None:
        """Take a change back."""
        fields = self.changes.get(section, {})
        fields.pop(name, None)
        if not fields:
            self.changes.pop(section, None)

    def reset_all(self) -> None:
        """Back to the preset."""
        self.changes = {}

    def base_value(self, section: str, name: str) -> Any:
        """What the preset says."""
        if section == "bounds":
            return self.base.bounds.as_dict()[name]
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

    def case(self) -> Case:
        """The whole case.

        Raises:
            InputError: the changes do not make a case; the text says which field and what to do.
        """
        case = self.base
        for section, fields in self.changes.items():
            if section == "bounds":
                case = case.with_bounds(fields)
            else:
                case = case.replaced(section, **fields)
        return case


def numbers_from_text(text: str, where: str) -> tuple[float, ...]:
    """Numbers from "0.22, 0.27".

    Raises:
        InputError: a part is no number.
    """
    parts: Sequence[str] = [part for part in text.replace(";", ",").replace(" ", ",").split(",") if part]
    try:
        return tuple(float(part) for part in parts)
    except ValueError:
        raise InputError(f"{where}: '{text}' is not a list of numbers; write for example 0.22, 0.27") from None
