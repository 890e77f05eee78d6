"""A small search over both levels, its front as a drawing.

python examples/small_optimisation.py [--generations 20] [--population 16] [--to front.svg] [--run my.hpsop]
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hpsop_core import load_case, open_run, optimize
from hpsop_core.charts.looks import Sheet
from hpsop_core.charts.search import Cloud, Front, Mark, pareto_chart, window
from hpsop_core.charts.style import PRINT
from hpsop_core.runs.events import RunEvent
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord
from hpsop_core.typing_aliases import Array


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generations", type=int, default=20)
    parser.add_argument("--population", type=int, default=16)
    parser.add_argument("--to", type=Path, default=Path("front.svg"))
    parser.add_argument("--run", type=Path, help="keep the run in this file; called again, it goes on")
    asked = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        path = asked.run or Path(folder) / "small.hpsop"
        optimize(
            load_case("dtc-p4119"),
            path,
            generations=asked.generations,
            level1_generations=max(1, asked.generations * 2 // 3),
            population=asked.population,
            progress=tell,
        )
        run = open_run(path)
        asked.to.write_text(drawing(run), encoding="utf-8")
        print(f"{len(run.front())} designs on the front; drawn in {asked.to}")


def tell(event: RunEvent) -> None:
    """One line a generation."""
    if event.kind == "generation":
        now = event.snapshot
        print(f"generation {now.generation} of {now.generations}, level {now.level}: {now.hypervolume:.5f}")


def objectives(records: Sequence[DesignRecord]) -> Array:
    """(n, 2) of those that could be computed."""
    found = [record.evaluation.objectives for record in records if record.evaluation.ok]
    return np.array([(value["f1"], value["f2"]) for value in found], dtype=float).reshape(-1, 2)


def drawing(run: RunReader) -> str:
    """The last generation's front, the rest of its population and the initial design, as the report draws them."""
    front, members = objectives(run.front()), objectives(run.members())
    initial = objectives([run.initial(run.generations()[-1].level)])
    plot = pareto_chart(
        clouds=[Cloud(members, "archive", key="population")],
        fronts=[Front(front, "front", key="front")] if len(front) else [],
        marks=[Mark(*initial[0], "square", 4.5, "initial", "initial design", "initial design")],
        limits=window(np.concatenate([front, initial]), members),
        titles=(run.case.objectives.first, run.case.objectives.second),
        sheet=Sheet(480.0, 360.0, PRINT),
    )
    return plot.file_svg("pareto")


if __name__ == "__main__":
    main()
