"""The Rankine solver's pictures in docs/pictures.

python -m tools.pictures.rankine --to docs/pictures
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.geometry.analytic_bodies import wigley_panels
from hpsop_core.geometry.hull.panels import block_points
from hpsop_core.hydro.michell import wave_coefficients
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.rankine.solver import RankineFields, solve, solve_panels
from hpsop_core.typing_aliases import Array
from hpsop_core.validation import rankine_studies as studies
from hpsop_core.validation.rankine import tank_points
from tools.pictures.plotting import pyplot

_DPI = 100
_FROUDE_COLOURS = ("#1f5fa8", "#c0392b")


def waves_picture(file: Path) -> None:
    """Wave patterns and hull pressure of the parent at both conditions."""
    plt = pyplot()
    hull = studies.parent_hull_itself()
    result = solve(hull, studies.FROUDE_NUMBERS, fields=True)
    figure, axes = plt.subplots(4, 1, figsize=(11, 11), height_ratios=[3, 0.75, 3, 0.75], layout="constrained")
    for k, condition in enumerate(result.conditions):
        fields = condition.fields
        if fields is None:
            continue
        _pattern(figure, axes[2 * k], fields, condition.froude_number)
        _pressure(figure, axes[2 * k + 1], fields)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def _pattern(figure: Any, axes: Any, fields: RankineFields, froude_number: float) -> None:
    limit = 2.5
    levels = np.linspace(-limit, limit, 26)
    elevation = np.clip(fields.elevation, -limit, limit)
    for side in (1.0, -1.0):
        filled = axes.contourf(fields.x, side * fields.y, elevation, levels=levels, cmap="RdBu_r")
    # The strip between the two innermost rows, where no hull lies in it.
    length = float(np.max(fields.quads[..., 0]))
    for free in (fields.x[:, 0] < 0.0, fields.x[:, 0] > length):
        x, y, value = (grid[free, :1] for grid in (fields.x, fields.y, elevation))
        strip = np.hstack([x, x]), np.hstack([-y, y]), np.hstack([value, value])
        axes.contourf(*strip, levels=levels, cmap="RdBu_r")
    axes.set(aspect="equal", ylabel="y [m]", xlim=(-310, 480), ylim=(-170, 170))
    axes.set_title(f"Fn {froude_number:g}: elevation [m] and pressure on the hull, x forward from AP", loc="left")
    figure.colorbar(filled, ax=axes, shrink=0.8, ticks=np.arange(-2.0, 2.5), aspect=15)


def _pressure(figure: Any, axes: Any, fields: RankineFields) -> None:
    start = 0
    for grid, (_, along, across) in zip(block_points(fields.quads, fields.blocks), fields.blocks, strict=True):
        values = fields.pressure_coefficient[start : start + along * across].reshape(along, across)
        start += along * across
        drawn = axes.pcolormesh(grid[..., 0], grid[..., 2], values, cmap="viridis", vmin=-0.3, vmax=0.3)
    axes.set(xlim=(-10, 375), ylim=(-2, 17), ylabel="z [m]")
    figure.colorbar(drawn, ax=axes, label="Cp", ticks=(-0.3, 0.0, 0.3), aspect=6)


def tank_picture(file: Path) -> None:
    """The parent beside its towing tests."""
    plt = pyplot()
    hull = studies.parent_hull_itself()
    rows = tank_points()
    numbers = np.round(np.arange(0.16, 0.3001, 0.005), 4)
    result = solve(hull, numbers.tolist())
    table = hull.offset_table()
    thin = wave_coefficients(table.x, table.z, table.y, hull.length, hull.hydrostatics.wetted_surface, numbers.tolist())
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    plane = np.array([c.wave_coefficient for c in result.conditions])
    pressure = np.array([c.wave_coefficient_pressure for c in result.conditions])
    tank_numbers = np.array([row["froude_number"] for row in rows])
    left.plot(numbers, 1e4 * plane, color="#1f5fa8", label="Rankine, momentum plane (the objective)")
    left.plot(numbers, 1e4 * pressure, "--", color="#1f5fa8", lw=1, label="Rankine, pressure (cross-check)")
    left.plot(numbers, 1e3 * thin, ":", color="grey", label="Michell / 10")
    left.plot(tank_numbers, [1e4 * row["wave_coefficient"] for row in rows], "ko", ms=5, label="tank, k = 0.094")
    left.set(xlabel="Fn", ylabel="10^4 Cw", ylim=(0, 14))
    left.legend(fontsize=8)
    friction = np.array([row["friction_coefficient"] for row in rows])
    ours = (1.0 + studies.FORM_FACTOR) * friction + np.interp(tank_numbers, numbers, plane)
    right.plot(tank_numbers, 1e3 * ours, color="#1f5fa8", label="1.094 CF + Cw, Rankine")
    right.plot(
        tank_numbers, [1e3 * row["total_coefficient"] for row in rows], "ko", ms=5, label="tank, CT of the model"
    )
    right.fill_between(tank_numbers, 0.94e3 * ours, 1.06e3 * ours, color="#1f5fa8", alpha=0.12, label="6 %")
    right.set(xlabel="Fn", ylabel="10^3 CT")
    right.legend(fontsize=8)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def wigley_picture(file: Path) -> None:
    """The Wigley hull beside thin-ship theory, and the thin-ship limit."""
    plt = pyplot()
    numbers = np.round(np.arange(0.22, 0.4201, 0.008), 4)
    settings = RankineSettings()
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    for axes, breadth in zip(panels, (0.1, 0.02), strict=True):
        hull = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise, breadth=breadth)
        conditions = solve_panels(hull, numbers.tolist(), settings).conditions
        scale = 1e3 * (0.1 / breadth) ** 2
        michell = studies.wigley_michell(hull, breadth, numbers.tolist())
        axes.plot(numbers, scale * michell, ":", color="grey", label="Michell")
        axes.plot(numbers, [scale * c.wave_coefficient for c in conditions], color="#1f5fa8", label="Rankine, plane")
        values = [scale * c.wave_coefficient_pressure for c in conditions]
        axes.plot(numbers, values, "--", color="#1f5fa8", lw=1, label="Rankine, pressure")
        if breadth == 0.1:
            label = "experiments at .313 (range, mean)"
            axes.errorbar([0.313], [1.70], yerr=[[0.3], [0.2]], fmt="ko", ms=4, capsize=3, label=label)
        axes.set(xlabel="Fn", ylabel="10^3 Cw" + ("" if breadth == 0.1 else " x 25"), ylim=(0, 4))
        axes.set_title(f"Wigley hull, B/L {breadth:g}", fontsize=10)
        axes.legend(fontsize=8)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def block_picture(file: Path) -> None:
    """Wave resistance over the block coefficient at the parent's dimensions, for three positions of LCB."""
    plt = pyplot()
    ratios = np.linspace(0.905, 1.14, 48)
    own_blocks = ratios
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
    shoulder = studies.shoulder_at(ratios)
    for shift, style in ((0.0, "-"), (0.01, "--"), (-0.01, ":")):
        blocks, areas = studies.sweep_displacement(ratios, shift)
        own_blocks = blocks if shift == 0.0 else own_blocks
        for k, axes in enumerate(panels):
            label = f"LCB {100 * shift:+.0f} % Lpp" if shift else "LCB of the parent"
            axes.plot(blocks, areas[:, k] * 1025.0 * 9.80665 / 1e6, style, color=_FROUDE_COLOURS[k], label=label)
    parent = studies.parent_hull_itself()
    own = studies.wave_areas(parent) * 1025.0 * 9.80665 / 1e6
    for k, axes in enumerate(panels):
        axes.plot([parent.hydrostatics.block_coefficient], [own[k]], "ko", ms=5, label="parent")
        axes.set(xlabel="block coefficient", ylabel="Rw [MN]", ylim=(0, None))
        _shoulder_axis(axes, own_blocks, shoulder / (2.0 * np.pi * studies.FROUDE_NUMBERS[k] ** 2 * parent.length))
        axes.set_title(f"Fn {studies.FROUDE_NUMBERS[k]:g}", loc="left")
        axes.legend(fontsize=8)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def _shoulder_axis(axes: Any, blocks: Array, waves: Array) -> None:
    """A second scale on top: the fore shoulder aft of FP in transverse wave lengths (LCB of the parent)."""
    ticks = np.arange(np.ceil(10.0 * waves.min()), 10.0 * waves.max()) / 10.0
    top = axes.secondary_xaxis("top")
    top.set_xticks(np.interp(-ticks, -waves, blocks), [f"{tick:.1f}" for tick in ticks])
    top.set_xlabel("fore shoulder aft of FP / wave length (LCB of the parent)", fontsize=9)


