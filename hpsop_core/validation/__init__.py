"""Validation: our numbers beside experiments, published codes and closed forms, printed by ``hpsop validate``.

* check: one line of it: a number, what it is held against, how far it may be off, and what it proves
* comparison: a curve of such lines
* published_hulls, published_propellers: ships and propellers of others, as they were measured
* hull, resistance, powering, rankine, propeller_level1, propeller_level2: the lines of a discipline
* rankine_studies, propeller_studies: sweeps that validation, pictures and docs share; miss_studies: why points miss
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator

from hpsop_core.validation.check import Check

DISCIPLINES = (
    "hull",
    "resistance",
    "powering",
    "rankine",
    "propeller_level1",
    "propeller_level2",
    "published_hulls",
    "published_propellers",
)


def all_checks() -> Iterator[Check]:
    """Every check of every discipline, computed as it is asked for; the long ones take minutes."""
    for discipline in DISCIPLINES:
        module = importlib.import_module(f"hpsop_core.validation.{discipline}")
        yield from module.checks()
