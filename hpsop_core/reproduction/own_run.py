"""The paper's tables and figures for a run of any other case, as one HTML file.

Without the paper's numbers: they are of its own ship and propeller.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from hpsop_core.charts.plot import Plot
from hpsop_core.markup import Markup, fill, joined, one_line
from hpsop_core.report.csv_table import Table, table_html
from hpsop_core.report.data import ReportData
from hpsop_core.report.html_page import Section, chart_html, figure_or_why, page, pair, paragraph
from hpsop_core.report.paper_figures import evolution_figure, open_water_figure, resistance_figure, thrust_figure
from hpsop_core.report.paper_tables import bounds_table, conditions_table, designs_table, points_table
from hpsop_core.report.tables import run_facts
from hpsop_core.reproduction.paper import CASE_NAME
from hpsop_core.version import __version__


def own_tables(data: ReportData) -> tuple[Table, ...]:
    """Tables 1 to 4 of a run."""
    return conditions_table(data.case), bounds_table(data.case), designs_table(data), points_table(data)


def own_page_html(data: ReportData, made: Sequence[Table]) -> str:
    """The page's text.

    Args:
        data: a run's.
        made: ``own_tables`` of it.
    """
    table1, table2, table3, table4 = made
    compared = data.compared()
    marked = [row for row, (_, record) in enumerate(compared) if record is data.compromise]

    def drawn(number: int, caption: str, draw: Callable[[], Plot]) -> Markup:
        return figure_or_why(lambda: chart_html(draw(), f"figure-{number}", caption))

    level = f"level {data.level or 1}"
    fronts = Markup("")
    if data.front:
        fronts = drawn(
            5,
            "Fronts of several generations (blue: level 1, orange: level 2, green: the last). Each level is normalised "
            "by the initial design at that level.",
            lambda: evolution_figure(data),
        )
    resistance = pair(
        drawn(6, f"Wave resistance, {level}.", lambda: resistance_figure(data, "wave")),
        drawn(7, f"Total resistance, {level}.", lambda: resistance_figure(data, "total")),
    )
    sections = [
        Section("setup", "Tables 1 and 2: conditions, bounds", table_html(table1) + table_html(table2)),
        Section("table3", "Table 3: initial and optimal designs", table_html(table3, wide=True, marked=marked)),
        Section("table4", "Table 4: operating points", table_html(table4, wide=True)),
        Section("figure5", "Figure 5: evolution of the fronts", fronts or paragraph("No generation has a front yet.")),
        Section("figures67", "Figures 6 and 7: resistance", resistance),
        Section(
            "figure8",
            "Figure 8: open water",
            drawn(8, f"Open water at full scale, {level}.", lambda: open_water_figure(data)),
        ),
        Section(
            "figure9",
            "Figure 9: thrust",
            drawn(9, f"Thrust required and available, {level}.", lambda: thrust_figure(data)),
        ),
        Section("run", "The run", run_facts(data.run.summary(), len(data.run.failures()))),
    ]
    footer = f"hpsop {__version__}, made {time.strftime('%Y-%m-%d %H:%M')}"
    return page(
        f"{data.case.title or data.case.name}, in the paper's tables and figures", _head(data), sections, footer
    )


def _head(data: ReportData) -> Markup:
    summary = data.run.summary()
    words = fill(
        "Tables 1 to 4 and Figures 5 to 9 of the HPSOP paper, made from a run of the case <code>{}</code>. The paper's "
        "own numbers belong to the case <code>{}</code> as it is shipped and are not shown here.",
        one_line(data.case.name),
        CASE_NAME,
    )
    parts = [paragraph(words)]
    if summary["state"] != "finished":
        told = "<strong>The run is not finished</strong>: {}, generation {} of {}."
        parts.append(
            paragraph(fill(told, one_line(summary["state"]), summary["generation"], summary["generations"]), "banner")
        )
    return joined(parts)
