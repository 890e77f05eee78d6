"""What an owner asks first of a design: what it saves and whether it is safe, before and after, with errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from explorer.state.shown import Shown
from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.evaluation.coverage import KEPT, LIMIT, UNCOVERED, VIOLATED, Standing, standings
from hpsop_core.evaluation.levels import FAST
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import Markup, fill, joined
from hpsop_core.optimization.families import STATED_ERRORS
from hpsop_core.quantities import change_text, number_text, size_of_case
from hpsop_core.units import Size

_MOST_CONDITIONS = 2
# apart by so much of themselves two speeds read the same
_SAME_SPEED = 1e-3
# of a number of the usual order
_DIGITS = 3
_STATE_WORDS = {KEPT: "kept", LIMIT: "at its limit", VIOLATED: "violated", UNCOVERED: "not covered"}


@dataclass(frozen=True)
class _Line:
    """One number: what it is, from an evaluation, its unit and digits, has it the solvers' error, name and scale."""

    words: str
    value: Callable[[Evaluation], float | None]
    unit: str
    decimals: int
    solved: bool = True
    error: str = ""
    scale: float = 1e-6

    def sized(self, size: Size) -> _Line:
        """The same in the unit and with the digits of a ship of this size."""
        unit, plain = size.unit(self.unit, self.decimals, _DIGITS), self.value

        def value(item: Evaluation) -> float | None:
            found = plain(item)
            return None if found is None else unit.factor * found

        return replace(self, unit=unit.symbol, decimals=unit.decimals, value=value, scale=unit.factor * self.scale)


def _power(index: int) -> Callable[[Evaluation], float | None]:
    return lambda item: 1e-6 * item.conditions[index].delivered_power if index < len(item.conditions) else None


def _tonnes(name: str) -> Callable[[Evaluation], float | None]:
    def get(item: Evaluation) -> float | None:
        value = getattr(item, name) if item.ok else None
        return None if value is None else 1e-3 * float(value)

    return get


def _hull(name: str) -> Callable[[Evaluation], float | None]:
    def get(item: Evaluation) -> float | None:
        value = getattr(item.hull, name) if item.ok else None
        return None if value is None else float(value)

    return get


def _displacement(density: float) -> Callable[[Evaluation], float | None]:
    # files of before there were masses in them hold the volume
    return lambda item: 1e-3 * density * item.hull.displaced_volume if item.ok else None


def _lines(evaluation: Evaluation, case: Case) -> list[_Line]:
    conditions, froude = evaluation.conditions, case.conditions.speed == "froude"
    # the fastest decides the engine, the one of the greatest share the fuel
    main = {len(conditions) - 1, max(range(len(conditions)), key=lambda index: conditions[index].weight)}
    chosen = range(len(conditions)) if len(conditions) <= _MOST_CONDITIONS else sorted(main)
    lines = [
        _Line(
            f"delivered power at {_at(conditions[index], froude)}",
            _power(index),
            "MW",
            1,
            error=f"delivered_power_{index + 1}",
        )
        for index in sorted(chosen, reverse=True)
    ]
    lines += [
        _Line("fuel", _tonnes("fuel_per_hour"), "t/h", 2, error="fuel_per_hour", scale=1e-3),
        _Line("CO₂", _tonnes("carbon_dioxide_per_hour"), "t/h", 2, error="carbon_dioxide_per_hour", scale=1e-3),
        _Line("displacement", _displacement(case.constants.density), "t", 0, False),
        _Line("GM", _hull("metacentric_height"), "m", 2, False),
    ]
    return lines


def _at(condition: ConditionResult, froude: bool) -> str:
    """At fixed Froude numbers each design has speeds of its own."""
    return f"Fn {condition.froude_number:.4g}" if froude else f"{condition.speed / KNOT:.1f} kn"


def _speeds(case: Case, before: Evaluation | None, after: Evaluation) -> Markup:
    """Where powers are of two speeds, these speeds."""
    if before is None or case.conditions.speed != "froude":
        return Markup("")
    pairs = [
        f"{first.speed / KNOT:.1f} → {second.speed / KNOT:.1f} kn at Fn {second.froude_number:.4g}"
        for first, second in zip(before.conditions, after.conditions, strict=False)
        if abs(second.speed / first.speed - 1.0) > _SAME_SPEED
    ]
    return fill('<span class="soft">powers of two speeds: {}<br></span>', ", ".join(pairs)) if pairs else Markup("")


