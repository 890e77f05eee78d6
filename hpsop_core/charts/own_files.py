"""What was understood of a hull or propeller file, drawn: the given points beside the surface, profile, columns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.charts.axis import Axis
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.sheet import Placed, sheet_svg
from hpsop_core.charts.style import PRINT, Style
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.input import HullFile, ShipTable
from hpsop_core.geometry.hull.input.deviations import section_deviations
from hpsop_core.geometry.propeller.input import UnderstoodPropeller
from hpsop_core.geometry.propeller.sections import half_thickness, mean_line
from hpsop_core.typing_aliases import Array, IntArray

MOST_STATIONS = 11
# Readings further off than this part of the breadth are marked: 5 cm on a Panamax ship, a line's width on the plan.
NOTED_DEVIATION = 0.0015
BLADE_SECTIONS = (0.3, 0.5, 0.7, 0.9)
_WIDTH, _HEIGHT = 1000.0, 760.0
_SURFACE, _GIVEN, _OFF = "selected", "knee", "published"
_MARGINS = (50.0, 14.0, 8.0, 36.0)
_RADIAL_COLUMNS = (
    (("pitch_ratio", "P/D", _SURFACE), ("chord_ratio", "c/D", "knee")),
    (("thickness_ratio", "t/c", _SURFACE), ("camber_ratio", "f/c", "knee"), ("rake_ratio", "rake/D", "front")),
)


def hull_sheet(file: HullFile) -> str:
    """Body plan with the file's readings, profile and sectional areas as one SVG sheet."""
    parent = file.parent
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    charts = [
        Placed(body_plan(hull, file.table, 560.0, 400.0), 10.0, 26.0, "body plan, aft left; dots: the file; +: shaft"),
        Placed(profile(hull, 490.0, 300.0), 10.0, 450.0, "profile of the fitted patches, heights drawn larger"),
        Placed(areas(hull, file.table, 480.0, 300.0), 510.0, 450.0, "sectional areas: surface, and readings as dots"),
    ]
    lines = [(600.0, 40.0 + 17.0 * k, line) for k, line in enumerate(_words(file))]
    return sheet_svg(_WIDTH, _HEIGHT, charts, lines)


def _words(file: HullFile) -> list[str]:
    told = file.understood
    lines = [
        told.name,
        told.layout,
        f"lengths in {told.unit}",
        *told.axes.split(", "),
        "",
        f"Lpp {told.length:.5g} m,  B {told.breadth:.5g} m,  T {told.draft:.5g} m",
        f"L/B {told.length / told.breadth:.2f},  B/T {told.breadth / told.draft:.2f}",
        f"volume {told.displaced_volume:,.6g} m3,  S {told.wetted_surface:,.6g} m2",
        f"CB {told.block_coefficient:.4f},  CM {told.midship_coefficient:.4f},  CP {told.prismatic_coefficient:.4f}",
        f"LCB {told.buoyancy_centre_percent:+.2f} % of L from midship (+ forward)",
    ]
    if told.fit is not None:
        worst = max(told.fit.patches, key=lambda patch: patch.max_m)
        lines += [
            "",
            f"largest deviation {1e3 * worst.max_m:.3g} mm, patch {worst.patch},",
            f"x {worst.max_at_x_m:.4g} m, z {worst.max_at_z_m:.3g} m",
        ]
    return lines


def _chosen(table: ShipTable, low: float, high: float) -> IntArray:
    """Stations of one half body that are drawn, evenly over their number."""
    wet = np.max(table.y[:, table.z <= table.draft * (1.0 + 1e-9)], axis=1) > 0.0
    inside = np.flatnonzero(wet & (table.x >= low) & (table.x <= high))
    if len(inside) <= MOST_STATIONS:
        return inside
    return np.asarray(inside[np.unique(np.round(np.linspace(0, len(inside) - 1, MOST_STATIONS)).astype(int))])


def body_plan(hull: Hull, table: ShipTable, width: float, height: float, style: Style = PRINT) -> Plot:
    """Sections of the surface at stations of the file, with the file's readings there, at equal scales.

    A reading in the water that the surface leaves by more than ``NOTED_DEVIATION`` of the breadth is marked with its
    distance; the topsides are no part of any number and follow the sheer only.
    """
    bottom, top = float(min(table.z[0], 0.0)), float(table.z[-1])
    wide, high = width - _MARGINS[0] - _MARGINS[1], height - _MARGINS[2] - _MARGINS[3]
    half = float(np.max(table.y))
    scale = min(wide / (2.1 * half), high / (1.08 * (top - bottom)))
    low = bottom - 0.04 * (top - bottom)
    plot = Plot(
        width, height, Axis("half-breadth [m]", (-0.5 * wide / scale, 0.5 * wide / scale)),
        Axis("above the baseline [m]", (low, low + high / scale), 5), margins=_MARGINS, style=style,
    )  # fmt: skip
    ends = [hull.parent.extent(name) for name in hull.parent.underwater]
    first, last = min(e[0] for e in ends), max(e[1] for e in ends)
    inset = 1e-9 * (last - first)
    middle = 0.5 * hull.length
    for side, indices in ((-1.0, _chosen(table, -np.inf, middle)), (1.0, _chosen(table, middle, np.inf))):
        x = np.clip(table.x[indices], first + inset, last - inset)
        for k, lines in zip(indices, hull.sections(x, 121), strict=True):
            for line in lines:
                plot.line(side * line[:, 1], line[:, 2], f"{_SURFACE} thin", name=f"x {table.x[k]:.5g} m")
        for k in indices:
            positive = np.flatnonzero(table.y[k] > 0.0)
            plot.dots(side * table.y[k, positive], table.z[positive], 1.5, _GIVEN)
        _mark_deviations(plot, hull, table, indices, side)
    plot.horizontal(hull.draft, "guide")
    plot.vertical(0.0, "guide")
    plot.mark(0.0, hull.parent.shaft_height, "plus", 5.0, "open ink")
    return plot


