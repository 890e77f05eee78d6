"""The page's numbers are those of every table: ``hpsop_core.quantities``."""

from __future__ import annotations

from hpsop_core.quantities import (
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    HULL,
    OBJECTIVE_TITLES,
    OBJECTIVES,
    PROPELLER,
    VARIABLES,
    Quantity,
    all_quantities,
    change_text,
    condition_quantities,
    number_text,
    objective_title,
    violated,
)

__all__ = [
    "CONSTRAINTS",
    "CONSTRAINT_WORDS",
    "HULL",
    "OBJECTIVES",
    "OBJECTIVE_TITLES",
    "PROPELLER",
    "VARIABLES",
    "Quantity",
    "all_quantities",
    "change_text",
    "condition_quantities",
    "number_text",
    "objective_title",
    "violated",
]
