"""Level 1 against the open-water tests of P4119."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.validation.propeller_level1 import MODEL_DIAMETER, reference_rows


def columns(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rows = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == name]
    return tuple(np.array([float(row[key]) for row in rows]) for key in ("J", "KT", "10KQ"))  # type: ignore[return-value]


def test_set_a_over_the_working_range() -> None:
    advance, kt, kq = columns("A")
    working = advance <= 0.9
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    result = lifting_line.solve(model, advance[working], SectionDrag.model_scale(10.0, 1e-6))
    # 5 %, the aim; the lift factor and the off-design drag are fitted on these eight numbers, and on nothing else
    assert np.all(np.abs(result.thrust_coefficient / kt[working] - 1.0) < 0.05)
    assert np.all(np.abs(10.0 * result.torque_coefficient / kq[working] - 1.0) < 0.05)
    assert result.reynolds_number_07R is not None
    # chord .4622 D at 0.7 R, n D^2/nu = 9.29e5, sqrt(J^2 + 2.2^2)
    assert result.reynolds_number_07R[1] == pytest.approx(9.29e5 * 0.4622 * np.hypot(0.7, 0.7 * np.pi), rel=1e-3)


def test_without_the_fit() -> None:
    """No lift factor and no off-design drag: 12 %. Potential flow lifts too much, and drag is missing at J 0.5."""
    advance, kt, kq = columns("A")
    working = advance <= 0.9
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    result = lifting_line.solve(
        model,
        advance[working],
        SectionDrag.model_scale(10.0, 1e-6, off_design_factor=0.0),
        lifting_line.LiftingLineSettings(camber_effectiveness=1.0),
    )
    assert np.all(np.abs(result.thrust_coefficient / kt[working] - 1.0) < 0.12)
    assert np.all(np.abs(10.0 * result.torque_coefficient / kq[working] - 1.0) < 0.12)


def test_points_that_were_not_fitted() -> None:
    """Set A at J 1.1 and set B: read-offs rounded to 0.005, so absolute."""
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    drag = SectionDrag.model_scale(10.0, 1e-6)
    advance, kt, kq = columns("A")
    light = advance > 1.0
    result = lifting_line.solve(model, advance[light], drag)
    assert np.all(np.abs(result.thrust_coefficient - kt[light]) < 0.01)
    assert np.all(np.abs(10.0 * result.torque_coefficient - kq[light]) < 0.02)
    advance, kt, kq = columns("B")
    result = lifting_line.solve(model, advance, drag)
    assert np.all(np.abs(result.thrust_coefficient - kt) < 0.015)
    assert np.all(np.abs(10.0 * result.torque_coefficient - kq) < 0.025)
