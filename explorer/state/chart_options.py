"""What a browser's charts of a run show."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

_MOST_AXES = 100


@dataclass(frozen=True)
class ChartOptions:
    """What the scatter chart and the parallel coordinates show; belongs to a browser. Quantities stand by their keys.

    Attributes:
        x, y: of the scatter chart.
        colour, size: what its points' colour and size tell; "" for nothing.
        axes: order of the parallel coordinates' axes as a person has dragged them; those not named follow.
        axis_colour: what the colour of their lines tells; "" for nothing.
    """

    x: str = "length"
    y: str = "delivered_power_1"
    colour: str = "propeller_diameter"
    size: str = ""
    axes: tuple[str, ...] = ()
    axis_colour: str = ""

    def restored(self, saved: object) -> ChartOptions:
        """These with what ``saved`` says, where it says something sensible."""
        if not isinstance(saved, dict):
            return self
        words = {
            name: saved[name]
            for name in ("x", "y", "colour", "size", "axis_colour")
            if isinstance(saved.get(name), str) and len(saved[name]) <= 80
        }
        axes = saved.get("axes")
        if isinstance(axes, list | tuple) and all(isinstance(key, str) for key in axes):
            words["axes"] = tuple(axes)[:_MOST_AXES]
        return dataclasses.replace(self, **words)
