"""The hub: how long it is, its outline from the forward face to the boss cap, and the fillet at the blades' roots.

Lengths in tip radii, propeller axes (x downstream).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.propeller.propeller import BladeSections, Propeller
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import cylinder_points, section_points
from hpsop_core.typing_aliases import Array

FILLET_RADIUS = 0.03
_LEAST_GAP = 0.01
_MARGIN = 0.03
_CHAMFER = 0.04
_FACE_RADIUS_RATIO = 0.85
_CAP_LENGTH_RATIO = 1.1
_OUTLINE_POINTS = 61


@dataclass(frozen=True)
class Hub:
    """A hub of revolution.

    Attributes:
        radius: of the cylinder that carries the blades.
        fillet_radius: of the fillet between blade and hub.
        face_x, cylinder_start, cylinder_end, cap_x: forward face, ends of the cylinder, tip of the boss cap.
        root_start, root_end: extent along the shaft of the root with its fillet.
    """

    radius: float
    fillet_radius: float
    face_x: float
    cylinder_start: float
    cylinder_end: float
    cap_x: float
    root_start: float
    root_end: float

    def radius_at(self, x: Array) -> Array:
        """Radius of the outline at x: a rounded chamfer, the cylinder, an elliptic cap."""
        ahead = np.clip((self.cylinder_start - x) / (self.cylinder_start - self.face_x), 0.0, 1.0)
        behind = np.clip((x - self.cylinder_end) / (self.cap_x - self.cylinder_end), 0.0, 1.0)
        chamfer = 1.0 - (1.0 - _FACE_RADIUS_RATIO) * ahead**2
        return np.asarray(self.radius * chamfer * np.sqrt(1.0 - behind**2))


def root_contour(propeller: Propeller, fillet_offset: float, points: int = _OUTLINE_POINTS) -> tuple[Array, Array]:
    """The root section's closed outline, pushed outwards by ``fillet_offset``, wrapped on the hub.

    From the trailing edge over the back to the leading edge and over the face to the trailing edge again.

    Args:
        propeller: the propeller.
        fillet_offset: in tip radii, normal to the section's outline.
        points: on each side.

    Returns:
        (x, theta), each (2 points - 1,); the last is the first.
    """
    sections = propeller.table.at(np.array([propeller.hub_ratio]))
    fractions = cosine_chord_fractions(points)
    back_s, back_eta = section_points(sections, fractions, True)
    face_s, face_eta = section_points(sections, fractions, False)
    along = np.concatenate([back_s[:, ::-1], face_s[:, 1:]], axis=1)
    across = np.concatenate([back_eta[:, ::-1], face_eta[:, 1:]], axis=1)
    x, theta = pushed_outwards(sections, along, across, np.array([fillet_offset]))
    return x[0], theta[0]


def pushed_outwards(sections: BladeSections, along: Array, across: Array, offset: Array) -> tuple[Array, Array]:
    """Closed outlines of sections (nr, m), the last point the first, each pushed outwards by ``offset`` (nr,).

    From the trailing edge over the back to the leading edge and over the face.

    Returns:
        (x, theta), each (nr, m), wrapped on the cylinders of their radii.
    """
    ds, de = _periodic_difference(along), _periodic_difference(across)
    length = np.hypot(ds, de)
    # over the back towards the leading edge the outside is on the right of the direction of travel
    along = along + offset[:, None] * de / length
    across = across - offset[:, None] * ds / length
    return cylinder_points(
        sections.radius_ratio[:, None],
        sections.pitch_angle[:, None],
        sections.skew[:, None],
        sections.rake_ratio[:, None],
        along,
        across,
    )


def _periodic_difference(values: Array) -> Array:
    """Central differences along closed outlines whose last point is the first."""
    inner = values[:, 2:] - values[:, :-2]
    ends = values[:, 1:2] - values[:, -2:-1]
    return np.concatenate([ends, inner, ends], axis=1)


def root_gap(propeller: Propeller) -> float:
    """Free arc of the hub between the roots of neighbouring blades, in tip radii; negative where they overlap."""
    radius = propeller.hub_ratio
    root = propeller.table.at(np.array(radius))
    thickness = 2.0 * float(root.chord_ratio * root.thickness_ratio) / float(np.sin(root.pitch_angle))
    return 2.0 * np.pi * radius / propeller.blade_count - thickness


def check_root_gap(propeller: Propeller) -> None:
    """Raise InputError where the roots of neighbouring blades meet, so that no hub lies between them."""
    gap = root_gap(propeller)
    if gap < _LEAST_GAP:
        raise InputError(
            f"propeller {propeller.table.name}: the roots of neighbouring blades meet on the hub ({gap:.3f} R between "
            "them); fewer blades or thinner roots are needed"
        )


@lru_cache(maxsize=64)
def hub_of(propeller: Propeller) -> Hub:
    """The hub that carries the blades of a propeller: as long as the root sections with their fillets need."""
    radius = propeller.hub_ratio
    fillet = float(np.clip(0.25 * root_gap(propeller), 0.1 * FILLET_RADIUS, FILLET_RADIUS))
    x, _ = root_contour(propeller, fillet)
    start, end = float(np.min(x)), float(np.max(x))
    cylinder_start, cylinder_end = start - _MARGIN, end + _MARGIN
    return Hub(
        radius=radius,
        fillet_radius=fillet,
        face_x=cylinder_start - _CHAMFER,
        cylinder_start=cylinder_start,
        cylinder_end=cylinder_end,
        cap_x=cylinder_end + _CAP_LENGTH_RATIO * radius,
        root_start=start,
        root_end=end,
    )
