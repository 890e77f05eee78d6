"""The tables of a report: result against initial design, correlations, the whole front, failures, run facts."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import rankdata

from hpsop_core.case.case import Case
from hpsop_core.case.variables import VARIABLE_NAMES
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import (
    HULL,
    OBJECTIVE_TITLES,
    OBJECTIVES,
    PROPELLER,
    Quantity,
    change_text,
    condition_quantities,
    free_variables,
    number_text,
    variable_quantities,
    violated,
)
from hpsop_core.report.html_page import facts, symbol, table, text
from hpsop_core.runs.records import DesignRecord, Failure
from hpsop_core.typing_aliases import Array

LEAST_FOR_CORRELATION = 10
FAILURES_SHOWN = 40

_IN_RESULT = (
    "froude_number", "speed", "total_resistance", "wave_resistance", "delivered_power", "open_water_efficiency",
    "advance_coefficient", "rotation_rate_rpm", "thrust", "torque", "required_expanded_area_ratio",
    "blade_cavitation_margin",
)  # fmt: skip
_ONLY_DIFFERENCES = ("blade_cavitation_margin", "f1", "f2")


def result_quantities(case: Case) -> tuple[Quantity, ...]:
    """The rows of the result table, in their order."""
    conditions = condition_quantities(case.conditions.froude_numbers)
    kept = tuple(q for q in conditions if q.key.rsplit("_", 1)[0] in _IN_RESULT)
    variables = variable_quantities(case.initial.variables)
    pitch = tuple(dataclasses.replace(q, group="Propeller") for q in variables if q.key == "pitch_ratio")
    return (*OBJECTIVES, *kept, *HULL, *PROPELLER, *pitch)


def _named(quantity: Quantity, case: Case) -> str:
    label = quantity.label
    if quantity.key in ("f1", "f2"):
        name = case.objectives.first if quantity.key == "f1" else case.objectives.second
        label = OBJECTIVE_TITLES[name]
    return f"{text(label)} {symbol(quantity.symbol)} <span class=unit>[{text(quantity.unit or '–')}]</span>"


def _change(quantity: Quantity, initial: Evaluation, other: Evaluation) -> str:
    before, after = quantity.value(initial), quantity.value(other)
    if before is None or after is None:
        return ""
    if quantity.key in ("blades",):
        words = change_text(before, after, 0, relative=False)
    elif any(quantity.key.startswith(name) for name in _ONLY_DIFFERENCES):
        words = change_text(before, after, quantity.decimals, relative=False)
    else:
        words = change_text(before, after, quantity.decimals)
    good = quantity.better * (after - before)
    kind = " good" if good > 0 else " bad" if good < 0 else ""
    return f'<span class="change{kind}">{text(words)}</span>'


def result_table(case: Case, initial: DesignRecord, others: Sequence[tuple[str, DesignRecord]]) -> str:
    """Initial design and others side by side, with the change against the initial design below each number."""
    header = ["", f"initial<br><span class=unit>design {initial.id}</span>"]
    header += [f"{text(name)}<br><span class=unit>design {record.id}</span>" for name, record in others]
    rows: list[list[str]] = []
    group = ""
    for quantity in result_quantities(case):
        values = [quantity.value(record.evaluation) for record in (initial, *(record for _, record in others))]
        if all(value is None for value in values):
            continue
        if quantity.group != group:
            group = quantity.group
            rows.append([text(group)])
        cells = [quantity.text(initial.evaluation)]
        cells += [
            f"{quantity.text(record.evaluation)}{_change(quantity, initial.evaluation, record.evaluation)}"
            for _, record in others
        ]
        rows.append([_named(quantity, case), *cells])
    rows.append(["Constraints"])
    kept = ["yes" if record.evaluation.feasible else "no" for record in (initial, *(record for _, record in others))]
    rows.append(["all constraints that apply are kept", *kept])
    return table(header, rows, caption="Beside each number: change against the initial design at the same level")


def broken_constraints(evaluation: Evaluation) -> list[str]:
    """Violated constraints in words; markup."""
    return [text(line) for line in violated(evaluation)]


def front_table(case: Case, front: Sequence[DesignRecord], marks: Mapping[int, str]) -> str:
    """The whole front: objectives, free variables, main numbers of each condition."""
    free = free_variables(case)
    names = ("total_resistance", "open_water_efficiency", "delivered_power")
    per_condition = [
        quantity
        for quantity in condition_quantities(case.conditions.froude_numbers)
        if quantity.key.rsplit("_", 1)[0] in names
    ]
    length = [quantity for quantity in HULL if quantity.key == "length"]
    columns = [*OBJECTIVES, *free, *length, *per_condition]
    header = ["design", ""]
    header += [f"{symbol(q.symbol)}<br><span class=unit>[{text(q.unit or '–')}]</span>" for q in columns]
    rows = [
        [str(record.id), text(marks.get(record.id, "")), *(q.text(record.evaluation) for q in columns)]
        for record in front
    ]
    marked = [index for index, record in enumerate(front) if record.id in marks]
    return table(header, rows, words=(1,), marked=marked, wide=True)


def rank_correlation(first: Array, second: Array) -> float | None:
    """Spearman's rho of the pairs (n,) that are finite; None for too few, or when one of them does not vary."""
    keep = np.isfinite(first) & np.isfinite(second)
    if np.count_nonzero(keep) < LEAST_FOR_CORRELATION:
        return None
    a, b = (rankdata(values[keep]) for values in (first, second))
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else None


