"""The horseshoe vortices of the lifting line: where they lie and what they induce.

Lengths in tip radii, circulation 1. Axes and theta as in geometry/propeller/surface.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.radial_table import BladeSections
from hpsop_core.geometry.propeller.surface import cylinder_points, to_cartesian
from hpsop_core.hydro.lifting_line.chord_surface import ChordPoints, chord_points
from hpsop_core.hydro.singularities.vortices import helix_tail_velocity, polyline_normal_velocity, wrench_velocities
from hpsop_core.typing_aliases import Array, IntArray

_CHORD_SEGMENTS = 12
_WAKE_SEGMENTS = 40
_FIRST_WAKE_STEP = 0.05
_WAKE_STEP_GROWTH = 1.08


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
        chordwise: bound vortices on each strip, N; each stands at the quarter of its share of the chord.
        leg_x, leg_theta: trailing vortices on the blade, from each bound vortex to the trailing edge, (N, M + 1, n).
        control_fraction: fractions of the chord of the control points, the three quarters of the shares, (N,).
        control: control points, strip by strip.
    """

    blade_count: int
    hub_ratio: float
    edges: Array
    radii: Array
    sections: BladeSections
    reference_advance: float
    chordwise: int
    leg_x: Array
    leg_theta: Array
    control_fraction: Array
    control: ChordPoints

    @staticmethod
    def make(propeller: Propeller, strips: int, chordwise: int) -> HorseshoeGrid:
        """Half-cosine strips, dense at the tip; the hub is a plane of symmetry of the load, more or less."""
        hub = propeller.hub_ratio
        edges = hub + (1.0 - hub) * np.sin(0.5 * np.pi * np.arange(strips + 1) / strips)
        edges[-1] = 1.0
        radii = hub + (1.0 - hub) * np.sin(0.5 * np.pi * (np.arange(strips) + 0.5) / strips)
        at_edges, sections = propeller.table.at(edges), propeller.table.at(radii)
        # A tip leg of no chord would leave the blade beside the last control point instead of behind it.
        edge_chord = 2.0 * np.maximum(at_edges.chord_ratio, sections.chord_ratio[-1])
        start = (np.arange(chordwise)[:, None] + 0.25) / chordwise
        fraction = start + (1.0 - start) * np.linspace(0.0, 1.0, _CHORD_SEGMENTS + 1)
        along = edge_chord[:, None] * (fraction[:, None, :] - 0.5)
        leg_x, leg_theta = cylinder_points(
            edges[:, None],
            at_edges.pitch_angle[:, None],
            at_edges.skew[:, None],
            at_edges.rake_ratio[:, None],
            along,
            np.zeros_like(along),
        )
        control_fraction = (np.arange(chordwise) + 0.75) / chordwise
        return HorseshoeGrid(
            blade_count=propeller.blade_count,
            hub_ratio=hub,
            edges=edges,
            radii=radii,
            sections=sections,
            reference_advance=propeller.pitch_diameter_ratio_07R / np.pi,
            chordwise=chordwise,
            leg_x=leg_x,
            leg_theta=leg_theta,
            control_fraction=control_fraction,
            control=chord_points(propeller, radii, control_fraction),
        )

    @property
    def image_edges(self) -> Array:
        """Radii of the hub's image vortices, r_h^2/r, of opposite circulation and the same axial pitch."""
        return np.asarray(self.hub_ratio**2 / self.edges)


def normal_influence(grid: HorseshoeGrid, wake_advance: Array) -> Array:
    """Normal velocity at the control points of horseshoes of circulation 1 on all blades.

    Args:
        grid: the horseshoes.
        wake_advance: r tan(beta_i) of the wake, (K,).

    Returns:
        (K, M N, M N): control point, then horseshoe, each strip by strip; normal as in ``ChordPoints``.
    """
    control, normals = grid.control.points, grid.control.normals
    chordwise, count = grid.chordwise, normals.shape[0]
    influence = np.zeros((wake_advance.size, count, count))
    influence += _on_blade(grid, control, normals)
    wakes = _Wakes.make(grid)
    for node, advance in enumerate(wake_advance):
        legs = wakes.normal_velocity(grid, float(advance), control, normals)
        tail_axial, tail_tangential = wakes.tail(grid, float(advance))
        legs += tail_axial * grid.control.axial + tail_tangential * grid.control.tangential
        influence[node] += np.repeat((legs[1:] - legs[:-1]).T, chordwise, axis=1)
    return influence


