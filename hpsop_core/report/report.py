"""A run as one HTML file for people who will not start hpsop: what was asked, what came out, how far to trust it."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.curves import hull_lines, resistance_points, thrust_curves
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.quantities import change_text, number_text, objective_title
from hpsop_core.report import charts
from hpsop_core.report.charts import COMPROMISE_LOOK, INITIAL_LOOK, Look, Point
from hpsop_core.report.figures import figure_html
from hpsop_core.report.html_page import Section, bullets, page, pair, text, write_whole
from hpsop_core.report.tables import (
    broken_constraints,
    correlation_table,
    failure_table,
    front_table,
    result_table,
    run_facts,
)
from hpsop_core.report.words import assumptions, trust
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord
from hpsop_core.typing_aliases import Array
from hpsop_core.version import __version__

CHART_ABOVE = 0.03
"""Resistance is drawn this far above the greatest Froude number: beyond, the curve would dwarf the working range."""


@dataclass(frozen=True, eq=False)
class ReportData:
    """What a report draws from, at one moment of a run.

    Attributes:
        run: the run.
        generations: finished ones.
        initial: at the last generation's level; None while it is not evaluated.
        front: of the last generation, ascending in f1.
        compromise, knee: None where the front is empty.
    """

    run: RunReader
    generations: tuple[Generation, ...]
    initial: DesignRecord | None
    front: tuple[DesignRecord, ...]
    compromise: DesignRecord | None
    knee: DesignRecord | None

    @classmethod
    def of(cls, run: RunReader) -> ReportData:
        """The run as it is now."""
        generations = run.generations()
        last = generations[-1] if generations else None
        front = run.designs(last.front) if last is not None else ()
        by_id = {record.id: record for record in front}
        try:
            initial = run.initial(1 if last is None else last.level)
        except InputError:
            initial = None
        return cls(
            run=run,
            generations=generations,
            initial=initial,
            front=front,
            compromise=None if last is None or last.compromise is None else by_id[last.compromise],
            knee=None if last is None or last.knee is None else by_id[last.knee],
        )

    @property
    def case(self) -> Case:
        """The run's."""
        return self.run.case

    @property
    def level(self) -> int | None:
        """Of the last generation."""
        return self.generations[-1].level if self.generations else None

    def chosen(self) -> list[tuple[str, DesignRecord]]:
        """Compromise, knee and both ends of the front; a design that is several of these comes once, with all names."""
        if not self.front:
            return []
        named = [("compromise", self.compromise), ("knee", self.knee)]
        named += [("best f₁", self.front[0]), ("best f₂", self.front[-1])]
        names: dict[int, str] = {}
        for name, record in named:
            if record is not None:
                names[record.id] = f"{names[record.id]}, {name}" if record.id in names else name
        records = {record.id: record for record in self.front}
        return [(words, records[number]) for number, words in names.items()]

    def marks(self) -> dict[int, str]:
        """What the front's table calls the chosen ones."""
        return {record.id: name for name, record in self.chosen()}

    def drawn(self) -> list[tuple[Look, Evaluation]]:
        """The designs of the comparing charts."""
        pairs = [(INITIAL_LOOK, self.initial), (COMPROMISE_LOOK, self.compromise)]
        return [(look, record.evaluation) for look, record in pairs if record is not None and record.evaluation.ok]

    @cached_property
    def resistance(self) -> list[tuple[Look, tuple[ResistancePoint, ...], Evaluation]]:
        """Resistance over Froude number of the drawn designs.

        Raises:
            SolverFailure: one cannot be computed.
        """
        return [
            (look, resistance_points(self.case, evaluation, self.reference(evaluation.level), CHART_ABOVE), evaluation)
            for look, evaluation in self.drawn()
        ]

    def reference(self, level: int) -> Reference:
        """What normalises and calibrates at a level.

        Raises:
            SolverFailure: it is not in the file and cannot be computed.
        """
        stored = self.run.reference(level)
        return reference_for(self.case, level) if stored is None else Reference.from_dict(stored)


