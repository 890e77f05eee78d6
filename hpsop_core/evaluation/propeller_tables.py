"""Level 1's open-water curves from a table: a search asks the lifting line for thousands of propellers of one family.

For each blade count KT and KQ at the nodes of the open-water curve are polynomials in pitch ratio, expanded area ratio
and diameter (which acts through the drag alone), through the lifting line's answers at Chebyshev nodes between the
bounds of the case. Each table is held against propellers that are none of its nodes; where it is not within
``TOLERANCE`` of them on the finest grid, or a propeller of it cannot be computed, that blade count has none and each
design is solved. A table follows from the case alone, so which process makes it decides nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import TypeAlias

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.errors import HpsopError
from hpsop_core.evaluation.levels import FAST
from hpsop_core.evaluation.propeller_answer import (
    NODE_COUNT,
    PropellerAnswer,
    PropellerVariables,
    blade_drag,
    curve_nodes,
    propeller_answer,
    propeller_variables,
)
from hpsop_core.hydro.open_water import SectionDrag
from hpsop_core.hydro.operating_point import PropellerCurve, chebyshev_nodes
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

TOLERANCE = 1e-4
"""Greatest difference of KT and of KQ at a node to the lifting line's own, over their root mean square on the curve.
The lifting line itself is some 5 % off a test."""

_VARIED = ("pitch_ratio", "expanded_area_ratio", "diameter")
_GRIDS = ((5, 5, 3), (5, 7, 3), (7, 9, 4))
"""Nodes over each of ``_VARIED``, tried in this order."""

_CHECKED = ((0.15, 0.35, 0.25), (0.35, 0.85, 0.75), (0.65, 0.15, 0.25), (0.85, 0.65, 0.75))
"""Where a table is held against the lifting line, as parts of each bound's range: between nodes, where it is worst."""

_WORTH = 4
"""Evaluations of level 1 for each propeller of the tables from which on they save more than they cost."""

Bounds: TypeAlias = tuple[float, float]


@dataclass(frozen=True)
class PropellerTables:
    """The tables of a case, made in each process when they are first asked for; picklable and a key.

    Attributes:
        parent: a propeller of the family; what is not varied is the same in all.
        drag: of the blades.
        blade_counts: least and greatest.
        bounds: least and greatest pitch ratio, expanded area ratio and diameter in m.
    """

    parent: PropellerVariables
    drag: SectionDrag
    blade_counts: tuple[int, int]
    bounds: tuple[Bounds, Bounds, Bounds]

    def answer(self, propeller: PropellerVariables) -> PropellerAnswer | None:
        """Open-water curves of a propeller; None where no table holds it."""
        least, greatest = self.blade_counts
        place = tuple(float(getattr(propeller, name)) for name in _VARIED)
        inside = all(low <= value <= high for value, (low, high) in zip(place, self.bounds, strict=True))
        if not inside or not least <= propeller.blade_count <= greatest:
            return None
        table = _table(self, propeller.blade_count)
        return None if table is None else table.answer(place)


def tables_for(case: Case) -> PropellerTables | None:
    """What level 1 of a search asks instead of the lifting line.

    None without ``optimization.surface``; where level 1 is all that the search has, so that what it shows in the end is
    solved; and where it asks for too few designs.
    """
    search, bounds = case.optimization, case.bounds.as_dict()
    least, greatest = (int(bound) for bound in bounds["blade_count"])
    propellers = (greatest - least + 1) * int(np.prod(_GRIDS[0]))
    asked = search.population * search.level1_generations
    if not search.surface or search.level1_generations >= search.generations or asked < _WORTH * propellers:
        return None
    pitch, area, diameter = ((float(bounds[name][0]), float(bounds[name][1])) for name in _VARIED)
    parent = propeller_variables(case.propeller, case.initial.variables)
    return PropellerTables(parent, blade_drag(case.constants), (least, greatest), (pitch, area, diameter))


