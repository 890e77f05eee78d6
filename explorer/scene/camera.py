"""Camera presets: where a naval architect stands to look at a ship."""

from __future__ import annotations

from dataclasses import dataclass

PRESETS = ("perspective", "profile", "plan", "body", "propeller")
TITLES = {"perspective": "Perspective", "profile": "Profile", "plan": "Plan", "body": "Body", "propeller": "Propeller"}
Point = tuple[float, float, float]


@dataclass(frozen=True)
class CameraPose:
    """Where the camera stands, what it looks at, what is up, and how wide it sees (vertical angle in rad)."""

    position: Point
    look_at: Point
    up: Point
    field_of_view: float


def preset(
    name: str, length: float, breadth: float, draft: float, shaft: tuple[float, float], diameter: float, aspect: float
) -> CameraPose:
    """A preset for a ship of this size.

    Args:
        name: one of PRESETS.
        length, breadth, draft: m.
        shaft: x of the boss's end and height of the shaft, m.
        diameter: of the propeller, m.
        aspect: width over height of the 3D view.
    """
    middle = (0.5 * length, 0.0, 0.9 * draft)
    up: Point = (0.0, 0.0, 1.0)
    # Profile, plan and body use a long lens from far away: nearly the parallel projection of a lines drawing.
    lens = 0.14

    def distance(width: float, height: float) -> float:
        wanted = max(height, width / max(aspect, 0.2))
        return 0.5 * wanted / 0.0701

    if name == "profile":
        away = distance(1.12 * length, 3.0 * draft)
        return CameraPose((middle[0], -away, middle[2]), middle, up, lens)
    if name == "plan":
        away = distance(1.12 * length, 1.6 * breadth)
        return CameraPose((middle[0], 0.0, middle[2] + away), middle, (0.0, 1.0, 0.0), lens)
    if name == "body":
        away = distance(1.5 * breadth, 2.6 * draft)
        look = (0.5 * length, 0.0, 0.95 * draft)
        return CameraPose((look[0] + away, 0.0, look[2]), look, up, lens)
    if name == "propeller":
        look = (shaft[0] - 0.1 * diameter, 0.0, shaft[1])
        reach = 2.1 * diameter * max(1.0, 1.1 / max(aspect, 0.3))
        return CameraPose((look[0] - 0.86 * reach, -0.52 * reach, look[2] + 0.10 * reach), look, up, 0.75)
    reach = 0.66 * length * max(1.0, 1.7 / max(aspect, 0.3))
    look = (0.53 * length, 0.0, 0.6 * draft)
    return CameraPose((look[0] + 0.62 * reach, -1.08 * reach, look[2] + 0.42 * reach), look, up, 0.75)
