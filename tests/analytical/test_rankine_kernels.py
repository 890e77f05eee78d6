"""The panel and point-source kernels against closed forms and brute-force quadrature."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.hydro.rankine.operator import convect, difference_weights
from hpsop_core.hydro.singularities.source_panels import SourcePanels, flat_panels, panel_velocities, point_velocities

FAR_AWAY = 1e7


def unit_square() -> SourcePanels:
    """A unit square so far to port that its y-image is felt below 1e-14."""
    corners = np.array([[[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]]])
    return flat_panels(corners + np.array([0.0, FAR_AWAY, 0.0]))


@pytest.mark.parametrize("height", [0.1, 0.25, 0.5, 1.0, 2.0])
def test_axis_of_the_unit_square(height: float) -> None:
    # Solid angle 4 atan(ab/(z sqrt(a^2 + b^2 + z^2))) over 4 pi, a = b = 1/2. The offset of 1e7 costs 9 digits in y.
    exact = np.arctan(0.25 / (height * np.sqrt(0.5 + height**2))) / np.pi
    w = panel_velocities(np.array([[0.0, FAR_AWAY, height]]), unit_square(), image_z=False, far_diagonals=1e9)[2][0, 0]
    assert w == pytest.approx(exact, rel=1e-7)


def test_just_above_the_panel_half_the_flux_goes_up() -> None:
    w = panel_velocities(np.array([[0.0, FAR_AWAY, 1e-7]]), unit_square(), image_z=False)[2][0, 0]
    assert w == pytest.approx(0.5, abs=1e-6)


def warped_panel() -> SourcePanels:
    """A general quadrilateral near both planes of symmetry."""
    return flat_panels(np.array([[[0.0, 0.1, -0.3], [0.9, 0.2, -0.35], [1.1, 0.8, -0.2], [-0.1, 0.7, -0.25]]]))


def brute_force(panel: SourcePanels, point: np.ndarray, order: int = 80) -> np.ndarray:
    """The velocity with all images by a Gauss product rule over the bilinear map of the flat panel."""
    node, weight = np.polynomial.legendre.leggauss(order)
    s, t = np.meshgrid(0.5 * (node + 1.0), 0.5 * (node + 1.0), indexing="ij")
    a, b, c, d = panel.corners[0]
    at = ((1 - s) * (1 - t))[..., None] * a + (s * (1 - t))[..., None] * b
    at = at + (s * t)[..., None] * c + ((1 - s) * t)[..., None] * d
    along = (1 - t)[..., None] * (b - a) + t[..., None] * (c - d)
    across = (1 - s)[..., None] * (d - a) + s[..., None] * (c - b)
    area = np.linalg.norm(np.cross(along, across), axis=-1) * np.outer(weight, weight) / 4.0
    total = np.zeros(3)
    for mirror_y in (1.0, -1.0):
        for mirror_z in (1.0, -1.0):
            away = point - at * np.array([1.0, mirror_y, mirror_z])
            total += np.sum(area[..., None] * away / np.linalg.norm(away, axis=-1)[..., None] ** 3, axis=(0, 1))
    return total / (4.0 * np.pi)


def test_closed_form_with_images_against_quadrature() -> None:
    panel = warped_panel()
    generator = np.random.default_rng(3)
    # At least 0.15 off the panel, where 80 x 80 Gauss points are exact to 1e-9: 1e-6 is sure to be ours.
    for _ in range(20):
        point = generator.normal(size=3) * np.array([1.0, 0.7, 0.7])
        point[1] = abs(point[1]) + 0.1
        if abs((point - panel.centre[0]) @ panel.normal[0]) < 0.15 or point[2] > 0.1:
            continue
        ours = np.array([v[0, 0] for v in panel_velocities(point[None, :], panel, image_z=True, far_diagonals=1e9)])
        exact = brute_force(panel, point)
        assert np.max(np.abs(ours - exact)) < 1e-6 * np.linalg.norm(exact)


def test_far_field_switch_is_not_felt() -> None:
    panel = warped_panel()
    generator = np.random.default_rng(4)
    direction = generator.normal(size=(500, 3))
    direction[:, 1] = np.abs(direction[:, 1])
    points = panel.centre + 4.001 * panel.diagonal[0] * direction / np.linalg.norm(direction, axis=1)[:, None]
    near = panel_velocities(points, panel, image_z=False, far_diagonals=1e9)
    far = panel_velocities(points, panel, image_z=False)
    size = np.max(np.abs(near))
    # Monopole and quadrupole leave the octupole: below (1/8)^3 = 2e-3 of the panel's own influence.
    assert max(np.max(np.abs(a - b)) for a, b in zip(near, far, strict=True)) < 2e-3 * size
    assert max(np.max(np.abs(a - b)) for a, b in zip(near, far, strict=True)) > 0.0


def test_collapsed_edge_is_a_triangle() -> None:
    # A triangle as a quadrilateral with a double corner equals the two halves it can be cut into.
    a, b, c = np.array([0.0, 0.2, -0.1]), np.array([1.0, 0.3, -0.2]), np.array([0.4, 1.1, -0.6])
    middle = 0.5 * (b + c)
    whole = flat_panels(np.array([[a, b, c, c]]))
    halves = flat_panels(np.array([[a, b, middle, middle], [a, middle, c, c]]))
    point = np.array([[0.3, 0.9, -0.9], [1.5, 0.1, -0.4]])
    one = panel_velocities(point, whole, image_z=True, far_diagonals=1e9)
    two = panel_velocities(point, halves, image_z=True, far_diagonals=1e9)
    for left, right in zip(one, two, strict=True):
        # Rounding only.
        assert np.allclose(left[:, 0], right.sum(axis=1), rtol=0.0, atol=1e-13)


def test_closed_body_of_panels_lets_its_flux_out() -> None:
    # Gauss: unit density on a closed surface gives the flux of its area through any surface around it. On the axis of
    # symmetry far away that is area/(4 pi r^2).
    from hpsop_core.geometry.analytic_bodies import ellipsoid_quads

    panels = flat_panels(ellipsoid_quads(16, 8, (1.0, 0.5, 0.4)))
    u = panel_velocities(np.array([[200.0, 0.0, 0.0]]), panels, image_z=True)[0].sum()
    # The quadrupole of the body at r = 200 is (1/200)^2.
    assert u == pytest.approx(4.0 * panels.area.sum() / (4.0 * np.pi * 200.0**2), rel=1e-4)


def test_point_source_with_image() -> None:
    velocity = point_velocities(np.array([[1.0, 2.0, -0.5]]), np.array([[0.0, 1.0, 0.5]]), np.array([3.0]))
    away, image = np.array([1.0, 1.0, -1.0]), np.array([1.0, 3.0, -1.0])
    exact = 3.0 / (4.0 * np.pi) * (away / np.linalg.norm(away) ** 3 + image / np.linalg.norm(image) ** 3)
    assert np.allclose([v[0, 0] for v in velocity], exact, rtol=1e-14)


@pytest.mark.parametrize(
    ("kappa", "dispersion", "damping"), [(0.3, 2e-5, 1e-3), (0.6, 1.5e-3, 5e-3), (1.0, 3e-2, 3e-2)]
)
def test_difference_has_the_symbol_it_claims(kappa: float, dispersion: float, damping: float) -> None:
    # On a uniform grid D exp(i k x) = [i kappa (1 + O(kappa^6)) + 2/15 (1 - cos kappa)^3]/dx exp(i k x).
    columns, step = 30, 0.1
    x = (step * np.arange(columns))[:, None]
    weights = difference_weights(x)
    wave = np.exp(1j * kappa / step * x)
    out = np.zeros((columns, 2))
    convect(np.hstack([wave.real, wave.imag]), weights, np.ones(columns), np.zeros(columns), out)
    symbol = (out[:, 0] + 1j * out[:, 1]) / wave[:, 0] * step
    inner = symbol[4:-2]
    assert np.allclose(inner, inner[0], atol=1e-12)
    assert abs(inner[0].imag / kappa - 1.0) < dispersion
    assert 0.0 < inner[0].real < damping
    assert inner[0].real == pytest.approx(2.0 / 15.0 * (1.0 - np.cos(kappa)) ** 3, rel=1e-9)
