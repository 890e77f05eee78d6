"""Forces of the blades from the strips' circulations (Kutta-Joukowski) and from the pressures, with section drag.

Lengths in tip radii, time in revolutions (n = 1), rho = 1: V = 2 J, omega = 2 pi, KT = T/16, KQ = Q/32.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import IDEAL_ANGLE_PER_CAMBER
from hpsop_core.hydro.blade_panels.grid import BladeGrid
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.hydro.singularities.vortices import wrench_velocities
from hpsop_core.typing_aliases import Array

OMEGA = 2.0 * np.pi


@dataclass(frozen=True)
class StripData:
    """What the force formulas need of each strip; all (m,).

    Attributes:
        radius: r/R of the control points; width: of the strips.
        chord: c/R; thickness_ratio: t/c.
        pitch_angle: geometric, and ideal_angle: of the mean line at shock-free entry, radians.
        edges: (m + 1,) r/R.
        blade_count: Z.
        diameter: D in m, for the Reynolds or roughness number of the sections.
    """

    radius: Array
    width: Array
    chord: Array
    thickness_ratio: Array
    pitch_angle: Array
    ideal_angle: Array
    edges: Array
    blade_count: int
    diameter: float

    @classmethod
    def of(cls, propeller: Propeller, grid: BladeGrid) -> StripData:
        sections = propeller.table.at(grid.radius_middle)
        return cls(
            grid.radius_middle,
            np.diff(grid.radius_edges),
            2.0 * sections.chord_ratio,
            sections.thickness_ratio,
            sections.pitch_angle,
            IDEAL_ANGLE_PER_CAMBER * sections.camber_ratio,
            grid.radius_edges,
            propeller.blade_count,
            propeller.diameter,
        )


def induction_matrices(strips: StripData, wake_pitch: Array) -> tuple[Array, Array]:
    """Axial and tangential velocity at each strip's lifting line of unit circulations, each (m, m).

    Trailing vortices leave the strip edges as helices of pitch `wake_pitch` (m + 1,) P/R (Wrench's closed form); each
    has an image of opposite sign at r_hub^2/r, of the same axial pitch, so that the hub sheds no root vortex.
    """
    control = strips.radius[:, None]
    hub = strips.edges[0]
    advance = wake_pitch[None, :] / OMEGA
    axial, swirl = wrench_velocities(control, strips.edges[None, :], advance, strips.blade_count)
    image_axial, image_swirl = wrench_velocities(control, hub**2 / strips.edges[None, :], advance, strips.blade_count)
    axial, swirl = axial - image_axial, swirl - image_swirl
    return axial[:, 1:] - axial[:, :-1], swirl[:, :-1] - swirl[:, 1:]


@dataclass(frozen=True)
class LocalFlow:
    """Velocities at the strips' lifting lines: axial V + ua, against the rotation omega r - ut; (m,) each."""

    axial: Array
    tangential: Array

    @property
    def speed(self) -> Array:
        return np.hypot(self.axial, self.tangential)


def local_flow(strips: StripData, circulation: Array, advance: float, matrices: tuple[Array, Array]) -> LocalFlow:
    """The flow at the strips for circulations (m,) and V = `advance` (2 J)."""
    return LocalFlow(advance + matrices[0] @ circulation, OMEGA * strips.radius - matrices[1] @ circulation)


def circulation_forces(strips: StripData, circulation: Array, flow: LocalFlow) -> tuple[float, float]:
    """(KT, KQ) without drag: dT = Z G (omega r - ut) dr, dQ = Z G (V + ua) r dr."""
    thrust = strips.blade_count * float(np.sum(circulation * flow.tangential * strips.width))
    torque = strips.blade_count * float(np.sum(circulation * flow.axial * strips.radius * strips.width))
    return thrust / 16.0, torque / 32.0


def drag_forces(strips: StripData, flow: LocalFlow, advance: float, drag: SectionDrag) -> tuple[float, float]:
    """What section drag adds to (KT, KQ)."""
    if not drag.viscous:
        return 0.0, 0.0
    speed = flow.speed
    excess = 2.0 * np.pi * (strips.pitch_angle - np.arctan2(flow.axial, flow.tangential) - strips.ideal_angle)
    ideal = drag.ideal_coefficient(
        strips.diameter,
        0.5 * strips.chord,
        strips.thickness_ratio,
        np.sqrt((0.5 * advance) ** 2 + (np.pi * strips.radius) ** 2),
    )
    coefficient = drag.coefficient(ideal, excess)
    force = 0.5 * strips.blade_count * speed * strips.chord * coefficient * strips.width
    thrust = -float(np.sum(force * flow.axial))
    torque = float(np.sum(force * flow.tangential * strips.radius))
    return thrust / 16.0, torque / 32.0


def pressure_forces(pressure: Array, area_vector: Array, points: Array, blade_count: int) -> tuple[float, float]:
    """(KT, KQ) of pressures (over rho) on panels with outward area vectors (n, 3) at points (n, 3)."""
    force = -pressure[:, None] * area_vector
    thrust = -blade_count * float(np.sum(force[:, 0]))
    # theta turns from y to z in solver axes
    torque = -blade_count * float(np.sum(points[:, 1] * force[:, 2] - points[:, 2] * force[:, 1]))
    return thrust / 16.0, torque / 32.0
