"""What makes a hull look like a ship: deck house, funnel, containers or hatch covers, rudder. For looks alone.

All of it follows from the hull's own dimensions, stands on the deck that the parent has, and goes nowhere else: no
solver, no number and no exported file knows of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpsop_core.geometry.hull.hull import Hull

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[np.int64]]
Colour = tuple[int, int, int]

WHITE: Colour = (236, 238, 240)
GLASS: Colour = (46, 62, 78)
STEEL: Colour = (112, 118, 124)
FUNNEL: Colour = (38, 72, 120)
BAND: Colour = (206, 92, 58)
HATCH: Colour = (134, 104, 84)
_CONTAINERS: tuple[Colour, ...] = (
    (132, 46, 34),
    (34, 66, 108),
    (168, 160, 146),
    (52, 92, 72),
    (160, 104, 40),
    (86, 90, 98),
)
# A container ship is slender, a bulk carrier or tanker full; a small ship carries its cargo under hatch covers.
_SLENDER, _LARGE = 0.74, 140.0
# from here on the house stands forward and the funnel aft, as on the largest container ships
_TWO_ISLANDS = 300.0
# models are furnished like the ship of this length that they stand for
_MODEL, _STANDS_FOR = 40.0, 200.0
# a 40-foot bay with its gap, two boxes abreast, two tiers (m)
_BAY, _BOX, _PAIR, _TIERS = 14.4, 12.2, 4.95, 5.2
_EDGE_STATIONS = np.linspace(0.0, 1.0, 33)


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes along the ship's axes: centres (n, 3) and sides (n, 3) in m, colours (n, 3) uint8."""

    centres: Array
    sides: Array
    colours: NDArray[np.uint8]


class _Pile:
    """Boxes while they are being put."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._colours: list[Colour] = []

    def put(self, x: Sequence[float], y: Sequence[float], z: Sequence[float], colour: Colour) -> None:
        """A box from the first to the second of each."""
        (x0, x1), (y0, y1), (z0, z1) = x, y, z
        middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1))
        self._rows.append((*middle, x1 - x0, y1 - y0, z1 - z0))
        self._colours.append(colour)

    def across(self, x: Sequence[float], half: float, z: Sequence[float], colour: Colour) -> None:
        """A box over the centreplane."""
        self.put(x, (-half, half), z, colour)

    def boxes(self) -> Boxes:
        table = np.array(self._rows).reshape(-1, 6)
        return Boxes(table[:, :3], table[:, 3:], np.array(self._colours, dtype=np.uint8).reshape(-1, 3))


@dataclass(frozen=True, eq=False)
class _Deck:
    """The deck's edge: x ascending, half-breadth and height there; the unit of length for what stands on it."""

    x: Array
    half: Array
    height: Array
    metre: float

    def half_over(self, first: float, last: float) -> float:
        """The least half-breadth between two stations."""
        return float(np.interp(np.linspace(first, last, 5), self.x, self.half).min())

    def height_over(self, first: float, last: float) -> float:
        """The greatest height between two stations."""
        return float(np.interp((first, last), self.x, self.height).max())


def deck_furniture(hull: Hull) -> Boxes:
    """All that stands on the deck."""
    deck = _deck(hull)
    pile = _Pile()
    length = hull.length
    parent = hull.parent
    slender = parent.hydrostatics.block_coefficient < _SLENDER
    size = _size(hull)
    large = size * _model_scale(size) >= _LARGE
    if slender and large:
        two = size * _model_scale(size) >= _TWO_ISLANDS
        house, funnel = (0.68, 0.20) if two else (0.19, 0.15)
        tiers = 3 if two else 2
        clear = [_house(pile, deck, house * length, (2.0 * tiers + 3.0) * 2.9), _stack(pile, deck, funnel * length)]
        _containers(pile, deck, length, tiers, clear)
    else:
        # a full ship or a large one has its house at the stern, a small slender one amidships
        aft = not slender or large
        at = 0.10 if aft else 0.46
        floor = 6.0 if aft else 4.0
        clear = [
            _house(pile, deck, at * length, floor * 2.9),
            _stack(pile, deck, (at - (0.045 if aft else 0.035)) * length),
        ]
        _hatches(pile, deck, length, clear, 7 if not slender else 4)
    mast = 0.965 * length
    unit, height = deck.metre, deck.height_over(mast, mast)
    pile.across((mast - 0.4 * unit, mast + 0.4 * unit), 0.4 * unit, (height, height + 11.0 * unit), STEEL)
    return pile.boxes()


