"""The lines plan at one scale: body plan and sheer on one baseline, the half-breadth plan below; and its numbers."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

import numpy as np

from hpsop_core.charts.axis import Axis
from hpsop_core.charts.marks import text_width
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.style import SCREEN, Style
from hpsop_core.geometry.hull.lines import HullLine
from hpsop_core.typing_aliases import Array

_ROLE = {
    "STATIONS": "ink thin",
    "WATERLINES": "level1 thin",
    "DESIGN_WATERLINE": "level1",
    "BUTTOCKS": "level2 thin",
    "PROFILE": "ink",
}
# wider at the left than any number of the hidden axis: a plot that had to widen it would stretch the ship
_MARGINS = (64.0, 12.0, 12.0, 24.0)
_AIR = 0.02
"""Between the views, in lengths of the ship; half of it beyond the ends."""


_HEIGHTS = (1.0, 0.75, 0.5, 0.3, 1.3, 0.15, 1.6, 0.9)
"""In drafts: where a section's number may stand, the best place first."""


def lines_plan_chart(
    lines: Sequence[HullLine], length: float, breadth: float, draft: float, width: float, style: Style = SCREEN
) -> Plot:
    """Three views at one scale, each line named by its place; as high as that scale asks for.

    Args:
        lines: as ``geometry.hull.lines.plan_lines`` cuts them.
        length, breadth, draft: of the hull, in m.
        width: px.
        style: colours and letters.
    """
    cloud = np.concatenate([line.points for line in lines])
    aft, fore, deck = float(cloud[:, 0].min()), float(cloud[:, 0].max()), float(cloud[:, 2].max())
    half = max(float(cloud[:, 1].max()), 0.5 * breadth)
    air = _AIR * length
    # the body plan stands left of the sheer on the same baseline, so that waterlines run through both
    middle = aft - 2.5 * air - half
    left, right = middle - half - air, fore + 1.5 * air
    floor, top = -2.5 * air - half, deck + 1.5 * air
    share = style.letters / 11.0
    wide = width - share * (_MARGINS[0] + _MARGINS[1])
    height = wide * (top - floor) / (right - left) + share * (_MARGINS[2] + _MARGINS[3])
    plot = Plot(
        width,
        height,
        Axis("body plan and sheer plan above, half-breadth plan below, all at one scale", (left, right)),
        Axis(" ", (floor, top)),
        margins=_MARGINS,
        style=style,
    )
    plot.without_numbers()
    centreline = -1.5 * air
    _grid(plot, lines, length, deck, draft, half, middle, centreline, (aft, fore), air)
    for line in lines:
        x, y, z = line.points.T
        css, name = _ROLE[line.layer], line_name(line, length)
        if line.layer in ("STATIONS", "PROFILE"):
            side = -1.0 if line.at < 0.5 * length - 1e-6 * length else 1.0
            if line.layer == "STATIONS":
                plot.line(middle + side * y, z, css, name=name)
            else:
                plot.line(x, z, css, name=name)
        elif line.layer == "BUTTOCKS":
            plot.line(x, z, css, name=name)
        else:
            plot.line(x, centreline - y, css, name=name)
    _names(plot, lines, length, draft, middle, fore + 0.6 * air)
    return plot


def lines_csv(lines: Sequence[HullLine], length: float) -> str:
    """Every point of every line: its kind, where its plane stands, x, y, z in m."""
    target = io.StringIO()
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(["line", "at [m]", "x [m]", "y [m]", "z [m]"])
    for line in lines:
        name, at = line_name(line, length), f"{line.at:.9g}"
        writer.writerows([name, at, *(f"{value:.6f}" for value in point)] for point in line.points)
    return target.getvalue()


def line_name(line: HullLine, length: float) -> str:
    """Station 3.5, waterline 4.2 m, buttock 10.2 m, profile."""
    if line.layer == "STATIONS":
        return f"station {10.0 * line.at / length:.4g}"
    if line.layer == "PROFILE":
        return "profile"
    word = {"BUTTOCKS": "buttock", "DESIGN_WATERLINE": "design waterline"}.get(line.layer, "waterline")
    return f"{word} {line.at:.4g} m"


