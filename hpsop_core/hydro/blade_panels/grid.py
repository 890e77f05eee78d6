"""Panels on one propeller blade and its wake.

Solver axes: lengths in tip radii (R = 1), x downstream, a point at (r, theta) is (x, r cos theta, r sin theta) with
theta in the sense of rotation. They mirror the propeller axes of `geometry.propeller.surface` (y and z are swapped);
`to_propeller_axes` goes back.

Blade: corners[i, j], i from the trailing edge along the face (pressure side) to the leading edge and back along the
back (suction side), j from the hub to the tip; both spacings are cosines. Collocation points lie half way in i and, in
j, at the cosine mid-point of the strip (the quadrature point of an elliptic loading; the centroid would give KT 5 %
too high on ten strips). All are points of the blade's one surface, its edges closed
(`geometry.propeller.closed`). The tip is an edge of finite chord and no thickness: a tip of no chord would make the
sections of wide blades cut each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.geometry.propeller.closed import closed_sections
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.blade_panels.settings import WakeSettings
from hpsop_core.hydro.singularities.dipole_panels import PanelSet, panel_set
from hpsop_core.typing_aliases import Array, IntArray

STAGE = "blade_panels"
TIP_CHORD_RADIUS = 0.995
"""The tip edge has the chord that the blade has at this r/R."""


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
    strips = radial_panels
    edges, middle, fraction = cosine_stations(propeller.hub_ratio, 1.0, strips)
    step = 0.02 * np.diff(edges)
    # corners, the section whose chord the tip gets, and three sections a strip for its normals
    sections = closed_sections(
        propeller,
        np.concatenate([edges, [TIP_CHORD_RADIUS], middle - step, middle, middle + step]),
        chordwise_panels // 2,
    )
    # the last strip thins out to nothing at the tip
    thinning = np.ones(strips)
    thinning[-1] = 1.0 - fraction[-1]
    thickness = np.concatenate([np.ones(strips), [0.0, 1.0], np.tile(thinning, 3)])
    chord_factor = np.ones(thickness.size)
    chord_factor[strips] = sections.chord[strips + 1] / sections.chord[strips]
    x, theta = (np.ascontiguousarray(part.T) for part in sections.outlines(thickness, chord_factor))
    points = to_cartesian(x, sections.radius_ratio[None, :], theta)
    surface = strip_surface(points[:, : strips + 1], fraction)
    inner, at, outer = np.split(points[:, strips + 2 :], 3, axis=1)
    along_j = (outer[:-1] + outer[1:]) - (inner[:-1] + inner[1:])
    normal = np.cross(along_j, at[1:] - at[:-1])
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-300)
    surface = replace(surface, normal=normal)
    corner_x, corner_theta = (np.ascontiguousarray(part[:, : strips + 1]) for part in (x, theta))
    return BladeGrid(surface, 0.5 * (at[1:] + at[:-1]), corner_x, corner_theta, edges, middle)


def wake_angles(settings: WakeSettings) -> Array:
    """Angles of the wake's cross lines behind the trailing edge, radians, from 0."""
    total = np.radians(360.0 * settings.revolutions)
    first = np.radians(settings.first_step_degrees)
    count = int(np.ceil(np.log1p(total * (settings.growth - 1.0) / first) / np.log(settings.growth)))
    steps = settings.growth ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps) * total])


def helical_wake(blade: BladeGrid, pitch: Array, settings: WakeSettings) -> tuple[PanelSet, IntArray]:
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
