"""Panels on one propeller blade, its share of the hub, and its wake.

Solver axes: lengths in tip radii (R = 1), x downstream, a point at (r, theta) is (x, r cos theta, r sin theta) with
theta in the sense of rotation. They mirror the propeller axes of `geometry.propeller_surface` (y and z are swapped);
`to_propeller_axes` goes back.

Blade: corners[i, j], i from the trailing edge along the face (pressure side) to the leading edge and back along the
back (suction side), j from the hub to the tip; both spacings are cosines. Collocation points lie half way in i and, in
j, at the cosine mid-point of the strip (the quadrature point of an elliptic loading; the centroid would give KT 5 %
too high on ten strips). The tip is an edge of finite chord and no thickness: a tip of no chord would make the
sections of wide blades cut each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.propeller import BladeSections, Propeller
from hpsop_core.geometry.propeller_sections import cosine_chord_fractions
from hpsop_core.geometry.propeller_surface import blade_cylindrical
from hpsop_core.hydro.influence_blade import PanelSet, panel_set
from hpsop_core.typing_aliases import Array

STAGE = "blade_panels"
TIP_CHORD_RADIUS = 0.995
"""The tip edge has the chord that the table gives at this r/R."""


@dataclass(frozen=True)
class StripSurface:
    """A lifting surface as a grid of panels.

    Attributes:
        corners: (n + 1, m + 1, 3); i from the trailing edge over the lower side to the leading edge and back.
        panels: the n m panels, panel (i, j) at i m + j.
        collocation: (n, m, 3).
        normal: (n, m, 3) unit outward normals at the collocation points.
        span_fraction: (m,) place of the collocation points between the edges of their strip.
    """

    corners: Array
    panels: PanelSet
    collocation: Array
    normal: Array
    span_fraction: Array

    @property
    def shape(self) -> tuple[int, int]:
        return int(self.corners.shape[0]) - 1, int(self.corners.shape[1]) - 1


def grid_quadrilaterals(corners: Array) -> Array:
    """Quadrilaterals (n m, 4, 3) of a corner grid (n + 1, m + 1, 3), counter-clockwise about (d/dj) x (d/di)."""
    quads = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=2)
    return quads.reshape(-1, 4, 3)


def bilinear_points(corners: Array, span_fraction: Array) -> tuple[Array, Array]:
    """Points half way along i and at `span_fraction` (m,) along j, and the unit normals there: two (n, m, 3)."""
    f = span_fraction[None, :, None]
    start = (1.0 - f) * corners[:-1, :-1] + f * corners[:-1, 1:]
    end = (1.0 - f) * corners[1:, :-1] + f * corners[1:, 1:]
    along_j = 0.5 * (corners[:-1, 1:] - corners[:-1, :-1] + corners[1:, 1:] - corners[1:, :-1])
    normal = np.cross(along_j, end - start)
    size = np.linalg.norm(normal, axis=2, keepdims=True)
    return 0.5 * (start + end), normal / np.maximum(size, 1e-300)


def strip_surface(corners: Array, span_fraction: Array) -> StripSurface:
    """The lifting surface with these corners."""
    collocation, normal = bilinear_points(corners, span_fraction)
    return StripSurface(corners, panel_set(grid_quadrilaterals(corners)), collocation, normal, span_fraction)


def cosine_stations(start: float, end: float, count: int) -> tuple[Array, Array, Array]:
    """Edges (count + 1), cosine mid-points (count) and the place of the latter between the edges (count)."""
    edges = start + (end - start) * 0.5 * (1.0 - np.cos(np.pi * np.arange(count + 1) / count))
    middle = start + (end - start) * 0.5 * (1.0 - np.cos(np.pi * (np.arange(count) + 0.5) / count))
    return edges, middle, (middle - edges[:-1]) / np.diff(edges)


def to_cartesian(x: Array, radius: Array, theta: Array) -> Array:
    """Cylindrical coordinates, broadcast, as points (..., 3) in solver axes."""
    x, radius, theta = np.broadcast_arrays(x, radius, theta)
    return np.stack([x, radius * np.cos(theta), radius * np.sin(theta)], axis=-1)


def to_propeller_axes(points: Array) -> Array:
    """Solver axes to propeller axes (x downstream, y to starboard, z up): the same numbers with y and z swapped."""
    return points[..., [0, 2, 1]]


@dataclass(frozen=True)
class BladeGrid:
    """Panels of the key blade.

    Attributes:
        surface: the blade's panels and collocation points; its normals are those of the true sections at the strips'
            collocation radii, not of the panels: where the wrap of the blade changes along the radius, a bilinear
            panel has a wrong pitch in mid-strip (half a degree on ten strips, 4 % of KT).
        onset_points: (n, m, 3) points of the true surface, where the onset flow is taken.
        x, theta: (n + 1, m + 1) cylindrical corner coordinates.
        radius_edges: (m + 1,) r/R of the strips' edges; radius_middle: (m,) of the collocation points.
    """

    surface: StripSurface
    onset_points: Array
    x: Array
    theta: Array
    radius_edges: Array
    radius_middle: Array


def blade_grid(propeller: Propeller, chordwise_panels: int, radial_panels: int) -> BladeGrid:
    """The panels of the key blade.

    Args:
        propeller: the propeller.
        chordwise_panels: panels round a section (even).
        radial_panels: strips from hub to tip.
    """
    edges, middle, fraction = cosine_stations(propeller.hub_ratio, 1.0, radial_panels)
    sections = propeller.table.at(edges)
    chord = np.array(sections.chord_ratio)
    chord[-1] = float(propeller.table.at(np.array(TIP_CHORD_RADIUS)).chord_ratio)
    thickness = np.array(sections.thickness_ratio)
    thickness[-1] = 0.0
    sections = replace(sections, chord_ratio=chord, thickness_ratio=thickness)
    x, theta = _section_outline(sections, 1.0, chordwise_panels)
    surface = strip_surface(to_cartesian(x, edges[None, :], theta), fraction)
    thinning = np.ones(radial_panels)
    thinning[-1] = 1.0 - fraction[-1]
    step = 0.02 * np.diff(edges)
    outlines = []
    for shift in (-step, 0.0 * step, step):
        radius = middle + shift
        outline = _section_outline(propeller.table.at(radius), thinning, chordwise_panels)
        outlines.append(to_cartesian(outline[0], radius[None, :], outline[1]))
    inner, at, outer = outlines
    along_j = (outer[:-1] + outer[1:]) - (inner[:-1] + inner[1:])
    normal = np.cross(along_j, at[1:] - at[:-1])
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-300)
    surface = replace(surface, normal=normal)
    return BladeGrid(
        surface, 0.5 * (at[1:] + at[:-1]), np.ascontiguousarray(x), np.ascontiguousarray(theta), edges, middle
    )


def _section_outline(sections: BladeSections, thickness_factor: Array | float, panels: int) -> tuple[Array, Array]:
    """(x, theta), each (panels + 1, sections): from the trailing edge over the face to the nose and back."""
    fractions = cosine_chord_fractions(panels // 2 + 1)
    x_back, theta_back = blade_cylindrical(sections, fractions, True, thickness_factor)
    x_face, theta_face = blade_cylindrical(sections, fractions, False, thickness_factor)
    x = np.concatenate([x_face[:, ::-1], x_back[:, 1:]], axis=1).T
    theta = np.concatenate([theta_face[:, ::-1], theta_back[:, 1:]], axis=1).T
    return np.ascontiguousarray(x), np.ascontiguousarray(theta)


@dataclass(frozen=True)
class HubGrid:
    """One blade's sector of the hub, from this blade's face to the next blade's back.

    Attributes:
        corners: (na + 1, nt + 1, 3), i downstream, j along +theta, outward normals away from the axis.
        panels: its na nt panels.
        collocation, normal: (na nt, 3).
        blade_rows: rows of panels between the blades (first, last + 1).
    """

    corners: Array
    panels: PanelSet
    collocation: Array
    normal: Array
    blade_rows: tuple[int, int]


@dataclass(frozen=True)
class HubSettings:
    """How the hub is panelled; lengths in tip radii.

    Attributes:
        rows_cylinder: panels on the cylinder before and behind the root, each.
        rows_end: panels on each rounded end.
        panels_round: panels round the whole hub, shared by the blades (at least three a sector).
        cylinder_ahead, cylinder_behind, end_length: extent of the hub before, behind the root, and of its ends.
    """

    rows_cylinder: int = 3
    rows_end: int = 4
    panels_round: int = 18
    cylinder_ahead: float = 0.25
    cylinder_behind: float = 0.35
    end_length: float = 0.4


def _outline_chains(x: Array, theta: Array) -> tuple[Array, Array]:
    """Indices of the root outline's corners from the first to the last along the shaft: over the back, over the face.

    Raises:
        SolverFailure: the outline is not single valued along the shaft.
    """
    # corner 0 and the last one are the trailing edge: the outline is closed
    x, theta = x[:-1], theta[:-1]
    first, last = int(np.argmin(x)), int(np.argmax(x))
    up = np.arange(first, first + (last - first) % x.size + 1) % x.size
    down = np.arange(first, first - (first - last) % x.size - 1, -1) % x.size
    for chain in (up, down):
        if np.any(np.diff(x[chain]) <= 0.0):
            raise SolverFailure(STAGE, "the hub folds: the root section's outline turns back along the shaft")
    middle = 0.5 * (x[first] + x[last])
    back_first = np.interp(middle, x[up], theta[up]) <= np.interp(middle, x[down], theta[down])
    return (up, down) if back_first else (down, up)


def hub_grid(blade: BladeGrid, blade_count: int, settings: HubSettings, wake_pitch: float) -> HubGrid:
    """The sector of the hub that belongs to the key blade.

    Stations are planes x = constant through every corner of the root outline. So the panels cannot fold round the
    leading edge of the root (where both sides of the section turn back ahead of it), and hub and blade share their
    boundary exactly: a corner of one side lies opposite to a point on an edge of the other.

    Args:
        blade: the blade; its root outline bounds the sector.
        blade_count: Z.
        settings: resolution and extent.
        wake_pitch: P/R along which the sector's edges follow the wake behind the root.

    Raises:
        SolverFailure: the hub folds, or the roots of neighbouring blades overlap.
    """
    hub_radius = float(blade.radius_edges[0])
    root = blade.surface.corners[:, 0]
    back, face = _outline_chains(blade.x[:, 0], blade.theta[:, 0])
    between = np.sort(blade.x[:-1, 0])
    sector = 2.0 * np.pi / blade_count
    edges = []
    for chain in (face, back):
        y, z = (np.interp(between, root[chain, 0], root[chain, a]) for a in (1, 2))
        angle = np.interp(between, root[chain, 0], blade.theta[chain, 0])
        # the chord's own angle on the branch of theta
        angle = angle + np.angle((y + 1j * z) * np.exp(-1j * angle))
        edges.append((np.hypot(y, z), angle))
    (radius_start, theta_start), (radius_end, theta_end) = edges
    theta_end = theta_end + sector
    gap = float(np.min(theta_end - theta_start))
    if gap < 0.05 * sector:
        raise SolverFailure(
            STAGE,
            f"the roots of neighbouring blades meet on the hub: {gap:.3f} rad of the sector {sector:.3f} are free",
        )
    x_first, x_last = float(between[0]), float(between[-1])
    step = (x_last - x_first) / between.size
    ahead = x_first - _stretched(settings.cylinder_ahead, step, settings.rows_cylinder)
    behind = x_last + _stretched(settings.cylinder_behind, step, settings.rows_cylinder)
    quarter = 0.5 * np.pi * np.arange(1, settings.rows_end + 1) / settings.rows_end
    nose_x = ahead[-1] - settings.end_length * np.sin(quarter)
    tail_x = behind[-1] + settings.end_length * np.sin(quarter)
    end_radius = hub_radius * np.cos(quarter)
    end_radius[-1] = 0.0
    x = np.concatenate([nose_x[::-1], ahead[:0:-1], between, behind[1:], tail_x])
    ahead_radius = np.concatenate([end_radius[::-1], np.full(ahead.size - 1, hub_radius)])
    behind_radius = np.concatenate([np.full(behind.size - 1, hub_radius), end_radius])
    lead = nose_x.size + ahead.size - 1
    twist = -2.0 * np.pi * (np.concatenate([behind[1:], tail_x]) - x_last) / wake_pitch
    columns = max(3, round(settings.panels_round / blade_count))
    fraction = np.arange(columns + 1) / columns
    start = np.concatenate([np.full(lead, theta_start[0]), theta_start, theta_start[-1] + twist])
    end = np.concatenate([np.full(lead, theta_end[0]), theta_end, theta_end[-1] + twist])
    theta = start[:, None] + (end - start)[:, None] * fraction
    radius = np.concatenate([ahead_radius, np.full(between.size, hub_radius), behind_radius])
    radius = np.broadcast_to(radius[:, None], theta.shape).copy()
    radius[lead : lead + between.size, 0] = radius_start
    radius[lead : lead + between.size, -1] = radius_end
    # (d/dj) x (d/di) = theta^ x x^ = r^: outward
    corners = to_cartesian(x[:, None], radius, theta)
    collocation, normal = bilinear_points(corners, np.full(columns, 0.5))
    return HubGrid(
        corners,
        panel_set(grid_quadrilaterals(corners)),
        collocation.reshape(-1, 3),
        normal.reshape(-1, 3),
        (lead, lead + between.size - 1),
    )


def _stretched(length: float, first_step: float, count: int) -> Array:
    """Distances 0 .. length in `count` steps that grow geometrically from about `first_step`."""
    low, high = 0.2, 10.0
    for _ in range(60):
        ratio = np.sqrt(low * high)
        total = first_step * float(np.sum(ratio ** np.arange(count)))
        low, high = (ratio, high) if total < length else (low, ratio)
    steps = np.sqrt(low * high) ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps) * length])


@dataclass(frozen=True)
class WakeSettings:
    """The helical wake: `revolutions` turns, steps of `first_step_degrees` that grow by `growth` each.

    A first step of 10 degrees would give KT 1.3 % too low, an end after two turns 0.6 % too high.
    """

    revolutions: float = 3.0
    first_step_degrees: float = 4.0
    growth: float = 1.08


def wake_angles(settings: WakeSettings) -> Array:
    """Angles of the wake's cross lines behind the trailing edge, radians, from 0."""
    total = np.radians(360.0 * settings.revolutions)
    first = np.radians(settings.first_step_degrees)
    count = int(np.ceil(np.log1p(total * (settings.growth - 1.0) / first) / np.log(settings.growth)))
    steps = settings.growth ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps) * total])


def helical_wake(blade: BladeGrid, pitch: Array, settings: WakeSettings) -> tuple[PanelSet, Array]:
    """Wake panels behind the trailing edge and the strip of each.

    Args:
        blade: the blade.
        pitch: (m + 1,) P/R of the helix that leaves each strip edge at constant radius.
        settings: length and resolution.
    """
    psi = wake_angles(settings)
    # Straight steps would cut inside their helix: the corners move out so that the mean radius is kept.
    excess = (0.5 * np.diff(psi)) ** 2 / 6.0
    widening = np.ones(psi.size)
    widening[1:-1] += 0.5 * (excess[1:] + excess[:-1])
    widening[-1] += excess[-1]
    x = blade.x[0][None, :] + psi[:, None] * pitch[None, :] / (2.0 * np.pi)
    theta = blade.theta[0][None, :] - psi[:, None]
    corners = to_cartesian(x, blade.radius_edges[None, :] * widening[:, None], theta)
    strips = blade.radius_middle.size
    return panel_set(grid_quadrilaterals(corners)), np.tile(np.arange(strips), psi.size - 1)
