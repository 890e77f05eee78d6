"""Where a level-2 hull evaluation spends its time: both conditions of one design, one core.

    python benchmarks/bench_rankine.py [--refine FACTOR] [--repeat N]

Best of N, after one run that compiles the kernels; the reference line is a matrix product on the same core.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.panels import hull_panels
from hpsop_core.hydro.rankine import solver as rankine
from hpsop_core.hydro.rankine.grid import surface_grid
from hpsop_core.hydro.rankine.resistance import plane_resistance, wave_planes

FROUDE_NUMBERS = (0.22, 0.27)


def best(repeat: int, work: Callable[[], Any]) -> tuple[float, Any]:
    """Shortest wall time of ``repeat`` runs, with the last result."""
    times, result = [], None
    for _ in range(repeat):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


def main() -> None:
    """Print the split."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--refine", type=float, default=1.0)
    parser.add_argument("--repeat", type=int, default=5)
    chosen = parser.parse_args()
    settings = rankine.RankineSettings().refined(chosen.refine)
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    rankine.solve(hull, FROUDE_NUMBERS, settings)
    repeat = chosen.repeat
    gravity = 1.0 / np.array(FROUDE_NUMBERS) ** 2
    with threadpool_limits(limits=1):
        sample = np.random.default_rng(0).random((1500, 1500))
        product, _ = best(repeat, lambda: sample @ sample)
        geometry, body = best(repeat, lambda: hull_panels(hull, settings.hull_lengthwise, settings.hull_girthwise))
        panels, waterline = rankine.solver_axes(body)
        double_body, base = best(repeat, lambda: rankine.double_body(panels))
        meshing, grid = best(repeat, lambda: surface_grid(waterline, settings))
        assembly, system = best(repeat, lambda: rankine.surface_system(base, grid))
        one, strengths = best(repeat, lambda: rankine.surface_strengths(system, float(gravity[0])))
        both = np.stack([strengths, strengths], axis=1)
        on_hull = base.strengths[:, None] - system.elimination @ both
        planes = wave_planes(grid, settings)
        resistance, _ = best(repeat, lambda: plane_resistance(planes, panels, on_hull, grid, both, gravity))
    whole, result = best(repeat, lambda: rankine.solve(hull, FROUDE_NUMBERS, settings))
    print(f"unknowns {result.unknowns} ({panels.count} hull, {len(grid.area)} surface), best of {repeat}, one core")
    for name, seconds in (
        ("panels of the hull", geometry),
        ("double body: influence and LU", double_body),
        ("surface grid", meshing),
        ("surface: assembly and elimination", assembly),
        ("surface: solve, each condition", one),
        ("momentum planes, both conditions", resistance),
        ("whole design, both conditions", whole),
    ):
        print(f"{name:36s} {1000 * seconds:8.1f} ms  {seconds / product:6.2f} x a 1500^3 product")


if __name__ == "__main__":
    main()
