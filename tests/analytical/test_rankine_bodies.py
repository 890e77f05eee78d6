"""Hess-Smith panels on bodies whose potential flow is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from hpsop_core.geometry.analytic_bodies import ellipsoid_quads, wigley_panels
from hpsop_core.hydro.rankine.resistance import pressure_force
from hpsop_core.hydro.rankine.solver import double_body, solver_axes
from hpsop_core.hydro.singularities.source_panels import flat_panels


def ellipsoid_coefficients(a: float, b: float, c: float) -> tuple[float, float, float]:
    """alpha0, beta0, gamma0 of Lamb, Hydrodynamics, art. 114 (substitution l = t^2/(1 - t)^2 tames both ends)."""

    def coefficient(axis: float) -> float:
        def integrand(t: float) -> float:
            scale = max(a, b, c) ** 2
            value = scale * t**2 / (1.0 - t) ** 2
            jacobian = scale * 2.0 * t / (1.0 - t) ** 3
            return jacobian / ((axis**2 + value) * np.sqrt((a**2 + value) * (b**2 + value) * (c**2 + value)))

        return a * b * c * float(quad(integrand, 0.0, 1.0 - 1e-12, epsabs=1e-13, epsrel=1e-12, limit=400)[0])

    return coefficient(a), coefficient(b), coefficient(c)


@pytest.mark.parametrize("axes", [(1.0, 0.2, 0.1), (1.0, 0.14, 0.08), (1.0, 1.0, 1.0)])
def test_reference_itself(axes: tuple[float, float, float]) -> None:
    # alpha0 + beta0 + gamma0 = 2 for any ellipsoid; the quadrature carries about nine digits.
    assert sum(ellipsoid_coefficients(*axes)) == pytest.approx(2.0, abs=1e-8)


@pytest.mark.parametrize(
    ("axes", "published"),
    [
        ((1.0, 1.0, 1.0), 1.5),
        ((1.0, 0.2, 0.1), 1.03423),
        ((1.0, 0.4, 0.2), 1.09327),
        ((1.0, 0.14, 0.08), 1.02221),
        ((1.0, 0.2, 0.2), 1.05912),
    ],
)
def test_surface_velocity_of_ellipsoids(axes: tuple[float, float, float], published: float) -> None:
    alpha = ellipsoid_coefficients(*axes)[0]
    largest = 1.0 + alpha / (2.0 - alpha)
    assert largest == pytest.approx(published, abs=1e-5)
    panels = flat_panels(ellipsoid_quads(40, 14, axes))
    body = double_body(panels)
    # 560 flat panels on the quarter: their angle of 4.5 degrees, squared, is 0.6 %.
    assert np.max(np.linalg.norm(body.flow, axis=1)) == pytest.approx(largest, rel=0.01)
    # (1 + k1)(e_x - n_x n) everywhere but on the last panels at the poles, where panels are slivers.
    exact = largest * (np.array([1.0, 0.0, 0.0]) - panels.normal[:, :1] * panels.normal)
    away = np.abs(panels.centre[:, 0]) < 0.9
    assert np.max(np.linalg.norm(body.flow - exact, axis=1)[away]) < 0.01
    assert np.min(body.pressure_coefficient) == pytest.approx(1.0 - largest**2, rel=0.02, abs=2e-3)
    # d'Alembert and zero net source; the mesh is symmetric fore and aft, so both are rounding.
    assert abs(pressure_force(body.pressure_coefficient, panels)[0]) < 1e-12
    assert abs(np.sum(body.strengths * panels.area)) < 1e-12


def test_zero_pressure_on_the_sphere() -> None:
    # Cp = 1 - 2.25 sin^2 vanishes at 41.81 degrees from the stagnation point.
    panels = flat_panels(ellipsoid_quads(40, 14, (1.0, 1.0, 1.0)))
    pressure = double_body(panels).pressure_coefficient
    angle = np.degrees(np.arccos(np.abs(panels.centre[:, 0]) / np.linalg.norm(panels.centre, axis=1)))
    inside = (angle > 20.0) & (angle < 70.0)
    order = np.argsort(angle[inside])
    crossing = np.interp(0.0, -pressure[inside][order], angle[inside][order])
    # Panels are 4.5 degrees long; linear interpolation between them is good to a fraction of that.
    assert crossing == pytest.approx(41.81, abs=0.5)


def test_double_body_drag_of_the_wigley_hull() -> None:
    hull = wigley_panels(44, 9)
    panels, _ = solver_axes(hull)
    drag = 2.0 * pressure_force(double_body(panels).pressure_coefficient, panels)[0] / hull.wetted_surface
    # Fore-and-aft symmetry leaves nothing but rounding.
    assert abs(drag) < 1e-8
