"""How a design variable is declared: limits, words, symbol, unit, digits, slider and default range in one entry."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

from hpsop_core.case.fields import KEY, FieldRule

_VARIABLE = "variable"
# A length's slider has about five hundred steps to the initial design's own value: 1 cm for a ship, 0.1 mm for a model.
_LENGTH_STEP = 1.0 / 500.0


@dataclass(frozen=True)
class Variable:
    """Everything that is said about one design variable.

    Attributes:
        name: in case files, JSON and Python.
        rule: what it may ever be, whatever the bounds of a case (outside, the parents' families mean nothing), in SI
            units; and its meaning in one line.
        label: what it is, short.
        symbol: what follows an underscore is its subscript.
        unit: of the shown number, which is ``scale`` times the number itself.
        scale: see ``unit``.
        decimals: of the shown number; of a length: at least so many.
        step: of its sliders; None for a length, whose step follows its size.
        bounds: a sensible search around an initial design, as ``spread`` says; two equal numbers fix the variable.
        reach: how far sliders go, as ``spread`` says.
        spread: "factor": times the initial design's value; "shift": added to it; "range": the numbers themselves.
        initial: the initial design's value where a case does not state it.
        bounds_required: whether a case must state its bounds; if not, it is fixed at the initial design's value.
    """

    name: str
    rule: FieldRule
    label: str
    symbol: str
    unit: str
    scale: float
    decimals: int
    step: float | None
    bounds: tuple[float, float]
    reach: tuple[float, float]
    spread: str
    initial: float
    bounds_required: bool

    @property
    def whole(self) -> bool:
        """Whether it is counted."""
        return self.rule.kind == "integer"

    def typed(self, value: float) -> float | int:
        """The number as the design holds it."""
        return round(value) if self.whole else float(value)

    def shown(self, value: float) -> float:
        """The number in ``unit``."""
        return self.scale * value

    def shown_pair(self, pair: tuple[float, float]) -> tuple[float, float]:
        """Two bounds in ``unit``."""
        return self.shown(pair[0]), self.shown(pair[1])

    def from_shown(self, number: float) -> float:
        """The number whose shown one is ``number``, without what floats add to its digits."""
        return round(number / self.scale, 10)

    def step_near(self, value: float) -> float:
        """The step of a slider around an initial design's value."""
        return float(10.0 ** math.floor(math.log10(value * _LENGTH_STEP))) if self.step is None else self.step

    def decimals_near(self, value: float) -> int:
        """Digits after the point of shown numbers around an initial design's value: a slider's step can be seen."""
        if self.step is not None:
            return self.decimals
        return max(self.decimals, round(-math.log10(self.step_near(value))))

    def bounds_near(self, value: float) -> tuple[float, float]:
        """Default bounds around an initial design's value: whole steps, within the rule."""
        if self.bounds[0] == self.bounds[1] and self.spread != "range":
            return value, value
        return self._spread(value, self.bounds, self.step_near(value))

    def reach_near(self, value: float) -> tuple[float, float]:
        """The ends of a slider around an initial design's value, which lies between them."""
        low, high = self._spread(value, self.reach, self.step_near(value) * (1.0 if self.whole else 10.0))
        return min(low, value), max(high, value)

    def _spread(self, value: float, pair: tuple[float, float], grid: float) -> tuple[float, float]:
        """``pair`` around ``value``, rounded outwards to the grid and cut at the rule's limits."""
        low, high = pair
        if self.spread == "factor":
            low, high = low * value, high * value
        elif self.spread == "shift":
            low, high = value + low, value + high
        # what floats leave of a whole number of grid steps is not another step
        low, high = math.floor(low / grid + 1e-6) * grid, math.ceil(high / grid - 1e-6) * grid
        return float(max(round(low, 12), self.rule.lower)), float(min(round(high, 12), self.rule.upper))


def variable(
    label: str,
    symbol: str,
    meaning: str,
    limits: tuple[float, float],
    *,
    bounds: tuple[float, float],
    reach: tuple[float, float],
    initial: float,
    spread: str = "factor",
    unit: str = "",
    shown_unit: str | None = None,
    scale: float = 1.0,
    decimals: int = 3,
    step: float | None = None,
    whole: bool = False,
    initial_meaning: str | None = None,
    bounds_required: bool = False,
) -> Any:
    """A field of ``DesignVariables`` (see ``Variable``); no dataclass default: a design states every variable.

    Args:
        unit: SI unit, or "" for a pure number.
        shown_unit: ``unit`` unless stated.
        initial_meaning: what the field of [initial] means, where it differs.
    """
    rule = FieldRule("integer" if whole else "number", meaning, unit, *limits)
    shown = unit if shown_unit is None else shown_unit
    declared = Variable(
        "", rule, label, symbol, shown, scale, decimals, step, bounds, reach, spread, initial, bounds_required
    )
    in_case = dataclasses.replace(rule, meaning=initial_meaning or meaning, default=initial)
    return dataclasses.field(metadata={KEY: in_case, _VARIABLE: declared})


def declared_variables(declaration: type[Any]) -> dict[str, Variable]:
    """The variables that a dataclass's fields declare, by name, in their order."""
    return {
        field.name: dataclasses.replace(field.metadata[_VARIABLE], name=field.name)
        for field in dataclasses.fields(declaration)
    }
