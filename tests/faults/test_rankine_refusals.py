"""What the Rankine solver must refuse: never a number for a form that is none, never a NaN."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core import evaluate, load_case
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.analytic_bodies import wigley_panels
from hpsop_core.geometry.hull.form import LongitudinalShift
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.panels import HullPanels, grid_quads
from hpsop_core.hydro.rankine.checks import check_answer, check_panels
from hpsop_core.hydro.rankine.solver import RankineSettings, solve, solve_panels, solver_axes
from tests.two_speeds import TWO_SPEEDS

COARSE = RankineSettings().refined(0.7)


def wigley() -> HullPanels:
    """A sound hull to spoil."""
    return wigley_panels(20, 6)


@pytest.mark.parametrize("froude_number", [0.0, 0.05, 0.0999, 0.51, 2.0, -0.2, float("nan"), float("inf")])
def test_froude_numbers_outside_the_range(froude_number: float) -> None:
    with pytest.raises(InputError, match="Froude number"):
        solve_panels(wigley(), [0.3, froude_number], COARSE)


def test_no_froude_number() -> None:
    with pytest.raises(InputError):
        solve_panels(wigley(), [], COARSE)


@pytest.mark.parametrize("amplitude", [90.0, 110.0, 150.0])
@pytest.mark.parametrize("sign", [(-1.0, -1.0), (-1.0, 0.0), (0.0, -1.0)])
def test_folded_form(amplitude: float, sign: tuple[float, float]) -> None:
    # The same sections shifted so far that dx'/dx < 0 somewhere; volume and centre are those of the folded form, so
    # that only the fold itself can be noticed.
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    shift = LongitudinalShift(parent.shift_frame, sign[0] * amplitude, sign[1] * amplitude)
    x = np.linspace(0.0, parent.length, 2001)
    assert np.min(shift.evaluate(x)[1]) < 0.0
    sections = parent.quadrature
    volume = float(np.sum(sections.area * sections.width * shift.evaluate(sections.x)[1]))
    folded = replace(hull, shift=shift, hydrostatics=replace(hull.hydrostatics, displaced_volume=volume))
    with pytest.raises(SolverFailure, match="rankine") as caught:
        solve(folded, [0.22, 0.27])
    assert caught.value.stage == "rankine"
    assert "fold" in caught.value.reason or "float" in caught.value.reason


def test_form_that_crosses_itself() -> None:
    sound = wigley()
    quads = sound.quads.copy()
    # Half-breadths turned inside out below half draft: the sections cross the centreplane.
    quads[..., 1] -= 0.02 * (quads[..., 2] < 0.5 * sound.draft)
    with pytest.raises(SolverFailure, match="crosses"):
        solve_panels(replace(sound, quads=quads), [0.3], COARSE)


def test_hull_out_of_the_water() -> None:
    sound = wigley()
    with pytest.raises(SolverFailure, match="above the waterline"):
        solve_panels(replace(sound, draft=0.5 * sound.draft), [0.3], COARSE)
    with pytest.raises(SolverFailure, match="float"):
        solve_panels(replace(sound, displaced_volume=0.0), [0.3], COARSE)


def test_collapsed_panels() -> None:
    sound = wigley()
    quads = sound.quads.copy()
    quads[30] = quads[30, :1]
    with pytest.raises(SolverFailure, match="collapses"):
        solve_panels(replace(sound, quads=quads), [0.3], COARSE)


def test_not_a_number_in_the_panels() -> None:
    sound = wigley()
    quads = sound.quads.copy()
    quads[3, 2, 0] = np.nan
    with pytest.raises(SolverFailure, match="finite"):
        solve_panels(replace(sound, quads=quads), [0.3], COARSE)


def test_open_hull() -> None:
    # A hull that ends in the open: the panels enclose less than the stated displacement.
    sound = wigley()
    with pytest.raises(SolverFailure, match="enclose"):
        solve_panels(replace(sound, quads=sound.quads[:-42]), [0.3], COARSE)


def test_stations_in_the_wrong_order() -> None:
    points = np.zeros((9, 5, 3))
    x = np.array([0.0, 0.1, 0.25, 0.4, 0.35, 0.6, 0.75, 0.9, 1.0])
    z = np.linspace(0.0, 0.0625, 5)
    points[..., 0], points[..., 2] = x[:, None], z
    points[..., 1] = 0.05 * (1 - (2 * x[:, None] - 1) ** 2) * (1 - (1 - z / 0.0625) ** 2)
    with pytest.raises(SolverFailure, match="folded"):
        solve_panels(replace(wigley(), quads=grid_quads(points), blocks=(("w", 8, 4),)), [0.3], COARSE)


def test_hollow_bottom_is_no_fold() -> None:
    # A bottom that rises by 15 degrees towards the centreplane faces 0.26 inward, and is a hull all the same.
    sound = wigley()
    floor = np.array([[0.0, 0.02], [0.015, 0.016], [0.03, 0.012]])
    x = np.linspace(0.3, 0.7, 5)
    points = np.zeros((5, 3, 3))
    points[..., 0], points[..., 1], points[..., 2] = x[:, None], floor[:, 0], floor[:, 1]
    panels, _ = solver_axes(replace(sound, quads=np.concatenate([sound.quads, grid_quads(points)])))
    assert np.min(panels.normal[:, 1]) < -0.2
    check_panels(replace(sound, quads=np.concatenate([sound.quads, grid_quads(points)])), panels)


def test_froude_number_of_a_design_outside_the_range_is_a_failed_evaluation() -> None:
    # At fixed speed a shorter design is faster: 0.5 sqrt(355/331) = 0.518.
    case = load_case(TWO_SPEEDS)
    case = replace(case, conditions=replace(case.conditions, froude_numbers=(0.22, 0.5)))
    design = replace(case.initial.variables, length_to_breadth=6.5)
    evaluation = evaluate(case, design, 2)
    assert evaluation.status == "failed"
    assert "Froude number 0.51" in evaluation.reason


def test_waterline_that_does_not_fit_the_water() -> None:
    sound = wigley()
    wide = sound.waterline * np.array([1.0, 12.0])
    with pytest.raises(SolverFailure, match="waterline"):
        solve_panels(replace(sound, waterline=wide), [0.3], COARSE)


def test_too_slow_for_the_mesh_is_a_reason_and_not_a_negative_number() -> None:
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    with pytest.raises(SolverFailure, match="not positive"):
        solve(hull, [0.1])


@pytest.mark.parametrize(
    "change",
    [
        {"rows": 2},
        {"columns_along_hull": 3},
        {"half_width": -1.0},
        {"planes": ()},
        {"planes": (2.0,)},
        {"collocation_shift": 0.9},
    ],
)
def test_settings_that_make_no_mesh(change: dict[str, object]) -> None:
    with pytest.raises(InputError, match="Rankine settings"):
        RankineSettings(**change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "dimensions", [(355.0, 120.0, 14.5), (355.0, 51.0, 0.5), (355.0, 5.0, 14.5), (100.0, 51.0, 14.5)]
)
def test_odd_ships_give_positive_numbers_or_reasons(dimensions: tuple[float, float, float]) -> None:
    hull = load_parent_hull().transform(*dimensions)
    try:
        result = solve(hull, [0.22, 0.4], COARSE)
    except SolverFailure as failure:
        assert failure.reason
        return
    for condition in result.conditions:
        numbers = (condition.wave_coefficient, condition.wave_coefficient_pressure, condition.sinkage, condition.trim)
        assert np.all(np.isfinite(numbers))
        assert condition.wave_coefficient > 0.0


def test_no_waves_at_a_low_speed_name_the_speed_that_has_them() -> None:
    """A wave of 2 pi Fn^2 L has 7 cells of L/31 at Fn 0.19 (0.1896); "take a higher speed" had to be guessed at."""
    with pytest.raises(SolverFailure, match=r"5.2 cells .* take Froude number 0.19 or more, or level 1 alone"):
        check_answer(0.163, -1e-6, 1e-5, np.zeros(3), 1.0 / 31.0)
    with pytest.raises(SolverFailure, match="take a higher speed, or level 1 alone"):
        check_answer(0.25, -1e-6, 1e-5, np.zeros(3), 1.0 / 31.0)
