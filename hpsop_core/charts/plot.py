"""A chart: curves, bands, marks with error bars and notes on one or two axes; out come SVG and CSV."""

from __future__ import annotations

import copy
import csv
import io
import json
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hpsop_core.charts import frame
from hpsop_core.charts.axis import Axis
from hpsop_core.charts.frame import Area, Key, mark_css
from hpsop_core.charts.marks import error_path, mark_path, polyline, smooth, text_width
from hpsop_core.charts.style import PRINT, SCREEN, Style, style_sheet
from hpsop_core.markup import Markup, fill, joined, symbol_plain, symbol_svg, xml_text
from hpsop_core.typing_aliases import Array

_CROWD = 1500
_NAMESPACE = "http://www.w3.org/2000/svg"
_MOST_READ, _MOST_NAMED = 400, 24
"""Points of a line, and lines, that a pointer reads: a crowd is not read."""
_PLAIN_LETTERS = 11.0
"""Margins are told for letters of this size."""


@dataclass(frozen=True, eq=False)
class Series:
    """What was drawn, as numbers.

    Attributes:
        name: of the series.
        x, y: (n,) in the units of the axes.
        second: whether y belongs to the second axis.
        x_error, y_error: (2, n) distances below and above, or None.
    """

    name: str
    x: Array
    y: Array
    second: bool = False
    x_error: Array | None = None
    y_error: Array | None = None


