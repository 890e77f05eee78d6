"""What the page asks of hpsop_core about one design: numbers, curves, lines and meshes, each remembered.

Nothing here knows viser. Every answer depends on the case and the variables alone, so it is kept in small caches that
all browsers share; memory stays flat however many designs are looked at.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar

import numpy as np

from explorer.charts.curves import DesignCurves
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.curves import FROUDE_STEP, HullLines, hull_lines, resistance_points, thrust_curves
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation

Value = TypeVar("Value")
# Charts end soon after the fastest condition; level 1 follows every hump of the wave resistance.
_FROUDE_ABOVE = 0.025
_FROUDE_STEP = {1: 0.004, 2: FROUDE_STEP}


class Remembered(Generic[Value]):
    """A small least-recently-used cache that computes a missing value once, even when two threads ask."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._values: OrderedDict[Hashable, Value] = OrderedDict()
        self._guards: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def get(self, key: Hashable, compute: Callable[[], Value]) -> Value:
        """The value under ``key``; ``compute`` makes it where it is not there (an error is not remembered)."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key]
            guard = self._guards.setdefault(key, threading.Lock())
        with guard:
            with self._lock:
                if key in self._values:
                    return self._values[key]
            try:
                value = compute()
            finally:
                with self._lock:
                    self._guards.pop(key, None)
            with self._lock:
                self._values[key] = value
                while len(self._values) > self._size:
                    self._values.popitem(last=False)
            return value

    def peek(self, key: Hashable) -> Value | None:
        """The value if it is there."""
        with self._lock:
            return self._values.get(key)


class Physics:
    """Answers about designs of any case."""

    def __init__(self) -> None:
        self._references: Remembered[Reference] = Remembered(8)
        self._evaluations: Remembered[Evaluation] = Remembered(400)
        self._curves: Remembered[DesignCurves] = Remembered(60)
        self._lines: Remembered[HullLines] = Remembered(60)
        self._fields: Remembered[Any] = Remembered(6)

    def reference(self, case: Case, level: int) -> Reference:
        """The initial design's numbers at a level (at level 2, or with calibration by it, this takes a second)."""
        return self._references.get((case, level), lambda: reference_for(case, level))

    def evaluate(self, case: Case, variables: DesignVariables, level: int) -> Evaluation:
        """A design's evaluation."""
        key = (case, level, variables.key())
        return self._evaluations.get(key, lambda: evaluate(case, variables, level, self.reference(case, level)))

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
        thrust = thrust_curves(case, evaluation, points)
        return DesignCurves(
            froude_number=thrust.froude_number,
            speed=np.array([point.speed for point in points]),
            total_resistance=np.array([point.total_resistance for point in points]),
            wave_resistance=np.array([point.wave_resistance for point in points]),
            thrust_required=thrust.required,
            thrust_available=thrust.available,
            level=evaluation.level,
        )

    def lines(self, case: Case, variables: DesignVariables) -> HullLines:
        """Sections and sectional areas.

        Raises:
            SolverFailure: the form cannot be made.
        """
        return self._lines.get((case, variables.key()), lambda: hull_lines(case, variables))