@dataclass(frozen=True, eq=False)
class _Wakes:
    """Points of all wake legs and their images on the unit wake: x = x0 + advance * angle."""

    start_x: Array
    angle: Array
    radius: Array
    theta: Array
    first: IntArray
    last_angle: float

    @staticmethod
    def make(grid: HorseshoeGrid) -> _Wakes:
        growth = _WAKE_STEP_GROWTH
        angles = _FIRST_WAKE_STEP * (growth ** np.arange(_WAKE_SEGMENTS + 1) - 1.0) / (growth - 1.0)
        blades = np.arange(grid.blade_count)
        # Far legs need fewer points: every second on the other blades, every fourth on the images in the hub.
        groups = ((grid.edges, blades[:1], 1), (grid.edges, blades[1:], 2), (grid.image_edges, blades, 4))
        start_x, angle, radius, theta, lengths = [], [], [], [], []
        for radii, turned, stride in groups:
            some = angles[::stride]
            shape = (turned.size, radii.size, some.size)
            turn = 2.0 * np.pi * turned / grid.blade_count
            # A polygon encloses less than its circle; with its corners moved out it induces far away what the helix
            # does.
            step = np.concatenate([[some[1] - some[0]], 0.5 * (some[2:] - some[:-2]), [some[-1] - some[-2]]])
            outward = np.sqrt(step / np.sin(np.minimum(step, 1.5)))
            start_x.append(np.broadcast_to(grid.leg_x[0, :, -1:], shape).ravel())
            angle.append(np.broadcast_to(some, shape).ravel())
            radius.append(np.broadcast_to(radii[:, None] * outward, shape).ravel())
            theta.append((grid.leg_theta[0, :, -1:] + turn[:, None, None] - some).ravel())
            lengths += [some.size] * (turned.size * radii.size)
        first = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64)
        return _Wakes(
            start_x=np.concatenate(start_x),
            angle=np.concatenate(angle),
            radius=np.concatenate(radius),
            theta=np.concatenate(theta),
            first=first,
            last_angle=float(angles[-1]),
        )

    def normal_velocity(self, grid: HorseshoeGrid, advance: float, control: Array, normals: Array) -> Array:
        """Normal velocity of the wake legs of all blades less their images, (M + 1, M N)."""
        points = to_cartesian(self.start_x + advance * self.angle, self.radius, self.theta)
        velocity = polyline_normal_velocity(points, self.first, control, normals)
        legs = velocity.reshape(2, grid.blade_count, grid.edges.size, -1).sum(axis=1)
        return np.asarray(legs[0] - legs[1])

    def tail(self, grid: HorseshoeGrid, advance: float) -> tuple[Array, Array]:
        """Axial and tangential velocity of what follows the last point of legs less images, two (M + 1, M N)."""
        distance = grid.leg_x[0, :, -1:] + advance * self.last_angle - grid.control.x.ravel()
        step, radii = np.array(advance), np.repeat(grid.radii, grid.chordwise)
        real = helix_tail_velocity(radii, grid.edges[:, None], distance, step, grid.blade_count)
        image = helix_tail_velocity(radii, grid.image_edges[:, None], distance, step, grid.blade_count)
        return real[0] - image[0], real[1] - image[1]


def _on_blade(grid: HorseshoeGrid, control: Array, normals: Array) -> Array:
    """What does not depend on the wake: bound vortices and legs along the chords, with images; (M N, M N)."""
    blades, chordwise, rows, strips = grid.blade_count, grid.chordwise, grid.edges.size, grid.radii.size
    turn = 2.0 * np.pi * np.arange(blades)[:, None, None, None] / blades
    # Far legs need fewer points; (blades, N, M + 1, n, 3) each: the key blade, the other blades, images on all.
    polylines = [
        to_cartesian(grid.leg_x[..., ::stride], radii[:, None], grid.leg_theta[..., ::stride] + turned)
        for radii, turned, stride in (
            (grid.edges, turn[:1], 1),
            (grid.edges, turn[1:], 2),
            (grid.image_edges, turn, 4),
        )
    ]
    points = np.concatenate([part.reshape(-1, 3) for part in polylines])
    lengths = np.concatenate([np.full(part.size // (3 * part.shape[-2]), part.shape[-2]) for part in polylines])
    first = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64)
    along = polyline_normal_velocity(points, first, control, normals)
    along = along.reshape(2, blades, chordwise, rows, -1).sum(axis=1)
    along = along[0] - along[1]
    # Bound vortices from edge to edge outwards; an image from the inside out is the opposite of this order.
    starts = [part[..., 0, :] for part in polylines]
    start = np.stack([np.concatenate(starts[:2]), starts[2]])
    outward = np.stack([start[..., :-1, :], start[..., 1:, :]], axis=-2)
    first = np.arange(2 * blades * chordwise * strips, dtype=np.int64) * 2
    bound = polyline_normal_velocity(outward.reshape(-1, 3), first, control, normals)
    bound = bound.reshape(2, blades, chordwise, strips, -1).sum(axis=1)
    # (N, M, control points) to (control points, M N)
    horseshoes = along[:, 1:] - along[:, :-1] + bound[0] - bound[1]
    return np.asarray(horseshoes.transpose(2, 1, 0).reshape(-1, strips * chordwise))


def induced_at_lifting_line(grid: HorseshoeGrid, wake_advance: Array) -> tuple[Array, Array]:
    """Axial and tangential velocity at the strips' lifting line of horseshoes of circulation 1: two (K, M, M).

    The lifting line is taken as straight and radial: skew and rake enter through the flow tangency only.
    """
    advance = wake_advance[:, None, None]
    axial, tangential = wrench_velocities(grid.radii[:, None], grid.edges, advance, grid.blade_count)
    axial_image, tangential_image = wrench_velocities(grid.radii[:, None], grid.image_edges, advance, grid.blade_count)
    axial, tangential = axial - axial_image, tangential - tangential_image
    return axial[..., 1:] - axial[..., :-1], tangential[..., :-1] - tangential[..., 1:]
