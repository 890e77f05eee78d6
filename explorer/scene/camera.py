"""Camera presets: where a naval architect stands to look at a ship."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from viser.transforms import SO3

PRESETS = ("perspective", "below", "profile", "plan", "body", "propeller", "backs")
CLOSE_UPS = ("propeller", "backs")
LONG_VIEWS = ("profile", "plan")
TITLES = {
    "perspective": "Perspective",
    "below": "Below",
    "profile": "Profile",
    "plan": "Plan",
    "body": "Body",
    "propeller": "Propeller",
    "backs": "Backs",
}
Array = NDArray[np.float64]
Point = tuple[float, float, float]
_UP: Point = (0.0, 0.0, 1.0)
# part of the picture that stays empty on each side
_MARGIN = 0.04


@dataclass(frozen=True)
class CameraPose:
    """Where the camera stands, what it looks at, what is up, and how wide it sees (vertical angle in rad)."""

    position: Point
    look_at: Point
    up: Point
    field_of_view: float

    def orientation(self) -> tuple[float, float, float, float]:
        """As a quaternion (w, x, y, z) of a camera that looks along its own z with y downwards."""
        forward = np.array(self.look_at) - np.array(self.position)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, np.array(self.up))
        right /= np.linalg.norm(right)
        turn = np.column_stack([right, np.cross(forward, right), forward])
        w, x, y, z = (float(value) for value in SO3.from_matrix(turn).wxyz)
        return w, x, y, z


def preset(
    name: str,
    length: float,
    breadth: float,
    draft: float,
    shaft: tuple[float, float],
    diameter: float,
    aspect: float,
    abeam: float = 0.0,
    lens: float | None = None,
) -> CameraPose:
    """A preset for a ship of this size: all of it in the picture, as large as the 3D view allows.

    Args:
        name: one of PRESETS.
        length, breadth, draft: m.
        shaft: x of the propeller's centre and height of the shaft, m.
        diameter: of the propeller, m.
        aspect: width over height of the 3D view.
        abeam: how far to port another ship lies, m.
        lens: another vertical angle than the preset's own, rad.
    """
    if name in CLOSE_UPS:
        look = (shaft[0] + 0.05 * diameter, 0.0, shaft[1] + 0.02 * diameter)
        reach = 2.0 * diameter * max(1.0, 1.1 / max(aspect, 0.3))
        # from astern the blades show their faces, from ahead their backs
        along = 0.86 if name == "backs" else -0.86
        return CameraPose((look[0] + along * reach, -0.52 * reach, look[2] + 0.10 * reach), look, _UP, 0.75)
    # what has to be seen: from the counter to the bulb, from the keel to the deck of the parent; from ahead, where
    # nothing lies before it, to the bridge
    x0, x1, deck = -0.03 * length, 1.025 * length, (4.2 if name == "body" else 2.4) * draft
    corners = np.array([(x, y, z) for x in (x0, x1) for y in (-breadth / 2, breadth / 2 + abeam) for z in (0.0, deck)])
    # a narrow view looks along the ship more than across it
    side = float(np.interp(aspect, (0.6, 1.8), (0.66, 1.75)))
    # Profile, plan and body use a long lens from far away: nearly the parallel projection of a lines drawing.
    direction, up, own = {
        "profile": ((0.0, -1.0, 0.0), _UP, 0.14),
        "plan": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 0.14),
        "body": ((1.0, 0.0, 0.0), _UP, 0.14),
        "below": ((0.9, -0.9 * side, -0.42), _UP, 0.75),
    }.get(name, ((0.9, -0.9 * side, 0.40), _UP, 0.75))
    return _framed(corners, np.array(direction), up, own if lens is None else lens, aspect)


def nearest_seen(position: Point, framed: tuple[float, float, float], abeam: float = 0.0) -> float:
    """Where a camera may begin to see: a part of its distance from the box that holds the ship, and never far from it.

    The farther away it begins, the finer a graphics card tells two surfaces apart that lie close to each other.

    Args:
        position: the camera's, m.
        framed: length, breadth and draft of the ship, m.
        abeam: how far to port another ship lies, m.
    """
    length, breadth, draft = framed
    low = np.array([-0.03 * length, -0.6 * breadth, 0.0])
    high = np.array([1.04 * length, 0.6 * breadth + abeam, 4.5 * draft])
    place = np.array(position)
    distance = float(np.linalg.norm(place - np.clip(place, low, high)))
    return max(0.15 * distance, 0.0015 * length)


def _framed(corners: Array, direction: Array, up: Point, lens: float, aspect: float) -> CameraPose:
    """The nearest stand in ``direction`` from which all corners lie in the picture, looking at their middle."""
    backward = direction / np.linalg.norm(direction)
    right = np.cross(np.array(up), backward)
    right /= np.linalg.norm(right)
    above = np.cross(backward, right)
    tangents = np.array([np.tan(lens / 2.0) * max(aspect, 0.2), np.tan(lens / 2.0)]) * (1.0 - 2.0 * _MARGIN)
    look = corners.mean(axis=0)
    for _ in range(8):
        # perspective makes the near end larger, so the middle of the picture is not the middle of the ship
        local = corners - look
        across = np.stack([local @ right, local @ above])
        depth = local @ backward
        distance = float((depth + np.abs(across) / tangents[:, None]).max())
        shown = across / (distance - depth)
        middle = 0.5 * (shown.max(axis=1) + shown.min(axis=1))
        look = look + distance * (middle[0] * right + middle[1] * above)
    position = look + distance * backward
    return CameraPose(_point(position), _point(look), up, lens)


def _point(values: Array) -> Point:
    return (float(values[0]), float(values[1]), float(values[2]))
