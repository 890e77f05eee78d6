"""What must not change the lifting line's answer, and how smoothly the rest does."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.propeller.propeller import RadialTable, load_propeller, propeller_family
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.lifting_line.solver import LiftingLineSettings
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array

ADVANCE = np.array([0.3, 0.5, 0.7, 0.9])
DRAG = SectionDrag.full_scale(30e-6)


def residual(abscissa: Array, values: Array) -> float:
    """Largest relative departure from a polynomial of degree 5."""
    smooth = np.polynomial.Polynomial.fit(abscissa, values, 5)
    return float(np.max(np.abs(values / smooth(abscissa) - 1.0)))


def test_size_does_not_matter_without_viscosity() -> None:
    small = propeller_family(load_propeller(), 0.1, 5, 1.02, 0.7)
    results = [lifting_line.solve(p, ADVANCE, SectionDrag.inviscid()) for p in (small, small.with_diameter(9.0))]
    assert np.array_equal(results[0].thrust_coefficient, results[1].thrust_coefficient)
    assert np.array_equal(results[0].torque_coefficient, results[1].torque_coefficient)


def test_larger_blades_have_less_drag() -> None:
    propeller = propeller_family(load_propeller(), 3.0, 4)
    torque = [lifting_line.solve(propeller.with_diameter(d), 0.8, DRAG).torque_coefficient[0] for d in (1.0, 3.0, 9.0)]
    assert torque[0] > torque[1] > torque[2]


def test_same_input_same_bits() -> None:
    propeller = propeller_family(load_propeller(), 9.0, 5, 0.98, 0.65)
    first, second = (lifting_line.solve(propeller, ADVANCE, DRAG) for _ in range(2))
    assert np.array_equal(first.thrust_coefficient, second.thrust_coefficient)
    assert np.array_equal(first.torque_coefficient, second.torque_coefficient)


def test_one_at_a_time_is_all_at_once() -> None:
    prepared = lifting_line.prepare(propeller_family(load_propeller(), 9.0, 5))
    together = prepared.solve(ADVANCE, DRAG)
    for i, advance in enumerate(ADVANCE):
        alone = prepared.solve(float(advance), DRAG)
        # the matching needs J to 1e-6
        assert alone.thrust_coefficient[0] == pytest.approx(together.thrust_coefficient[i], abs=1e-11)
        assert alone.torque_coefficient[0] == pytest.approx(together.torque_coefficient[i], abs=1e-11)


@pytest.mark.parametrize(("blades", "area"), [(3, 0.607), (7, 1.0)])
def test_strips_and_wake_table_are_fine_enough(blades: int, area: float) -> None:
    propeller = propeller_family(load_propeller(), 9.0, blades, 1.0, area)
    usual = lifting_line.solve(propeller, ADVANCE, DRAG)
    # strips: the optimiser compares designs on one grid; 2 % in the level is within the model's own error
    fine = lifting_line.solve(propeller, ADVANCE, DRAG, LiftingLineSettings(strips=20))
    assert np.allclose(fine.thrust_coefficient, usual.thrust_coefficient, rtol=0.02)
    assert np.allclose(fine.torque_coefficient, usual.torque_coefficient, rtol=0.02)
    # the table: an interpolation error that must stay far below the model's, KT within 1e-4
    table = lifting_line.solve(propeller, ADVANCE, DRAG, LiftingLineSettings(wake_nodes=20))
    assert np.allclose(table.thrust_coefficient, usual.thrust_coefficient, atol=1e-4)
    assert np.allclose(table.torque_coefficient, usual.torque_coefficient, atol=1e-4)


def test_curves_are_smooth_in_advance_and_design() -> None:
    """The optimiser and the matching need residuals below 1e-4 of a smooth curve."""
    parent = load_propeller()
    advance = np.linspace(0.55, 0.75, 81)
    result = lifting_line.solve(propeller_family(parent, 9.0, 5), advance, DRAG)
    assert residual(advance, result.thrust_coefficient) < 1e-6
    assert residual(advance, result.torque_coefficient) < 1e-6
    for values, make in (
        (np.linspace(0.95, 1.05, 25), lambda x: propeller_family(parent, 9.0, 5, x)),
        (np.linspace(0.5, 0.8, 25), lambda x: propeller_family(parent, 9.0, 5, 1.0, x)),
        (np.linspace(7.0, 9.5, 25), lambda x: propeller_family(parent, x, 5)),
    ):
        results = [lifting_line.solve(make(float(x)), 0.7, DRAG) for x in values]
        assert residual(values, np.array([r.thrust_coefficient[0] for r in results])) < 1e-5
        assert residual(values, np.array([r.torque_coefficient[0] for r in results])) < 1e-5


@pytest.mark.parametrize("blades", [2, 3, 4, 5, 6, 7])
def test_the_whole_design_space_converges(blades: int) -> None:
    """J 0.1 to 1.3 at every corner and beyond: finite, thrust and torque fall with J."""
    advance = np.linspace(0.1, 1.3, 25)
    for pitch in (0.95, 1.05):
        for area in (0.3, 0.5, 0.607, 1.0, 1.1):
            propeller = propeller_family(load_propeller(), 9.0, blades, pitch, area)
            result = lifting_line.solve(propeller, advance, DRAG)
            assert np.all(np.isfinite(result.thrust_coefficient)) and np.all(np.isfinite(result.torque_coefficient))
            assert np.all(np.diff(result.thrust_coefficient) < 0.0)
            # with no speed to speak of, a screw of this pitch thrusts; driven 20 % past its pitch it brakes
            assert result.thrust_coefficient[0] > 0.25 and result.thrust_coefficient[-1] < 0.0


def test_more_blades_on_one_area_thrust_more() -> None:
    """At the same area and pitch the induced loss falls with the number of blades; levels 1 and 2 agree on it."""
    thrust = [
        lifting_line.solve(propeller_family(load_propeller(), 9.0, z), 0.7, DRAG).thrust_coefficient[0]
        for z in (3, 4, 5, 6, 7)
    ]
    assert np.all(np.diff(thrust) > 0.0)


def test_what_cannot_be_solved_names_its_advance() -> None:
    flat = propeller_family(load_propeller(), 9.0, 3, 0.4)
    with pytest.raises(SolverFailure, match=r"J = 1\.3"):
        lifting_line.solve(flat, np.array([0.2, 1.3]), DRAG)
    with pytest.raises(InputError, match="finite"):
        lifting_line.solve(flat, np.array([0.2, np.nan]), DRAG)
    with pytest.raises(InputError, match="finite"):
        lifting_line.solve(flat, -0.1, DRAG)


def test_a_little_skew_changes_little() -> None:
    """The limit of vanishing skew, and no jump on the way to a moderate one."""
    parent = load_propeller()
    thrust = []
    for degrees in (0.0, 1e-6, 10.0):
        share = (parent.radius_ratio - 0.2) / 0.8
        table = RadialTable(
            "skewed",
            parent.radius_ratio,
            parent.chord_ratio,
            parent.pitch_ratio,
            np.radians(degrees) * share**2,
            parent.rake_ratio,
            parent.thickness_ratio,
            parent.camber_ratio,
        )
        result = lifting_line.solve(propeller_family(table, 9.0, 3), 0.7, DRAG)
        thrust.append(result.thrust_coefficient[0])
    assert thrust[1] == pytest.approx(thrust[0], rel=1e-6)
    # experiments with skewed series find KT within a few percent of the unskewed parent
    assert thrust[2] == pytest.approx(thrust[0], rel=0.06)
