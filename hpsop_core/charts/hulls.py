"""Charts of a hull's form: body plan and sectional areas."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.charts.axis import Axis
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.propulsion import WAITING
from hpsop_core.evaluation.curves import HullLines

_MARGINS = (50.0, 14.0, 8.0, 36.0)


def body_plan_chart(designs: Sequence[tuple[Look, HullLines]], sheet: Sheet) -> Plot:
    """Sections at equal scales: aft body at the left, fore body at the right; the draft as a line."""
    drawn = [line for _, lines in designs for _, parts in lines.sections for line in parts if len(line)]
    half = max((float(np.abs(line[:, 0]).max()) for line in drawn), default=26.0)
    top = max((float(line[:, 1].max()) for line in drawn), default=20.0)
    # equal scales: a body plan that is stretched lies
    share = sheet.style.letters / 11.0
    wide, high = sheet.width - share * (_MARGINS[0] + _MARGINS[1]), sheet.height - share * (_MARGINS[2] + _MARGINS[3])
    scale = min(wide / (2.1 * half), high / (1.06 * top))
    y = Axis("half-breadth y [m]: aft body left, fore body right", (-0.5 * wide / scale, 0.5 * wide / scale))
    z = Axis("height z [m]", (-0.03 * top, high / scale - 0.03 * top), 5)
    plot = Plot(sheet.width, sheet.height, y, z, margins=_MARGINS, style=sheet.style)
    if not designs:
        plot.message(WAITING)
    for look, lines in designs:
        key = look.name
        for station, parts in lines.sections:
            side = -1.0 if station < 10 else 1.0
            for line in parts:
                name = f"station {station:g}, {look.name}"
                plot.line(side * line[:, 0], line[:, 1], f"{look.css} thin", name=name, key=key)
                key = ""
        plot.horizontal(lines.draft, f"{look.css} thin")
    plot.vertical(0.0, "guide")
    return plot


def sectional_area_chart(designs: Sequence[tuple[Look, HullLines]], sheet: Sheet) -> Plot:
    """Immersed sectional area along the ship."""
    top = max((float(lines.area.max()) for _, lines in designs), default=1.0)
    ends = [float(value) for _, lines in designs for value in (lines.area_station.min(), lines.area_station.max())]
    x = Axis("x / L_PP [–] (0: AP, 1: FP)", (min([-0.06, *ends]), max([1.06, *ends])))
    y = Axis("sectional area A [m²]", (0.0, 1.08 * top), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(54, 14, 8, 34), style=sheet.style)
    if not designs:
        plot.message(WAITING)
    for look, lines in designs:
        plot.line(lines.area_station, lines.area, look.css, name=look.name, key=look.name)
    return plot
