"""What a user says about a hull file beside its name, and what comes out of every reader."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array, IntArray

# Metres in a unit of length. "ft-in-8" is the shipyard's feet-inches-eighths.
UNITS = {"m": 1.0, "mm": 0.001, "cm": 0.01, "ft": 0.3048, "in": 0.0254, "ft-in-8": 0.3048}
BOWS = ("auto", "+x", "-x")
ORIGINS = ("auto", "ap", "midship", "fp")
WATERLINES = ("auto", "draft", "z0")
UPS = ("auto", "z", "-z", "y", "-y")
_CHOICES = {"bow": BOWS, "origin": ORIGINS, "waterline": WATERLINES, "up": UPS}


@dataclass(frozen=True)
class Axes:
    """How a file's axes lie in the ship; "auto" is what the file itself says, else the habit of this program.

    Attributes:
        bow: the end of x at which the bow is: "+x" or "-x".
        origin: where x = 0 is: "ap", "midship" or "fp".
        waterline: what z = 0 is: "draft", the baseline with the still water at the draft, or "z0", the still water
            itself.
        up: the axis of a mesh that points up: "z", "-z", "y" or "-y".
    """

    bow: str = "auto"
    origin: str = "auto"
    waterline: str = "auto"
    up: str = "auto"

    def __post_init__(self) -> None:
        for name, allowed in _CHOICES.items():
            value = getattr(self, name)
            if value not in allowed:
                raise InputError(f"axes: {name} '{value}' is unknown; choose one of {', '.join(allowed)}")

    @classmethod
    def from_words(cls, words: str) -> Axes:
        """Axes from "bow=-x,origin=fp,waterline=z0", in any order; what is not stated stays "auto".

        Raises:
            InputError: an unknown name or value.
        """
        axes = cls()
        for word in filter(None, (part.strip() for part in words.split(","))):
            name, _, value = (part.strip().lower() for part in word.partition("="))
            if name not in _CHOICES:
                known = "; ".join(f"{key} {', '.join(values[1:])}" for key, values in _CHOICES.items())
                raise InputError(
                    f"axes: '{word}' is unknown; write for example bow=-x,origin=fp,waterline=z0 ({known})"
                )
            axes = replace(axes, **{name: value})
        return axes


@dataclass(frozen=True)
class ReadOptions:
    """What the user states about a hull file; None and "auto" leave it to the file.

    Attributes:
        length: Lpp, m.
        draft: still water above the baseline, m.
        breadth: moulded, m; needed by a table in fractions of B/2 that does not state it.
        unit: of the file's lengths, a key of ``UNITS``.
        axes: see ``Axes``.
    """

    length: float | None = None
    draft: float | None = None
    breadth: float | None = None
    unit: str | None = None
    axes: Axes = field(default_factory=Axes)

    def __post_init__(self) -> None:
        for name in ("length", "draft", "breadth"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise InputError(f"{name} must be a positive number of metres, not {value}")
        if self.unit is not None and self.unit not in UNITS:
            raise InputError(f"unit '{self.unit}' is unknown; choose one of {', '.join(UNITS)}")


@dataclass(frozen=True, eq=False)
class FileTable:
    """A rectangular table as it stands in a file, in the file's own axes but in metres.

    Attributes:
        name: of the file.
        layout: what kind of table it is, in words.
        x: (nx,) stations in the order of the file, in m, or station numbers where ``spacing`` is not None.
        z: (nz,) heights, m, or fractions of the draft.
        y: (nx, nz) half-breadths >= 0, m, or fractions of B/2.
        rows: (nx, nz) line of the file that holds each reading.
        numbered: x holds station numbers instead of lengths.
        fractions: z and y are fractions of draft and B/2.
        stated: what the file itself states: "length", "draft", "breadth", "length_to_breadth", "breadth_to_draft",
            "spacing", each a number; and "origin", "bow", "waterline" as words.
        unit: of the file's lengths.
        notes: what was assumed or noticed, one line each.
    """

    name: str
    layout: str
    x: Array
    z: Array
    y: Array
    rows: IntArray
    numbered: bool
    fractions: bool
    stated: dict[str, float | str]
    unit: str
    notes: tuple[str, ...]

    def noted(self, *notes: str) -> FileTable:
        """The same table with further notes."""
        return replace(self, notes=(*self.notes, *notes))


def listed(words: Sequence[str]) -> str:
    """ "a, b and c"."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
