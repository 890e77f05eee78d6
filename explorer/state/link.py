"""A page in words: what a link says of run, generation, design, view and pins, and nothing that is secret."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

from explorer.state.shown import Shown
from explorer.state.view_options import ViewOptions
from hpsop_core.case.variables import VARIABLE_TABLE, DesignVariables
from hpsop_core.errors import InputError

LONGEST = 1500
"""Letters of a link's query: what is longer is none of ours."""

_MOST_PINS = 4
# what of the 3D view is switched on and off; light or dark, and the size of screenshots, are the reader's own
_SWITCHED = tuple(
    name
    for name, value in dataclasses.asdict(ViewOptions()).items()
    if isinstance(value, bool) and name != "dark" and not name.startswith("picture")
)


@dataclass(frozen=True)
class LinkedDesign:
    """A design that a link names: of the run by its id, the initial one, or a what-if by its variables."""

    design_id: int | None = None
    variables: DesignVariables | None = None
    level: int = 1

    @classmethod
    def of(cls, shown: Shown) -> LinkedDesign:
        """How a link names this one."""
        if shown.design_id is not None:
            return cls(shown.design_id)
        variables = shown.evaluation.variables if shown.kind == "whatif" else None
        return cls(None, variables, shown.evaluation.level)

    @classmethod
    def read(cls, word: str) -> LinkedDesign | None:
        """What a word of a link names; None where it names nothing."""
        if word == "initial":
            return cls()
        if word.isdecimal() and len(word) < 15:
            return cls(int(word))
        level, _, numbers = word.partition("~")
        values = numbers.split("_")
        if level not in ("w1", "w2") or len(values) != len(VARIABLE_TABLE):
            return None
        try:
            named = {
                name: variable.typed(float(value))
                for (name, variable), value in zip(VARIABLE_TABLE.items(), values, strict=True)
            }
            return cls(None, DesignVariables.from_dict(named, "link"), int(level[1]))
        except (InputError, ValueError, OverflowError):
            return None

    def word(self) -> str:
        """As a link writes it."""
        if self.design_id is not None:
            return str(self.design_id)
        if self.variables is None:
            return "initial"
        values = self.variables.as_dict()
        return f"w{self.level}~" + "_".join(f"{values[name]!r}" for name in VARIABLE_TABLE)


@dataclass(frozen=True)
class Link:
    """What a link opens; None or empty: as the page stands.

    Attributes:
        run: the run file's name.
        generation: the one that is looked at.
        design: the selected one.
        pins: side by side.
        options: of the 3D view; its ghost is the initial design.
        tab: the chosen chart.
    """

    run: str = ""
    generation: int | None = None
    design: LinkedDesign | None = None
    pins: tuple[LinkedDesign, ...] = ()
    options: ViewOptions | None = None
    tab: str = ""

    def query(self) -> str:
        """As the query of an address, without its question mark."""
        pairs = [("run", self.run)]
        if self.generation is not None:
            pairs.append(("generation", str(self.generation)))
        if self.design is not None:
            pairs.append(("design", self.design.word()))
        if self.pins:
            pairs.append(("pins", ",".join(pin.word() for pin in self.pins)))
        if self.options is not None:
            shown = [name for name in _SWITCHED if getattr(self.options, name)]
            pairs += [
                ("view", self.options.camera),
                ("show", ",".join(shown)),
                ("at", str(self.options.condition)),
            ]
        pairs.append(("chart", self.tab))
        return urlencode([(name, value) for name, value in pairs if value], quote_via=quote, safe=",~")


def read_link(query: str, cameras: Sequence[str]) -> Link | None:
    """What an address opens; None where it says nothing of ours. What cannot be understood in it is left out.

    Args:
        query: of the address, with or without its question mark: anything that a browser may send.
        cameras: the views there are.
    """
    if len(query) > LONGEST:
        return None
    try:
        words = dict(parse_qsl(query.removeprefix("?"), max_num_fields=20))
    except ValueError:
        return None
    if not {"run", "design", "generation", "pins", "view"} & set(words):
        return None
    pins = [LinkedDesign.read(word) for word in words.get("pins", "").split(",")]
    generation, place = words.get("generation", ""), words.get("at", "0")
    options = None
    if words.get("view") in cameras:
        on = words.get("show", "").split(",")
        flags: dict[str, Any] = {name: name in on for name in _SWITCHED}
        condition = int(place) if place.isdecimal() and len(place) < 3 else 0
        options = dataclasses.replace(ViewOptions(), camera=words["view"], condition=condition, **flags)
    return Link(
        run=words.get("run", "")[:200],
        generation=int(generation) if generation.isdecimal() and 0 < len(generation) < 7 else None,
        design=LinkedDesign.read(words["design"]) if "design" in words else None,
        pins=tuple(pin for pin in pins if pin is not None)[:_MOST_PINS],
        options=options,
        tab=words.get("chart", "")[:40],
    )
