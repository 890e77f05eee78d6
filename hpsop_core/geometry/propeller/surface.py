"""Points on a blade's surface from its radial table.

Propeller axes: x downstream along the shaft, z up, y = z cross x (to starboard on a ship), right-handed. The angle
theta grows in the sense of rotation of a right-handed propeller: seen from astern clockwise, from z towards y, so that
a point at radius r is (x, r sin theta, r cos theta). Lengths are in tip radii (R = 1) unless a diameter is given.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hpsop_core.geometry.propeller.radial_table import BladeSections, RadialTable
from hpsop_core.geometry.propeller.sections import half_thickness, mean_line
from hpsop_core.typing_aliases import Array


def cylinder_points(
    radius_ratio: Array, pitch_angle: Array, skew: Array, rake_ratio: Array, along_chord: Array, across: Array
) -> tuple[Array, Array]:
    """Wrap section coordinates round the cylinder of their radius.

    x = 2 rake + s sin(phi) - eta cos(phi), theta = -(s cos(phi) + eta sin(phi))/r with s = s0 + r skew/cos(phi):
    positive skew moves a section aft along its own helix (skew-induced rake included).

    Args:
        radius_ratio, pitch_angle, skew, rake_ratio: of the sections (rake over D); all arguments broadcast.
        along_chord: s0 from the mid-chord towards the trailing edge, in tip radii.
        across: eta from the chord line towards the suction side, in tip radii.

    Returns:
        (x in tip radii, theta in radians).
    """
    sine, cosine = np.sin(pitch_angle), np.cos(pitch_angle)
    along = along_chord + radius_ratio * skew / cosine
    x = 2.0 * rake_ratio + along * sine - across * cosine
    theta = -(along * cosine + across * sine) / radius_ratio
    return np.asarray(x), np.asarray(theta)


def to_cartesian(x: Array, radius_ratio: Array, theta: Array) -> Array:
    """(x, r, theta), broadcast, as points (..., 3) in propeller axes."""
    x, radius_ratio, theta = np.broadcast_arrays(x, radius_ratio, theta)
    return np.stack([x, radius_ratio * np.sin(theta), radius_ratio * np.cos(theta)], axis=-1)


def blade_points(
    sections: BladeSections, chord_fraction: Array, suction_side: bool, thickness_factor: Array | float = 1.0
) -> Array:
    """Points of one side of the key blade (generator line at theta = 0, which is up).

    Args:
        sections: sections with arrays of shape (nr,), for example ``propeller.table.at(radii)``.
        chord_fraction: fractions of the chord from the leading edge, (nc,).
        suction_side: the back of the blade (upstream) if true, else its face (downstream).
        thickness_factor: multiplies the thickness, (nr,) or one number; 0 gives the mean surface.

    Returns:
        (nr, nc, 3) in tip radii.
    """
    x, theta = blade_cylindrical(sections, chord_fraction, suction_side, thickness_factor)
    return to_cartesian(x, sections.radius_ratio[:, None], theta)


def blade_cylindrical(
    sections: BladeSections, chord_fraction: Array, suction_side: bool, thickness_factor: Array | float = 1.0
) -> tuple[Array, Array]:
    """As ``blade_points``, but (x, theta), each (nr, nc); the radii are those of the sections."""
    along, across = section_points(sections, chord_fraction, suction_side, thickness_factor)
    return cylinder_points(
        sections.radius_ratio[:, None],
        sections.pitch_angle[:, None],
        sections.skew[:, None],
        sections.rake_ratio[:, None],
        along,
        across,
    )


def section_points(
    sections: BladeSections, chord_fraction: Array, suction_side: bool, thickness_factor: Array | float = 1.0
) -> tuple[Array, Array]:
    """The expanded sections: (s from mid-chord aft, eta towards the suction side), each (nr, nc), in tip radii.

    Thickness is added normal to the chord: eta = f yc +- t yt.
    """
    chord = 2.0 * sections.chord_ratio[:, None]
    fraction = np.asarray(chord_fraction, dtype=np.float64)
    thickness = sections.thickness_ratio[:, None] * np.reshape(np.asarray(thickness_factor, dtype=np.float64), (-1, 1))
    sign = 1.0 if suction_side else -1.0
    along = chord * (fraction - 0.5)
    camber = sections.camber_ratio[:, None] * mean_line(fraction)
    across = chord * (camber + sign * thickness * half_thickness(fraction))
    return along, across


TIP_CHORD_RATIO = 0.02
"""Chord over D of the finite tip that meshes and CAD surfaces have where the table's chord goes to zero."""

