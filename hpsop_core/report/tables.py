"""The tables of a report: result against initial design, correlations, the whole front, failures, run facts."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.objectives import objective_named
from hpsop_core.case.variables import VARIABLE_NAMES
from hpsop_core.charts.correlations import LEAST_FOR_CORRELATION, correlation_rows, rank_correlations
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import Markup, fill, joined, one_line, symbol_html
from hpsop_core.quantities import (
    CONSTRAINT_GROUP,
    CONSTRAINTS,
    HULL,
    OBJECTIVES,
    PROPELLER,
    SHIP,
    Quantity,
    change_text,
    condition_names,
    condition_quantities,
    free_variables,
    number_text,
    size_of_case,
    variable_quantities,
)
from hpsop_core.report.html_page import Words, facts, paragraph, table, unit_html
from hpsop_core.runs.learning import surface_words
from hpsop_core.runs.records import DesignRecord, Failure, front_families
from hpsop_core.typing_aliases import Array

FAILURES_SHOWN = 40

_IN_RESULT = (
    "froude_number", "speed", "total_resistance", "friction_resistance", "form_resistance", "wave_resistance",
    "correlation_resistance", "air_resistance", "appendage_resistance", "effective_power", "delivered_power",
    "brake_power", "engine_load", "fuel_rate", "open_water_efficiency", "hull_efficiency", "propulsive_efficiency",
    "wake_fraction", "thrust_deduction", "advance_coefficient", "rotation_rate_rpm", "thrust", "torque",
    "required_expanded_area_ratio", "blade_cavitation_margin",
)  # fmt: skip
_ONLY_DIFFERENCES = ("blade_cavitation_margin", "f1", "f2")


def result_quantities(case: Case) -> tuple[Quantity, ...]:
    """The rows of the result table, in their order."""
    size = size_of_case(case)
    conditions = condition_quantities(condition_names(case), size)
    kept = tuple(q for q in conditions if q.key.rsplit("_", 1)[0] in _IN_RESULT)
    variables = variable_quantities(case)
    pitch = tuple(dataclasses.replace(q, group="Propeller") for q in variables if q.key == "pitch_ratio")
    ship = tuple(item.sized(size) for item in (*HULL, *SHIP, *PROPELLER))
    return (*OBJECTIVES, *kept, *ship, *pitch, *CONSTRAINTS)


def _named(quantity: Quantity, case: Case) -> Markup:
    label = quantity.label
    if quantity.key in ("f1", "f2"):
        name = case.objectives.first if quantity.key == "f1" else case.objectives.second
        label = objective_named(name).title
    return fill("{} {} {}", label, symbol_html(quantity.symbol), unit_html(quantity.unit))


def _change(quantity: Quantity, initial: Evaluation, other: Evaluation) -> Markup:
    before, after = quantity.value(initial), quantity.value(other)
    if before is None or after is None:
        return Markup("")
    plain = quantity.key in ("blades", "lcb") or quantity.group == CONSTRAINT_GROUP
    if plain or any(quantity.key.startswith(name) for name in _ONLY_DIFFERENCES):
        words = change_text(before, after, quantity.decimals, relative=False)
    else:
        words = change_text(before, after, quantity.decimals)
    good = quantity.better * (after - before)
    kind = " good" if good > 0 else " bad" if good < 0 else ""
    return fill('<span class="change{}">{}</span>', kind, words)


def result_table(case: Case, initial: DesignRecord, others: Sequence[tuple[str, DesignRecord]]) -> Markup:
    """Initial design and others side by side, with the change against the initial design below each number."""
    head = "{}<br><span class=unit>design {}</span>"
    header: list[Words] = ["", *(fill(head, name, record.id) for name, record in (("initial", initial), *others))]
    rows: list[list[Words]] = []
    group = ""
    for quantity in result_quantities(case):
        values = [quantity.value(record.evaluation) for record in (initial, *(record for _, record in others))]
        if all(value is None for value in values):
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append([group])
        cells: list[Words] = [_with_error(quantity, initial.evaluation)]
        for _, record in others:
            change = _change(quantity, initial.evaluation, record.evaluation)
            cells.append(joined((_with_error(quantity, record.evaluation), change)))
        rows.append([_named(quantity, case), *cells])
    rows.append(["Constraints"])
    kept = ["yes" if record.evaluation.feasible else "no" for record in (initial, *(record for _, record in others))]
    rows.append(["all constraints that apply are kept", *kept])
    solved = {record.evaluation.errors_source for record in (initial, *(record for _, record in others))}
    caption = "Beside each number: change against the initial design at the same level."
    return table(header, rows, caption=f"{caption} {_ERROR_WORDS.get(max(solved), '')}".strip())


_ERROR_WORDS = {
    "solved": "±: half width of the 90 % interval; what all designs share in it (k, wake) falls out of a change.",
    "stated": "±: half width of the 90 % interval, typical of level 2; `hpsop show RUN --refine` solves each its own.",
}


def _with_error(quantity: Quantity, evaluation: Evaluation) -> Words:
    """A number with its half width, where one is stated."""
    error = quantity.error_text(evaluation)
    number = quantity.text(evaluation)
    return joined((number, fill(' <span class="unit">{}</span>', error))) if error else number


def front_table(case: Case, front: Sequence[DesignRecord], marks: Mapping[int, str]) -> Markup:
    """The whole front: objectives, free variables, main numbers of each condition."""
    free = free_variables(case)
    names = ("total_resistance", "open_water_efficiency", "delivered_power")
    size = size_of_case(case)
    conditions = condition_quantities(condition_names(case), size)
    per_condition = [quantity for quantity in conditions if quantity.key.rsplit("_", 1)[0] in names]
    length = [quantity.sized(size) for quantity in HULL if quantity.key == "length"]
    columns = [*OBJECTIVES, *free, *length, *per_condition]
    belongs, _ = front_families(front)
    header: list[Words] = ["design", ""]
    header += [fill("{}<br>{}", symbol_html(q.symbol), unit_html(q.unit)) for q in columns]
    header.append("family")
    rows = [
        [
            str(record.id),
            marks.get(record.id, ""),
            *(joined((_with_error(q, record.evaluation), _side(record, q.key))) for q in columns),
            str(family),
        ]
        for record, family in zip(front, belongs, strict=True)
    ]
    marked = [index for index, record in enumerate(front) if record.id in marks]
    caption = (
        "↓, ↑: on its lower, upper bound. Designs of one family cannot be told apart by the error of their numbers."
    )
    return table(header, rows, words=(1,), marked=marked, wide=True, caption=caption)


def _side(record: DesignRecord, key: str) -> Words:
    side = record.evaluation.active_bounds.get(key)
    return "" if side is None else Markup("&nbsp;↓" if side == "lower" else "&nbsp;↑")


def correlation_table(case: Case, evaluations: Sequence[Evaluation]) -> Markup:
    """Spearman's correlations, tinted by strength; a sentence where there are too few designs."""
    if len(evaluations) < LEAST_FOR_CORRELATION:
        return paragraph(f"Fewer than {LEAST_FOR_CORRELATION} designs have been evaluated: no correlations yet.")

    def column(quantity: Quantity) -> Array:
        values = [quantity.value(evaluation) for evaluation in evaluations]
        return np.array([np.nan if value is None else value for value in values])

    found = rank_correlations(case, column)
    return table(
        ["variable", *(symbol_html(quantity.symbol) for quantity in found.results)],
        correlation_rows(found, lambda quantity: fill("{} {}", quantity.label, symbol_html(quantity.symbol))),
        caption=f"Spearman's rank correlation [–] over {len(evaluations)} designs of level {evaluations[0].level}",
    )


