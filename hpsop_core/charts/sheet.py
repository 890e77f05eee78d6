"""Several charts and words on one sheet, as one SVG file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hpsop_core.charts.plot import Plot
from hpsop_core.charts.style import PRINT, Style, style_sheet
from hpsop_core.markup import Markup, fill, joined, xml_text


@dataclass(frozen=True, eq=False)
class Placed:
    """A chart on a sheet: its left upper corner in px, and a line above it."""

    plot: Plot
    left: float
    top: float
    title: str


def sheet_svg(
    width: float,
    height: float,
    charts: Sequence[Placed],
    words: Sequence[tuple[float, float, str]],
    style: Style = PRINT,
) -> str:
    """The sheet as an SVG file with fixed colours.

    Args:
        width, height: px.
        charts: each keeps the size that it was made with.
        words: left, baseline and text of lines.
    """
    parts = [fill('<rect width="{:g}" height="{:g}" fill="white"/>', width, height)]
    for number, placed in enumerate(charts):
        area = placed.plot.area
        corner = (
            f'x="{placed.left:g}" y="{placed.top:g}" width="{area.picture_width:g}" height="{area.picture_height:g}"'
        )
        parts.append(placed.plot.svg(f"chart{number}", corner))
        line = '<text x="{:g}" y="{:g}" class="legend">{}</text>'
        parts.append(fill(line, placed.left + area.left, placed.top - 4.0, placed.title))
    parts += [fill('<text x="{:g}" y="{:g}">{}</text>', left, base, text) for left, base, text in words]
    head = fill(
        '<svg class="chart" xmlns="http://www.w3.org/2000/svg" width="{:g}" height="{:g}" viewBox="0 0 {:g} {:g}">',
        width, height, width, height,
    )  # fmt: skip
    rules = fill("<style>{}</style>", Markup(style_sheet(style).replace("width:100%;height:auto;", "")))
    return xml_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{head}{rules}{joined(parts)}</svg>\n')
