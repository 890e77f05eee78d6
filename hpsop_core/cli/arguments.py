"""What several commands read from their arguments, and how they print."""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import sys
from collections.abc import Sequence
from typing import Any

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.fields import FieldRule, checked_value
from hpsop_core.case.variables import SEARCH_TABLE, VARIABLE_TABLE, DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import FAST, LEVEL_NUMBERS, LEVELS


def add_level(parser: argparse.ArgumentParser) -> None:
    """--level 1|2."""
    parser.add_argument(
        "--level",
        type=int,
        choices=LEVEL_NUMBERS,
        default=FAST.number,
        help="; ".join(f"{level.number}: {level.words}" for level in LEVELS),
    )


def add_set(parser: argparse.ArgumentParser) -> None:
    """--set NAME=VALUE, repeatable."""
    parser.add_argument(
        "--set",
        dest="changes",
        action="extend",
        nargs="+",
        default=[],
        metavar="NAME=VALUE",
        help=f"change a design variable ({', '.join(SEARCH_TABLE)}) or a field of the case (section.field)",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """--json."""
    parser.add_argument("--json", action="store_true", help="print one JSON document on standard output")


def case_and_design(name: str, changes: Sequence[str]) -> tuple[Case, DesignVariables]:
    """The case and the design that CASE and --set name: the initial design with the changes.

    Raises:
        InputError: no such case, or a change that is not NAME=VALUE, names nothing or has a refused value.
    """
    case = load_case(name)
    variables: dict[str, object] = {}
    fields: dict[str, dict[str, object]] = {}
    for change in changes:
        field, separator, word = change.partition("=")
        field = field.strip()
        if not separator:
            raise InputError(f"--set {change}: write NAME=VALUE, for example --set diameter=9.2")
        if "." in field:
            section, item, value = _case_field(case, field, word.strip())
            fields.setdefault(section, {})[item] = value
        else:
            variables[field] = _number_or_word(word.strip())
    try:
        case = case.changed(fields)
    except InputError as error:
        raise InputError(f"--set {error}") from error
    return case, case.design(variables, "--set") if variables else case.initial.variables


def _case_field(case: Case, field: str, word: str) -> tuple[str, str, object]:
    """Section, field and value of section.field=value."""
    section, _, name = field.partition(".")
    sections = [item.name for item in dataclasses.fields(case) if dataclasses.is_dataclass(getattr(case, item.name))]
    sections.remove("bounds")
    if section not in sections:
        raise InputError(f"--set {field}: unknown section '{section}'; use one of {', '.join(sections)}")
    value: object
    if word in ("true", "false"):
        value = word == "true"
    elif word.startswith("["):
        value = [_number_or_word(item.strip()) for item in word.strip("[]").split(",") if item.strip()]
    else:
        value = _number_or_word(word)
    return section, name, value


def _number_or_word(word: str) -> object:
    try:
        value = float(word)
    except ValueError:
        return word
    return int(value) if value.is_integer() and math.isfinite(value) and "." not in word else value


def number_list(word: str, rule: FieldRule, option: str) -> tuple[float, ...]:
    """Numbers from a comma-separated word, each within the rule's limits.

    Raises:
        InputError: a part is no number or outside the limits.
    """
    parts = [part.strip() for part in word.split(",") if part.strip()]
    if not parts:
        raise InputError(f"{option}: no number given; write for example {option} 0.22,0.27")
    return tuple(float(checked_value(_number_or_word(part), rule, option)) for part in parts)


def checked_option(word: str | None, rule: FieldRule, option: str) -> float | None:
    """A number within the rule's limits, or None where the option is absent."""
    return None if word is None else float(checked_value(_number_or_word(word), rule, option))


def print_json(document: Any) -> None:
    """One JSON document on standard output; a NaN is a defect and raises ValueError."""
    json.dump(document, sys.stdout, allow_nan=False, indent=1)
    sys.stdout.write("\n")


def print_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table with right-aligned columns on standard output."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
    for row in [header, *rows]:
        print("  ".join(word.rjust(width) for word, width in zip(row, widths, strict=True)))


def describe_variables(variables: DesignVariables) -> list[str]:
    """One line a variable: name, value, unit."""
    return [
        f"  {name:<24}{value:>12.6g} {VARIABLE_TABLE[name].rule.unit}".rstrip()
        for name, value in variables.as_dict().items()
    ]
