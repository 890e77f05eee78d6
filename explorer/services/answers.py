"""What the page asks of hpsop_core about one design: numbers, curves and lines, each remembered.

Nothing here knows viser, and nothing is computed here. Every answer depends on the case and the variables alone, so it
is kept in small caches that all browsers share; memory stays flat however many designs are looked at.
"""

from __future__ import annotations

from collections.abc import Callable

from explorer.services.remembered import Remembered
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.curves import DesignCurves, HullLines, hull_lines, resistance_points, thrust_curves
from hpsop_core.evaluation.errors import evaluate_with_errors
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.evaluation.shipped_calibration import LEARNT, shipped
from hpsop_core.geometry.hull.lines import HullLine, plan_lines

# Charts end soon after the fastest condition. Level 1 follows every hump of the wave resistance; one speed of level 2
# costs more than all of these.
_FROUDE_ABOVE = 0.025
_FROUDE_STEP = {1: 0.004, 2: 0.015}

# hulls whose sections are remembered, 40 kB each; a chart of more would cut them again for ever
MOST_LINES = 240


class Answers:
    """Answers about designs of any case."""

    def __init__(self) -> None:
        self._references: Remembered[Reference] = Remembered(8)
        self._evaluations: Remembered[Evaluation] = Remembered(400)
        self._refined: Remembered[Evaluation] = Remembered(400)
        self._curves: Remembered[DesignCurves] = Remembered(60)
        self._lines: Remembered[HullLines] = Remembered(MOST_LINES)
        self._plans: Remembered[tuple[HullLine, ...]] = Remembered(24)

    def reference(self, case: Case, level: int) -> Reference:
        """The initial design's numbers at a level (at level 2, or with calibration by it, this takes a second)."""
        return self._references.get(self._standing(case, level), lambda: self._compute_reference(case, level))

    def take(self, case: Case, level: int, reference: Callable[[], Reference | None]) -> None:
        """Answer with a run's own reference from now on, where it has one."""
        if self._references.peek((case, level)) is None:
            own = reference()
            if own is not None:
                self._references.get((case, level), lambda: own)

    def _standing(self, case: Case, level: int) -> tuple[object, ...]:
        """Under what a case's reference is remembered: (case, level), or as a makeshift until a run has learnt."""
        known = self._references.peek((case, level)) is not None
        return (case, level) if known or not self._is_unlearnt(case, level) else (case, level, "one factor")

    def _is_unlearnt(self, case: Case, level: int) -> bool:
        learns = level == FAST.number and case.constants.wave_calibration == "learnt"
        return learns and shipped(case, LEARNT) is None

    def _compute_reference(self, case: Case, level: int) -> Reference:
        if self._is_unlearnt(case, level):
            # A run learns when it begins. Settings that are being edited cannot wait for dozens of hulls at every
            # change; the initial design has its level-2 value either way.
            case = case.replaced("constants", wave_calibration="level2")
        return reference_for(case, level)

    def evaluate(self, case: Case, variables: DesignVariables, level: int) -> Evaluation:
        """A design's evaluation."""
        key = (*self._standing(case, level), variables.key())
        return self._evaluations.get(key, lambda: evaluate(case, variables, level, self.reference(case, level)))

    def refined(self, case: Case, variables: DesignVariables) -> Evaluation:
        """A design of level 2 with its own errors, from finer solutions."""

        def compute() -> Evaluation:
            return evaluate_with_errors(case, variables, TRUTH.number, self.reference(case, TRUTH.number))

        return self._refined.get((case, variables.key()), compute)

    def known_refined(self, case: Case, variables: DesignVariables) -> Evaluation | None:
        """The same where it has been computed."""
        return self._refined.peek((case, variables.key()))

    def initial(self, case: Case, level: int) -> Evaluation:
        """The initial design's evaluation."""
        return self.evaluate(case, case.initial.variables, level)

    def curves(self, case: Case, evaluation: Evaluation) -> DesignCurves:
        """Resistance and thrust over a range of Froude numbers.

        Raises:
            SolverFailure: the design has no numbers.
        """
        key = (case, evaluation.level, evaluation.variables.key())
        return self._curves.get(key, lambda: self._compute_curves(case, evaluation))

    def known_curves(self, case: Case, evaluation: Evaluation) -> DesignCurves | None:
        """The same if it has been computed already."""
        return self._curves.peek((case, evaluation.level, evaluation.variables.key()))

    def _compute_curves(self, case: Case, evaluation: Evaluation) -> DesignCurves:
        reference = self.reference(case, evaluation.level)
        points = resistance_points(case, evaluation, reference, _FROUDE_ABOVE, _FROUDE_STEP[evaluation.level])
        return DesignCurves(points, thrust_curves(case, evaluation, points))

    def lines(self, case: Case, variables: DesignVariables) -> HullLines:
        """Sections and sectional areas.

        Raises:
            SolverFailure: the form cannot be made.
        """
        return self._lines.get((case, variables.key()), lambda: hull_lines(case, variables))

    def known_lines(self, case: Case, variables: DesignVariables) -> HullLines | None:
        """The same if they have been cut already."""
        return self._lines.peek((case, variables.key()))

    def plan(self, case: Case, variables: DesignVariables) -> tuple[HullLine, ...]:
        """Lines of the lines plan.

        Raises:
            SolverFailure: the form cannot be made.
        """
        key = (case, variables.key())
        return self._plans.get(key, lambda: tuple(plan_lines(design_hull(case, variables), "view")))

    def known_plan(self, case: Case, variables: DesignVariables) -> tuple[HullLine, ...] | None:
        """The same if it has been cut already."""
        return self._plans.peek((case, variables.key()))