class Plot:
    """A rectangle with axes that collects SVG elements, and the numbers they were drawn from.

    Args:
        width, height: of the chart in px of its own drawing; a legend makes it higher.
        x, y: the axes.
        second: an axis at the right for a second quantity.
        margins: left, right, top, bottom in px for letters of 11 px; larger letters widen them.
        style: colours and letters.

    A css argument names roles of ``style.ROLES`` and strokes ("dash", "thin"); a name or title is text from anywhere.
    """

    def __init__(
        self,
        width: float,
        height: float,
        x: Axis,
        y: Axis,
        second: Axis | None = None,
        margins: tuple[float, float, float, float] = (52.0, 12.0, 10.0, 36.0),
        style: Style = SCREEN,
    ) -> None:
        self.x, self.y, self.second, self.style = x, y, second, style
        left, right, top, bottom = (margin * style.letters / _PLAIN_LETTERS for margin in margins)
        # the title stands clear of the longest number
        left = max(left, 6 + _widest(y, style) + 1.5 * style.letters)
        if second is not None:
            right = max(right, 6 + _widest(second, style) + 1.8 * style.letters)
        self.area = Area(left, top, width - left - right, height - top - bottom, width, height)
        self.series: list[Series] = []
        self.keys: list[Key] = []
        self._elements: list[Markup] = []
        self._over: list[Markup] = []
        self._numbers = self._framed = True

    def copy(self) -> Plot:
        """The same plot, to draw further on without changing this one."""
        other = copy.copy(self)
        other.series, other.keys = list(self.series), list(self.keys)
        other._elements, other._over = list(self._elements), list(self._over)
        return other

    # ---- places ------------------------------------------------------------------------------------------------------
    def px(self, x: ArrayLike) -> Array:
        """Data to px, horizontally."""
        return self.area.left + self.x.share(x) * self.area.width

    def py(self, y: ArrayLike, second: bool = False) -> Array:
        """Data of the left or the second axis to px, vertically (down)."""
        axis = self.second if second and self.second is not None else self.y
        return self.area.bottom - axis.share(y) * self.area.height

    # ---- series ------------------------------------------------------------------------------------------------------
    def line(
        self,
        x: ArrayLike,
        y: ArrayLike,
        css: str,
        style: str = "",
        name: str = "",
        key: str = "",
        second: bool = False,
        curved: bool = False,
    ) -> None:
        """A line through points (n,); gaps where a value is not finite.

        Args:
            x, y: the points.
            css: classes.
            style: CSS of its own.
            name: shown at the pointer, and in the CSV.
            key: words of the legend.
            second: y belongs to the second axis.
            curved: drawn smooth between the points, without overshoot.
        """
        self._record(Series(name, np.asarray(x, dtype=float), np.asarray(y, dtype=float), second))
        if key:
            self.keys.append(Key("line", css, key, style))
        drawn = smooth(x, y) if curved else (x, y)
        path = polyline(self.px(drawn[0]), self.py(drawn[1], second))
        if path:
            self._elements.append(
                fill('<path d="{}" class="line {}" style="{}">{}</path>', path, css, style, _title(name))
            )

    def band(
        self,
        x: ArrayLike,
        low: ArrayLike,
        high: ArrayLike,
        css: str,
        name: str = "",
        key: str = "",
        second: bool = False,
    ) -> None:
        """A shaded band between two curves (n,), for example an interval; points that are not finite are left out."""
        x, low, high = (np.asarray(values, dtype=float) for values in (x, low, high))
        middle = 0.5 * (low + high)
        self._record(Series(name, x, middle, second, None, np.stack([middle - low, high - middle])))
        if key:
            self.keys.append(Key("band", css, key))
        keep = np.isfinite(x) & np.isfinite(low) & np.isfinite(high)
        there, back = self.py(low[keep], second), self.py(high[keep], second)[::-1]
        across = self.px(x[keep])
        path = polyline(np.concatenate([across, across[::-1]]), np.concatenate([there, back]))
        if path:
            self._elements.insert(0, fill('<path d="{}z" class="band {}">{}</path>', path, css, _title(name)))

    def dots(
        self, x: ArrayLike, y: ArrayLike, radius: float, css: str, style: str = "", name: str = "", key: str = ""
    ) -> None:
        """Many equal round marks (n,) as one path (an archive has thousands)."""
        self._record(Series(name, np.asarray(x, dtype=float), np.asarray(y, dtype=float)))
        if key:
            self.keys.append(Key("dots", css, key))
        area = self.area
        px, py = self.px(x), self.py(y)
        keep = np.isfinite(px) & np.isfinite(py)
        keep &= (px > area.left - 9) & (px < area.right + 9) & (py > area.top - 9) & (py < area.bottom + 9)
        # Equal pixels are drawn once; in a crowd whole pixels do, and the browser has a third of it to draw.
        pixels = np.column_stack([px[keep], py[keep]])
        steps = 10.0 if len(pixels) <= _CROWD else 1.0
        whole = np.round(pixels * steps).astype(np.int64).reshape(-1, 2)
        # as one number each, which sorts ten times as fast as rows
        corner, span = (whole.min(axis=0), int(np.ptp(whole[:, 1])) + 1) if len(whole) else (np.zeros(2, int), 1)
        once = np.unique((whole - corner) @ np.array([span, 1]))
        if once.size:
            across = ((once // span + corner[0]) / steps).tolist()
            down = ((once % span + corner[1]) / steps).tolist()
            path = "".join([f"M{a:g} {b:g}h0" for a, b in zip(across, down, strict=True)])
            width = f"stroke-width:{2 * radius:g};{style}"
            self._elements.append(fill('<path d="{}" class="dots {}" style="{}"/>', path, css, width))

    def points(
        self,
        x: ArrayLike,
        y: ArrayLike,
        shape: str,
        size: float,
        css: str,
        name: str = "",
        key: str = "",
        x_error: ArrayLike | None = None,
        y_error: ArrayLike | None = None,
        second: bool = False,
    ) -> None:
        """Marks (n,) with error bars.

        Args:
            x, y: the points.
            shape, size: of the marks, as ``marks.mark_path`` knows them.
            css: classes.
            name: in the CSV.
            key: words of the legend.
            x_error, y_error: half widths (n,), or distances below and above (2, n).
            second: y belongs to the second axis.
        """
        x, y = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
        errors = [
            None if e is None else np.broadcast_to(np.asarray(e, dtype=float), (2, len(x))) for e in (x_error, y_error)
        ]
        self._record(Series(name, x, y, second, *errors))
        if key:
            self.keys.append(Key(shape, css, key))
        for index in range(len(x)):
            a, b = float(self.px(x[index])), float(self.py(y[index], second))
            for error, upright in zip(errors, (False, True), strict=True):
                if error is None or not (math.isfinite(a) and math.isfinite(b)):
                    continue
                centre = y[index] if upright else x[index]
                ends = (centre - error[0, index], centre + error[1, index])
                low, high = (float(self.py(e, second) if upright else self.px(e)) for e in ends)
                if math.isfinite(low) and math.isfinite(high):
                    bar = error_path(a, b, low, high, upright)
                    self._elements.append(fill('<path d="{}" class="error {}"/>', bar, css))
            self.mark(x[index], y[index], shape, size, css, second=second)

    def mark(
        self,
        x: float,
        y: float,
        shape: str,
        size: float,
        css: str,
        style: str = "",
        title: str = "",
        name: str = "",
        key: str = "",
        second: bool = False,
    ) -> None:
        """One mark; ``title`` is shown at the pointer, ``name`` is its series in the CSV, ``key`` its legend."""
        if name:
            self._record(Series(name, np.array([x], dtype=float), np.array([y], dtype=float), second))
        if key:
            self.keys.append(Key(shape, css, key))
        if not (math.isfinite(x) and math.isfinite(y)):
            return
        a, b = float(self.px(x)), float(self.py(y, second))
        area = self.area
        if not (area.left - 1 <= a <= area.right + 1 and area.top - 1 <= b <= area.bottom + 1):
            return
        self._over.append(
            fill(
                '<path d="{}" class="mark {}" style="{}">{}</path>',
                mark_path(shape, a, b, size), mark_css(shape, css), style, _title(title),
            )
        )  # fmt: skip

    # ---- notes -------------------------------------------------------------------------------------------------------
    def text(
        self, x: float, y: float, text: str, css: str = "", anchor: str = "start", dx: float = 0.0, dy: float = 0.0
    ) -> None:
        """A text at a place of the data, moved by px."""
        a, b = float(self.px(x)) + dx, float(self.py(y)) + dy
        if math.isfinite(a) and math.isfinite(b):
            words = '<text x="{:.1f}" y="{:.1f}" text-anchor="{}" class="note {}">{}</text>'
            self._over.append(fill(words, a, b, anchor, css, symbol_svg(text)))

    def annotate(self, x: float, y: float, text: str, dx: float, dy: float, css: str = "") -> None:
        """A text beside a place of the data with a thin line to it."""
        a, b = float(self.px(x)), float(self.py(y))
        if math.isfinite(a) and math.isfinite(b):
            self._over.append(fill('<path d="M{:.1f} {:.1f}l{:.1f} {:.1f}" class="leader"/>', a, b, dx, dy))
            self.text(x, y, text, css, "start" if dx >= 0 else "end", dx + (2 if dx >= 0 else -2), dy + 4)

    def vertical(self, x: float, css: str) -> None:
        """A line through the whole height."""
        path = f"M{float(self.px(x)):.1f} {self.area.top:.1f}V{self.area.bottom:.1f}"
        self._elements.append(fill('<path d="{}" class="line {}"/>', path, css))

    def horizontal(self, y: float, css: str) -> None:
        """A line through the whole width."""
        path = f"M{self.area.left:.1f} {float(self.py(y)):.1f}H{self.area.right:.1f}"
        self._elements.append(fill('<path d="{}" class="line {}"/>', path, css))

    def rectangle(self, x0: float, x1: float, y0: float, y1: float, css: str, style: str = "") -> None:
        """A filled rectangle in data."""
        a0, a1 = sorted((float(self.px(x0)), float(self.px(x1))))
        b0, b1 = sorted((float(self.py(y0)), float(self.py(y1))))
        box = '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" class="{}" style="{}"/>'
        self._elements.append(fill(box, a0, b0, a1 - a0, b1 - b0, css, style))

    def raw(self, svg: Markup, over: bool = False) -> None:
        """An own element in px."""
        (self._over if over else self._elements).append(svg)

    def message(self, text: str, numbers: bool = False) -> None:
        """A word in the middle, for a chart that has nothing to show yet; its axes bear no numbers unless asked to."""
        self._numbers = numbers
        self._over.append(frame.message(self.area, text, self.style))

    def without_numbers(self) -> None:
        """No axes, ticks and grid: a drawing whose places say themselves what they are."""
        self._numbers = self._framed = False

    # ---- out ---------------------------------------------------------------------------------------------------------
    def svg(self, name: str, attributes: str = "", readable: bool = False) -> Markup:
        """The chart as an element of a page that has the ``style_sheet``.

        Args:
            name: one word, unique on the page: for the browser's events and the ids within.
            attributes: more of the element's, as the programmer wrote them.
            readable: the numbers of its named lines come with it, for the page to show at the pointer.
        """
        area = self.area
        keys, below = frame.legend(
            self.keys, area.picture_height + 3, 0.5 * area.left, area.picture_width - 0.5 * area.left, self.style
        )
        limits = ",".join(f"{value:.10g}" for value in (*self.x.limits, *self.y.limits))
        return fill(
            '<svg class="chart" data-chart="{name}" data-plot="{place}" data-limits="{limits}" {attributes} '
            'viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{label}">'
            '<clipPath id="clip-{name}"><rect x="{left:g}" y="{top:g}" width="{wide:g}" height="{high:g}"/></clipPath>'
            '<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" class="area"/>{grid}'
            '<g clip-path="url(#clip-{name})">{elements}</g>{axes}{over}{keys}</svg>',
            name=name,
            place=f"{area.left:g},{area.top:g},{area.width:g},{area.height:g}",
            limits=limits,
            attributes=Markup(attributes) + (self._readings() if readable and self._numbers else Markup("")),
            width=area.picture_width,
            height=area.picture_height + below,
            label=f"{symbol_plain(self.y.title)} against {symbol_plain(self.x.title)}",
            left=area.left - 1, top=area.top - 1, wide=area.width + 2, high=area.height + 2,
            x=area.left, y=area.top, w=area.width, h=area.height,
            grid=frame.grid(area, self.x, self.y, self._numbers),
            elements=joined(self._elements),
            axes=frame.axes(area, self.x, self.y, self.second, self._numbers, self.style, self._framed),
            over=joined(self._over),
            keys=keys,
        )  # fmt: skip

    def _readings(self) -> Markup:
        """The numbers of named lines as JSON in an attribute, of so many digits as a screen can show."""
        named = [item for item in self.series if item.name and 1 < len(item.x) <= _MOST_READ]
        content = {
            "x": symbol_plain(self.x.title),
            "y": symbol_plain(self.y.title),
            "y2": symbol_plain(self.second.title) if self.second is not None else "",
            "series": [
                {"name": item.name, "second": item.second, "x": _digits(item.x), "y": _digits(item.y)}
                for item in named[:_MOST_NAMED]
            ],
        }
        return fill(' data-values="{}"', json.dumps(content, separators=(",", ":")))

    def file_svg(self, name: str, style: Style = PRINT) -> str:
        """The chart as a whole SVG file: XML with its namespace, size and style, nothing to fetch.

        Args:
            name: one word.
            style: of fixed colours; a chart keeps its layout.
        """
        size = self.area.picture_width
        rules = fill("<style>{}</style>", Markup(style_sheet(style).replace("width:100%;height:auto;", "")))
        inner = self.svg(name, f'xmlns="{_NAMESPACE}" width="{size:g}"')
        head, tail = inner.split(">", 1)
        return xml_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{head}>{rules}{tail}\n')

    def csv(self) -> str:
        """The numbers of every named series, a row a point; errors as distances below and above where there are any."""
        target = io.StringIO()
        writer = csv.writer(target, lineterminator="\n")
        bars = any(item.x_error is not None or item.y_error is not None for item in self.series)
        titles = [symbol_plain(axis.title) for axis in (self.x, self.y, self.second) if axis is not None]
        writer.writerow(["series", *titles, *(("x below", "x above", "y below", "y above") if bars else ())])
        for item in self.series:
            for index in range(len(item.x)):
                row: list[str] = [item.name, _number(item.x[index])]
                value = _number(item.y[index])
                row += ["", value] if item.second else [value, *([""] if self.second is not None else [])]
                if bars:
                    for error in (item.x_error, item.y_error):
                        row += ["", ""] if error is None else [_number(part) for part in error[:, index]]
                writer.writerow(row)
        return target.getvalue()

    def _record(self, series: Series) -> None:
        if series.name:
            self.series.append(series)


def _widest(axis: Axis, style: Style) -> float:
    return max((text_width(text, style.letters) for _, text in axis.ticks()), default=0.0)


def _digits(values: Array) -> list[float | None]:
    return [float(f"{value:.5g}") if math.isfinite(value) else None for value in values.tolist()]


def _title(text: str) -> Markup:
    return fill("<title>{}</title>", text) if text else Markup("")


def _number(value: float) -> str:
    return f"{value:.9g}" if math.isfinite(value) else ""
