"""Tables of the propeller's theory pages in docs, computed anew.

python -m hpsop_core.validation.propeller_studies
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.propeller.propeller import Propeller, RadialTable, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels.settings import BladePanelSettings, HubSettings
from hpsop_core.hydro.blade_panels.solver import forces_of, solve
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.lifting_line.solver import LiftingLineSettings
from hpsop_core.hydro.open_water import OpenWater
from hpsop_core.hydro.section_drag import CAMBER_KEPT, OFF_DESIGN_FACTOR, SectionDrag
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.propeller_level1 import MODEL_DIAMETER, reference_rows
from hpsop_core.validation.propeller_level2 import fine_rigid_wake
from hpsop_core.validation.published_propellers import B_SERIES, b_series_drag, open_water_at, published_propeller

MODEL_SCALE = SectionDrag.model_scale(10.0, 1.0e-6)
GRIDS = ((20, 10), (24, 10), (32, 12), (40, 16), (60, 20), (80, 24))
OPTIMISER, AUDIT = BladePanelSettings(), replace(BladePanelSettings.fine(), forces="circulation")

Rows = Iterator[Sequence[str]]


def skewed_table(skew_degrees: float, rake: float = 0.0) -> RadialTable:
    """P4119 with skew that grows with the square of the radius to a value at the tip, and linear rake over D."""
    parent = load_propeller()
    outward = (parent.radius_ratio - parent.hub_ratio) / (1.0 - parent.hub_ratio)
    return replace(parent, skew=np.radians(skew_degrees) * outward**2, rake_ratio=rake * outward)


def model_propeller() -> Propeller:
    """P4119 as it was tested."""
    return propeller_family(load_propeller(), MODEL_DIAMETER, 3)


def experiment(name: str) -> tuple[Array, Array, Array]:
    """(J, KT, 10KQ) of a set of open-water tests of P4119."""
    rows = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == name]
    j, kt, kq = (np.array([float(row[key]) for row in rows]) for key in ("J", "KT", "10KQ"))
    return j, kt, kq


def _percent(value: float, reference: float) -> str:
    return f"{100.0 * (value / reference - 1.0):+.1f} %"


def _against_experiment(result: OpenWater) -> Rows:
    advance, kt, kq = experiment("A")
    other = {float(j): (a, b) for j, a, b in zip(*experiment("B"), strict=True)}
    for i, j in enumerate(advance):
        thrust, torque = float(result.thrust_coefficient[i]), 10.0 * float(result.torque_coefficient[i])
        yield (
            f"{j:.3f}", f"{kt[i]:.3f}", f"{thrust:.4f}", _percent(thrust, kt[i]),
            f"{kq[i]:.3f}", f"{torque:.4f}", _percent(torque, kq[i]),
            "{:.3f} / {:.3f}".format(*other[float(j)]),
        )  # fmt: skip


def level_1_against_experiment() -> Rows:
    """Model scale."""
    return _against_experiment(lifting_line.solve(model_propeller(), experiment("A")[0], MODEL_SCALE))


def level_2_against_experiment() -> Rows:
    """Model scale, optimiser's grid."""
    return _against_experiment(solve(model_propeller(), experiment("A")[0], MODEL_SCALE).open_water)


def against_propan() -> Rows:
    """Without viscosity: level 2 at PROPAN's settings by pressures and circulation, PROPAN, level 1."""
    fine = fine_rigid_wake()
    advance = fine.open_water.advance_coefficient
    circulation = forces_of(fine, "circulation")
    line = lifting_line.solve(model_propeller(), advance, SectionDrag.inviscid())
    for i, row in enumerate(reference_rows("p4119_propan.csv")):
        kt, kq = float(row["KT_blade_inv"]), float(row["10KQ_blade_inv"])
        ours, torque = float(fine.open_water.thrust_coefficient[i]), 10.0 * float(fine.open_water.torque_coefficient[i])
        yield (
            row["J"], f"{kt:.4f}", f"{ours:.4f}", _percent(ours, kt), f"{circulation[0][i]:.4f}",
            f"{kq:.4f}", f"{torque:.4f}", _percent(torque, kq), f"{10.0 * circulation[1][i]:.4f}",
            _percent(float(line.thrust_coefficient[i]), kt),
        )  # fmt: skip


def grid_convergence() -> Rows:
    """P4119 at model scale, J 0.5 and 0.833, on ever finer grids."""
    for chordwise, radial in GRIDS:
        hub = HubSettings(5, 6, 36) if chordwise >= 60 else HubSettings()
        start = time.process_time()
        result = solve(model_propeller(), [0.5, 0.833], MODEL_SCALE, BladePanelSettings(chordwise, radial, hub=hub))
        elapsed = time.process_time() - start
        pressure = forces_of(result, "pressure")
        cells = [f"{chordwise} x {radial}", str(result.model.onset_points.shape[0])]
        for i in range(2):
            water = result.open_water
            cells.append(f"{water.thrust_coefficient[i]:.4f} / {10.0 * water.torque_coefficient[i]:.4f}")
            cells.append(f"{pressure[0][i]:.4f} / {10.0 * pressure[1][i]:.4f}")
        yield (*cells, f"{elapsed:.2f}")


