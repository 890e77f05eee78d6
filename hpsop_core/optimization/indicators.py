"""How good a front is: non-dominated designs, hypervolume, spread, share of feasible designs."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence

import numpy as np

from hpsop_core.optimization.problem import Outcome

REFERENCE_POINT = (1.2, 1.2)
"""The hypervolume's reference point; the initial design stands at (1, 1)."""


class FrontArchive:
    """The non-dominated feasible designs of everything seen so far, ascending in the first objective.

    A design that another one equals or beats in both objectives is not in the front; of equal ones the first stays.
    """

    def __init__(self) -> None:
        self._first: list[float] = []
        self._second: list[float] = []
        self._ids: list[int] = []

    def add(self, outcomes: Iterable[Outcome]) -> None:
        """Offer designs, in order; infeasible and failed ones are ignored."""
        for outcome in outcomes:
            if outcome.feasible and outcome.objectives is not None:
                self._insert(outcome.objectives, outcome.evaluation_id)

    def _insert(self, objectives: tuple[float, float], evaluation_id: int) -> None:
        first, second = objectives
        place = bisect_left(self._first, first)
        # Along the front the second objective falls as the first one grows: the left neighbour is the best rival.
        if place > 0 and self._second[place - 1] <= second:
            return
        if place < len(self._first) and self._first[place] == first and self._second[place] <= second:
            return
        end = place
        while end < len(self._first) and self._second[end] >= second:
            end += 1
        self._first[place:end] = [first]
        self._second[place:end] = [second]
        self._ids[place:end] = [evaluation_id]

    @property
    def ids(self) -> tuple[int, ...]:
        """The evaluations on the front, ascending in the first objective."""
        return tuple(self._ids)

    @property
    def objectives(self) -> list[tuple[float, float]]:
        """(f1, f2) of the front, in the order of ``ids``."""
        return list(zip(self._first, self._second, strict=True))


def hypervolume(front: Sequence[tuple[float, float]], reference_point: tuple[float, float] = REFERENCE_POINT) -> float:
    """The area that a front dominates below the reference point; exact for two objectives.

    Args:
        front: (f1, f2) of any designs; dominated ones and ones beyond the reference point add nothing.
        reference_point: the worst corner.

    Returns:
        The area, 0 for an empty front.
    """
    area = 0.0
    lowest = reference_point[1]
    for first, second in sorted(front):
        if first < reference_point[0] and second < lowest:
            area += (reference_point[0] - first) * (lowest - second)
            lowest = second
    return area


def spread(front: Sequence[tuple[float, float]]) -> float | None:
    """How unevenly the designs stand along a front: 0 is even, about 1 is random.

    Deb et al. 2002 (IEEE Trans. Evol. Comp. 6, 182), equation for Delta, without the distances to the unknown ends of
    the true front; objectives are scaled by the front's own ranges first.

    Args:
        front: (f1, f2), ascending in f1.

    Returns:
        The spread, or None for fewer than three designs.
    """
    if len(front) < 3:
        return None
    points = np.array(front)
    ranges = np.ptp(points, axis=0)
    points = points / np.where(ranges > 0.0, ranges, 1.0)
    gaps = np.hypot(*np.diff(points, axis=0).T)
    mean = float(np.mean(gaps))
    if mean == 0.0:
        return 0.0
    return float(np.sum(np.abs(gaps - mean)) / (len(gaps) * mean))


def feasible_share(outcomes: Sequence[Outcome]) -> float:
    """The share of feasible designs, 0 to 1; 0 for none at all."""
    if not outcomes:
        return 0.0
    return sum(outcome.feasible for outcome in outcomes) / len(outcomes)