def _size(hull: Hull) -> float:
    """The length that decides what stands on deck: the parent's, the same for all designs of a ship.

    A hull of quite another size, such as a model of six metres of a ship's form, goes by its own.
    """
    parent = hull.parent.length
    return parent if 0.5 < hull.length / parent < 2.0 else hull.length


def _model_scale(length: float) -> float:
    return 1.0 if length >= _MODEL else _STANDS_FOR / length


def _deck(hull: Hull) -> _Deck:
    pieces = [hull.patch_points(name, _EDGE_STATIONS, np.array([1.0]))[:, 0] for name in hull.parent.topsides]
    edge = np.concatenate(pieces) if pieces else np.array([[0.0, 0.5 * hull.breadth, hull.draft]])
    edge = edge[np.argsort(edge[:, 0], kind="stable")]
    return _Deck(edge[:, 0], np.abs(edge[:, 1]), edge[:, 2], 1.0 / _model_scale(_size(hull)))


def _house(pile: _Pile, deck: _Deck, at: float, height: float) -> tuple[float, float]:
    """Accommodation with its bridge, its middle at a station; returns where it stands."""
    unit = deck.metre
    height *= unit
    x = at - 6.0 * unit, at + 6.0 * unit
    half, foot = deck.half_over(*x), deck.height_over(*x)
    top = foot + height
    pile.across(x, 0.84 * half, (foot, top), WHITE)
    # decks show as lines of windows, the bridge as one of glass with wings to the ship's side
    floors = max(2, round(height / (2.9 * unit)))
    for floor in range(1, floors):
        z = foot + (floor + 0.35) * height / floors
        pile.across((x[0] - 0.08 * unit, x[1] + 0.08 * unit), 0.80 * half, (z, z + 0.9 * unit), GLASS)
    bridge = x[0] + 2.0 * unit, x[1] + 1.0 * unit
    pile.across(bridge, 0.62 * half, (top, top + 3.2 * unit), WHITE)
    glass = bridge[0] - 0.08 * unit, bridge[1] + 0.08 * unit
    pile.across(glass, 0.63 * half, (top + 1.3 * unit, top + 2.4 * unit), GLASS)
    pile.across((x[1] - 4.0 * unit, x[1]), half, (top - 0.3 * unit, top + 1.0 * unit), WHITE)
    mast = top + 3.2 * unit
    pile.across((at - 0.5 * unit, at + 0.5 * unit), 0.5 * unit, (mast, mast + 7.0 * unit), WHITE)
    pile.across((at - 0.3 * unit, at + 0.3 * unit), 3.5 * unit, (mast + 4.0 * unit, mast + 4.5 * unit), WHITE)
    return x


def _stack(pile: _Pile, deck: _Deck, at: float) -> tuple[float, float]:
    """Engine casing and funnel; returns where they stand."""
    unit = deck.metre
    x = at - 5.0 * unit, at + 5.0 * unit
    half, foot = deck.half_over(*x), deck.height_over(*x)
    casing = foot + 11.0 * unit
    pile.across(x, 0.45 * half, (foot, casing), WHITE)
    funnel = at - 3.5 * unit, at + 2.5 * unit
    wide = min(0.26 * half, 4.5 * unit)
    pile.across(funnel, wide, (casing, casing + 9.0 * unit), FUNNEL)
    pile.across(
        (funnel[0] - 0.05 * unit, funnel[1] + 0.05 * unit),
        1.02 * wide,
        (casing + 5.5 * unit, casing + 7.5 * unit),
        BAND,
    )
    return x


def _free(first: float, last: float, clear: Sequence[tuple[float, float]]) -> bool:
    return all(last <= start or first >= end for start, end in clear)


def _containers(pile: _Pile, deck: _Deck, length: float, tiers: int, clear: Sequence[tuple[float, float]]) -> None:
    """Bays over the deck; only boxes that can be seen have colours of their own, one dark block fills the rest."""
    unit = deck.metre
    for number, first in enumerate(np.arange(0.01 * length, 0.915 * length, _BAY * unit)):
        last = first + _BOX * unit
        if not _free(first - unit, last + unit, clear):
            continue
        half, foot = deck.half_over(first, last), deck.height_over(first, last) + 1.6 * unit
        rows = int(1.97 * half / (_PAIR * unit))
        if rows < 2:
            continue
        # fewer tiers towards the bow, where nobody would see over them
        high = tiers - (first > 0.72 * length) - (first > 0.84 * length)
        high = max(high, 1)
        side = 0.5 * rows * _PAIR * unit
        pile.across((first, last), side, (foot - 1.6 * unit, foot), STEEL)
        inner = side - _PAIR * unit
        if high > 1 and inner > 0.0:
            pile.across((first, last), inner, (foot, foot + (high - 1) * _TIERS * unit), _CONTAINERS[number % 2])
        for tier in range(high):
            whole = tier == high - 1
            for row in range(rows) if whole else (0, rows - 1):
                y = -side + row * _PAIR * unit
                z = foot + tier * _TIERS * unit
                # a pattern that looks like chance and is the same every time
                colour = _CONTAINERS[(7 * number + 5 * row + 3 * tier + (number * row) % 4) % len(_CONTAINERS)]
                gap = 0.04 * unit
                pile.put((first, last), (y + gap, y + _PAIR * unit - gap), (z, z + _TIERS * unit - gap), colour)


