"""Waves and pressures of a design agree with the numbers of its evaluation."""

from __future__ import annotations

import numpy as np
import pytest

import hpsop_core
from hpsop_core.case.case import Case
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.fields import PressureField, blade_pressure, hull_pressure, pressures, waves
from hpsop_core.evaluation.result import Failed, Ok
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.hydro.cavitation import pressure_margin
from hpsop_core.typing_aliases import Array
from tests.two_speeds import stated_case


@pytest.fixture(scope="module")
def case() -> Case:
    """The recommended case with stated wave coefficients, so that level 1 needs no level 2."""
    return stated_case()


@pytest.fixture(scope="module")
def initial(case: Case) -> Ok:
    return evaluate(case)


def _areas(field: PressureField) -> Array:
    """(m, 3) area vectors of the panels, out of the body."""
    a, b, c, d = (field.points[field.quads[:, corner]] for corner in range(4))
    return np.asarray(0.5 * np.cross(c - a, d - b))


def test_the_waves_of_level_1_carry_the_evaluations_wave_resistance(case: Case, initial: Ok) -> None:
    hull = initial.hull
    for index, condition in enumerate(initial.conditions):
        field = waves(case, initial, condition=index)
        assert field.spectrum is not None
        coefficient = field.spectrum.wave_resistance * hull.length**2 / hull.wetted_surface
        # the calibrated coefficient; other tangents than the integral's
        assert coefficient == pytest.approx(condition.wave_coefficient, rel=1e-3)


def test_they_stand_in_the_python_interface() -> None:
    assert hpsop_core.waves is waves
    assert hpsop_core.pressures is pressures


def test_a_design_is_an_evaluation_variables_or_the_initial_one(case: Case, initial: Ok) -> None:
    by_evaluation = waves(case, initial, condition=1)
    for other in (
        waves(case, initial.variables, level=1, condition=1),
        waves(case, condition=1),
        waves(case, initial, froude_number=initial.conditions[1].froude_number),
    ):
        assert np.array_equal(other.elevation, by_evaluation.elevation)
        assert other.wave_calibration == by_evaluation.wave_calibration


def test_the_blades_pressure_gives_the_evaluations_thrust(case: Case, initial: Ok) -> None:
    condition = initial.conditions[0]
    field = blade_pressure(case, initial)
    forces = -_areas(field) * field.pressure[:, None]
    thrust = forces[field.blade >= 0].sum(axis=0)
    # Pressures on 40 x 16 panels against the lifting line's thrust, which has the sections' drag in it too.
    assert thrust[0] == pytest.approx(condition.thrust, rel=0.05)
    # all blades together push along the shaft alone
    assert np.abs(thrust[1:]).max() < 1e-6 * thrust[0]
    assert field.advance_coefficient == condition.advance_coefficient
    # speed of the section at the tip: advance and rotation
    tip = np.hypot(
        (1.0 - condition.wake_fraction) * condition.speed,
        np.pi * condition.rotation_rate_rpm / 60.0 * initial.variables.diameter,
    )
    assert field.dynamic_pressure.max() == pytest.approx(0.5 * case.constants.density * tip**2, rel=0.05)
    assert field.dynamic_pressure.max() < 0.5 * case.constants.density * tip**2
    # the cavitation number's own reference: P0 - Pv over it is that number
    hull, constants = initial.hull, case.constants
    immersion = hull.draft - initial.propeller.shaft_height
    margin = pressure_margin(
        immersion,
        constants.density,
        constants.gravity,
        constants.atmospheric_pressure,
        constants.vapour_pressure,
    )
    assert margin / field.reference_pressure == pytest.approx(condition.cavitation_number, rel=1e-9)
    assert field.uniform_coefficient * field.reference_pressure == pytest.approx(field.pressure)


def test_the_blades_turn_in_the_aperture(case: Case, initial: Ok) -> None:
    field = blade_pressure(case, initial)
    place = propeller_placement(design_hull(case, initial.variables), design_propeller(case, initial.variables))
    blades = field.points[np.unique(field.quads[field.blade >= 0])] - place[:3, 3]
    radius = np.hypot(blades[:, 1], blades[:, 2])
    assert radius.max() == pytest.approx(0.5 * initial.variables.diameter, rel=1e-3)
    assert set(field.blade) == {-1, *range(initial.variables.blade_count)}


def test_the_hulls_panels_are_its_surface(case: Case, initial: Ok) -> None:
    hull = initial.hull
    field = hull_pressure(case, initial)
    area = _areas(field)
    # flat panels under the surface of the form
    assert np.linalg.norm(area, axis=1).sum() == pytest.approx(hull.wetted_surface, rel=0.02)
    # the bottom faces down, the sides face out, and what is inside is the displacement's volume
    corners = field.points[field.quads].mean(axis=1) - np.array([0.0, 0.0, hull.draft])
    assert float(np.sum(corners * area)) / 3.0 == pytest.approx(hull.displaced_volume, rel=0.02)
    half = len(field.quads) // 2
    assert np.array_equal(field.pressure_coefficient[:half], field.pressure_coefficient[half:])
    speed = initial.conditions[0].speed
    assert field.pressure == pytest.approx(0.5 * case.constants.density * speed**2 * field.pressure_coefficient)


def test_both_pressures_are_the_two_alone(case: Case, initial: Ok) -> None:
    both = pressures(case, initial, condition=1)
    assert np.array_equal(
        both.hull.pressure_coefficient, hull_pressure(case, initial, condition=1).pressure_coefficient
    )
    assert np.array_equal(
        both.blades.pressure_coefficient, blade_pressure(case, initial, condition=1).pressure_coefficient
    )


def test_what_is_not_there_is_refused(case: Case, initial: Ok) -> None:
    for condition in (-1, 2):
        with pytest.raises(InputError, match="numbered from 0"):
            waves(case, initial, condition=condition)
    with pytest.raises(InputError, match="neither 1 nor 2"):
        waves(case, initial, level=3)
    failed = Failed(case.name, 1, initial.variables, "hull", "the form cannot be made")
    with pytest.raises(SolverFailure, match="the form cannot be made"):
        waves(case, failed)
    with pytest.raises(SolverFailure, match="the form cannot be made"):
        pressures(case, failed)
