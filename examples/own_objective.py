"""A search with an objective of one's own: transport work, delivered power over weight times speed.

    python examples/own_objective.py [--generations 12] [--population 16]

An objective that everyone shall have is one entry in hpsop_core, see docs/adding-an-objective.md; this is the way for
one's own.
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from hpsop_core import evaluate, load_case, optimize
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.runs.tasks import Physics, hydrodynamics


def evaluate_transport(case: Case, variables: DesignVariables, level: int, reference: Any) -> Evaluation:
    """The evaluation with f1 = power per transport work in W/(kN m/s), f2 as the case has it. (Workers import this.)"""
    result = evaluate(case, variables, level, reference)
    if not result.ok:
        return result
    weight = case.constants.density * case.constants.gravity * result.hull.displaced_volume / 1e3
    transport = sum(c.weight * c.delivered_power / (weight * c.speed) for c in result.conditions)
    return replace(result, objectives={"f1": transport, "f2": result.objectives["f2"]})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generations", type=int, default=12)
    parser.add_argument("--population", type=int, default=16)
    asked = parser.parse_args()

    case = load_case("dtc-p4119")
    own = hydrodynamics()
    physics = Physics(evaluate_transport, own.reference_for, own.reference_from_dict)
    with tempfile.TemporaryDirectory() as folder:
        run = optimize(
            case,
            Path(folder) / "own.hpsop",
            generations=asked.generations,
            level1_generations=asked.generations,
            population=asked.population,
            physics=physics,
        )
        initial = run.initial(1).evaluation.objectives["f1"]
        for record in run.front():
            values = record.evaluation.objectives
            print(
                f"design {record.id:4d}: {values['f1']:.3f} W/(kN m/s) ({values['f1'] / initial:.4f} of the initial "
                f"design's), {case.objectives.second} {values['f2']:.4f}"
            )


if __name__ == "__main__":
    main()
