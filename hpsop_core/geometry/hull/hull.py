"""Parent hulls and the hulls derived from them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from hpsop_core.assets import SHIPPED_HULLS, read_asset_text
from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.form import LEAST_STRETCH, FormSolver, LongitudinalShift, ShiftFrame
from hpsop_core.geometry.hull.hydrostatics import (
    HullQuadrature,
    Hydrostatics,
    hydrostatics,
    integrate_parent,
    sectional_areas,
)
from hpsop_core.geometry.hull.offset_table import OffsetTable, tabulate
from hpsop_core.geometry.nurbs import NurbsSurface, basis_matrix, rising_spline_inverse
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, IntArray

# Stations of the offset table: intervals in fractions of the length with their spacing. The flat stern makes most of
# Michell's integral on a pram-sterned hull, hence the fine spacing aft.
STATION_SPACING = (
    (0.0, 0.085, 0.0014), (0.085, 0.17, 0.004), (0.17, 0.82, 0.016), (0.82, 0.96, 0.006), (0.96, 1.0, 0.0016)
)  # fmt: skip
HEIGHT_FRACTIONS = np.concatenate(
    [[0.0, 0.004, 0.012, 0.025, 0.045, 0.07, 0.1, 0.14], np.arange(0.19, 0.59, 0.05), np.arange(0.60, 0.84, 0.03),
     np.linspace(0.84, 1.0, 13)]
)  # fmt: skip
# Refitted patches leave the exact shift by at most this part of the length (4 mm of 355 m).
EXCHANGE_DEVIATION = 1e-5
_CACHE_LIMIT = 256


@dataclass(frozen=True)
class PatchDeviation:
    """How far the given points lie from one fitted patch, m; ``net`` is the size of its control net."""

    patch: str
    net: tuple[int, int]
    points: int
    rms_m: float
    p99_m: float
    max_m: float
    max_at_x_m: float
    max_at_z_m: float


@dataclass(frozen=True)
class FitReport:
    """What fitting a surface to given points has changed; ``str`` prints it for people.

    Attributes:
        source: the file.
        patches: one entry a patch.
        table_volume: displaced volume of the bare points by the trapezoidal rule, m3.
        fitted_volume: displaced volume of the surface, m3.
    """

    source: str
    patches: tuple[PatchDeviation, ...]
    table_volume: float
    fitted_volume: float

    def __str__(self) -> str:
        lines = [f"{self.source}: deviation of the fitted surface from the given points"]
        for p in self.patches:
            lines.append(
                f"  {p.patch:<11s} net {p.net[0]:3d} x {p.net[1]:<3d} rms {1e3 * p.rms_m:8.2f} mm  "
                f"99 % {1e3 * p.p99_m:8.2f} mm  max {1e3 * p.max_m:8.2f} mm at x {p.max_at_x_m:.3f} m, "
                f"z {p.max_at_z_m:.3f} m"
            )
        change = 100.0 * (self.fitted_volume / self.table_volume - 1.0)
        lines.append(
            f"  displaced volume {self.fitted_volume:.6g} m3, {change:+.2f} % against the trapezoidal rule on the table"
        )
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class ParentHull:
    """A hull as section patches from which designs are derived.

    Attributes:
        name: what the parent is called.
        length, breadth, draft: between perpendiculars, moulded, design, m.
        deck_height: height of the deck above the baseline, m.
        shaft_height: height of the shaft's axis above the baseline, m.
        boss_end_x: aft end of the stern boss, where the propeller's hub begins, m from AP.
        shift_frame: where sections may move.
        underwater, topsides: patches by name, port side; v = 1 of an underwater patch is the design waterline or, for
            the parts that are submerged altogether, their upper centreline.
        caps: (patch, "first" or "last"): ends in u that are flat and open (boss, transom), closed towards the
            centreplane by meshes.
        girth: patch -> (other, start, end): its v in [0, 1] is the other's v in [start, end] where they meet.
        along: patch -> other patch with the same u (a topsides patch and the patch below it).
        source: where the shape comes from.
        fit_report: how well the surface meets the points of a user's own hull.
        warnings: what every hull of this family has to say, one line each.
        lowest: height of the deepest point where that lies below the baseline (a dome, a raked keel), m, <= 0.
    """

    name: str
    length: float
    breadth: float
    draft: float
    deck_height: float
    shaft_height: float
    boss_end_x: float
    shift_frame: ShiftFrame
    underwater: Mapping[str, NurbsSurface]
    topsides: Mapping[str, NurbsSurface]
    caps: tuple[tuple[str, str], ...] = ()
    girth: Mapping[str, tuple[str, float, float]] = field(default_factory=dict)
    along: Mapping[str, str] = field(default_factory=dict)
    source: str = ""
    fit_report: FitReport | None = None
    warnings: tuple[str, ...] = ()
    lowest: float = 0.0
    _points: dict[tuple[str, bytes, bytes], Array] = field(default_factory=dict, repr=False)

    def surface(self, name: str) -> NurbsSurface:
        """The parent's patch of that name.

        Raises:
            InputError: there is no such patch.
        """
        for group in (self.underwater, self.topsides):
            if name in group:
                return group[name]
        raise InputError(f"hull '{self.name}': no patch '{name}' (has {', '.join([*self.underwater, *self.topsides])})")

    def points(self, name: str, u: Array, v: Array) -> Array:
        """Points of a patch in the parent's frame, (len(u), len(v), 3), read-only, remembered by parameters."""
        key = (name, np.asarray(u, dtype=np.float64).tobytes(), np.asarray(v, dtype=np.float64).tobytes())
        found = self._points.get(key)
        if found is None:
            found = self.surface(name).evaluate(u, v)
            found.setflags(write=False)
            if len(self._points) >= _CACHE_LIMIT:
                self._points.clear()
            self._points[key] = found
        return found

    def parameter(self, name: str, x: Array) -> Array:
        """u of a patch at stations x of the parent's frame (x is monotone in u), clipped to the patch."""
        surface = self.surface(name)
        return rising_spline_inverse(
            surface.knots_u, surface.degree_u, surface.control_points[:, 0, 0], np.asarray(x, dtype=np.float64)
        )

    def extent(self, name: str) -> tuple[float, float]:
        """First and last x of a patch in the parent's frame."""
        net = self.surface(name).control_points
        return float(net[0, 0, 0]), float(net[-1, 0, 0])

    @cached_property
    def _table(self) -> tuple[Array, Array, Array]:
        """Stations, heights and half-breadths of the parent's offset table."""
        extents = [self.extent(name) for name in self.underwater]
        ends = sorted({value for extent in extents for value in extent})
        low, high = ends[0], ends[-1]
        pieces: list[Array] = [np.array(ends)]
        for start, stop, step in STATION_SPACING:
            a, b = (low + (high - low) * part for part in (start, stop))
            pieces.append(np.linspace(a, b, max(2, round((stop - start) / step) + 1)))
        # Ends of patches (the boss, the aperture, the stem) are stations; regular ones too close to them give way.
        x = np.unique(np.concatenate(pieces))
        near = 2e-4 * (high - low)
        keep = [k for k in range(len(x)) if x[k] in ends or float(np.min(np.abs(np.array(ends) - x[k]))) > near]
        x = x[keep]
        z = self.lowest + HEIGHT_FRACTIONS * (self.draft - self.lowest)
        z[-1] = self.draft
        parameters, stations = self._covered(x)
        return x, z, tabulate(list(self.underwater.values()), parameters, stations, x, z)

    def _covered(self, x: Array) -> tuple[list[Array], list[IntArray]]:
        parameters, stations = [], []
        for name in self.underwater:
            first, last = self.extent(name)
            inside = np.flatnonzero((x >= first - 1e-9) & (x <= last + 1e-9))
            stations.append(inside)
            parameters.append(self.parameter(name, x[inside]))
        return parameters, stations

    @cached_property
    def quadrature(self) -> HullQuadrature:
        """Integrands of the hydrostatics at Gauss points."""
        x = self._table[0]
        parameters, stations = self._covered(x)
        area = np.zeros_like(x)
        # A station on the border of two patches belongs to both: the larger area is the section's.
        for surface, u, index in zip(self.underwater.values(), parameters, stations, strict=True):
            own = sectional_areas(surface, u) if len(u) else np.zeros(0)
            first, last = x[index[0]] if len(index) else 0.0, x[index[-1]] if len(index) else 0.0
            border = (x[index] == first) | (x[index] == last)
            area[index] = np.where(border, np.maximum(area[index], own), area[index] + own)
        return integrate_parent(list(self.underwater.values()), self.length, self.draft, x, area)

    @cached_property
    def _form_solver(self) -> FormSolver:
        quadrature = self.quadrature
        return FormSolver(self.shift_frame, quadrature.x, quadrature.area * quadrature.width)

    @cached_property
    def hydrostatics(self) -> Hydrostatics:
        """Hydrostatics of the parent itself."""
        return self.transform(self.length, self.breadth, self.draft).hydrostatics

    @one_blas_thread()
    def transform(
        self,
        length: float,
        breadth: float,
        draft: float,
        displaced_volume: float | None = None,
        buoyancy_centre_shift: float = 0.0,
    ) -> Hull:
        """A hull of this family.

        Args:
            length, breadth, draft: of the new hull, m.
            displaced_volume: m3; None keeps the parent's block coefficient by pure scaling.
            buoyancy_centre_shift: shift of the longitudinal centre of buoyancy against the scaled parent's, m, positive
                forward; the volume is then held even where ``displaced_volume`` is None.

        Raises:
            InputError: a dimension is not a positive number.
        """
        for name, value in (("length", length), ("breadth", breadth), ("draft", draft)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"hull '{self.name}': {name} must be a positive number of metres, not {value}")
        if displaced_volume is not None and not (np.isfinite(displaced_volume) and displaced_volume > 0.0):
            raise InputError(f"hull '{self.name}': displaced volume must be positive, not {displaced_volume}")
        if not np.isfinite(buoyancy_centre_shift):
            raise InputError(f"hull '{self.name}': shift of the centre of buoyancy must be finite")
        scale = (length / self.length, breadth / self.breadth, draft / self.draft)
        quadrature = self.quadrature
        shift = LongitudinalShift(self.shift_frame, 0.0, 0.0)
        warnings: tuple[str, ...] = ()
        clipped, centre_held = False, True
        if displaced_volume is not None or buoyancy_centre_shift != 0.0:
            solver = self._form_solver
            volume = solver.volume
            if displaced_volume is not None:
                volume = displaced_volume / (scale[0] * scale[1] * scale[2])
            solution = solver.solve(volume, solver.centre + buoyancy_centre_shift / scale[0])
            shift, clipped, centre_held = solution.shift, solution.clipped, solution.centre_held
        measured = hydrostatics(quadrature, shift, scale, (length, breadth, draft))
        if clipped:
            asked = volume * scale[0] * scale[1] * scale[2]
            warnings = (_clipped_line(measured, asked, solver.centre * scale[0] + buoyancy_centre_shift),)
        elif not centre_held:
            own = self._form_solver.centre * scale[0] + buoyancy_centre_shift
            moved = measured.longitudinal_centre_of_buoyancy - own
            warnings = (
                f"this hull cannot hold its centre of buoyancy while its volume changes: it lies {moved:+.3g} m "
                "from the asked place",
            )
        return Hull(self, length, breadth, draft, shift, measured, clipped, (*warnings, *self.warnings))