def report_html(run: RunReader) -> str:
    """The report's text."""
    data = ReportData.of(run)
    summary = run.summary()
    failures = run.failures()
    sections = [
        Section("result", "Result", _result(data)),
        Section("pareto", "Trade-off and search", _search(data)),
        Section("propulsion", "Propeller and resistance", _propulsion(data)),
        Section("form", "Hull form", _form(data)),
        Section("drivers", "What drives what", _drivers(data)),
        Section("trust", "How far to trust these numbers", trust(data.case, data.level)),
        Section("assumptions", "What was asked", assumptions(data.case)),
        Section("front", "The whole front", _front(data)),
        Section("run", "The run", run_facts(summary, len(failures))),
        Section(
            "failures",
            "Failed evaluations",
            failure_table(failures) if failures else "<p>No evaluation failed.</p>",
        ),
    ]
    footer = f"hpsop {__version__}, report of {time.strftime('%Y-%m-%d %H:%M')}"
    return page(data.case.title or data.case.name, _head(data, summary), sections, footer)


def write_report(run: RunReader, target: str | Path, force: bool = False) -> Path:
    """Write a run's report as one HTML file.

    Args:
        run: finished or not.
        target: the file.
        force: replace it if it is there.

    Raises:
        InputError: a file that may not or cannot be written.
    """
    path = Path(target)
    if path.is_dir():
        raise InputError(f"{path}: is a folder; --to needs a file, for example {path / 'report.html'}")
    if path.suffix == ".hpsop" or (path.exists() and path.samefile(run.path)):
        raise InputError(f"{path}: is a run file's name; --to needs another one, for example report.html")
    if path.exists() and not force:
        raise InputError(f"{path}: is there already; give --force to replace it, or another name")
    write_whole(path, report_html(run))
    return path


def _head(data: ReportData, summary: dict[str, object]) -> str:
    parts = [
        f'<p class="soft">Case {text(data.case.name)}: {text(data.case.objectives.first.replace("_", " "))} against '
        f"{text(data.case.objectives.second.replace('_', ' '))}, hull and propeller optimised together. "
        f"{text(data.case.description)}</p>"
    ]
    if summary["state"] != "finished":
        reason = f" ({text(summary['reason'])})" if summary["reason"] else ""
        parts.append(
            f'<p class="banner"><strong>This run is not finished</strong>: {text(summary["state"])}{reason}, '
            f"generation {summary['generation']} of {summary['generations']}. What stands here is what it has found so "
            "far.</p>"
        )
    if data.level == 1:
        parts.append(
            '<p class="banner">All results are of <strong>level 1</strong>, the fast and rough one; see “How far to '
            "trust these numbers”.</p>"
        )
    return "".join(parts)


def _result(data: ReportData) -> str:
    if data.initial is None:
        return "<p>Nothing is evaluated yet, not even the initial design.</p>"
    chosen = data.chosen()
    parts = []
    if data.compromise is not None:
        parts.append(_in_short(data, data.initial.evaluation, data.compromise))
    elif data.generations:
        share = 100.0 * data.generations[-1].feasible_share
        parts.append(
            f'<p class="banner"><strong>There is no feasible design on the front</strong> in generation '
            f"{data.generations[-1].number} ({number_text(share, 0)} % of the population is feasible), so there is no "
            "compromise either. Widen the bounds, loosen the constraints, or let the search go on.</p>"
        )
    else:
        parts.append('<p class="banner">No generation is finished yet; only the initial design is known.</p>')
    broken = broken_constraints(data.initial.evaluation)
    if broken:
        parts.append("<p>The initial design itself breaks constraints:</p>" + bullets(broken))
    warnings = [
        f"{text(name)}: {text(warning)}"
        for name, record in [("initial", data.initial), *chosen]
        for warning in record.evaluation.warnings
    ]
    parts.append(result_table(data.case, data.initial, chosen))
    if warnings:
        parts.append("<p>Warnings:</p>" + bullets(list(dict.fromkeys(warnings))))
    return "".join(parts)


