"""A design's numbers as CSV tables; offsets and the radial table are in the form in which users give theirs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.evaluation.curves import resistance_points
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.export.offsets import offsets_csv
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.input import COLUMNS
from hpsop_core.geometry.propeller.propeller import Propeller

_STATIONS = ((-0.02, 0.06, 33), (0.06, 0.2, 22), (0.2, 0.8, 25), (0.8, 0.94, 22), (0.94, 1.035, 39))
_HEIGHTS = ((0.0, 0.1, 7), (0.1, 1.0, 28))
_RADII = 21


def _csv(header: Sequence[str], rows: Sequence[Sequence[float]]) -> str:
    lines = [",".join(header)]
    lines += [",".join(f"{value:.9g}" for value in row) for row in rows]
    return "\n".join(lines) + "\n"


def _joined(pieces: tuple[tuple[float, float, int], ...]) -> list[float]:
    return [float(value) for value in np.unique(np.concatenate([np.linspace(*piece) for piece in pieces]).round(6))]


def offsets_table(hull: Hull) -> str:
    """Half-breadths of the whole hull, dense at the ends, in m; `hpsop resistance --offsets` reads it."""
    x = np.array(_joined(_STATIONS)) * hull.length
    deck = hull.parent.deck_height * hull.scale[2]
    above = np.linspace(hull.draft, 0.997 * deck, 14)[1:]
    bottom = hull.parent.lowest * hull.scale[2]
    return offsets_csv(hull, x, np.concatenate([bottom + np.array(_joined(_HEIGHTS)) * (hull.draft - bottom), above]))


def propeller_table(propeller: Propeller) -> str:
    """The design's own radial table; `hpsop open-water --geometry` reads it."""
    table = propeller.table
    columns = (
        table.radius_ratio, table.chord_ratio, table.pitch_ratio, np.degrees(table.skew), table.rake_ratio,
        table.thickness_ratio, table.camber_ratio,
    )  # fmt: skip
    head = f"# D {propeller.diameter:.6g} m, Z {propeller.blade_count}, EAR {propeller.expanded_area_ratio:.4f}\n"
    return head + _csv(COLUMNS, np.stack(columns, axis=1).tolist())


def hydrostatics_table(hull: Hull) -> str:
    """Sectional areas in m2, with the hydrostatics as comments above them."""
    h = hull.hydrostatics
    numbers = {
        "length between perpendiculars [m]": hull.length, "breadth [m]": hull.breadth, "draft [m]": hull.draft,
        "displaced volume [m3]": h.displaced_volume, "wetted surface [m2]": h.wetted_surface,
        "LCB from AP [m]": h.longitudinal_centre_of_buoyancy, "KB [m]": h.vertical_centre_of_buoyancy,
        "BMt [m]": h.transverse_metacentric_radius, "waterplane area [m2]": h.waterplane_area,
        "CB": h.block_coefficient, "CP": h.prismatic_coefficient, "CM": h.midship_coefficient,
        "CWP": h.waterplane_coefficient,
    }  # fmt: skip
    head = "".join(f"# {name}: {value:.7g}\n" for name, value in numbers.items())
    rows = np.stack([h.sectional_area_x, h.sectional_area], axis=1)
    return head + _csv(("station_x_m", "sectional_area_m2"), rows.tolist())


def resistance_table(case: Case, evaluation: Evaluation, reference: Reference) -> str:
    """Resistance over Froude number at the evaluation's level, calibrated as the evaluation was.

    Raises:
        SolverFailure: a speed cannot be computed.
    """
    points = resistance_points(case, evaluation, reference)
    header = (
        "froude_number", "speed_m_s", "friction_coefficient", "wave_coefficient", "friction_resistance_N",
        "wave_resistance_N", "total_resistance_N", "form_resistance_N", "correlation_resistance_N", "air_resistance_N",
        "appendage_resistance_N",
    )  # fmt: skip
    rows = [
        (
            p.froude_number, p.speed, p.friction_coefficient, p.wave_coefficient, p.friction_resistance,
            p.wave_resistance, p.total_resistance, p.form_resistance, p.correlation_resistance, p.air_resistance,
            p.appendage_resistance,
        )
        for p in points
    ]  # fmt: skip
    head = f"# level {evaluation.level}; total = friction + form + wave + correlation + air + appendage\n"
    return head + _csv(header, rows)


def open_water_table(evaluation: Evaluation) -> str:
    """The open-water curves at full scale and the evaluation's level."""
    if not evaluation.ok:
        return ""
    curve = evaluation.open_water
    header = ("advance_coefficient", "thrust_coefficient", "torque_coefficient", "open_water_efficiency")
    columns = (
        curve.advance_coefficient, curve.thrust_coefficient, curve.torque_coefficient, curve.open_water_efficiency
    )  # fmt: skip
    return f"# full scale, level {evaluation.level}\n" + _csv(header, list(zip(*columns, strict=True)))
