"""A finished evaluation on its way from a worker into the run file and to the search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hpsop_core.optimization.problem import Outcome
from hpsop_core.runs.packing import essence_of


@dataclass(frozen=True)
class Result:
    """What an evaluation came to, taken apart where it was made: a run with many workers only puts it away.

    Attributes:
        status, stage, reason, elapsed, feasible: as in the evaluation's document.
        outcome: what the search is told; its number is the run's to give.
        essence: all that the document holds, as ``packing.essence_of``.
    """

    status: str
    stage: str
    reason: str
    elapsed: float
    feasible: bool
    outcome: Outcome
    essence: bytes

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> Result:
        """That of a document as ``Evaluation.as_dict`` gives it.

        Raises:
            ValueError: a number is not finite.
            TypeError: something has no JSON form.
        """
        return cls(
            status=document["status"],
            stage=document.get("stage", ""),
            reason=document["reason"],
            elapsed=float(document["elapsed"]),
            feasible=bool(document["feasible"]),
            outcome=Outcome.from_json(0, document),
            essence=essence_of(document),
        )
