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

from explorer.charts.curves import DesignCurves, HullLines
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.curves import resistance_curve
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.shapes import design_hull

Value = TypeVar("Value")
# The classic twenty, halved towards the ends where the form changes fast, and the bulb ahead of FP.
_STATIONS = np.array([-0.2, 0.0, 0.5, 1.0, 1.5, *range(2, 19), 18.5, 19.0, 19.5, 20.0, 20.2])
_FROUDE_POINTS = {1: 33, 2: 9}


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
        if not evaluation.conditions or evaluation.hull is None or evaluation.open_water is None:
            raise SolverFailure("curves", evaluation.reason or "the design has no numbers")
        own = [condition.froude_number for condition in evaluation.conditions]
        low, high = max(0.10, min(own) - 0.05), max(own) + 0.025
        froude = np.unique(np.concatenate([np.linspace(low, high, _FROUDE_POINTS[evaluation.level]), own]))
        points = resistance_curve(
            case, evaluation.variables, evaluation.level, tuple(froude.tolist()), self.reference(case, evaluation.level)
        )
        speed = np.array([point.speed for point in points])
        total = np.array([point.total_resistance for point in points])
        first = evaluation.conditions[0]
        open_water = evaluation.open_water
        available = []
        for condition in evaluation.conditions:
            rate = condition.rotation_rate_rpm / 60.0
            diameter = evaluation.variables.diameter
            advance = speed * (1.0 - condition.wake_fraction) / (rate * diameter)
            kt = np.interp(
                advance, open_water.advance_coefficient, open_water.thrust_coefficient, left=np.nan, right=np.nan
            )
            available.append(case.constants.density * rate**2 * diameter**4 * kt)
        return DesignCurves(
            froude_number=np.array([point.froude_number for point in points]),
            speed=speed,
            total_resistance=total,
            wave_resistance=np.array([point.wave_resistance for point in points]),
            thrust_required=total / (1.0 - first.thrust_deduction),
            thrust_available=tuple(available),
            level=evaluation.level,
        )

    def lines(self, case: Case, variables: DesignVariables) -> HullLines:
        """Sections and sectional areas.

        Raises:
            SolverFailure: the form cannot be made.
        """
        return self._lines.get((case, variables.key()), lambda: _hull_lines(case, variables))


def _hull_lines(case: Case, variables: DesignVariables) -> HullLines:
    hull = design_hull(case, variables)
    cut = zip(_STATIONS, hull.sections(_STATIONS / 20.0 * hull.length, points=29), strict=True)
    sections = [(float(station), tuple(line[:, 1:] for line in lines)) for station, lines in cut if lines]
    hydrostatics = hull.hydrostatics
    return HullLines(
        sections=tuple(sections),
        area_x=np.asarray(hydrostatics.sectional_area_x) / hull.length,
        area=np.asarray(hydrostatics.sectional_area),
        draft=hull.draft,
        length=hull.length,
    )