def _grid(
    plot: Plot,
    lines: Sequence[HullLine],
    length: float,
    deck: float,
    draft: float,
    half: float,
    middle: float,
    centreline: float,
    ends: tuple[float, float],
    air: float,
) -> None:
    """Stations through sheer and half-breadth plan, baseline and draft through body and sheer plan, centrelines."""
    for station in range(11):
        x = station / 10.0 * length
        plot.line([x, x], [0.0, deck], "soft hair")
        plot.line([x, x], [centreline, centreline - half], "soft hair")
        plot.text(x, centreline, {0: "AP 0", 10: "10 FP"}.get(station, str(station)), "soft", "middle", dy=-4)
    plot.line([middle, middle], [0.0, deck], "soft hair")
    for z, css in ((0.0, "soft hair"), (draft, "level1 hair")):
        plot.line([middle - half, middle + half], [z, z], css)
        plot.line([ends[0], ends[1] + 0.5 * air], [z, z], css)
    plot.line(ends, [centreline, centreline], "soft hair")
    # what is a curve in one view is straight in the others
    for z in sorted({line.at for line in lines if line.layer == "WATERLINES"}):
        plot.line([middle - half, middle + half], [z, z], "level1 hair")
        plot.line([ends[0], ends[1] + 0.5 * air], [z, z], "level1 hair")
    for y in sorted({line.at for line in lines if line.layer == "BUTTOCKS"}):
        plot.line(ends, [centreline - y] * 2, "level2 hair")
        for side in (-1.0, 1.0):
            plot.line([middle + side * y] * 2, [0.0, deck], "level2 hair")


def _names(
    plot: Plot,
    lines: Sequence[HullLine],
    length: float,
    draft: float,
    middle: float,
    right: float,
) -> None:
    """Numbers of stations on the body plan's lines, heights of waterlines ahead of the bow, buttocks where they end."""
    used: list[tuple[float, float]] = []

    def place(x: float, y: float, words: str, css: str, anchor: str, dx: float, dy: float) -> bool:
        a, b = float(plot.px(x)) + dx, float(plot.py(y)) + dy
        wide = text_width(words, plot.style.note) + 2.0
        if any(abs(a - other) < wide and abs(b - level) < 0.9 * plot.style.note for other, level in used):
            return False
        used.append((a, b))
        plot.text(x, y, words, css, anchor, dx=dx, dy=dy)
        return True

    sections: dict[float, list[Array]] = {}
    for line in lines:
        if line.layer == "STATIONS" and -1e-9 <= line.at <= (1.0 + 1e-9) * length:
            sections.setdefault(line.at, []).append(line.points)
    for at, parts in sorted(sections.items()):
        number = 10.0 * at / length
        if abs(number - round(number)) > 1e-6:
            continue
        points = np.concatenate(parts)
        side = -1.0 if at < 0.5 * length - 1e-6 * length else 1.0
        # sections run together at the side and at the keel: the first height where there is room for the number
        for height in _HEIGHTS:
            nearest = points[int(np.argmin(np.abs(points[:, 2] - height * draft)))]
            if abs(nearest[2] - height * draft) > 0.1 * draft:
                continue
            if place(middle + side * nearest[1], float(nearest[2]), f"{number:.0f}", "", "middle", 0.0, 3.5):
                break
    place(right, 0.0, "BL", "soft", "start", 0.0, 3.5)
    drawn: set[tuple[str, float]] = set()
    for line in lines:
        key = (line.layer, line.at)
        if key in drawn or line.layer not in ("WATERLINES", "DESIGN_WATERLINE", "BUTTOCKS"):
            continue
        drawn.add(key)
        if line.layer == "BUTTOCKS":
            aft = line.points[int(np.argmin(line.points[:, 0]))]
            place(float(aft[0]), float(aft[2]), f"{line.at:.3g}", "level2", "end", -3.0, 3.0)
        else:
            place(right, line.at, f"{line.at:.3g}", "level1", "start", 0.0, 3.5)