def _clipped_line(measured: Hydrostatics, volume: float, centre: float) -> str:
    """What a clipped form has reached instead of the asked volume (m3) and centre of buoyancy (m from AP)."""
    parts = [f"form clipped at dx'/dx = {LEAST_STRETCH}:"]
    if abs(measured.displaced_volume / volume - 1.0) > 1e-5:
        block = measured.block_coefficient * volume / measured.displaced_volume
        parts.append(
            f"block coefficient {measured.block_coefficient:.4f} instead of {block:.4f}, displaced volume "
            f"{measured.displaced_volume:.6g} m3 instead of {volume:.6g} m3;"
        )
    reached = measured.longitudinal_centre_of_buoyancy
    if abs(reached - centre) > 1e-5 * abs(centre):
        parts.append(f"centre of buoyancy {reached:.5g} m from AP instead of {centre:.5g} m;")
    return " ".join(parts).rstrip(";")


@dataclass(frozen=True, eq=False)
class HullPatch:
    """One patch of a hull: the parent's surface, its sections shifted, then scaled.

    Attributes:
        name: patch name.
        underwater: below the design waterline.
    """

    hull: Hull
    name: str
    underwater: bool

    def evaluate(self, u: Array, v: Array) -> Array:
        """Points (len(u), len(v), 3) in ship axes, m, port side."""
        return self.hull.patch_points(self.name, u, v)

    def derivatives(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Points and first derivatives in u and v, each (len(u), len(v), 3)."""
        points, along, across = self.hull.parent.surface(self.name).derivatives(u, v)
        moved, stretch = self.hull.shift.evaluate(points[..., 0])
        scale = np.array(self.hull.scale)
        points[..., 0] = moved
        along[..., 0] *= stretch
        return points * scale, along * scale, across * scale

    def parameter(self, x: Array) -> Array:
        """u at stations x of this hull (m), clipped to the patch."""
        return self.hull.patch_parameter(self.name, x)


@dataclass(frozen=True, eq=False)
class Hull:
    """A hull in ship axes: x forward from AP, y to port, z up from the baseline, m; patches are the port side.

    Attributes:
        parent: where its sections come from.
        length, breadth, draft: m.
        shift: longitudinal shift in the parent's frame, applied before scaling.
        hydrostatics: measured on this geometry.
        clipped: the asked form was beyond what the parent carries.
        warnings: one line each.
    """

    parent: ParentHull
    length: float
    breadth: float
    draft: float
    shift: LongitudinalShift
    hydrostatics: Hydrostatics
    clipped: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def scale(self) -> tuple[float, float, float]:
        """Factors in x, y, z against the parent."""
        return self.length / self.parent.length, self.breadth / self.parent.breadth, self.draft / self.parent.draft

    @property
    def shaft_height(self) -> float:
        """Height of the shaft's axis above the baseline, m; scales with the draft."""
        return self.parent.shaft_height * self.draft / self.parent.draft

    @property
    def depth(self) -> float:
        """Height of the deck above the baseline, m; scales with the draft.

        A shipped hull states it; of an own hull it is the highest waterline of the table or of the sampled mesh, and
        where nothing reaches above the draft, that of the upright walls which stand in for the topsides.
        """
        return self.parent.deck_height * self.draft / self.parent.draft

    @property
    def boss_end_x(self) -> float:
        """x of the aft end of the boss, where the hub's forward face stands, m; scales with the length."""
        return self.parent.boss_end_x * self.length / self.parent.length

    @property
    def patches(self) -> tuple[HullPatch, ...]:
        """All patches, underwater ones first."""
        return tuple(HullPatch(self, name, True) for name in self.parent.underwater) + tuple(
            HullPatch(self, name, False) for name in self.parent.topsides
        )

    def station_map(self, x: Array) -> Array:
        """Where the parent's stations x stand in this hull, m."""
        return np.asarray(self.shift.evaluate(x)[0] * (self.length / self.parent.length))

    def patch_points(self, patch_name: str, u: Array, v: Array) -> Array:
        """Points of a patch on the tensor grid u x v: (len(u), len(v), 3), m; cheap for parameters seen before."""
        parent = self.parent.points(patch_name, u, v)
        result: Array = parent * np.array(self.scale)
        # x depends on u alone
        result[..., 0] = self.station_map(parent[:, 0, 0])[:, None]
        return result

    def patch_parameter(self, patch_name: str, x: Array) -> Array:
        """u of a patch at stations x of this hull (m), clipped to the patch."""
        target = np.asarray(x, dtype=np.float64) / self.scale[0]
        low, high = (np.full_like(target, end) for end in self.parent.extent(patch_name))
        for _ in range(50):
            middle = 0.5 * (low + high)
            above = self.shift.evaluate(middle)[0] > target
            high, low = np.where(above, middle, high), np.where(above, low, middle)
        return self.parent.parameter(patch_name, 0.5 * (low + high))

    def waterline(self, count: int = 201) -> Array:
        """The design waterline, port side, stern to stem: (n, 2) of x and y in m; n about count, y = 0 at both ends."""
        pieces: list[Array] = []
        draft = self.parent.draft
        # up to the rounding of a fit
        at_top = {n: np.abs(s.control_points[:, -1, 2] - draft) for n, s in self.parent.underwater.items()}
        names = [n for n, away in at_top.items() if np.all(away < 1e-9 * draft)]
        for name in sorted(names, key=lambda n: self.parent.extent(n)[0]):
            u = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, max(3, count // len(names))))
            points = self.patch_points(name, u, np.array([1.0]))[:, 0, :2]
            pieces.append(points if not pieces else points[1:])
        return np.concatenate(pieces)

    def sections(self, x: Array, points: int = 101, underwater_only: bool = False) -> tuple[tuple[Array, ...], ...]:
        """The port half of the sections at stations x (m), exact on the surface.

        One line (points, 3) in m, from below upwards, for every patch that a station meets; none beyond the ends.
        """
        v = np.linspace(0.0, 1.0, points)
        found: list[list[Array]] = [[] for _ in x]
        for patch in self.patches:
            if underwater_only and not patch.underwater:
                continue
            first, last = self.station_map(np.array(self.parent.extent(patch.name)))
            # A station on the border of two patches belongs to the forward one; all of a patch at once, for speed.
            inside = np.flatnonzero((x >= first) & (x < last))
            if len(inside):
                for index, line in zip(inside, patch.evaluate(patch.parameter(x[inside]), v), strict=True):
                    found[index].append(line)
        return tuple(tuple(lines) for lines in found)

    def offset_table(self) -> OffsetTable:
        """Half-breadths for thin-ship theory; stations move with the sections, so y is the parent's, scaled."""
        x, z, y = self.parent._table
        _, sy, sz = self.scale
        heights = z * sz
        heights[-1] = self.draft
        return OffsetTable(self.station_map(x), heights, y * sy)

    @one_blas_thread()
    def nurbs_patch(self, patch_name: str) -> tuple[NurbsSurface, float]:
        """The patch as a NURBS surface for exchange files, with its largest deviation from this hull in m.

        The shift is not a spline: x of u is refitted, with knots inserted where it bends; y and z only scale.
        """
        surface = self.parent.surface(patch_name)
        for _ in range(7):
            u = np.linspace(0.0, 1.0, 10 * len(surface.control_points) + 1)
            basis = basis_matrix(surface.knots_u, surface.degree_u, u)
            control = surface.control_points[:, 0, 0]
            x = basis @ control
            shifted = self.shift.evaluate(x)[0]
            # Both ends stay on the neighbours' ends.
            new = control.copy()
            new[0], new[-1] = shifted[0], shifted[-1]
            rest = shifted - basis[:, [0, -1]] @ new[[0, -1]]
            new[1:-1] = np.linalg.lstsq(basis[:, 1:-1], rest, rcond=None)[0]
            error = np.abs(basis @ new - shifted) * self.scale[0]
            deviation = float(np.max(error))
            if deviation < EXCHANGE_DEVIATION * self.length:
                break
            breaks = np.unique(surface.knots_u)
            span = np.clip(np.searchsorted(breaks, u, side="right") - 1, 0, len(breaks) - 2)
            bad = np.unique(span[error >= EXCHANGE_DEVIATION * self.length])
            surface = surface.with_knots_u(0.5 * (breaks[bad] + breaks[bad + 1]))
        net = surface.control_points * np.array(self.scale)
        net[..., 0] = (new * self.scale[0])[:, None]
        return (
            NurbsSurface(surface.degree_u, surface.degree_v, surface.knots_u, surface.knots_v, net, surface.weights),
            deviation,
        )


def parent_hull_from_dict(data: dict[str, Any]) -> ParentHull:
    """A parent hull from the shipped JSON form.

    Raises:
        InputError: a key is missing or unreadable.
    """
    try:
        groups: dict[str, dict[str, NurbsSurface]] = {"underwater": {}, "topsides": {}}
        for patch in data["patches"]:
            groups[patch["group"]][patch["name"]] = NurbsSurface.from_dict(patch)
        frame = data["shift"]
        return ParentHull(
            name=data["name"],
            length=float(data["length"]),
            breadth=float(data["breadth"]),
            draft=float(data["draft"]),
            deck_height=float(data["deck_height"]),
            shaft_height=float(data["shaft_height"]),
            boss_end_x=float(data["boss_end_x"]),
            shift_frame=ShiftFrame(
                float(frame["aft"]), float(frame["middle"]), float(frame["forward"]), float(data["length"])
            ),
            underwater=groups["underwater"],
            topsides=groups["topsides"],
            caps=tuple((str(name), str(end)) for name, end in data.get("caps", ())),
            girth={name: (str(g[0]), float(g[1]), float(g[2])) for name, g in data.get("girth", {}).items()},
            along={str(name): str(other) for name, other in data.get("along", {}).items()},
            source=str(data.get("source", "")),
        )
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"hull file: unreadable ({problem!r})") from problem


@lru_cache(maxsize=8)
def load_parent_hull(name: str = "dtc") -> ParentHull:
    """A shipped parent hull.

    Raises:
        InputError: no hull of that name is shipped.
    """
    if name not in SHIPPED_HULLS:
        raise InputError(f"hull '{name}' is not shipped; available: {', '.join(SHIPPED_HULLS)}")
    return parent_hull_from_dict(json.loads(read_asset_text("hulls", f"{name}.json")))
