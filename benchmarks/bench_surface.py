"""What a learnt surface gets wrong, on designs that no surface and no front has ever solved.

    python benchmarks/bench_surface.py [RUN.hpsop] [--designs 60]

The surface is learnt from all that the run solved at level 2, as its last one was. Then it answers for (a) designs that
the run itself asked it for and never solved, evenly over the run, and (b) a Latin hypercube over the whole space; the
solvers are asked for the same designs. Errors are over those that the surface answers; the others are solved anyway.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib.resources import as_file
from pathlib import Path

import numpy as np

from hpsop_core.assets import asset_path
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.reference import Reference, learnt, reference_for
from hpsop_core.evaluation.result import Ok
from hpsop_core.optimization.sampling import latin_hypercube
from hpsop_core.runs.reader import RunReader, open_run


def solved_and_predicted(run: RunReader) -> tuple[list[dict[str, object]], list[DesignVariables]]:
    """Documents of what was solved at level 2, by id; and designs that were predicted and never solved."""
    records = [run.design(point.id) for point in run.archive() if point.level == 2 and point.origin != "hand"]
    records.sort(key=lambda record: record.id)
    solved = [record for record in records if not record.evaluation.predicted]
    known = {record.evaluation.variables.key() for record in solved}
    fresh = {
        record.evaluation.variables.key(): record.evaluation.variables
        for record in records
        if record.evaluation.predicted and record.evaluation.variables.key() not in known
    }
    return [record.evaluation.as_dict() for record in solved], list(fresh.values())


def report(name: str, run: RunReader, reference: Reference, designs: Sequence[DesignVariables]) -> None:
    """Print the errors of the surface over these designs."""
    plain = reference_for(run.case, 2)
    resistance, efficiency, objectives, answered = [], [], [], 0
    for design in designs:
        told = evaluate(run.case, design, 2, reference)
        if not (isinstance(told, Ok) and told.predicted):
            continue
        truth = evaluate(run.case, design, 2, plain)
        if not isinstance(truth, Ok):
            continue
        answered += 1
        for one, other in zip(told.conditions, truth.conditions, strict=True):
            resistance.append(one.total_resistance / other.total_resistance - 1.0)
            efficiency.append(one.open_water_efficiency / other.open_water_efficiency - 1.0)
        objectives.append([told.objectives[key] / truth.objectives[key] - 1.0 for key in ("f1", "f2")])
    print(f"{name}: {len(designs)} designs, {answered} answered by the surface")
    for what, errors in (("Rt", resistance), ("eta0", efficiency), ("f1", [pair[0] for pair in objectives])):
        size = 100.0 * np.abs(errors)
        if size.size:
            print(f"  {what:5s} rms {np.sqrt(np.mean(size**2)):.4f} %, 95 % within {np.percentile(size, 95):.4f} %, "
                  f"greatest {size.max():.4f} %")  # fmt: skip


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    with as_file(asset_path("demo", "dtc-p4119.hpsop")) as shipped:
        parser.add_argument("run", type=Path, nargs="?", default=shipped, help="the shipped demonstration by default")
    parser.add_argument("--designs", type=int, default=60)
    asked = parser.parse_args()
    run = open_run(asked.run)
    solved, predicted = solved_and_predicted(run)
    reference, errors = learnt(run.case, reference_for(run.case, 2), solved, reference_for(run.case, 1))
    print(f"learnt from {len(solved)} solved designs; its own held-out error: {dict(errors)}")
    places = np.unique(np.linspace(0, len(predicted) - 1, asked.designs).astype(int)) if predicted else []
    report("asked for by the run, never solved", run, reference, [predicted[place] for place in places])
    space = run.case.bounds
    sample = [space.decode(vector) for vector in latin_hypercube(space, asked.designs, 60)]
    report("spread over the space", run, reference, sample)


if __name__ == "__main__":
    main()
