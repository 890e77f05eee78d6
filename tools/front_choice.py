"""Whether the front of a run is a choice: how many of its designs stand clear of their bounds, and how far it reaches.

python -m tools.front_choice RUN.hpsop ...

The tables of docs/recommended-case.md are made of it. It looks at the front of the last generation.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.runs.reader import RunReader, open_run


@dataclass(frozen=True)
class Choice:
    """What a front offers.

    Attributes:
        designs: on the front.
        inside: share of them that have half or more of their free variables clear of the bounds by 1 % of the range.
        blade_count: at which the front reaches farthest in the objective that reaches less.
        spans: of both objectives at that blade count, over the least: 0.05 is 5 %.
    """

    designs: int
    inside: float
    blade_count: int
    spans: tuple[float, float]


def choice_of(run: RunReader) -> Choice:
    """The choice that the last front of a run offers.

    Raises:
        InputError: there is no front.
    """
    found = [record.evaluation for record in run.front()]
    if not found:
        raise InputError(f"{run.path}: has no front yet; let the run go on")
    free = len(run.case.bounds.free)
    inside = sum(len(evaluation.active_bounds) <= free / 2 for evaluation in found) / len(found)
    spans: dict[int, tuple[float, float]] = {}
    for blades in sorted({evaluation.variables.blade_count for evaluation in found}):
        own = [evaluation.objectives for evaluation in found if evaluation.variables.blade_count == blades]
        values = np.array([(objectives["f1"], objectives["f2"]) for objectives in own], dtype=float)
        first, second = np.ptp(values, axis=0) / values.min(axis=0)
        spans[blades] = (float(first), float(second))
    widest = max(spans, key=lambda blades: min(spans[blades]))
    return Choice(len(found), inside, widest, spans[widest])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each run."""
    parser = argparse.ArgumentParser(prog="python -m tools.front_choice", description=__doc__)
    parser.add_argument("runs", nargs="+", metavar="RUN.hpsop")
    for path in parser.parse_args(arguments).runs:
        found = choice_of(open_run(path))
        first, second = (100.0 * span for span in found.spans)
        print(
            f"{path}: {found.designs} designs, {100.0 * found.inside:.0f} % clear of half their bounds or more, spans "
            f"{first:.1f} and {second:.1f} % (Z {found.blade_count})"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
