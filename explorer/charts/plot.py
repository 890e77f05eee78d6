"""Axes, ticks, lines and marks of a chart, as SVG.

Colours come from CSS classes (assets/page.css), so that a chart follows the light or dark theme without being redrawn.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from hpsop_core.markup import escape, symbol_html, symbol_plain, symbol_svg

_CROWD = 1500
Limits = tuple[float, float]
Array = NDArray[np.float64]


def nice_step(span: float, count: int) -> float:
    """A tick distance of 1, 2, 2.5 or 5 times a power of ten that divides ``span`` into about ``count`` parts."""
    if not span > 0.0 or not math.isfinite(span):
        return 1.0
    raw = span / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    for factor in (1.0, 2.0, 2.5, 5.0, 10.0):
        if raw <= factor * power * 1.0001:
            return factor * power
    return 10.0 * power


def ticks(limits: Limits, count: int) -> list[float]:
    """Round numbers within the limits."""
    step = nice_step(limits[1] - limits[0], count)
    first = math.ceil(limits[0] / step - 1e-9)
    last = math.floor(limits[1] / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def tick_texts(values: Sequence[float]) -> list[str]:
    """Tick labels with as many decimals as their distance needs and no more."""
    if not values:
        return []
    step = min((b - a for a, b in itertools.pairwise(values)), default=abs(values[0]) or 1.0)
    largest = max(abs(value) for value in values)
    decimals = 0
    while decimals < 8 and abs(round(step, decimals) - step) > 1e-6 * step:
        decimals += 1
    if largest >= 1e5:
        return [f"{value:,.0f}".replace(",", " ") for value in values]
    return [f"{value:.{decimals}f}".replace("-", "−") for value in values]


def padded(values: ArrayLike, fraction: float = 0.06, include: Iterable[float] = ()) -> Limits:
    """Limits around finite values with some air; (0, 1) when there are none."""
    numbers = np.concatenate([np.asarray(values, dtype=float).ravel(), np.asarray(list(include), dtype=float)])
    numbers = numbers[np.isfinite(numbers)]
    if numbers.size == 0:
        return (0.0, 1.0)
    low, high = float(numbers.min()), float(numbers.max())
    span = high - low
    if span <= 1e-12 * max(abs(high), 1.0):
        span = max(abs(high), 1e-3) * 0.1
    return (low - fraction * span, high + fraction * span)


def smooth(x: ArrayLike, y: ArrayLike, count: int = 160) -> tuple[Array, Array]:
    """A curve through computed points without overshoot (PCHIP), for the eye; gaps where a point is not finite."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    keep = np.isfinite(x) & np.isfinite(y)
    if keep.sum() < 4 or np.any(np.diff(x[keep]) <= 0.0):
        return x, y
    fine = np.union1d(np.linspace(x[keep][0], x[keep][-1], count), x[keep])
    return fine, np.asarray(PchipInterpolator(x[keep], y[keep])(fine))


