"""The horseshoe vortices of the lifting line: where they lie and what they induce.

Lengths in tip radii, circulation 1. Axes and theta as in geometry/propeller_surface.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller import Propeller
from hpsop_core.geometry.propeller_surface import cylinder_points, rotate_blade, to_cartesian
from hpsop_core.geometry.radial_table import BladeSections
from hpsop_core.hydro.helical_vortices import helix_tail_velocity, polyline_normal_velocity, wrench_velocities
from hpsop_core.typing_aliases import Array

_CHORD_SEGMENTS = 8
_WAKE_SEGMENTS = 32
_FIRST_WAKE_STEP = 0.07
_WAKE_STEP_GROWTH = 1.10


@dataclass(frozen=True, eq=False)
class HorseshoeGrid:
    """Horseshoes of the key blade.

    Attributes:
        blade_count: Z.
        hub_ratio: hub radius.
        edges: radii of the trailing vortices, hub to tip, (M + 1,).
        radii: radii of the strips, (M,).
        sections: sections at ``radii``.
        reference_advance: advance a radian of a wake at the geometric pitch of 0.7 R.
        leg_x, leg_theta: trailing vortices on the blade, quarter chord to trailing edge, (M + 1, n).
        control_x, control_theta: three-quarter-chord points, (M,).
    """

    blade_count: int
    hub_ratio: float
    edges: Array
    radii: Array
    sections: BladeSections
    reference_advance: float
    leg_x: Array
    leg_theta: Array
    control_x: Array
    control_theta: Array

    @staticmethod
    def make(propeller: Propeller, strips: int) -> HorseshoeGrid:
        """Half-cosine strips, dense at the tip; the hub is a plane of symmetry of the load, more or less."""
        hub = propeller.hub_ratio
        edges = hub + (1.0 - hub) * np.sin(0.5 * np.pi * np.arange(strips + 1) / strips)
        edges[-1] = 1.0
        radii = hub + (1.0 - hub) * np.sin(0.5 * np.pi * (np.arange(strips) + 0.5) / strips)
        at_edges, sections = propeller.table.at(edges), propeller.table.at(radii)
        # A tip leg of no chord would leave the blade beside the last control point instead of behind it.
        edge_chord = 2.0 * np.maximum(at_edges.chord_ratio, sections.chord_ratio[-1])
        along = edge_chord[:, None] * (-0.25 + 0.75 * np.linspace(0.0, 1.0, _CHORD_SEGMENTS + 1))
        leg_x, leg_theta = cylinder_points(
            edges[:, None],
            at_edges.pitch_angle[:, None],
            at_edges.skew[:, None],
            at_edges.rake_ratio[:, None],
            along,
            np.zeros_like(along),
        )
        control_x, control_theta = cylinder_points(
            radii,
            sections.pitch_angle,
            sections.skew,
            sections.rake_ratio,
            0.5 * sections.chord_ratio,
            np.zeros_like(radii),
        )
        return HorseshoeGrid(
            blade_count=propeller.blade_count,
            hub_ratio=hub,
            edges=edges,
            radii=radii,
            sections=sections,
            reference_advance=propeller.pitch_diameter_ratio_07R / np.pi,
            leg_x=leg_x,
            leg_theta=leg_theta,
            control_x=control_x,
            control_theta=control_theta,
        )

    @property
    def image_edges(self) -> Array:
        """Radii of the hub's image vortices, r_h^2/r, of opposite circulation and the same axial pitch."""
        return np.asarray(self.hub_ratio**2 / self.edges)


def normal_influence(grid: HorseshoeGrid, wake_advance: Array) -> Array:
    """Normal velocity at the three-quarter-chord points of horseshoes of circulation 1 on all blades.

    Args:
        grid: the horseshoes.
        wake_advance: r tan(beta_i) of the wake, (K,).

    Returns:
        (K, M, M): control point, then horseshoe; normal towards the suction side.
    """
    control = to_cartesian(grid.control_x, grid.radii, grid.control_theta)
    pitch = grid.sections.pitch_angle
    axial, tangential = -np.cos(pitch), -np.sin(pitch)
    normals = np.stack(
        [axial, tangential * np.cos(grid.control_theta), -tangential * np.sin(grid.control_theta)], axis=-1
    )
    radius = np.concatenate([grid.edges, grid.image_edges])
    fixed = _legs(grid, radius, grid.leg_x, grid.leg_theta)
    angles = _FIRST_WAKE_STEP * (_WAKE_STEP_GROWTH ** np.arange(_WAKE_SEGMENTS + 1) - 1.0) / (_WAKE_STEP_GROWTH - 1.0)
    wake_x = grid.leg_x[:, -1:] + wake_advance[:, None, None] * angles
    wake_theta = grid.leg_theta[:, -1:] - angles
    wake = _legs(grid, radius, wake_x, np.broadcast_to(wake_theta, wake_x.shape))
    legs = polyline_normal_velocity(wake, control, normals).sum(axis=-3)
    legs += polyline_normal_velocity(fixed, control, normals).sum(axis=-3)
    distance = np.concatenate([wake_x[..., -1], wake_x[..., -1]], axis=-1)[..., None] - grid.control_x
    tail_axial, tail_tangential = helix_tail_velocity(
        grid.radii, radius[:, None], distance, wake_advance[:, None, None], grid.blade_count
    )
    legs += tail_axial * axial + tail_tangential * tangential
    count = grid.edges.size
    legs = legs[:, :count] - legs[:, count:]
    return np.swapaxes(legs[:, 1:] - legs[:, :-1] + _bound(grid, radius, control, normals), -1, -2)


def _legs(grid: HorseshoeGrid, radius: Array, x: Array, theta: Array) -> Array:
    """Legs and their images on all blades as polylines, (..., Z, 2 (M + 1), n, 3)."""
    turn = 2.0 * np.pi * np.arange(grid.blade_count) / grid.blade_count
    x = np.concatenate([x, x], axis=-2)[..., None, :, :]
    theta = np.concatenate([theta, theta], axis=-2)[..., None, :, :] + turn[:, None, None]
    return to_cartesian(x, radius[:, None], theta)


def _bound(grid: HorseshoeGrid, radius: Array, control: Array, normals: Array) -> Array:
    """Bound vortices and their images on all blades, (M, M): horseshoe, then control point."""
    count = grid.edges.size
    start = to_cartesian(grid.leg_x[:, 0], grid.edges, grid.leg_theta[:, 0])
    image = to_cartesian(grid.leg_x[:, 0], radius[count:], grid.leg_theta[:, 0])
    segments = np.stack([np.stack([start[:-1], start[1:]], axis=1), np.stack([image[1:], image[:-1]], axis=1)])
    turned = np.stack([rotate_blade(segments, blade, grid.blade_count) for blade in range(grid.blade_count)])
    return np.asarray(polyline_normal_velocity(turned, control, normals).sum(axis=(0, 1)))


def induced_at_lifting_line(grid: HorseshoeGrid, wake_advance: Array) -> tuple[Array, Array]:
    """Axial and tangential velocity at the strips' lifting line of horseshoes of circulation 1: two (K, M, M).

    The lifting line is taken as straight and radial: skew and rake enter through the flow tangency only.
    """
    advance = wake_advance[:, None, None]
    axial, tangential = wrench_velocities(grid.radii[:, None], grid.edges, advance, grid.blade_count)
    axial_image, tangential_image = wrench_velocities(grid.radii[:, None], grid.image_edges, advance, grid.blade_count)
    axial, tangential = axial - axial_image, tangential - tangential_image
    return axial[..., 1:] - axial[..., :-1], tangential[..., :-1] - tangential[..., 1:]