@dataclass(frozen=True, eq=False)
class _Table:
    """One blade count's.

    Attributes:
        bounds: as in ``PropellerTables``.
        series: Chebyshev coefficients over the three variables of KT at the nodes, then KQ; (., ., ., 2 n).
    """

    bounds: tuple[Bounds, Bounds, Bounds]
    series: Array

    def values(self, place: tuple[float, ...]) -> Array:
        """KT at the nodes, then KQ; (2 n,)."""
        found = self.series
        for value, bounds in zip(place, self.bounds, strict=True):
            polynomials = _polynomials(np.array(value), bounds, found.shape[0])
            found = (polynomials @ found.reshape(len(polynomials), -1)).reshape(found.shape[1:])
        return found

    def answer(self, place: tuple[float, ...]) -> PropellerAnswer:
        """The curves of a propeller."""
        thrust, torque = np.split(self.values(place), 2)
        return PropellerAnswer(PropellerCurve(curve_nodes(), thrust, torque), None)


def _polynomials(values: Array, bounds: Bounds, count: int) -> Array:
    """Chebyshev polynomials of degree 0 to ``count`` - 1 at values between the bounds, (..., count)."""
    low, high = bounds
    position = np.clip((2.0 * values - low - high) / ((high - low) or 1.0), -1.0, 1.0)
    return np.asarray(np.cos(np.arange(count) * np.arccos(position)[..., None]))


@lru_cache(maxsize=32)
@one_blas_thread()
def _table(tables: PropellerTables, blade_count: int) -> _Table | None:
    tested = [
        tuple(low + part * (high - low) for part, (low, high) in zip(parts, tables.bounds, strict=True))
        for parts in _CHECKED
    ]
    try:
        exact = np.array([_solved(tables, blade_count, place) for place in tested])
        by_curve = exact.reshape(len(tested), 2, NODE_COUNT)
        scale = np.repeat(np.sqrt(np.mean(by_curve**2, axis=(0, 2))), NODE_COUNT)
        for grid in _GRIDS:
            table = _through(tables, blade_count, grid)
            off = np.array([table.values(place) for place in tested]) - exact
            if float(np.max(np.abs(off) / scale)) <= TOLERANCE:
                return table
    except HpsopError:
        # A corner of the bounds that the family or the lifting line does not reach; the designs say so themselves.
        pass
    return None


def _through(tables: PropellerTables, blade_count: int, grid: tuple[int, int, int]) -> _Table:
    """The table through the lifting line's answers at the nodes of a grid; a variable that is fixed has one node."""
    axes = [
        np.array([low]) if low == high else chebyshev_nodes(low, high, count)
        for (low, high), count in zip(tables.bounds, grid, strict=True)
    ]
    solved = [_solved(tables, blade_count, place) for place in product(*(axis.tolist() for axis in axes))]
    series = np.array(solved).reshape(*map(len, axes), -1)
    for axis, bounds in zip(axes, tables.bounds, strict=True):
        # Each turn does the first axis and makes it the last of the three.
        transform = np.linalg.inv(_polynomials(axis, bounds, len(axis)))
        series = np.moveaxis(np.tensordot(transform, series, axes=1), 0, 2)
    return _Table(tables.bounds, series)


def _solved(tables: PropellerTables, blade_count: int, place: tuple[float, ...]) -> Array:
    """KT, then KQ, at the curve's nodes, by the lifting line; (2 nodes,).

    Raises:
        HpsopError: this propeller cannot be computed.
    """
    pitch, area, diameter = place  # as in _VARIED
    propeller = replace(
        tables.parent, blade_count=blade_count, pitch_ratio=pitch, expanded_area_ratio=area, diameter=diameter
    )
    curve = propeller_answer(propeller, FAST.number, tables.drag).curve
    return np.concatenate([curve.thrust_coefficient, curve.torque_coefficient])
