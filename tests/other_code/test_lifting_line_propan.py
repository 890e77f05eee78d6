"""Level 1 without viscosity against PROPAN's panel results for P4119."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.validation.propeller_level1 import reference_rows


def test_inviscid_thrust_and_torque() -> None:
    rows = reference_rows("p4119_propan.csv")
    advance, kt, kq = (np.array([float(row[key]) for row in rows]) for key in ("J", "KT_blade_inv", "10KQ_blade_inv"))
    result = lifting_line.solve(propeller_family(load_propeller(), 1.0, 3), advance, SectionDrag.inviscid())
    # PROPAN's wake is rigid at the geometric pitch; ours is 18 % finer at J 0.5, worth 4 % there. From J 0.8 on ours
    # lifts more: two bound vortices lift 2 to 4 % more than our own panels, and those 2 to 6 % more than PROPAN's.
    low = advance <= 0.75
    assert np.all(np.abs(result.thrust_coefficient / kt - 1.0)[low] < 0.06)
    assert np.all(np.abs(10.0 * result.torque_coefficient / kq - 1.0)[low] < 0.06)
    assert np.all(np.abs(result.thrust_coefficient - kt) < 0.02)
    assert np.all(np.abs(10.0 * result.torque_coefficient - kq) < 0.03)