def failure_table(failures: Sequence[Failure]) -> Markup:
    """Failed evaluations: how many at which stage, then one by one with reason and variables."""
    stages = Counter((failure.level, failure.stage) for failure in failures)
    counts = table(
        ["stage", "level", "failed"],
        [[stage or "–", str(level), str(count)] for (level, stage), count in sorted(stages.items())],
    )
    rows = [
        [
            str(failure.id),
            str(failure.level),
            str(failure.generation),
            failure.stage or "–",
            one_line(failure.reason),
            ", ".join(f"{value:.5g}" for value in failure.variables.key()),
        ]
        for failure in failures[:FAILURES_SHOWN]
    ]
    caption = f"The first {len(rows)} of {len(failures)}. Variables in this order: " + ", ".join(VARIABLE_NAMES)
    header = ["design", "level", "generation", "stage", "reason", "variables"]
    return counts + table(header, rows, caption=caption, words=(3, 4, 5), wide=True)


def duration(seconds: float) -> str:
    """h:mm:ss."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} h"


def run_facts(summary: Mapping[str, Any], failed: int) -> Markup:
    """How the numbers came about."""
    done, asked = summary["generation"], summary["generations"]
    by_level = summary["generations_by_level"]
    parts = [f"level {level}: {count}" for level, count in sorted(by_level.items())]
    rows = []
    for level, numbers in summary["evaluations"].items():
        each = numbers["processor_seconds"] / max(1, numbers["count"])
        rows.append(
            [
                str(level),
                str(by_level.get(level, 0)),
                number_text(numbers["count"], 0),
                number_text(numbers["feasible"], 0),
                number_text(numbers["failed"], 0),
                duration(summary["wall_seconds"].get(level, 0.0)),
                number_text(each, 3),
            ]
        )
    versions = ", ".join(f"{name} {value}" for name, value in summary["versions"].items())
    state = str(summary["state"]) + (f": {summary['reason']}" if summary["reason"] else "")
    journal = [one_line(f"{entry['at']}: {entry['text']}") for entry in summary["journal"]]
    pairs: list[tuple[Words, Words]] = [
        ("run file", one_line(summary["run"])),
        ("state", one_line(state)),
        ("begun", str(summary["created"])),
        ("seed", str(summary["seed"])),
        ("population", str(summary["population"])),
        ("generations", f"{done} of {asked}" + (f" ({', '.join(parts)})" if parts else "")),
        ("failed evaluations", number_text(failed, 0)),
        ("designs made by hand", str(summary["designs_by_hand"])),
        ("versions", versions),
    ]
    if "surface" in summary:
        pairs.append(("learnt surface", surface_words(summary)))
    if journal:
        pairs.append(("journal", joined(journal[-6:], "<br>")))
    header = ["level", "generations", "evaluations", "feasible", "failed", "wall time", "seconds each"]
    return facts(pairs) + (table(header, rows, caption="Evaluations") if rows else Markup(""))
