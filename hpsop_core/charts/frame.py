"""What stands round the area of a chart: grid, ticks, axis lines, titles, and the legend below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hpsop_core.charts.axis import Axis
from hpsop_core.charts.marks import mark_path, text_width
from hpsop_core.charts.style import Style
from hpsop_core.markup import Markup, escape, fill, joined, symbol_svg

_TICK = '<text x="{:.1f}" y="{:.1f}" text-anchor="{}" class="tick">{}</text>'
_ROW = 1.5
"""Height of a row of the legend in heights of its letters."""


@dataclass(frozen=True)
class Area:
    """The rectangle within the axes, px.

    Attributes:
        left, top, width, height: of the rectangle.
        picture_width, picture_height: of the chart around it, without the legend.
    """

    left: float
    top: float
    width: float
    height: float
    picture_width: float
    picture_height: float

    @property
    def right(self) -> float:
        """px."""
        return self.left + self.width

    @property
    def bottom(self) -> float:
        """px."""
        return self.top + self.height


@dataclass(frozen=True)
class Key:
    """An entry of the legend.

    Attributes:
        shape: of a mark; "line" is a stroke, "band" a filled box, "dots" a point of a cloud.
        css: classes.
        words: what it stands for; an underscore makes a subscript.
        style: as the line's or band's own.
    """

    shape: str
    css: str
    words: str
    style: str = ""


def grid(area: Area, x: Axis, y: Axis, numbers: bool) -> Markup:
    """Lines behind the curves, at the ticks of the lower and left axes."""
    path = ""
    if numbers:
        path += "".join(f"M{area.left + s * area.width:.1f} {area.top:.1f}V{area.bottom:.1f}" for s in _shares(x))
        path += "".join(f"M{area.left:.1f} {area.bottom - s * area.height:.1f}H{area.right:.1f}" for s in _shares(y))
    return fill('<path d="{}" class="grid"/>', path)


def axes(area: Area, x: Axis, y: Axis, second: Axis | None, numbers: bool, style: Style, framed: bool = True) -> Markup:
    """Axis lines, ticks' labels, titles."""
    drop, rise = 1.27 * style.letters, 0.36 * style.letters
    path = f"M{area.left:g} {area.top:g}V{area.bottom:g}H{area.right:g}" + (f"V{area.top:g}" if second else "")
    parts = [fill('<path d="{}" class="axis"/>', path)] if framed else []
    for value, text in x.ticks() if numbers else ():
        a = area.left + float(x.share(value)) * area.width
        # a label at the very end must not run out of the picture
        end = a + 0.5 * text_width(text, style.letters) > area.picture_width
        at, anchor = (area.picture_width - 1, "end") if end else (a, "middle")
        parts.append(fill(_TICK, at, area.bottom + drop, anchor, text))
    for axis, at, anchor in ((y, area.left - 6, "end"), (second, area.right + 6, "start")):
        if axis is None or not numbers:
            continue
        for value, text in axis.ticks():
            parts.append(fill(_TICK, at, area.bottom - float(axis.share(value)) * area.height + rise, anchor, text))
    middle = area.top + area.height / 2
    titled = '<text {} text-anchor="middle" class="axis-title">{}</text>'
    place = fill('x="{:.1f}" y="{:.1f}"', area.left + area.width / 2, area.picture_height - 4)
    parts.append(fill(titled, place, symbol_svg(x.title)))
    turned = '<g transform="translate({:.1f} {:.1f}) rotate(-90)">{}</g>'
    parts.append(fill(turned, 1.1 * style.letters, middle, fill(titled, "", symbol_svg(y.title))))
    if second is not None:
        right = area.picture_width - 0.4 * style.letters
        parts.append(fill(turned, right, middle, fill(titled, "", symbol_svg(second.title))))
    return joined(parts)


def legend(keys: Sequence[Key], top: float, left: float, width: float, style: Style) -> tuple[Markup, float]:
    """Rows of small marks with words.

    Args:
        keys: in their order.
        top, left, width: where the rows stand, px.
        style: for the size of letters.

    Returns:
        Its markup and its height in px.
    """
    row = _ROW * style.letters
    parts = []
    a, b = left, top + 0.9 * style.letters
    for key in keys:
        drawn = 20.0 if key.shape in ("line", "band") else 12.0
        wide = drawn + 3 + text_width(key.words, style.letters)
        if a > left and a + wide > left + width:
            a, b = left, b + row
        y = b - 0.35 * style.letters
        if key.shape == "line":
            mark = fill('<path d="M{:.1f} {:.1f}h18" class="key-line {}" style="{}"/>', a, y, key.css, key.style)
        elif key.shape == "band":
            box = '<path d="M{:.1f} {:.1f}h18v8h-18z" class="key-band {}" style="{}"/>'
            mark = fill(box, a, y - 4, key.css, key.style)
        elif key.shape == "dots":
            mark = fill('<path d="M{:.1f} {:.1f}h0" class="key-dots {}" style="stroke-width:6"/>', a + 6, y, key.css)
        else:
            path = mark_path(key.shape, a + 6, y, 4)
            mark = fill('<path d="{}" class="key-mark {}"/>', path, mark_css(key.shape, key.css))
        words = '<text x="{:.1f}" y="{:.1f}" class="legend">{}</text>'
        parts.append(mark + fill(words, a + drawn + 3, b, symbol_svg(key.words)))
        a += wide + 12
    return fill('<g class="keys">{}</g>', joined(parts)), (b - top + 0.5 * style.letters if keys else 0.0)


def mark_css(shape: str, css: str) -> str:
    """A mark's classes: those of strokes alone are open."""
    return f"{css} {'ring' if shape == 'ring' else 'open' if shape in ('cross', 'plus') else ''}".strip()


def message(area: Area, text: str, style: Style) -> Markup:
    """Words in the middle, a row a line; a row that is wider than the area goes on in the next."""
    a, b = area.left + area.width / 2, area.top + area.height / 2
    size = style.letters + 2
    rows: list[str] = []
    for line in text.split("\n"):
        rows.append("")
        for word in line.split(" "):
            longer = f"{rows[-1]} {word}".strip()
            if rows[-1] and text_width(longer, size) > area.width:
                rows.append(word)
            else:
                rows[-1] = longer
    return joined(
        fill('<text x="{:.0f}" y="{:.0f}" text-anchor="middle" class="empty">{}</text>', a, b + 17 * index, escape(row))
        for index, row in enumerate(rows)
    )


def _shares(axis: Axis) -> list[float]:
    return [float(axis.share(value)) for value, _ in axis.ticks()]
