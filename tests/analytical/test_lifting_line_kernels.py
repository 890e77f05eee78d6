"""The lifting line's vortex kernels against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.geometry.propeller.sections import ZERO_LIFT_ANGLE_PER_CAMBER, half_thickness
from hpsop_core.geometry.propeller.surface import to_cartesian
from hpsop_core.hydro.lifting_line.chord_surface import chord_points
from hpsop_core.hydro.lifting_line.solver import _CAMBER_SLOPES
from hpsop_core.hydro.lifting_line.thickness import thickness_normal_velocity
from hpsop_core.hydro.singularities.vortices import helix_tail_velocity, polyline_normal_velocity, wrench_velocities
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.propeller_level1 import elliptic_wing

AXES = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def helices(radius: float, advance: float, blades: int, start: float, turns: float, per_turn: int = 240) -> Array:
    """Helical vortices (Z, n, 3) that begin at angle ``start`` and run downstream."""
    angle = np.linspace(start, start + 2.0 * np.pi * turns, int(turns * per_turn) + 1)
    turn = 2.0 * np.pi * np.arange(blades)[:, None] / blades
    return to_cartesian(np.broadcast_to(advance * angle, (blades, angle.size)), np.array(radius), turn - angle)


def velocity(lines: Array, point: Array) -> Array:
    """Velocity (3,) of polylines (p, n, 3) at a point."""
    first = np.arange(lines.shape[0], dtype=np.int64) * lines.shape[1]
    return polyline_normal_velocity(lines.reshape(-1, 3), first, np.repeat(point[None], 3, axis=0), AXES).sum(axis=0)


def test_straight_vortex() -> None:
    line = np.array([[[-2.0, 0.0, 0.0], [0.5, 0.0, 0.0], [3.0, 0.0, 0.0]]])
    # closed form of a finite straight vortex: (cos a + cos b)/(4 pi h), around the line by the right hand
    exact = (2.0 / np.hypot(2.0, 0.7) + 3.0 / np.hypot(3.0, 0.7)) / (4.0 * np.pi * 0.7)
    assert np.allclose(velocity(line, np.array([0.0, 0.0, 0.7])), [0.0, -exact, 0.0], atol=1e-14)


@pytest.mark.parametrize("blades", [3, 5, 7])
@pytest.mark.parametrize(
    ("control", "vortex", "advance"), [(0.7, 0.8, 0.3), (0.7, 0.6, 0.3), (0.3, 0.9, 0.25), (0.95, 0.9, 0.5)]
)
def test_wrench_is_the_biot_savart_integral(blades: int, control: float, vortex: float, advance: float) -> None:
    direct = velocity(helices(vortex, advance, blades, 0.0, 25.0, per_turn=720), np.array([0.0, 0.0, control]))
    tail = helix_tail_velocity(
        np.array(control), np.array(vortex), np.array(advance * 50.0 * np.pi), np.array(advance), blades
    )
    axial, tangential = wrench_velocities(np.array(control), np.array(vortex), np.array(advance), blades)
    # asymptotic formula: 4.4e-4 was found in velocities up to 2.6; the key blade's theta is y at the top
    assert direct[0] + float(tail[0]) == pytest.approx(float(axial), abs=6e-4)
    assert -(direct[1] + float(tail[1])) == pytest.approx(float(tangential), abs=6e-4)


def test_far_wake_formula_replaces_the_far_wake() -> None:
    start = 15.0
    point = np.array([0.0, 0.0, 0.6])
    far = velocity(helices(0.8, 0.3, 3, start, 60.0, per_turn=120), point)
    tail = helix_tail_velocity(np.array(0.6), np.array(0.8), np.array(0.3 * start), np.array(0.3), 3)
    # the whole tail is 1.6 % of the wake's velocity (about 1.2); a tenth of it is enough
    assert abs(far[0] - float(tail[0])) < 2e-3
    assert abs(far[1] - float(tail[1])) < 2e-3


def test_endless_pitch_gives_straight_vortices() -> None:
    """One blade: a semi-infinite straight vortex, 1/(4 pi h)."""
    for control, vortex in ((0.8, 0.6), (0.3, 0.9)):
        axial, tangential = wrench_velocities(np.array(control), np.array(vortex), np.array(1e9), 1)
        # 1 % would hide a wrong term; the limit is exact
        assert float(tangential) == pytest.approx(1.0 / (4.0 * np.pi * (control - vortex)), rel=1e-6)
        assert abs(float(axial)) < 1e-6


def test_endlessly_many_blades_give_momentum_theory() -> None:
    """At the disc half the jump: u_t = Z/(4 pi r) outside the vortices and none inside; u_a = Z/(4 pi a) inside."""
    blades, advance = 400, 0.3
    axial, tangential = wrench_velocities(np.array([0.8, 0.4]), np.array(0.6), np.array(advance), blades)
    assert tangential[0] == pytest.approx(blades / (4.0 * np.pi * 0.8), rel=0.01)
    assert abs(tangential[1]) < 0.01 * tangential[0]
    assert axial[1] == pytest.approx(blades / (4.0 * np.pi * advance), rel=0.01)
    assert abs(axial[0]) < 0.01 * axial[1]


@pytest.mark.parametrize("aspect", [4.0, 6.0, 8.0, 12.0])
def test_elliptic_wing(aspect: float) -> None:
    slope, drag, downwash = elliptic_wing(aspect)
    # 1 %: 40 cosine strips
    assert slope == pytest.approx(2.0 * np.pi / (1.0 + 2.0 / aspect), rel=0.01)
    assert drag == pytest.approx(1.0 / (np.pi * aspect), rel=0.01)
    # constant downwash CL/(pi A), but for the outermost strips
    assert np.allclose(downwash[2:-2], 1.0 / (np.pi * aspect), rtol=0.01)


def test_two_bound_vortices_keep_lift_and_moment_of_the_mean_line() -> None:
    """In two dimensions, at no incidence: lift 2 pi times the zero-lift angle, for one vortex and for two."""
    for count, slopes in _CAMBER_SLOPES.items():
        vortex = (np.arange(count) + 0.25) / count
        control = (np.arange(count) + 0.75) / count
        # downwash of circulation 1 on chord 1, U = 1: 1/(2 pi distance)
        influence = 1.0 / (2.0 * np.pi * (control[:, None] - vortex))
        lift = 2.0 * float(np.sum(np.linalg.solve(influence, -np.array(slopes))))
        # the published angles are rounded to four digits
        assert lift == pytest.approx(-2.0 * np.pi * ZERO_LIFT_ANGLE_PER_CAMBER, rel=1e-3)
        flat = 2.0 * float(np.sum(np.linalg.solve(influence, np.ones(count))))
        assert flat == pytest.approx(2.0 * np.pi, rel=1e-12)


def test_thickness_turns_the_flow_towards_less_incidence() -> None:
    """Linear in the thickness, nothing without it, more with more blades of the same shape."""
    radii = 0.2 + 0.8 * np.sin(0.5 * np.pi * (np.arange(8) + 0.5) / 8)
    middle = np.array([0.375, 0.875])
    propeller = propeller_family(load_propeller(), 1.0, 3)
    usual = thickness_normal_velocity(propeller, radii, middle)
    half = replace(propeller, table=replace(propeller.table, thickness_ratio=0.5 * propeller.table.thickness_ratio))
    assert np.allclose(thickness_normal_velocity(half, radii, middle), 0.5 * usual, rtol=1e-12, atol=1e-15)
    # at J 0.8 it acts towards the pressure side all along the blade
    total = usual @ np.array([1.6, 1.0])
    assert np.all(total < 0.0)
    six = replace(propeller, blade_count=6)
    assert np.all(thickness_normal_velocity(six, radii, middle) @ np.array([1.6, 1.0]) < total)


def test_thickness_of_a_far_blade_is_a_known_source() -> None:
    """A closed body has no net source; its far field is the dipole of its volume times the speed along the chord."""
    angle = np.pi * np.arange(25) / 24
    fraction = 0.5 * (1.0 - np.cos(0.5 * (angle[1:] + angle[:-1])))
    growth = np.diff(2.0 * half_thickness(0.5 * (1.0 - np.cos(angle))))
    x = np.linspace(0.0, 1.0, 20001)
    area = 2.0 * float(np.mean(half_thickness(x)[1:] + half_thickness(x)[:-1])) * 0.5
    assert float(np.sum(growth)) == pytest.approx(0.0, abs=1e-12)
    # integration by parts: int x t' = -int t; 24 stations at their cosine middles
    assert -float(np.sum(growth * fraction)) == pytest.approx(area, rel=0.01)


def test_normals_are_square_to_a_raked_and_skewed_chord_surface() -> None:
    parent = load_propeller()
    outward = (parent.radius_ratio - 0.2) / 0.8
    table = replace(parent, rake_ratio=0.15 * outward, skew=np.radians(25.0) * outward**2)
    propeller = propeller_family(table, 1.0, 4)
    radii, fractions, step = np.array([0.35, 0.6, 0.9]), np.array([0.2, 0.5, 0.875]), 1e-4
    here = chord_points(propeller, radii, fractions)
    for moved, tolerance in (
        (chord_points(propeller, radii, fractions + step), 1e-3),
        # between the rows of the table the derivative of its interpolation has corners
        (chord_points(propeller, radii + step, fractions), 5e-3),
    ):
        along = moved.points - here.points
        along /= np.linalg.norm(along, axis=1)[:, None]
        assert np.max(np.abs(np.sum(along * here.normals, axis=1))) < tolerance
    # the part across the section is a unit vector
    assert np.allclose(np.hypot(here.axial, here.tangential), 1.0)
