"""Which number stands for which design of a run, and what is known of it.

Designs are numbered in the order asked: a run that is asked again gives each the number that it has in the file. What
a learnt surface predicted has a number for each surface that was asked; a solved design is never predicted after.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.runs.records import variables_text
from hpsop_core.runs.schema import FIRST_SEARCH_ID, initial_id


class DivergedError(Exception):
    """What is asked is not what the file's run was asked."""


class Ledger:
    """Numbers and outcomes of a run's evaluations.

    Args:
        initial: the initial design's variables text.
        stored: the file's evaluations by id: (level, variables text, outcome).
    """

    def __init__(self, initial: str, stored: Mapping[int, tuple[int, str, Outcome]]) -> None:
        self._initial = initial
        self._stored = dict(stored)
        self._numbers: dict[tuple[int, str, int], int] = {}
        self._next = FIRST_SEARCH_ID

    def number(self, candidate: Candidate) -> tuple[int, bool]:
        """The design's number, and whether this is its first appearance.

        Raises:
            DivergedError: the file has another design of this number.
        """
        text = variables_text(candidate.variables)
        solved = self._numbers.get((candidate.level, text, 0))
        if solved is not None:
            return solved, False
        key = candidate.level, text, candidate.surface
        if key in self._numbers:
            return self._numbers[key], False
        # The initial design keeps its own number when it is in a population too.
        if text == self._initial:
            number = initial_id(candidate.level)
        else:
            number = self._next
            self._next += 1
        stored = self._stored.get(number)
        if stored is not None and stored[:2] != key[:2]:
            raise DivergedError(f"another design than number {number} is asked for")
        self._numbers[key] = number
        return number, True

    def knows(self, number: int) -> bool:
        """Whether the evaluation is finished."""
        return number in self._stored

    def outcome(self, number: int) -> Outcome:
        """What the evaluation came to."""
        return self._stored[number][2]

    def record(self, number: int, candidate: Candidate, outcome: Outcome) -> None:
        """An evaluation is finished."""
        self._stored[number] = candidate.level, variables_text(candidate.variables), outcome

    def settle(self, candidates: Iterable[Candidate]) -> None:
        """A generation is finished: where the surface was in doubt its design counts as solved from now on.

        In the order asked, so that what is known when does not depend on which worker was quicker.
        """
        for candidate in candidates:
            if candidate.surface:
                number, _ = self.number(candidate)
                if not self.outcome(number).predicted:
                    self._numbers[candidate.level, variables_text(candidate.variables), 0] = number

    def solved(self) -> tuple[int, ...]:
        """Numbers of what the true level's solvers have computed so far in the order asked, ascending."""
        return tuple(
            sorted(
                number
                for (level, _, surface), number in self._numbers.items()
                if level == TRUTH.number and surface == 0 and number in self._stored
            )
        )

    def counts(self) -> tuple[int, int]:
        """Finished evaluations of either level, predicted ones included."""
        levels = [level for level, _, _ in self._stored.values()]
        return levels.count(1), levels.count(TRUTH.number)

    @property
    def failures(self) -> int:
        """Failed evaluations."""
        return sum(outcome.failed for _, _, outcome in self._stored.values())

    @property
    def predictions(self) -> int:
        """Evaluations that a surface predicted."""
        return sum(outcome.predicted for _, _, outcome in self._stored.values())

    def __len__(self) -> int:
        return len(self._stored)
