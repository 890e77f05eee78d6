"""What a run says of its time left, against what its plan asks the solvers for."""

from __future__ import annotations

import dataclasses

import pytest

from hpsop_core.case.case import load_case
from hpsop_core.case.sections import OptimizationSection
from hpsop_core.runs.time_left import designs_to_solve, level2_seconds

SETTINGS = OptimizationSection(
    population=50, surface=True, surface_sample=10, surface_checks=12, surface_generations=12
)


def test_without_a_surface_every_design_is_solved() -> None:
    plain = dataclasses.replace(SETTINGS, surface=False)
    assert designs_to_solve(plain, 50, False) == designs_to_solve(plain, 50, True) == 2500


@pytest.mark.parametrize(
    ("generations", "begun", "solved"),
    [
        (0, True, 0),
        (1, False, 60),  # the first one is the last one
        (2, False, 110),
        (1, True, 50),
        (50, False, 60 + 4 * 24 + 50),
        (13, True, 24 + 50),
    ],
)
def test_with_a_surface_first_checks_and_last_are_solved(generations: int, begun: bool, solved: int) -> None:
    assert designs_to_solve(SETTINGS, generations, begun) == solved


def test_the_demonstration_was_guessed_within_a_half() -> None:
    """161 were solved; a designer wants to know whether it takes one minute or five."""
    settings = load_case("dtc-p4119").optimization
    level2 = settings.generations - settings.level1_generations
    assert 161 / 1.5 <= designs_to_solve(settings, level2, False) <= 161 * 1.5


def test_generations_that_are_predicted_are_measured() -> None:
    # nothing is known of predicted ones yet: only what is solved counts for much
    assert level2_seconds(SETTINGS, 50, 0.12, []) == pytest.approx(206 * 0.12 + 50 * 0.3)
    assert level2_seconds(SETTINGS, 49, 0.12, [7.0]) == pytest.approx(146 * 0.12 + 49 * 0.3)
    # the first one, which is solved as a whole, tells nothing of the others
    assert level2_seconds(SETTINGS, 40, 0.12, [7.0, 1.0, 0.5, 0.2, 0.2]) == pytest.approx(122 * 0.12 + 40 * 0.35)
