"""A ship of the user's own on its way to a case: its files, what was said about them, what was understood."""

from __future__ import annotations

from dataclasses import dataclass, field

from hpsop_core.geometry.hull.input import HullFile, ReadOptions
from hpsop_core.geometry.propeller.input import UnderstoodPropeller


@dataclass(frozen=True, eq=False)
class UserFile:
    """A file that somebody brought: its name, for people, and its bytes."""

    name: str
    content: bytes


@dataclass(frozen=True, eq=False)
class OwnShip:
    """The ship that is being brought in; all browsers share it, as they share the case that it becomes.

    Attributes:
        hull, propeller: the files, or None.
        options: what was said about the hull's file.
        shaft_height, boss_x: said about the propeller's place, m; None leaves it to the file.
        blades: said about the propeller's table.
        read: what was understood of the hull, or None; while ``reading``, by what was said before.
        read_propeller: the same of the propeller.
        trouble, propeller_trouble: why a file cannot be used, or "".
        reading: whether a file is being read.
        seconds: that the last reading took.
    """

    hull: UserFile | None = None
    propeller: UserFile | None = None
    options: ReadOptions = field(default_factory=ReadOptions)
    shaft_height: float | None = None
    boss_x: float | None = None
    blades: int = 4
    read: HullFile | None = None
    read_propeller: UnderstoodPropeller | None = None
    trouble: str = ""
    propeller_trouble: str = ""
    reading: bool = False
    seconds: float = 0.0
