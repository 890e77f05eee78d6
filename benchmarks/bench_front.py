"""How soon the recommended run has its front: hypervolume against time, beside the same run without a learnt surface.

    python benchmarks/bench_front.py --to FOLDER [--seeds 1 2 3] [--exact-seed 1] [--workers 2] [--generations 150]

Each run is whole: population and generations of the case, workers started within its time, every evaluation on disk.
Errors of the final front are left out: they come when the front stands. The run without a surface solves each of its
level-2 designs: its last front's hypervolume is what 99.5 % are taken of. What counts is solved designs alone, also
where a surface's predictions stand on a generation's front meanwhile. Times are the wall's, from the call of
``optimize``. A run that FOLDER holds already is read, not made again; its times are then those of its first making.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

from hpsop_core.case.case import load_case
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.optimization.indicators import hypervolume
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.reader import open_run

SHARE = 0.995


def course(path: Path, seed: int, workers: int, surface: bool, generations: int | None) -> list[tuple[float, float]]:
    """Seconds since the run was asked for and the hypervolume of what level 2 had solved, generation by generation.

    Args:
        path: of the run file.
        seed, workers, surface, generations: of the run; generations as the case has them where None.
    """
    note = path.with_suffix(".json")
    if not note.exists():
        case = load_case("dtc-p4119").replaced("optimization", surface=surface, final_errors=False, seed=seed)
        begun = time.time()
        # the case's share of level 1
        first = None if generations is None else 2 * generations // 3
        optimize(case, path, generations=generations, level1_generations=first, workers=workers)
        note.write_text(json.dumps({"begun": begun, "ended": time.time()}))
    times = json.loads(note.read_text())
    run = open_run(path)
    solved = [
        point for point in run.archive(TRUTH.number) if not point.predicted and point.feasible and point.objectives
    ]
    rows = []
    for record in run.generation_records():
        number = record.generation.number
        if record.generation.level == TRUTH.number:
            points = [point.objectives for point in solved if point.generation <= number and point.objectives]
            rows.append((record.finished_at - times["begun"], hypervolume(points)))
    rows.append((times["ended"] - times["begun"], rows[-1][1]))
    return rows


def told(name: str, path: Path, rows: list[tuple[float, float]], wanted: float) -> None:
    """One line, and the course in ten steps."""
    run = open_run(path)
    points = run.archive()
    true = [point for point in points if point.level == TRUTH.number]
    predicted = sum(point.predicted for point in true)
    reached = next((seconds for seconds, volume in rows if volume >= SHARE * wanted), None)
    words = "not reached" if reached is None else f"after {reached:.0f} s"
    print(
        f"{name:22s} {rows[-1][0]:6.0f} s, {len(points) - len(true)} of level 1, {len(true) - predicted} solved, "
        f"{predicted} predicted; hypervolume {rows[-1][1]:.6f} ({100.0 * rows[-1][1] / wanted:.2f} %); "
        f"{100.0 * SHARE:g} % {words}"
    )
    step = max(1, len(rows) // 10)
    print("   " + "  ".join(f"{seconds:.0f} s {100.0 * volume / wanted:.2f} %" for seconds, volume in rows[::step]))


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--to", type=Path, required=True)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--exact-seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--generations", type=int)
    asked = parser.parse_args()
    asked.to.mkdir(parents=True, exist_ok=True)
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {asked.workers} workers")
    exact = asked.to / f"exact-{asked.exact_seed}.hpsop"
    rows = course(exact, asked.exact_seed, asked.workers, False, asked.generations)
    wanted = rows[-1][1]
    told(f"exact, seed {asked.exact_seed}", exact, rows, wanted)
    for seed in asked.seeds:
        path = asked.to / f"surface-{seed}.hpsop"
        told(f"surface, seed {seed}", path, course(path, seed, asked.workers, True, asked.generations), wanted)
    print(f"load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
