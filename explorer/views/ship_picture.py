"""The picture of a ship that is being brought in: body plan with the file's points, profile, areas; the blade."""

from __future__ import annotations

from collections.abc import Callable

from explorer.state.own_ship import OwnShip
from explorer.state.session import Session
from explorer.views.chips import NOTHING, box, soft
from hpsop_core.charts.own_files import (
    NOTED_DEVIATION,
    areas,
    blade_outline,
    body_plan,
    profile,
    radial_columns,
)
from hpsop_core.charts.style import SCREEN
from hpsop_core.geometry.hull.input import HullFile
from hpsop_core.geometry.propeller.input import UnderstoodPropeller
from hpsop_core.markup import Markup, fill, joined


class ShipPicture:
    """Draws what was understood; a picture that is asked for again is not drawn again.

    Args:
        session: whose panel it stands in.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._known: dict[str, tuple[tuple[object, ...], tuple[Markup, Markup]]] = {}

    def drawn(self, ship: OwnShip) -> tuple[Markup, Markup]:
        """What people look at first (body plan, outline of the blade), and the further curves.

        Both are faded while a file is read anew.
        """
        size = (self._session.chart_width, self._session.size[1])
        pairs = []
        if ship.read is not None:
            read = ship.read
            pairs.append(self._once("hull", (read, size), lambda: _hull(read, *size)))
        if ship.read_propeller is not None:
            told = ship.read_propeller
            pairs.append(self._once("propeller", (told, size), lambda: _propeller(told, *size)))
        if not pairs:
            return NOTHING, NOTHING
        faded = "opacity:.45" if ship.reading else ""
        state = "old" if ship.reading else "now"
        frame = '<div data-ship-picture="{}" style="{}">{}</div>'
        first, more = (joined(pair[k] for pair in pairs) for k in (0, 1))
        return box(fill(frame, state, faded, first)), box(fill(frame, state, faded, more))

    def _once(
        self, what: str, key: tuple[object, ...], draw: Callable[[], tuple[Markup, Markup]]
    ) -> tuple[Markup, Markup]:
        known = self._known.get(what)
        if known is None or known[0] != key:
            known = self._known[what] = (key, draw())
        return known[1]


def _hull(read: HullFile, width: float, height: int) -> tuple[Markup, Markup]:
    hull = read.parent.transform(read.parent.length, read.parent.breadth, read.parent.draft)
    high = min(max(0.33 * height, 230.0), 360.0)
    # at equal scales a beamy ship needs less
    flat = float(read.table.z[-1] - min(read.table.z[0], 0.0)) / (2.0 * float(read.table.y.max()))
    limit = 1e3 * NOTED_DEVIATION * hull.breadth
    plan = fill(
        "{}{}",
        body_plan(hull, read.table, width, min(high, 52.0 + 1.05 * flat * (width - 64.0)), SCREEN).svg("ship_body"),
        soft(
            "Body plan, aft body left; lines: the surface that everything is computed on, dots: the file, squares: "
            f"readings in the water more than {limit:.2g} mm off it (rest on one for its distance), +: the shaft."
        ),
    )
    curves = fill(
        "{}{}",
        profile(hull, width, 0.55 * high, SCREEN).svg("ship_profile"),
        areas(hull, read.table, width, 0.65 * high, SCREEN).svg("ship_areas"),
    )
    return plan, curves


def _propeller(told: UnderstoodPropeller, width: float, height: int) -> tuple[Markup, Markup]:
    high = min(max(0.3 * height, 220.0), 320.0)
    outline = fill(
        "{}{}",
        blade_outline(told, width, high, SCREEN).svg("ship_blade"),
        soft("Expanded outline, leading edge to the left; dots: the table's rows."),
    )
    curves = fill(
        "{}{}",
        radial_columns(told, 0, width, 0.7 * high, SCREEN).svg("ship_pitch"),
        radial_columns(told, 1, width, 0.7 * high, SCREEN).svg("ship_thickness"),
    )
    return outline, curves
