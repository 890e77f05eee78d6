"""Charts of designs: open water, resistance, thrust, body plan, sectional areas, convergence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.charts.plot import Plot, legend, padded, smooth
from hpsop_core.evaluation.curves import HullLines
from hpsop_core.evaluation.result import Evaluation

Array = NDArray[np.float64]
_SUBSCRIPTS = "₁₂₃₄"


@dataclass(frozen=True)
class Series:
    """A design on a chart: its name, CSS colour class and dash class."""

    name: str
    css: str
    dash: str = ""


@dataclass(frozen=True)
class DesignCurves:
    """What is computed for a shown design beyond its evaluation.

    Attributes:
        froude_number: (n,) on the design's own length.
        speed: (n,) m/s.
        total_resistance, wave_resistance: (n,) N.
        thrust_required: (n,) N: Rt/(1 - t).
        thrust_available: for each condition (n,) N: what the propeller gives at that condition's rate of rotation.
        level: of the resistance.
    """

    froude_number: Array
    speed: Array
    total_resistance: Array
    wave_resistance: Array
    thrust_required: Array
    thrust_available: tuple[Array, ...]
    level: int


def open_water_chart(designs: Sequence[tuple[Series, Evaluation]], width: float, height: float) -> str:
    """KT, 10KQ and efficiency against J, the required KT of each condition, and the operating points."""
    curves = [(series, item.open_water, item) for series, item in designs if item.open_water is not None]
    longest = max((max(curve.advance_coefficient) for _, curve, _ in curves), default=1.2)
    top = 0.9
    for _, curve, _ in curves:
        top = max(top, 1.04 * max(curve.open_water_efficiency), 10.4 * max(curve.torque_coefficient))
    plot = Plot(
        width,
        height,
        (0.0, longest),
        (0.0, min(top, 1.4)),
        "advance coefficient J [–]",
        "K_T, 10K_Q, η₀ [–]",
        margins=(48, 12, 8, 34),
    )
    if not curves:
        plot.message("no open-water curves for this design")
    for index, (series, curve, evaluation) in enumerate(curves):
        computed = np.asarray(curve.advance_coefficient)
        j, kt = smooth(computed, curve.thrust_coefficient)
        kq = 10.0 * smooth(computed, curve.torque_coefficient)[1]
        with np.errstate(divide="ignore", invalid="ignore"):
            # from the smooth KT and KQ, so that the curve keeps its shape where it falls to nothing
            eta = np.where((kt > 0.0) & (kq > 0.0), 10.0 * j * kt / (2.0 * np.pi * kq), np.nan)
        css = f"{series.css} {series.dash}"
        for values, word in ((kt, "KT"), (kq, "10KQ"), (eta, "η₀")):
            plot.line(j, np.where(values >= 0.0, values, np.nan), css, title=f"{word}, {series.name}")
        main = index == len(curves) - 1
        if main:
            for values, word in ((kt, "K_T"), (kq, "10K_Q"), (eta, "η₀")):
                plot.text(j[0], values[0], word, anchor="end", dx=-5, dy=4)
        for number, condition in enumerate(evaluation.conditions):
            if not condition.advance_coefficient > 0.0:
                continue
            needed = condition.thrust_coefficient / condition.advance_coefficient**2 * j**2
            needed = np.where(needed <= plot.y_limits[1], needed, np.nan)
            if main or series.name == "initial":
                plot.line(j, needed, f"required {series.css}", title=f"required KT, condition {number + 1}")
            at, label = condition.advance_coefficient, f"J{_SUBSCRIPTS[number]} {condition.advance_coefficient:.4f}"
            plot.mark(
                at,
                condition.thrust_coefficient,
                "circle",
                3.6,
                _solid(series.css),
                title=f"{series.name}: {label}, KT {condition.thrust_coefficient:.4f}",
            )
            plot.mark(
                at,
                condition.open_water_efficiency,
                "circle",
                3.0,
                _solid(series.css),
                title=f"{series.name}: {label}, η₀ {condition.open_water_efficiency:.4f}",
            )
            if main:
                others = [item.advance_coefficient for item in evaluation.conditions if item is not condition]
                # two conditions may nearly coincide: their names then stand on either side
                right = all(at >= other for other in others)
                plot.text(at, 0.0, f"J_{number + 1}", "soft", "start" if right else "end", dx=3 if right else -3, dy=-5)
                plot.raw(
                    f'<path d="M{float(plot.px(at)):.1f} {float(plot.py(condition.open_water_efficiency)):.1f}'
                    f'V{float(plot.py(0.0)):.1f}" class="guide"/>'
                )
    keys = [("line", f"{series.css} {series.dash}", series.name) for series, _, _ in curves]
    keys.append(("dash", "required soft", "required K_T, a condition each"))
    return plot.svg("open_water") + legend(keys)


def _solid(css: str) -> str:
    return "selected-solid" if css == "selected" else css


def resistance_chart(
    designs: Sequence[tuple[Series, Evaluation, DesignCurves]], which: str, width: float, height: float
) -> str:
    """Wave ("wave") or total ("total") resistance against Froude number (the paper's figures 6 and 7)."""
    word = "wave resistance R_W [MN]" if which == "wave" else "total resistance R_T [MN]"

    def values(curves: DesignCurves) -> Array:
        return 1e-6 * (curves.wave_resistance if which == "wave" else curves.total_resistance)

    x = [curves.froude_number for _, _, curves in designs]
    y = [values(curves) for _, _, curves in designs]
    x_limits = padded(np.concatenate(x), 0.0) if x else (0.16, 0.3)
    y_limits = (0.0, padded(np.concatenate(y), 0.06, (0.0,))[1]) if y else (0.0, 1.0)
    plot = Plot(width, height, x_limits, y_limits, "Froude number Fn [–]", word, margins=(48, 12, 8, 34))
    if not designs:
        plot.message("computing …")
    for series, evaluation, curves in designs:
        plot.line(*smooth(curves.froude_number, values(curves)), f"{series.css} {series.dash}", title=series.name)
        for number, condition in enumerate(evaluation.conditions):
            force = condition.wave_resistance if which == "wave" else condition.total_resistance
            plot.mark(
                condition.froude_number,
                1e-6 * force,
                "circle",
                3.6,
                _solid(series.css),
                title=f"{series.name}, condition {number + 1}: {1e-3 * force:,.0f} kN",
            )
    keys = [("line", f"{series.css} {series.dash}", series.name) for series, _, _ in designs]
    return plot.svg(f"resistance_{which}") + legend(keys)


def thrust_chart(designs: Sequence[tuple[Series, Evaluation, DesignCurves]], width: float, height: float) -> str:
    """Thrust required by the hull, and given by the propeller at each condition's rate, against Fn (figure 9)."""
    x = [curves.froude_number for _, _, curves in designs]
    # high enough for the operating points with air above; the steep ends of the curves may leave the chart
    top = [1.75e-6 * condition.thrust for _, evaluation, _ in designs for condition in evaluation.conditions]
    x_limits = padded(np.concatenate(x), 0.0) if x else (0.16, 0.3)
    plot = Plot(
        width,
        height,
        x_limits,
        (0.0, max(top, default=1.0)),
        "Froude number Fn [–]",
        "thrust T [MN]",
        margins=(48, 12, 8, 34),
    )
    if not designs:
        plot.message("computing …")
    for index, (series, evaluation, curves) in enumerate(designs):
        plot.line(
            *smooth(curves.froude_number, 1e-6 * curves.thrust_required),
            f"{series.css} {series.dash}",
            title=f"required, {series.name}",
        )
        for number, (condition, available) in enumerate(
            zip(evaluation.conditions, curves.thrust_available, strict=False)
        ):
            plot.line(
                *smooth(curves.froude_number, 1e-6 * available),
                f"{series.css} dot thin",
                title=f"available at {condition.rotation_rate_rpm:.1f} rpm, {series.name}",
            )
            plot.mark(
                condition.froude_number,
                1e-6 * condition.thrust,
                "circle",
                3.6,
                _solid(series.css),
                title=f"{series.name}, condition {number + 1}: T {1e-3 * condition.thrust:,.0f} kN at "
                f"{condition.rotation_rate_rpm:.1f} rpm",
            )
        if index == len(designs) - 1:
            for number, (condition, available) in enumerate(
                zip(evaluation.conditions, curves.thrust_available, strict=False)
            ):
                finite = np.flatnonzero(np.isfinite(available))
                if finite.size:
                    plot.text(
                        float(curves.froude_number[finite[0]]),
                        1e-6 * float(available[finite[0]]),
                        f"n_{number + 1} = {condition.rotation_rate_rpm:.1f} rpm",
                        dx=5,
                        dy=-5,
                    )
    keys = [("line", f"{series.css} {series.dash}", f"required, {series.name}") for series, _, _ in designs]
    keys.append(("line", "soft dot thin", "available at each condition's n"))
    return plot.svg("thrust") + legend(keys)


def body_plan(designs: Sequence[tuple[Series, HullLines]], width: float, height: float) -> str:
    """Sections: aft body at the left, fore body at the right."""
    half = max(
        (
            float(np.abs(line[:, 0]).max())
            for _, lines in designs
            for _, parts in lines.sections
            for line in parts
            if len(line)
        ),
        default=26.0,
    )
    top = max(
        (float(line[:, 1].max()) for _, lines in designs for _, parts in lines.sections for line in parts if len(line)),
        default=20.0,
    )
    # equal scales: a body plan that is stretched lies
    scale = min((width - 64.0) / (2.1 * half), (height - 44.0) / (1.06 * top))
    y_span, z_span = (width - 64.0) / scale, (height - 44.0) / scale
    plot = Plot(
        width,
        height,
        (-y_span / 2, y_span / 2),
        (-0.03 * top, z_span - 0.03 * top),
        "half-breadth y [m]: aft body left, fore body right",
        "height z [m]",
        margins=(50, 14, 8, 36),
    )
    if not designs:
        plot.message("computing …")
    for series, lines in designs:
        for station, parts in lines.sections:
            side = -1.0 if station < 10 else 1.0
            for line in parts:
                plot.line(
                    side * line[:, 0],
                    line[:, 1],
                    f"{series.css} {series.dash} thin",
                    title=f"station {station:g}, {series.name}",
                )
        plot.horizontal(lines.draft, f"{series.css} guide")
    plot.vertical(0.0, "guide")
    return plot.svg("body_plan") + legend([("line", f"{s.css} {s.dash}", s.name) for s, _ in designs])


def sectional_area_chart(designs: Sequence[tuple[Series, HullLines]], width: float, height: float) -> str:
    """Sectional-area curves."""
    top = max((float(lines.area.max()) for _, lines in designs), default=1.0)
    plot = Plot(
        width,
        height,
        (-0.06, 1.06),
        (0.0, 1.08 * top),
        "x / L_PP [–] (0: AP, 1: FP)",
        "sectional area [m²]",
        margins=(54, 14, 8, 34),
    )
    if not designs:
        plot.message("computing …")
    for series, lines in designs:
        plot.line(lines.area_station, lines.area, f"{series.css} {series.dash}", title=series.name)
    return plot.svg("sectional_area") + legend([("line", f"{s.css} {s.dash}", s.name) for s, _ in designs])


def convergence_chart(
    numbers: Sequence[int], levels: Sequence[int], values: Sequence[float], total: int, width: float, height: float
) -> str:
    """Hypervolume of the feasible front, one line for each level."""
    shown = [value for value in values if np.isfinite(value)]
    plot = Plot(
        width,
        height,
        (0.0, float(max(total, 1))),
        padded(shown, 0.08) if shown else (0.0, 1.0),
        "generation [–]",
        "hypervolume [–]",
        margins=(56, 14, 8, 34),
    )
    if not shown:
        plot.message("no generation yet")
    for level in (1, 2):
        at = [index for index, item in enumerate(levels) if item == level]
        if at:
            plot.line([numbers[i] for i in at], [values[i] for i in at], f"level{level}", title=f"level {level}")
            plot.mark(float(numbers[at[-1]]), float(values[at[-1]]), "circle", 3.4, f"level{level}")
    return plot.svg("convergence") + legend([("line", "level1", "level 1"), ("line", "level2", "level 2")])


def best_chart(
    numbers: Sequence[int],
    levels: Sequence[int],
    best: Sequence[tuple[float, float]],
    total: int,
    width: float,
    height: float,
) -> str:
    """The least feasible f1 and f2 of each generation's front; each level divides by its own initial design."""
    values = np.asarray(best, dtype=float).reshape(-1, 2)
    plot = Plot(
        width,
        height,
        (0.0, float(max(total, 1))),
        padded(values, 0.08),
        "generation [–]",
        "least objective on the front [–]",
        margins=(56, 14, 8, 34),
    )
    for level in (1, 2):
        at = np.flatnonzero(np.asarray(levels) == level)
        for column, css in ((0, "pin1"), (1, "pin2")):
            if at.size:
                title = f"least f{column + 1}, level {level}"
                plot.line(np.asarray(numbers)[at], values[at, column], css, title=title)
    return plot.svg("best") + legend([("line", "pin1", "least f₁"), ("line", "pin2", "least f₂")])
