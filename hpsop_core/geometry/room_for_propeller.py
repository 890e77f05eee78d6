"""Where a propeller finds room behind a hull whose file tells neither shaft nor boss."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.geometry.clearance import propeller_clearance
from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.propeller.propeller import Propeller

# Tip clearance that is looked for, as a part of the diameter: sizes about the found one have room too.
CLEAR = 0.1
# The hub begins this part of the diameter forward of a transom at the least: the blades turn under the ship.
UNDER_TRANSOM = 0.35
# Places along the stern, and sizes, that are tried.
_PLACES, _SIZES = 13, 9


@dataclass(frozen=True)
class PropellerRoom:
    """Where the hub begins, m from AP, the shaft's height above the baseline and the diameter, m."""

    boss_x: float
    shaft_height: float
    diameter: float


def room_for_propeller(
    parent: ParentHull, propeller_of: Callable[[float], Propeller], greatest: float, least: float, lowest: float
) -> PropellerRoom | None:
    """A place of the hub and a diameter at which the blades stay clear of the hull; None where they are so already.

    Where the run rises over the shaft without skeg or boss, as of boats and tugs, the stern profile meets the shaft
    under the ship, and any propeller there would cut the hull: it stands further aft, on an open shaft, as low as its
    tips may be.

    Args:
        parent: the hull, with the place of the hub that was found or assumed.
        propeller_of: the propeller of a diameter, m.
        greatest, least: diameters between which it may be, m.
        lowest: height of the lowest tip above the baseline, m.

    Returns:
        The greatest diameter for which there is room, and its foremost place; also None without room anywhere.
    """
    if _clearance(parent, parent.boss_end_x, propeller_of(greatest)) >= 0.0:
        return None
    aftmost = min(float(patch.control_points[0, 0, 0]) for patch in parent.underwater.values())
    transom = any(end == "first" and name in parent.underwater for name, end in parent.caps)
    for diameter in np.linspace(greatest, least, _SIZES):
        propeller = propeller_of(float(diameter))
        last = aftmost + (UNDER_TRANSOM * float(diameter) if transom else 0.0)
        places = np.linspace(parent.boss_end_x, min(last, parent.boss_end_x), _PLACES)
        shaft = min(parent.shaft_height, lowest + 0.5 * float(diameter))
        lowered = replace(parent, shaft_height=shaft)
        if _clearance(lowered, float(places[-1]), propeller) < CLEAR * diameter:
            continue
        clear = (x for x in places if _clearance(lowered, float(x), propeller) >= CLEAR * diameter)
        return PropellerRoom(float(next(clear)), shaft, float(diameter))
    return None


def _clearance(parent: ParentHull, boss_end_x: float, propeller: Propeller) -> float:
    placed = replace(parent, boss_end_x=boss_end_x, _points={})
    return propeller_clearance(placed.transform(placed.length, placed.breadth, placed.draft), propeller)
