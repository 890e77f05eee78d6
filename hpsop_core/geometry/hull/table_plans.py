"""The patches that a table of half-breadths is divided into, as plans.

One patch from the bottom's centreline to the design waterline; where sections end below the waterline at the bow (a
bulb), at a post of the stern or at a propeller aperture, further patches that share the first one's edges. Sharp ends
and a sharp keel stay sharp: where the table closes to zero, the surface's edge lies in the centreplane exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.geometry.hull.fit import FitSettings, Section, StationMap, knots_at
from hpsop_core.geometry.hull.fit_plan import (
    CLOSED_AFT,
    CLOSED_FORWARD,
    FIRST,
    LAST,
    LOWER_EDGE_ON_CENTREPLANE,
    UPPER_EDGE_ON_CENTREPLANE,
    End,
    HeightLimits,
    Held,
    PatchPlan,
    Seam,
    Spans,
    StraightEdge,
    columns_on,
    knots_with,
    upper_edge_at,
)
from hpsop_core.geometry.hull.table_ends import HullEnd, hull_end
from hpsop_core.geometry.hull.table_knuckles import with_knuckle
from hpsop_core.geometry.hull.table_stations import (
    HalfBreadths,
    TableStation,
    aperture_station,
    post_station,
    stations_in_water,
)
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.typing_aliases import Array

MOST_SPANS = 48
FEWEST_GIRTH_SPANS, MOST_GIRTH_SPANS = 8, 22
# Readings are exact: the net is smoothed ten times less than the default, which is meant for sampled surfaces.
SETTINGS = FitSettings(smoothing=5e-3, rounds=3)
# Sides keep this part of the hull's length from the centreplane: they never cross, and a knife edge stays sharp.
LEAST_HALF_BREADTH = 1e-7
# Control points may lie this part of the draft beyond the heights of the points, as those of a rounded edge must.
HEIGHT_ROOM = 0.15
# Upright sides where the table ends at the waterline, as a part of the draft.
WALL_HEIGHT_TO_DRAFT = 0.5
# Other knots keep this distance, in v, from a knuckle's.
KNUCKLE_ROOM = 0.03
# A further knot this far, in v, from the ends of a post.
CORNER = 0.012
SKEG_KNOTS = tuple(float(knot) for knot in np.linspace(0.15, 0.85, 6))
TOPSIDES_KNOTS = (0.25, 0.5, 0.75)
# Part of the greatest half-breadth: sides that reach less over the end of the waterline close there, a raked stem.
LITTLE_OVERHANG = 0.05


@dataclass(frozen=True, eq=False)
class _Division:
    """Where the stations in the water part into patches.

    Attributes:
        table, draft: the hull.
        stations: those in the water, from aft.
        aft, forward: first and last that reach the waterline.
        opening: the foremost one with a skeg below an aperture, or None.
        pillar: the one at which the profile steps down a post, or None.
    """

    table: HalfBreadths
    draft: float
    stations: Sequence[TableStation]
    aft: int
    forward: int
    opening: int | None
    pillar: int | None

    @staticmethod
    def of(table: HalfBreadths, draft: float) -> _Division:
        stations = stations_in_water(table, draft)
        floating = [k for k, station in enumerate(stations) if station.surface]
        opening = aperture_station(stations)
        pillar = post_station(stations, floating[0]) if opening is None else None
        return _Division(table, draft, stations, floating[0], floating[-1], opening, pillar)

    @property
    def border(self) -> int | None:
        """The station at which the main patch ends aft and the counter begins; None: there is no counter."""
        return self.opening if self.opening is not None else self.pillar

    @property
    def ends_at_post(self) -> bool:
        """The table ends at the stern post itself: the hull above it ends there too, flat."""
        return self.pillar is not None and self.pillar == self.aft and self.counter_end.x >= self.stations[self.aft].x

    @property
    def counter_end(self) -> HullEnd:
        """How the counter ends."""
        return hull_end(self.table, self.stations[self.aft : (self.border or 0) + 2], False, self.draft)

    @property
    def first(self) -> int:
        """The main patch's first station."""
        return self.aft if self.border is None else self.border

    @property
    def bulb(self) -> Sequence[TableStation]:
        """Submerged stations forward of the waterline; a single one is the tip of a raked stem."""
        ahead = self.stations[self.forward + 1 :]
        return ahead if len(ahead) >= 2 else ()

    @property
    def settings(self) -> FitSettings:
        return replace(SETTINGS, least_half_breadth=LEAST_HALF_BREADTH * float(self.table.x[-1] - self.table.x[0]))


