"""Levels 1 and 2 of the propeller must agree, or the hand-over between them would reshuffle the front."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core.geometry.propeller.propeller import RadialTable, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels import solver as blade_panels
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag


@pytest.mark.parametrize("blades", [3, 4, 5, 6, 7])
def test_thrust_and_torque_of_both_levels(blades: int) -> None:
    advance = np.array([0.5, 0.7])
    drag = SectionDrag.full_scale(30e-6)
    for pitch in (0.95, 1.05):
        propeller = propeller_family(load_propeller(), 9.0, blades, pitch)
        first = lifting_line.solve(propeller, advance, drag)
        second = blade_panels.solve(propeller, advance, drag).open_water
        # 4 % in KT at J 0.7 is the aim; KQ and J 0.5 are held to the same
        assert np.allclose(first.thrust_coefficient, second.thrust_coefficient, rtol=0.04)
        assert np.allclose(first.torque_coefficient, second.torque_coefficient, rtol=0.04)


def raked_and_skewed(rake: float, skew_degrees: float) -> RadialTable:
    """P4119 with rake over D at the tip, linear, and skew that grows with the square of the radius."""
    parent = load_propeller()
    outward = (parent.radius_ratio - parent.hub_ratio) / (1.0 - parent.hub_ratio)
    return replace(parent, rake_ratio=rake * outward, skew=np.radians(skew_degrees) * outward**2)


@pytest.mark.parametrize(("rake", "skew"), [(0.1, 0.0), (0.18, 0.0), (-0.1, 0.0), (0.0, 30.0), (0.1, 30.0)])
@pytest.mark.parametrize("blades", [3, 7])
def test_levels_agree_on_raked_and_skewed_blades(blades: int, rake: float, skew: float) -> None:
    propeller = propeller_family(raked_and_skewed(rake, skew), 1.0, blades)
    advance, drag = np.array([0.7]), SectionDrag.inviscid()
    first = lifting_line.solve(propeller, advance, drag).thrust_coefficient[0]
    second = blade_panels.solve(propeller, advance, drag).open_water.thrust_coefficient[0]
    # Level 1's forces know no rake and no skew, so 8 %; with normals that do not lean with the blade it was 22 %.
    assert first == pytest.approx(second, rel=0.08)
