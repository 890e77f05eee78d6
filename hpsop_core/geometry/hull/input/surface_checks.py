"""What the fitted surface must keep of the readings, and what it must not do between them."""

from __future__ import annotations

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import ParentHull, PatchDeviation
from hpsop_core.geometry.hull.input.ship_table import ShipTable

# Largest distance of a point from the fitted surface, as a part of the breadth; sound tables stay below 0.5 %.
LARGEST_DEVIATION = 0.015
# How far the surface may pass the table's heights and breadths between the points, as a part of the draft.
LARGEST_SWING = 0.03
# How much of a section may be missing from the surface before it is said, and before it is refused, of the largest
# section. Tables whose waterlines are far apart lack up to 2.7 % by the trapezoidal rule; what lies beyond the
# waterline's end is lacking whole, 47 % of a submarine.
NOTED_LACK, LARGEST_LACK = 0.05, 0.15


def worst_patch(parent: ParentHull) -> PatchDeviation | None:
    """The patch with the largest deviation, or None where nothing was fitted."""
    if parent.fit_report is None:
        return None
    return max(parent.fit_report.patches, key=lambda patch: patch.max_m)


def check_fit(parent: ParentHull, table: ShipTable) -> None:
    """A half-breadth far off the smooth surface through its neighbours is a slip of the pen, not a hull.

    Raises:
        InputError: names the row of the reading next to the largest deviation.
    """
    worst = worst_patch(parent)
    if worst is None or worst.max_m <= LARGEST_DEVIATION * parent.breadth:
        return
    k = int(np.argmin(np.abs(table.x - worst.max_at_x_m)))
    level = int(np.argmin(np.abs(table.z - worst.max_at_z_m)))
    place = table.station_name(float(table.x[k]))
    remedy = "correct it or add stations there" if table.rows is not None else (
        "a knuckle, an appendage or a gap in the mesh? leave it out or close it"
    )  # fmt: skip
    raise InputError(
        f"{table.name}{table.row(k, level)}: the point at {place}, waterline {table.z[level]:g} m (half-breadth "
        f"{table.y[k, level]:.4g} m) lies {worst.max_m:.3g} m off the smooth surface through its neighbours "
        f"({worst.patch}); {remedy}"
    )


def check_between(parent: ParentHull, table: ShipTable) -> None:
    """Between the points, where no reading speaks, the surface must stay within the table's heights and breadths.

    Raises:
        InputError: names the station next to the largest swing.
    """
    grid = np.linspace(0.0, 1.0, 101)
    room = LARGEST_SWING * parent.draft
    half = 0.5 * parent.breadth
    for patch, surface in parent.underwater.items():
        points = surface.evaluate(grid, grid)
        for beyond, what in (
            (float(table.z[0]) - points[..., 2], "below the lowest waterline"),
            (points[..., 2] - parent.draft, "above the draft"),
            (points[..., 1] - half, "outside the greatest half-breadth"),
        ):
            if float(beyond.max()) > room:
                place = points[np.unravel_index(int(np.argmax(beyond)), beyond.shape)]
                k = int(np.argmin(np.abs(table.x - place[0])))
                remedy = "add stations there" if table.rows is not None else "is x forward, z up, and the draft right?"
                raise InputError(
                    f"{table.name}{table.row(k, 0)}: near {table.station_name(float(table.x[k]))}, z = "
                    f"{place[2]:.3g} m, the smooth surface ({patch}) swings {float(beyond.max()):.3g} m {what} between "
                    f"the points; {remedy}"
                )


def check_areas(parent: ParentHull, table: ShipTable) -> tuple[str, ...]:
    """No part of the table may be missing from the surface, as a body that ends under water aft of the waterline is.

    Returns:
        A warning where a station lacks something.

    Raises:
        InputError: names the station that lacks most.
    """
    heights = np.append(table.z[table.z < table.draft], table.draft)
    given = np.array([2.0 * np.trapezoid(np.interp(heights, table.z, row), heights) for row in table.y])
    curve = parent.quadrature
    fitted = np.interp(table.x, curve.curve_x, curve.curve_area, left=0.0, right=0.0)
    k = int(np.argmax(given - fitted))
    lack = float(given[k] - fitted[k]) / float(np.max(given))
    if lack <= NOTED_LACK:
        return ()
    place = table.station_name(float(table.x[k]))
    text = (
        f"{place} has {given[k]:.3g} m2 under water, of which the fitted surface has {fitted[k]:.3g}: a body that goes "
        "on under water beyond the end of its waterline (a submarine, a stern bulb) is not supported; is the draft of "
        f"{table.draft:g} m right?"
    )
    if lack > LARGEST_LACK:
        raise InputError(f"{table.name}{table.row(k, 0)}: {text}")
    return (f"warning: {text}",)
