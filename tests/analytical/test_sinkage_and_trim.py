"""Level 2's sinkage and trim against forces that are summed here over its pressures, in ship axes."""

from __future__ import annotations

import numpy as np
import pytest
from hand_calculation import BASE

from hpsop_core import evaluate
from hpsop_core.evaluation.fields import hull_pressure
from hpsop_core.evaluation.shapes import design_hull


def test_sinkage_and_trim_balance_the_pressures() -> None:
    case = BASE.replaced("constants", wave_calibration="none", stated_wave_coefficients=())
    result = evaluate(case, None, 2)
    assert result.ok
    hull = design_hull(case, case.initial.variables)
    line = hull.waterline(401)
    x, breadth = line[:, 0], 2.0 * line[:, 1]
    area = float(np.trapezoid(breadth, x))
    middle = float(np.trapezoid(breadth * x, x)) / area
    inertia = float(np.trapezoid(breadth * (x - middle) ** 2, x))
    for index, condition in enumerate(result.conditions):
        field = hull_pressure(case, result, condition=index)
        corners = field.points[field.quads]
        centre = corners.mean(axis=1)
        # Half the cross product of the diagonals: outwards, towards the water that presses inwards.
        outward = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        force = -field.pressure[:, None] * outward
        lift = float(force[:, 2].sum())
        lever_x, lever_z = centre[:, 0] - middle, centre[:, 2] - hull.draft
        # About +y, to port: what turns the bow down.
        bow_down = float(np.sum(lever_z * force[:, 0] - lever_x * force[:, 2]))
        weight = 1025.0 * 9.80665
        trim = bow_down / (weight * inertia)
        sinkage = -lift / (weight * area) + trim * (0.5 * hull.length - middle)
        # Flat panels and a waterline of other points: some per cent.
        assert condition.sinkage == pytest.approx(sinkage, rel=0.05)
        assert condition.trim == pytest.approx(trim, rel=0.08, abs=2e-6)
        assert condition.sinkage > 0.0, "a ship under way sits deeper"
