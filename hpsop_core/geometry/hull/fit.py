"""Least-squares fit of one hull patch to cross-sections.

A hull patch here is a B-spline surface whose x depends on u alone: every iso-u curve is a cross-section. That makes
sectional areas, offsets and the longitudinal form transformation exact on the surface, and it is why the fit is
linear: only y and z of the control points are unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from scipy import linalg, sparse
from scipy.interpolate import BSpline, PchipInterpolator, make_interp_spline

from hpsop_core.geometry.nurbs import NurbsSurface, basis_matrix, clamped_knots, rising_spline_inverse
from hpsop_core.typing_aliases import Array

DEGREE = 3
# Points that a section is resampled to at equal chord length.
SAMPLES = 81
# Of the search for the control points that a limit holds: rounds without progress before it goes one by one, and all in
# all. It is over in five as a rule, in ten at a blunt bulb.
_PATIENCE = 3
_MOST_ROUNDS = 300


@dataclass(frozen=True)
class FitSettings:
    """Weights and rounds of a fit.

    Attributes:
        smoothing: weight of the second differences of the net; it only decides what the points leave open.
        rounds: corrections of v by projection.
        least_half_breadth: free control points keep this distance from the centreplane, m: the sides never cross.
    """

    smoothing: float = 5e-2
    rounds: int = 4
    least_half_breadth: float = 2e-3


@dataclass(frozen=True)
class StationMap:
    """x as a rising cubic B-spline of the surface parameter u.

    Attributes:
        knots: clamped knots on [0, 1].
        control_x: coefficients in metres.
    """

    knots: Array
    control_x: Array

    @staticmethod
    def through(stations: Sequence[float], flat_start: bool, flat_end: bool) -> StationMap:
        """The map that passes the given stations at equally spaced u.

        Args:
            stations: rising x; one knot span between neighbours.
            flat_start, flat_end: dx/du = 0 at that end, so that a rounded end (y like the root of the distance) is
                smooth in u.
        """
        at = np.linspace(0.0, 1.0, len(stations))
        ends = [(1, 0.0) if flat else (2, 0.0) for flat in (flat_start, flat_end)]
        spline = make_interp_spline(at, np.asarray(stations, dtype=np.float64), DEGREE, bc_type=([ends[0]], [ends[1]]))
        fine = spline(np.linspace(0.0, 1.0, 40 * len(stations)))
        if np.any(np.diff(fine) <= 0.0):
            raise ValueError(f"station map is not rising near x = {fine[int(np.argmin(np.diff(fine)))]:.2f} m")
        control = np.array(spline.c)
        control[0], control[-1] = stations[0], stations[-1]
        return StationMap(np.asarray(spline.t), control)

    def x(self, u: Array) -> Array:
        """x in metres at parameters u."""
        return np.asarray(BSpline(self.knots, self.control_x, DEGREE)(u))

    def u(self, x: Array) -> Array:
        """The inverse of `x`."""
        return rising_spline_inverse(self.knots, DEGREE, self.control_x, np.asarray(x, dtype=np.float64))


@dataclass(frozen=True)
class Section:
    """A cross-section to be fitted.

    Attributes:
        x: station in metres.
        points: (k, 2) half-breadths and heights from v = 0 to v = 1, metres.
        knuckle: index of a point where the section turns sharply, and the v that it has in every section of the patch.
    """

    x: float
    points: Array
    knuckle: tuple[int, float] | None = None

    def resampled(self, fractions: Array) -> Array:
        """Points at fractions of the chord length, through a shape-preserving cubic: shape (len(fractions), 2).

        A knuckle stays sharp: each side of it has a curve of its own.
        """
        chord = self.chord_fractions()
        if self.knuckle is None:
            return _through(chord, self.points, fractions)
        at, v = self.knuckle
        below = _through(chord[: at + 1], self.points[: at + 1], np.minimum(fractions, v))
        above = _through(chord[at:], self.points[at:], np.maximum(fractions, v))
        return np.where((fractions <= v)[:, None], below, above)

    def chord_fractions(self) -> Array:
        """Cumulative chord length of the points over its total, shape (k,); with a knuckle, over that of each side."""
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        total = np.concatenate([[0.0], np.cumsum(steps)])
        if self.knuckle is None:
            return np.asarray(total / total[-1])
        at, v = self.knuckle
        above = v + (1.0 - v) * (total - total[at]) / (total[-1] - total[at])
        fractions = np.where(np.arange(len(total)) <= at, v * total / total[at], above)
        fractions[-1] = 1.0
        return np.asarray(fractions)


def _through(chord: Array, points: Array, fractions: Array) -> Array:
    """Points (n, 2) at fractions of a chord, by a shape-preserving cubic, or a line where there are only two."""
    if len(points) < 3:
        return np.column_stack([np.interp(fractions, chord, points[:, axis]) for axis in (0, 1)])
    return np.asarray(PchipInterpolator(chord, points)(fractions))


def tidy_section(x: float, points: Array, least_step: float = 1e-3) -> Section:
    """A section without points closer than ``least_step`` metres to their predecessor (the last point stays)."""
    kept = [points[0]]
    for point in points[1:-1]:
        if np.hypot(*(point - kept[-1])) > least_step and np.hypot(*(point - points[-1])) > least_step:
            kept.append(point)
    kept.append(points[-1])
    return Section(x, np.array(kept))


class DeviationSummary(TypedDict):
    """Deviation of given points from a patch, m, with the place of the largest."""

    points: int
    rms_m: float
    p99_m: float
    max_m: float
    max_at_x_m: float
    max_at_z_m: float


@dataclass(frozen=True)
class PatchFit:
    """A fitted patch and how far the given points lie from it.

    Attributes:
        surface: the fitted surface.
        deviation: distance of every given point along the surface normal, metres, shape (n,).
        where: the points, (n, 3), metres.
    """

    surface: NurbsSurface
    deviation: Array
    where: Array

    def summary(self) -> DeviationSummary:
        """Root mean square, 99th percentile and maximum deviation in metres with the place of the maximum."""
        worst = int(np.argmax(self.deviation))
        return {
            "points": len(self.deviation),
            "rms_m": float(np.sqrt(np.mean(self.deviation**2))),
            "p99_m": float(np.percentile(self.deviation, 99.0)),
            "max_m": float(self.deviation[worst]),
            "max_at_x_m": float(self.where[worst, 0]),
            "max_at_z_m": float(self.where[worst, 2]),
        }


def _projected(surface: NurbsSurface, u: Array, v: Array, target: Array, iterations: int) -> Array:
    """Parameters v of the points of the iso-u curves nearest to the targets (n, 2), by a damped Gauss-Newton."""
    for _ in range(iterations):
        left = basis_matrix(surface.knots_u, DEGREE, u)
        value = basis_matrix(surface.knots_v, DEGREE, v)
        slope = basis_matrix(surface.knots_v, DEGREE, v, 1)
        rows = np.einsum("iu,uvk->ivk", left, surface.control_points[..., 1:])
        point = np.einsum("ivk,iv->ik", rows, value)
        tangent = np.einsum("ivk,iv->ik", rows, slope)
        step = np.sum((target - point) * tangent, axis=1) / np.maximum(np.sum(tangent**2, axis=1), 1e-12)
        v = np.clip(v + np.clip(step, -0.02, 0.02), 0.0, 1.0)
    return v


def _row_kronecker(left: Array, right: Array) -> sparse.csr_matrix:
    """Rows of products of basis functions, (n, nu * nv), sparse."""
    count, nu = left.shape
    nv = right.shape[1]
    rows, columns, values = [], [], []
    span = DEGREE + 1
    first_u = np.clip(np.argmax(left != 0.0, axis=1), 0, nu - span)
    first_v = np.clip(np.argmax(right != 0.0, axis=1), 0, nv - span)
    index = np.arange(count)
    for a in range(span):
        for b in range(span):
            rows.append(index)
            columns.append((first_u + a) * nv + first_v + b)
            values.append(left[index, first_u + a] * right[index, first_v + b])
    return sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(count, nu * nv)
    )


def _roughness(nu: int, nv: int) -> sparse.csr_matrix:
    """Second differences of the control net in both directions."""

    def second(n: int) -> sparse.csr_matrix:
        return sparse.diags([1.0, -2.0, 1.0], [0, 1, 2], shape=(n - 2, n), format="csr")

    return sparse.vstack([sparse.kron(second(nu), sparse.eye(nv)), sparse.kron(sparse.eye(nu), second(nv))]).tocsr()


def fit_patch(
    sections: Sequence[Section],
    stations: StationMap,
    knots_v: Array,
    fixed_y: Array,
    fixed_z: Array,
    *,
    settings: FitSettings = FitSettings(),
    edge: Array | None = None,
    heights: tuple[float, float] | None = None,
) -> PatchFit:
    """Fit y and z of a control net to sections by least squares with parameter correction.

    Args:
        sections: rising in x, within the range of the station map.
        stations: x of u; its control points are the x of the surface's net.
        knots_v: clamped knots along the section.
        fixed_y, fixed_z: (nu, nv), NaN where the value is free, else the value the control point keeps.
        settings: weights and rounds.
        edge: control points (nv, 3) of a shared edge in u; sections then spread v along their girth as that edge does,
            so that parameter lines run on smoothly from the neighbour.
        heights: lowest and highest z of free control points, m, so that the surface stays between them: a profile that
            jumps from one station to the next would else swing below the keel or above the waterline.

    Returns:
        The surface and the deviation of the given points.
    """
    fractions = np.linspace(0.0, 1.0, SAMPLES)
    u_of = stations.u(np.array([section.x for section in sections]))
    dense = [section.resampled(fractions) for section in sections]
    points = np.concatenate([*dense, *(section.points for section in sections)])
    u = np.concatenate([np.repeat(u_of, SAMPLES), np.repeat(u_of, [len(s.points) for s in sections])])
    v = np.concatenate([np.tile(fractions, len(sections)), *(s.chord_fractions() for s in sections)])
    # Ends are told before the spreading: its rounding must not decide which points are held there.
    pinned = (v == 0.0) | (v == 1.0)
    if edge is not None:
        v = np.where(pinned, v, _spread_of(knots_v, edge)(v))
    weight = np.where(pinned, 4.0, 1.0)
    nu, nv = len(stations.control_x), len(knots_v) - DEGREE - 1
    net = np.zeros((nu, nv, 3))
    net[..., 0] = stations.control_x[:, None]
    left = basis_matrix(stations.knots, DEGREE, u)
    rough = settings.smoothing * _roughness(nu, nv)
    surface: NurbsSurface | None = None
    for _ in range(settings.rounds + 1):
        if surface is not None:
            moved = _projected(surface, u, v, points, 2)
            v = np.where(pinned, v, moved)
        design = sparse.diags(weight) @ _row_kronecker(left, basis_matrix(knots_v, DEGREE, v))
        for axis, fixed, limits in ((0, fixed_y, None), (1, fixed_z, heights)):
            net[..., axis + 1] = bounded_least_squares(design, weight * points[:, axis], rough, fixed, limits)
        net[..., 1] = np.where(np.isnan(fixed_y), np.maximum(net[..., 1], settings.least_half_breadth), net[..., 1])
        surface = NurbsSurface(DEGREE, DEGREE, stations.knots, knots_v, net, np.ones((nu, nv)))
    if surface is None:
        raise ValueError("a fit needs at least one round")
    given = len(sections) * SAMPLES
    return _deviation(surface, u[given:], v[given:], points[given:], pinned[given:])


def _spread_of(knots_v: Array, edge: Array) -> PchipInterpolator:
    """v as a function of the chord fraction along an edge curve."""
    v = np.linspace(0.0, 1.0, 401)
    points = basis_matrix(knots_v, DEGREE, v) @ edge
    steps = np.maximum(np.linalg.norm(np.diff(points, axis=0), axis=1), 1e-9)
    fraction = np.concatenate([[0.0], np.cumsum(steps)]) / np.sum(steps)
    fraction[-1] = 1.0
    return PchipInterpolator(fraction, v)


def bounded_least_squares(
    design: sparse.csr_matrix,
    target: Array,
    rough: sparse.csr_matrix,
    fixed: Array,
    limits: tuple[float, float] | None,
) -> Array:
    """The control values that fit best between two limits: bounded least squares, by block principal pivoting.

    In each round values beyond a limit are held at it, and held ones that would rather go back are let go, all at once
    while that makes them fewer, else one at a time, which ends. Without the letting go each held value throws its
    neighbours over the other limit, until the net swings from one to the other. (J. Judice, F. Pires: A block principal
    pivoting algorithm for large-scale strictly monotone linear complementarity problems, Computers & Operations
    Research 21, 1994; here with two limits.)

    Args:
        design: (m, nu * nv) basis functions at the points, with the points' weights.
        target: (m,) coordinates of the points, m, with their weights.
        rough: (k, nu * nv), whose product with the values shall be small too.
        fixed: (nu, nv), NaN where the value is free, else the value it keeps, which no limit touches.
        limits: lowest and highest free value, m; None: any.

    Returns:
        (nu, nv) values, m.
    """
    known = ~np.isnan(fixed.ravel())
    values = np.where(known, np.nan_to_num(fixed.ravel()), 0.0)
    normal = (design.T @ design + rough.T @ rough).tocsr()
    towards = design.T @ target
    low, high = limits or (-np.inf, np.inf)
    side = np.zeros(len(values), dtype=np.int64)  # -1 held at the lower limit, 1 at the upper one
    fewest, patience = len(values) + 1, _PATIENCE
    for _ in range(_MOST_ROUNDS):
        values[side < 0], values[side > 0] = low, high
        held = known | (side != 0)
        free = np.flatnonzero(~held)
        right = towards - normal @ np.where(held, values, 0.0)
        values[free] = linalg.solve(normal[free][:, free].toarray(), right[free], assume_a="pos")
        drawn = towards - normal @ values
        wanted = np.where(side * drawn < 0.0, 0, side)
        wanted[free] = (values[free] > high).astype(np.int64) - (values[free] < low)
        wrong = np.flatnonzero(~known & (wanted != side))
        if len(wrong) == 0:
            break
        patience = _PATIENCE if len(wrong) < fewest else patience - 1
        fewest = min(fewest, len(wrong))
        turned = wrong if patience >= 0 else wrong[-1:]
        side[turned] = wanted[turned]
    return np.asarray(np.where(known, values, np.clip(values, low, high)).reshape(fixed.shape))


def _deviation(surface: NurbsSurface, u: Array, v: Array, target: Array, pinned: Array) -> PatchFit:
    v = _projected(surface, u, v, target, 12)
    x = surface.evaluate_pairs(u, v)[:, 0]
    left = [basis_matrix(surface.knots_u, DEGREE, u, order) for order in (0, 1)]
    right = [basis_matrix(surface.knots_v, DEGREE, v, order) for order in (0, 1)]
    net = surface.control_points
    along = np.einsum("iu,uvk,iv->ik", left[1], net, right[0], optimize=True)
    across = np.einsum("iu,uvk,iv->ik", left[0], net, right[1], optimize=True)
    normal = np.cross(along, across)
    size = np.linalg.norm(normal, axis=1)
    offset = target - surface.evaluate_pairs(u, v)[:, 1:]
    in_section = np.hypot(offset[:, 0], offset[:, 1])
    along_normal = np.abs(np.sum(offset * normal[:, 1:], axis=1)) / np.maximum(size, 1e-12)
    # At a degenerate edge or a pinned end there is no usable normal: the distance in the section stands.
    deviation = np.where(pinned | (size < 1e-9) | (v == 0.0) | (v == 1.0), in_section, along_normal)
    return PatchFit(surface, deviation, np.column_stack([x, target]))


def free_net(stations: StationMap, knots_v: Array) -> tuple[Array, Array]:
    """Two (nu, nv) arrays of NaN: nothing fixed yet."""
    shape = (len(stations.control_x), len(knots_v) - DEGREE - 1)
    return np.full(shape, np.nan), np.full(shape, np.nan)


def edge_segment(knots_v: Array, edge: Array, start: float, end: float, extra: Array) -> tuple[Array, Array]:
    """The stretch start <= v <= end of an edge curve as a curve of its own, with further knots inserted.

    Exact: knot insertion and splitting by geomdl (The NURBS Book, algorithms A5.1 and A5.4).

    Args:
        knots_v, edge: the whole curve, control points (nv, 3).
        start, end: parameters of the stretch.
        extra: additional interior knots in the new parameter (0..1).

    Returns:
        Clamped knots on [0, 1] and control points of the stretch.
    """
    from geomdl import BSpline as GeomdlBSpline
    from geomdl import operations

    curve = GeomdlBSpline.Curve()
    curve.degree = DEGREE
    curve.ctrlpts = edge.tolist()
    curve.knotvector = knots_v.tolist()
    if end < 1.0:
        curve, _ = operations.split_curve(curve, end)
        start = start / end
    if start > 0.0:
        _, curve = operations.split_curve(curve, start)
    for knot in extra:
        if np.min(np.abs(np.asarray(curve.knotvector) - knot)) > 1e-3:
            operations.insert_knot(curve, [float(knot)], [1])
    return np.asarray(curve.knotvector, dtype=np.float64), np.asarray(curve.ctrlpts, dtype=np.float64)


def knots_at(interior: Sequence[float]) -> Array:
    """Clamped cubic knot vector with the given interior knots."""
    return clamped_knots(list(interior), DEGREE)
