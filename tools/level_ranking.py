"""How well level 1 ranks what level 2 judges: ``python -m tools.level_ranking``, two minutes.

Two samples of the resistance objective on the DTC: dimensions at one fullness, and dimensions with the displacement.
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy.stats import qmc, spearmanr

from hpsop_core import evaluate, load_case
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.reference import reference_for
from hpsop_core.typing_aliases import Array


def sampled(case: Case, with_displacement: bool, count: int) -> list[DesignVariables]:
    """Designs of a Sobol sequence; without displacement their block coefficient is the initial design's."""
    initial = case.initial.variables
    made = []
    for at in qmc.Sobol(4, rng=np.random.default_rng(3)).random(count):
        length_to_breadth, breadth_to_draft, draft = 6.5 + 1.5 * at[0], 3.0 + at[1], 14.0 + 0.5 * at[2]
        breadth = breadth_to_draft * draft
        box = length_to_breadth * breadth**2 * draft / (initial.length * initial.breadth * initial.draft)
        ratio = 0.95 + 0.1 * at[3] if with_displacement else box
        if 0.6 < ratio < 1.4:
            made.append(
                initial.replaced(
                    {
                        "length_to_breadth": length_to_breadth,
                        "breadth_to_draft": breadth_to_draft,
                        "draft": draft,
                        "displacement_ratio": ratio,
                    }
                )
            )
    return made


def both_levels(case: Case, designs: list[DesignVariables]) -> Array:
    """Resistance objective by level 1 and 2 per displacement to two thirds, and CB, (n, 3); failures are left out."""
    references = [reference_for(case, level) for level in (1, 2)]
    rows = []
    for design in designs:
        results = [evaluate(case, design, level, references[level - 1]) for level in (1, 2)]
        if all(result.ok for result in results):
            scale = design.displacement_ratio ** (2.0 / 3.0)
            values = [(result.all_objectives["resistance"] or 0.0) / scale for result in results]
            rows.append([*values, results[1].hull.block_coefficient])
    return np.array(rows)


def main() -> None:
    """Print the rank correlations."""
    argparse.ArgumentParser(prog="python -m tools.level_ranking", description=__doc__).parse_args()
    case = load_case("dtc-p4119-power")
    for name, with_displacement in (("dimensions at one fullness", False), ("dimensions and displacement", True)):
        table = both_levels(case, sampled(case, with_displacement, 64))
        low, high = table[:, 2].min(), table[:, 2].max()
        print(f"{name}: {len(table)} designs, CB {low:.3f} to {high:.3f}: Spearman {_rank(table):.3f}")
        if with_displacement:
            narrow = table[(table[:, 2] >= 0.60) & (table[:, 2] <= 0.70)]
            print(f"  of these {len(narrow)} with CB 0.60 to 0.70: Spearman {_rank(narrow):.3f}")


def _rank(table: Array) -> float:
    return float(spearmanr(table[:, 0], table[:, 1])[0])


if __name__ == "__main__":
    main()