def underwater_plans(table: HalfBreadths, draft: float) -> list[PatchPlan]:
    """Plans below the waterline: main, and where the table has them bulb, counter and skeg.

    Raises:
        InputError: the hull has too few stations in the water.
    """
    division = _Division.of(table, draft)
    main, bulb_part, post = _main(division)
    plans = [main]
    if bulb_part > 0.0:
        plans.append(_bulb(division, bulb_part))
    if division.border is not None and not division.ends_at_post:
        plans.append(_counter(division, division.border, post[1]))
    if division.opening is not None:
        plans.append(_skeg(division, division.opening, post[0]))
    return plans


def _main(division: _Division) -> tuple[PatchPlan, float, tuple[float, float]]:
    """The main patch, the part of its fore end that a bulb shares, and the stretch of its aft end that is a post."""
    table, draft, stations = division.table, division.draft, division.stations
    floating = stations[division.first : division.forward + 1]
    sections = [Section(s.x, s.points) for s in floating if s.surface]
    spans = int(np.clip(np.sum(table.z < draft), FEWEST_GIRTH_SPANS, MOST_GIRTH_SPANS))
    interior = list(np.linspace(0.0, 1.0, spans + 1)[1:-1])
    bulb_part, post = 0.0, (0.0, 0.0)
    if division.bulb:
        points, bulb_part = _with_stem(division.bulb[0].points, draft)
        sections.append(Section(division.bulb[0].x, points))
        fore_end = HullEnd(division.bulb[0].x, None)
        if bulb_part < 1.0:
            interior = knots_with(interior, bulb_part, bulb_part)
    else:
        fore_end = hull_end(table, floating, True, draft)
        knuckle = with_knuckle(sections) if division.border is None else None
        if knuckle is not None:
            sections, v = knuckle
            # Three knots: the surface may turn there, along the whole patch.
            interior = sorted([*(k for k in interior if abs(k - v) > KNUCKLE_ROOM), v, v, v])
    if division.border is None:
        aft_end = hull_end(table, stations[division.aft : division.forward + 1], False, draft)
    else:
        border = stations[division.border]
        if division.opening is not None:
            points, post = _with_aperture(border)
            interior = _with_corners(knots_with(interior, *post), *post)
        else:
            points, post = _above_post(border, float(stations[division.border + 1].points[0, 1]))
            interior = _with_corners(knots_with(interior, post[1], post[1]), 0.0, post[1])
        sections[0] = Section(border.x, points)
        aft_end = HullEnd(border.x, None)
    knots = knots_at(interior)
    held = [LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(draft)]
    open_ends: list[End] = []
    if bulb_part > 0.0:
        held.append(Held("y", 0.0, LAST, columns_on(knots, bulb_part, 1.0)))
    elif fore_end.bottom is not None:
        held += _sharp(LAST, fore_end.bottom, draft)
    else:
        open_ends.append("last")
    if division.border is not None:
        held.append(Held("y", 0.0, FIRST, columns_on(knots, *post)))
        if division.ends_at_post:
            open_ends.append("first")
    elif aft_end.bottom is not None:
        held += _sharp(FIRST, aft_end.bottom, draft)
    else:
        open_ends.append("first")
    x = np.unique(np.concatenate([[aft_end.x], [s.x for s in sections], [fore_end.x]]))
    limits = HeightLimits(float(table.z[0]) - HEIGHT_ROOM * draft, draft)
    plan = PatchPlan(
        "main", sections, Spans(x, most=MOST_SPANS), knots, tuple(held),
        heights=limits, settings=division.settings, open_ends=tuple(open_ends),
    )  # fmt: skip
    return plan, bulb_part, post


