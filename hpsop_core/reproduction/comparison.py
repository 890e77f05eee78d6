"""The paper's tables beside a run of its case: every number as a value, before anything is written."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hpsop_core.case.case import Case, load_case
from hpsop_core.errors import InputError
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.levels import FAST, LEVEL_NUMBERS
from hpsop_core.evaluation.propeller_answer import (
    blade_drag,
    build_propeller,
    propeller_answer,
    propeller_variables,
)
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.shapes import initial_volume
from hpsop_core.hydro import cavitation
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.report.csv_table import Cell, Table
from hpsop_core.report.data import ReportData
from hpsop_core.reproduction import paper
from hpsop_core.reproduction.paper import CASE_NAME, PaperDesign, PaperPoint
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord

TABLE4_QUANTITIES = ("Rt [kN]", "J [-]", "N [1/min]", "KT [-]", "10KQ [-]", "eta [-]", "T [kN]", "PD [MW]")
TABLE4_DIGITS = (0, 3, 2, 4, 4, 4, 0, 1)
"""Decimals of each on a page."""


def is_of_the_paper(run: RunReader) -> bool:
    """Whether a run is one of the paper's case as it is shipped; population, generations and seed may differ."""
    own, stored = load_case(CASE_NAME), run.case.optimization
    settings = {name: getattr(stored, name) for name in ("population", "generations", "level1_generations", "seed")}
    return own.replaced("optimization", **settings) == run.case


def checked_run(run: RunReader) -> RunReader:
    """The run, if it is one of the paper's case.

    Raises:
        InputError: it is a run of another case.
    """
    if not is_of_the_paper(run):
        raise InputError(
            f"{run.path}: holds a run of the case '{run.case.name}', not of '{CASE_NAME}' as it is shipped; choose "
            f"another folder, or show this run with --run {run.path}"
        )
    return run


@dataclass(frozen=True, eq=False)
class Reproduction:
    """Everything that is compared.

    Attributes:
        report: a run of the paper's case, as a report of it sees it.
        level: of the last generation (1 while there is none).
        initial: at that level.
    """

    report: ReportData
    level: int
    initial: DesignRecord

    @classmethod
    def of(cls, run: RunReader) -> Reproduction:
        """The run as it is now.

        Raises:
            InputError: not a run of the paper's case, or one that has evaluated nothing.
        """
        report = ReportData.of(checked_run(run))
        level = 1 if report.level is None else report.level
        return cls(report, level, run.initial(level))

    @property
    def run(self) -> RunReader:
        """Of the paper's case."""
        return self.report.run

    @property
    def case(self) -> Case:
        """The paper's."""
        return self.report.case

    @property
    def chosen(self) -> tuple[tuple[str, DesignRecord], ...]:
        """(R1 to R5, design) of our front, ascending in f1; fewer where the front is smaller."""
        return self.report.spread

    @property
    def compromise(self) -> DesignRecord | None:
        """Of our front; None where it is empty."""
        return self.report.compromise

    def reference(self, level: int) -> Reference:
        """What normalises at a level.

        Raises:
            SolverFailure: the initial design cannot be computed there.
        """
        return self.report.reference(level)

    def designs(self) -> list[tuple[str, Evaluation]]:
        """Our initial design and those chosen, each with its name."""
        return [("initial", self.initial.evaluation), *((name, item.evaluation) for name, item in self.chosen)]


# -- the paper's tables beside ours --------------------------------------------------------------------------------


def tables(data: Reproduction) -> tuple[Table, ...]:
    """All tables, in the order of the page.

    Raises:
        SolverFailure: a curve of the paper's designs cannot be computed.
    """
    return (
        table1(data.case), table2(data.case), table3(data), table4(data), paper_designs(data), propellers(data),
        audit(data), resistance_audit(data),
    )  # fmt: skip