@dataclass
class Plot:
    """A rectangle with axes that collects SVG elements.

    Attributes:
        width, height: of the whole chart in px of its own drawing.
        x_limits, y_limits: of the data.
        x_title, y_title: with units.
        margins: left, right, top, bottom in px.
    """

    width: float
    height: float
    x_limits: Limits
    y_limits: Limits
    x_title: str
    y_title: str
    margins: tuple[float, float, float, float] = (52.0, 12.0, 10.0, 36.0)

    def __post_init__(self) -> None:
        self._elements: list[str] = []
        self._over: list[str] = []
        self._numbers = True

    @property
    def plot_width(self) -> float:
        """Of the area within the axes, px."""
        return self.width - self.margins[0] - self.margins[1]

    @property
    def plot_height(self) -> float:
        """Of the area within the axes, px."""
        return self.height - self.margins[2] - self.margins[3]

    def copy(self) -> Plot:
        """The same plot, to draw further on without changing this one."""
        other = copy.copy(self)
        other._elements, other._over = list(self._elements), list(self._over)
        return other

    def px(self, x: ArrayLike) -> Array:
        """Data to px, horizontally."""
        low, high = self.x_limits
        return self.margins[0] + (np.asarray(x, dtype=float) - low) / (high - low) * self.plot_width

    def py(self, y: ArrayLike) -> Array:
        """Data to px, vertically (down)."""
        low, high = self.y_limits
        return self.margins[2] + (1.0 - (np.asarray(y, dtype=float) - low) / (high - low)) * self.plot_height

    def line(self, x: ArrayLike, y: ArrayLike, css: str, style: str = "", title: str = "") -> None:
        """A polyline; gaps where a value is not finite."""
        path = polyline(self.px(x), self.py(y))
        if path:
            hint = f"<title>{escape(title)}</title>" if title else ""
            self._elements.append(f'<path d="{path}" class="line {css}" style="{style}">{hint}</path>')

    def dots(self, x: ArrayLike, y: ArrayLike, radius: float, css: str, style: str = "") -> None:
        """Many equal round marks as one path (an archive has thousands)."""
        px, py = self.px(x), self.py(y)
        keep = np.isfinite(px) & np.isfinite(py)
        keep &= (px > self.margins[0] - 9) & (px < self.width - self.margins[1] + 9)
        keep &= (py > self.margins[2] - 9) & (py < self.height - self.margins[3] + 9)
        # Equal pixels are drawn once; in a crowd whole pixels do, and the browser has a third of it to draw.
        pixels = np.column_stack([px[keep], py[keep]])
        pixels = np.unique(np.round(pixels, 1 if len(pixels) <= _CROWD else 0), axis=0)
        if pixels.size:
            path = "".join(f"M{a:g} {b:g}h0" for a, b in pixels)
            self._elements.append(f'<path d="{path}" class="dots {css}" style="stroke-width:{2 * radius:g};{style}"/>')

    def mark(self, x: float, y: float, shape: str, size: float, css: str, style: str = "", title: str = "") -> None:
        """One mark: circle, ring, square, diamond, star, cross, triangle."""
        if not (math.isfinite(x) and math.isfinite(y)):
            return
        a, b = float(self.px(x)), float(self.py(y))
        if not (-20 < a < self.width + 20 and -20 < b < self.height + 20):
            return
        hint = f"<title>{escape(title)}</title>" if title else ""
        self._over.append(f'<path d="{mark_path(shape, a, b, size)}" class="mark {css}" style="{style}">{hint}</path>')

    def text(
        self, x: float, y: float, text: str, css: str = "", anchor: str = "start", dx: float = 0.0, dy: float = 0.0
    ) -> None:
        """A text at a place of the data, moved by px."""
        a, b = float(self.px(x)) + dx, float(self.py(y)) + dy
        self._over.append(
            f'<text x="{a:.1f}" y="{b:.1f}" text-anchor="{anchor}" class="note {css}">{symbol_svg(text)}</text>'
        )

    def vertical(self, x: float, css: str) -> None:
        """A line through the whole height."""
        a = float(self.px(x))
        self._elements.append(
            f'<path d="M{a:.1f} {self.margins[2]:.1f}V{self.height - self.margins[3]:.1f}" class="line {css}"/>'
        )

    def horizontal(self, y: float, css: str) -> None:
        """A line through the whole width."""
        b = float(self.py(y))
        self._elements.append(
            f'<path d="M{self.margins[0]:.1f} {b:.1f}H{self.width - self.margins[1]:.1f}" class="line {css}"/>'
        )

    def rectangle(self, x0: float, x1: float, y0: float, y1: float, css: str, style: str = "") -> None:
        """A filled rectangle in data."""
        a0, a1 = sorted((float(self.px(x0)), float(self.px(x1))))
        b0, b1 = sorted((float(self.py(y0)), float(self.py(y1))))
        self._elements.append(
            f'<rect x="{a0:.1f}" y="{b0:.1f}" width="{a1 - a0:.1f}" height="{b1 - b0:.1f}" '
            f'class="{css}" style="{style}"/>'
        )

    def raw(self, svg: str, over: bool = False) -> None:
        """An own element in px."""
        (self._over if over else self._elements).append(svg)

    def message(self, text: str, numbers: bool = False) -> None:
        """A word in the middle, for a chart that has nothing to show yet; its axes bear no numbers unless asked to."""
        self._numbers = numbers
        a = self.margins[0] + self.plot_width / 2
        b = self.margins[2] + self.plot_height / 2
        for index, row in enumerate(text.split("\n")):
            self._over.append(
                f'<text x="{a:.0f}" y="{b + 17 * index:.0f}" text-anchor="middle" class="empty">{escape(row)}</text>'
            )

    def svg(
        self,
        chart: str,
        attributes: str = "",
        x_count: int = 6,
        y_count: int = 5,
    ) -> str:
        """The whole chart.

        Args:
            chart: its name for the browser's events.
            attributes: data-drag, data-hover, data-click, data-box as page.js reads them.
            x_count, y_count: about how many ticks.
        """
        left, right, top, bottom = self.margins
        x_end, y_end = self.width - right, self.height - bottom
        grid, labels = [], []
        x_ticks, y_ticks = ticks(self.x_limits, x_count), ticks(self.y_limits, y_count)
        if not self._numbers:
            x_ticks, y_ticks = [], []
        for value, text in zip(x_ticks, tick_texts(x_ticks), strict=True):
            a = float(self.px(value))
            grid.append(f"M{a:.1f} {top:.1f}V{y_end:.1f}")
            # a label at the very end must not run out of the picture
            end = a + 3.2 * len(text) > self.width
            place = f'x="{self.width - 1:.1f}" text-anchor="end"' if end else f'x="{a:.1f}" text-anchor="middle"'
            labels.append(f'<text {place} y="{y_end + 14:.1f}" class="tick">{text}</text>')
        for value, text in zip(y_ticks, tick_texts(y_ticks), strict=True):
            b = float(self.py(value))
            grid.append(f"M{left:.1f} {b:.1f}H{x_end:.1f}")
            labels.append(f'<text x="{left - 6:.1f}" y="{b + 4:.1f}" text-anchor="end" class="tick">{text}</text>')
        middle = left + self.plot_width / 2
        labels.append(
            f'<text x="{middle:.1f}" y="{self.height - 4:.1f}" text-anchor="middle" class="axis-title">'
            f"{symbol_svg(self.x_title)}</text>"
        )
        middle = top + self.plot_height / 2
        labels.append(
            f'<text transform="translate(12 {middle:.1f}) rotate(-90)" text-anchor="middle" '
            f'class="axis-title">{symbol_svg(self.y_title)}</text>'
        )
        clip = f"clip-{chart}"
        limits = ",".join(f"{value:.10g}" for value in (*self.x_limits, *self.y_limits))
        area = f"{left:g},{top:g},{self.plot_width:g},{self.plot_height:g}"
        return (
            f'<svg class="chart" data-chart="{chart}" data-plot="{area}" data-limits="{limits}" {attributes} '
            f'viewBox="0 0 {self.width:g} {self.height:g}" role="img" '
            f'aria-label="{escape(symbol_plain(self.y_title))} against {escape(symbol_plain(self.x_title))}">'
            f'<clipPath id="{clip}"><rect x="{left - 1:g}" y="{top - 1:g}" '
            f'width="{self.plot_width + 2:g}" height="{self.plot_height + 2:g}"/></clipPath>'
            f'<rect x="{left:g}" y="{top:g}" width="{self.plot_width:g}" height="{self.plot_height:g}" class="area"/>'
            f'<path d="{"".join(grid)}" class="grid"/><g clip-path="url(#{clip})">{"".join(self._elements)}</g>'
            f'<path d="M{left:g} {top:g}V{y_end:g}H{x_end:g}" class="axis"/>{"".join(labels)}{"".join(self._over)}'
            "</svg>"
        )


