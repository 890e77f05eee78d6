"""When level 2 asks the solvers and when a learnt surface: the plan of a search with ``optimization.surface``.

The first generation of level 2 is solved, and with it a sample spread over what level 1 found feasible: the first
surface is learnt from these. Every few generations a *check* solves some designs of the front; the next generation is
the same population asked again, of the surface learnt with them. It is too when the surface left twice as many designs
to the solvers as a check would solve. The run's last generation is its population, solved.
So an answer is never older than its surface, a surface is a function of the generations before it alone, and what a
finished run shows is solved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hpsop_core.case.sections import OptimizationSection
from hpsop_core.optimization.problem import Outcome
from hpsop_core.typing_aliases import Array


class SurfacePlan:
    """Which surface answers in which generation of level 2; advanced with the search.

    Args:
        settings: the case's ``[optimization]``.
    """

    def __init__(self, settings: OptimizationSection) -> None:
        self._settings = settings
        self._closings: set[int] = set()
        self._since = 0  # generations told since a surface was learnt
        self._doubts = 0  # designs solved since then
        self.surface = 0

    def close(self, generation: int) -> None:
        """Solve all of this generation's population: it is, or was once, the run's last."""
        self._closings.add(generation)

    def closes(self, generation: int) -> bool:
        """Whether this generation is solved as a whole."""
        return self._settings.surface and generation in self._closings

    @property
    def checks(self) -> bool:
        """Whether designs of the front are solved next."""
        return self.surface > 0 and self._since >= self._settings.surface_generations

    @property
    def learns(self) -> bool:
        """Whether there is news from the solvers to learn from before the next generation."""
        return self._since == 0 or self.doubted

    @property
    def doubted(self) -> bool:
        """Whether the surface left so many designs to the solvers that it would gain by what they said."""
        return self._doubts >= 2 * self._settings.surface_checks

    def solved(self) -> None:
        """A generation with new designs to learn from was told."""
        self._since, self._doubts = 0, 0

    def told(self, doubts: int) -> None:
        """Any other generation was told, with so many designs that the surface left to the solvers."""
        self._since += 1
        self._doubts += doubts

    def next_surface(self) -> int:
        """Learn: the number of the surface from now on."""
        self.surface += 1
        self._since = self._doubts = 0
        return self.surface


def front_to_check(front: Sequence[int], outcomes: Mapping[int, Outcome], count: int) -> frozenset[int]:
    """Predicted designs of a front, evenly along it, its ends among them; at most ``count``."""
    predicted = [number for number in front if outcomes[number].predicted]
    if len(predicted) <= count:
        return frozenset(predicted)
    if count == 1:
        return frozenset(predicted[:1])
    places = [place * (len(predicted) - 1) // (count - 1) for place in range(count)]
    return frozenset(predicted[place] for place in places)


def spread_out(points: Array, chosen: Array, count: int) -> list[int]:
    """Rows of ``points`` far from each other and from those chosen already, each the farthest when its turn comes.

    Args:
        points: (n, d), scaled alike in all directions.
        chosen: (k, d), k at least 1.
        count: of rows; fewer where no other point is left.

    Returns:
        Their indices, in the order taken.
    """
    taken: list[int] = []
    if len(points) == 0:
        return taken
    distance = np.min(np.sum((points[:, None, :] - chosen[None, :, :]) ** 2, axis=2), axis=1)
    for _ in range(count):
        farthest = int(np.argmax(distance))
        if distance[farthest] <= 0.0:
            break
        taken.append(farthest)
        distance = np.minimum(distance, np.sum((points - points[farthest]) ** 2, axis=1))
    return taken