def _uncalibrated(case: Case, evaluation: Evaluation) -> Markup:
    """Thin-ship theory alone may give a full stern several times its waves: a power that nobody should read as one."""
    if evaluation.level != FAST.number or case.constants.wave_calibration != "none":
        return Markup("")
    return Markup(
        '<span class="standing">level 1, not calibrated: powers compare designs, they are no forecast<br></span>'
    )


def headline_card(case: Case, initial: Shown | None, shown: Shown) -> Markup:
    """Power, fuel, CO2, displacement and stability, before and after.

    The error of a change is the designs' own where they were solved finer, else that of a comparison of two designs at
    their level as the studies of the solvers state it; what all designs share (k, wake) is in the number's error alone.

    Args:
        case: of both.
        initial: the initial design at the same level, or None while it is not known.
        shown: the selected design.
    """
    evaluation = shown.evaluation
    if not evaluation.ok:
        return Markup("")
    before = initial.evaluation if initial is not None and shown.kind != "initial" and initial.evaluation.ok else None
    rows = []
    missing = []
    size = size_of_case(case)
    for line in (line.sized(size) for line in _lines(evaluation, case)):
        value = line.value(evaluation)
        if value is None:
            missing.append(line.words)
            continue
        old = line.value(before) if before is not None else None
        text = number_text(value, line.decimals)
        if line.error in evaluation.errors:
            # of the number alone: what two designs have in common falls out of the change
            text += f" ± {number_text(line.scale * evaluation.errors[line.error], line.decimals)}"
        change = Markup("")
        if old is not None:
            text = f"{number_text(old, line.decimals)} → {text}"
            words = change_text(old, value, line.decimals)
            if line.solved:
                own = evaluation.comparison_errors.get(line.error, STATED_ERRORS[evaluation.level])
                words = words.replace(" %", f" ± {100.0 * own:.1f} %")
            tone = "" if not line.solved or words.startswith("0") else "good" if value < old else "bad"
            change = fill('<span class="{}">{}</span>', tone, words)
        rows.append(
            fill(
                '<tr data-headline="{}"><td>{}</td><td><b>{}</b> {}</td><td>{}</td></tr>',
                line.words,
                line.words,
                text,
                line.unit,
                change,
            )
        )
    said = fill('<span class="soft">{}: not stated by the case<br></span>', ", ".join(missing)) if missing else ""
    return fill(
        '<table class="headline">{}</table>{}{}',
        joined(rows),
        _uncalibrated(case, evaluation) + _speeds(case, before, evaluation),
        said,
    )


def _where(standing: Standing, names: Sequence[str]) -> str:
    label = standing.constraint.label
    return label if standing.condition is None else f"{label} at {names[standing.condition]}"


def traffic_lights(case: Case, shown: Shown, names: Sequence[str]) -> Markup:
    """A light for each constraint and condition; what is violated, at its limit or not covered also in words.

    Args:
        case: what asks the constraints.
        shown: the selected design.
        names: of the conditions.
    """
    found = standings(case, shown.evaluation)
    lights, words = [], []
    for standing in found:
        where, state = _where(standing, names), _STATE_WORDS[standing.state]
        lights.append(
            fill(
                '<span class="light {}" data-light="{}" title="{}: {}"><i aria-hidden="true"></i>{}</span>',
                standing.state,
                standing.constraint.name,
                where,
                standing.words or state,
                _short(standing, names),
            )
        )
        if standing.state == UNCOVERED:
            words.append(fill("{} ({})", where, standing.words))
    covered = Markup("")
    if words:
        covered = fill(
            '<p class="standing" data-uncovered="{}">“Feasible” does not cover: {}.</p>',
            len(words),
            joined(words, "; "),
        )
    return fill('<div class="lights">{}</div>{}', joined(lights), covered)


def _short(standing: Standing, names: Sequence[str]) -> str:
    symbol = standing.constraint.symbol
    state = {LIMIT: " limit", VIOLATED: " violated", UNCOVERED: " –"}.get(standing.state, "")
    word = _WORDS.get(standing.constraint.name, symbol)
    return word + ("" if standing.condition is None else f" {names[standing.condition]}") + state


_WORDS = {
    "displacement": "∇",
    "diameter_to_draft": "D/d",
    "cavitation": "blade area",
    "form": "form",
    "propeller_clearance": "clearance",
    "back_cavitation": "cavitation",
    "tip_clearance": "tip",
    "length": "L",
    "breadth": "B",
    "metacentric_height": "GM",
    "engine": "engine",
}
