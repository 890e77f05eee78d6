"""Which variables drive which result: Spearman's rank correlation over the archive."""

from __future__ import annotations

from explorer.state.run_picture import RunPicture
from hpsop_core.charts.correlations import LEAST_FOR_CORRELATION, correlation_rows, rank_correlations
from hpsop_core.markup import Markup, fill, joined, symbol_html
from hpsop_core.quantities import Quantity
from hpsop_core.typing_aliases import Array


def drivers_table(picture: RunPicture) -> Markup:
    """A table of correlations, coloured by sign and strength; one level at a time."""
    level = picture.current_level
    keep = (picture.level == level) & ~picture.failed
    if keep.sum() < LEAST_FOR_CORRELATION:
        words = '<p class="soft">Correlations appear once {} designs have been evaluated.</p>'
        return fill(words, LEAST_FOR_CORRELATION)

    def column(quantity: Quantity) -> Array | None:
        values = picture.column(quantity.key)
        return None if values is None else values[keep]

    found = rank_correlations(picture.case, column)
    heads = joined(
        fill(
            '<th title="{}">{}{}</th>',
            item.label + item.place,
            symbol_html(item.symbol),
            fill('<br><span class="unit">{}</span>', item.condition) if item.condition else "",
        )
        for item in found.results
    )
    rows = [fill("<tr><th>variable</th>{}</tr>", heads)]
    for name, *cells in correlation_rows(found, _named):
        row = '<tr><td class="name">{}</td>{}</tr>'
        rows.append(fill(row, name, joined(fill("<td>{}</td>", cell) for cell in cells)))
    return fill(
        '<table class="numbers">{}</table><p class="soft">Spearman\'s rank correlation over {} level-{} designs: + '
        "grows with the variable, − falls. A search samples where it is good, not evenly: read it as a hint.</p>",
        joined(rows),
        int(keep.sum()),
        level,
    )


def _named(quantity: Quantity) -> Markup:
    return fill('{} <span class="unit">{}</span>', quantity.label, symbol_html(quantity.symbol))
