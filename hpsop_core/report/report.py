"""A run as one HTML file for people who will not start hpsop: what was asked, what came out, how far to trust it."""

from __future__ import annotations

import os
import shlex
import time
from pathlib import Path

from hpsop_core.charts.engine import engine_chart
from hpsop_core.charts.hulls import body_plan_chart, sectional_area_chart
from hpsop_core.charts.propulsion import open_water_chart
from hpsop_core.errors import InputError
from hpsop_core.evaluation.curves import hull_lines
from hpsop_core.evaluation.levels import level_of
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.ship import engine_of
from hpsop_core.markup import Markup, fill, joined, one_line
from hpsop_core.quantities import change_text, number_text, size_of_case, standing_on, violated
from hpsop_core.report.data import ReportData
from hpsop_core.report.html_page import (
    Section,
    Words,
    bullets,
    chart_html,
    figure_or_why,
    page,
    pair,
    paragraph,
)
from hpsop_core.report.looks import SHEET, SMALL_SHEET
from hpsop_core.report.paper_figures import thrust_figure
from hpsop_core.report.search import front_chapter, search_chapter
from hpsop_core.report.tables import (
    correlation_table,
    failure_table,
    front_table,
    result_table,
    run_facts,
)
from hpsop_core.report.words import assumptions, trust
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord, front_families
from hpsop_core.units import Size
from hpsop_core.version import __version__
from hpsop_core.writing import refuse_to_replace, write_whole