def grid_over_the_family() -> Rows:
    """Largest difference of the optimiser's grid to 80 x 24 panels over J 0.5 to 0.9, without viscosity."""
    advance = [0.5, 0.6, 0.7, 0.833, 0.9]
    members = [("P4119", 3, 0.607, 0.0, 0.0), ("", 5, 0.607, 0.0, 0.0), ("", 7, 0.607, 0.0, 0.0)]
    members += [("", 2, 0.3, 0.0, 0.0), ("", 3, 1.1, 0.0, 0.0), ("", 7, 1.1, 0.0, 0.0)]
    members += [("", 4, 0.607, 40.0, 0.0), ("", 5, 0.8, 25.0, 0.1)]
    for name, blades, area, skew, rake in members:
        propeller = propeller_family(skewed_table(skew, rake), 1.0, blades, 1.0, area)
        label = name or f"Z {blades}, EAR {area:g}" + (f", skew {skew:g} degrees, rake {rake:g} D" if skew else "")
        try:
            coarse, fine = (
                solve(propeller, advance, SectionDrag.inviscid(), settings).open_water
                for settings in (OPTIMISER, AUDIT)
            )
        except SolverFailure as failure:
            yield label, f"refused: {failure.reason}", ""
            continue
        thrust = 100.0 * (coarse.thrust_coefficient / fine.thrust_coefficient - 1.0)
        torque = 100.0 * (coarse.torque_coefficient / fine.torque_coefficient - 1.0)
        yield (
            label, f"{thrust.min():+.2f} to {thrust.max():+.2f}", f"{torque.min():+.2f} to {torque.max():+.2f}",
        )  # fmt: skip


def levels_over_the_family() -> Rows:
    """Level 1 over level 2 less one, full-scale drag."""
    advance, drag = [0.5, 0.7, 0.85], SectionDrag.full_scale()
    for blades, pitch, area in (
        (3, 0.95, 0.607), (3, 1.05, 0.607), (4, 1.0, 0.607), (5, 0.95, 0.607), (5, 1.05, 0.607), (6, 1.0, 0.607),
        (7, 0.95, 0.607), (7, 1.05, 0.607), (3, 0.95, 1.0), (7, 1.05, 1.0), (3, 1.0, 0.4),
    ):  # fmt: skip
        propeller = propeller_family(load_propeller(), 9.0, blades, pitch, area)
        first = lifting_line.solve(propeller, advance, drag)
        second = solve(propeller, advance, drag).open_water
        ratios = (
            first.thrust_coefficient / second.thrust_coefficient,
            first.torque_coefficient / second.torque_coefficient,
        )
        cells = [", ".join(f"{100.0 * (r - 1.0):+.1f}" for r in ratio) for ratio in ratios]
        yield (str(blades), f"{pitch:g}", f"{area:g}", *cells)


def levels_on_raked_and_skewed_blades() -> Rows:
    """Level 1 over level 2 less one at J 0.7, without viscosity."""
    for rake, skew in ((0.0, 0.0), (0.1, 0.0), (0.18, 0.0), (-0.1, 0.0), (0.0, 30.0), (0.0, 55.0), (0.1, 30.0)):
        cells = []
        for blades in (3, 5, 7):
            propeller = propeller_family(skewed_table(skew, rake), 1.0, blades)
            first = lifting_line.solve(propeller, [0.7], SectionDrag.inviscid()).thrust_coefficient[0]
            second = solve(propeller, [0.7], SectionDrag.inviscid()).open_water.thrust_coefficient[0]
            cells.append(f"{100.0 * (first / second - 1.0):+.1f}")
        yield (f"{rake:g}", f"{skew:g}", *cells)


def cavitation_and_grid() -> Rows:
    """Least Cp + sigma and cavitating share of the back at full scale, D 9 m, n 1.6 1/s, P0 - Pv 1.95e5 Pa."""
    for blades, area in ((3, 0.607), (5, 0.607), (7, 0.607), (7, 1.0)):
        propeller = propeller_family(load_propeller(), 9.0, blades, 1.0, area)
        for chordwise, radial in ((24, 10), (48, 16), (80, 24)):
            result = solve(
                propeller, [0.65, 0.75, 0.9], SectionDrag.full_scale(), BladePanelSettings(chordwise, radial)
            )
            table = result.pressure_table()
            margins = [table.margin(j, 9.0, 1.6, 1025.0, 1.95e5) for j in (0.65, 0.75, 0.9)]
            cells = [f"{m.margin:+.2f}, {100.0 * m.cavitating_share:.1f} %" for m in margins]
            yield (f"{blades}, {area:g}", f"{chordwise} x {radial}", *cells)


