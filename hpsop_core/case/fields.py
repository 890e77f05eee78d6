"""How a field of a case is declared, checked and written: its limits, unit and meaning stand beside it.

Every section of a case is a frozen dataclass whose fields are made by the functions below. ``read_section`` turns a
TOML table into such a section and refuses whatever it does not understand, in one line that names the field.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import tomli_w

from hpsop_core.errors import InputError, shown

# where a dataclass field keeps its rule
KEY = "hpsop"
_SPREAD_LIST = re.compile(r"\[\n((?: .*,\n)+)\]")
Section = TypeVar("Section")


@dataclass(frozen=True)
class FieldRule:
    """What a field of a case may hold.

    Attributes:
        kind: "number", "integer", "choice", "text", "numbers" (a list) or "flag".
        meaning: one line for people.
        unit: SI unit, or "" for a pure number.
        lower, upper: inclusive limits of a number.
        choices: the allowed words of a choice.
        optional: whether the field may be absent (None).
        default: what stands where a case does not state the field and its dataclass has no default.
    """

    kind: str
    meaning: str
    unit: str = ""
    lower: float = -math.inf
    upper: float = math.inf
    choices: tuple[str, ...] = ()
    optional: bool = False
    default: float | None = None


def number(default: float, lower: float, upper: float, meaning: str, unit: str = "") -> Any:
    """A real number within [lower, upper]."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("number", meaning, unit, lower, upper)})


def optional_number(lower: float, upper: float, meaning: str, unit: str = "") -> Any:
    """A real number within [lower, upper] that may be left out."""
    rule = FieldRule("number", meaning, unit, lower, upper, optional=True)
    return dataclasses.field(default=None, metadata={KEY: rule})


def integer(default: int, lower: int, upper: int, meaning: str, unit: str = "") -> Any:
    """A whole number within [lower, upper]."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("integer", meaning, unit, lower, upper)})


def choice(default: str, choices: Sequence[str], meaning: str) -> Any:
    """One of a few words."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("choice", meaning, choices=tuple(choices))})


def text(default: str, meaning: str) -> Any:
    """Free text."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("text", meaning)})


def numbers(default: tuple[float, ...], lower: float, upper: float, meaning: str, unit: str = "") -> Any:
    """A list of real numbers, each within [lower, upper]."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("numbers", meaning, unit, lower, upper)})


def flag(default: bool, meaning: str) -> Any:
    """Yes or no."""
    return dataclasses.field(default=default, metadata={KEY: FieldRule("flag", meaning)})


def rules(section: type[Any]) -> dict[str, FieldRule]:
    """The rule of every field of a section, by field name."""
    return {field.name: field.metadata[KEY] for field in dataclasses.fields(section) if KEY in field.metadata}


def unknown_name(name: str, known: Sequence[str], where: str) -> InputError:
    """The error for a name that does not exist, with the nearest one that does."""
    near = difflib.get_close_matches(name[:100], known, n=1)
    remedy = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
    return InputError(f"{where}: unknown field {shown(name)}; {remedy}")


def checked_value(value: object, rule: FieldRule, where: str) -> Any:
    """``value`` as the field's type; None leaves an optional field out.

    Args:
        value: what the user gave.
        rule: the field's rule.
        where: names the file and field, for the error.

    Raises:
        InputError: wrong type, NaN or infinite, outside the limits, or no option.
    """
    if value is None and rule.optional:
        return None
    if rule.kind == "flag":
        if not isinstance(value, bool):
            raise InputError(f"{where}: {shown(value)} is not true or false; write true or false")
        return value
    if rule.kind == "text":
        if not isinstance(value, str):
            raise InputError(f"{where}: {shown(value)} is not a text; put it in quotes")
        return value
    if rule.kind == "choice":
        if not isinstance(value, str) or value not in rule.choices:
            raise InputError(f"{where}: {shown(value)} is no option; use one of {', '.join(rule.choices)}")
        return value
    if rule.kind == "numbers":
        if not isinstance(value, Sequence) or isinstance(value, str):
            raise InputError(f"{where}: {shown(value)} is not a list of numbers; write for example [0.22, 0.27]")
        return tuple(_checked_number(item, rule, f"{where}[{index}]") for index, item in enumerate(value))
    return _checked_number(value, rule, where)


def _checked_number(value: object, rule: FieldRule, where: str) -> float | int:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"{where}: {shown(value)} is not a number; give a number{_limits(rule)}")
    # Not isfinite: Python's whole numbers may be greater than every double.
    if value != value or abs(value) == math.inf:
        raise InputError(f"{where}: {shown(value)} is not a finite number; give a number{_limits(rule)}")
    if rule.kind == "integer":
        if value != round(value):
            raise InputError(f"{where}: {shown(value)} is not a whole number; give a whole number{_limits(rule)}")
        value = round(value)
    if not rule.lower <= value <= rule.upper:
        raise InputError(f"{where}: {_shown(value)} is outside its limits; give a number{_limits(rule)}")
    return value if rule.kind == "integer" else float(value)


def _limits(rule: FieldRule) -> str:
    unit = f" {rule.unit}" if rule.unit else ""
    return f" from {_shown(rule.lower)} to {_shown(rule.upper)}{unit}" if math.isfinite(rule.lower) else unit


def _shown(value: float | int) -> str:
    # Whole numbers with every digit; one that no double reaches would not even print.
    return f"{value:g}" if isinstance(value, float) else str(value) if abs(value) < 10**15 else "a huge number"


def read_section(section: type[Section], table: Mapping[str, object], where: str) -> Section:
    """A section from a TOML table.

    Args:
        section: the dataclass of the section.
        table: the parsed table.
        where: file and section, for errors.

    Raises:
        InputError: an unknown field, or a value that its rule refuses.
    """
    known = rules(section)
    values: dict[str, Any] = {name: rule.default for name, rule in known.items() if rule.default is not None}
    for name, value in table.items():
        if name not in known:
            raise unknown_name(name, list(known), where)
        values[name] = checked_value(value, known[name], f"{where}: {name}")
    return section(**values)


def section_table(section: object) -> dict[str, object]:
    """A section as a TOML table, every field stated (so that a stored case never depends on later defaults)."""
    stated = {name: getattr(section, name) for name in rules(type(section))}
    return {name: value for name, value in stated.items() if value is not None}


def toml_text(tables: Mapping[str, object]) -> str:
    """TOML of texts, numbers, lists of numbers and tables of them, in the order given; floats keep all their digits.

    Raises:
        InputError: a text is no Unicode (a file's name may hold bytes that are none).
    """
    # tomli-w gives every number of a list a line of its own; a pair of bounds reads better on one. Nothing else ends a
    # line with a bracket that opens: a line break within a text is written as \n.
    written = _SPREAD_LIST.sub(lambda found: f"[{_joined(found[1])}]", tomli_w.dumps(tables))
    try:
        written.encode()
    except UnicodeEncodeError as error:
        line = written[: error.start].count("\n")
        there = ascii(written.splitlines()[line])
        raise InputError(f"case: {there} is no Unicode text; rename the file or mend the text") from error
    return written


def _joined(lines: str) -> str:
    return ", ".join(line.strip().removesuffix(",") for line in lines.splitlines())
