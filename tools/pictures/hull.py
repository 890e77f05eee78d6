"""Pictures of the hull family for the documentation.

python -m tools.pictures.hull --to docs/pictures
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.geometry.hull.hull import Hull, ParentHull, load_parent_hull
from hpsop_core.geometry.hull.mesh import hull_view_parts
from tools.pictures.plotting import pyplot
from tools.pictures.shading import ShadedPart, render

BLOCK_COEFFICIENTS = (0.60, 0.63, 0.66, 0.69, 0.72, 0.75)
CENTRE_SHIFTS = (-0.01, -0.005, 0.0, 0.005, 0.01)
_COLOURS = {
    "main": "#2b6cb0", "counter": "#2f855a", "skeg": "#c05621", "bulb": "#6b46c1", "topsides_mid": "#a0aec0",
    "topsides_aft": "#b7a57a", "topsides_stern": "#cbb994", "topsides_bow": "#d69e9e",
}  # fmt: skip


def body_plan(axes: Any, hull: Hull, stations: Sequence[float], underwater_only: bool = False, **style: Any) -> None:
    """Sections into axes: afterbody to the left, forebody to the right."""
    middle = 0.5 * hull.length
    for x, lines in zip(stations, hull.sections(np.array(stations), 161, underwater_only), strict=True):
        side = 1.0 if x > middle else -1.0
        for line in lines:
            axes.plot(side * line[:, 1], line[:, 2], **style)
    axes.set_aspect("equal")


def _stations(hull: Hull) -> list[float]:
    part = np.array([-0.015, -0.004, 0.008, 0.02, 0.033, 0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.499,
                     0.501, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.985, 0.996, 1.006, 1.017,
                     1.026])  # fmt: skip
    return [float(value) for value in part * hull.length]


def picture_body_plan(hull: Hull, to: Path) -> None:
    """Body plan of a hull, with the design waterline and the shaft."""
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(9.0, 6.2), dpi=110)
    body_plan(axes, hull, _stations(hull), color="#2b6cb0", linewidth=0.9)
    axes.axhline(hull.draft, color="#718096", linewidth=0.8, linestyle="--")
    axes.axvline(0.0, color="#718096", linewidth=0.8)
    axes.plot(0.0, hull.shaft_height, "o", markersize=4, color="#c05621")
    axes.set(xlabel="half-breadth [m], afterbody left, forebody right", ylabel="height [m]")
    axes.set_ylim(top=1.09 * hull.parent.deck_height)
    axes.set_title(f"{hull.parent.name.upper()} body plan, {hull.length:g} x {hull.breadth:g} x {hull.draft:g} m")
    axes.grid(alpha=0.25)
    # Sections that part at the deck carry their x in percent of the length; the others are named in the documentation.
    for x, lines in zip(_stations(hull), hull.sections(np.array(_stations(hull)), 3), strict=True):
        if x > 0.89 * hull.length:
            axes.annotate(f"{100 * x / hull.length:.3g}", (lines[-1][-1, 1], hull.parent.deck_height), fontsize=7,
                          rotation=60, ha="left", va="bottom", xytext=(0, 1), textcoords="offset points")  # fmt: skip
    figure.tight_layout()
    figure.savefig(to)
    plt.close(figure)


def picture_profile_and_patches(hull: Hull, to: Path) -> None:
    """Side view of all patches with iso-parametric lines, stern and bow enlarged, and the waterline in plan."""
    plt = pyplot()
    figure = plt.figure(figsize=(11.0, 8.0), dpi=90)
    grid = figure.add_gridspec(3, 2, height_ratios=[0.75, 2.4, 0.9])
    whole, stern, bow = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    plan = figure.add_subplot(grid[2, :])
    for axes, rows, columns in ((whole, 60, 9), (stern, 120, 17), (bow, 120, 17)):
        for patch in hull.patches:
            colour = _COLOURS.get(patch.name, "#4a5568")
            points = patch.evaluate(np.linspace(0.0, 1.0, rows), np.linspace(0.0, 1.0, columns))
            for line in points[:: 2 if rows > 60 else 1]:
                axes.plot(line[:, 0], line[:, 2], color=colour, linewidth=0.4)
            for column in range(columns):
                edge = column in (0, columns - 1)
                axes.plot(points[:, column, 0], points[:, column, 2], color=colour, linewidth=1.2 if edge else 0.4)
        axes.axhline(hull.draft, color="black", linewidth=0.6, linestyle="--")
        axes.set_aspect("equal")
    factor = hull.length / 355.0
    stern.set(xlim=(-8 * factor, 32 * factor), ylim=(-0.5, 24), title="stern: counter, skeg with boss, aperture")
    bow.set(xlim=(334 * factor, 369 * factor), ylim=(-0.5, 24), title="bow: main patch and bulb")
    axis = [hull.boss_end_x - 7 * factor, hull.boss_end_x]
    stern.plot(axis, [hull.shaft_height] * 2, color="#c05621", linestyle="-.", linewidth=0.8)
    waterline = hull.waterline(400)
    plan.plot(waterline[:, 0], waterline[:, 1], color="#2b6cb0")
    plan.set(xlabel="x from the aft perpendicular [m]", ylabel="y [m]", title="design waterline")
    plan.grid(alpha=0.25)
    keys = [plt.Line2D([], [], color=_COLOURS.get(patch.name, "#4a5568"), label=patch.name) for patch in hull.patches]
    figure.legend(handles=keys, loc="upper center", ncols=len(keys), fontsize=8, frameon=False)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.965))
    figure.savefig(to)
    plt.close(figure)


def picture_solid(hull: Hull, to: Path) -> None:
    """Shaded views of the hull: from ahead, from astern, the stern from below and the bow."""
    plt = pyplot()
    colours = {"underwater": (0.75, 0.28, 0.22), "topsides": (0.36, 0.52, 0.70)}
    parts = [ShadedPart(*mesh, colours[name]) for name, mesh in hull_view_parts(hull, "view").items()]
    factor = hull.length / 355.0
    views = (
        ("from ahead", -38.0, 20.0, None),
        ("from astern", 214.0, 14.0, None),
        ("stern from below: counter, aperture, boss, skeg", 222.0, -12.0, ((11.0 * factor, 0.0, 8.0), 17.0 * factor)),
        ("bow and bulb", -38.0, 6.0, ((356.0 * factor, 0.0, 16.0), 28.0 * factor)),
    )
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 7.6), dpi=90)
    for (title, azimuth, elevation, focus), place in zip(views, axes.flat, strict=True):
        place.imshow(render(parts, azimuth, elevation, focus, 520, 350))
        place.set_title(title, fontsize=9)
        place.set_axis_off()
    figure.tight_layout()
    figure.savefig(to)
    plt.close(figure)


def picture_family(parent: ParentHull, to: Path) -> None:
    """Body plans and sectional-area curves over the range of block coefficients and centres of buoyancy."""
    plt = pyplot()
    figure, axes = plt.subplots(2, 2, figsize=(11.5, 7.0), dpi=90, width_ratios=[1.35, 1.0])
    length, breadth, draft = parent.length, parent.breadth, parent.draft
    box = length * breadth * draft
    own = parent.hydrostatics.displaced_volume
    cases = (
        [(f"CB {cb:.2f}", parent.transform(length, breadth, draft, cb * box)) for cb in BLOCK_COEFFICIENTS],
        [(f"LCB {100 * s:+.1f} % L", parent.transform(length, breadth, draft, own, s * length)) for s in CENTRE_SHIFTS],
    )
    for row, family in enumerate(cases):
        colours = plt.get_cmap("viridis")(np.linspace(0.0, 0.9, len(family)))
        for (label, hull), colour in zip(family, colours, strict=True):
            parts = (0.1, 0.2, 0.3, 0.499, 0.7, 0.8, 0.9)
            body_plan(axes[row, 0], hull, [p * length for p in parts], True, color=colour, linewidth=0.9)
            hydro = hull.hydrostatics
            stretch = hull.shift.least_stretch()
            axes[row, 1].plot(hydro.sectional_area_x, hydro.sectional_area, color=colour, linewidth=1.1,
                              label=f"{label}  (least dx'/dx {stretch:.2f})")  # fmt: skip
        axes[row, 0].set(title="stations .1 .2 .3 .5 L | .7 .8 .9 L", xlabel="y [m]", ylabel="z [m]")
        axes[row, 1].set(title="sectional area [m²]", xlabel="x from the aft perpendicular [m]")
        axes[row, 1].legend(fontsize=8)
        axes[row, 1].grid(alpha=0.25)
    figure.tight_layout()
    figure.savefig(to)
    plt.close(figure)


def main() -> None:
    """Makes every picture."""
    parser = argparse.ArgumentParser(description="Pictures of the hull family.")
    parser.add_argument("--to", type=Path, default=Path("docs/pictures"))
    folder = parser.parse_args().to
    folder.mkdir(parents=True, exist_ok=True)
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    picture_body_plan(hull, folder / "hull-body-plan.png")
    picture_profile_and_patches(hull, folder / "hull-patches.png")
    picture_solid(hull, folder / "hull-solid.png")
    picture_family(parent, folder / "hull-family.png")


if __name__ == "__main__":
    main()
