"""Which variables drive which results: Spearman's rank correlation over evaluated designs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.markup import Markup, escape, fill
from hpsop_core.quantities import OBJECTIVES, Quantity, free_variables, quantities_of_case
from hpsop_core.typing_aliases import Array

LEAST_FOR_CORRELATION = 10
"""Fewer designs say nothing about a rank."""

_RESULTS = (
    "block_coefficient", "total_resistance_1", "open_water_efficiency_1", "delivered_power_1",
    "required_expanded_area_ratio_1",
)  # fmt: skip
_RISING, _FALLING = "201, 42, 42", "25, 113, 194"


def rank_correlation(first: Array, second: Array) -> float | None:
    """Spearman's rho of the pairs (n,) that are finite; None for too few, or when one of them does not vary."""
    keep = np.isfinite(first) & np.isfinite(second)
    if np.count_nonzero(keep) < LEAST_FOR_CORRELATION:
        return None
    a, b = first[keep], second[keep]
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return None
    # The page and the report hold this chart ready; SciPy's statistics are a fifth of the page's imports.
    from scipy.stats import spearmanr

    return float(spearmanr(a, b).statistic)


@dataclass(frozen=True)
class RankCorrelations:
    """Spearman's rho of each free variable with each result.

    Attributes:
        variables: rows.
        results: columns.
        rho: a row a variable; None where there is no correlation to tell.
    """

    variables: tuple[Quantity, ...]
    results: tuple[Quantity, ...]
    rho: tuple[tuple[float | None, ...], ...]


def rank_correlations(case: Case, column: Callable[[Quantity], Array | None]) -> RankCorrelations:
    """Correlations of a case's free variables with its objectives and main results.

    Args:
        case: whose variables and conditions.
        column: a quantity's values (n,) over the designs, NaN where there is none; None if it is not kept.
    """
    everything = {quantity.key: quantity for quantity in quantities_of_case(case)}
    results = (*OBJECTIVES, *(everything[key] for key in _RESULTS if key in everything))
    free = tuple(free_variables(case))
    columns = {quantity.key: column(quantity) for quantity in (*free, *results)}

    def rho(first: Array | None, second: Array | None) -> float | None:
        return None if first is None or second is None else rank_correlation(first, second)

    rows = tuple(tuple(rho(columns[row.key], columns[item.key]) for item in results) for row in free)
    return RankCorrelations(free, results, rows)


def correlation_cell(rho: float | None) -> Markup:
    """A table's cell: the number with its sign, tinted by sign and strength."""
    if rho is None:
        return escape("–")
    text = f"{abs(rho):.2f}"
    words = text if text == "0.00" else f"{'+' if rho > 0 else '−'}{text}"
    colour = f"rgba({_RISING if rho > 0 else _FALLING}, {0.55 * abs(rho):.2f})"
    return fill('<span style="display: block; padding: 0 .3rem; background: {}">{}</span>', colour, words)


def correlation_rows(found: RankCorrelations, named: Callable[[Quantity], Markup]) -> Sequence[list[Markup]]:
    """Rows of a table: the variable's name, then a cell a result."""
    return [
        [named(quantity), *(correlation_cell(value) for value in row)]
        for quantity, row in zip(found.variables, found.rho, strict=True)
    ]
