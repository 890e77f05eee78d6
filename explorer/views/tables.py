"""Tables of a design's numbers, as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from explorer.state.shown import Shown
from hpsop_core.case.case import KNOT
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import Markup, fill, joined, symbol_html, symbol_plain
from hpsop_core.quantities import (
    CONSTRAINT_GROUP,
    CONSTRAINTS,
    HULL,
    OBJECTIVES,
    PROPELLER,
    SHIP,
    Quantity,
    change_text,
    condition_quantities,
    conditions_of,
    standing_on,
    violated,
)
from hpsop_core.units import SHIP_SIZE, Size

_ROOM_FOR_NAMES = 4
_CONDITIONS_APART = 2
_PLAIN_CHANGE = {CONSTRAINT_GROUP}
# a percentage of a percentage says nothing
_PLAIN_KEYS = {"blades", "lcb"}


def headline(shown: Shown) -> Markup:
    """Design 12 · level 1 · generation 3 · feasible."""
    evaluation = shown.evaluation
    parts: list[str] = [fill("<b>{}</b>", shown.label), f"level {evaluation.level}"]
    if shown.generation is not None and shown.generation > 0:
        parts.append(f"generation {shown.generation}")
    if not evaluation.ok:
        parts.append(fill('<span class="bad">failed: {}</span>', evaluation.reason))
    elif evaluation.feasible:
        parts.append(Markup('<span class="good">feasible</span>'))
    else:
        parts.append(Markup('<span class="bad">infeasible</span>'))
    return joined(parts, " · ")


def warnings_html(shown: Shown) -> Markup:
    """Violated constraints, what the design stands on, and warnings in words."""
    lines = [fill('<p class="bad">{}</p>', text) for text in violated(shown.evaluation)]
    standing = standing_on(shown.evaluation)
    if standing:
        lines.append(
            fill('<p class="standing" data-standing="{}">Stands on: {}.</p>', len(standing), "; ".join(standing))
        )
    lines += [fill('<p class="soft">{}</p>', _written(text, shown.evaluation)) for text in shown.evaluation.warnings]
    return joined(lines)


def _written(text: str, evaluation: Evaluation) -> str:
    """A warning as the page writes: it is plain text for terminals too, and names a condition by its Froude number."""
    for plain, sign in (("2 pi Fn^2 L", "2π Fn² L"), (" m2 ", " m² ")):
        text = text.replace(plain, sign)
    for condition in evaluation.conditions:
        number = condition.froude_number
        text = text.replace(f"Froude number {number:g}:", f"{condition.speed / KNOT:.4g} kn (Fn {number:.4g}):")
    return text[:1].upper() + text[1:]


def comparison_table(initial: Shown | None, selected: Shown | None, quantities: Sequence[Quantity]) -> Markup:
    """Initial, selected and change, grouped; the conditions stand side by side in their own groups."""
    rows = [Markup("<tr><th></th><th>initial</th><th>selected</th><th>change</th></tr>")]
    group = ""
    for quantity in quantities:
        first = quantity.value(initial.evaluation) if initial else None
        second = quantity.value(selected.evaluation) if selected else None
        if first is None and second is None:
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append(fill('<tr class="group"><td colspan="4">{}</td></tr>', group))
        plain = group in _PLAIN_CHANGE or quantity.key in _PLAIN_KEYS
        change = change_text(first, second, quantity.decimals, relative=not plain)
        rows.append(
            fill(
                '<tr data-quantity="{}"><td class="name">{}</td><td>{}</td><td>{}</td><td class="{}">{}</td></tr>',
                quantity.key,
                _name(quantity),
                quantity.text(initial.evaluation) if initial else "–",
                _with_error(quantity, selected) if selected else "–",
                _tone(quantity, first, second),
                change,
            )
        )
    return _table(rows)


def many_table(
    initials: Mapping[int, Shown | None], designs: Sequence[Shown], quantities: Sequence[Quantity]
) -> Markup:
    """All numbers of several designs with the difference to the initial design at the same level below each.

    Args:
        initials: the initial design by level; the column "initial" is that of the last design's level.
        designs: one or more.
        quantities: of the case, in their order (``quantities_of_case``).
    """
    initial = initials.get(designs[-1].evaluation.level)
    heads = joined(
        fill(
            '<th class="pinned" style="--pin:var(--hp-pin{})">{}<br><span class="unit">level {}</span></th>',
            index + 1,
            item.label,
            item.evaluation.level,
        )
        for index, item in enumerate(designs)
    )
    name = _name if len(designs) < _ROOM_FOR_NAMES else _short_name
    rows = [fill("<tr><th></th><th>initial</th>{}</tr>", heads)]
    group = ""
    for quantity in quantities:
        first = quantity.value(initial.evaluation) if initial else None
        values = [quantity.value(item.evaluation) for item in designs]
        if first is None and all(value is None for value in values):
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append(fill('<tr class="group"><td colspan="{}">{}</td></tr>', 2 + len(designs), group))
        cells = []
        plain = group in _PLAIN_CHANGE or quantity.key in _PLAIN_KEYS
        for item, value in zip(designs, values, strict=True):
            own = initials.get(item.evaluation.level)
            base = quantity.value(own.evaluation) if own else None
            change = change_text(base, value, quantity.decimals, relative=not plain)
            cells.append(
                fill(
                    '<td>{}<br><span class="change {}">{}</span></td>',
                    _with_error(quantity, item),
                    _tone(quantity, base, value),
                    change,
                )
            )
        rows.append(
            fill(
                '<tr data-compare="{}"><td class="name">{}</td><td>{}</td>{}</tr>',
                quantity.key,
                name(quantity),
                quantity.text(initial.evaluation) if initial else "–",
                joined(cells),
            )
        )
    return _table(rows)


def _table(rows: Sequence[Markup]) -> Markup:
    return fill('<table class="numbers">{}</table>', joined(rows))


def design_card(shown: Shown, size: Size = SHIP_SIZE) -> Markup:
    """Every number of a design, for the tooltip; units by the size of the run's ships."""
    evaluation = shown.evaluation
    names = conditions_of(evaluation)
    alone = (*OBJECTIVES, *(item.sized(size) for item in (*HULL, *SHIP, *PROPELLER)), *CONSTRAINTS)
    columns = [_table([_card_row(quantity, shown) for quantity in alone])]
    quantities = condition_quantities(names, size)
    each = len(quantities) // max(len(names), 1)
    groups = [quantities[index * each : (index + 1) * each] for index in range(len(names))]
    if len(groups) > _CONDITIONS_APART:
        columns.append(_conditions_side_by_side(shown, names, groups))
    else:
        for part in groups:
            group = fill('<tr class="group"><td colspan="2">{}</td></tr>', part[0].group)
            columns.append(_table([group, *(_card_row(quantity, shown) for quantity in part)]))
    return joined([headline(shown), fill('<div class="columns">{}</div>', joined(columns)), warnings_html(shown)])


