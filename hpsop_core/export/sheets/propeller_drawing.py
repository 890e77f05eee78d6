"""The propeller drawing: expanded and projected outline, side view, sections, pitch and thickness over the radius."""

from __future__ import annotations

import numpy as np

from hpsop_core.export.design import LeavingDesign
from hpsop_core.export.sheets.paper import HEIGHT, MARGIN, Sheet, View, standard_scale
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import blade_points, section_points
from hpsop_core.typing_aliases import Array
from hpsop_core.units import written

_SECTIONS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
_EDGES = np.array([0.0, 1.0])


def propeller_drawing(design: LeavingDesign) -> Sheet:
    """The sheet; the key blade, up, seen from astern (projected) and from port (side), forward to the left."""
    propeller = design.propeller
    radius = 0.5 * propeller.diameter
    table = propeller.table
    # Denser at the tip, where the chord falls like a root.
    radii = 1.0 - (1.0 - table.hub_ratio) * np.linspace(1.0, 0.0, 121) ** 2
    sections = table.at(radii)
    scale = standard_scale(radius, 330.0)
    mm, base = 1000.0 / scale, HEIGHT - MARGIN - 35.0 - 1000.0 / scale * radius
    sheet = Sheet("propeller")
    expanded, projected, side = View(150.0, base, scale), View(372.0, base, scale), View(545.0, base, scale)

    middle = radii * sections.skew / np.cos(sections.pitch_angle)
    edges = [middle + sign * sections.chord_ratio for sign in (-1.0, 1.0)]
    for edge in edges:
        sheet.line("OUTLINE", expanded.on_paper(radius * np.stack([edge, radii], axis=1)))
    sheet.line("GRID", expanded.on_paper(radius * np.stack([middle, radii], axis=1)))
    points = radius * blade_points(sections, _EDGES, True, 0.0)
    for outline in (points[:, 0], points[:, 1]):
        sheet.line("OUTLINE", projected.on_paper(outline[:, [1, 2]]))
        sheet.line("OUTLINE", side.on_paper(outline[:, [0, 2]]))
    rake = 2.0 * radius * sections.rake_ratio
    sheet.line("GRID", side.on_paper(np.stack([rake, radius * radii], axis=1)))
    hub = radius * propeller.hub_ratio
    angle = np.linspace(0.0, np.pi, 91)
    arc = hub * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    sheet.line("LINES", projected.on_paper(arc))
    for view, text in ((expanded, "Expanded"), (projected, "Projected, from astern"), (side, "Side, forward left")):
        sheet.line("GRID", np.array([[view.x - 75.0, view.y], [view.x + 75.0, view.y]]))
        sheet.line("GRID", np.array([[view.x, view.y], [view.x, view.y + 1.03 * mm * radius]]))
        sheet.word(view.x, view.y - 8.0, f"{text}, 1 : {scale:g}", 3.5, "middle")
    fraction = cosine_chord_fractions(81)
    for ratio in (value for value in _SECTIONS if value > table.hub_ratio + 0.02):
        at = table.at(np.array([ratio]))
        along, back = section_points(at, fraction, True)
        _, face = section_points(at, fraction, False)
        shift = float(ratio * at.skew[0] / np.cos(at.pitch_angle[0]))
        outline = np.concatenate(
            [np.stack([along[0], back[0]], axis=1), np.stack([along[0], face[0]], axis=1)[::-1]]
        ) + np.array([shift, ratio])
        sheet.line("LINES", expanded.on_paper(radius * outline))
        left, right = (float(np.interp(ratio, radii, edge)) for edge in edges)
        sheet.word(expanded.x + mm * radius * right + 4.0, base + mm * radius * ratio - 1.0, f"{ratio:g} R")
        ends = radius * np.array([[left, ratio], [right, ratio]])
        sheet.line("GRID", expanded.on_paper(ends))
    diameter = propeller.diameter
    _graph(sheet, 638.0, base, mm * radius, radii, diameter * sections.pitch_ratio, "Pitch [m]")
    thickness = 1000.0 * diameter * sections.chord_ratio * sections.thickness_ratio
    _graph(sheet, 735.0, base, mm * radius, radii, thickness, "Thickness [mm]")
    rows = _particulars(design)
    sheet.table(40.0, base - 30.0, rows)
    _radial_table(sheet, 165.0, base - 30.0, design)
    lines = [
        f"{design.case.name}, {design.label}, level {design.evaluation.level}",
        "Right-handed. Expanded outline leading edge to the left; sections with the table's",
        "own edges; the solids' trailing edges and tips are 0.001 D thick. Thickness is a",
        "family's rule and no class's strength. Paper A1, lengths in mm at the scales given.",
    ]
    sheet.frame("Propeller", lines)
    return sheet


def _graph(sheet: Sheet, left: float, base: float, tall: float, radii: Array, values: Array, name: str) -> None:
    """Values to the right over the radius upwards, beside the outlines at their own height."""
    top = float(np.max(values)) * 1.1
    width = 75.0
    sheet.line("OUTLINE", np.stack([left + width * values / top, base + tall * radii], axis=1))
    sheet.box("GRID", left, base, width, tall)
    for ratio in (0.2, 0.4, 0.6, 0.8, 1.0):
        sheet.line("GRID", np.array([[left, base + tall * ratio], [left + width, base + tall * ratio]]))
        value = float(np.interp(ratio, radii, values))
        if ratio >= radii[0]:
            sheet.word(left + width + 1.5, base + tall * ratio - 1.0, f"{value:.4g}")
    sheet.word(left + 0.5 * width, base - 8.0, name, 3.5, "middle")


def _particulars(design: LeavingDesign) -> list[tuple[str, str]]:
    propeller = design.propeller
    point = design.evaluation.conditions[0]
    return [
        ("Diameter", f"{propeller.diameter:.4f} m"),
        ("Blades", f"{propeller.blade_count}"),
        ("Expanded area ratio", f"{propeller.expanded_area_ratio:.4f}"),
        ("P/D at 0.7 R", f"{propeller.pitch_diameter_ratio_07R:.4f}"),
        ("Hub ratio", f"{propeller.hub_ratio:.4f}"),
        ("Shaft above baseline", f"{design.hull.shaft_height:.3f} m"),
        ("Rate of revolutions", f"{point.rotation_rate_rpm:.2f} 1/min"),
        ("Delivered power", written(point.delivered_power / 1e6, "MW", 3)),
    ]


def _radial_table(sheet: Sheet, left: float, top: float, design: LeavingDesign) -> None:
    table, diameter = design.propeller.table, 1000.0 * design.propeller.diameter
    head = ("r/R", "pitch", "chord", "thickness", "camber", "rake", "skew [deg]")
    chord = table.chord_ratio * diameter
    columns = (
        table.radius_ratio, table.pitch_ratio * diameter, chord, table.thickness_ratio * chord,
        table.camber_ratio * chord, table.rake_ratio * diameter, np.degrees(table.skew),
    )  # fmt: skip
    digits = (3, 1, 1, 2, 2, 1, 2)
    for number, (name, values, count) in enumerate(zip(head, columns, digits, strict=True)):
        x = left + 4.0 + 26.0 * number
        sheet.word(x, top - 5.0, name)
        for row, value in enumerate(values):
            sheet.word(x, top - 10.0 - 4.2 * row, f"{value:.{count}f}")
    sheet.box("GRID", left, top - 12.0 - 4.2 * len(table.radius_ratio), 190.0, 12.0 + 4.2 * len(table.radius_ratio))
    sheet.word(left, top + 2.0, "Radial table, mm")