def table1(case: Case) -> Table:
    """Conditions and weights."""
    ours = list(zip(case.froude_numbers, case.conditions.weights, strict=True))
    rows = tuple(
        (f"condition {number}", froude, mine[0], weight, mine[1])
        for number, ((froude, weight), mine) in enumerate(zip(paper.table1(), ours, strict=True), start=1)
    )
    return Table(
        "table1",
        "The paper's Table 1: operating conditions.",
        ("condition", "Fn paper [-]", "Fn ours [-]", "weight paper [-]", "weight ours [-]"),
        rows,
    )


def table2(case: Case) -> Table:
    """Bounds."""
    ours = case.bounds.as_dict()
    rows = tuple(
        (name, low, float(ours[name][0]), high, float(ours[name][1])) for name, (low, high) in paper.table2().items()
    )
    low, high = ours["displacement_ratio"]
    return Table(
        "table2",
        "The paper's Table 2: limits of the design variables. Ours have one more, without which no optimum could lie\n"
        f"below the initial displacement as the paper's do: displacement_ratio {low:g} to {high:g}.",
        ("variable", "lower paper", "lower ours", "upper paper", "upper ours"),
        rows,
    )


def table3(data: Reproduction) -> Table:
    """Main particulars of the paper's designs and of ours."""
    rows: list[tuple[Cell, ...]] = [
        (
            f"paper {d.name}", d.length, d.breadth, d.draft, d.block_coefficient, d.blade_count, d.diameter,
            d.pitch_ratio, d.f1, d.f2,
        )
        for d in paper.table3()
    ]  # fmt: skip
    for name, e in data.designs():
        v = e.variables
        booked = e.hull.booked_block_coefficient if e.ok else None
        words = name
        if data.compromise is not None and dict(data.chosen).get(name) is data.compromise:
            words = f"{name} (compromise)"
        rows.append(
            (
                f"ours {words}",
                v.length,
                v.breadth,
                v.draft,
                booked,
                v.blade_count,
                v.diameter,
                v.pitch_ratio,
                e.objectives["f1"],
                e.objectives["f2"],
            )
        )
    return Table(
        "table3",
        f"The paper's Table 3 and ours (level {data.level}): initial and optimal designs. CB is booked, there as here.",
        ("design", "L [m]", "B [m]", "d [m]", "CB [-]", "Z [-]", "D [m]", "P/D multiplier [-]", "f1 [-]", "f2 [-]"),
        tuple(rows),
    )


def table4(data: Reproduction) -> Table:
    """Operating points of initial and compromise design."""
    ours = {paper.INITIAL: data.initial.evaluation}
    if data.compromise is not None:
        ours[paper.COMPROMISE] = data.compromise.evaluation
    density = data.case.constants.density
    rows: list[tuple[Cell, ...]] = []
    for name, words in ((paper.INITIAL, "initial"), (paper.COMPROMISE, "compromise")):
        points = paper.points_of(name)
        conditions = ours[name].conditions if name in ours else ()
        for number, point in enumerate(points):
            c = conditions[number] if number < len(conditions) else None
            theirs = (
                1e-3 * point.total_resistance, point.advance_coefficient, point.rotation_rate_rpm,
                point.thrust_coefficient, point.ten_torque_coefficient, point.open_water_efficiency,
                1e-3 * point.thrust(density), 1e-6 * point.delivered_power(density),
            )  # fmt: skip
            mine: tuple[float | None, ...] = (None,) * len(theirs)
            if c is not None:
                mine = (
                    1e-3 * c.total_resistance, c.advance_coefficient, c.rotation_rate_rpm, c.thrust_coefficient,
                    10.0 * c.torque_coefficient, c.open_water_efficiency, 1e-3 * c.thrust, 1e-6 * c.delivered_power,
                )  # fmt: skip
            rows += [
                (words, point.froude_number, quantity, given, own, None if own is None else own / given)
                for quantity, given, own in zip(TABLE4_QUANTITIES, theirs, mine, strict=True)
            ]
    return Table(
        "table4",
        f"The paper's Table 4 and ours (level {data.level}); T and PD of the paper follow from its KT, KQ and N.",
        ("design", "Fn [-]", "quantity", "paper", "ours", "ours / paper [-]"),
        tuple(rows),
    )