def _conditions_side_by_side(shown: Shown, names: Sequence[str], groups: Sequence[Sequence[Quantity]]) -> Markup:
    """A row a quantity, a column a condition: many conditions would not fit beside each other otherwise."""
    rows = [fill("<tr><th></th>{}<th></th></tr>", joined(fill("<th>{}</th>", name) for name in names))]
    for own in zip(*groups, strict=True):
        if all(quantity.value(shown.evaluation) is None for quantity in own):
            continue
        cells = joined(fill("<td>{}</td>", _with_error(quantity, shown)) for quantity in own)
        symbol = symbol_html(own[0].symbol.removesuffix("1").removesuffix("_"))
        rows.append(fill('<tr><td>{}</td>{}<td class="unit">{}</td></tr>', symbol, cells, own[0].unit))
    return _table(rows)


def _card_row(quantity: Quantity, shown: Shown) -> Markup:
    if quantity.value(shown.evaluation) is None:
        return Markup("")
    unit = fill(' <span class="unit">{}</span>', quantity.unit) if quantity.unit else ""
    symbol = symbol_html(quantity.symbol)
    return fill("<tr><td>{}</td><td>{}{}</td></tr>", symbol, _with_error(quantity, shown), unit)


def _with_error(quantity: Quantity, shown: Shown) -> Markup:
    """A number with the half width of its 90 % interval, where one is stated."""
    error = quantity.error_text(shown.evaluation)
    number = quantity.text(shown.evaluation)
    return (
        fill('{} <span class="unit" data-error="{}">{}</span>', number, quantity.key, error)
        if error
        else fill("{}", number)
    )


def _name(quantity: Quantity) -> Markup:
    return fill(
        "<span title=\"{}\">{} <span class='unit'>{}</span>{}</span>",
        _meaning(quantity),
        quantity.label,
        symbol_html(quantity.symbol),
        _bracketed_unit(quantity),
    )


def _meaning(quantity: Quantity) -> str:
    """A quantity's name and formula, for whoever rests on it."""
    return f"{quantity.label}: {symbol_plain(quantity.formula)}" if quantity.formula else quantity.label


def _short_name(quantity: Quantity) -> Markup:
    """Symbol and unit, with the name on hover: several designs leave no room for both."""
    symbol = symbol_html(quantity.symbol)
    return fill('<span title="{}">{}{}</span>', _meaning(quantity), symbol, _bracketed_unit(quantity))


def _bracketed_unit(quantity: Quantity) -> Markup:
    return fill(' <span class="unit">[{}]</span>', quantity.unit) if quantity.unit else Markup("")


def _tone(quantity: Quantity, first: float | None, second: float | None) -> str:
    if not quantity.better or first is None or second is None or abs(second - first) < 1e-9 * max(abs(first), 1e-9):
        return ""
    return "good" if (second - first) * quantity.better > 0 else "bad"