_TIP_CLOSING_RADIUS = 0.99


def finite_tip_sections(table: RadialTable, radius_ratio: Array) -> BladeSections:
    """Sections for shapes that must have an area: a short tip chord, and no thickness at the very tip.

    The chord is sqrt(c^2 + c_tip^2 w) with w = ((r - r_h)/(R - r_h))^16, so that nothing but the last 2 % of the radius
    changes visibly; the thickness keeps its absolute value and closes elliptically over the last 1 %.
    """
    sections = table.at(radius_ratio)
    hub = table.hub_ratio
    outward = np.clip((radius_ratio - hub) / (1.0 - hub), 0.0, 1.0)
    chord = np.sqrt(sections.chord_ratio**2 + TIP_CHORD_RATIO**2 * outward**16)
    closing = np.clip((radius_ratio - _TIP_CLOSING_RADIUS) / (1.0 - _TIP_CLOSING_RADIUS), 0.0, 1.0)
    thickness = sections.thickness_ratio * (sections.chord_ratio / chord) * np.sqrt(1.0 - closing**2)
    return replace(sections, chord_ratio=chord, thickness_ratio=thickness)


EDGE_THICKNESS_RATIO = 0.001
"""Thickness over D of trailing edge and tip, and the least diameter of the nose, of meshes and CAD surfaces.

A blade that closes to nothing can be neither milled nor meshed; 9 mm on a propeller of 9 m is what a yard leaves.
"""


def edge_half_thickness(chord: Array, chord_fraction: Array) -> Array:
    """Half of the edges' own thickness at fractions of a chord in tip radii, broadcast, in tip radii.

    A quarter circle at the nose and constant behind it, to the trailing edge.
    """
    edge = EDGE_THICKNESS_RATIO
    nose = np.clip(1.0 - chord * chord_fraction / edge, 0.0, 1.0)
    return np.asarray(edge * np.sqrt(1.0 - nose**2))


def finite_edge_points(sections: BladeSections, chord_fraction: Array) -> tuple[Array, Array, Array]:
    """Sections whose edges have a thickness: (s, eta of the back, eta of the face), each (nr, nc), in tip radii.

    The half thickness is the root of the squares of the table's t yt and of ``edge_half_thickness``: at the edges the
    latter, in the middle of a blade the table's own to a hundredth of it. `closed.py` takes it away again.
    """
    chord = 2.0 * sections.chord_ratio[:, None]
    fraction = np.asarray(chord_fraction, dtype=np.float64)
    along = chord * (fraction - 0.5)
    own = chord * sections.thickness_ratio[:, None] * half_thickness(fraction)
    half = np.hypot(own, edge_half_thickness(chord, fraction))
    camber = chord * sections.camber_ratio[:, None] * mean_line(fraction)
    return along, camber + half, camber - half


def rotate_blade(points: Array, blade: int, blade_count: int) -> Array:
    """Points of the key blade (..., 3) turned to the place of blade number ``blade`` (0 is the key blade)."""
    angle = 2.0 * np.pi * blade / blade_count
    sine, cosine = np.sin(angle), np.cos(angle)
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    # theta grows from z towards y
    return np.stack([x, cosine * y + sine * z, cosine * z - sine * y], axis=-1)
