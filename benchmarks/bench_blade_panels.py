"""Times of the blade panel method on the optimiser's grid, with the split; least processor time of several runs.

OPENBLAS_NUM_THREADS=1 python benchmarks/bench_blade_panels.py
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy.linalg import lu_factor

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.blade_panels.grid import blade_grid, helical_wake
from hpsop_core.hydro.blade_panels.hub_grid import hub_grid
from hpsop_core.hydro.blade_panels.model import BladePanelModel, blade_panel_model, rotating_onset
from hpsop_core.hydro.blade_panels.potential import factorise
from hpsop_core.hydro.blade_panels.settings import WAKE_PITCH_COUNT, BladePanelSettings
from hpsop_core.hydro.blade_panels.solver import solve
from hpsop_core.hydro.section_drag import SectionDrag


def best(action: Callable[[], object], repeats: int = 8) -> float:
    """Least processor time in ms (other programs on the machine count little)."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return 1e3 * min(times)


def conditions(model: BladePanelModel, advance: np.ndarray, drag: SectionDrag) -> None:
    for j in advance:
        model.forces(model.condition(float(j)), drag)


def main() -> None:
    """Print the table."""
    drag = SectionDrag.full_scale()
    advance = np.linspace(0.25, 1.15, 7)
    settings = BladePanelSettings()
    print(f"goal: 7 J <= 200 ms; grid {settings.text}")
    for blades in (3, 5, 7):
        propeller = propeller_family(load_propeller(), 9.0, blades)
        grid = blade_grid(propeller, settings.chordwise_panels, settings.radial_panels)
        hub = hub_grid(grid, blades, settings.hub, 2.0)
        onset = rotating_onset(np.concatenate([grid.onset_points.reshape(-1, 3), hub.collocation]))
        body = factorise(grid.surface, blades, onset, hub)
        pitch = np.full(grid.radius_edges.size, 2.0)
        wake = helical_wake(grid, pitch, settings.wake_grid)
        model = blade_panel_model(propeller, settings, True)
        count = onset.shape[0]
        matrix = np.random.default_rng(0).normal(size=(count, count)) + count * np.eye(count)
        panels = best(
            lambda p=propeller, b=blades: hub_grid(
                blade_grid(p, settings.chordwise_panels, settings.radial_panels), b, settings.hub, 2.0
            )
        )
        assembly = best(lambda g=grid, b=blades, o=onset, h=hub: factorise(g.surface, b, o, h))
        factor = best(lambda m=matrix: lu_factor(m, check_finite=False))
        one_wake = best(lambda g=grid, p=pitch: helical_wake(g, p, settings.wake_grid)) + best(
            lambda b=body, w=wake: b.wake_potential(*w)
        )
        kutta = best(lambda m=model: conditions(m, advance, drag))
        print(f"Z = {blades}: {count} unknowns, {wake[0].count} wake panels")
        print(f"  panels                                 {panels:7.1f} ms")
        print(f"  assembly and factor                    {assembly:7.1f} ms, of which factor {factor:.1f} ms")
        print(f"  {WAKE_PITCH_COUNT} wakes                                {WAKE_PITCH_COUNT * one_wake:7.1f} ms")
        print(f"  7 J: Kutta condition, alignment, force {kutta:7.1f} ms")
        print(f"  7 J from nothing                       {best(lambda p=propeller: solve(p, advance, drag)):7.1f} ms")


if __name__ == "__main__":
    main()
