"""A hull's division into patches, declared, and the one loop that fits them.

A plan says of one patch where its sections are, where its knots lie, which control points are held and which edge it
shares with a patch fitted before it. The shipped hull and every hull of a user are lists of such plans.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from hpsop_core.geometry.hull.fit import (
    DEGREE,
    FitSettings,
    PatchFit,
    Section,
    StationMap,
    edge_segment,
    fit_patch,
    free_net,
)
from hpsop_core.typing_aliases import Array

End = Literal["first", "last"]
ROW = {"first": 0, "last": -1}
OPPOSITE: dict[End, End] = {"first": "last", "last": "first"}
EVERY = slice(None)
# Neighbouring spans of x(u) differ by no more than this factor: a surface must not change its stiffness at once.
LARGEST_SPAN_RATIO = 1.7


@dataclass(frozen=True, eq=False)
class Spans:
    """The stations that the knots of x(u) are laid to.

    Attributes:
        x: rising, m.
        flat_start, flat_end: a rounded end, where dx/du = 0.
        most: None: one knot at each of these stations; else as dense as they are, up to this number of spans, with
            spacing that changes gently.
        with_seam: the shared edge's own station is one of them.
    """

    x: Sequence[float] | Array
    flat_start: bool = False
    flat_end: bool = False
    most: int | None = None
    with_seam: bool = False

    def station_map(self, edge: Array | None) -> StationMap:
        """x of u; ``edge`` are the control points (nv, 3) of the shared edge.

        Raises:
            ValueError: x(u) does not rise.
        """
        x = np.asarray(self.x, dtype=np.float64)
        if self.with_seam and edge is not None:
            x = np.unique([*x, float(edge[0, 0])])
        stations = list(self.x) if self.most is None else _gentle_stations(x, self.most).tolist()
        return StationMap.through(stations, self.flat_start, self.flat_end)


@dataclass(frozen=True)
class Seam:
    """The edge that a patch shares with one fitted before it: an end of that patch, or a stretch of that end.

    Attributes:
        patch: the neighbour.
        end: the neighbour's end in u; the edge is the opposite end of the patch itself.
        start, stop: the stretch in the neighbour's v; the patch's v runs over it, on the neighbour's knots there.
        extra_knots: further knots of the patch's own v.
        spread: sections spread v along their girth as the edge does, so that parameter lines run on smoothly.
    """

    patch: str
    end: End
    start: float = 0.0
    stop: float = 1.0
    extra_knots: tuple[float, ...] = ()
    spread: bool = True


@dataclass(frozen=True)
class StraightEdge:
    """Control points at equal steps of a straight line over v, from the value at v = 0 to that at v = 1."""

    start: float
    end: float

    def control_values(self, knots_v: Array) -> Array:
        """(nv,) values at the Greville points of the knots."""
        count = len(knots_v) - DEGREE - 1
        greville = np.array([np.mean(knots_v[k + 1 : k + DEGREE + 1]) for k in range(count)])
        return self.start + (self.end - self.start) * greville


@dataclass(frozen=True, eq=False)
class Held:
    """Control points that keep a value.

    Attributes:
        axis: y or z.
        value: m; an array must fit the rows and columns.
        rows, columns: which of the net (nu, nv).
    """

    axis: Literal["y", "z"]
    value: float | StraightEdge | Array
    rows: slice = field(default_factory=lambda: EVERY)
    columns: slice = field(default_factory=lambda: EVERY)


FIRST, LAST = slice(0, 1), slice(-1, None)
LOWER_EDGE_ON_CENTREPLANE = Held("y", 0.0, columns=FIRST)
UPPER_EDGE_ON_CENTREPLANE = Held("y", 0.0, columns=LAST)
CLOSED_AFT, CLOSED_FORWARD = Held("y", 0.0, rows=FIRST), Held("y", 0.0, rows=LAST)


def upper_edge_at(height: float) -> Held:
    """The edge v = 1 at one height, m."""
    return Held("z", height, columns=LAST)


@dataclass(frozen=True)
class HeightLimits:
    """Between which heights free control points stay, m.

    Attributes:
        lowest, highest: m.
        below_seam: where the shared edge goes deeper, the lower limit is this far below it, m; None: it does not.
    """

    lowest: float
    highest: float
    below_seam: float | None = None

    def of(self, edge: Array | None) -> tuple[float, float]:
        """Lower and upper limit beside the control points (nv, 3) of a shared edge."""
        if edge is None or self.below_seam is None:
            return self.lowest, self.highest
        return min(self.lowest, float(np.min(edge[:, 2])) - self.below_seam), self.highest


@dataclass(frozen=True, eq=False)
class PatchPlan:
    """One patch of a hull before it is fitted.

    Attributes:
        name: of the patch.
        sections: what it is fitted to, rising in x.
        spans: knots of x(u); None: it shares u with the patch ``along``.
        knots: knots of v; None: those of the seam.
        held: control points that keep a value, later ones over earlier ones; the seam's own over all of them.
        seam: the edge shared with an earlier patch.
        along: the patch below, whose upper edge is this one's lower edge and whose u it shares.
        heights: limits of free control points.
        settings: weights and rounds of the fit.
        open_ends: ends that are flat and open, to be closed towards the centreplane by meshes.
    """

    name: str
    sections: Sequence[Section]
    spans: Spans | None
    knots: Array | None
    held: tuple[Held, ...]
    seam: Seam | None = None
    along: str | None = None
    heights: HeightLimits | None = None
    settings: FitSettings = field(default_factory=FitSettings)
    open_ends: tuple[End, ...] = ()


def fit_patches(plans: Iterable[PatchPlan], neighbours: Mapping[str, PatchFit] | None = None) -> dict[str, PatchFit]:
    """Fits patch after patch, each to its sections and to the edges of those before it.

    Args:
        plans: a patch that another one joins stands before it.
        neighbours: patches fitted earlier.

    Raises:
        ValueError: a plan joins a patch that is not there yet, or has no knots.
        numpy.linalg.LinAlgError: the sections do not determine a surface.
    """
    fits: dict[str, PatchFit] = {}
    for plan in plans:
        fits[plan.name] = _fit(plan, {**(neighbours or {}), **fits})
    return fits


def _fit(plan: PatchPlan, fitted: Mapping[str, PatchFit]) -> PatchFit:
    missing = [name for name in (plan.along, plan.seam and plan.seam.patch) if name and name not in fitted]
    if missing:
        raise ValueError(f"patch '{plan.name}' joins '{missing[0]}', which is not fitted before it")
    knots, edge = plan.knots, None
    if plan.seam is not None:
        own_knots, edge = _shared_edge(plan.seam, fitted[plan.seam.patch])
        knots = own_knots if knots is None else knots
    if knots is None:
        raise ValueError(f"patch '{plan.name}' has neither knots nor a seam")
    below = None if plan.along is None else fitted[plan.along].surface
    if plan.spans is not None:
        stations = plan.spans.station_map(edge)
    elif below is not None:
        stations = StationMap(below.knots_u, below.control_points[:, 0, 0])
    else:
        raise ValueError(f"patch '{plan.name}' has neither spans nor a patch below it")
    fixed_y, fixed_z = free_net(stations, knots)
    if below is not None:
        fixed_y[:, 0] = below.control_points[:, -1, 1]
    for held in plan.held:
        value = held.value.control_values(knots) if isinstance(held.value, StraightEdge) else held.value
        (fixed_y if held.axis == "y" else fixed_z)[held.rows, held.columns] = value
    if plan.seam is not None and edge is not None:
        row = ROW[OPPOSITE[plan.seam.end]]
        fixed_y[row], fixed_z[row] = edge[:, 1], edge[:, 2]
    return fit_patch(
        plan.sections,
        stations,
        knots,
        fixed_y,
        fixed_z,
        settings=plan.settings,
        edge=edge if plan.seam is not None and plan.seam.spread else None,
        heights=None if plan.heights is None else plan.heights.of(edge),
    )


def _shared_edge(seam: Seam, neighbour: PatchFit) -> tuple[Array, Array]:
    """Knots and control points of the shared edge."""
    surface = neighbour.surface
    edge = surface.control_points[ROW[seam.end]]
    if (seam.start, seam.stop, seam.extra_knots) == (0.0, 1.0, ()):
        return surface.knots_v, edge
    return edge_segment(surface.knots_v, edge, seam.start, seam.stop, np.array(seam.extra_knots))


def girths(plans: Iterable[PatchPlan]) -> dict[str, tuple[str, float, float]]:
    """Whose v each patch's v is, and which stretch of it: meshes of neighbours meet along these.

    A patch that joins another one counts in the v of the patch that one counts in, at the end of the chain one that
    joins nothing.
    """
    found: dict[str, tuple[str, float, float]] = {}
    for plan in plans:
        if plan.seam is None:
            found[plan.name] = (plan.name, 0.0, 1.0)
            continue
        base, low, high = found.get(plan.seam.patch, (plan.seam.patch, 0.0, 1.0))
        found[plan.name] = (base, low + plan.seam.start * (high - low), low + plan.seam.stop * (high - low))
    return found


def open_ends(plans: Iterable[PatchPlan]) -> list[tuple[str, str]]:
    """(patch, "first" or "last") of every flat open end."""
    return [(plan.name, end) for plan in plans for end in plan.open_ends]


def columns_on(knots_v: Array, low: float, high: float) -> slice:
    """Control points whose basis functions live between two knots of v with no knot between them.

    Held at y = 0 they put the edge on the centreplane there, exactly: a stern post or a stem.
    """
    count = len(knots_v) - DEGREE - 1
    first = int(np.searchsorted(knots_v, low, side="right")) - 1 - DEGREE
    return slice(min(max(first, 0), count - 1), min(int(np.searchsorted(knots_v, high)), count))


def knots_with(interior: Iterable[float], low: float, high: float, room: float = 0.02) -> list[float]:
    """Interior knots with two more (or one, where both are the same), without those that come too close to them."""
    return sorted([*(k for k in interior if not low - room <= k <= high + room), *{low, high}])


def _gentle_stations(x: Array, most: int) -> Array:
    """Stations as dense as the data whose spacing changes gently, from the first to the last of x."""
    if len(x) < 3:
        return np.linspace(x[0], x[-1], 4)
    count = int(np.clip(len(x) - 1, 3, most))
    chosen = np.interp(np.linspace(0.0, len(x) - 1.0, count + 1), np.arange(len(x)), x)
    spacing = np.log(np.diff(chosen))
    for _ in range(200):
        stations = x[0] + (x[-1] - x[0]) * np.concatenate([[0.0], np.cumsum(np.exp(spacing))]) / np.sum(np.exp(spacing))
        stations[-1] = x[-1]
        if len(spacing) < 2 or float(np.max(np.abs(np.diff(spacing)))) < np.log(LARGEST_SPAN_RATIO):
            return np.asarray(stations)
        padded = np.concatenate([spacing[:1], spacing, spacing[-1:]])
        spacing = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    return np.linspace(x[0], x[-1], count + 1)
