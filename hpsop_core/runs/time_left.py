"""The time that level 2 still takes, as far as it can be guessed: with a learnt surface most of it is quick."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from hpsop_core.case.sections import OptimizationSection

_PREDICTED_SECONDS = 0.3  # of a generation that a surface answers, until some are measured
_MEASURED = 3  # of these, from which on their median counts


def designs_to_solve(settings: OptimizationSection, generations: int, begun: bool) -> int:
    """Designs that level 2's solvers will be asked for: see ``optimization.surface_plan``.

    Args:
        settings: the case's ``[optimization]``.
        generations: of level 2 that are left.
        begun: whether its first one is over.
    """
    if not settings.surface:
        return generations * settings.population
    if generations == 0:
        return 0
    first = 0 if begun else settings.population + settings.surface_sample
    between = generations - 1 - (not begun)
    if between < 0:
        return first
    # what a check solves, and about as many that the surface is in doubt of
    checked = between // settings.surface_generations * 2 * settings.surface_checks
    return first + checked + settings.population


def level2_seconds(
    settings: OptimizationSection, generations: int, seconds_a_design: float, known: Sequence[float]
) -> float:
    """Seconds of the generations of level 2 that are left, where a surface answers.

    Args:
        settings, generations: as of ``designs_to_solve``.
        seconds_a_design: that is solved, all workers at work.
        known: seconds of all its finished generations, in their order: the first one was solved as a whole.
    """
    predicted = known[1:]
    typical = statistics.median(predicted) if len(predicted) >= _MEASURED else _PREDICTED_SECONDS
    return designs_to_solve(settings, generations, bool(known)) * seconds_a_design + generations * typical