def polyline(px: Array, py: Array) -> str:
    """An SVG path through finite points, interrupted at the others."""
    finite = np.isfinite(px) & np.isfinite(py)
    parts = []
    pen_up = True
    for a, b, good in zip(px.tolist(), py.tolist(), finite.tolist(), strict=True):
        if not good:
            pen_up = True
            continue
        parts.append(f"{'M' if pen_up else 'L'}{a:.1f} {b:.1f}")
        pen_up = False
    return "".join(parts)


def mark_path(shape: str, a: float, b: float, size: float) -> str:
    """The outline of a mark around (a, b) px; ``size`` is its half-width."""
    s = size
    if shape in ("circle", "ring"):
        return f"M{a - s:.1f} {b:.1f}a{s:g} {s:g} 0 1 0 {2 * s:g} 0a{s:g} {s:g} 0 1 0 {-2 * s:g} 0z"
    if shape == "square":
        return f"M{a - s:.1f} {b - s:.1f}h{2 * s:g}v{2 * s:g}h{-2 * s:g}z"
    if shape == "diamond":
        return f"M{a:.1f} {b - s:.1f}l{s:g} {s:g}l{-s:g} {s:g}l{-s:g} {-s:g}z"
    if shape == "triangle":
        return f"M{a:.1f} {b - s:.1f}l{s:g} {1.8 * s:g}h{-2 * s:g}z"
    if shape == "cross":
        return f"M{a - s:.1f} {b - s:.1f}l{2 * s:g} {2 * s:g}m0 {-2 * s:g}l{-2 * s:g} {2 * s:g}"
    points = []
    for index in range(10):
        radius = s if index % 2 == 0 else 0.42 * s
        angle = math.pi * (index / 5.0 - 0.5)
        points.append(f"{a + radius * math.cos(angle):.1f} {b + radius * math.sin(angle):.1f}")
    return "M" + "L".join(points) + "z"


def legend(entries: Sequence[tuple[str, str, str]]) -> str:
    """A row of small marks with words: (shape, css, word); the shape "line" and "dash" are strokes."""
    parts = []
    for shape, css, word in entries:
        if shape in ("line", "dash"):
            dash = "stroke-dasharray:4 3" if shape == "dash" else ""
            drawn = f'<path d="M1 6H17" class="line {css}" style="{dash}"/>'
            width = 18
        else:
            drawn = f'<path d="{mark_path(shape, 6, 6, 4)}" class="mark {css}"/>'
            width = 12
        parts.append(
            f'<span class="key"><svg width="{width}" height="12" viewBox="0 0 {width} 12">{drawn}</svg>'
            f"<span>{symbol_html(word)}</span></span>"
        )
    return f'<div class="legend">{"".join(parts)}</div>'