def _kept(value: float, decimals: int, unit: str = "") -> str:
    """A number with its unit, never parted by the end of a line."""
    return f"{number_text(value, decimals)} {unit}".strip().replace(" ", "\xa0")


def _in_short(data: ReportData, initial: Evaluation, record: DesignRecord) -> str:
    chosen = record.evaluation
    lines = []
    for before, after in zip(initial.conditions, chosen.conditions, strict=False):
        lines.append(
            f"At Fn {_kept(after.froude_number, 3)} ({_kept(after.speed / 0.514444, 1, 'kn')}): delivered power "
            f"<strong>{_kept(1e-6 * after.delivered_power, 2, 'MW')}</strong> instead of "
            f"{_kept(1e-6 * before.delivered_power, 2, 'MW')} "
            f"({change_text(before.delivered_power, after.delivered_power, 1)}), total resistance "
            f"{_kept(1e-3 * after.total_resistance, 0, 'kN')} "
            f"({change_text(before.total_resistance, after.total_resistance, 0)}), open-water efficiency "
            f"{_kept(after.open_water_efficiency, 3)} instead of {_kept(before.open_water_efficiency, 3)}."
        )
        if abs(after.speed / before.speed - 1.0) > 1e-6:
            speed = _kept(before.speed / 0.514444, 1, "kn")
            lines[-1] += f" The initial design runs {speed} at that Froude number: the powers are of two speeds."
    hull, before_hull = chosen.hull, initial.hull
    if hull is not None and before_hull is not None and hull.booked_volume is not None:
        lines.append(
            f"<strong>Its hull really displaces {_kept(hull.displaced_volume, 0, 'm³')}</strong> "
            f"({change_text(before_hull.displaced_volume, hull.displaced_volume, 0)}); the case only books "
            f"{_kept(hull.booked_volume, 0, 'm³')} "
            f"({change_text(before_hull.booked_volume, hull.booked_volume, 0)})."
        )
        if hull.displaced_volume < hull.booked_volume:
            lines[-1] += " A smaller ship is part of the gain."
    return (
        f'<p class="lead">The compromise between both objectives is design {record.id}, one of {len(data.front)} on '
        f"the front; numbers of level {chosen.level}.</p>{bullets(lines)}"
    )


def _search(data: ReportData) -> str:
    if not data.generations:
        return "<p>No generation is finished yet.</p>"
    archive, infeasible = _archive(data.run)

    def point(record: DesignRecord | None) -> Point | None:
        if record is None or not record.evaluation.ok:
            return None
        return float(record.evaluation.objectives["f1"] or 0.0), float(record.evaluation.objectives["f2"] or 0.0)

    front = [p for p in (point(record) for record in data.front) if p is not None]
    names = data.case.objectives
    titles = (objective_title(names.first, "$f_1$"), objective_title(names.second, "$f_2$"))
    pareto = charts.pareto_chart(
        archive, infeasible, front, point(data.initial), point(data.compromise), point(data.knee), titles
    )
    total = len(infeasible) + sum(len(points) for points in archive.values())
    last = data.generations[-1]
    return pair(
        figure_html(
            pareto,
            "pareto",
            f"All {total} designs that could be computed; both objectives are minimised. Each level is normalised by "
            "the "
            "initial design at that level, so points of different levels compare only roughly. Designs far off are "
            "left "
            "out of the picture.",
        ),
        figure_html(
            charts.convergence_chart(data.generations),
            "convergence",
            f"Hypervolume: the area between the front and the point (1.2, 1.2), one series a level; {len(data.front)} "
            f"designs on the front of generation {last.number}. Below: feasible share of the population.",
        ),
    )


