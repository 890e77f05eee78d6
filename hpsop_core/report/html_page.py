"""One self-contained HTML file: the page's frame, its tables, and how it is put in its place.

A string is text and escaped, ``Markup`` is not (see ``hpsop_core.markup``); nothing is fetched from anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hpsop_core.charts.plot import Plot
from hpsop_core.charts.style import PRINT, style_sheet
from hpsop_core.errors import SolverFailure
from hpsop_core.markup import Markup, fill, joined, one_line, xml_text

_STYLE = """
:root { --ink: #1d2733; --soft: #5b6775; --line: #d9dfe6; --tint: #f4f6f9; --accent: #1f5fa8; --warn: #9a4b00;
  --good: #1b6e3c; --bad: #a3262a; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 62rem; padding: 2.2rem 1.4rem 4rem; background: #fff; color: var(--ink);
  font: 15px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.75rem; font-weight: 600; line-height: 1.2; margin: 0 0 .3rem; letter-spacing: -.01em;
  overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; font-weight: 600; margin: 2.6rem 0 .7rem; padding-top: .9rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1rem; font-weight: 600; margin: 1.5rem 0 .4rem; }
p, ul { margin: .5rem 0 .8rem; max-width: 46rem; overflow-wrap: anywhere; }
ul { padding-left: 1.2rem; } li { margin: .2rem 0; }
.soft, figcaption, caption { color: var(--soft); }
.small { font-size: .86rem; }
.banner { border-left: 4px solid var(--warn); background: #fff7ed; padding: .6rem .9rem; margin: 1rem 0; }
.lead { font-size: 1.05rem; }
.scroll { overflow-x: auto; margin: .7rem 0 1.1rem; }
table { border-collapse: collapse; font-size: .86rem; line-height: 1.4; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding: 0 0 .35rem; font-size: .86rem; }
th, td { padding: .22rem .6rem; text-align: right; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; } td { white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 0; white-space: normal; }
thead th { border-bottom: 1.5px solid var(--soft); vertical-align: bottom; }
td.words { text-align: left; white-space: normal; min-width: 9rem; overflow-wrap: anywhere; }
th.words { text-align: left; }
table.wide { font-size: .74rem; } table.wide th, table.wide td { padding: .2rem .32rem; }
table.wide th:first-child, table.wide td:first-child { padding-left: 0; } table.wide td.words { min-width: 5rem; }
tr.group th { text-align: left; color: var(--accent); padding-top: .8rem; border-bottom-color: var(--soft); }
tr.mark td { background: var(--tint); }
td .change { display: inline-block; min-width: 4.3rem; color: var(--soft); font-size: .78rem; }
td .change.good { color: var(--good); } td .change.bad { color: var(--bad); }
.unit { color: var(--soft); white-space: nowrap; }
sub { font-size: .72em; line-height: 0; }
dl.facts { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1.2rem; margin: .6rem 0; }
dl.facts dt { color: var(--soft); } dl.facts dd { margin: 0; overflow-wrap: anywhere; }
figure { margin: .8rem 0 1.4rem; break-inside: avoid; }
figure svg { display: block; width: 100%; height: auto; max-width: 34rem; }
figcaption { font-size: .86rem; max-width: 44rem; margin-top: .3rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1.6rem; break-inside: avoid; }
nav { font-size: .86rem; margin: 1.1rem 0; color: var(--soft); } nav a { margin-right: .9rem; white-space: nowrap; }
a { color: var(--accent); text-decoration: none; } a:hover { text-decoration: underline; }
footer { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: .8rem; color: var(--soft);
  font-size: .82rem; }
@media (max-width: 46rem) {
  body { padding: 1.2rem .9rem 3rem; }
  .pair { grid-template-columns: 1fr; }
  h1 { font-size: 1.4rem; }
  dl.facts { grid-template-columns: 1fr; gap: 0; } dl.facts dd { margin-bottom: .5rem; }
  td .change { display: block; } td:first-child { min-width: 8.5rem; }
}
@page { size: A4; margin: 14mm 13mm 16mm; }
@media print {
  html { font-size: 12.4px; }
  body { padding: 0; max-width: none; font-size: 1rem; }
  nav { display: none; }
  h2 { margin-top: 1.5rem; break-after: avoid; } h3 { break-after: avoid; } p, ul { max-width: none; }
  .scroll { overflow: visible; }
  th, td { padding: .14rem .45rem; }
  table.wide { font-size: .68rem; } table.wide th, table.wide td { padding: .1rem .24rem; }
  thead { display: table-header-group; } tr { break-inside: avoid; } tr.group { break-after: avoid; }
  figure svg { max-width: 115mm; } .pair figure svg { max-width: 100%; }
  .banner, td, td span { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  a { color: inherit; }
}
"""


Words = str | Markup
"""Text, which is escaped, or markup, which is not."""


def table(
    header: Sequence[Words],
    rows: Sequence[Sequence[Words]],
    *,
    caption: Words = "",
    words: Sequence[int] = (),
    marked: Sequence[int] = (),
    wide: bool = False,
) -> Markup:
    """A table; a row of one cell is a heading across it.

    Args:
        header, rows: cells.
        caption: above the table.
        words: columns that hold sentences.
        marked: rows to tint.
        wide: many columns: smaller in print.
    """

    def cells(tag: str, row: Sequence[Words]) -> Markup:
        return joined(
            fill("<{0}{1}>{2}</{0}>", tag, Markup(" class=words") if index in words else "", cell)
            for index, cell in enumerate(row)
        )

    body = []
    for number, row in enumerate(rows):
        if len(row) == 1 and len(header) > 1:
            group = '<tr class="group"><th colspan="{}" scope="rowgroup">{}</th></tr>'
            body.append(fill(group, len(header), row[0]))
        else:
            body.append(fill("<tr{}>{}</tr>", Markup(" class=mark") if number in marked else "", cells("td", row)))
    return fill(
        '<div class="scroll"><table{}>{}<thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>',
        Markup(' class="wide"') if wide else "",
        fill("<caption>{}</caption>", caption) if caption else "",
        cells("th", header),
        joined(body),
    )


def facts(pairs: Sequence[tuple[Words, Words]]) -> Markup:
    """Names beside their values."""
    return fill('<dl class="facts">{}</dl>', joined(fill("<dt>{}</dt><dd>{}</dd>", *pair) for pair in pairs))


def bullets(lines: Sequence[Words]) -> Markup:
    """A list."""
    return fill("<ul>{}</ul>", joined(fill("<li>{}</li>", line) for line in lines))


def paragraph(words: Words, css: str = "") -> Markup:
    """A paragraph of a class: "soft", "banner", "lead"."""
    return fill('<p class="{}">{}</p>', css, words) if css else fill("<p>{}</p>", words)


def pair(first: Words, second: Words) -> Markup:
    """Two figures side by side where there is room."""
    return fill('<div class="pair">{}{}</div>', first, second)


def unit_html(unit: str) -> Markup:
    """A unit in its brackets, as tables have it."""
    return fill("<span class=unit>[{}]</span>", unit or "–")


def chart_html(plot: Plot, name: str, caption: str) -> Markup:
    """A chart with its caption.

    Args:
        plot: of the print style.
        name: one word, unique on the page.
        caption: text.
    """
    figure = '<figure id="figure-{}">{}<figcaption>{}</figcaption></figure>'
    return fill(figure, name, plot.svg(name), one_line(caption))


def figure_or_why(draw: Callable[[], Markup]) -> Markup:
    """A figure, or the sentence that says why there is none."""
    try:
        return draw()
    except SolverFailure as failure:
        return paragraph(f"Not drawn: {failure}.")


@dataclass(frozen=True)
class Section:
    """A section of a page.

    Attributes:
        anchor: one word, unique on the page.
        title: text.
        body: markup; a plain string would be shown as text.
    """

    anchor: str
    title: str
    body: Words


def page(title: str, head: Words, sections: Sequence[Section], footer: str) -> str:
    """A whole document.

    Args:
        title: text, of window and page.
        head: below the title.
        sections: in their order; linked from the top.
        footer: text.
    """
    links = joined((fill('<a href="#{}">{}</a>', item.anchor, one_line(item.title)) for item in sections), " ")
    body = joined(
        (
            fill('<section id="{}"><h2>{}</h2>\n{}\n</section>', item.anchor, one_line(item.title), item.body)
            for item in sections
        ),
        "\n",
    )
    document = fill(
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        # Not even a slip can fetch something.
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
        'img-src data:">\n'
        "<title>{title}</title>\n<style>{style}</style>\n</head>\n<body>\n<header><h1>{title}</h1>\n"
        "{head}</header>\n<nav>{links}</nav>\n{body}\n<footer>{footer}</footer>\n</body>\n</html>\n",
        title=one_line(title),
        style=Markup(_STYLE + style_sheet(PRINT)),
        head=head,
        links=links,
        body=body,
        footer=one_line(footer),
    )
    return xml_text(document)