def _with_corners(interior: list[float], low: float, high: float) -> list[float]:
    """Interior knots with one more just outside a post's ends, where the section turns sharply off the centreplane."""
    beside = [value for value in (low - CORNER, high + CORNER) if CORNER < value < 1.0 - CORNER]
    return sorted([*interior, *beside])


def _sharp(rows: slice, bottom: float, top: float) -> list[Held]:
    """A sharp end: its edge on the centreplane, straight from the bottom to the waterline."""
    return [Held("y", 0.0, rows), Held("z", StraightEdge(bottom, top), rows)]


def _with_stem(section: Array, draft: float) -> tuple[Array, float]:
    """A submerged section continued up the centreline to the waterline, and the chord fraction where it closes."""
    top = float(section[-1, 1])
    if top > draft * (1.0 - 2e-3):
        return np.vstack([section[:-1], [[0.0, draft]]]), 1.0
    post = np.column_stack([np.zeros(6), np.linspace(top, draft, 7)[1:]])
    whole = Section(0.0, np.vstack([section, post]))
    return whole.points, float(whole.chord_fractions()[len(section) - 1])


def _with_aperture(station: TableStation) -> tuple[Array, tuple[float, float]]:
    """Skeg, post and counter of one station as one section, and the chord fractions where the post begins and ends."""
    if station.skeg is None:
        raise ValueError("no aperture here")
    low, high = station.skeg[-1, 1], station.points[0, 1]
    post = np.column_stack([np.zeros(5), np.linspace(low, high, 7)[1:-1]])
    whole = Section(station.x, np.vstack([station.skeg, post, station.points]))
    fractions = whole.chord_fractions()
    first = len(station.skeg) - 1
    return whole.points, (float(fractions[first]), float(fractions[first + 6]))


def _above_post(station: TableStation, keel: float) -> tuple[Array, tuple[float, float]]:
    """A post from the keel up to the station's section, both as one section, and the chord fractions of the post."""
    high = float(station.points[0, 1])
    post = np.column_stack([np.zeros(6), np.linspace(keel, high, 7)[:-1]])
    whole = Section(station.x, np.vstack([post, station.points]))
    return whole.points, (0.0, float(whole.chord_fractions()[6]))


def _bulb(division: _Division, part: float) -> PatchPlan:
    """The submerged stations at the bow, up to the zero reading ahead of them or to a flat end at the last one."""
    table, draft, stations = division.table, division.draft, division.bulb
    near = stations[-1]
    nose = int(np.searchsorted(table.x, near.x)) + 1
    pointed = nose < len(table.x)
    x = [s.x for s in stations]
    held = [LOWER_EDGE_ON_CENTREPLANE, UPPER_EDGE_ON_CENTREPLANE]
    if pointed:
        x.append(float(table.x[nose]))
        held += [CLOSED_FORWARD, Held("z", float(near.points[int(np.argmax(near.points[:, 0])), 1]), LAST)]
    lowest, highest = (find(float(find(s.points[:, 1])) for s in stations) for find in (min, max))
    room = HEIGHT_ROOM * draft
    return PatchPlan(
        "bulb", [Section(s.x, s.points) for s in stations], Spans(np.array(x), flat_end=pointed, most=MOST_SPANS), None,
        tuple(held), Seam("main", "last", 0.0, part), heights=HeightLimits(lowest - room, min(highest + room, draft)),
        settings=division.settings, open_ends=() if pointed else ("last",),
    )  # fmt: skip


