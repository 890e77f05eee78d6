"""The lifting machinery of the blade panels (wake, Kutta condition) on an elliptic wing of high aspect ratio."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.hydro.blade_panels.grid import cosine_stations, grid_quadrilaterals, strip_surface
from hpsop_core.hydro.blade_panels.potential import KuttaProblem, factorise
from hpsop_core.hydro.singularities.dipole_panels import panel_set


def elliptic_wing(aspect_ratio: float, chordwise: int, strips: int, incidence: float) -> tuple[float, np.ndarray]:
    """(lift coefficient, circulation over that of the elliptic loading) of a wing of span 2, 2 % thick."""
    edges, middle, fraction = cosine_stations(-1.0, 1.0, strips)
    root = 8.0 / (np.pi * aspect_ratio)
    chord = root * np.sqrt(np.maximum(1.0 - edges**2, 0.0))
    chord[[0, -1]] = root * np.sqrt(1.0 - 0.995**2)
    thickness = np.full(strips + 1, 0.02)
    thickness[[0, -1]] = 0.0
    x = cosine_chord_fractions(chordwise // 2 + 1)
    shape = 5.0 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    x = np.concatenate([x[::-1], x[1:]])
    shape = np.concatenate([-shape[::-1], shape[1:]])
    # The upper side lies at negative z, so that (span) x (chord) points out of it.
    corners = np.zeros((chordwise + 1, strips + 1, 3))
    corners[:, :, 0] = (x[:, None] - 0.5) * chord
    corners[:, :, 1] = edges
    corners[:, :, 2] = -shape[:, None] * thickness * chord
    surface = strip_surface(corners, fraction)
    onset = np.zeros((surface.panels.count, 3, 2))
    onset[:, 0, 0] = onset[:, 2, 1] = 1.0
    body = factorise(surface, 1, onset)
    distance = root * np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 64.0, 400.0])
    wake = corners[0][None] + distance[:, None, None] * [1.0, 0.0, 0.0]
    potential = body.wake_potential(panel_set(grid_quadrilaterals(wake)), np.tile(np.arange(strips), distance.size - 1))
    ends = np.zeros(strips, dtype=np.bool_)
    ends[[0, -1]] = True
    kutta = KuttaProblem.of(body, np.ones(strips), ends)
    terms = kutta.wake_terms(potential)
    weights = np.array([np.cos(incidence), -np.sin(incidence)])
    jump = kutta.solve(weights, terms, kutta.first_guess(weights, terms), "the wing")
    area = 4.0 / aspect_ratio
    lift = 2.0 * float(np.sum(jump * np.diff(edges))) / area
    elliptic = 2.0 * lift * area / (2.0 * np.pi) * np.sqrt(1.0 - middle**2)
    return lift, jump / elliptic


def test_lift_slope_and_elliptic_loading() -> None:
    aspect_ratio, incidence = 20.0, np.radians(2.0)
    lift, loading = elliptic_wing(aspect_ratio, 40, 16, incidence)
    lifting_line = 2.0 * np.pi / (1.0 + 2.0 / aspect_ratio)
    # At A = 20 lifting-surface theory (Helmbold) lies 0.5 % below the lifting line, 2 % thickness 1.6 % above it.
    assert lift / incidence == pytest.approx(lifting_line, rel=0.025)
    # Elliptic chords are loaded elliptically; the outermost strips see the finite tip chord.
    assert np.all(np.abs(loading[2:-2] - 1.0) < 0.02)


def test_low_aspect_ratio_converges_with_the_grid() -> None:
    coarse, _ = elliptic_wing(3.0, 24, 10, np.radians(2.0))
    fine, _ = elliptic_wing(3.0, 48, 20, np.radians(2.0))
    # the optimiser's grid is to be within 1 % of a fine one
    assert coarse == pytest.approx(fine, rel=0.01)
    # Helmbold's slope for A = 3, which is good to a few per cent at low aspect ratio
    assert fine / np.radians(2.0) == pytest.approx(2.0 * np.pi * 3.0 / (2.0 + np.sqrt(13.0)), rel=0.05)