# -- the paper's designs in our physics ----------------------------------------------------------------------------


def evaluated(data: Reproduction, design: PaperDesign, level: int) -> Evaluation:
    """A design of the paper's Table 3 at a level of ours."""
    variables = design.variables(data.case, initial_volume(data.case))
    return evaluate(data.case, variables, level, data.reference(level))


def paper_designs(data: Reproduction) -> Table:
    """The paper's designs with our physics at both levels."""
    rows: list[tuple[Cell, ...]] = []
    for design in paper.table3():
        values: list[Cell] = []
        for level in LEVEL_NUMBERS:
            e = evaluated(data, design, level)
            power: list[float | None] = [c.delivered_power / 1e6 for c in e.conditions]
            power = power or [None, None]
            values += [e.objectives["f1"], e.objectives["f2"], *power, "yes" if e.feasible else "no"]
        rows.append((design.name, design.f1, design.f2, *values))
    one = ("f1 {} [-]", "f2 {} [-]", "PD1 {} [MW]", "PD2 {} [MW]", "feasible {}")
    header = [name.format(f"level {level}") for level in LEVEL_NUMBERS for name in one]
    return Table(
        "paper_designs",
        "The designs of the paper's Table 3 computed with hpsop's case dtc-p4119-paper, each level normalised by our "
        "initial design.",
        ("design", "f1 paper [-]", "f2 paper [-]", *header),
        tuple(rows),
    )


def propellers(data: Reproduction) -> Table:
    """KT, 10KQ and efficiency of our propellers at the paper's J."""
    rows: list[tuple[Cell, ...]] = []
    volume = initial_volume(data.case)
    for point in paper.table4():
        key = propeller_variables(data.case.propeller, point.design.variables(data.case, volume))
        j = point.advance_coefficient
        rows.append(
            (
                point.design.name,
                j,
                "paper",
                point.thrust_coefficient,
                point.ten_torque_coefficient,
                point.open_water_efficiency,
                None,
                None,
                None,
            )
        )
        for level in LEVEL_NUMBERS:
            kt, kq = propeller_answer(key, level, blade_drag(data.case.constants)).curve.coefficients(j)
            ours = (float(kt), 10.0 * float(kq), j * float(kt) / (2.0 * math.pi * float(kq)))
            theirs = (point.thrust_coefficient, point.ten_torque_coefficient, point.open_water_efficiency)
            off = tuple(100.0 * (mine / given - 1.0) for mine, given in zip(ours, theirs, strict=True))
            rows.append((point.design.name, j, f"level {level}", *ours, *off))
    return Table(
        "propeller_at_paper_j",
        "Open water at the paper's advance coefficients: the paper's Table 4 and our propeller of the same Z, D\n"
        "and pitch multiplier, EAR kept at 0.607, full scale.",
        (
            "design",
            "J [-]",
            "source",
            "KT [-]",
            "10KQ [-]",
            "eta [-]",
            "KT off [%]",
            "10KQ off [%]",
            "eta off [%]",
        ),
        tuple(rows),
    )


def thrust_with_absolute_pitch(data: Reproduction, point: PaperPoint) -> float:
    """Level 1's KT at the point's J if the printed P/D were the absolute one at 0.7 R."""
    parent = data.case.initial.variables
    absolute = build_propeller(propeller_variables(data.case.propeller, parent)).pitch_diameter_ratio_07R
    changed = parent.replaced({"pitch_ratio": point.design.pitch_ratio * parent.pitch_ratio / absolute})
    key = propeller_variables(data.case.propeller, changed)
    answer = propeller_answer(key, 1, blade_drag(data.case.constants))
    return float(answer.curve.coefficients(point.advance_coefficient)[0])


