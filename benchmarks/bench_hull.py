"""Times of the hull's geometry; best of several runs on one core.

OPENBLAS_NUM_THREADS=1 python benchmarks/bench_hull.py
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.mesh import hull_mesh, hull_view_parts


def best(action: Callable[[], object], repeats: int = 30) -> float:
    """Shortest time in ms."""
    action()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def main() -> None:
    """Print the table."""
    start = time.perf_counter()
    parent = load_parent_hull()
    parent.transform(355.0, 51.0, 14.5, 170_000.0)
    print(f"load the parent and integrate it once {1e3 * (time.perf_counter() - start):8.1f} ms")
    box = 360.0 * 50.0 * 14.2
    print("goals: new design with hydrostatics <= 5 ms, view mesh of the hull well below 30 ms")
    print(f"  scaled only                         {best(lambda: parent.transform(360.0, 50.0, 14.2)):8.2f} ms")
    for block in (0.61, 0.66, 0.74):
        elapsed = best(lambda b=block: parent.transform(360.0, 50.0, 14.2, b * box, 1.0))
        print(f"  form CB {block:.2f} with hydrostatics     {elapsed:8.2f} ms")
    elapsed = best(lambda: parent.transform(360.0, 50.0, 14.2, 0.80 * box))
    print(f"  clipped form                        {elapsed:8.2f} ms")
    hull = parent.transform(360.0, 50.0, 14.2, 0.70 * box)
    print(f"  offset table {hull.offset_table().y.shape}              {best(hull.offset_table):8.2f} ms")
    u, v = np.linspace(0.0, 1.0, 61), np.linspace(0.0, 1.0, 21)
    print(f"  61 x 21 points of the main patch    {best(lambda: hull.patch_points('main', u, v)):8.2f} ms")
    for name in ("drag", "view", "export"):
        faces = len(hull_mesh(hull, name).faces)
        elapsed = best(lambda n=name: hull_view_parts(hull, n))
        print(f"  {name:6s} mesh, {faces:6d} faces          {elapsed:8.2f} ms")
    elapsed = best(lambda: [hull.nurbs_patch(name) for name in parent.underwater], 5)
    print(f"  exchange surfaces below the water   {elapsed:8.2f} ms")


if __name__ == "__main__":
    main()
