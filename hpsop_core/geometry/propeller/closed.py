"""The blade's surface with its edges closed: what the solvers' panels stand on.

The blade has one surface, `nurbs.blade_surface`. Its trailing edge and tip have a thickness, its nose has one too where
the section's own would be less, because what is milled and meshed needs it; a flow solver's Kutta condition needs a
trailing edge without. Points of back and face at the same chord fraction lie on one normal of the chord, on either side
of the mean line. The surface was drawn with a half thickness of hypot(own, edge) (`surface.finite_edge_points`), so its
points give the mean line as their middle, and the section's own half thickness as sqrt(half^2 - edge^2). At the nose of
wide thin tips that is a small difference of two numbers which the surface holds to 1e-4 D: it may come out as nothing,
and back and face would be the same panel. There the table's own thickness counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller.nurbs import blade_parameters, blade_surface
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions, half_thickness
from hpsop_core.geometry.propeller.surface import edge_half_thickness
from hpsop_core.typing_aliases import Array

# What the difference of half and edge may lose of the table's own thickness.
_LEAST_OF_TABLE = 0.5


@dataclass(frozen=True, eq=False)
class ClosedSections:
    """Sections of the key blade at some radii, on their cylinders, with sharp edges; propeller axes, tip radii.

    Attributes:
        radius_ratio: r/R, (nr,).
        x, theta: mean line, (nr, nc), from the leading edge to the trailing edge, cosine spacing.
        half_x, half_theta: what leads from the mean line to the back, and taken away to the face, (nr, nc); zero at
            both edges.
    """

    radius_ratio: Array
    x: Array
    theta: Array
    half_x: Array
    half_theta: Array

    @property
    def chord(self) -> Array:
        """c/R, (nr,)."""
        turn = self.theta[:, -1] - self.theta[:, 0]
        return np.asarray(np.hypot(self.x[:, -1] - self.x[:, 0], self.radius_ratio * turn))

    def outlines(self, thickness_factor: Array, chord_factor: Array) -> tuple[Array, Array]:
        """Outlines from the trailing edge over the face to the leading edge and over the back: (x, theta).

        Args:
            thickness_factor: multiplies the thickness, (nr,).
            chord_factor: stretches the mean line about its mid-chord, (nr,).

        Returns:
            Each (nr, 2 nc - 1).
        """

        def outline(mean: Array, half: Array) -> Array:
            middle = 0.5 * (mean[:, :1] + mean[:, -1:])
            mean = middle + chord_factor[:, None] * (mean - middle)
            half = thickness_factor[:, None] * half
            return np.concatenate([(mean - half)[:, ::-1], (mean + half)[:, 1:]], axis=1)

        return outline(self.x, self.half_x), outline(self.theta, self.half_theta)


def closed_sections(propeller: Propeller, radius_ratio: Array, intervals: int) -> ClosedSections:
    """Sections of ``blade_surface`` with the thickness of its edges taken away.

    Args:
        propeller: the propeller.
        radius_ratio: r/R, (nr,), in any order.
        intervals: along the chord; nc is one more.
    """
    radius = np.asarray(radius_ratio, dtype=np.float64)
    # R = 1: a model and its ship have the same panels to the last bit
    surface = blade_surface(propeller.with_diameter(2.0))
    points = surface.evaluate(blade_parameters(propeller, radius), np.linspace(0.0, 1.0, 2 * intervals + 1))
    x = points[..., 0]
    # a wide blade goes round the hub by more than half a turn
    theta = np.unwrap(np.arctan2(points[..., 1], points[..., 2]), axis=1)
    # the surface goes from the trailing edge over the back to the leading edge and over the face
    back, face = slice(intervals, None, -1), slice(intervals, None)
    half_x, half_theta = 0.5 * (x[:, back] - x[:, face]), 0.5 * (theta[:, back] - theta[:, face])
    middle_x, middle_theta = 0.5 * (x[:, back] + x[:, face]), 0.5 * (theta[:, back] + theta[:, face])
    mean = ClosedSections(radius, middle_x, middle_theta, half_x, half_theta)
    edge = edge_half_thickness(mean.chord[:, None], cosine_chord_fractions(intervals + 1))
    half = np.hypot(half_x, radius[:, None] * half_theta)
    drawn = np.where(half > 0.0, half, 1.0)
    own = np.sqrt(np.maximum(1.0 - (edge / drawn) ** 2, 0.0))
    # On the optimiser's panels never less than two thirds of the table's comes out.
    own = np.maximum(own, _LEAST_OF_TABLE * _own_half_thickness(propeller, radius, intervals) / drawn)
    own[:, [0, -1]] = 0.0
    return ClosedSections(radius, middle_x, middle_theta, own * half_x, own * half_theta)


def _own_half_thickness(propeller: Propeller, radius: Array, intervals: int) -> Array:
    """Of the table, in tip radii, (nr, nc)."""
    sections = propeller.table.at(radius)
    greatest = 2.0 * sections.chord_ratio * sections.thickness_ratio
    return np.asarray(greatest[:, None] * half_thickness(cosine_chord_fractions(intervals + 1)))