def correlations(case: Case, evaluations: Sequence[Evaluation]) -> tuple[list[Quantity], list[Quantity], list[Any]]:
    """(free variables, results, rho by row and column) over evaluations of one level that did not fail."""
    free = free_variables(case)
    wanted = ("total_resistance_1", "open_water_efficiency_1", "delivered_power_1", "required_expanded_area_ratio_1")
    conditions = {quantity.key: quantity for quantity in condition_quantities(case.conditions.froude_numbers)}
    results = [*OBJECTIVES, *(conditions[key] for key in wanted)]

    def column(quantity: Quantity) -> Array:
        values = [quantity.value(evaluation) for evaluation in evaluations]
        return np.array([np.nan if value is None else value for value in values])

    columns = {quantity.key: column(quantity) for quantity in (*free, *results)}
    rho = [[rank_correlation(columns[row.key], columns[item.key]) for item in results] for row in free]
    return free, results, rho


def correlation_table(case: Case, evaluations: Sequence[Evaluation]) -> str:
    """Spearman's correlations, tinted by strength; a sentence where there are too few designs."""
    if len(evaluations) < LEAST_FOR_CORRELATION:
        return f"<p>Fewer than {LEAST_FOR_CORRELATION} designs have been evaluated: no correlations yet.</p>"
    free, results, rho = correlations(case, evaluations)
    rows = []
    for quantity, row in zip(free, rho, strict=True):
        cells = []
        for value in row:
            if value is None:
                cells.append("–")
                continue
            colour = "163, 38, 42" if value > 0 else "31, 95, 168"
            words = f"{'+' if value > 0 else '−'}{abs(value):.2f}"
            tint = f"background: rgba({colour}, {0.55 * abs(value):.2f})"
            cells.append(f'<span style="display: block; padding: 0 .3rem; {tint}">{words}</span>')
        rows.append([f"{text(quantity.label)} {symbol(quantity.symbol)}", *cells])
    return table(
        ["variable", *(symbol(quantity.symbol) for quantity in results)],
        rows,
        caption=f"Spearman's rank correlation [–] over {len(evaluations)} designs of level {evaluations[0].level}",
    )


def failure_table(failures: Sequence[Failure]) -> str:
    """Failed evaluations: how many at which stage, then one by one with reason and variables."""
    stages = Counter((failure.level, failure.stage) for failure in failures)
    counts = table(
        ["stage", "level", "failed"],
        [[text(stage or "–"), str(level), str(count)] for (level, stage), count in sorted(stages.items())],
    )
    rows = [
        [
            str(failure.id),
            str(failure.level),
            str(failure.generation),
            text(failure.stage or "–"),
            text(failure.reason),
            text(", ".join(f"{value:.5g}" for value in failure.variables.key())),
        ]
        for failure in failures[:FAILURES_SHOWN]
    ]
    caption = f"The first {len(rows)} of {len(failures)}. Variables in this order: " + ", ".join(VARIABLE_NAMES)
    header = ["design", "level", "generation", "stage", "reason", "variables"]
    return counts + table(header, rows, caption=text(caption), words=(3, 4, 5), wide=True)


def duration(seconds: float) -> str:
    """h:mm:ss."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} h"


def run_facts(summary: Mapping[str, Any], failed: int) -> str:
    """How the numbers came about."""
    done, asked = summary["generation"], summary["generations"]
    by_level = summary["generations_by_level"]
    parts = [f"level {text(level)}: {count}" for level, count in sorted(by_level.items())]
    rows = []
    for level, numbers in summary["evaluations"].items():
        each = numbers["processor_seconds"] / max(1, numbers["count"])
        rows.append(
            [
                text(level),
                str(by_level.get(level, 0)),
                number_text(numbers["count"], 0),
                number_text(numbers["feasible"], 0),
                number_text(numbers["failed"], 0),
                duration(summary["wall_seconds"].get(level, 0.0)),
                number_text(each, 3),
            ]
        )
    versions = ", ".join(f"{text(name)} {text(value)}" for name, value in summary["versions"].items())
    state = text(summary["state"]) + (f": {text(summary['reason'])}" if summary["reason"] else "")
    journal = [f"{text(entry['at'])}: {text(entry['text'])}" for entry in summary["journal"]]
    pairs = [
        ("run file", text(summary["run"])),
        ("state", state),
        ("begun", text(summary["created"])),
        ("seed", str(summary["seed"])),
        ("population", str(summary["population"])),
        ("generations", f"{done} of {asked}" + (f" ({', '.join(parts)})" if parts else "")),
        ("failed evaluations", number_text(failed, 0)),
        ("designs made by hand", str(summary["designs_by_hand"])),
        ("versions", versions),
    ]
    if journal:
        pairs.append(("journal", "<br>".join(journal[-6:])))
    header = ["level", "generations", "evaluations", "feasible", "failed", "wall time", "seconds each"]
    return facts(pairs) + (table(header, rows, caption="Evaluations") if rows else "")
