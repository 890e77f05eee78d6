"""A parent hull fitted to any rectangular table of half-breadths: its patches, shaft, shift frame and fit report."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.fit import PatchFit
from hpsop_core.geometry.hull.fit_plan import Seam, fit_patches, girths, open_ends
from hpsop_core.geometry.hull.form import ShiftFrame
from hpsop_core.geometry.hull.hull import FitReport, ParentHull, PatchDeviation
from hpsop_core.geometry.hull.hydrostatics import sectional_areas
from hpsop_core.geometry.hull.table_plans import deck_height, topsides_plan, underwater_plans
from hpsop_core.geometry.hull.table_stations import HalfBreadths, table_station
from hpsop_core.one_thread import one_blas_thread

# Flat ends smaller than this part of the largest section are the last slice of a bulb or stem, not worth a warning.
LEAST_FLAT_END = 0.005
# Without a stern boss in the table: the reference ship's proportions (5.0 m of 14.5 m).
SHAFT_HEIGHT_TO_DRAFT = 5.0 / 14.5


def _boss(fits: dict[str, PatchFit], height: float) -> float:
    """Where the aft profile meets the shaft's height: the foremost place for a hub without cutting the hull."""
    best = np.inf
    for fit in fits.values():
        u = np.linspace(0.0, 1.0, 401)
        points = fit.surface.evaluate(u, np.linspace(0.0, 1.0, 81))
        inside = (points[:, 0, 2] <= height) & (points[:, -1, 2] >= height)
        if np.any(inside):
            best = min(best, float(points[inside][0, 0, 0]))
    return best if np.isfinite(best) else min(_extent(fit)[0] for fit in fits.values())


def _boss_height(skeg: PatchFit) -> float | None:
    """Height of the widest place of a skeg's aft end, m; None where it is widest at its bottom or top: no boss."""
    section = skeg.surface.evaluate(np.array([0.0]), np.linspace(0.0, 1.0, 201))[0]
    widest = int(np.argmax(section[:, 1]))
    low, high, height = float(section[0, 2]), float(section[-1, 2]), float(section[widest, 2])
    return height if 0.15 < (height - low) / max(high - low, 1e-12) < 0.85 else None


@one_blas_thread()
def parent_from_table(
    table: HalfBreadths, length: float, draft: float, shaft_height: float | None = None, boss_x: float | None = None
) -> ParentHull:
    """A parent hull with its fit report.

    Sections may move between 2.5 % of the body's length forward of the boss and 2 % aft of the fore end of the
    waterline, about the middle of the fullest sections.

    Args:
        table: the hull.
        length, draft: m.
        shaft_height: of the shaft's axis above the baseline, m; None: the widest place of a boss, where the table has
            one, else 5.0/14.5 of the draft.
        boss_x: where the propeller's hub begins, m from AP; None: the aft end of a skeg, else where the aft profile
            meets the shaft's height.

    Raises:
        InputError: the table cannot be made into a hull.
    """
    try:
        below = underwater_plans(table, draft)
        fits = fit_patches(below)
        above = [topsides_plan(table, draft, "topsides", "main", fits["main"].surface)]
        if "counter" in fits:
            seam = Seam("topsides", "first", spread=False)
            above.append(topsides_plan(table, draft, "topsides_aft", "counter", fits["counter"].surface, seam))
        sides = fit_patches(above, fits)
    except (ValueError, np.linalg.LinAlgError) as problem:
        raise InputError(f"{table.name}: no smooth surface through these stations ({problem})") from problem
    own_height = _boss_height(fits["skeg"]) if "skeg" in fits else None
    shaft = next(height for height in (shaft_height, own_height, SHAFT_HEIGHT_TO_DRAFT * draft) if height is not None)
    boss = boss_x
    if boss is None:
        boss = _boss(fits, shaft) if "skeg" not in fits else _extent(fits["skeg"])[0]
    frame = _shift_frame(fits, boss, length)
    plans = [*below, *above]
    rough = ParentHull(
        name=table.name,
        length=length,
        breadth=moulded_breadth(table, draft),
        draft=draft,
        deck_height=deck_height(table, draft),
        shaft_height=shaft,
        boss_end_x=boss,
        shift_frame=frame,
        underwater={name: fit.surface for name, fit in fits.items()},
        topsides={name: fit.surface for name, fit in sides.items()},
        caps=(*open_ends(plans), *_open_sides(sides, length)),
        girth=girths(plans),
        along={plan.name: plan.along for plan in plans if plan.along is not None},
        source=f"fitted to {table.name}",
        lowest=min(0.0, *(float(np.min(fit.surface.control_points[..., 2])) for fit in fits.values()))
        if table.z[0] < 0.0
        else 0.0,
    )
    report = FitReport(
        table.name,
        tuple(PatchDeviation(name, fit.surface.weights.shape, **fit.summary()) for name, fit in fits.items()),
        _table_volume(table, draft),
        float(np.sum(rough.quadrature.area * rough.quadrature.width)),
    )
    return replace(
        rough, shift_frame=_about_fullest(rough, frame), fit_report=report, warnings=_flat_ends(rough), _points={}
    )


