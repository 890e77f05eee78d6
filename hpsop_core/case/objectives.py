"""The objectives, each declared once: a case chooses two of them by name.

All are minimised; each but the cavitation margin is 1 for the initial design at the same level. To add one, add an
entry to ``OBJECTIVES``: the case's choices, the page, the report and the reference of the case file follow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from hpsop_core.case.design_numbers import DesignNumbers, InitialNumbers

Formula: TypeAlias = Callable[[DesignNumbers, InitialNumbers], float | None]
"""(a design's numbers, the initial design's) -> the objective; None where the numbers for it are missing."""


@dataclass(frozen=True)
class Objective:
    """An objective; less is better.

    Attributes:
        name: in the case file.
        label: short, for an axis.
        formula: as people write it.
        words: one clause that says what it is.
        value: the formula.
    """

    name: str
    label: str
    formula: str
    words: str
    value: Formula

    @property
    def title(self) -> str:
        """Label and formula."""
        return f"{self.label}, {self.formula}"


def over_initial(name: str) -> Formula:
    """sum w x/x0 over the conditions, for a number x of which less is better.

    Args:
        name: of a ``ConditionResult``'s field.
    """

    def formula(design: DesignNumbers, initial: InitialNumbers) -> float | None:
        pairs = _pairs(design, initial, name)
        return None if pairs is None else math.fsum(weight * own / first for weight, own, first in pairs)

    return formula


def initial_over(name: str) -> Formula:
    """sum w x0/x over the conditions, for a number x of which more is better.

    Args:
        name: of a ``ConditionResult``'s field.
    """

    def formula(design: DesignNumbers, initial: InitialNumbers) -> float | None:
        pairs = _pairs(design, initial, name)
        return None if pairs is None else math.fsum(weight * first / own for weight, own, first in pairs)

    return formula


def _pairs(design: DesignNumbers, initial: InitialNumbers, name: str) -> list[tuple[float, float, float]] | None:
    """(weight, the design's number, the initial design's) at each condition; None if one is missing."""
    first = initial.conditions.get(name)
    own = [getattr(condition, name) for condition in design.conditions]
    if first is None or None in own:
        return None
    weights = [condition.weight for condition in design.conditions]
    return list(zip(weights, own, first, strict=True))


def _displacement(design: DesignNumbers, initial: InitialNumbers) -> float:
    return initial.displaced_volume / design.displaced_volume


def _cavitation_margin(design: DesignNumbers, initial: InitialNumbers) -> float:
    area_ratio = design.propeller.expanded_area_ratio
    return 1.0 - (area_ratio - design.conditions[0].required_expanded_area_ratio) / area_ratio


OBJECTIVES: tuple[Objective, ...] = (
    Objective(
        name="resistance",
        label="resistance",
        formula="Σ w R/R₀",
        words="total resistance over the initial design's, weighted sum over the conditions",
        value=over_initial("total_resistance"),
    ),
    Objective(
        name="efficiency",
        label="efficiency",
        formula="Σ w η₀/η",
        words="the initial design's open-water efficiency over the design's, weighted sum (less is better)",
        value=initial_over("open_water_efficiency"),
    ),
    Objective(
        name="delivered_power",
        label="delivered power",
        formula="Σ w P/P₀",
        words="delivered power over the initial design's, weighted sum",
        value=over_initial("delivered_power"),
    ),
    Objective(
        name="displacement",
        label="displacement",
        formula="∇₀/∇",
        words="the initial design's displacement over the design's (less is better)",
        value=_displacement,
    ),
    Objective(
        name="cavitation_margin",
        label="cavitation margin",
        formula="1 − (EAR − EARreq)/EAR",
        words="1 minus the margin of blade area over Keller's requirement at the first condition",
        value=_cavitation_margin,
    ),
)

OBJECTIVE_NAMES = tuple(objective.name for objective in OBJECTIVES)


def objective_named(name: str) -> Objective:
    """The objective of a name that a case may state."""
    return OBJECTIVES[OBJECTIVE_NAMES.index(name)]
