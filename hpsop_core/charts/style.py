"""How charts look: colours by what they stand for, letters and sizes; one style sheet made of them.

A chart names what a line stands for ("initial", "level2", "published") and never a colour. So one chart follows the
page's light and dark theme, is printed in colours that survive paper, and a new role is one entry here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

_SERIES = re.compile(r"\.(line|dots|band|mark)\b")
ROLES = (
    "initial", "selected", "chosen1", "chosen2", "chosen3", "chosen4", "chosen5", "level1", "level2", "archive",
    "infeasible", "compromise", "knee", "front", "published", "pin1", "pin2", "pin3", "pin4", "soft", "ink",
)  # fmt: skip
"""What a line, mark, band or text can stand for; each is a class of the style sheet."""


@dataclass(frozen=True)
class Style:
    """The look of charts.

    Attributes:
        colours: of every role, and of "area" (behind the plot), "grid" and "brush".
        font: family, as CSS writes it; "inherit" takes the page's.
        letters: size of ticks and titles in px of the drawing.
        note: size of notes within the plot in px.
        line: width of a curve in px.
    """

    colours: Mapping[str, str]
    font: str = "inherit"
    letters: float = 11.0
    note: float = 10.5
    line: float = 1.7


SCREEN = Style(
    {
        **{name: f"var(--hp-{name})" for name in ("initial", "selected", "level1", "level2", "archive", "knee")},
        **{f"chosen{number}": f"var(--hp-pin{(number - 1) % 4 + 1})" for number in range(1, 6)},
        **{f"pin{number}": f"var(--hp-pin{number})" for number in range(1, 5)},
        "infeasible": "var(--hp-bad)",
        "compromise": "var(--hp-gold)",
        "front": "var(--hp-level2)",
        "published": "var(--hp-bad)",
        "soft": "var(--hp-soft)",
        "ink": "var(--hp-ink)",
        "area": "var(--hp-area)",
        "grid": "var(--hp-faint)",
        "brush": "var(--hp-selected)",
    }
)
"""In the explorer: the theme's own variables, light or dark."""

PRINT = Style(
    {
        "initial": "#4a5563",
        "selected": "#1f5fa8",
        "chosen1": "#1f5fa8",
        "chosen2": "#c2571a",
        "chosen3": "#1b6e3c",
        "chosen4": "#7a3fa0",
        "chosen5": "#b08a00",
        "level1": "#8fb4d9",
        "level2": "#e3a55a",
        "archive": "#b7c0ca",
        "infeasible": "#6f7b88",
        "compromise": "#1f5fa8",
        "knee": "#c2571a",
        "front": "#1b6e3c",
        "published": "#b3261e",
        "pin1": "#0b7285",
        "pin2": "#a61e4d",
        "pin3": "#5c940d",
        "pin4": "#862e9c",
        "soft": "#5b6775",
        "ink": "#1d2733",
        "area": "#ffffff",
        "grid": "#e3e8ee",
        "brush": "#c2571a",
    },
    font='system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", Arial, sans-serif',
    letters=11.5,
    note=11.0,
    line=1.6,
)
"""On paper and in files: fixed colours on white that stay apart in grey, letters of 7 pt at half of A4's width."""


def style_sheet(style: Style) -> str:
    """The rules of a style; they hold inside charts only."""
    colour = style.colours
    rules = [
        ("", f"width:100%;height:auto;display:block;user-select:none;touch-action:none;font-family:{style.font}"),
        ("[data-drag=pan]", "cursor:crosshair"),
        (" text", f"fill:{colour['ink']};font-size:{style.letters:g}px"),
        (" .tick", f"fill:{colour['soft']}"),
        (" .axis-title", f"font-size:{style.letters + 0.5:g}px"),
        # a halo, so that a word stays readable across a line
        (
            " .note",
            f"font-size:{style.note:g}px;paint-order:stroke;stroke:{colour['area']};stroke-width:3px;"
            "stroke-linejoin:round",
        ),
        (" .legend", f"fill:{colour['soft']}"),
        (" .sub", "font-size:.78em"),
        (" .count", f"font-size:{style.letters - 1.5:g}px;fill:{colour['soft']}"),
        (" .empty", f"fill:{colour['soft']};font-size:{style.letters + 2:g}px"),
        (" .area", f"fill:{colour['area']}"),
        (" .grid", f"stroke:{colour['grid']};stroke-width:.6;fill:none"),
        (" .axis", f"stroke:{colour['soft']};fill:none;stroke-width:1"),
        (" .line", f"fill:none;stroke-width:{style.line:g};stroke-linejoin:round"),
        (" .dots", "fill:none;stroke-linecap:round"),
        (" .band", "fill-opacity:.16;stroke:none"),
        (" .error", "fill:none;stroke-width:1.1"),
        (" .mark", f"stroke:{colour['area']};stroke-width:1"),
        (" .leader", f"fill:none;stroke:{colour['soft']};stroke-width:.7"),
    ]
    for role in ROLES:
        rules += [
            (f" .line.{role},svg.chart .dots.{role},svg.chart .error.{role}", f"stroke:{colour[role]}"),
            (f" .mark.{role},svg.chart .band.{role},svg.chart .note.{role}", f"fill:{colour[role]}"),
        ]
    rules += [
        # drawn by strokes alone
        *((f" .mark.open.{role}", f"fill:none;stroke:{colour[role]};stroke-width:1.6") for role in ROLES),
        (" .mark.selected.ring", f"fill:none;stroke:{colour['selected']};stroke-width:2.4"),
        (" .mark.compromise", f"stroke:{colour['ink']};stroke-width:.8"),
        (" .mark.infeasible", f"fill:none;stroke:{colour['infeasible']};stroke-width:1.2"),
        (" .mark.hand", f"fill:{colour['area']};stroke:{colour['ink']};stroke-width:1.3"),
        (" .dots.infeasible", "opacity:.35"),
        # paler than the front of the level: a point of the archive is only ever better than its own level's
        *((f" .dots.archive.{name}", f"stroke:{colour[name]};stroke-opacity:.45") for name in ("level1", "level2")),
        # of a learnt surface: there, but not solved
        (" .dots.archive.predicted", f"stroke:{colour['archive']};stroke-opacity:.4"),
        (" .line.required", "stroke-dasharray:2 3;stroke-width:1.2;opacity:.75"),
        (" .dash", "stroke-dasharray:6 3"),
        (" .dot", "stroke-dasharray:1.5 3"),
        (" .dashdot", "stroke-dasharray:7 3 1.5 3"),
        (" .dotdash", "stroke-dasharray:1.5 2 1.5 5"),
        (" .thin", "stroke-width:1"),
        (" .hair", "stroke-width:.6;opacity:.55"),
        (" .guide", f"stroke:{colour['soft']};stroke-width:.8;stroke-dasharray:3 3;fill:none"),
        (" .brush", f"fill:{colour['brush']};opacity:.25"),
        (" .boxed", f"fill:none;stroke:{colour['ink']};stroke-dasharray:3 2"),
    ]
    return "\n".join(f"{_with_keys(f'svg.chart{selector}')}{{{content}}}" for selector, content in rules)


def _with_keys(selectors: str) -> str:
    """The selectors, and the same for the legend's samples: these are no marks or lines that a pointer may mean."""
    found = selectors.split(",")
    samples = [_SERIES.sub(r".key-\1", selector) for selector in found]
    return ",".join(dict.fromkeys([*found, *samples]))
