"""What a run tells while it goes on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from hpsop_core.optimization.generation import Generation

State: TypeAlias = Literal["new", "running", "paused", "stopped", "finished", "failed"]
"""new: not started; paused: waits for ``resume`` (or for room on the disk: see the reason); stopped: ended before the
last generation, may be started again; failed: cannot go on, see the reason."""


@dataclass(frozen=True)
class RunSnapshot:
    """Where a run stands.

    Attributes:
        state: see ``State``.
        reason: why, where that is not obvious; else "".
        generation: generations finished.
        generations: asked for in total.
        level: of the generation under way.
        population: designs asked for in the generation under way.
        done: of these, evaluated.
        evaluations: finished in the whole run, per level.
        predictions: of these, predicted by a learnt surface.
        failures: of these, failed.
        hypervolume: of the last generation.
        feasible_share: of the last generation.
        seconds_left: an estimate; None while there is nothing to go by.
        elapsed: wall time of all generations so far in s.
        workers: where evaluations run.
    """

    state: State = "new"
    reason: str = ""
    generation: int = 0
    generations: int = 0
    level: int = 1
    population: int = 0
    done: int = 0
    evaluations: tuple[int, int] = (0, 0)
    predictions: int = 0
    failures: int = 0
    hypervolume: float = 0.0
    feasible_share: float = 0.0
    seconds_left: float | None = None
    elapsed: float = 0.0
    workers: str = ""


@dataclass(frozen=True)
class RunEvent:
    """Something happened.

    Attributes:
        kind: "state" (it changed), "generation" (one is finished and in the file), "evaluation" (progress within a
            generation, at most ten a second), "failure" (an evaluation failed), "handover" (level 2 begins next).
        snapshot: where the run stands now.
        generation: of "generation" and "handover".
        evaluation_id: of "failure".
        text: for people: of "failure" stage and reason, of "handover" why.
    """

    kind: Literal["state", "generation", "evaluation", "failure", "handover"]
    snapshot: RunSnapshot
    generation: Generation | None = None
    evaluation_id: int | None = None
    text: str = ""