def _counter(division: _Division, border: int, start: float) -> PatchPlan:
    """The patch above an aperture or aft of a post, on to the aft end of the waterline."""
    draft, stations = division.draft, division.stations
    end = division.counter_end
    above = stations[division.aft : border] or stations[border : border + 1]
    held = [LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(draft)]
    if end.bottom is not None:
        held += _sharp(FIRST, end.bottom, draft)
    room = HEIGHT_ROOM * draft
    lowest = min(float(np.min(s.points[:, 1])) for s in above)
    return PatchPlan(
        "counter", [Section(s.x, s.points) for s in above],
        Spans(np.array([end.x, *(s.x for s in above)]), most=MOST_SPANS, with_seam=True), None, tuple(held),
        Seam("main", "first", start, 1.0), heights=HeightLimits(lowest - room, draft, below_seam=room),
        settings=division.settings, open_ends=("first",) if end.bottom is None else (),
    )  # fmt: skip


def _skeg(division: _Division, opening: int, end: float) -> PatchPlan:
    """The patch below the aperture; its aft end is flat."""
    sections = [Section(s.x, s.skeg) for s in division.stations[:opening] if s.skeg is not None]
    return PatchPlan(
        "skeg", sections, Spans(np.array([s.x for s in sections]), most=MOST_SPANS, with_seam=True), None,
        (LOWER_EDGE_ON_CENTREPLANE, UPPER_EDGE_ON_CENTREPLANE), Seam("main", "first", 0.0, end, SKEG_KNOTS),
        settings=division.settings, open_ends=("first",),
    )  # fmt: skip


def deck_height(table: HalfBreadths, draft: float) -> float:
    """The table's highest waterline; where it has fewer than two above the draft, that of upright walls, m."""
    above = table.z[table.z > draft * 1.001]
    return draft * (1.0 + WALL_HEIGHT_TO_DRAFT) if len(above) < 2 else float(above[-1])


def topsides_plan(
    table: HalfBreadths, draft: float, name: str, below: str, surface: NurbsSurface, seam: Seam | None = None
) -> PatchPlan:
    """The sides above the waterline over one patch: from the table where it reaches higher, else upright walls.

    Args:
        table, draft: the hull.
        name: of the patch.
        below, surface: the patch below, whose edge v = 1 the sides continue.
        seam: the edge at the patch's fore end, where another patch of sides begins.
    """
    edge = surface.control_points[:, -1, 1]
    above = table.z[table.z > draft * 1.001]
    height = deck_height(table, draft)
    walls = len(above) < 2
    held = [Held("z", StraightEdge(draft, height))]
    if walls:
        held.append(Held("y", edge[:, None]))
    stations = StationMap(surface.knots_u, surface.control_points[:, 0, 0])
    ends = float(stations.control_x[0]), float(stations.control_x[-1])
    # The sides have sections at their ends too, else they would swing there. Where the waterline closes they close with
    # it if little overhangs; a wide overhang ends there flat.
    at_ends = []
    for end, x, closed in ((0, ends[0], CLOSED_AFT), (-1, ends[1], CLOSED_FORWARD)):
        row = np.array([np.interp(x, table.x, column) for column in table.y.T])
        little = LITTLE_OVERHANG * float(np.max(table.y))
        if edge[end] == 0.0 and np.max(np.interp(above, table.z, row), initial=0.0) < little:
            held.append(closed)
        else:
            at_ends.append((x, row))
    near = 1e-9 * float(table.x[-1] - table.x[0])
    inside = (table.x > ends[0] + near) & (table.x < ends[1] - near)
    sections = []
    for x, row in [*zip(table.x[inside], table.y[inside], strict=True), *at_ends]:
        at = float(surface.evaluate(stations.u(np.array([x])), np.array([1.0]))[0, 0, 1])
        widths = np.array([at]) if walls else np.interp(above, table.z, row)
        heights = np.array([height]) if walls else above
        sections.append(Section(float(x), np.vstack([[at, draft], np.column_stack([widths, heights])])))
    return PatchPlan(
        name, sections, None, knots_at(TOPSIDES_KNOTS), tuple(held), seam, below,
        settings=replace(SETTINGS, rounds=0, least_half_breadth=0.0),
    )  # fmt: skip
