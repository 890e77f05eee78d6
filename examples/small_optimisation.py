"""A small search over both levels, its front as a drawing.

python examples/small_optimisation.py [--generations 20] [--population 16] [--to front.svg] [--run my.hpsop]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from hpsop_core import load_case, open_run, optimize
from hpsop_core.runs.events import RunEvent
from hpsop_core.runs.reader import RunReader


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


def drawing(run: RunReader, width: float = 480.0, height: float = 360.0, margin: float = 60.0) -> str:
    """The last generation's front (filled), the rest of its population (open) and the initial design (a cross)."""
    front = {record.id for record in run.front()}
    members = [record for record in run.members() if record.evaluation.ok]
    initial = run.initial(members[0].evaluation.level).evaluation
    places = [record.evaluation.objectives for record in members] + [initial.objectives]
    (x0, x1), (y0, y1) = (
        (min(place[name] for place in places), max(place[name] for place in places)) for name in ("f1", "f2")
    )

    def at(place: dict[str, float]) -> tuple[float, float]:
        x = margin + (width - 2 * margin) * (place["f1"] - x0) / max(x1 - x0, 1e-9)
        return x, height - margin - (height - 2 * margin) * (place["f2"] - y0) / max(y1 - y0, 1e-9)

    marks = []
    for record in members:
        x, y = at(record.evaluation.objectives)
        fill = "#0b6" if record.id in front else "none"
        marks.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{fill}" stroke="#0b6"/>')
    x, y = at(initial.objectives)
    marks.append(f'<path d="M{x - 5:.1f} {y:.1f}h10M{x:.1f} {y - 5:.1f}v10" stroke="#c33" stroke-width="2"/>')
    names = run.case.objectives
    words = [
        f'<text x="{width / 2}" y="{height - 15}" text-anchor="middle">{names.first}: {x0:.4f} to {x1:.4f}</text>',
        f'<text x="20" y="{height / 2}" text-anchor="middle" transform="rotate(-90 20 {height / 2})">'
        f"{names.second}: {y0:.4f} to {y1:.4f}</text>",
    ]
    frame = f'<rect x="{margin - 15}" y="{margin - 15}" width="{width - 2 * margin + 30}" '
    frame += f'height="{height - 2 * margin + 30}" fill="none" stroke="#888"/>'
    body = "\n".join([frame, *marks, *words])
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" font-family="sans-serif">'
    return f"{head}\n{body}\n</svg>\n"


if __name__ == "__main__":
    main()
