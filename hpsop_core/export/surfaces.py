"""A design as NURBS surfaces in ship axes: both sides of the hull, its flat ends and deck, the blades and the hub."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.export.fairing import faired_seams
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.nurbs import NurbsSurface, clamped_knots
from hpsop_core.geometry.propeller.nurbs import propeller_surfaces
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.typing_aliases import Array

# Of each group, red, green, blue, opacity, 0 to 255.
COLOURS = {
    "hull underwater": (150, 60, 50, 255),
    "hull topsides": (70, 95, 120, 255),
    "hull flat ends": (120, 120, 120, 255),
    "propeller": (190, 150, 60, 255),
}
_MIRROR = np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class NamedSurface:
    """A surface of a design.

    Attributes:
        group: "hull underwater", "hull topsides", "hull flat ends" or "propeller".
        name: what it is, with its side: "main port", "blade 1".
        surface: in m, ship axes (x forward of AP, y to port, z up).
    """

    group: str
    name: str
    surface: NurbsSurface


def hull_surfaces(hull: Hull) -> tuple[tuple[NamedSurface, ...], float]:
    """Every patch of both sides with deck, transom and boss end, and the largest deviation from the hull in m.

    The deviation is that of refitting the longitudinal shift (``Hull.nurbs_patch``), zero to rounding for a hull that
    is only scaled, and that of the strips beside seams (``fairing``), which is the larger one as a rule.
    """
    found: list[NamedSurface] = []
    refitted = {patch.name: hull.nurbs_patch(patch.name) for patch in hull.patches}
    surfaces, deviation = faired_seams(hull.parent, {name: surface for name, (surface, _) in refitted.items()})
    deviation += max(off for _, off in refitted.values())
    for group, names in (("hull underwater", hull.parent.underwater), ("hull topsides", hull.parent.topsides)):
        for name in names:
            surface = surfaces[name]
            found.extend(_both_sides(group, name, surface))
            for cap, end in hull.parent.caps:
                if cap == name:
                    row = 0 if end == "first" else -1
                    edge, weights = surface.control_points[row], surface.weights[row]
                    flat = _to_centreplane(edge, weights, surface.knots_v, surface.degree_v)
                    found.extend(_both_sides("hull flat ends", f"{name} end", flat))
            if group == "hull topsides" and _is_deck(hull, surface):
                edge, weights = surface.control_points[:, -1], surface.weights[:, -1]
                deck = _to_centreplane(edge, weights, surface.knots_u, surface.degree_u)
                found.extend(_both_sides("hull flat ends", f"{name} deck", deck))
    return tuple(found), deviation


def design_surfaces(hull: Hull, propeller: Propeller) -> tuple[tuple[NamedSurface, ...], float]:
    """Hull and propeller in its place; and the hull's deviation in m, as ``hull_surfaces`` gives it."""
    hull_parts, deviation = hull_surfaces(hull)
    blades = propeller_surfaces(propeller, propeller_placement(hull, propeller))
    return hull_parts + tuple(NamedSurface("propeller", name, surface) for name, surface in blades.items()), deviation


def _both_sides(group: str, name: str, surface: NurbsSurface) -> tuple[NamedSurface, NamedSurface]:
    mirrored = replace(surface, control_points=surface.control_points * _MIRROR)
    return NamedSurface(group, f"{name} port", surface), NamedSurface(group, f"{name} starboard", mirrored)


def _is_deck(hull: Hull, surface: NurbsSurface) -> bool:
    height = hull.parent.deck_height * hull.scale[2]
    return bool(np.allclose(surface.control_points[:, -1, 2], height, atol=1e-6 * height))


def _to_centreplane(edge: Array, weights: Array, knots: Array, degree: int) -> NurbsSurface:
    """The ruled surface between a curve (control points, weights) and its foot on the centreplane.

    A stretch of the curve in the centreplane itself, below a stern post, is left out: a strip without width is no face.
    """
    edge, weights, knots = _off_the_centreplane(edge, weights, knots, degree)
    foot = edge * np.array([1.0, 0.0, 1.0])
    control, both = np.stack([edge, foot], axis=1), np.stack([weights, weights], axis=1)
    return NurbsSurface(degree, 1, knots, clamped_knots([], 1), control, both)


def _off_the_centreplane(edge: Array, weights: Array, knots: Array, degree: int) -> tuple[Array, Array, Array]:
    """The curve from where it leaves the centreplane on, its control points, weights and knots on [0, 1]."""
    stands_off = np.flatnonzero(edge[:, 1] != 0.0)
    if len(stands_off) == 0 or stands_off[0] <= degree:
        return edge, weights, knots
    # With the control points before it zero, so is the curve up to this knot; there it is cut, by inserting the knot
    # until the curve goes through a control point.
    cut = float(knots[stands_off[0]])
    extra = np.full(degree - int(np.count_nonzero(knots == cut)), cut)
    line = NurbsSurface(
        degree, 1, knots, clamped_knots([], 1), np.stack([edge, edge], axis=1), np.stack([weights] * 2, 1)
    )
    finer = line.with_knots_u(extra) if len(extra) else line
    first = int(np.searchsorted(finer.knots_u, cut)) - 1
    rest = np.concatenate([[cut], finer.knots_u[first + 1 :]])
    return finer.control_points[first:, 0], finer.weights[first:, 0], (rest - cut) / (1.0 - cut)