def audit(data: Reproduction) -> Table:
    """What the paper's Table 4 implies by itself."""
    density = data.case.constants.density
    rows = tuple(
        (
            point.design.name, point.froude_number, point.speed, point.implied_wake, point.fitted_wake,
            point.recomputed_efficiency, point.open_water_efficiency, point.thrust(density) / 1e3,
            point.total_resistance / 1e3, point.thrust(density) / point.total_resistance,
            point.implied_deduction(density), point.delivered_power(density) / 1e6, point.effective_power / 1e6,
            _keller(data.case, point),
        )
        for point in paper.table4()
    )  # fmt: skip
    return Table(
        "table4_audit",
        f"What the paper's Table 4 implies with rho {density:g} kg/m3, g {paper.PAPER_GRAVITY:g} m/s2, Keller's K = 0.",
        (
            "design",
            "Fn [-]",
            "V [m/s]",
            "w implied [-]",
            "w of Taylor's table [-]",
            "eta recomputed [-]",
            "eta printed [-]",
            "T [kN]",
            "Rt [kN]",
            "T/Rt [-]",
            "t implied [-]",
            "PD [MW]",
            "PE = Rt V [MW]",
            "EAR by Keller [-]",
        ),
        rows,
    )


def _keller(case: Case, point: PaperPoint) -> float:
    """Least expanded area ratio for the printed thrust, K = 0, shaft where ours is."""
    constants, design = case.constants, point.design
    shaft = 5.0 * design.draft / 14.5
    margin = cavitation.pressure_margin(
        design.draft - shaft, constants.density, constants.gravity, constants.atmospheric_pressure,
        constants.vapour_pressure,
    )  # fmt: skip
    thrust = point.thrust(constants.density)
    return cavitation.keller_expanded_area_ratio(design.blade_count, thrust, design.diameter, margin, 0.0)


def wave_part(data: Reproduction, point: PaperPoint) -> tuple[float, float]:
    """(Rw in N, Cw) that the paper's Rt leaves after ITTC-57 friction on our wetted surface of its dimensions."""
    initial = point.design.name == paper.INITIAL
    evaluation = data.initial.evaluation if initial else evaluated(data, point.design, FAST.number)
    if not evaluation.ok:
        raise InputError(f"the paper's {point.design.name} cannot be built; report this")
    hull = evaluation.hull
    constants = data.case.constants
    dynamic = 0.5 * constants.density * point.speed**2 * hull.wetted_surface
    friction = ittc57_coefficient(point.speed * point.design.length / constants.viscosity) * dynamic
    wave = point.total_resistance - (1.0 + constants.form_factor) * friction
    return wave, wave / dynamic


def resistance_audit(data: Reproduction) -> Table:
    """The paper's resistance beside ours at both levels, for its two designs of Table 4."""
    rows: list[tuple[Cell, ...]] = []
    for name in (paper.INITIAL, paper.COMPROMISE):
        points = paper.points_of(name)
        ours = {level: evaluated(data, points[0].design, level).conditions for level in LEVEL_NUMBERS}
        for number, point in enumerate(points):
            _, coefficient = wave_part(data, point)
            row: list[Cell] = [name, point.froude_number, point.total_resistance / 1e3, 1e4 * coefficient]
            for level in LEVEL_NUMBERS:
                c = ours[level][number] if number < len(ours[level]) else None
                row += [None, None] if c is None else [c.total_resistance / 1e3, 1e4 * c.wave_coefficient]
            rows.append(tuple(row))
    return Table(
        "resistance_audit",
        "Total resistance, and the wave coefficient on 1/2 rho V^2 S; the paper's is what its Rt leaves after ITTC-57\n"
        "friction. In the tank the DTC has Cw 3.36e-4 at Fn 0.218 (assets/reference/dtc_resistance.csv).",
        (
            "design",
            "Fn [-]",
            "Rt paper [kN]",
            "10^4 Cw paper [-]",
            "Rt level 1 [kN]",
            "10^4 Cw level 1 [-]",
            "Rt level 2 [kN]",
            "10^4 Cw level 2 [-]",
        ),
        tuple(rows),
    )
