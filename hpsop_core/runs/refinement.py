"""Errors of a run's final designs: which are wanted, and where they stand in the run file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.records import ERROR_FIELDS, ERRORS_KEY, json_text
from hpsop_core.runs.schema import initial_id
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import Physics, hydrodynamics


def shown_front(path: str | Path, generation: int) -> tuple[int, ...]:
    """The designs of the front that people are shown after a generation (see ``fronts``), ascending in f1."""
    front = open_run(path).known_front(generation)
    return () if front is None else front.ids


def unrefined(store: RunStore, front: Sequence[int]) -> dict[int, DesignVariables]:
    """The designs of a front, and the initial one, whose errors are not known yet, by their ids."""
    return _unknown(store, (initial_id(TRUTH.number), *front))


def _unknown(store: RunStore, numbers: Sequence[int]) -> dict[int, DesignVariables]:
    known = json.loads(store.value(ERRORS_KEY, "{}"))
    wanted = [number for number in dict.fromkeys(numbers) if str(number) not in known]
    documents = store.documents(wanted)
    return {
        number: DesignVariables.from_dict(data["variables"])
        for number, data in zip(wanted, documents, strict=True)
        if data["status"] == "ok" and data["level"] == TRUTH.number and not data.get("predicted")
    }


def keep_errors(store: RunStore, documents: Mapping[int, Mapping[str, Any]]) -> None:
    """Store the error fields of evaluations beside those that are known, in the order of the designs' ids.

    Args:
        store: the run file.
        documents: evaluations as ``as_dict`` gives them, by the design's id; those without errors are left.

    Raises:
        StoreUnwritableError: the file cannot be written.
    """
    known = {int(number): fields for number, fields in json.loads(store.value(ERRORS_KEY, "{}")).items()}
    known |= {
        number: {name: document[name] for name in ERROR_FIELDS}
        for number, document in documents.items()
        if document["errors"]
    }
    store.set_values(**{ERRORS_KEY: json_text({str(number): known[number] for number in sorted(known)})})


def refine_front(
    path: str | Path,
    told: Callable[[int, int], None],
    physics: Physics | None = None,
    designs: Sequence[int] | None = None,
) -> int:
    """Solve designs of a run finer, here and now, and keep their errors in its file.

    Args:
        path: the run file; nobody else may be writing it.
        told: called with (done, wanted) before each design and at the end.
        physics: the hydrodynamics by default.
        designs: their ids; the last front and the initial design by default.

    Returns:
        How many designs were solved; 0 where all errors are known.

    Raises:
        InputError: no such run, it has not reached level 2, or it is being written.
    """
    refine = (physics or hydrodynamics()).refine
    store = RunStore(Path(path))
    try:
        last = store.generation(len(store.generation_times()))
        reference = store.reference(TRUTH.number)
        if refine is None or last is None or last.level != TRUTH.number or reference is None:
            raise InputError(
                f"{path}: has no front of level {TRUTH.number} yet, whose errors could be stated; let it go on"
            )
        basis = (physics or hydrodynamics()).reference_from_dict(json.loads(reference))
        wanted = unrefined(store, shown_front(path, last.number)) if designs is None else _unknown(store, designs)
        for done, (number, variables) in enumerate(wanted.items()):
            told(done, len(wanted))
            keep_errors(store, {number: refine(store.case, variables, TRUTH.number, basis).as_dict()})
        told(len(wanted), len(wanted))
        return len(wanted)
    finally:
        store.close()
