"""The chapters of a report that show the search and its front: trade-off, progress, designs along the front."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.charts.plot import Plot
from hpsop_core.charts.search import Cloud, Front, Mark, convergence_chart, family_front, pareto_chart, window
from hpsop_core.markup import Markup
from hpsop_core.quantities import objective_title
from hpsop_core.report.csv_table import table_html
from hpsop_core.report.data import ReportData
from hpsop_core.report.html_page import chart_html, figure_or_why, pair, paragraph
from hpsop_core.report.looks import SHEET
from hpsop_core.report.paper_figures import evolution_figure, open_water_figure, resistance_figure
from hpsop_core.report.paper_tables import designs_table, points_table
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord, front_families
from hpsop_core.typing_aliases import Array

_PREDICTED = (
    " Pale points were predicted by a learnt surface and not solved; some of them lie better than the front, because "
    "the best of many predictions is too good by its error: a front holds solved designs."
)


def search_chapter(data: ReportData) -> Markup:
    """Everything evaluated, how the search went on, and its fronts by generation."""
    if not data.generations:
        return paragraph("No generation is finished yet.")
    clouds, total = archive_clouds(data.run)
    last = data.generations[-1]
    return pair(
        chart_html(
            pareto_figure(data, clouds),
            "pareto",
            f"All {total} designs that could be computed; both objectives are minimised. Each level is normalised by "
            "the initial design at that level, so points of different levels compare only roughly. Designs far off are "
            "left out of the picture. ×n: a family of n designs that the error of their numbers cannot tell apart."
            + (_PREDICTED if any(cloud.css == "archive predicted" for cloud in clouds) else ""),
        ),
        chart_html(
            convergence_chart(
                [item.number for item in data.generations],
                [item.level for item in data.generations],
                [item.hypervolume for item in data.run.known_fronts()],
                last.number,
                SHEET,
                [item.feasible_share for item in data.generations],
            ),
            "convergence",
            f"Hypervolume: the area between the front and the point (1.2, 1.2), one series a level; {len(data.front)} "
            f"designs on the front of generation {last.number}. Dotted: feasible share of the population.",
        ),
    ) + _evolution(data)


def pareto_figure(data: ReportData, clouds: Sequence[Cloud]) -> Plot:
    """The Pareto chart of a run as it is now."""
    front = _objectives(data.front)
    fronts = [Front(front, "front", 2.6, key="front")] if len(front) else []
    if len(front):
        belongs, _ = front_families(data.front)
        dots, fronts[0] = family_front(fronts[0], belongs)
        clouds = [*clouds, dots]
    marks = []
    for record, shape, size, name in (
        (data.initial, "square", 4.5, "initial"),
        (data.compromise, "star", 8.0, "compromise"),
        (data.knee, "diamond", 5.0, "knee"),
    ):
        points = _objectives([record] if record is not None else [])
        if len(points):
            marks.append(Mark(float(points[0, 0]), float(points[0, 1]), shape, size, name, name, name))
    core = np.concatenate([front, *(np.array([[mark.x, mark.y]]) for mark in marks)])
    feasible = [cloud.points for cloud in clouds if cloud.css != "infeasible"]
    limits = window(core, np.concatenate(feasible) if feasible else np.zeros((0, 2)))
    names = data.case.objectives
    titles = (objective_title(names.first, "f_1"), objective_title(names.second, "f_2"))
    return pareto_chart(clouds, fronts, marks, limits, titles, SHEET)


def _objectives(records: Sequence[DesignRecord]) -> Array:
    """(n, 2) of those that could be computed."""
    found = [record.evaluation.objectives for record in records if record.evaluation.ok]
    return np.array([(f["f1"] or 0.0, f["f2"] or 0.0) for f in found], dtype=float).reshape(-1, 2)


def archive_clouds(run: RunReader) -> tuple[list[Cloud], int]:
    """Objectives of the infeasible designs, then of the feasible ones by level; and how many there are."""
    points = [point for point in run.archive() if point.objectives is not None]

    def cloud(chosen: list[tuple[float, float] | None], css: str, key: str) -> Cloud:
        return Cloud(np.array(chosen, dtype=float).reshape(-1, 2), css, 1.6, key=key)

    made = [cloud([p.objectives for p in points if not p.feasible], "infeasible", "infeasible")]
    for level in sorted({point.level for point in points}):
        own = [p.objectives for p in points if p.feasible and p.level == level and not p.predicted]
        made.append(cloud(own, f"level{level}", f"level {level}, feasible"))
    predicted = [p.objectives for p in points if p.feasible and p.predicted]
    made.insert(1, cloud(predicted, "archive predicted", "predicted, not solved"))
    return [item for item in made if len(item.points)], len(points)


def _evolution(data: ReportData) -> Markup:
    if not data.front:
        return Markup("")
    return chart_html(
        evolution_figure(data),
        "evolution",
        "Fronts of several generations (the paper's Figure 5): blue level 1, orange level 2, green the last one. Each "
        "level is normalised by the initial design at that level.",
    )


def front_chapter(data: ReportData) -> Markup:
    """The initial design and five spread along the front: the paper's Tables 3 and 4, its Figures 6 to 8."""
    compared = data.compared()
    if not any(record.evaluation.ok for _, record in compared):
        return paragraph("There is nothing to compare yet.")
    marked = [row for row, (_, record) in enumerate(compared) if record is data.compromise]
    words = paragraph(
        "R1 to R5 lie evenly over the front's ranks, its ends and the compromise among them."
        if data.spread
        else "The front is empty: only the initial design is shown."
    )
    tables = table_html(designs_table(data), wide=True, marked=marked, file=False) + table_html(
        points_table(data), wide=True, file=False
    )
    over = "over the speed" if data.case.conditions.speeds_are_fixed else "over Froude number on each design's length"

    def resistance(which: str, title: str) -> Markup:
        return chart_html(
            resistance_figure(data, which), f"resistance-{which}", f"{title} {over}; dots: the operating conditions."
        )

    charts = pair(
        figure_or_why(lambda: resistance("wave", "Wave resistance (the paper's Figure 6)")),
        figure_or_why(lambda: resistance("total", "Total resistance (the paper's Figure 7)")),
    )
    open_water = figure_or_why(
        lambda: chart_html(
            open_water_figure(data),
            "open-water-spread",
            "Open water at full scale (the paper's Figure 8): thrust coefficient, ten times the torque coefficient, "
            "efficiency.",
        )
    )
    return words + tables + charts + open_water
