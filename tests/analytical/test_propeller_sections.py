"""Blade sections and radial tables against closed forms and published ordinates."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.geometry.propeller.radial_table import RadialTable
from hpsop_core.geometry.propeller.sections import (
    IDEAL_ANGLE_PER_CAMBER,
    IDEAL_LIFT_PER_CAMBER,
    ZERO_LIFT_ANGLE_PER_CAMBER,
    half_thickness,
    mean_line,
)


def test_mean_line_is_the_published_a08_line() -> None:
    # PROPAN's analytic column, printed to 5 digits
    published = {0.005: 0.04224, 0.1: 0.44781, 0.3: 0.86294, 0.5: 0.99930, 0.8: 0.70224, 0.95: 0.17111}
    for fraction, value in published.items():
        assert float(mean_line(np.array(fraction))) == pytest.approx(value, abs=1e-5)
    assert np.allclose(mean_line(np.array([0.0, 1.0])), 0.0, atol=1e-14)


def test_zero_lift_angle_follows_from_the_mean_line() -> None:
    """Thin-section theory on our own ordinates: alpha_L0 = (1/pi) int dy/dx (1 - cos theta) dtheta."""
    theta = (np.arange(20000) + 0.5) * np.pi / 20000
    x = 0.5 * (1.0 - np.cos(theta))
    step = 1e-6
    ahead, behind = np.clip(x + step, 0.0, 1.0), np.clip(x - step, 0.0, 1.0)
    slope = (mean_line(ahead) - mean_line(behind)) / (ahead - behind)
    zero_lift = np.mean(slope * (1.0 - np.cos(theta)))
    ideal = np.mean(slope)
    # the logarithmic ends of the slope leave a few 1e-4
    assert zero_lift == pytest.approx(ZERO_LIFT_ANGLE_PER_CAMBER, rel=2e-3)
    assert ideal == pytest.approx(IDEAL_ANGLE_PER_CAMBER, rel=5e-3)
    assert 2.0 * np.pi * (ideal - zero_lift) == pytest.approx(IDEAL_LIFT_PER_CAMBER, rel=2e-3)


def test_thickness_has_its_maximum_its_nose_and_a_closed_edge() -> None:
    x = np.linspace(0.0, 1.0, 2001)
    open_edge = half_thickness(x, closed=False)
    assert float(open_edge.max()) == pytest.approx(0.5, abs=1e-4)
    assert float(open_edge[-1]) == pytest.approx(0.0333, abs=1e-9)
    assert float(half_thickness(np.array(1.0))) == pytest.approx(0.0, abs=1e-12)
    small = 1e-6
    # y = sqrt(2 rho x) at the nose, rho = 0.448 t^2/c
    assert float(half_thickness(np.array(small))) == pytest.approx(np.sqrt(2 * 0.448 * small), rel=2e-3)


def test_expanded_area_of_p4119() -> None:
    parent = load_propeller()
    # published 0.6; the table integrates to 0.607
    assert parent.blade_count * parent.expanded_area_ratio_per_blade == pytest.approx(0.607, abs=0.005)


def test_expanded_area_of_an_elliptic_blade_is_exact() -> None:
    """Chord c0 sqrt((1 - r)(r - h)) integrates to c0 pi/8 (1 - h)^2."""
    hub = 0.2
    tau = np.linspace(np.sqrt(1.0 - hub), 0.0, 60)
    radius = 1.0 - tau**2
    radius[0], radius[-1] = hub, 1.0
    chord = np.sqrt(np.maximum((1.0 - radius) * (radius - hub), 0.0))
    flat = np.full_like(radius, 0.05)
    table = RadialTable("ellipse", radius, chord + 1e-9, flat + 1.0, 0 * flat, 0 * flat, flat, 0 * flat, 4)
    exact = 2.0 / np.pi * np.pi / 8.0 * (1.0 - hub) ** 2
    # the chord has a root at the hub too, where the table's variable does not resolve it
    assert table.expanded_area_ratio_per_blade == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize("blades", [2, 3, 5, 7])
@pytest.mark.parametrize("area", [0.3, 0.607, 1.0])
def test_family_rules(blades: int, area: float) -> None:
    parent = load_propeller()
    member = propeller_family(parent, 8.0, blades, 1.03, area)
    assert blades * member.table.expanded_area_ratio_per_blade == pytest.approx(area, rel=1e-12)
    thickness = member.table.chord_ratio * member.table.thickness_ratio
    expected = parent.chord_ratio * parent.thickness_ratio * (3.0 / blades) ** (2.0 / 3.0)
    assert np.allclose(thickness, expected, rtol=1e-12, atol=0.0)
    assert np.allclose(member.table.pitch_ratio, 1.03 * parent.pitch_ratio, rtol=1e-14)
    assert member.pitch_diameter_ratio_07R == pytest.approx(1.03 * 1.0839, rel=1e-9)
    assert np.array_equal(member.table.camber_ratio, parent.camber_ratio)
    assert member.hub_ratio == 0.2


def test_the_parent_comes_back_from_the_family() -> None:
    parent = load_propeller()
    member = propeller_family(parent, 9.0, 3)
    for name in ("chord_ratio", "pitch_ratio", "thickness_ratio", "camber_ratio", "skew", "rake_ratio"):
        assert np.array_equal(getattr(member.table, name), getattr(parent, name)), name


def test_table_reads_back_its_own_rows() -> None:
    parent = load_propeller()
    sections = parent.at(parent.radius_ratio)
    assert np.allclose(sections.chord_ratio, parent.chord_ratio, atol=1e-12)
    assert np.allclose(sections.thickness_ratio, parent.thickness_ratio, atol=1e-12)
    between = parent.at(np.linspace(0.2, 1.0, 801)).chord_ratio
    assert between.min() >= 0.0 and between.max() < 0.4622 + 2e-3