def _mark_deviations(plot: Plot, hull: Hull, table: ShipTable, indices: IntArray, side: float) -> None:
    for k, distances in zip(indices, section_deviations(hull, table, indices), strict=True):
        wet = table.z <= hull.draft * (1.0 + 1e-9)
        for level in np.flatnonzero(wet & (distances > NOTED_DEVIATION * hull.breadth)):
            words = f"{1e3 * distances[level]:.3g} mm off at x {table.x[k]:.5g} m, z {table.z[level]:.4g} m"
            plot.mark(side * table.y[k, level], table.z[level], "square", 4.0, f"open {_OFF}", title=words)


def profile(hull: Hull, width: float, height: float, style: Style = PRINT) -> Plot:
    """Outlines of the fitted patches from the side."""
    lines: list[Array] = []
    along, across = np.linspace(0.0, 1.0, 201), np.linspace(0.0, 1.0, 41)
    for name in (*hull.parent.underwater, *hull.parent.topsides):
        edges = hull.patch_points(name, along, np.array([0.0, 1.0]))
        ends = hull.patch_points(name, np.array([0.0, 1.0]), across)
        lines += [edges[:, 0], edges[:, 1], ends[0], ends[1]]
    points = np.concatenate(lines)
    (x0, _, z0), (x1, _, z1) = points.min(axis=0), points.max(axis=0)
    plot = Plot(
        width,
        height,
        Axis("x from AP [m]", _wider(x0, x1)),
        Axis("z [m]", _wider(z0, z1), 5),
        margins=_MARGINS,
        style=style,
    )
    for line in lines:
        plot.line(line[:, 0], line[:, 2], f"{_SURFACE} thin")
    plot.horizontal(hull.draft, "guide")
    for x in (0.0, hull.length):
        plot.vertical(x, "guide")
    plot.mark(hull.parent.boss_end_x, hull.parent.shaft_height, "plus", 5.0, "open ink")
    return plot


def areas(hull: Hull, table: ShipTable, width: float, height: float, style: Style = PRINT) -> Plot:
    """Sectional areas of the surface, and of the readings by the trapezoidal rule."""
    measured = hull.hydrostatics
    below = np.append(table.z[table.z < table.draft], table.draft)
    own = np.array([2.0 * float(np.trapezoid(np.interp(below, table.z, row), below)) for row in table.y])
    top = max(float(np.max(own)), float(np.max(measured.sectional_area)))
    x = _wider(
        float(min(table.x[0], measured.sectional_area_x[0])), float(max(table.x[-1], measured.sectional_area_x[-1]))
    )
    plot = Plot(
        width, height, Axis("x from AP [m]", x), Axis("area of both sides [m²]", (0.0, 1.08 * top), 5),
        margins=_MARGINS, style=style,
    )  # fmt: skip
    plot.line(measured.sectional_area_x, measured.sectional_area, _SURFACE, name="surface")
    plot.dots(table.x, own, 2.0, _GIVEN, name="readings")
    plot.vertical(measured.longitudinal_centre_of_buoyancy, "guide")
    plot.text(measured.longitudinal_centre_of_buoyancy, 0.06 * top, "LCB", dx=4.0)
    return plot


def _wider(low: float, high: float, part: float = 0.04) -> tuple[float, float]:
    return low - part * (high - low), high + part * (high - low)


def propeller_sheet(told: UnderstoodPropeller) -> str:
    """Expanded outline, sections, and the columns over the radius with the table's rows as dots, as one SVG sheet."""
    titles = [", ".join(word for _, word, _ in column) for column in _RADIAL_COLUMNS]
    charts = [
        Placed(
            blade_outline(told, 480.0, 340.0), 10.0, 50.0, "expanded outline, leading edge to the left; dots: the file"
        ),
        Placed(_blade_sections(told, 480.0, 340.0), 505.0, 50.0, "sections, leading edge to the left"),
        *(
            Placed(radial_columns(told, k, 480.0, 320.0), 10.0 + 495.0 * k, 420.0, title)
            for k, title in enumerate(titles)
        ),
    ]
    words = (
        f"{told.table.name}: Z {told.blade_count}, EAR {told.expanded_area_ratio:.4f}, hub ratio {told.hub_ratio:.3f}, "
        f"P/D {told.pitch_ratio_07R:.4f} at 0.7 R"
    )
    return sheet_svg(_WIDTH, _HEIGHT, charts, [(20.0, 22.0, words)])


