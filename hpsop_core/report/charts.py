"""The charts of a report: values in, a matplotlib figure out. Every axis has its title and unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hpsop_core.evaluation.curves import HullLines, ThrustCurves, smooth_open_water, through
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.report.figures import (
    COMPROMISE,
    FRONT,
    INITIAL,
    INK,
    KNEE,
    LEVEL_COLOURS,
    PAPER,
    SIZE,
    SOFT,
    drawing,
    titled,
)
from hpsop_core.typing_aliases import Array

Point = tuple[float, float]


@dataclass(frozen=True)
class Look:
    """How a design appears in every chart: its name, colour and line style."""

    name: str
    colour: str
    line: str = "-"


INITIAL_LOOK = Look("initial", INITIAL, "--")
COMPROMISE_LOOK = Look("compromise", COMPROMISE)


@dataclass(frozen=True)
class PaperPoints:
    """Published points to draw in: values in the chart's units, and what they are."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    marker: str = "x"
    notes: Sequence[str] = field(default_factory=tuple)


def draw_paper_points(axes: Any, points: Sequence[PaperPoints]) -> None:
    """Published points into axes, in one colour that nothing of ours has."""
    for item in points:
        axes.plot(
            item.x, item.y, item.marker, color=PAPER, markersize=6, markeredgewidth=1.5, markerfacecolor="none",
            linestyle="none", label=item.label, zorder=6,
        )  # fmt: skip
        for x, y, note in zip(item.x, item.y, item.notes, strict=False):
            axes.annotate(note, (x, y), (4, 4), textcoords="offset points", color=PAPER, fontsize=7)


