"""Why points of the validation miss: one thing changed at a time, beside what was measured.

Nothing here is a correction: each study shows what a suspected cause is worth.
"""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from hpsop_core.assets import read_asset_text
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.input import ReadOptions, read_hull
from hpsop_core.geometry.propeller.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels.settings import BladePanelSettings
from hpsop_core.hydro.blade_panels.solver import solve
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.rankine import solver as rankine
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.propeller_level1 import MODEL_DIAMETER, reference_rows
from hpsop_core.validation.published_hulls import MODEL_LENGTH
from hpsop_core.validation.published_propellers import (
    B_SERIES,
    KP505_DIAMETER,
    KP505_RATE,
    VISCOSITY,
    b_series_drag,
    published_propeller,
)

Rows = Iterator[tuple[str, ...]]
SLOPE_HEAD = ("propeller", "J", "level 1", "level 2", "level 2, wake at the blade's pitch")
CAMBER_HEAD = (
    "propeller",
    "camber",
    "K_T at J 0.5, 0.7, 0.9 in %",
    "10 K_Q in %",
    "eta_0 in %",
    "K_T a blade at J 0.9",
)
SINKAGE_HEAD = ("Fn", "measured", "fixed", "sunk", "fixed, mesh x 1.25", "sinkage in % of the draught")


def _measured(name: str, advance: tuple[float, ...]) -> tuple[Array, Array, Array]:
    """J, KT and KQ of a test, at the J asked for."""
    rows = reference_rows(f"{name}_openwater.csv")
    table = {round(float(row["J"]), 3): (float(row["KT"]), float(row["10KQ"]) / 10.0) for row in rows}
    kt, kq = np.array([table[j] for j in advance]).T
    return np.array(advance), kt, kq


def _propellers() -> Iterator[tuple[str, Propeller, SectionDrag, tuple[Array, Array, Array]]]:
    """Propellers whose curves were measured or fitted as tables, with the drag of their tests."""
    set_a = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == "A" and float(row["J"]) < 1.0]
    j, kt, kq = (np.array([float(row[key]) for row in set_a]) for key in ("J", "KT", "10KQ"))
    model = SectionDrag.model_scale(10.0, VISCOSITY)
    yield "P4119, set A", propeller_family(load_propeller(), MODEL_DIAMETER, 3), model, (j, kt, kq / 10.0)
    for blades, name in B_SERIES.items():
        propeller = published_propeller(f"bseries_{name}", blades, 1.0)
        yield f"B{blades}", propeller, b_series_drag(propeller), _measured(f"bseries_{name}", (0.5, 0.7, 0.9))
    propeller = published_propeller("kp505", 5, KP505_DIAMETER)
    drag = SectionDrag.model_scale(KP505_RATE, VISCOSITY)
    yield "KP505", propeller, drag, _measured("kp505", (0.5, 0.7, 0.9))


def slopes_by_wake_pitch() -> Rows:
    """Slope of KT over J, over the measured one."""
    for name, propeller, drag, (advance, kt, _) in _propellers():
        fixed = BladePanelSettings(wake="geometric_pitch")
        curves = (
            lifting_line.solve(propeller, advance, drag),
            solve(propeller, advance, drag).open_water,
            solve(propeller, advance, drag, fixed).open_water,
        )
        measured = float(np.polyfit(advance, kt, 1)[0])
        ratios = (float(np.polyfit(advance, curve.thrust_coefficient, 1)[0]) / measured for curve in curves)
        yield (name, f"{advance[0]:g} to {advance[-1]:g}", *(f"{ratio:.2f}" for ratio in ratios))


def thrust_by_camber() -> Rows:
    """Errors of level 2 with the tabulated camber, and with the camber at which thrust is about right."""
    for name, propeller, drag, (advance, kt, kq) in _propellers():
        if name.startswith("P4119"):
            continue
        efficiency = advance * kt / (2.0 * np.pi * kq)
        for share in (1.0, 1.3 if name == "KP505" else 0.75):
            table = replace(propeller.table, camber_ratio=share * propeller.table.camber_ratio)
            own = solve(replace(propeller, table=table), advance, drag).open_water
            yield (
                name,
                f"x {share:g}",
                _errors(own.thrust_coefficient, kt),
                _errors(own.torque_coefficient, kq),
                _errors(own.open_water_efficiency, efficiency),
                f"{float(own.thrust_coefficient[-1] - kt[-1]) / propeller.blade_count:+.4f}",
            )


def _errors(own: Array, measured: Array) -> str:
    return ", ".join(f"{100.0 * (float(a) / float(b) - 1.0):+.1f}" for a, b in zip(own, measured, strict=True))


def series_60_sunk() -> Rows:
    """10^3 Cw of Series 60, fixed, and in water that stands higher by the computed first-order sinkage; no trim."""
    numbers = (0.2672, 0.2794, 0.2915, 0.3037, 0.3158)
    rows = {float(row["Fn"]): row for row in reference_rows("series60_cb060_resistance.csv")}
    fixed = _series_60(0.0)
    surface = fixed.hydrostatics.wetted_surface
    finer = rankine.solve(fixed, numbers, rankine.RankineSettings().refined(1.25)).conditions
    for number, own, fine in zip(numbers, rankine.solve(fixed, numbers).conditions, finer, strict=True):
        sunk = _series_60(own.sinkage)
        found = rankine.solve(sunk, [number]).conditions[0].wave_coefficient
        found *= sunk.hydrostatics.wetted_surface / surface
        measured = 0.5 * (float(rows[number]["CW_k010_e3"]) + float(rows[number]["CW_k013_e3"]))
        values = (measured, 1e3 * own.wave_coefficient, 1e3 * found, 1e3 * fine.wave_coefficient)
        yield (f"{number:g}", *(f"{value:.2f}" for value in values), f"{100.0 * own.sinkage / fixed.draft:.1f}")


def _series_60(sinkage: float) -> Hull:
    """The hull of Todd's table floating deeper, in m; the table reaches to half as much draught again."""
    text = read_asset_text("reference", "series60_cb060_offsets.csv")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    head, *stations = csv.reader(io.StringIO("\n".join(lines)))
    breadth = MODEL_LENGTH / 7.5
    draft = breadth / 2.5
    points = ["station_x_m,waterline_z_m,half_breadth_m"]
    for station, *offsets in stations:
        x = MODEL_LENGTH * (1.0 - float(station) / 20.0)
        for name, offset in zip(head[1:], offsets, strict=True):
            height = float(name.removeprefix("wl_")) * draft
            points.append(f"{x:.6f},{height:.6f},{0.5 * breadth * float(offset):.6f}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "series60.csv"
        path.write_text("\n".join(points) + "\n", encoding="utf-8")
        return read_hull(path, ReadOptions(length=MODEL_LENGTH, draft=draft + sinkage)).hull
