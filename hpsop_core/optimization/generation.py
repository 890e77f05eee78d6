"""What a generation of the search came to."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Generation:
    """What a generation came to. Ids are evaluations of the run.

    Attributes:
        number: from 1.
        level: 1 or 2.
        asked: the designs of this generation, in the order asked.
        members: the population that survived, best first.
        front: the non-dominated feasible members, ascending in f1: NSGA-II's Pareto front.
        hypervolume: of the front, below (1.2, 1.2). Crowding may take a design off a full front: it can fall a little.
        spread: of the front; None for fewer than three designs.
        feasible_share: of the members.
        failures: failed evaluations among the designs asked.
        compromise, knee: of the front; None if it is empty.
        note: "" or why the level ends here.
    """

    number: int
    level: int
    asked: tuple[int, ...]
    members: tuple[int, ...]
    front: tuple[int, ...]
    hypervolume: float
    spread: float | None
    feasible_share: float
    failures: int
    compromise: int | None
    knee: int | None
    note: str