def _hatches(pile: _Pile, deck: _Deck, length: float, clear: Sequence[tuple[float, float]], count: int) -> None:
    """Hatch covers on their coamings, as many as fit between house and bow."""
    unit = deck.metre
    for first in np.linspace(0.05 * length, 0.93 * length, count + 1)[:-1]:
        pitch = 0.88 * length / count
        last = first + 0.78 * pitch
        if not _free(first - unit, last + unit, clear):
            continue
        half, foot = deck.half_over(first, last), deck.height_over(first, last)
        wide = 0.58 * half
        pile.across((first, last), wide, (foot, foot + 1.3 * unit), STEEL)
        pile.across(
            (first - 0.3 * unit, last + 0.3 * unit), wide + 0.4 * unit, (foot + 1.3 * unit, foot + 2.1 * unit), HATCH
        )


def unit_box() -> Mesh:
    """A box of side 1 about the origin, each face with corners of its own so that its edges are sharp."""
    corners: list[Array] = []
    faces: list[NDArray[np.int64]] = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            first = 4 * len(corners)
            square = np.zeros((4, 3))
            square[:, axis] = side
            square[:, (axis + 1) % 3] = (-0.5, 0.5, 0.5, -0.5)
            square[:, (axis + 2) % 3] = (-0.5, -0.5, 0.5, 0.5)
            order = [[0, 1, 2], [0, 2, 3]] if side > 0.0 else [[0, 2, 1], [0, 3, 2]]
            corners.append(square)
            faces.append(np.array(order) + first)
    return np.concatenate(corners), np.concatenate(faces)


def rudder(underwater: Array, propeller_x: float, shaft_height: float, diameter: float) -> Mesh:
    """A spade rudder in the propeller's slipstream, up to the counter above it.

    Args:
        underwater: (n, 3) vertices of the hull below the waterline, m.
        propeller_x, shaft_height: of the propeller's centre, m.
        diameter: of the propeller, m.
    """
    lead = propeller_x - 0.34 * diameter
    chord, thick = 0.56 * diameter, 0.11 * diameter
    middle = lead - 0.35 * chord
    centre = underwater[np.abs(underwater[:, 1]) < 1e-6 * diameter]
    above = centre[(centre[:, 2] > shaft_height + 0.3 * diameter) & (np.abs(centre[:, 0] - middle) < 0.5 * diameter)]
    top = shaft_height + 0.75 * diameter
    if len(above):
        order = np.argsort(above[:, 0])
        top = float(np.interp(middle, above[order, 0], above[order, 2])) - 0.01 * diameter
    # clear of the baseline, as a docking ship needs it
    bottom = max(shaft_height - 0.52 * diameter, 0.05 * shaft_height)
    # a symmetrical section, blunt forward and sharp aft, taken in a little at the foot
    along = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 13))
    half = thick * (1.4845 * np.sqrt(along) - 0.63 * along - 1.758 * along**2 + 1.4215 * along**3 - 0.5180 * along**4)
    ring = np.concatenate([np.column_stack([along, half]), np.column_stack([along[-2:0:-1], -half[-2:0:-1]])])
    levels = []
    for z, size in ((bottom, 0.80), (top, 1.0)):
        levels.append(
            np.column_stack([lead - 0.02 * chord - size * chord * ring[:, 0], size * ring[:, 1], np.full(len(ring), z)])
        )
    count = len(ring)
    here, ahead = np.arange(count), (np.arange(count) + 1) % count
    sides = np.concatenate(
        [np.column_stack([here, ahead, ahead + count]), np.column_stack([here, ahead + count, here + count])]
    )
    # the foot has corners of its own: its edge is sharp
    foot = 2 * count + here[1:-1]
    lid = np.column_stack([np.full(count - 2, 2 * count), foot, foot + 1])
    return np.concatenate([*levels, levels[0]]), np.concatenate([sides, lid])