def _extent(fit: PatchFit) -> tuple[float, float]:
    """First and last x of a patch, m."""
    net = fit.surface.control_points
    return float(net[0, 0, 0]), float(net[-1, 0, 0])


def moulded_breadth(table: HalfBreadths, draft: float) -> float:
    """The greatest breadth in the water, m: at the draft itself too, which may lie between two waterlines."""
    found = [table_station(float(x), table.z, row, draft) for x, row in zip(table.x, table.y, strict=True)]
    return 2.0 * max(float(np.max(station.points[:, 0])) for station in found if station is not None)


def _open_sides(sides: dict[str, PatchFit], length: float) -> list[tuple[str, str]]:
    """Ends of the topsides that stand off the centreplane: the transom, and a flat fore end."""
    foremost, aftmost = next(iter(sides)), next(reversed(sides))
    return [
        (name, end)
        for name, end, row in ((aftmost, "first", 0), (foremost, "last", -1))
        if float(np.max(sides[name].surface.control_points[row, :, 1])) > 1e-6 * length
    ]


def _shift_frame(fits: dict[str, PatchFit], boss: float, length: float) -> ShiftFrame:
    """Where sections may move, about the middle of that stretch."""
    first, (main_first, last) = min(_extent(fit)[0] for fit in fits.values()), _extent(fits["main"])
    body = last - first
    aft, forward = max(boss, main_first) + 0.025 * body, last - 0.02 * body
    return ShiftFrame(aft, 0.5 * (aft + forward), forward, length)


def _about_fullest(parent: ParentHull, frame: ShiftFrame) -> ShiftFrame:
    """The frame about the middle of the fullest sections, which must not lie at either end of it."""
    quadrature = parent.quadrature
    full = quadrature.curve_x[quadrature.curve_area > 0.995 * quadrature.largest_area]
    aft, forward = frame.aft, frame.forward
    middle = float(np.clip(0.5 * (full[0] + full[-1]), aft + 0.3 * (forward - aft), aft + 0.7 * (forward - aft)))
    return replace(frame, middle=middle)


def _flat_ends(parent: ParentHull) -> tuple[str, ...]:
    """A line for every flat end in the water that is no boss: what level 1 cannot see there."""
    lines = []
    least = LEAST_FLAT_END * parent.quadrature.largest_area
    for name, end in parent.caps:
        if name in parent.topsides or name == "skeg":
            continue
        u = np.array([0.0 if end == "first" else 1.0])
        area = float(sectional_areas(parent.surface(name), u)[0])
        if area < least:
            continue
        x = parent.extent(name)[0 if end == "first" else 1]
        lines.append(
            f"the hull ends in a flat face of {area:.3g} m2 in the water at x = {x:.4g} m: thin-ship theory "
            "(level 1) takes no waves from it, and it is no part of the wetted surface"
        )
    return tuple(lines)


def _table_volume(table: HalfBreadths, draft: float) -> float:
    """Displaced volume of the bare table by the trapezoidal rule, m3."""
    z = np.append(table.z[table.z < draft], draft)
    y = np.array([np.interp(z, table.z, row) for row in table.y])
    return float(2.0 * np.trapezoid(np.trapezoid(y, z, axis=1), table.x))