def strips_of_level_1() -> Rows:
    """KT of P4119 at J 0.5 by the number of strips."""
    for strips in (8, 10, 16, 24):
        result = lifting_line.solve(model_propeller(), [0.5], MODEL_SCALE, LiftingLineSettings(strips=strips))
        yield (str(strips), f"{result.thrust_coefficient[0]:.4f}")


def drag_factor_on_the_b_series() -> Rows:
    """Error of efficiency in % over J by k of the section drag, level 1: what one k does from heavy to light load."""
    for blades, name in B_SERIES.items():
        rows = {
            round(float(row["J"]), 2): float(row["eta0"]) for row in reference_rows(f"bseries_{name}_openwater.csv")
        }
        propeller = published_propeller(f"bseries_{name}", blades, 1.0)
        advance = np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
        for factor in (0.0, 3.0, OFF_DESIGN_FACTOR, 10.0):
            drag = replace(b_series_drag(propeller), off_design_factor=factor)
            own = lifting_line.solve(propeller, advance, drag).open_water_efficiency
            cells = [f"{100.0 * (a / rows[round(float(j), 2)] - 1.0):+.1f}" for a, j in zip(own, advance, strict=True)]
            yield (f"B{blades}", f"{factor:g}", *cells)


def camber_at_full_scale() -> Rows:
    """Change of KT, KQ and efficiency in % where a full-scale blade keeps more of its camber, D 9 m, J 0.7."""
    for blades in (3, 5, 7):
        propeller = propeller_family(load_propeller(), 9.0, blades)
        chord_07 = float(propeller.table.at_07R.chord_ratio)
        scaled = SectionDrag.full_scale(camber_scaling="reynolds")
        gain = scaled.camber_gain(propeller.diameter, chord_07)
        for level in (1, 2):
            base = open_water_at(level, propeller, np.array([0.7]), SectionDrag.full_scale())
            changed = open_water_at(level, propeller, np.array([0.7]), scaled)
            pairs = (
                (changed.thrust_coefficient, base.thrust_coefficient),
                (changed.torque_coefficient, base.torque_coefficient),
                (changed.open_water_efficiency, base.open_water_efficiency),
            )
            cells = (f"{100.0 * (float(a[0]) / float(b[0]) - 1.0):+.2f}" for a, b in pairs)
            yield (str(blades), f"{level}", f"{gain * CAMBER_KEPT:.3f}", *cells)


_EXPERIMENT_HEAD = ("J", "KT test", "KT", "error", "10KQ test", "10KQ", "error", "set B: KT / 10KQ")
_LEVELS_HEAD = ("Z", "m", "EAR", "KT at J 0.5, 0.7, 0.85 in %", "KQ in %")
DRAG_FACTOR_HEAD = ("propeller", "k", "J 0.3", "0.4", "0.5", "0.6", "0.7", "0.8")
CAMBER_HEAD = ("Z", "level", "camber kept", "KT in %", "KQ in %", "efficiency in %")
TABLES = (
    ("Level 1, P4119, model scale", _EXPERIMENT_HEAD, level_1_against_experiment),
    ("Level 1, strips", ("strips", "KT at J 0.5"), strips_of_level_1),
    ("Level 2, P4119, model scale", _EXPERIMENT_HEAD, level_2_against_experiment),
    (
        "Without viscosity, against PROPAN",
        ("J", "KT PROPAN", "KT", "error", "KT circ.", "10KQ PROPAN", "10KQ", "error", "10KQ circ.", "level 1, KT"),
        against_propan,
    ),
    (
        "Grid convergence, P4119",
        ("panels", "unknowns", "J 0.5 circ.", "J 0.5 press.", "J 0.833 circ.", "J 0.833 press.", "CPU s"),
        grid_convergence,
    ),
    ("Grid over the family", ("propeller", "KT in %", "KQ in %"), grid_over_the_family),
    ("Levels over the family", _LEVELS_HEAD, levels_over_the_family),
    ("Levels on raked and skewed blades", ("rake/D", "skew", "Z 3", "Z 5", "Z 7"), levels_on_raked_and_skewed_blades),
    ("k on the B-series", DRAG_FACTOR_HEAD, drag_factor_on_the_b_series),
    ("Camber at full scale", CAMBER_HEAD, camber_at_full_scale),
    ("Cavitation", ("Z, EAR", "panels", "J 0.65", "J 0.75", "J 0.9"), cavitation_and_grid),
)


def main() -> int:
    """Print every table as Markdown; about a minute."""
    for title, head, rows in TABLES:
        lines = ["", title, "", f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
        lines += [f"| {' | '.join(row)} |" for row in rows()]
        sys.stdout.write("\n".join(lines) + "\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
