"""Checks of the blade panel method against another code, experiment, itself on a finer grid, and bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels.settings import BladePanelSettings
from hpsop_core.hydro.blade_panels.solver import BladePanelResult, forces_of, solve
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.check import FITTED, HELD_OUT, Check, absolute_check, labelled, relative_check
from hpsop_core.validation.propeller_level1 import (
    EXPERIMENT,
    MODEL_DIAMETER,
    actuator_disc_efficiency,
    betz_efficiency,
    reference_rows,
)

GROUP = "propeller, level 2"
PEER = "PROPAN panel code, rigid wake at the geometric pitch"
OWN = "this method on 80 x 24 panels"
WORKING_RANGE = (0.5, 0.9)


@lru_cache(maxsize=1)
def fine_rigid_wake() -> BladePanelResult:
    """P4119 without viscosity on 80 x 24 panels at PROPAN's settings: rigid wake, blade forces from the pressures."""
    advance = np.array([float(row["J"]) for row in reference_rows("p4119_propan.csv")])
    settings = replace(BladePanelSettings.fine(), wake="geometric_pitch")
    return solve(_model(), advance, SectionDrag.inviscid(), settings)


@lru_cache(maxsize=1)
def experiment_points() -> tuple[Array, Array, Array]:
    """(J, KT, 10KQ) of set A within the working range."""
    rows = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == "A"]
    table = np.array([[float(row[name]) for name in ("J", "KT", "10KQ")] for row in rows])
    table = table[(table[:, 0] >= WORKING_RANGE[0]) & (table[:, 0] <= WORKING_RANGE[1])]
    return table[:, 0], table[:, 1], table[:, 2]


def _model() -> Propeller:
    return propeller_family(load_propeller(), MODEL_DIAMETER, 3)


def checks() -> Iterator[Check]:
    """All checks of the panel method; about ten seconds, each group when it is asked for."""
    yield from _geometry_checks()
    yield from _grid_checks()
    yield from labelled(HELD_OUT, _peer_checks())
    yield from labelled(FITTED, _experiment_checks())
    yield from _level_checks()
    yield from _bound_checks()


def _geometry_checks() -> Iterator[Check]:
    defect = float(np.max(solve(_model(), np.array([0.8]), SectionDrag.inviscid()).model.row_sum_defect))
    yield absolute_check(GROUP, "row sums of the dipole matrix + 2 pi, worst", defect, 0.0, "Gauss's theorem", 0.1)


def _grid_checks() -> Iterator[Check]:
    fine = fine_rigid_wake()
    advance = fine.open_water.advance_coefficient
    kt, kq = forces_of(fine, "circulation")
    coarse = solve(_model(), advance, SectionDrag.inviscid(), BladePanelSettings(wake="geometric_pitch")).open_water
    for i, j in enumerate(advance):
        if WORKING_RANGE[0] <= j <= WORKING_RANGE[1]:
            label = f"P4119 without viscosity J {j:g}"
            yield relative_check(
                GROUP, f"{label}: KT on 24 x 10 panels", float(coarse.thrust_coefficient[i]), float(kt[i]), OWN, 0.01
            )
            yield relative_check(
                GROUP,
                f"{label}: 10KQ on 24 x 10 panels",
                10.0 * float(coarse.torque_coefficient[i]),
                10.0 * float(kq[i]),
                OWN,
                0.01,
            )
            yield relative_check(
                GROUP,
                f"{label}: KT by pressures, 80 x 24",
                float(fine.open_water.thrust_coefficient[i]),
                float(kt[i]),
                "Kutta-Joukowski forces on the same grid",
                0.04,
            )
            yield relative_check(
                GROUP,
                f"{label}: 10KQ by pressures, 80 x 24",
                10.0 * float(fine.open_water.torque_coefficient[i]),
                10.0 * float(kq[i]),
                "Kutta-Joukowski forces on the same grid",
                0.04,
            )


def _peer_checks() -> Iterator[Check]:
    result = fine_rigid_wake().open_water
    for i, row in enumerate(reference_rows("p4119_propan.csv")):
        j = float(row["J"])
        kt, kq = float(result.thrust_coefficient[i]), 10.0 * float(result.torque_coefficient[i])
        peer_kt, peer_kq = float(row["KT_blade_inv"]), float(row["10KQ_blade_inv"])
        label = f"P4119 without viscosity J {j:g}"
        if j <= WORKING_RANGE[1]:
            tolerance = 0.05 if j > WORKING_RANGE[0] else 0.07
            yield relative_check(GROUP, f"{label}: KT", kt, peer_kt, PEER, tolerance)
            yield relative_check(GROUP, f"{label}: 10KQ", kq, peer_kq, PEER, tolerance)
        else:
            yield absolute_check(GROUP, f"{label}: KT", kt, peer_kt, PEER, 0.007)
            yield absolute_check(GROUP, f"{label}: 10KQ", kq, peer_kq, PEER, 0.008)


def _experiment_checks() -> Iterator[Check]:
    advance, kt, kq = experiment_points()
    result = solve(_model(), advance, SectionDrag.model_scale(10.0, 1.0e-6)).open_water
    for i, j in enumerate(advance):
        yield relative_check(
            GROUP, f"P4119 J {j:g}: KT", float(result.thrust_coefficient[i]), float(kt[i]), EXPERIMENT, 0.08
        )
        yield relative_check(
            GROUP, f"P4119 J {j:g}: 10KQ", 10.0 * float(result.torque_coefficient[i]), float(kq[i]), EXPERIMENT, 0.08
        )


def _level_checks() -> Iterator[Check]:
    drag = SectionDrag.full_scale()
    for blades, pitch in ((3, 0.95), (3, 1.05), (4, 1.0), (5, 1.0), (6, 1.0), (7, 0.95), (7, 1.05)):
        propeller = propeller_family(load_propeller(), 9.0, blades, pitch)
        advance = np.array([0.7])
        panels = float(solve(propeller, advance, drag).open_water.thrust_coefficient[0])
        line = float(lifting_line.solve(propeller, advance, drag).thrust_coefficient[0])
        yield relative_check(
            GROUP, f"Z {blades}, pitch x {pitch:g}, J 0.7: KT at both levels", panels, line, "level 1", 0.04
        )


def _bound_checks() -> Iterator[Check]:
    advance = np.array([0.3, 0.5, 0.7, 0.9])
    disc, betz = -1.0, -1.0
    for blades, pitch, area in ((3, 1.0, None), (5, 0.95, 0.6), (7, 1.05, 1.0)):
        result = solve(
            propeller_family(load_propeller(), 1.0, blades, pitch, area), advance, SectionDrag.inviscid()
        ).open_water
        efficiency = result.open_water_efficiency
        disc = max(disc, float(np.max(efficiency - actuator_disc_efficiency(result.thrust_coefficient, advance))))
        ideal = [betz_efficiency(float(kt), float(j)) for kt, j in zip(result.thrust_coefficient, advance, strict=True)]
        betz = max(betz, float(np.max(efficiency - np.array(ideal))))
    for name, excess in (("actuator disc", disc), ("Betz optimum, endless blades", betz)):
        yield Check(
            GROUP,
            f"greatest efficiency without drag, less that of the {name}",
            excess,
            0.0,
            f"{name}, closed form",
            "never above 0",
            excess <= 0.0,
        )
