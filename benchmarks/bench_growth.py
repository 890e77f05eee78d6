"""How the cost of a level-2 answer grows, and how far it stands above LAPACK: ratios within one process.

    python benchmarks/bench_growth.py [--repeat N] [--variables]

Processor time of this thread, least of N. Beside each mesh stand the factorisations that it cannot do without (the
hull's matrix in double precision, the surface's in single precision once a condition), done by LAPACK alone on random
matrices of the same sizes: the share of the solve that no other code would save. Wave coefficients beside them say what
a finer mesh would buy.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import lu_factor
from threadpoolctl import threadpool_limits

from hpsop_core.case.case import load_case
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.hydro.rankine import solver as rankine
from hpsop_core.hydro.singularities.source_panels import flat_panels, panel_velocities

FACTORS = (0.8, 1.0, 1.1, 1.25, 1.5)


def least(repeat: int, work: Callable[[], Any]) -> tuple[float, Any]:
    """Least processor time of this thread in s, with the last result."""
    times, result = [], None
    for _ in range(repeat):
        start = time.thread_time()
        result = work()
        times.append(time.thread_time() - start)
    return min(times), result


def factorisation(size: int, kind: type[np.floating[Any]], repeat: int) -> float:
    """LAPACK's LU of a random matrix, in s."""
    matrix = np.random.default_rng(0).random((size, size)).astype(kind)
    return least(repeat, lambda: lu_factor(matrix, check_finite=False))[0]


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=3)
    repeat = parser.parse_args().repeat
    case = load_case("dtc-p4119")
    hull = design_hull(case, case.initial.variables)
    froude_numbers = case.froude_numbers
    with threadpool_limits(limits=1):
        rankine.solve(hull, froude_numbers)
        print("panels     hull  surface  ms     over LAPACK's LUs  10^3 Cw at each condition")
        base = None
        for factor in FACTORS:
            settings = rankine.RankineSettings().refined(factor)
            seconds, result = least(repeat, lambda settings=settings: rankine.solve(hull, froude_numbers, settings))
            panels = result.unknowns - settings.rows * (
                settings.columns_along_hull + settings.columns_upstream + settings.columns_downstream
            )
            surface = result.unknowns - panels
            floor = factorisation(panels, np.float64, repeat)
            floor += len(froude_numbers) * factorisation(surface, np.float32, repeat)
            waves = ", ".join(f"{1e3 * point.wave_coefficient:.4f}" for point in result.conditions)
            print(f"x {factor:4.2f}   {panels:6d} {surface:8d}  {1e3 * seconds:6.1f} {seconds / floor:10.2f}  {waves}")
            base = seconds if factor == 1.0 else base
        print("conditions  ms     over one condition")
        one = None
        for count in (1, 2, 4, 6):
            asked = tuple(float(x) for x in np.linspace(froude_numbers[0], froude_numbers[-1], count))
            seconds, _ = least(repeat, lambda asked=asked: rankine.solve(hull, asked))
            one = one or seconds
            print(f"{count:6d}   {1e3 * seconds:7.1f} {seconds / one:7.2f}")
        quads = np.random.default_rng(1).random((600, 1, 3)) * 50.0 + np.array(
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
        )
        panels_600 = flat_panels(quads)
        points = np.random.default_rng(2).random((600, 3)) * 50.0 - np.array([0.0, 0.0, 60.0])
        far, _ = least(repeat, lambda: panel_velocities(points, panels_600, image_z=True))
        near, _ = least(repeat, lambda: panel_velocities(points, panels_600, image_z=True, far_diagonals=1e3))
        pairs = 4 * 600 * 600
        print(
            f"influence of a source panel at a point: {1e9 * far / pairs:.1f} ns far, {1e9 * near / pairs:.1f} ns exact"
        )


if __name__ == "__main__":
    main()
