"""Figures as inline SVG: one look, no window system, no state shared between figures."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from hpsop_core.report.html_page import text

INK, SOFT, GRID = "#1d2733", "#5b6775", "#e3e8ee"
INITIAL, COMPROMISE, KNEE, PAPER = "#4a5563", "#1f5fa8", "#c2571a", "#b3261e"
LEVEL_COLOURS = {1: "#8fb4d9", 2: "#e3a55a"}
FRONT = "#1b6e3c"
SERIES = ("#1f5fa8", "#c2571a", "#1b6e3c", "#7a3fa0", "#b08a00")
SIZE = (4.8, 3.4)
"""Width and height in inches: small enough that letters stay readable on a phone."""

_STYLE: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 8.5,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "legend.fontsize": 7.5,
    "legend.frameon": True,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "lines.linewidth": 1.4,
    "mathtext.default": "it",
    "svg.fonttype": "path",
}


def pyplot() -> Any:
    """matplotlib's plotting state without a window system, for pictures that a command writes as PNG."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt


@contextmanager
def drawing(width: float = SIZE[0], height: float = SIZE[1]) -> Iterator[Figure]:
    """A figure in hpsop's look, within a ``with`` block that adds what is on it.

    Figures are rendered later by ``figure_svg``, which sets the same look again.
    """
    with matplotlib.rc_context(_STYLE):
        yield Figure(figsize=(width, height), layout="constrained")


def figure_svg(figure: Figure, name: str) -> str:
    """The figure as an <svg> element to stand in an HTML page.

    Args:
        figure: what to draw.
        name: one word, unique on the page: it heads every id, so that figures do not borrow each other's parts.
    """
    target = io.StringIO()
    with matplotlib.rc_context({**_STYLE, "svg.hashsalt": name}):
        FigureCanvasSVG(figure)
        figure.savefig(target, format="svg", dpi=200, metadata={"Date": None}, facecolor="none")
    svg = target.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"\s*<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    # matplotlib's style sheet would hold for the whole page.
    svg = re.sub(r"\s*<style .*?</style>", "", svg, flags=re.DOTALL)
    svg = svg.replace("<svg ", '<svg style="stroke-linejoin: round; stroke-linecap: butt" ', 1)
    # HTML knows SVG's names by itself, and the page shall hold no address at all.
    svg = re.sub(r'\s+xmlns(:\w+)?="[^"]*"', "", svg, count=2)
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'href="#', f'href="#{name}-', svg)
    svg = svg.replace("url(#", f"url(#{name}-")
    svg = re.sub(r'<svg ([^>]*?)width="[^"]*"', r"<svg \1", svg, count=1)
    svg = re.sub(r'<svg ([^>]*?)height="[^"]*"', r"<svg \1", svg, count=1)
    return re.sub(r"\n\s*", "\n", svg).strip()


def figure_html(figure: Figure, name: str, caption: str) -> str:
    """The figure with its caption (plain text), ready for a page."""
    label = text(caption)
    svg = figure_svg(figure, name).replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1)
    return f'<figure id="figure-{name}">{svg}<figcaption>{label}</figcaption></figure>'


def titled(axes: Any, x: str, y: str) -> None:
    """Both axes' titles, each with its unit."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
