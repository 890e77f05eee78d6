"""Errors of a run's final designs: which are wanted, and where they stand in the run file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.optimization.generation import Generation
from hpsop_core.runs.records import json_text
from hpsop_core.runs.schema import initial_id
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import Physics, hydrodynamics


def unrefined(store: RunStore, last: Generation) -> dict[int, DesignVariables]:
    """The designs of a generation's front, and the initial one, whose errors are not known yet, by their ids."""
    known = json.loads(store.value("errors", "{}"))
    wanted = [number for number in (initial_id(TRUTH.number), *last.front) if str(number) not in known]
    documents = store.documents(wanted)
    return {
        number: DesignVariables.from_dict(data["variables"])
        for number, data in zip(wanted, documents, strict=True)
        if data["status"] == "ok" and not data.get("predicted")
    }


def keep_errors(store: RunStore, errors: Mapping[int, Mapping[str, float]]) -> None:
    """Store errors beside those that are known, in the order of the designs' ids; empty ones are not known.

    Raises:
        StoreUnwritableError: the file cannot be written.
    """
    known = {int(number): widths for number, widths in json.loads(store.value("errors", "{}")).items()}
    known |= {number: widths for number, widths in errors.items() if widths}
    store.set_values(errors=json_text({str(number): known[number] for number in sorted(known)}))


def refine_front(path: str | Path, told: Callable[[int, int], None], physics: Physics | None = None) -> int:
    """Solve a run's last front and its initial design on a finer mesh, here and now, and keep their errors in its file.

    Args:
        path: the run file; nobody else may be writing it.
        told: called with (done, wanted) after each design.
        physics: the hydrodynamics by default.

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
        wanted = unrefined(store, last)
        for done, (number, variables) in enumerate(wanted.items(), 1):
            keep_errors(store, {number: refine(store.case, variables, TRUTH.number, basis).errors})
            told(done, len(wanted))
        return len(wanted)
    finally:
        store.close()
