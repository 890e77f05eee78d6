"""Meshes of a design for the 3D view, in ship axes and metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.scene.furniture import Boxes, deck_furniture, rudder
from explorer.scene.paint import boot_top, draught_marks, shadow, walls_and_deck
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.curves import HullLines
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.mesh import Resolution, hull_view_parts
from hpsop_core.geometry.propeller.mesh import propeller_view_parts

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]
# a drawn waterline lies outside the hull by this part of the breadth: 6 cm of a large ship
_OUTSIDE = 0.0012


@dataclass(frozen=True)
class SceneGeometry:
    """What the page draws of a design.

    Attributes:
        underwater, topsides, deck: vertices and faces, fixed topology; the topsides are without the deck.
        blades, hub: vertices about the hub's centre, turning about x, and faces.
        propeller_position: of the hub's centre.
        waterline: (n, 3) closed.
        length, breadth, draft, diameter: m.
        boot_top, marks, rudder, shadow, boxes: for looks alone (``scene.paint``, ``scene.furniture``).
    """

    underwater: Mesh
    topsides: Mesh
    deck: Mesh
    blades: Mesh
    hub: Mesh
    propeller_position: tuple[float, float, float]
    waterline: NDArray[np.float64]
    length: float
    breadth: float
    draft: float
    diameter: float
    boot_top: Mesh
    marks: Mesh
    rudder: Mesh
    shadow: Mesh
    boxes: Boxes


def scene_geometry(case: Case, variables: DesignVariables, near: bool = True) -> SceneGeometry:
    """All meshes of a design.

    Args:
        case: the ship.
        variables: the design.
        near: whether it is looked at closely. A third of the triangles looks the same where the whole ship is seen, and
            a screen without graphics hardware takes 5 microseconds for each of them at every frame.

    Raises:
        SolverFailure: the hull or the propeller cannot be made.
    """
    hull = design_hull(case, variables)
    propeller = design_propeller(case, variables)
    resolution: Resolution = "view" if near else "drag"
    parts = hull_view_parts(hull, resolution)
    blades, hub = (propeller_view_parts(propeller, resolution)[name] for name in ("blades", "hub"))
    placement = propeller_placement(hull, propeller)
    turn, position = placement[:3, :3].T, placement[:3, 3]
    empty = (np.zeros((3, 3)), np.array([[0, 1, 2]]))
    port = hull.waterline()
    port = port + np.array([0.0, _OUTSIDE * hull.breadth])  # or it would drown in the hull
    line = np.concatenate([port, port[::-1] * np.array([1.0, -1.0])])
    waterline = np.column_stack([line, np.full(len(line), hull.draft)])
    underwater, above = parts.get("underwater", empty), parts.get("topsides", empty)
    walls, deck = walls_and_deck(hull, above, resolution)
    return SceneGeometry(
        underwater=underwater,
        topsides=walls,
        deck=deck,
        blades=(blades[0] @ turn, blades[1]),
        hub=(hub[0] @ turn, hub[1]),
        propeller_position=(float(position[0]), float(position[1]), float(position[2])),
        waterline=waterline,
        length=hull.length,
        breadth=hull.breadth,
        draft=hull.draft,
        diameter=propeller.diameter,
        boot_top=boot_top(hull),
        marks=draught_marks(hull),
        rudder=rudder(underwater[0], float(position[0]), float(position[2]), propeller.diameter),
        shadow=shadow(waterline, hull.depth - hull.draft),
        boxes=deck_furniture(hull),
    )


def ghost_segments(lines: HullLines, waterline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sections on both sides and the waterline as (n, 2, 3) segments: a ghost that hides nothing."""
    pieces = [np.stack([waterline[:-1], waterline[1:]], axis=1)]
    for station, parts in lines.sections:
        x = station / 20.0 * lines.length
        for part in parts:
            for side in (1.0, -1.0):
                points = np.column_stack([np.full(len(part), x), side * part[:, 0], part[:, 1]])
                pieces.append(np.stack([points[:-1], points[1:]], axis=1))
    return np.concatenate(pieces)
