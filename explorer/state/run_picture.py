"""What a run looks like at one moment: arrays that charts draw from, whoever drives the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hpsop_core.case.case import Case

IDLE, STARTING, RUNNING, PAUSED, STOPPING, STOPPED, FINISHED, FAILED = (
    "idle",
    "starting",
    "running",
    "paused",
    "stopping",
    "stopped",
    "finished",
    "failed",
)
ACTIVE = (STARTING, RUNNING, PAUSED, STOPPING)


@dataclass(frozen=True)
class GenerationPicture:
    """One generation: its number from 1, level, members, and the front known by then with its hypervolume."""

    number: int
    level: int
    members: tuple[int, ...]
    front: tuple[int, ...]
    hypervolume: float


@dataclass(frozen=True)
class RunPicture:
    """A frozen view of a run.

    Attributes:
        name: the run file's name, or "" before the first run.
        opening: which opening of which file, from 1; 0 before the first run. Two runs may bear one name.
        case: what it runs.
        status: one of the words above.
        message: why it failed or ended, for people.
        live: whether this program drives it (else it is only read).
        ids, level, generation: of every finished evaluation, shape (n,), ids ascending.
        objectives: (n, 2), NaN where the evaluation failed.
        feasible, failed, by_hand, predicted: (n,); predicted by a learnt surface instead of solved.
        table: (n, len(columns)), NaN where a number is missing.
        columns: quantity keys of the table.
        generations: finished generations in order.
        compromise, knee: ids on the newest front, or None.
        seconds_left: an honest guess, or None.
        elapsed: seconds of work so far.
        comparison: errors of the newest front's designs in a comparison, by id and quantity, where they are known.
    """

    name: str
    case: Case
    status: str = IDLE
    message: str = ""
    live: bool = False
    ids: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    level: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    generation: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    objectives: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    feasible: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    failed: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    by_hand: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    table: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))
    columns: tuple[str, ...] = ()
    generations: tuple[GenerationPicture, ...] = ()
    compromise: int | None = None
    knee: int | None = None
    seconds_left: float | None = None
    elapsed: float = 0.0
    predicted: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    opening: int = 0
    comparison: Mapping[int, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """One consistent picture: as many of everything as there are designs, a column of the table for each key.

        Raises:
            ValueError: it would be made of two different moments.
        """
        count = len(self.ids)
        if not len(self.predicted):
            object.__setattr__(self, "predicted", np.zeros(count, dtype=bool))
        flags = (self.level, self.generation, self.feasible, self.failed, self.by_hand, self.predicted)
        if (
            any(values.shape != (count,) for values in flags)
            or self.objectives.shape != (count, 2)
            or self.table.shape != (count, len(self.columns))
        ):
            raise ValueError("a picture of a run needs as many rows as designs and as many columns as keys")

    @property
    def total_generations(self) -> int:
        """Planned generations of both levels."""
        return self.case.optimization.generations

    @property
    def predictions(self) -> int:
        """How many designs a learnt surface predicted."""
        return int(self.predicted.sum())

    @property
    def current_level(self) -> int:
        """Of the newest generation, or 1."""
        return self.generations[-1].level if self.generations else 1

    def row(self, design_id: int) -> int | None:
        """Where a design stands in the arrays."""
        at = int(np.searchsorted(self.ids, design_id))
        return at if at < len(self.ids) and self.ids[at] == design_id else None

    def rows(self, design_ids: tuple[int, ...]) -> NDArray[np.int64]:
        """Rows of those designs that are in the arrays."""
        if not design_ids or not len(self.ids):
            return np.zeros(0, dtype=np.int64)
        wanted = np.asarray(design_ids, dtype=np.int64)
        at = np.clip(np.searchsorted(self.ids, wanted), 0, len(self.ids) - 1)
        found: NDArray[np.int64] = at[self.ids[at] == wanted]
        return found

    def generation_at(self, number: int | None) -> GenerationPicture | None:
        """Generation ``number``, or the newest for None."""
        if not self.generations:
            return None
        if number is None:
            return self.generations[-1]
        return self.generations[min(max(number, 1), len(self.generations)) - 1]

    def last_of_level(self, level: int, upto: int | None = None) -> GenerationPicture | None:
        """The newest generation of a level, not after ``upto``."""
        for item in reversed(self.generations):
            if item.level == level and (upto is None or item.number <= upto):
                return item
        return None

    def column(self, key: str) -> NDArray[np.float64] | None:
        """A quantity of every design, or None when the table does not hold it."""
        if key == "f1":
            return self.objectives[:, 0]
        if key == "f2":
            return self.objectives[:, 1]
        return self.table[:, self.columns.index(key)] if key in self.columns else None

    def inside(self, filters: Mapping[str, tuple[float, float]]) -> NDArray[np.bool_]:
        """Which designs pass every range filter."""
        keep = np.ones(len(self.ids), dtype=bool)
        for key, (low, high) in filters.items():
            values = self.column(key)
            if values is not None:
                keep &= (values >= low) & (values <= high)
        return keep