def report_html(run: RunReader) -> str:
    """The report's text.

    Raises:
        InputError: the run names a hull or propeller file that is gone or changed (``RunReader.check_ship``).
    """
    run.check_ship()
    data = ReportData.of(run)
    summary = run.summary()
    failures = run.failures()
    sections = [
        Section("result", "Result", _result(data)),
        Section("pareto", "Trade-off and search", search_chapter(data)),
        Section("spread", "Along the front", front_chapter(data)),
        Section("propulsion", "Propeller and thrust", _propulsion(data)),
        Section("form", "Hull form", _form(data)),
        Section("drivers", "What drives what", _drivers(data)),
        Section("trust", "How far to trust these numbers", trust(data.case, data.level)),
        Section("assumptions", "What was asked", assumptions(data.case)),
        Section("front", "The whole front", _front(data)),
        Section("run", "The run", run_facts(summary, len(failures))),
        Section(
            "failures",
            "Failed evaluations",
            failure_table(failures) if failures else paragraph("No evaluation failed."),
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
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder; --to needs a file, for example {path / 'report.html'}")
    if path.suffix == ".hpsop" or (os.path.exists(path) and path.samefile(run.path)):
        raise InputError(f"{path}: is a run file's name; --to needs another one, for example report.html")
    refuse_to_replace(path, force)
    write_whole(path, report_html(run))
    return path


def _head(data: ReportData, summary: dict[str, object]) -> Markup:
    first, second = (name.replace("_", " ") for name in (data.case.objectives.first, data.case.objectives.second))
    intro = f"Case {data.case.name}: {first} against {second}, hull and propeller optimised together."
    parts = [paragraph(one_line(f"{intro} {data.case.description}"), "soft")]
    if summary["state"] != "finished":
        reason = f" ({summary['reason']})" if summary["reason"] else ""
        words = fill(
            "<strong>This run is not finished</strong>: {}, generation {} of {}. What stands here is what it has found "
            "so far.",
            one_line(f"{summary['state']}{reason}"),
            summary["generation"],
            summary["generations"],
        )
        parts.append(paragraph(words, "banner"))
    if data.level is not None and level_of(data.level).caution:
        words = fill(
            "All results are of <strong>level {}</strong>, the fast and rough one; see “How far to trust these "
            "numbers”.",
            data.level,
        )
        parts.append(paragraph(words, "banner"))
    return joined(parts)


def _result(data: ReportData) -> Markup:
    if data.initial is None:
        return paragraph("Nothing is evaluated yet, not even the initial design.")
    chosen = data.chosen()
    parts = []
    if data.compromise is not None:
        parts.append(_in_short(data, data.initial.evaluation, data.compromise))
    elif data.generations:
        words = fill(
            "<strong>There is no feasible design on the front</strong> in generation {} ({} % of the population is "
            "feasible), so there is no compromise either. Widen the bounds, loosen the constraints, or let the search "
            "go on.",
            data.generations[-1].number,
            number_text(100.0 * data.generations[-1].feasible_share, 0),
        )
        parts.append(paragraph(words, "banner"))
    else:
        parts.append(paragraph("No generation is finished yet; only the initial design is known.", "banner"))
    broken = violated(data.initial.evaluation)
    if broken:
        parts.append(paragraph("The initial design itself breaks constraints:") + bullets(broken))
    warnings = [
        one_line(f"{name}: {warning}")
        for name, record in [("initial", data.initial), *chosen]
        for warning in record.evaluation.warnings
    ]
    parts.append(result_table(data.case, data.initial, chosen))
    if warnings:
        parts.append(paragraph("Warnings:") + bullets(list(dict.fromkeys(warnings))))
    return joined(parts)


def _kept(value: float, decimals: int, unit: str = "") -> str:
    """A number with its unit, never parted by the end of a line."""
    return f"{number_text(value, decimals)} {unit}".strip().replace(" ", "\xa0")


def _sized(value: float, decimals: int, unit: str, size: Size) -> str:
    """The same of a number in a ship's unit, in the unit of this size of ship."""
    own = size.unit(unit, decimals)
    return _kept(own.factor * value, own.decimals, own.symbol)


def _in_short(data: ReportData, initial: Evaluation, record: DesignRecord) -> Markup:
    chosen, size = record.evaluation, size_of_case(data.case)
    lines: list[Words] = []
    for before, after in zip(initial.conditions, chosen.conditions, strict=False):
        line = fill(
            "At Fn {} ({}): delivered power <strong>{}</strong> instead of {} ({}), total resistance {} ({}), "
            "open-water efficiency {} instead of {}.",
            _kept(after.froude_number, 3),
            _kept(after.speed / 0.514444, 1, "kn"),
            _sized(1e-6 * after.delivered_power, 2, "MW", size),
            _sized(1e-6 * before.delivered_power, 2, "MW", size),
            change_text(before.delivered_power, after.delivered_power, 1),
            _sized(1e-3 * after.total_resistance, 0, "kN", size),
            change_text(before.total_resistance, after.total_resistance, 0),
            _kept(after.open_water_efficiency, 3),
            _kept(before.open_water_efficiency, 3),
        )
        if abs(after.speed / before.speed - 1.0) > 1e-6:
            speed = _kept(before.speed / 0.514444, 1, "kn")
            line += f" The initial design runs {speed} at that Froude number: the powers are of two speeds."
        lines.append(line)
    booked = chosen.hull.booked_volume if chosen.ok else None
    if chosen.ok and initial.ok and booked is not None:
        hull, before_hull = chosen.hull, initial.hull
        line = fill(
            "<strong>Its hull really displaces {}</strong> ({}); the case only books {} ({}).",
            _sized(hull.displaced_volume, 0, "m³", size),
            change_text(before_hull.displaced_volume, hull.displaced_volume, 0),
            _sized(booked, 0, "m³", size),
            change_text(before_hull.booked_volume, booked, 0),
        )
        if hull.displaced_volume < booked:
            line += " A smaller ship is part of the gain."
        lines.append(line)
    standing = standing_on(chosen)
    if standing:
        lines.append(f"It stands on: {'; '.join(standing)}. Where a bound decides, ask whether it is meant.")
    first = (
        f"The compromise between both objectives is design {record.id}, one of {len(data.front)} on the front; numbers "
        f"of level {chosen.level}."
    )
    return paragraph(first, "lead") + bullets(lines)


def _propulsion(data: ReportData) -> Markup:
    drawn = data.drawn()
    with_curves = [(look, evaluation) for look, evaluation in drawn if evaluation.ok]
    if not with_curves:
        return paragraph("There are no curves: no design has open-water results.")

    def open_water() -> Markup:
        return chart_html(
            open_water_chart(with_curves, SHEET),
            "open-water",
            "Open water at full scale: thrust coefficient, ten times the torque coefficient, efficiency. Dots: "
            "operating points, where the thrust coefficient meets what the hull requires.",
        )

    def thrust() -> Markup:
        return chart_html(
            thrust_figure(data),
            "thrust",
            "Thrust that the hull requires, and what the propeller gives at each condition's rate of rotation (the "
            "paper's Figure 9).",
        )

    engine = engine_of(data.case.engine)

    def diagram() -> Markup:
        return chart_html(
            engine_chart(engine, with_curves, SHEET),
            "engine",
            "Brake power over the rate of revolutions; dashed: the engine's layout. Crosses lie outside.",
        )

    charts = pair(figure_or_why(open_water), figure_or_why(thrust))
    return charts if engine is None else charts + figure_or_why(diagram)


def _form(data: ReportData) -> Markup:
    drawn = [(look, evaluation) for look, evaluation in data.drawn() if evaluation.ok]
    if not drawn:
        return paragraph("There is no form to draw.")

    def both() -> Markup:
        lines = [(look, hull_lines(data.case, evaluation.variables)) for look, evaluation in drawn]
        affine = data.case.hull.form == "affine"
        booked = " Affine form: the booked displacement does not change the sections." if affine else ""
        return pair(
            chart_html(
                body_plan_chart(lines, SMALL_SHEET),
                "body-plan",
                "Body plan at equal scales: sections at twentieths of the length, closer at the ends. Horizontal "
                "lines: draft.",
            ),
            chart_html(
                sectional_area_chart(lines, SMALL_SHEET),
                "sectional-area",
                f"Immersed sectional area along the ship.{booked}",
            ),
        )

    return figure_or_why(both)


def _drivers(data: ReportData) -> Markup:
    if data.level is None:
        return paragraph("No generation is finished yet.")
    ids = [p.id for p in data.run.archive(level=data.level) if p.objectives is not None]
    evaluations = [record.evaluation for record in data.run.designs(ids) if record.evaluation.conditions]
    return correlation_table(data.case, evaluations) + paragraph(
        "+ means that the result grows with the variable, − that it falls; 0 is no monotone relation. A search samples "
        "where it is good, not evenly: read it as a hint, not as a law."
    )


def _front(data: ReportData) -> Markup:
    if not data.front:
        return paragraph("The front is empty: no feasible design has been found.")
    words = fill(
        "{} designs, best f<sub>1</sub> first. Take one away with <code>hpsop export {} --design NUMBER --to "
        "FOLDER</code>.",
        len(data.front),
        one_line(shlex.quote(str(data.run.path))),
    )
    _, narrow = front_families(data.front)
    said = paragraph(narrow, "banner") if narrow else Markup("")
    return paragraph(words) + said + front_table(data.case, data.front, data.marks())