def _archive(run: RunReader) -> tuple[dict[int, Array], Array]:
    """Objectives (n, 2) of feasible designs by level, and of the infeasible ones."""
    points = [point for point in run.archive() if point.objectives is not None]

    def array(chosen: list[Point]) -> Array:
        return np.array(chosen, dtype=float).reshape(-1, 2)

    levels = sorted({point.level for point in points})
    feasible = {
        level: array([p.objectives for p in points if p.feasible and p.level == level and p.objectives])
        for level in levels
    }
    return feasible, array([p.objectives for p in points if not p.feasible and p.objectives])


def _or_why(draw: Callable[[], str]) -> str:
    """A figure, or the sentence that says why there is none."""
    try:
        return draw()
    except SolverFailure as failure:
        return f"<p>Not drawn: {text(failure)}.</p>"


def _propulsion(data: ReportData) -> str:
    drawn = data.drawn()
    with_curves = [(look, evaluation) for look, evaluation in drawn if evaluation.open_water is not None]
    if not with_curves:
        return "<p>There are no curves: no design has open-water results.</p>"

    def open_water() -> str:
        return figure_html(
            charts.open_water_chart(with_curves),
            "open-water",
            "Open water at full scale: thrust coefficient, ten times the torque coefficient, efficiency. Dots: "
            "operating "
            "points, where the thrust coefficient meets what the hull requires.",
        )

    def thrust() -> str:
        curves = [
            (look, thrust_curves(data.case, evaluation, points), evaluation)
            for look, points, evaluation in data.resistance
        ]
        return figure_html(
            charts.thrust_chart(curves),
            "thrust",
            "Thrust that the hull requires, and what the propeller gives at each condition's rate of rotation.",
        )

    def resistance(which: str, words: str) -> str:
        return figure_html(
            charts.resistance_chart(data.resistance, which),
            f"resistance-{which}",
            f"{words} over Froude number on each design's own length; dots: the operating conditions.",
        )

    return pair(_or_why(open_water), _or_why(thrust)) + pair(
        _or_why(lambda: resistance("total", "Total resistance")), _or_why(lambda: resistance("wave", "Wave resistance"))
    )


def _form(data: ReportData) -> str:
    drawn = [(look, evaluation) for look, evaluation in data.drawn() if evaluation.hull is not None]
    if not drawn:
        return "<p>There is no form to draw.</p>"

    def both() -> str:
        lines = [(look, hull_lines(data.case, evaluation.variables)) for look, evaluation in drawn]
        affine = data.case.hull.form == "affine"
        booked = " Affine form: the booked displacement does not change the sections." if affine else ""
        return pair(
            figure_html(
                charts.body_plan_chart(lines),
                "body-plan",
                "Body plan at equal scales: sections at twentieths of the length, closer at the ends. Horizontal "
                "lines: "
                "draft.",
            ),
            figure_html(
                charts.sectional_area_chart(lines), "sectional-area", f"Immersed sectional area along the ship.{booked}"
            ),
        )

    return _or_why(both)


def _drivers(data: ReportData) -> str:
    if data.level is None:
        return "<p>No generation is finished yet.</p>"
    ids = [p.id for p in data.run.archive(level=data.level) if p.objectives is not None]
    evaluations = [record.evaluation for record in data.run.designs(ids) if record.evaluation.conditions]
    return correlation_table(data.case, evaluations) + (
        "<p>+ means that the result grows with the variable, − that it falls; 0 is no monotone relation. A search "
        "samples "
        "where it is good, not evenly: read it as a hint, not as a law.</p>"
    )


def _front(data: ReportData) -> str:
    if not data.front:
        return "<p>The front is empty: no feasible design has been found.</p>"
    return (
        f"<p>{len(data.front)} designs, best f<sub>1</sub> first. Take one away with <code>hpsop export "
        f"{text(shlex.quote(str(data.run.path)))} --design NUMBER --to FOLDER</code>.</p>"
    ) + front_table(data.case, data.front, data.marks())
