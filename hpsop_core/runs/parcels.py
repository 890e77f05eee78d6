"""What all designs of a generation are evaluated with, sent to each worker once instead of with every design.

Case and reference are some 7 kB, with a learnt surface 1.6 MB. A job names its parcel; a worker that does not have it
says so, and is asked again with the content. So a worker that was just started, or has just joined a cluster, needs
nothing else, and which worker has what decides nothing.
"""

from __future__ import annotations

import hashlib
import pickle
from dataclasses import dataclass
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.runs.results import Result
from hpsop_core.runs.tasks import EvaluateFunction, evaluation_task

_KEPT = 4  # parcels in a worker: of each level, and of the newest surfaces

_opened: dict[str, tuple[EvaluateFunction, Case, Any]] = {}


@dataclass(frozen=True)
class Parcel:
    """A function, a case and a reference on their way to a worker.

    Attributes:
        name: of the content, by its hash.
        content: pickled; None where the worker is thought to have it.
    """

    name: str
    content: bytes | None

    @property
    def label(self) -> Parcel:
        """The parcel without its content."""
        return Parcel(self.name, None)


def parcel_of(evaluate: EvaluateFunction, case: Case, reference: Any) -> Parcel:
    """A parcel with its content."""
    content = pickle.dumps((evaluate, case, reference), protocol=pickle.HIGHEST_PROTOCOL)
    return Parcel(hashlib.sha256(content).hexdigest(), content)


def parcel_task(parcel: Parcel, variables: DesignVariables, level: int) -> Result | None:
    """Evaluate one design in this process, as ``evaluation_task``; None where the parcel is not here."""
    found = _opened.get(parcel.name)
    if found is None:
        if parcel.content is None:
            return None
        # From the run that this worker works for, as every other argument.
        found = _opened[parcel.name] = pickle.loads(parcel.content)  # noqa: S301
        for name in list(_opened)[:-_KEPT]:
            # A cluster's worker may have several threads.
            _opened.pop(name, None)
    evaluate, case, reference = found
    return evaluation_task(evaluate, case, variables, level, reference)
