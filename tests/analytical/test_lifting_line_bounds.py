"""What no propeller exceeds, and identities."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.validation.propeller_level1 import actuator_disc_efficiency, betz_efficiency

ADVANCE = np.array([0.2, 0.4, 0.6, 0.8, 0.95])


def test_bounds_themselves() -> None:
    """Closed-form values: CT 1 and 3 at J 1."""
    thrust = np.array([1.0, 3.0]) * np.pi / 8.0
    assert np.allclose(actuator_disc_efficiency(thrust, np.ones(2)), [0.8284, 0.6667], atol=5e-5)
    # Betz by hand for J -> 0: kappa = eps = 1, CT = 2 w (1 + 3 w/2) = 1 gives w = 1/3, eta = 1.5/(4/3)^2. That is above
    # the disc's 0.8284, because Theodorsen's CT is on the wake's area: the lower of the two bounds counts.
    slow = np.pi * 1e-3**2 / 8.0
    assert betz_efficiency(slow, 1e-3) == pytest.approx(1.5 / (4.0 / 3.0) ** 2, rel=1e-4)
    # with rotation in the wake it falls below the disc
    assert betz_efficiency(float(thrust[0]), 1.0) < 0.8284


@pytest.mark.parametrize("blades", [3, 5, 7])
@pytest.mark.parametrize(("pitch", "area"), [(0.95, 0.5), (1.05, 0.5), (1.0, 0.607), (1.05, 1.0)])
def test_efficiency_stays_below_disc_and_betz_optimum(blades: int, pitch: float, area: float) -> None:
    propeller = propeller_family(load_propeller(), 9.0, blades, pitch, area)
    result = lifting_line.solve(propeller, ADVANCE, SectionDrag.inviscid())
    efficiency = result.open_water_efficiency
    assert np.all(efficiency < actuator_disc_efficiency(result.thrust_coefficient, ADVANCE))
    for j, kt, eta in zip(ADVANCE, result.thrust_coefficient, efficiency, strict=True):
        assert eta < betz_efficiency(float(kt), float(j))
    viscous = lifting_line.solve(propeller, ADVANCE, SectionDrag.full_scale(30e-6))
    assert np.all(viscous.open_water_efficiency < efficiency)


def test_efficiency_is_the_identity() -> None:
    propeller = propeller_family(load_propeller(), 9.0, 4)
    result = lifting_line.solve(propeller, ADVANCE, SectionDrag.full_scale())
    expected = ADVANCE * result.thrust_coefficient / (2.0 * np.pi * result.torque_coefficient)
    assert np.allclose(result.open_water_efficiency, expected, rtol=1e-12)


def test_section_drag_lines() -> None:
    """ITTC-78, worked by hand: Re 1e6, t/c 0.05 -> 0.00748; c/kp 1e5 -> 0.00687."""
    one = np.array(1.0)
    model = SectionDrag.model_scale(10.0, 1e-6)
    # n D^2/nu * (speed ratio) (chord ratio) = 10 * 1 / 1e-6 * 0.1 = 1e6 at D = 1
    value = float(model.ideal_coefficient(1.0, 0.1 * one, 0.05 * one, one))
    assert value == pytest.approx(2.0 * 1.1 * (0.044 * 0.1 - 5.0 * 1e-4), rel=1e-12)
    full = SectionDrag.full_scale(30e-6)
    value = float(full.ideal_coefficient(10.0, 0.3 * one, 0.05 * one, one))
    assert value == pytest.approx(2.2 * (1.89 + 1.62 * 5.0) ** -2.5, rel=1e-12)
    assert float(SectionDrag.inviscid().ideal_coefficient(10.0, one, one, one)) == 0.0
    # no fall of the model line at small Reynolds numbers
    low = model.ideal_coefficient(1.0, np.array([1e-4, 1e-3]), 0.05 * one, one)
    assert low[0] == low[1] == pytest.approx(2.2 * 0.004293, rel=1e-3)