def objective_picture(file: Path) -> None:
    """Smoothness over the ratios: the curves, and what a cubic leaves of them."""
    plt = pyplot()
    figure, panels = plt.subplots(2, 2, figsize=(11, 6), height_ratios=[2, 1], sharex="col", layout="constrained")
    for column, (name, low, high) in enumerate((("length_to_breadth", 6.5, 8.5), ("breadth_to_draft", 3.0, 4.5))):
        at = np.linspace(low, high, 41)
        areas = studies.sweep_ratio(name, at)
        for k in range(2):
            values: Array = areas[:, k] * 1025.0 * 9.80665 / 1e6
            fitted = np.polyval(np.polyfit(at - at.mean(), values, 3), at - at.mean())
            label = f"Fn {studies.FROUDE_NUMBERS[k]:g}"
            panels[0, column].plot(at, values, ".-", color=_FROUDE_COLOURS[k], ms=3, label=label)
            panels[1, column].plot(at, 100.0 * (values / fitted - 1.0), ".-", color=_FROUDE_COLOURS[k], ms=3)
        panels[0, column].set(ylabel="Rw [MN]", ylim=(0, None))
        panels[0, column].legend(fontsize=8)
        panels[1, column].set(xlabel=name.replace("_", " "), ylabel="off a cubic [%]", ylim=(-0.2, 0.2))
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def main() -> None:
    """Make all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--to", type=Path, required=True)
    folder = parser.parse_args().to
    folder.mkdir(parents=True, exist_ok=True)
    waves_picture(folder / "rankine-waves.png")
    tank_picture(folder / "rankine-tank.png")
    wigley_picture(folder / "rankine-wigley.png")
    block_picture(folder / "rankine-block-coefficient.png")
    objective_picture(folder / "rankine-objective.png")


if __name__ == "__main__":
    main()
