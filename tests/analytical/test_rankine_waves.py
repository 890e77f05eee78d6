"""Waves of the Rankine solver against linear theory: Kelvin, Michell, Havelock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from hpsop_core.geometry.analytic_bodies import wigley_half_breadth, wigley_panels
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.hydro import michell
from hpsop_core.hydro.rankine.solver import RankineFields, RankineSettings, solve, solve_panels
from hpsop_core.validation.rankine_studies import deep_body_settings, submerged_sphere

DEFAULT = RankineSettings()


def wave_number(distance: np.ndarray, elevation: np.ndarray, expected: float) -> float:
    """Least-squares wave number of a cosine that decays with the square root of the distance, plus a constant."""
    trials = expected * np.linspace(0.7, 1.3, 601)
    misfits = []
    envelope = 1.0 / np.sqrt(distance)
    for trial in trials:
        basis = [envelope * np.cos(trial * distance), envelope * np.sin(trial * distance), np.ones_like(distance)]
        matrix = np.stack(basis, axis=1)
        misfits.append(np.sum((matrix @ np.linalg.lstsq(matrix, elevation, rcond=None)[0] - elevation) ** 2))
    return float(trials[int(np.argmin(misfits))])


@pytest.mark.parametrize("froude_number", [0.25, 0.31])
def test_transverse_wave_length_behind_a_submerged_sphere(froude_number: float) -> None:
    # A deep body makes hardly any diverging waves, so that the track shows 2 pi Fn^2 L alone. 5 % of
    # it is 0.02 to 0.03 L, no more than one cell of the surface.
    settings = replace(DEFAULT, downstream=1.5, columns_downstream=52)
    result = solve_panels(submerged_sphere(0.05, 0.15), [froude_number], settings, fields=True)
    fields = result.conditions[0].fields
    assert fields is not None
    behind = 1.0 - fields.x[:, 0]
    window = (behind > 1.0) & (behind < 2.1)
    found = wave_number(behind[window] - 0.5, fields.elevation[window, 0], 1.0 / froude_number**2)
    assert 2.0 * np.pi / found == pytest.approx(2.0 * np.pi * froude_number**2, rel=0.05)


def upstream_share(fields: RankineFields, length: float, ahead: float) -> float:
    """Largest elevation more than ``ahead`` lengths before FP over the largest anywhere."""
    before = fields.x / length > 1.0 + ahead
    return float(np.max(np.abs(fields.elevation[before])) / np.max(np.abs(fields.elevation)))


@pytest.mark.parametrize("froude_number", [0.22, 0.27])
def test_no_waves_ahead_of_the_bow(froude_number: float) -> None:
    # Without a radiation condition waves would be as high ahead as behind. The double body's own rise ahead of a bow
    # falls like 1/distance^2: a tenth is the most that it may leave a fifth of a length ahead.
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    result = solve(hull, [froude_number], fields=True)
    fields = result.conditions[0].fields
    assert fields is not None
    assert upstream_share(fields, hull.length, 0.2) < 0.10
    # and the rise has one sign: a wave would have two.
    before = fields.elevation[fields.x[:, 0] > 1.15 * hull.length, 0]
    assert np.all(before > 0.0)


@pytest.mark.parametrize(("froude_number", "lower", "upper"), [(0.313, 0.90, 1.0), (0.25, 0.85, 1.05)])
def test_thin_ship_limit(froude_number: float, lower: float, upper: float) -> None:
    # A thin hull leaves Michell's waves, of which a grid of about 2,600 unknowns may lose a tenth and gain nothing; the
    # shorter waves of .25 have fewer cells, hence the wider band.
    settings = DEFAULT.refined(1.3)
    breadth = 0.02
    hull = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise, breadth=breadth)
    x, z = np.linspace(0.0, 1.0, 161), np.linspace(0.0, hull.draft, 41)
    table = wigley_half_breadth(x[:, None], z[None, :], 1.0, breadth, hull.draft)
    thin = michell.wave_coefficients(x, z, table, 1.0, hull.wetted_surface, [froude_number])[0]
    result = solve_panels(hull, [froude_number], settings)
    assert result.unknowns < 2700
    condition = result.conditions[0]
    assert lower < condition.wave_coefficient_pressure / thin < upper
    # Far field and near field of one solution: within a tenth of each other.
    assert condition.wave_coefficient == pytest.approx(condition.wave_coefficient_pressure, rel=0.1)


def havelock(ratio: float, depth_froude: float) -> float:
    """R/(pi rho g a^3) of a dipole at immersion ratio*a: Havelock 1917, k0 = g/U^2, depth_froude = U/sqrt(g f)."""
    depth_number = 1.0 / depth_froude**2
    integral = quad(lambda t: np.cos(t) ** -5 * np.exp(-2.0 * depth_number / np.cos(t) ** 2), 0.0, 0.5 * np.pi - 1e-6)[
        0
    ]
    return float(4.0 * (depth_number / ratio) ** 3 * integral)


@pytest.mark.parametrize(
    ("depth_froude", "published"), [(0.6, 0.00528), (0.7, 0.01118), (0.8, 0.01576), (1.0, 0.01804)]
)
def test_submerged_sphere_against_havelock(depth_froude: float, published: float) -> None:
    # The dipole meets the sphere's condition in unbounded flow only: 10 % at three radii immersion. A body on the
    # centreplane needs rows finer than itself.
    exact = havelock(3.0, depth_froude)
    assert exact == pytest.approx(published, rel=1e-3)
    radius = 0.05
    froude_number = depth_froude * np.sqrt(3.0 * radius)
    condition = solve_panels(submerged_sphere(radius, 3.0 * radius), [froude_number], deep_body_settings()).conditions[
        0
    ]
    # From 1/2 rho U^2 S to pi rho g a^3.
    convert = 0.5 * froude_number**2 * 4.0 / radius
    assert condition.wave_coefficient_pressure * convert == pytest.approx(exact, rel=0.10)
    assert condition.wave_coefficient * convert == pytest.approx(exact, rel=0.10)
