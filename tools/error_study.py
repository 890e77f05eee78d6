"""What errors designs have: ``python -m tools.error_study [CASE] [COUNT]``, some two seconds a design.

Designs of a Sobol sequence over the case's space are solved with their errors. Printed are medians and 90 % values of
the half widths: of the waves by Froude number, from which ``evaluation.stated_errors`` has its typical ones, and of the
objectives in a comparison.
"""

from __future__ import annotations

import argparse
import itertools

import numpy as np
from scipy.stats import qmc

from hpsop_core import load_case
from hpsop_core.case.case import Case
from hpsop_core.evaluation.errors import evaluate_with_errors
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.evaluation.result import Ok


def solved(case: Case, count: int) -> list[Ok]:
    """Designs with their errors, of forms that carry what is asked."""
    reference = reference_for(case, 2)
    space = case.bounds
    lower, upper = space.relaxed_lower, space.relaxed_upper
    found: list[Ok] = []
    for point in qmc.Sobol(len(space.free), scramble=False).random(16 * count):
        result = evaluate_with_errors(case, space.decode(lower + point * (upper - lower)), 2, reference)
        if result.ok and not result.hull.clipped:
            found.append(result)
        if len(found) == count:
            break
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tools.error_study", description=__doc__)
    parser.add_argument("case", nargs="?", default="dtc-p4119", help="a shipped case's name or a case file")
    parser.add_argument("count", nargs="?", type=int, default=16, help="of designs")
    asked = parser.parse_args()
    designs = solved(load_case(asked.case), asked.count)
    rows = np.array(
        [
            [
                item.froude_number,
                1e4 * item.wave_coefficient,
                1e4 * design.errors[f"wave_coefficient_{place}"],
                design.comparison_errors[f"delivered_power_{place}"],
                design.errors[f"delivered_power_{place}"] / item.delivered_power,
            ]
            for design in designs
            for place, item in enumerate(design.conditions, 1)
        ]
    )
    print(f"{len(designs)} designs; half widths, median and 90 %")
    edges = np.quantile(rows[:, 0], np.linspace(0.0, 1.0, 5))
    for low, high in itertools.pairwise(edges):
        part = rows[(rows[:, 0] >= low) & (rows[:, 0] <= high)]
        print(
            f"Fn {low:.3f} to {high:.3f}, mean {part[:, 0].mean():.3f}: 10^4 Cw {_two(part[:, 2])} of "
            f"{np.median(part[:, 1]):.2f}; power {_two(100 * part[:, 4])} %, compared {_two(100 * part[:, 3])} %"
        )
    for name in ("f1", "f2"):
        print(f"{name} in a comparison: {_two([100 * design.comparison_errors[name] for design in designs])} %")
    share = [
        design.error_terms["propeller_mesh"][f"delivered_power_{place}"] / item.delivered_power
        for design in designs
        for place, item in enumerate(design.conditions, 1)
    ]
    print(f"power, propeller's mesh alone: {_two([100 * value for value in share])} %")
    print(f"{np.median([design.elapsed for design in designs]):.1f} s a design")


def _two(values: object) -> str:
    numbers = np.asarray(values, dtype=float)
    return f"{np.median(numbers):.3g}, {np.quantile(numbers, 0.9):.3g}"


if __name__ == "__main__":
    main()