def window(core: Sequence[Point], cloud: Array) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits of a Pareto chart: all of ``core``, the better three quarters of a cloud (n, 2), and air round them."""
    limits = []
    for axis in (0, 1):
        values = [point[axis] for point in core]
        if len(cloud):
            values += [float(cloud[:, axis].min()), float(np.quantile(cloud[:, axis], 0.75))]
        low, high = (min(values), max(values)) if values else (0.0, 1.0)
        air = 0.06 * (high - low) or 0.05
        limits.append((low - air, high + air))
    return limits[0], limits[1]


def pareto_chart(
    archive: dict[int, Array],
    infeasible: Array,
    front: Sequence[Point],
    initial: Point | None,
    compromise: Point | None,
    knee: Point | None,
    axis_titles: tuple[str, str],
) -> Figure:
    """Everything evaluated, and what stands out.

    Args:
        archive: level -> (n, 2) objectives of its feasible designs.
        infeasible: (n, 2) of the others, of both levels.
        front: of the last generation, ascending in the first objective.
        initial, compromise, knee: where there are any.
        axis_titles: of the objectives.
    """
    with drawing(SIZE[0], 3.9) as figure:
        axes: Any = figure.add_subplot()
        # Thousands of marks as one picture; everything else stays lines.
        flat: dict[str, Any] = {"rasterized": True, "linewidths": 0.0}
        axes.scatter(*infeasible.T, s=5, color="#b7c0ca", label="infeasible", zorder=1, **flat)
        for level, points in archive.items():
            axes.scatter(
                *points.T, s=7, color=LEVEL_COLOURS[level], label=f"level {level}, feasible", zorder=1 + level, **flat
            )
        if front:
            x, y = zip(*front, strict=True)
            axes.plot(x, y, "o-", color=FRONT, markersize=3, linewidth=0.9, label="front", zorder=4)
        for point, marker, colour, name, size in (
            (initial, "s", INITIAL, "initial", 6),
            (compromise, "*", COMPROMISE, "compromise", 12),
            (knee, "D", KNEE, "knee", 5),
        ):
            if point is not None:
                axes.plot(
                    point[0], point[1], marker, color=colour, markersize=size, label=name, zorder=5,
                    markeredgecolor="white", markeredgewidth=0.6, linestyle="none",
                )  # fmt: skip
        core = [*front, *(p for p in (initial, compromise, knee) if p is not None)]
        clouds = [points for points in archive.values() if len(points)]
        across, up = window(core, np.concatenate(clouds) if clouds else np.zeros((0, 2)))
        axes.set(xlim=across, ylim=up)
        titled(axes, *axis_titles)
        legend = figure.legend(loc="outside lower center", ncols=4, fontsize=7, frameon=False)
        for handle in legend.legend_handles:
            if isinstance(handle, PathCollection):
                handle.set_sizes([16.0])
        return figure


def convergence_chart(generations: Sequence[Generation]) -> Figure:
    """Hypervolume, one series a level, and the feasible share of the population."""
    with drawing(SIZE[0], 3.9) as figure:
        upper: Any
        lower: Any
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        for level in (1, 2):
            own = [item for item in generations if item.level == level]
            if own:
                numbers = [item.number for item in own]
                mark = "o" if len(own) < 3 else ""
                style: dict[str, Any] = {"color": LEVEL_COLOURS[level], "marker": mark, "markersize": 3}
                upper.plot(numbers, [item.hypervolume for item in own], label=f"level {level}", **style)
                lower.plot(numbers, [100.0 * item.feasible_share for item in own], **style)
        upper.set_ylim(bottom=0.0)
        lower.set_ylim(0.0, 104.0)
        upper.set_ylabel("hypervolume [–]")
        titled(lower, "generation [–]", "feasible [%]")
        upper.legend(loc="lower right")
        figure.align_ylabels()
        return figure


def open_water_chart(
    designs: Sequence[tuple[Look, Evaluation]], paper: Sequence[PaperPoints] = (), required: bool = True
) -> Figure:
    """KT, 10KQ and efficiency over J; the required KT of each condition and the operating points."""
    with drawing(SIZE[0], 3.9) as figure:
        axes: Any = figure.add_subplot()
        top = 0.8
        drawn: list[tuple[Array, Array, Array, Array]] = []
        for look, evaluation in designs:
            if evaluation.open_water is None:
                continue
            j, kt, kq, eta = smooth_open_water(evaluation.open_water)
            top = max(top, float(np.nanmax(kq)), float(np.nanmax(eta)))
            style: dict[str, Any] = {"color": look.colour, "linestyle": look.line, "linewidth": 1.2}
            for number, values in enumerate((kt, kq, eta)):
                axes.plot(j, values, label=look.name if number == 0 else None, **style)
            drawn.append((j, kt, kq, eta))
            for condition in evaluation.conditions if required else ():
                at = condition.advance_coefficient
                parabola = condition.thrust_coefficient / at**2 * j**2
                shown = parabola <= 1.6 * condition.thrust_coefficient
                axes.plot(j[shown], parabola[shown], ":", color=look.colour, linewidth=1.0)
                for height in (condition.thrust_coefficient, condition.open_water_efficiency):
                    axes.plot(at, height, "o", color=look.colour, markersize=4, markeredgecolor="white", zorder=5)
                axes.plot([at, at], [0.0, condition.open_water_efficiency], color=look.colour, linewidth=0.5, alpha=0.6)
        _name_curves(axes, drawn)
        draw_paper_points(axes, paper)
        axes.set_ylim(0.0, 1.04 * top)
        titled(axes, "advance coefficient $J$ [–]", "$K_T$, $10K_Q$, $\\eta_0$ [–]")
        handles, names = axes.get_legend_handles_labels()
        if required:
            handles.append(Line2D([], [], linestyle=":", color=SOFT, linewidth=1.0))
            names.append("required $K_T$")
        figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False)
        return figure


def _name_curves(axes: Any, drawn: Sequence[tuple[Array, Array, Array, Array]]) -> None:
    """KT, 10KQ and eta0 where the three are apart: at low J, at the peak, and where the thrust has nearly gone."""
    if not drawn:
        return
    j = drawn[0][0]
    late, peak = int(0.76 * len(j)), int(np.nanargmax(drawn[0][3]))
    for place, height, word, shift in (
        (1, max(float(kq[1]) for _, _, kq, _ in drawn), "$10K_Q$", (3, 4)),
        (peak, max(float(np.nanmax(eta)) for *_, eta in drawn), "$\\eta_0$", (-4, 4)),
        (late, min(float(np.nan_to_num(kt[late])) for _, kt, _, _ in drawn), "$K_T$", (-16, -9)),
    ):
        axes.annotate(word, (j[place], height), shift, textcoords="offset points", color=INK)


def resistance_chart(
    designs: Sequence[tuple[Look, Sequence[ResistancePoint], Evaluation]],
    which: str,
    paper: Sequence[PaperPoints] = (),
) -> Figure:
    """Wave ("wave") or total ("total") resistance over Froude number, the conditions marked."""
    name = f"{which}_resistance"
    word = "wave resistance $R_W$ [MN]" if which == "wave" else "total resistance $R_T$ [MN]"
    with drawing() as figure:
        axes: Any = figure.add_subplot()
        for look, points, evaluation in designs:
            froude = np.array([point.froude_number for point in points])
            force = np.array([1e-6 * getattr(point, name) for point in points])
            axes.plot(*through(froude, force), look.line, color=look.colour, label=look.name)
            for condition in evaluation.conditions:
                height = 1e-6 * getattr(condition, name)
                axes.plot(condition.froude_number, height, "o", color=look.colour, markersize=4)
        draw_paper_points(axes, paper)
        axes.set_ylim(bottom=0.0)
        titled(axes, "Froude number $Fn$ [–]", word)
        axes.legend(loc="upper left")
        return figure


def thrust_chart(designs: Sequence[tuple[Look, ThrustCurves, Evaluation]], paper: Sequence[PaperPoints] = ()) -> Figure:
    """Thrust that the hull asks for, and that the propeller gives at each condition's rate of rotation."""
    with drawing(SIZE[0], 3.9) as figure:
        axes: Any = figure.add_subplot()
        highest = 0.0
        for look, curves, evaluation in designs:
            axes.plot(
                *through(curves.froude_number, 1e-6 * curves.required), look.line, color=look.colour,
                label=f"required $R_T/(1-t)$, {look.name}",
            )  # fmt: skip
            for number, (condition, available) in enumerate(zip(evaluation.conditions, curves.available, strict=True)):
                label = f"available at {condition.rotation_rate_rpm:.0f} 1/min"
                shape = (":", "-.", (0, (1, 3)), (0, (5, 1, 1, 1)))[number]
                axes.plot(
                    *through(curves.froude_number, 1e-6 * available), linestyle=shape, color=look.colour, linewidth=1.0,
                    label=f"{label}, {look.name}",
                )  # fmt: skip
                axes.plot(condition.froude_number, 1e-6 * condition.thrust, "o", color=look.colour, markersize=4)
                highest = max(highest, 1e-6 * condition.thrust)
        draw_paper_points(axes, paper)
        published = [y for item in paper for y in item.y]
        axes.set_ylim(0.0, 1.25 * max([highest, *published], default=1.0))
        titled(axes, "Froude number $Fn$ [–]", "thrust $T$ [MN]")
        figure.legend(loc="outside lower center", ncols=2, fontsize=6.6, frameon=False)
        return figure


