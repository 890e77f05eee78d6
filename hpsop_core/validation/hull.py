"""Checks of the hull's geometry against the published ship, closed forms and its own watertight mesh."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hpsop_core.geometry.hull.form import LEAST_STRETCH
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.input import parent_hull_from_offsets
from hpsop_core.geometry.hull.mesh import hull_mesh, underwater_mesh
from hpsop_core.scratch import scratch_folder
from hpsop_core.validation.check import FITTED, HELD_OUT, Check, absolute_check, labelled, relative_check

GROUP = "hull geometry"
SHIP = "public DTC geometry at full scale, T = 14.5 m (El Moctar et al. 2012)"


def _bound(quantity: str, computed: float, bound: float, source: str, below: bool = True) -> Check:
    passed = computed <= bound if below else computed >= bound
    return Check(GROUP, quantity, computed, bound, source, "at most" if below else "at least", passed)


def _wigley_table() -> str:
    """Half-breadths of the parabolic Wigley hull, L/B 10, B/T 1.6, 81 x 21 points."""
    lines = ["station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, 100.0, 81):
        for z in np.linspace(0.0, 6.25, 21):
            y = 5.0 * (1.0 - (x / 50.0 - 1.0) ** 2) * (1.0 - ((6.25 - z) / 6.25) ** 2)
            lines.append(f"{x:.6f},{z:.6f},{y:.6f}")
    return "\n".join(lines) + "\n"


def checks() -> Iterator[Check]:
    """All checks of the hull, a few seconds in all."""
    yield from labelled(FITTED, _ship_checks())
    yield from labelled(HELD_OUT, _closed_form_checks())
    yield from _family_checks()


def _ship_checks() -> Iterator[Check]:
    parent = load_parent_hull()
    length, breadth, draft = parent.length, parent.breadth, parent.draft
    hull = parent.transform(length, breadth, draft)
    hydro = hull.hydrostatics
    yield relative_check(GROUP, "DTC displaced volume [m3]", hydro.displaced_volume, 173_398.0, SHIP, 0.002)
    yield relative_check(GROUP, "DTC wetted surface [m2]", hydro.wetted_surface, 22_044.0, SHIP, 0.007)
    yield absolute_check(
        GROUP, "DTC centre of buoyancy from AP [m]", hydro.longitudinal_centre_of_buoyancy, 174.06, SHIP, 0.15
    )
    yield absolute_check(GROUP, "DTC block coefficient", hydro.block_coefficient, 0.6605, SHIP, 0.002)
    yield relative_check(GROUP, "DTC waterplane area [m2]", hydro.waterplane_area, 15_314.0, SHIP, 0.002)


def _closed_form_checks() -> Iterator[Check]:
    with scratch_folder("validation") as folder:
        path = Path(folder) / "wigley.csv"
        path.write_text(_wigley_table(), encoding="utf-8")
        wigley = parent_hull_from_offsets(path, 100.0, 6.25).hydrostatics
    source = "closed form of the parabolic hull, given as an 81 x 21 table"
    yield relative_check(GROUP, "Wigley S/L^2", wigley.wetted_surface / 1e4, 0.14879, source, 1e-3)
    yield relative_check(GROUP, "Wigley block coefficient", wigley.block_coefficient, 4.0 / 9.0, source, 1e-3)


def _family_checks() -> Iterator[Check]:
    parent = load_parent_hull()
    length, breadth, draft = parent.length, parent.breadth, parent.draft
    box = length * breadth * draft
    own = parent.hydrostatics
    for block, shift in ((0.60, 0.0), (0.75, 0.0), (own.block_coefficient, -0.01), (own.block_coefficient, 0.01)):
        hull = parent.transform(length, breadth, draft, block * box, shift * length)
        name = f"form CB {block:.3f}, LCB {100 * shift:+.0f} % L"
        yield relative_check(
            GROUP, f"{name}: block coefficient", hull.hydrostatics.block_coefficient, block, "what was asked", 1e-6
        )
        yield _bound(f"{name}: least dx'/dx", hull.shift.least_stretch(), LEAST_STRETCH, "no folded sections", False)
        mesh = underwater_mesh(hull, "export")
        yield relative_check(
            GROUP, f"{name}: displaced volume [m3]", hull.hydrostatics.displaced_volume, float(mesh.volume),
            "volume of the watertight mesh", 5e-4,
        )  # fmt: skip
        closed = hull_mesh(hull, "view")
        yield Check(GROUP, f"{name}: view mesh closed", float(closed.is_watertight), 1.0, "every edge has two faces",
                    "exact", bool(closed.is_watertight))  # fmt: skip
