"""What the algorithm is told about an evaluated design: always finite, with failures as infeasible designs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hpsop_core.case.constraints import FEASIBILITY_TOLERANCE
from hpsop_core.case.variables import DesignVariables
from hpsop_core.typing_aliases import Array

FAILED_OBJECTIVE = 1e3
"""What a failed evaluation shows as either objective; the normalised objectives are of order one."""

FAILED_VIOLATION = 1e6
"""The constraint violation of a failed evaluation: finite, and worse than anything a computed design shows."""

UNNAMED_VIOLATION = 0.1
"""Violation of a computed design that is called infeasible although every constraint it shows is kept."""


@dataclass(frozen=True)
class Candidate:
    """A design that the algorithm wants evaluated.

    Attributes:
        level: fidelity level, 1 or 2.
        variables: the decoded design.
        origin: "initial", "sample", "seed", "offspring", "handover", "reseed" or "renewal".
        surface: 0: to be solved; n: the nth learnt surface may answer for the solvers, where it is not in doubt.
    """

    level: int
    variables: DesignVariables
    origin: str
    surface: int = 0

    @property
    def key(self) -> tuple[float, ...]:
        """The exact numbers that name this evaluation: the level and the decoded variables."""
        return (float(self.level), *self.variables.key())


@dataclass(frozen=True)
class Outcome:
    """What an evaluation came to, as far as the algorithm cares.

    Attributes:
        evaluation_id: the evaluation's number in the run.
        objectives: (f1, f2), never penalised; None if the evaluation failed.
        violations: max(0, g) for each constraint that applies, and for infeasibility outside them.
        feasible: every g <= ``FEASIBILITY_TOLERANCE`` and nothing else against the design.
        cavitation: g3 with its sign, None where it is not applied.
        predicted: a learnt surface's answer, not the solvers'.
    """

    evaluation_id: int
    objectives: tuple[float, float] | None
    violations: tuple[float, ...]
    feasible: bool
    cavitation: float | None = None
    predicted: bool = False

    @property
    def failed(self) -> bool:
        """Whether there are no objectives."""
        return self.objectives is None

    @classmethod
    def from_json(cls, evaluation_id: int, data: Mapping[str, Any]) -> Outcome:
        """The outcome in an evaluation's JSON (``hpsop evaluate --json``); anything not finite counts as failed."""
        failed = cls(evaluation_id, None, (), False)
        if data.get("status") != "ok":
            return failed
        f1, f2 = data["objectives"]["f1"], data["objectives"]["f2"]
        constraints = [g for g in data["constraints"].values() if g is not None]
        if f1 is None or f2 is None or not all(math.isfinite(value) for value in (f1, f2, *constraints)):
            return failed
        within = all(g <= FEASIBILITY_TOLERANCE for g in constraints)
        feasible = within and bool(data["feasible"])
        violations = tuple(max(0.0, float(g)) for g in constraints)
        if within and not feasible:
            violations = (*violations, UNNAMED_VIOLATION)
        cavitation, predicted = data["constraints"].get("cavitation"), bool(data.get("predicted"))
        margin = None if cavitation is None else float(cavitation)
        return cls(evaluation_id, (float(f1), float(f2)), violations, feasible, margin, predicted)

    def violation(self, cavitation_margin: float) -> float:
        """Sum of the violations when Keller's criterion must be kept by a margin, in expanded area ratio."""
        total = math.fsum(self.violations)
        if self.cavitation is None:
            return total
        return total + max(0.0, self.cavitation + cavitation_margin) - max(0.0, self.cavitation)


def algorithm_view(
    outcomes: list[Outcome], handling: str, penalty_factor: float, cavitation_margin: float = 0.0
) -> tuple[Array, Array]:
    """Objectives and constraint values as NSGA-II sees them; always finite.

    With ``handling`` "penalty" (the paper) F_i = f_i + penalty_factor * sum max(0, g_j) and only a failed evaluation
    is infeasible. With "feasibility_first" F_i = f_i, and the sum of the violations is the constraint: a feasible
    design beats an infeasible one, of two infeasible ones the lesser violation wins (Deb et al. 2002).

    With a margin the *search* asks g3 + margin <= 0, where g3 is applied; what is reported stays g3.

    Args:
        outcomes: n outcomes.
        handling: "penalty" or "feasibility_first".
        penalty_factor: of the penalty.
        cavitation_margin: in expanded area ratio.

    Returns:
        F of shape (n, 2) and G of shape (n, 1); a design is infeasible for the algorithm if G > 0.
    """
    objectives = np.full((len(outcomes), 2), FAILED_OBJECTIVE)
    constraint = np.full((len(outcomes), 1), FAILED_VIOLATION)
    for row, outcome in enumerate(outcomes):
        if outcome.objectives is None:
            continue
        violation = outcome.violation(cavitation_margin)
        if handling == "penalty":
            objectives[row] = np.array(outcome.objectives) + penalty_factor * violation
            constraint[row] = 0.0
        else:
            objectives[row] = outcome.objectives
            constraint[row] = 0.0 if outcome.feasible and violation <= FEASIBILITY_TOLERANCE else violation
    return objectives, constraint
