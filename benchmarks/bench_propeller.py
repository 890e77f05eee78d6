"""Times of the propeller's geometry and of the lifting line; least processor time of several runs.

OPENBLAS_NUM_THREADS=1 python benchmarks/bench_propeller.py
"""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import count as count_up

import numpy as np

from hpsop_core.geometry.clearance import propeller_clearance
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.mesh import hull_view_parts
from hpsop_core.geometry.propeller.mesh import propeller_mesh, propeller_view_parts
from hpsop_core.geometry.propeller.nurbs import blade_nurbs
from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag


def best(action: Callable[[], object], repeats: int = 20) -> float:
    """Least processor time in ms (other programs on the machine count little)."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return 1e3 * min(times)


def main() -> None:
    """Print the table."""
    parent = load_propeller()
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    drag = SectionDrag.full_scale(30e-6)
    seven = np.linspace(0.3, 0.9, 7)
    print("goals: 7 J <= 50 ms, 1 J <= 10 ms, view mesh <= 15 ms")
    for blades in (3, 5, 7):
        propeller = propeller_family(parent, 9.0, blades)
        prepared = lifting_line.prepare(propeller)
        print(f"Z = {blades}")
        print(f"  family member             {best(lambda z=blades: propeller_family(parent, 9.0, z)):7.2f} ms")
        print(f"  prepare the lifting line  {best(lambda p=propeller: lifting_line.prepare(p)):7.2f} ms")
        print(f"  + 7 J                     {best(lambda q=prepared: q.solve(seven, drag)):7.2f} ms")
        print(f"  + 1 J                     {best(lambda q=prepared: q.solve(0.7, drag)):7.2f} ms")
        print(f"  7 J from nothing          {best(lambda p=propeller: lifting_line.solve(p, seven, drag)):7.2f} ms")
        for name in ("drag", "view", "export"):
            count = len(propeller_mesh(propeller, name).faces)
            elapsed = best(lambda p=propeller, n=name: propeller_view_parts(p, n))
            print(f"  {name:6s} mesh, {count:6d} faces {elapsed:7.2f} ms")
        print(f"  blade as NURBS            {best(lambda p=propeller: blade_nurbs(p), 5):7.2f} ms")
        print(f"  clearance to the hull     {best(lambda p=propeller: propeller_clearance(hull, p)):7.2f} ms")
    ships, steps = load_parent_hull(), count_up()

    def new_design() -> None:
        """Another hull and another propeller at every call, so that nothing of the last one helps."""
        step = 1e-3 * next(steps)
        ship = ships.transform(350.0 + step, 50.0, 14.2, 165_000.0 + step, 0.5)
        hull_view_parts(ship, "view")
        propeller_view_parts(propeller_family(parent, 9.0 + step, 5, 1.0, 0.6 + step), "view")

    print("goal: view meshes of a new hull and propeller <= 30 ms, their geometry and hydrostatics included")
    print(f"  new design to meshes      {best(new_design):7.2f} ms")


if __name__ == "__main__":
    main()
