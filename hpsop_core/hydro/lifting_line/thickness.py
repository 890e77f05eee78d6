"""What the blades' thickness does to the flow through the blades.

Each blade's thickness is a sheet of sources on its chord surface. Between the blades they speed the flow up and turn
it, so that the sections meet less incidence: the thickness correction that Morgan, Silovic and Denny (SNAME 1968)
tabulated for design, here computed. Lengths in tip radii, axes as in geometry/propeller/surface.py.
"""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import half_thickness
from hpsop_core.geometry.propeller.surface import cylinder_points, to_cartesian
from hpsop_core.hydro.lifting_line.chord_surface import chord_points
from hpsop_core.typing_aliases import Array, IntArray

_ROTATION = 2.0 * np.pi
_OWN_STATIONS = (4, 24)
"""Source stations on the blade itself: radial ones for each strip, and along the chord. Even numbers for each strip
keep the sources half a station away from the strips' radii."""
_OTHER_STATIONS = (2, 10)
"""The same on the other blades, which are farther away."""


def thickness_normal_velocity(propeller: Propeller, radii: Array, chord_fraction: Array) -> Array:
    """Normal velocity, along ``ChordPoints.normals``, that the thickness of all blades induces on the strips of one.

    Args:
        propeller: the propeller.
        radii: the strips' radii, (M,), at the half angles of the half-cosine spacing.
        chord_fraction: where on each chord, fractions from the leading edge, (N,).

    Returns:
        (M, N, 2): for a unit advance speed (in n R), and for the rotation.
    """
    control = chord_points(propeller, radii, chord_fraction)
    points, normals = control.points, control.normals
    others = np.arange(1, propeller.blade_count, dtype=np.int64)
    velocity = _source_velocity(propeller, radii.size, _OWN_STATIONS, np.arange(1, dtype=np.int64), points, normals)
    velocity += _source_velocity(propeller, radii.size, _OTHER_STATIONS, others, points, normals)
    return velocity.reshape(radii.size, chord_fraction.size, 2)


def _source_velocity(
    propeller: Propeller, strips: int, stations: tuple[int, int], blades: IntArray, points: Array, normals: Array
) -> Array:
    """Normal velocity (points, 2) of the thickness of some blades."""
    radial, along = strips * stations[0], stations[1]
    hub = propeller.hub_ratio
    edges = hub + (1.0 - hub) * np.sin(0.5 * np.pi * np.arange(radial + 1) / radial)
    radii = hub + (1.0 - hub) * np.sin(0.5 * np.pi * (np.arange(radial) + 0.5) / radial)
    sections = propeller.table.at(radii)
    pitch, chord = sections.pitch_angle, 2.0 * sections.chord_ratio
    angle = np.pi * np.arange(along + 1) / along
    fraction = 0.5 * (1.0 - np.cos(0.5 * (angle[1:] + angle[:-1])))
    growth = np.diff(2.0 * half_thickness(0.5 * (1.0 - np.cos(angle))))
    # Flow along the chord times growth of the thickness times width of the strip.
    volume = (chord * sections.thickness_ratio * np.diff(edges))[:, None] * growth
    chordwise = np.stack([np.sin(pitch), _ROTATION * radii * np.cos(pitch)], axis=-1)
    strength = (volume[..., None] * chordwise[:, None, :]).reshape(-1, 2)
    x, theta = cylinder_points(
        radii[:, None],
        pitch[:, None],
        sections.skew[:, None],
        sections.rake_ratio[:, None],
        chord[:, None] * (fraction - 0.5),
        np.zeros((1, along)),
    )
    turn = _ROTATION * blades[:, None, None] / propeller.blade_count
    sources = to_cartesian(x, radii[:, None], theta + turn).reshape(-1, 3)
    square = (-2.0 * points) @ sources.T
    square += np.sum(sources * sources, axis=1)
    square += np.sum(points * points, axis=1)[:, None]
    height = np.sum(points * normals, axis=1)[:, None] - normals @ sources.T
    kernel = height / (4.0 * np.pi * square * np.sqrt(square))
    return np.asarray(kernel @ np.tile(strength, (blades.size, 1)))
