"""A pair of panels in Capytaine and here, in one process on one core.

    pip install capytaine; OMP_NUM_THREADS=1 python benchmarks/bench_capytaine.py

Capytaine (a panel method for ships in waves, Fortran) assembles potential and normal velocity of flat source panels in
unbounded water: its Rankine part, without the wave part that makes most of its usual work. Ours gives the three
components of the velocity, each panel with its mirror image: two pairs at a time. Capytaine is no dependency of hpsop.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from hpsop_core.hydro.singularities.source_panels import flat_panels, panel_velocities


def least(repeat: int, work: Callable[[], object]) -> float:
    """Least processor time of this thread in s."""
    times = []
    for _ in range(repeat + 1):
        start = time.thread_time()
        work()
        times.append(time.thread_time() - start)
    return min(times[1:])


def main() -> None:
    """Print the times of a pair and their ratio."""
    try:
        import capytaine
    except ImportError:
        print("capytaine is not installed: pip install capytaine")
        return
    mesh = capytaine.mesh_sphere(radius=10.0, center=(0.0, 20.0, -30.0), resolution=(30, 30))
    green = capytaine.Delhommeau()
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    panels = flat_panels(vertices[faces])
    theirs = least(3, lambda: green.evaluate(mesh, mesh, free_surface=np.inf, water_depth=np.inf, wavenumber=0.0))
    ours = least(3, lambda: panel_velocities(panels.centre, panels, image_z=False))
    pairs = panels.count**2
    print(f"{panels.count} panels, Capytaine {capytaine.__version__}")
    print(f"Capytaine, potential and normal velocity     {1e9 * theirs / pairs:8.1f} ns a pair")
    print(f"hpsop, three components, exact where near     {1e9 * ours / (2 * pairs):8.1f} ns a pair")
    print(f"ratio Capytaine over hpsop                    {2.0 * theirs / ours:8.2f}")


if __name__ == "__main__":
    main()
