"""Tables of a design's numbers, as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from explorer.state.shown import Shown
from hpsop_core.markup import escape, symbol_html
from hpsop_core.quantities import (
    CONSTRAINTS,
    HULL,
    OBJECTIVES,
    PROPELLER,
    Quantity,
    all_quantities,
    change_text,
    condition_quantities,
    violated,
)

_ROOM_FOR_NAMES = 4
_PLAIN_CHANGE = {"Constraints (feasible ≤ 0)"}


def headline(shown: Shown) -> str:
    """Design 12 · level 1 · generation 3 · feasible."""
    evaluation = shown.evaluation
    parts = [f"<b>{escape(shown.label)}</b>", f"level {evaluation.level}"]
    if shown.generation is not None and shown.generation > 0:
        parts.append(f"generation {shown.generation}")
    if not evaluation.ok:
        parts.append(f'<span class="bad">failed: {escape(evaluation.reason)}</span>')
    elif evaluation.feasible:
        parts.append('<span class="good">feasible</span>')
    else:
        parts.append('<span class="bad">infeasible</span>')
    return " · ".join(parts)


def warnings_html(shown: Shown) -> str:
    """Violated constraints and warnings in words."""
    lines = [f'<p class="bad">{escape(text)}</p>' for text in violated(shown.evaluation)]
    lines += [f'<p class="soft">{escape(text)}</p>' for text in shown.evaluation.warnings]
    return "".join(lines)


def comparison_table(initial: Shown | None, selected: Shown | None, froude_numbers: Sequence[float]) -> str:
    """Initial, selected and change, grouped; the conditions stand side by side in their own groups."""
    rows = ["<tr><th></th><th>initial</th><th>selected</th><th>change</th></tr>"]
    group = ""
    for quantity in all_quantities(froude_numbers):
        first = quantity.value(initial.evaluation) if initial else None
        second = quantity.value(selected.evaluation) if selected else None
        if first is None and second is None:
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append(f'<tr class="group"><td colspan="4">{escape(group)}</td></tr>')
        plain = group in _PLAIN_CHANGE or quantity.key == "blades"
        change = change_text(first, second, quantity.decimals, relative=not plain)
        css = _tone(quantity, first, second)
        rows.append(
            f'<tr data-quantity="{quantity.key}"><td class="name">{_name(quantity)}</td>'
            f"<td>{quantity.text(initial.evaluation) if initial else '–'}</td>"
            f"<td>{quantity.text(selected.evaluation) if selected else '–'}</td>"
            f'<td class="{css}">{change}</td></tr>'
        )
    return f'<table class="numbers">{"".join(rows)}</table>'


def many_table(initials: Mapping[int, Shown | None], designs: Sequence[Shown], froude_numbers: Sequence[float]) -> str:
    """All numbers of several designs with the difference to the initial design at the same level below each.

    Args:
        initials: the initial design by level; the column "initial" is that of the last design's level.
        designs: one or more.
        froude_numbers: of the case.
    """
    initial = initials.get(designs[-1].evaluation.level)
    heads = "".join(
        f'<th class="pinned" style="--pin:var(--hp-pin{index + 1})">{escape(item.label)}'
        f'<br><span class="unit">level {item.evaluation.level}</span></th>'
        for index, item in enumerate(designs)
    )
    name = _name if len(designs) < _ROOM_FOR_NAMES else _short_name
    rows = [f"<tr><th></th><th>initial</th>{heads}</tr>"]
    group = ""
    for quantity in all_quantities(froude_numbers):
        first = quantity.value(initial.evaluation) if initial else None
        values = [quantity.value(item.evaluation) for item in designs]
        if first is None and all(value is None for value in values):
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append(f'<tr class="group"><td colspan="{2 + len(designs)}">{escape(group)}</td></tr>')
        cells = []
        plain = group in _PLAIN_CHANGE or quantity.key == "blades"
        for item, value in zip(designs, values, strict=True):
            own = initials.get(item.evaluation.level)
            base = quantity.value(own.evaluation) if own else None
            change = change_text(base, value, quantity.decimals, relative=not plain)
            cells.append(
                f'<td>{quantity.text(item.evaluation)}<br><span class="change {_tone(quantity, base, value)}">'
                f"{change}</span></td>"
            )
        rows.append(
            f'<tr data-compare="{quantity.key}"><td class="name">{name(quantity)}</td>'
            f"<td>{quantity.text(initial.evaluation) if initial else '–'}</td>{''.join(cells)}</tr>"
        )
    return f'<table class="numbers">{"".join(rows)}</table>'


def design_card(shown: Shown) -> str:
    """Every number of a design, for the tooltip."""
    evaluation = shown.evaluation
    froude = [condition.froude_number for condition in evaluation.conditions]
    left = "".join(_card_row(quantity, shown) for quantity in (*OBJECTIVES, *HULL, *PROPELLER, *CONSTRAINTS))
    columns = [f'<table class="numbers">{left}</table>']
    quantities = condition_quantities([round(value, 4) for value in froude])
    per_condition = len(quantities) // max(len(froude), 1) if froude else 0
    for index in range(len(froude)):
        part = quantities[index * per_condition : (index + 1) * per_condition]
        body = "".join(_card_row(quantity, shown) for quantity in part)
        columns.append(
            f'<table class="numbers"><tr class="group"><td colspan="2">{escape(part[0].group)}</td></tr>{body}</table>'
        )
    return f'{headline(shown)}<div class="columns">{"".join(columns)}</div>{warnings_html(shown)}'


def _card_row(quantity: Quantity, shown: Shown) -> str:
    if quantity.value(shown.evaluation) is None:
        return ""
    unit = f' <span class="unit">{quantity.unit}</span>' if quantity.unit else ""
    return f"<tr><td>{symbol_html(quantity.symbol)}</td><td>{quantity.text(shown.evaluation)}{unit}</td></tr>"


def _name(quantity: Quantity) -> str:
    unit = f' <span class="unit">[{quantity.unit}]</span>' if quantity.unit else ""
    return f"{escape(quantity.label)} <span class='unit'>{symbol_html(quantity.symbol)}</span>{unit}"


def _short_name(quantity: Quantity) -> str:
    """Symbol and unit, with the name on hover: several designs leave no room for both."""
    unit = f' <span class="unit">[{quantity.unit}]</span>' if quantity.unit else ""
    return f'<span title="{escape(quantity.label)}">{symbol_html(quantity.symbol)}{unit}</span>'


def _tone(quantity: Quantity, first: float | None, second: float | None) -> str:
    if not quantity.better or first is None or second is None or abs(second - first) < 1e-9 * max(abs(first), 1e-9):
        return ""
    return "good" if (second - first) * quantity.better > 0 else "bad"
