"""What stands in a run file, as values: designs, generations, and how they are written as JSON."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.fields import rules
from hpsop_core.case.sections import OptimizationSection
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.families import families, half_widths, narrow
from hpsop_core.optimization.generation import Generation
from hpsop_core.runs.checksums import DamagedRunError


@dataclass(frozen=True)
class DesignRecord:
    """One evaluated design of a run.

    Attributes:
        id: its number in the run.
        origin: "initial", "sample", "seed", "offspring", "handover", "reseed", "renewal" or "hand".
        generation: that asked for it first; 0 for the initial design, and for designs made by hand.
        evaluation: everything about it.
    """

    id: int
    origin: str
    generation: int
    evaluation: Evaluation

    def summary(self) -> dict[str, Any]:
        """The short form of ``hpsop show --front``."""
        return {
            "id": self.id,
            "objectives": dict(self.evaluation.objectives),
            "variables": self.evaluation.variables.as_dict(),
            "feasible": self.evaluation.feasible,
            "errors": dict(self.evaluation.errors),
            "comparison_errors": dict(self.evaluation.comparison_errors),
            "errors_source": self.evaluation.errors_source,
            "predicted": self.evaluation.predicted,
        }

    def as_dict(self) -> dict[str, Any]:
        """The evaluation's JSON with the record's own keys before it."""
        head = {"id": self.id, "origin": self.origin, "generation": self.generation}
        return {**head, **self.evaluation.as_dict()}


@dataclass(frozen=True)
class ArchivePoint:
    """A design as the chart of all designs needs it.

    Attributes:
        id, level, origin, generation: as in ``DesignRecord``.
        objectives: (f1, f2), or None if it failed.
        feasible: every constraint kept.
        predicted: by a learnt surface, not solved.
    """

    id: int
    level: int
    origin: str
    generation: int
    objectives: tuple[float, float] | None
    feasible: bool
    predicted: bool = False


@dataclass(frozen=True)
class Failure:
    """A failed evaluation: what was asked, where it failed, and why."""

    id: int
    level: int
    generation: int
    stage: str
    reason: str
    variables: DesignVariables
    elapsed: float


@dataclass(frozen=True)
class GenerationRecord:
    """A generation with its times.

    Attributes:
        generation: what it came to.
        elapsed: wall time in s, pauses not counted.
        finished_at: seconds since 1970.
    """

    generation: Generation
    elapsed: float
    finished_at: float


def front_families(records: Sequence[DesignRecord]) -> tuple[tuple[int, ...], str]:
    """The family of each design, 0 for one without objectives; and a sentence where they span less than their error.

    See ``optimization.families``.
    """
    known = [record for record in records if record.evaluation.ok]
    if not known:
        return (0,) * len(records), ""
    points = np.array([[record.evaluation.objectives["f1"], record.evaluation.objectives["f2"]] for record in known])
    levels = [record.evaluation.level for record in known]
    widths = half_widths(levels, points, [record.evaluation.comparison_errors for record in known])
    named = {record.id: int(family) for record, family in zip(known, families(points, widths), strict=True)}
    return tuple(named.get(record.id, 0) for record in records), narrow(points, widths)


def with_errors(case: Case, record: DesignRecord) -> DesignRecord:
    """The design with typical errors where it has none of its own (``evaluation.stated_errors``)."""
    # Reading a run shall not load what only some of its readers ask for.
    from hpsop_core.evaluation.stated_errors import with_stated_errors

    return dataclasses.replace(record, evaluation=with_stated_errors(case, record.evaluation))


ERROR_FIELDS = ("errors", "comparison_errors", "error_terms")
"""Of an evaluation: what a finer solution adds to it."""

ERRORS_KEY = "error_widths"
"""Where the run file's table ``run`` has these fields of its refined designs, by id."""


def known_errors(values: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """The error fields by the design's id, as text.

    Args:
        values: of the run file's table ``run``.
    """
    found: dict[str, dict[str, Any]] = json.loads(values.get(ERRORS_KEY, "{}"))
    return found


def json_text(value: Any) -> str:
    """JSON on one line with every digit of a float; NaN and infinity are refused.

    Raises:
        ValueError: a number is not finite.
    """
    return json.dumps(value, allow_nan=False, separators=(",", ":"), default=_plain)


def _plain(value: Any) -> Any:
    # numpy's scalars and arrays.
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")


def variables_text(variables: DesignVariables) -> str:
    """The exact variables as the text that names a design in the file."""
    return json_text(list(variables.key()))


def named_variables(text: str) -> dict[str, float | int]:
    """The variables that ``variables_text`` wrote, by name."""
    return DesignVariables.from_key(json.loads(text)).as_dict()


def generation_text(generation: Generation) -> str:
    """A generation as JSON."""
    return json_text(dataclasses.asdict(generation))


def generation_from_text(text: str) -> Generation:
    """The generation that ``generation_text`` wrote."""
    data = json.loads(text)
    values: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in data.items()}
    return Generation(**values)


MOST_GENERATIONS = int(rules(OptimizationSection)["generations"].upper)
"""That a run may have in total, extensions included: what a case may state."""


def generations_asked(values: Mapping[str, str]) -> int:
    """Generations asked for in total, of the table ``run``; earlier versions let more be asked than any case may."""
    asked = int(values["generations"])
    if asked < 1:
        raise ValueError(f"{asked} generations")
    return min(asked, MOST_GENERATIONS)


def fingerprint(level: int, variables: str, surface: int = 0) -> int:
    """64 bits that name an evaluation of the search: an index over them costs a tenth of one over the text.

    Two designs of a million share one with a probability of 3e-8; the second would then be refused, never mistaken.
    """
    asked = f"{level} {variables} {surface}" if surface else f"{level} {variables}"
    digest = hashlib.sha256(asked.encode()).digest()
    return int.from_bytes(digest[:8], "big", signed=True)


def check_agreement(path: Path, record: Mapping[str, Any], document: Mapping[str, Any]) -> None:
    """Whether an evaluation's row says what its JSON says: all that can be checked where there are no checksums.

    Args:
        path: of the run file, for the error.
        record: the row's cells by column.
        document: the JSON.

    Raises:
        DamagedRunError: they differ.
    """
    said = (
        document["level"],
        document["status"],
        document.get("stage", ""),
        document["reason"],
        bool(document["feasible"]),
        document["objectives"]["f1"],
        document["objectives"]["f2"],
        document["elapsed"],
        bool(document.get("predicted")),
        fingerprint(record["level"], record["variables"], record["surface"]),
    )
    names = ("level", "status", "stage", "reason", "feasible", "first_objective", "second_objective", "elapsed")
    flags = ("feasible", "surface")
    stands = tuple(bool(record[name]) if name in flags else record[name] for name in (*names, "surface", "fingerprint"))
    if said != stands:
        raise DamagedRunError(path, f"design {record['id']} contradicts itself")


def identifier(word: str) -> int | str:
    """A design's name as people write it: an integer id, "initial", "compromise" or "knee".

    Raises:
        InputError: it is none of these.
    """
    if word in ("initial", "compromise", "knee"):
        return word
    try:
        return int(word)
    except ValueError:
        raise InputError(f"--design {word}: give a design's number, initial, compromise or knee") from None
