"""Validation: our numbers beside experiments, published codes and closed forms."""

from __future__ import annotations

import importlib
from collections.abc import Iterator

from hpsop_core.validation.check import Check

DISCIPLINES = ("hull", "resistance", "rankine", "propeller_level1", "propeller_level2")


def all_checks() -> Iterator[Check]:
    """Every check of every discipline, computed as it is asked for; the long ones take minutes."""
    for discipline in DISCIPLINES:
        module = importlib.import_module(f"hpsop_core.validation.{discipline}")
        yield from module.checks()
