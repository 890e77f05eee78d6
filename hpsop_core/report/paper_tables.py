"""The paper's four tables for any run: conditions, bounds, designs along the front, operating points."""

from __future__ import annotations

from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.declared_variable import Variable
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.variables import SEARCH_TABLE
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import HULL, OBJECTIVES, free_variables, variable_quantities
from hpsop_core.report.csv_table import Cell, Table
from hpsop_core.report.data import ReportData

_PROPELLER = {"diameter", "blade_count", "pitch_ratio"}
"""Shown where they are fixed, too."""

_DIMENSIONS = ("length", "breadth", "hull_draft", "block_coefficient", "booked_cb")


def conditions_table(case: Case) -> Table:
    """Table 1: operating conditions with their weights."""
    numbers = zip(case.froude_numbers, case.speeds, case.conditions.weights, strict=True)
    return Table(
        "table1",
        "Operating conditions (the paper's Table 1). Froude number and speed of the initial design; "
        + ("the speed is kept." if case.conditions.speeds_are_fixed else "the Froude number is kept."),
        ("condition", "Fn [-]", "V [kn]", "weight [-]"),
        tuple((number, froude, speed / KNOT, weight) for number, (froude, speed, weight) in enumerate(numbers, 1)),
        (0, 4, 2, 2),
    )


def bounds_table(case: Case) -> Table:
    """Table 2: limits of the design variables, in the units that people read."""
    rows: list[tuple[Cell, ...]] = []
    for name, limits in case.bounds.as_dict().items():
        item = SEARCH_TABLE[name]
        values = (*limits, case.bounds.values(case.initial.variables)[name])
        rows.append((f"{item.label} [{item.unit or '-'}]", *(_shown(item, value) for value in values)))
    return Table(
        "table2",
        "Limits of the design variables (the paper's Table 2); where both are the same the variable is not free.",
        ("variable", "lower limit", "upper limit", "initial design"),
        tuple(rows),
    )


def _shown(item: Variable, value: float) -> Cell:
    """A number in the variable's unit; blades are counted."""
    typed = item.typed(value)
    return typed if isinstance(typed, int) else item.shown(typed)


def designs_table(data: ReportData) -> Table:
    """Table 3: the initial design and those spread along the front, with dimensions, free variables and objectives."""
    designs = [record.evaluation for _, record in data.compared() if record.evaluation.ok]
    hull = [q for q in HULL if q.key in _DIMENSIONS and any(q.value(e) is not None for e in designs)]
    free = {quantity.key for quantity in free_variables(data.case)} | _PROPELLER
    # The draft is a dimension and may be a variable: once is enough.
    variables = [q for q in variable_quantities(data.case) if q.key in free - {"draft"}]
    columns = [*hull, *variables, *OBJECTIVES]
    rows: list[tuple[Cell, ...]] = [
        (name, record.id, *(quantity.value(record.evaluation) for quantity in columns))
        for name, record in data.compared()
    ]
    return Table(
        "table3",
        f"Initial design and designs spread along the front, level {data.level or 1} (the paper's Table 3): "
        "dimensions, free variables, objectives.",
        ("design", "number", *(f"{q.symbol.replace(' ', '_')} [{q.unit or '-'}]" for q in columns)),
        tuple(rows),
        (0, 0, *(quantity.decimals for quantity in columns)),
    )


def points_table(data: ReportData) -> Table:
    """Table 4: operating points of the initial and the compromise design."""
    rows: list[tuple[Cell, ...]] = []
    for look, evaluation in data.drawn():
        rows += [(look.name, *point) for point in _points(evaluation)]
    return Table(
        "table4",
        f"Operating points of the initial and the compromise design, level {data.level or 1} (the paper's Table 4).",
        ("design", "Fn [-]", "V [kn]", "Rt [kN]", "J [-]", "N [1/min]", "KT [-]", "10KQ [-]", "eta [-]", "T [kN]",
         "PD [MW]"),
        tuple(rows),
        (0, 4, 2, 0, 4, 2, 4, 4, 4, 0, 2),
    )  # fmt: skip


def _points(evaluation: Evaluation) -> list[tuple[Cell, ...]]:
    def row(c: ConditionResult) -> tuple[Cell, ...]:
        return (
            c.froude_number, c.speed / KNOT, 1e-3 * c.total_resistance, c.advance_coefficient, c.rotation_rate_rpm,
            c.thrust_coefficient, 10.0 * c.torque_coefficient, c.open_water_efficiency, 1e-3 * c.thrust,
            1e-6 * c.delivered_power,
        )  # fmt: skip

    return [row(condition) for condition in evaluation.conditions]
