"""The lines plan: body plan, profile and half-breadth plan at one scale, with the principal particulars."""

from __future__ import annotations

import numpy as np

from hpsop_core.export.design import LeavingDesign
from hpsop_core.export.sheets.paper import MARGIN, TITLE_HEIGHT, WIDTH, Sheet, View, standard_scale
from hpsop_core.geometry.hull.lines import ENDS, plan_lines

_LEFT, _ROOM = 28.0, 785.0


def lines_plan(design: LeavingDesign) -> Sheet:
    """The sheet. Stations are numbered from 0 at AP to 10 at FP; the profile and half-breadth plan look to port."""
    hull = design.hull
    aft, fore = min(ENDS) * hull.length, max(ENDS) * hull.length + 0.03 * hull.length
    scale = standard_scale(fore - aft, _ROOM)
    mm = 1000.0 / scale
    sheet = Sheet("lines plan")
    x0 = _LEFT - mm * aft
    half = View(x0, MARGIN + TITLE_HEIGHT + 28.0, scale)
    side = View(x0, half.y + mm * 0.5 * hull.breadth + 40.0, scale)
    # body plan at a scale of its own: twice as large, or more
    body_scale = standard_scale(max(hull.breadth, 0.5 * hull.depth), 270.0)
    body = View(0.55 * WIDTH, side.y + mm * hull.depth + 45.0, body_scale)
    middle = 0.5 * hull.length
    for cut in plan_lines(hull):
        layer, line = cut.layer, cut.points
        kind = {"DESIGN_WATERLINE": "WATER", "PROFILE": "OUTLINE"}.get(layer, "LINES")
        if layer == "STATIONS":
            sign = -1.0 if line[:, 0].mean() < middle - 1e-6 * hull.length else 1.0
            sheet.line("LINES", body.on_paper(np.stack([sign * line[:, 1], line[:, 2]], axis=1)))
        elif layer in ("WATERLINES", "DESIGN_WATERLINE"):
            sheet.line(kind, half.on_paper(line[:, :2]))
        else:
            sheet.line(kind, side.on_paper(line[:, [0, 2]]))
    ends = np.array([aft, fore])
    for z in (0.0, hull.draft):
        layer = "WATER" if z else "GRID"
        sheet.line(layer, side.on_paper(np.stack([ends, np.full(2, z)], axis=1)))
        breadth = np.array([-0.55, 0.55]) * hull.breadth
        sheet.line(layer, body.on_paper(np.stack([breadth, np.full(2, z)], axis=1)))
    sheet.line("GRID", half.on_paper(np.stack([ends, np.zeros(2)], axis=1)))
    sheet.line("GRID", body.on_paper(np.array([[0.0, 0.0], [0.0, 1.05 * hull.depth]])))
    for station in range(11):
        x = station / 10.0 * hull.length
        for view, top in ((side, hull.depth), (half, 0.5 * hull.breadth)):
            sheet.line("GRID", view.on_paper(np.array([[x, 0.0], [x, 1.02 * top]])))
            name = {0: "0 AP", 10: "10 FP"}.get(station, str(station))
            sheet.word(view.x + mm * x, view.y - 5.0, name, 2.5, "middle")
    for view, text in ((side, "Profile and buttocks"), (half, "Half-breadth plan")):
        sheet.word(_LEFT, view.y - 12.0, f"{text}, 1 : {scale:g}", 3.5)
    sheet.word(body.x, body.y - 10.0, f"Body plan, aft left, 1 : {body_scale:g}", 3.5, "middle")
    particulars = _particulars(design)
    sheet.table(_LEFT, body.y + 5.0 * len(particulars), particulars)
    sheet.frame("Lines plan", _words(design))
    return sheet


def _words(design: LeavingDesign) -> list[str]:
    return [
        f"{design.case.name}, {design.label}, level {design.evaluation.level}",
        "Moulded lines in metres. Stations from AP (0) to FP (10); buttocks in 0.1 B,",
        "waterlines in 0.1 of the draft up to it, in 0.2 above. Computed surface, not faired by hand.",
        "Paper A1, lengths in mm at the scales given.",
    ]


def _particulars(design: LeavingDesign) -> list[tuple[str, str]]:
    hull, h = design.hull, design.hull.hydrostatics
    return [
        ("Length between perpendiculars", f"{hull.length:.3f} m"),
        ("Breadth", f"{hull.breadth:.3f} m"),
        ("Draft", f"{hull.draft:.3f} m"),
        ("Depth", f"{hull.depth:.3f} m"),
        ("Displaced volume", f"{h.displaced_volume:.1f} m³"),
        ("Wetted surface", f"{h.wetted_surface:.1f} m²"),
        ("Block coefficient", f"{h.block_coefficient:.4f}"),
        ("Prismatic coefficient", f"{h.prismatic_coefficient:.4f}"),
        ("Midship coefficient", f"{h.midship_coefficient:.4f}"),
        ("Waterplane coefficient", f"{h.waterplane_coefficient:.4f}"),
        ("LCB from AP", f"{h.longitudinal_centre_of_buoyancy:.3f} m"),
        ("KB", f"{h.vertical_centre_of_buoyancy:.3f} m"),
        ("BM", f"{h.transverse_metacentric_radius:.3f} m"),
    ]
