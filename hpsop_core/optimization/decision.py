"""Choosing one design of a front: the compromise (the paper's), a weighted choice, and the knee."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array


def normalised(front: Sequence[tuple[float, float]]) -> Array:
    """Objectives scaled so that the front's best is 0 (the utopia point) and its worst is 1, each for itself.

    Args:
        front: (f1, f2), at least one.

    Returns:
        Shape (n, 2); an objective that does not vary along the front is 0 everywhere.
    """
    points = np.array(front, dtype=np.float64)
    best = points.min(axis=0)
    ranges = np.ptp(points, axis=0)
    scaled: Array = (points - best) / np.where(ranges > 0.0, ranges, 1.0)
    return scaled


def compromise(front: Sequence[tuple[float, float]], weights: tuple[float, float] = (1.0, 1.0)) -> int | None:
    """The design with the least distance to the utopia point, in normalised objectives.

    With equal weights this is the paper's compromise solution (section "Results and discussion"). Moving the weights
    walks along the front: all weight on one objective gives that objective's best design.

    Args:
        front: (f1, f2) of the front's designs.
        weights: how much each objective counts; not negative, not both zero.

    Returns:
        Index into ``front`` (the first of equals), or None for an empty front.

    Raises:
        InputError: weights that say nothing.
    """
    first, second = weights
    if not (first >= 0.0 and second >= 0.0 and 0.0 < first + second < float("inf")):
        raise InputError(f"weights: {first:g} and {second:g}; give two numbers of 0 or more, not both 0")
    if not front:
        return None
    distances = np.hypot(*(normalised(front) * weights).T)
    if min(weights) == 0.0:
        # Only one objective counts: its best design, and among equals the one better in the other.
        order = np.lexsort((normalised(front)[:, 0 if first == 0.0 else 1], distances))
        return int(order[0])
    return int(np.argmin(distances))


def knee(front: Sequence[tuple[float, float]]) -> int | None:
    """The design that bulges most towards utopia: beyond it, a little of one objective costs much of the other.

    The greatest distance from the straight line between the ends of the front, in normalised objectives (Das 1999,
    "On characterizing the knee of the Pareto curve").

    Args:
        front: (f1, f2), ascending in f1.

    Returns:
        Index into ``front``; for fewer than three designs or a front that bulges nowhere, the compromise's.
    """
    if len(front) < 3:
        return compromise(front)
    points = normalised(front)
    # The ends are (0, 1) and (1, 0): the signed distance from their line is (1 - f1 - f2) / sqrt(2).
    bulge = 1.0 - points[:, 0] - points[:, 1]
    best = int(np.argmax(bulge))
    return best if bulge[best] > 0.0 else compromise(front)
