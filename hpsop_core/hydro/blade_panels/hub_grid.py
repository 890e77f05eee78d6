"""Panels on one blade's sector of the hub, in four blocks that share their edges with the root section.

The sector reaches from the face of the key blade (j = 0) to the back of the next one. In the cylinder's (x, theta)
plane a helix half way between the blades parts it: from every corner of the root outline a line of panels runs to that
helix, from the face in one block, from the back in the other. Seen along the shaft the root's round leading edge turns
back, so lines of constant x or lines to the opposite corner of the next blade would fold there; these lines lean
forward and cannot. The blocks meet on the helix with different corners, which opens slits of 1e-4 R at most. Ahead of
and behind the blades two more blocks carry the cylinder and the rounded ends; behind, they follow the wake.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.blade_panels.grid import STAGE, BladeGrid, bilinear_points, grid_quadrilaterals, to_cartesian
from hpsop_core.hydro.blade_panels.settings import HubSettings
from hpsop_core.hydro.singularities.dipole_panels import PanelSet, panel_set
from hpsop_core.typing_aliases import Array, IntArray


@dataclass(frozen=True)
class HubGrid:
    """One blade's sector of the hub.

    Attributes:
        blocks: corner grids (n + 1, m + 1, 3), i downstream, j along +theta, outward normals away from the axis.
        panels: the panels of all blocks, one block after the other.
        collocation, normal: (n, 3).
    """

    blocks: tuple[Array, ...]
    panels: PanelSet
    collocation: Array
    normal: Array

    @property
    def block_slices(self) -> tuple[slice, ...]:
        """Where the panels of each block lie in ``panels``."""
        ends = np.cumsum([0] + [(b.shape[0] - 1) * (b.shape[1] - 1) for b in self.blocks])
        return tuple(slice(int(a), int(b)) for a, b in itertools.pairwise(ends))


def hub_grid(blade: BladeGrid, blade_count: int, settings: HubSettings, wake_pitch: float) -> HubGrid:
    """The sector of the hub that belongs to the key blade.

    Args:
        blade: the blade; its root outline bounds the sector.
        blade_count: Z.
        settings: resolution and extent.
        wake_pitch: P/R along which the sector's edges follow the wake behind the root.

    Raises:
        SolverFailure: the roots of neighbouring blades meet, or the hub folds.
    """
    radius = float(blade.radius_edges[0])
    sector = 2.0 * np.pi / blade_count
    # corners 0 and n are the trailing edge, n/2 the leading edge
    x, theta = blade.x[:, 0], blade.theta[:, 0]
    count = x.size // 2
    face, back = np.arange(count, -1, -1), np.arange(count, x.size)
    x_first, x_last = float(x[count]), float(x[0])
    length, turn = x_last - x_first, float(theta[0] - theta[count])
    if length <= 0.0 or turn >= 0.0:
        raise SolverFailure(STAGE, "the hub folds: the root section does not run downstream against the rotation")
    gap, room = _gap_to_the_next(x, radius * theta, radius * sector)
    if gap < 0.02 * room:
        raise SolverFailure(
            STAGE,
            f"the roots of neighbouring blades meet on the hub: their chords are {room:.3f} R apart, of which "
            f"{max(gap, 0.0):.3f} R are free",
        )
    # Half way round, the helix through both edges of the root section, turned by half a sector.
    slope = turn / length
    # Square to the chord an edge reaches the helix sin(phi) cos(phi) times half a sector ahead of (aft of) where it
    # would lie on the helix itself.
    chord = np.hypot(length, radius * turn)
    lean = settings.lean * (radius * 0.5 * sector) * length * (radius * -turn) / chord**2
    columns = max(2, round(settings.panels_round / blade_count / 2))
    fraction = np.arange(columns + 1) / columns

    def block(chain: IntArray, from_face: bool) -> tuple[Array, Array]:
        turned = theta[chain] + (0.0 if from_face else sector)
        arc = np.hypot(np.diff(x[chain]), radius * np.diff(turned))
        place = np.concatenate([[0.0], np.cumsum(arc)]) / np.sum(arc)
        middle_x = x_first - lean + place * (length + 2.0 * lean)
        middle_theta = theta[count] + slope * (middle_x - x_first) + 0.5 * sector
        share = fraction if from_face else 1.0 - fraction
        block_x = x[chain][:, None] + (middle_x - x[chain])[:, None] * share
        block_theta = turned[:, None] + (middle_theta - turned)[:, None] * share
        return block_x, block_theta

    face_x, face_theta = block(face, True)
    back_x, back_theta = block(back, False)
    for block_x, block_theta in ((face_x, face_theta), (back_x, back_theta)):
        if np.any(_plane_areas(block_x, radius * block_theta) <= 0.0):
            raise SolverFailure(STAGE, "the hub folds at the root section: a panel turns over")
    step = length / count
    cylinder_ahead, cylinder_behind = settings.cylinder_ahead + lean, settings.cylinder_behind + lean
    ahead = _stretched(cylinder_ahead, step, settings.rows_cylinder)[:0:-1, None]
    behind = _stretched(cylinder_behind, step, settings.rows_cylinder)[1:, None]
    quarter = 0.5 * np.pi * np.arange(1, settings.rows_end + 1)[:, None] / settings.rows_end
    end_radius = radius * np.cos(quarter)
    end_radius[-1] = 0.0
    ring_x = np.concatenate([face_x[[0, -1]], back_x[[0, -1]][:, 1:]], axis=1)
    ring_theta = np.concatenate([face_theta[[0, -1]], back_theta[[0, -1]][:, 1:]], axis=1)
    nose = x_first - cylinder_ahead - settings.end_length * np.sin(quarter)[::-1]
    tail = x_last + cylinder_behind + settings.end_length * np.sin(quarter)
    # The rings next to the root are bent like its lines; the bend dies out along the cylinder.
    ahead_x = x_first - ahead + (1.0 - ahead / cylinder_ahead) * (ring_x[0] - x_first)
    behind_x = x_last + behind + (1.0 - behind / cylinder_behind) * (ring_x[1] - x_last)
    round_ring = np.ones_like(ring_x[0])
    front_x = np.concatenate([nose * round_ring, ahead_x, ring_x[:1]])
    rear_x = np.concatenate([ring_x[1:], behind_x, tail * round_ring])
    front_radius = np.concatenate([end_radius[::-1], np.full((ahead.size + 1, 1), radius)])
    rear_radius = np.concatenate([np.full((behind.size + 1, 1), radius), end_radius])
    front_theta = np.broadcast_to(ring_theta[0], front_x.shape)
    rear_theta = ring_theta[1] - 2.0 * np.pi * (rear_x - ring_x[1]) / wake_pitch
    # (d/dj) x (d/di) = theta^ x x^ = r^: outward
    blocks = (
        to_cartesian(front_x, front_radius, front_theta),
        to_cartesian(face_x, np.array(radius), face_theta),
        to_cartesian(back_x, np.array(radius), back_theta),
        to_cartesian(rear_x, rear_radius, rear_theta),
    )
    points = [bilinear_points(b, np.full(b.shape[1] - 1, 0.5)) for b in blocks]
    return HubGrid(
        blocks,
        panel_set(np.concatenate([grid_quadrilaterals(b) for b in blocks])),
        np.concatenate([p[0].reshape(-1, 3) for p in points]),
        np.concatenate([p[1].reshape(-1, 3) for p in points]),
    )


def _gap_to_the_next(x: Array, along: Array, distance: float) -> tuple[float, float]:
    """Least gap across the chord between a root outline and the next one, and the distance of their chords.

    Args:
        x, along: the outline in the cylinder's plane, from the trailing edge over the face to the leading edge and
            back; `along` is r theta.
        distance: from one blade to the next along r theta.

    Returns:
        gap (endless where the roots do not stand side by side), distance of the chords.
    """
    count = x.size // 2
    chord = np.array([x[0] - x[count], along[0] - along[count]])
    chord /= np.hypot(*chord)
    aft, across = chord[0] * x + chord[1] * along, -chord[1] * x + chord[0] * along
    face, back = slice(count, None, -1), slice(count, None)
    room = float(chord[0] * distance)
    next_aft = aft[back] + chord[1] * distance
    low, high = max(aft[count], next_aft[0]), min(aft[0], next_aft[-1])
    if low >= high:
        return np.inf, room
    place = np.linspace(low, high, 101)
    gap = np.interp(place, next_aft, across[back]) + room - np.interp(place, aft[face], across[face])
    return float(np.min(gap)), room


def _plane_areas(x: Array, y: Array) -> Array:
    """Signed areas of the cells of a corner grid in the plane, positive where (d/di, d/dj) turns counter-clockwise."""
    ax, ay = x[1:, 1:] - x[:-1, :-1], y[1:, 1:] - y[:-1, :-1]
    bx, by = x[:-1, 1:] - x[1:, :-1], y[:-1, 1:] - y[1:, :-1]
    return np.asarray(0.5 * (ax * by - ay * bx))


def _stretched(length: float, first_step: float, count: int) -> Array:
    """Distances 0 .. length in `count` steps that grow geometrically from about `first_step`."""
    low, high = 0.2, 10.0
    for _ in range(60):
        ratio = np.sqrt(low * high)
        total = first_step * float(np.sum(ratio ** np.arange(count)))
        low, high = (ratio, high) if total < length else (low, ratio)
    steps = np.sqrt(low * high) ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps) / np.sum(steps) * length])
