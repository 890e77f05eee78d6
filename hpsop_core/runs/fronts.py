"""The front that people are shown: the best of everything that a level has evaluated, not of its last population alone.

NSGA-II keeps a population of fixed size and gives up good designs when it is full; the run's file keeps them. So the
front of a generation is made of what its level has solved up to then. What a learnt surface predicted is no solved
number, and the least of many predictions is too good by its error: it is on a front only while the generation's own
population stands on it, and never on a finished run's, whose last population is solved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hpsop_core.optimization.decision import compromise, knee
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.indicators import FrontArchive, hypervolume, spread
from hpsop_core.optimization.problem import Outcome
from hpsop_core.runs.records import ArchivePoint


@dataclass(frozen=True)
class KnownFront:
    """The non-dominated feasible designs of a level up to a generation.

    Attributes:
        number, level: of the generation.
        ids: ascending in f1; of equal designs the one evaluated first.
        hypervolume: below (1.2, 1.2).
        spread: None for fewer than three designs.
        compromise, knee: of these designs; None if there are none.
    """

    number: int
    level: int
    ids: tuple[int, ...]
    hypervolume: float
    spread: float | None
    compromise: int | None
    knee: int | None


class FrontHistory:
    """The front of one generation after another.

    Args:
        points: of finished evaluations by id; it may grow between two calls of ``front``.
    """

    def __init__(self, points: Mapping[int, ArchivePoint]) -> None:
        self._points = points
        self._solved: dict[int, FrontArchive] = {}
        self._fronts: list[KnownFront] = []

    @property
    def fronts(self) -> tuple[KnownFront, ...]:
        """Those made so far, in order."""
        return tuple(self._fronts)

    def add(self, generation: Generation) -> KnownFront:
        """The front after the next generation, whose designs are all among the points."""
        solved = self._solved.setdefault(generation.level, FrontArchive())
        solved.add(self._outcome(number) for number in generation.asked if not self._points[number].predicted)
        predicted = [self._outcome(number) for number in generation.members if self._points[number].predicted]
        front = solved
        if predicted:
            front = FrontArchive()
            front.add([*(self._outcome(number) for number in solved.ids), *predicted])
        points = front.objectives
        chosen, bend = compromise(points), knee(points)
        found = KnownFront(
            number=generation.number,
            level=generation.level,
            ids=front.ids,
            hypervolume=hypervolume(points),
            spread=spread(points),
            compromise=None if chosen is None else front.ids[chosen],
            knee=None if bend is None else front.ids[bend],
        )
        self._fronts.append(found)
        return found

    def _outcome(self, number: int) -> Outcome:
        point = self._points[number]
        return Outcome(number, point.objectives, (), point.feasible, None, point.predicted)
