"""docs/paper-run.md and its figures: what a full run of the paper's case gave, beside the paper.

python -m tools.paper_run RUN.hpsop [--to docs]
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from hpsop_core.markup import Markup
from hpsop_core.quantities import number_text
from hpsop_core.report.csv_table import Table, cell_text, heading_html
from hpsop_core.report.tables import duration
from hpsop_core.reproduction.comparison import TABLE4_DIGITS, TABLE4_QUANTITIES, Reproduction, tables
from hpsop_core.reproduction.figures import Figure, figures
from hpsop_core.reproduction.page import verdict_html
from hpsop_core.runs.reader import RunReader, open_run

COMMAND = "hpsop optimize dtc-p4119-paper --run paper.hpsop --workers 2"
_MARKS = (
    ("<strong>", "**"), ("</strong>", "**"), ("<ul>", "\n"), ("</ul>", "\n"), ("<li>", "* "), ("</li>", "\n"),
    ("<h3>", "\n## "), ("</h3>", "\n"),
)  # fmt: skip


def markdown(markup: Markup) -> str:
    """Markup of paragraphs, lists and headings as Markdown; sub and superscripts stay HTML, which Markdown allows."""
    text = str(markup)
    for tag, mark in _MARKS:
        text = text.replace(tag, mark)
    return re.sub(r"\n{3,}", "\n\n", text).strip()


def _rows(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows)]


def table_lines(made: Table) -> list[str]:
    """A table in Markdown, below what it is."""
    head = [re.sub("</?span[^>]*>", "", str(heading_html(column, " "))) for column in made.header]
    return ["", " ".join(made.comment.split()), "", *_rows(head, made.texts())]


def _points_lines(made: Table) -> list[str]:
    """Table 4 with a column for each design and Froude number, theirs and ours side by side."""
    digits = dict(zip(TABLE4_QUANTITIES, TABLE4_DIGITS, strict=True))
    points = list(dict.fromkeys((row[0], row[1]) for row in made.rows))
    rows: dict[str, list[str]] = {}
    for _, _, quantity, theirs, ours, _ in made.rows:
        name = str(quantity)
        rows.setdefault(name, []).extend(cell_text(value, digits[name]) for value in (theirs, ours))
    head = ["", *(f"{design}, Fn {froude}: {whose}" for design, froude in points for whose in ("paper", "ours"))]
    return ["", " ".join(made.comment.split()), "", *_rows(head, ([name, *cells] for name, cells in rows.items()))]


def _figure_lines(drawn: Figure, folder: Path) -> list[str]:
    name = f"paper-figure-{drawn.number}"
    (folder / "pictures" / f"{name}.svg").write_text(drawn.plot.file_svg(name), encoding="utf-8")
    return ["", f"![Figure {drawn.number}](pictures/{name}.svg)", "", drawn.caption]


def _run_lines(run: RunReader) -> list[str]:
    summary = run.summary()
    rows = [
        (
            level,
            str(summary["generations_by_level"][level]),
            number_text(numbers["count"], 0),
            number_text(numbers["feasible"], 0),
            str(numbers["failed"]),
            duration(summary["wall_seconds"][level]),
            number_text(numbers["processor_seconds"] / max(1, numbers["count"]), 3),
        )
        for level, numbers in summary["evaluations"].items()
    ]
    versions = ", ".join(f"{name} {value}" for name, value in summary["versions"].items())
    return [
        f"Seed {summary['seed']}, population {summary['population']}, {summary['generations']} generations; front of "
        f"{summary['front_size']} designs (the best of all that level 2 solved), "
        f"hypervolume {summary['hypervolume']:.5f} below (1.2, 1.2), "
        f"{100.0 * summary['feasible_share']:.0f} % of the last population feasible. {versions}. The times are of two "
        "cores that others used too.",
        "",
        *_rows(
            ("level", "generations", "evaluations", "feasible", "failed", "wall time", "processor seconds each"), rows
        ),
    ]


def page(run: RunReader, folder: Path) -> str:
    """The page as Markdown; its figures are written into ``folder``/pictures.

    Raises:
        InputError: not a run of the paper's case.
        SolverFailure: a design of the paper's cannot be computed.
    """
    data = Reproduction.of(run)
    by_name: Mapping[str, Table] = {made.name: made for made in tables(data)}
    drawn = figures(data)
    lines = [
        "# A full run of the paper's case",
        "",
        "```",
        COMMAND,
        "hpsop reproduce --to folder --run paper.hpsop",
        "```",
        "",
        "Made from such a run by `python -m tools.paper_run paper.hpsop`; do not edit. `hpsop reproduce --to folder`",
        "alone does all of it: the run, this page as HTML, and the tables as CSV files ([reports](report.md)). IS and",
        "OP1 to OP5 are the paper's, R1 to R5 lie evenly along our front.",
        "",
        *_run_lines(run),
        "",
        markdown(verdict_html(data, by_name)),
        "",
        "## Table 3: initial and optimal designs",
        *table_lines(by_name["table3"]),
        *table_lines(by_name["paper_designs"]),
        "",
        "## Table 4: operating points",
        *_points_lines(by_name["table4"]),
        "",
        "## Figure 5: fronts by generation",
        *_figure_lines(drawn[5], folder),
        "",
        "## Figures 6 and 7: wave and total resistance",
        *_figure_lines(drawn[6], folder),
        *_figure_lines(drawn[7], folder),
        *table_lines(by_name["resistance_audit"]),
        "",
        "## Figure 8: open water",
        *_figure_lines(drawn[8], folder),
        *table_lines(by_name["propeller_at_paper_j"]),
        "",
        "## Figure 9: thrust",
        *_figure_lines(drawn[9], folder),
        *table_lines(by_name["table4_audit"]),
    ]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write page and figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path, metavar="RUN.hpsop")
    parser.add_argument("--to", type=Path, default=Path("docs"))
    asked = parser.parse_args(arguments)
    (asked.to / "pictures").mkdir(parents=True, exist_ok=True)
    (asked.to / "paper-run.md").write_text(page(open_run(asked.run), asked.to), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
