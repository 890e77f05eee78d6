"""The reference of a case file's fields, made from their declarations.

``python -m tools.case_reference > docs/case.md``
"""

from __future__ import annotations

import argparse
import math
import sys

from hpsop_core.case.case import SECTIONS, SHIPPED_CASES, load_case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.fields import FieldRule, rules, toml_text
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.case.variables import SEARCH_TABLE, STANDS_FOR, VARIABLE_TABLE

_HEAD = """# The case file

A case is a TOML file. `hpsop evaluate CASE` takes a shipped case's name or such a file; the page saves one by
*Save case*. Unknown fields, reversed bounds, NaN and numbers outside their limits are refused in one line. This page is
made from the code by `python -m tools.case_reference > docs/case.md`; a test compares them.

Files that a case names (`file`, `offsets`, `stl`, `geometry`) are relative to the case file.
"""

_BOUNDS = """
## [bounds]

Lower and upper bound of each design variable; equal bounds fix it. Not stated, these are fixed at the initial design's
values: {optional}. The initial design's own displacement_ratio is 1 here, whatever [initial] states:
that one is over the parent's form, this one over the initial design.
{stand_ins}

| variable | symbol | unit | may be | meaning |
|---|---|---|---|---|"""


def case_reference() -> str:
    """The whole page as Markdown."""
    parts = [_HEAD, "## Shipped cases\n"]
    for name in SHIPPED_CASES:
        case = load_case(name)
        parts.append(f"* **{name}**: {case.title}. {' '.join(case.description.split())}")
    optional = ", ".join(name for name, variable in VARIABLE_TABLE.items() if not variable.bounds_required)
    stand_ins = " ".join(
        f"A case states {name} or {other}, not both: what it states is searched, and the other follows from it and the "
        "main dimensions. --set and Case.design take either one in any case."
        for name, other in STANDS_FOR.items()
    )
    parts.append(_BOUNDS.format(optional=optional, stand_ins=stand_ins))
    for name, variable in SEARCH_TABLE.items():
        rule = variable.rule
        parts.append(f"| {name} | {variable.symbol} | {rule.unit or '-'} | {_limits(rule)} | {rule.meaning} |")
    for section, declaration in SECTIONS.items():
        parts.append(f"\n## [{section}]\n\n{(declaration.__doc__ or '').strip()}\n")
        parts.append("| field | default | unit | may be | meaning |\n|---|---|---|---|---|")
        for name, rule in rules(declaration).items():
            default = getattr(declaration, name, rule.default)
            shown = "-" if default is None else toml_text({name: default}).strip().removeprefix(f"{name} = ")
            parts.append(f"| {name} | {shown} | {rule.unit or '-'} | {_limits(rule)} | {rule.meaning} |")
        if section == "objectives":
            parts.append("\n| objective | formula | meaning |\n|---|---|---|")
            parts += [f"| {item.name} | {item.formula} | {item.words} |" for item in OBJECTIVES]
        if section == "constraints":
            parts.append("\n| constraint (g <= 0) | symbol | applies | g is |\n|---|---|---|---|")
            parts += [f"| {item.name} | {item.symbol} | {item.applies} | {item.meaning} |" for item in CONSTRAINTS]
    return "\n".join(parts) + "\n"


def _limits(rule: FieldRule) -> str:
    if rule.choices:
        return ", ".join(rule.choices)
    if not math.isfinite(rule.lower):
        return {"text": "any text", "flag": "true, false"}[rule.kind]
    words = {"integer": "whole, ", "numbers": "list, each "}.get(rule.kind, "")
    return f"{words}{rule.lower:g} to {rule.upper:g}"


if __name__ == "__main__":
    argparse.ArgumentParser(prog="python -m tools.case_reference", description=__doc__).parse_args()
    sys.stdout.write(case_reference())