def body_plan_chart(designs: Sequence[tuple[Look, HullLines]]) -> Figure:
    """Sections at equal scales: aft body to the left, fore body to the right."""
    with drawing(SIZE[0], 3.7) as figure:
        axes: Any = figure.add_subplot()
        for look, lines in designs:
            for station, parts in lines.sections:
                side = -1.0 if station < 10 else 1.0
                for part in parts:
                    axes.plot(side * part[:, 0], part[:, 1], look.line, color=look.colour, linewidth=0.8)
            axes.axhline(lines.draft, color=look.colour, linestyle=look.line, linewidth=0.6)
            axes.plot([], [], look.line, color=look.colour, label=look.name)
        axes.axvline(0.0, color=SOFT, linewidth=0.6)
        axes.set_aspect("equal")
        titled(axes, "half-breadth $y$ [m]; aft body left, fore body right", "height above baseline $z$ [m]")
        figure.legend(loc="outside lower center", ncols=2, frameon=False)
        return figure


def sectional_area_chart(designs: Sequence[tuple[Look, HullLines]]) -> Figure:
    """Immersed sectional area along the ship."""
    with drawing() as figure:
        axes: Any = figure.add_subplot()
        for look, lines in designs:
            axes.plot(lines.area_station, lines.area, look.line, color=look.colour, label=look.name)
        axes.set_ylim(bottom=0.0)
        titled(axes, "station $x/L_{PP}$ from AP [–]", "sectional area $A$ [m²]")
        axes.legend(loc="lower center")
        return figure


def evolution_chart(
    fronts: Sequence[tuple[str, str, Sequence[Point]]], axis_titles: tuple[str, str], paper: Sequence[PaperPoints]
) -> Figure:
    """Fronts of several generations: (label, colour, points ascending in the first objective)."""
    with drawing(SIZE[0], 3.9) as figure:
        axes: Any = figure.add_subplot()
        for label, colour, points in fronts:
            x, y = zip(*points, strict=True)
            axes.plot(x, y, ".-", color=colour, markersize=4, linewidth=0.8, label=label)
        draw_paper_points(axes, paper)
        titled(axes, *axis_titles)
        figure.legend(loc="outside lower center", ncols=3, fontsize=7, frameon=False)
        return figure
