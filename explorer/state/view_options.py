"""What of the design is drawn in 3D."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass


@dataclass(frozen=True)
class ViewOptions:
    """What of the design is drawn in 3D; belongs to a browser.

    ``ghost_of`` is "initial" or the ``name`` of a pinned design; a pin that is gone means the initial design.
    ``beside`` puts the ghost abeam, to port, where neither hull hides the other. ``fittings`` are
    for looks: deck house, cargo, rudder, draught marks. ``wide``: the panels are closed, the ship has the whole window.
    ``picture_*``: of a screenshot; a side of 0 is the window's.
    """

    ghost: bool = False
    ghost_of: str = "initial"
    beside: bool = False
    waves: bool = False
    pressure: bool = False
    spin: bool = False
    hull: bool = True
    topsides: bool = True
    fittings: bool = True
    water: bool = True
    condition: int = 0
    camera: str = "perspective"
    wide: bool = False
    dark: bool = False
    picture_open: bool = False
    picture_width: int = 0
    picture_height: int = 0
    picture_transparent: bool = False

    def picture_size(self, window: tuple[int, int]) -> tuple[int, int]:
        """Of a screenshot in px: what was chosen, else the window's."""
        return (self.picture_width, self.picture_height) if self.picture_width and self.picture_height else window

    def restored(self, saved: object) -> ViewOptions:
        """These with what ``saved`` says, where it says something that an option can be."""
        if not isinstance(saved, dict):
            return self
        known = dataclasses.asdict(ViewOptions())
        taken = {key: value for key, value in saved.items() if key in known and type(value) is type(known[key])}
        return dataclasses.replace(self, **taken)
