"""Points on the blades' chord surface and the normals to it.

Lengths in tip radii, axes and theta as in geometry/propeller/surface.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.radial_table import BladeSections
from hpsop_core.geometry.propeller.surface import cylinder_points, to_cartesian
from hpsop_core.typing_aliases import Array

_RADIAL_STEP = 1.0e-3


@dataclass(frozen=True, eq=False)
class ChordPoints:
    """Points on the chord surface of the key blade, strip by strip.

    A normal is a unit vector across the section, towards the suction side, plus the radial part that makes it square to
    the surface. It is longer than one where the blade leans (rake): flow tangency does not mind, because what is asked
    of the induced velocity and of the onset flow grows alike.

    Attributes:
        x, theta: (M, N).
        points: (M N, 3).
        axial, tangential: (M N,) components of the normals along x and theta.
        normals: (M N, 3).
    """

    x: Array
    theta: Array
    points: Array
    axial: Array
    tangential: Array
    normals: Array


def chord_points(propeller: Propeller, radii: Array, chord_fraction: Array) -> ChordPoints:
    """Points at radii (M,) and fractions of the chord from the leading edge (N,)."""
    sections = propeller.table.at(radii)
    x, theta = _wrapped(sections, chord_fraction)
    pitch = np.broadcast_to(sections.pitch_angle[:, None], x.shape)
    axial, tangential = -np.cos(pitch), -np.sin(pitch)
    # How the surface leans: the step across the section, from one radius to the next at the same share of the chord.
    inner, outer = radii - _RADIAL_STEP, np.minimum(radii + _RADIAL_STEP, 1.0)
    x_in, theta_in = _wrapped(propeller.table.at(inner), chord_fraction)
    x_out, theta_out = _wrapped(propeller.table.at(outer), chord_fraction)
    lean = axial * (x_out - x_in) + tangential * radii[:, None] * (theta_out - theta_in)
    radial = -lean / (outer - inner)[:, None]
    sine, cosine = np.sin(theta), np.cos(theta)
    normals = np.stack(
        [axial, tangential * cosine + radial * sine, -tangential * sine + radial * cosine], axis=-1
    ).reshape(-1, 3)
    points = to_cartesian(x, radii[:, None], theta).reshape(-1, 3)
    return ChordPoints(x, theta, points, axial.ravel(), tangential.ravel(), normals)


def _wrapped(sections: BladeSections, chord_fraction: Array) -> tuple[Array, Array]:
    """(x, theta) of points on the chords, (M, N) each."""
    along = 2.0 * sections.chord_ratio[:, None] * (chord_fraction - 0.5)
    return cylinder_points(
        sections.radius_ratio[:, None],
        sections.pitch_angle[:, None],
        sections.skew[:, None],
        sections.rake_ratio[:, None],
        along,
        np.zeros_like(along),
    )