def _radii(told: UnderstoodPropeller) -> Array:
    # Denser at the tip, where the chord falls like a root.
    return np.asarray(1.0 - (1.0 - told.hub_ratio) * np.linspace(1.0, 0.0, 201) ** 2)


def _equal_scales(x: Sequence[float], y: Sequence[float], width: float, height: float) -> tuple[Axis, Axis]:
    """Axes of one scale about the middle of two ranges."""
    wide, high = width - _MARGINS[0] - _MARGINS[1], height - _MARGINS[2] - _MARGINS[3]
    scale = min(wide / (1.1 * (x[1] - x[0])), high / (1.1 * (y[1] - y[0])))
    limits = [
        (0.5 * (low + top) - 0.5 * room / scale, 0.5 * (low + top) + 0.5 * room / scale)
        for (low, top), room in (((x[0], x[1]), wide), ((y[0], y[1]), high))
    ]
    return Axis("along the section / D", limits[0]), Axis("r / D", limits[1], 5)


def blade_outline(told: UnderstoodPropeller, width: float, height: float, style: Style = PRINT) -> Plot:
    """The expanded outline, leading edge to the left, with the table's rows."""
    radius = _radii(told)
    at, rows = told.table.at(radius), told.table
    # A skew angle is an arc r theta along the section's own helix, r theta / cos(phi), here over D.
    middle = 0.5 * radius * at.skew / np.cos(at.pitch_angle)
    own = 0.5 * rows.radius_ratio * rows.skew / np.cos(np.arctan2(rows.pitch_ratio, np.pi * rows.radius_ratio))
    edges = [middle + 0.5 * sign * at.chord_ratio for sign in (-1.0, 1.0)]
    ends = float(min(edge.min() for edge in edges)), float(max(edge.max() for edge in edges))
    x, y = _equal_scales(ends, (0.5 * told.hub_ratio, 0.5), width, height)
    plot = Plot(width, height, x, y, margins=_MARGINS, style=style)
    plot.line(middle, 0.5 * radius, "soft thin", name="mid-chord")
    for edge, sign in zip(edges, (-1.0, 1.0), strict=True):
        plot.line(edge, 0.5 * radius, _SURFACE, name="edge")
        plot.dots(own + 0.5 * sign * rows.chord_ratio, 0.5 * rows.radius_ratio, 2.2, _GIVEN)
    return plot


def _blade_sections(told: UnderstoodPropeller, width: float, height: float) -> Plot:
    chords = told.table.chord_ratio
    x, y = _equal_scales((-0.55 * float(chords.max()), 0.75 * float(chords.max())), (0.1, 0.5), width, height)
    plot = Plot(width, height, x, y, margins=_MARGINS, style=PRINT)
    part = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 121))
    for radius in (value for value in BLADE_SECTIONS if value > told.hub_ratio):
        at = told.table.at(np.array([radius]))
        chord = float(at.chord_ratio[0])
        camber = float(at.camber_ratio[0]) * mean_line(part)
        half = float(at.thickness_ratio[0]) * half_thickness(part)
        for sign in (-1.0, 1.0):
            outline = 0.5 * radius + (camber + sign * half) * chord
            plot.line((part - 0.5) * chord, outline, f"{_SURFACE} thin", name=f"{radius:g} R")
        plot.text(0.5 * chord, 0.5 * radius, f"{radius:g} R", "soft", dx=6.0)
    return plot


def radial_columns(told: UnderstoodPropeller, which: int, width: float, height: float, style: Style = PRINT) -> Plot:
    """Columns over the radius: 0 pitch and chord, 1 thickness, camber and rake; dots are the table's rows."""
    columns = _RADIAL_COLUMNS[which]
    title = ", ".join(word for _, word, _ in columns)
    radius = _radii(told)
    at = told.table.at(radius)
    values = np.concatenate([getattr(at, name) for name, _, _ in columns])
    low, high = _wider(min(0.0, float(values.min())), float(values.max()))
    plot = Plot(
        width, height, Axis("r/R", (0.95 * told.hub_ratio, 1.02)), Axis(title, (low, high), 5),
        margins=_MARGINS, style=style,
    )  # fmt: skip
    for name, word, role in columns:
        plot.line(radius, getattr(at, name), role, name=word)
        plot.dots(told.table.radius_ratio, getattr(told.table, name), 2.2, role)
        middle = len(radius) // 3
        plot.text(float(radius[middle]), float(getattr(at, name)[middle]), word, role, dx=4.0, dy=-5.0)
    return plot
