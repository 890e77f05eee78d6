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
        needs: fields of the case ("section.field") without which its numbers do not exist.
    """

    name: str
    label: str
    formula: str
    words: str
    value: Formula
    needs: tuple[str, ...] = ()

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


def _over_profile(design: DesignNumbers, initial: InitialNumbers, name: str) -> tuple[float, float] | None:
    """Sum of w x over the conditions: the design's and the initial design's."""
    pairs = _pairs(design, initial, name)
    if pairs is None:
        return None
    return math.fsum(w * own for w, own, _ in pairs), math.fsum(w * first for w, _, first in pairs)


def _fuel(design: DesignNumbers, initial: InitialNumbers) -> float | None:
    burnt = _over_profile(design, initial, "fuel_rate")
    return None if burnt is None else burnt[0] / burnt[1]


def _fuel_per_transport_work(design: DesignNumbers, initial: InitialNumbers) -> float | None:
    burnt, sailed = (_over_profile(design, initial, name) for name in ("fuel_rate", "speed"))
    cargo = _deadweight(design, initial)
    if burnt is None or sailed is None or cargo is None:
        return None
    return burnt[0] / burnt[1] * sailed[1] / sailed[0] * cargo


def _deadweight(design: DesignNumbers, initial: InitialNumbers) -> float | None:
    own, first = design.hull.deadweight, initial.hull.get("deadweight")
    return None if own is None or first is None else first / own


def _metacentric_height(design: DesignNumbers, initial: InitialNumbers) -> float | None:
    own, first = design.hull.metacentric_height, initial.hull.get("metacentric_height")
    return None if own is None or first is None else 2.0 - own / first


def _cavitation_margin(design: DesignNumbers, initial: InitialNumbers) -> float:
    area_ratio = design.propeller.expanded_area_ratio
    return 1.0 - (area_ratio - design.conditions[0].required_expanded_area_ratio) / area_ratio


_FUEL = ("engine.maximum_continuous_rating", "engine.specific_fuel_consumptions")

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
        words="1 minus the margin of blade area over what the cavitation criterion requires at the first condition",
        value=_cavitation_margin,
    ),
    Objective(
        name="fuel",
        label="fuel",
        formula="Σ w ṁ/Σ w ṁ₀",
        words="the main engine's fuel over the operating profile, over the initial design's",
        value=_fuel,
        needs=_FUEL,
    ),
    Objective(
        name="fuel_per_transport_work",
        label="fuel per transport work",
        formula="(Σ w ṁ/(DWT Σ w V))/(…)₀",
        words="fuel over the profile per deadweight and distance sailed, over the initial design's",
        value=_fuel_per_transport_work,
        needs=(*_FUEL, "loading.lightship_mass"),
    ),
    Objective(
        name="deadweight",
        label="deadweight",
        formula="DWT₀/DWT",
        words="the initial design's deadweight over the design's (less is better)",
        value=_deadweight,
        needs=("loading.lightship_mass",),
    ),
    Objective(
        name="metacentric_height",
        label="metacentric height",
        formula="2 − GM/GM₀",
        words="2 minus the metacentric height over the initial design's (less is better: a stiffer ship)",
        value=_metacentric_height,
        needs=("loading.centre_of_gravity_height",),
    ),
)

OBJECTIVE_NAMES = tuple(objective.name for objective in OBJECTIVES)


def objective_named(name: str) -> Objective:
    """The objective of a name that a case may state."""
    return OBJECTIVES[OBJECTIVE_NAMES.index(name)]
