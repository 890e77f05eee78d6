"""Which designs of a front the method cannot tell apart, and whether it can tell the front's ends apart at all.

Every number has an error, and two designs whose objectives differ by less are one answer. An evaluation's own errors
decide where they are known; else what the studies of the solvers state for a comparison of two forms at one level.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hpsop_core.evaluation.levels import LEVELS
from hpsop_core.typing_aliases import Array, IntArray

STATED_ERRORS: Mapping[int, float] = {level.number: level.comparison_error for level in LEVELS}
"""Relative error of an objective between two designs at a level."""


def half_widths(levels: Sequence[int], objectives: Array, errors: Sequence[Mapping[str, float]] = ()) -> Array:
    """Half widths of the objectives' errors.

    Args:
        levels: (n,) of the evaluations.
        objectives: (n, 2).
        errors: (n,) the evaluations' own in a comparison, by quantity, as fractions of it, f1 and f2 among them where
            they are known; or none at all. What all designs share (k, wake) is not in them.

    Returns:
        Shape (n, 2).
    """
    stated = np.array([STATED_ERRORS[level] for level in levels])
    widths = stated[:, None] * np.abs(objectives)
    for row, known in enumerate(errors):
        for column, name in enumerate(("f1", "f2")):
            if name in known:
                widths[row, column] = known[name] * abs(objectives[row, column])
    return np.asarray(widths)


def families(objectives: Array, widths: Array) -> IntArray:
    """The family of each design, counted from 1 along the first objective.

    A family has a leader, its design of least f1, and every design that differs from it by no more than the error in
    both objectives: families do not chain along a front.

    Args:
        objectives: (n, 2), finite.
        widths: (n, 2), see ``half_widths``.

    Returns:
        Shape (n,).
    """
    found = np.zeros(len(objectives), dtype=np.int64)
    count = 0
    for leader in np.lexsort((np.arange(len(objectives)), objectives[:, 1], objectives[:, 0])):
        if found[leader]:
            continue
        count += 1
        apart = np.abs(objectives - objectives[leader])
        same = np.all(apart <= np.maximum(widths, widths[leader]), axis=1) & (found == 0)
        found[same] = count
        found[leader] = count
    return found


def narrow(objectives: Array, widths: Array) -> str:
    """A sentence where a front is narrower than the error of its numbers; "" where it is not.

    Args:
        objectives: (n, 2) of a front.
        widths: (n, 2), see ``half_widths``.
    """
    if len(objectives) < 2:
        return ""
    spans = np.ptp(objectives, axis=0)
    error = np.max(widths, axis=0)
    least = np.min(np.abs(objectives), axis=0)
    small = [
        f"f{column + 1} by {100.0 * spans[column] / least[column]:.1f} % "
        f"(error {100.0 * error[column] / least[column]:.1f} %)"
        for column in (0, 1)
        if spans[column] <= error[column]
    ]
    if not small:
        return ""
    return f"This front is narrower than the error of its numbers: it spans {' and '.join(small)}. " + (
        "It is one answer, not a choice." if len(small) == 2 else "That objective decides nothing here."
    )
