"""Hypervolume, spread, fronts and choices against values that follow from their definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hpsop_core.errors import InputError
from hpsop_core.optimization.decision import compromise, knee
from hpsop_core.optimization.indicators import FrontArchive, feasible_share, hypervolume, spread
from hpsop_core.optimization.problem import Outcome

ROUNDING = 1e-14  # a few operations in double precision on numbers of order one


def outcome(number: int, first: float, second: float, feasible: bool = True) -> Outcome:
    return Outcome(number, (first, second), () if feasible else (0.1,), feasible)


def test_hypervolume_of_rectangles() -> None:
    assert hypervolume([]) == 0.0
    assert hypervolume([(1.0, 1.0)]) == pytest.approx(0.04, abs=ROUNDING)
    # Two overlapping rectangles: 0.4 x 0.1 + 0.2 x 0.3 - 0.2 x 0.1.
    assert hypervolume([(0.8, 1.1), (1.0, 0.9)]) == pytest.approx(0.04 + 0.06 - 0.02, abs=ROUNDING)
    # A dominated design, one beyond the reference point and one on its edge add nothing.
    extra = [(0.8, 1.1), (1.0, 0.9), (1.05, 1.15), (0.5, 1.3), (1.2, 0.1)]
    assert hypervolume(extra) == pytest.approx(0.08, abs=ROUNDING)


def test_hypervolume_of_a_circle_converges_to_its_area() -> None:
    # The front f1^2 + f2^2 = 1 below (1, 1) dominates 1 - pi/4 of the unit square... from outside: the staircase of n
    # points misses less than 1/n of it.
    count = 4000
    angles = np.linspace(0.0, math.pi / 2.0, count)
    front = [(1.0 - math.cos(angle), 1.0 - math.sin(angle)) for angle in angles]
    assert hypervolume(front, (1.0, 1.0)) == pytest.approx(math.pi / 4.0, abs=2.0 / count)


def test_spread_is_zero_for_even_and_known_for_uneven_fronts() -> None:
    assert spread([(0.0, 1.0), (1.0, 0.0)]) is None
    even = [(step / 10.0, 3.0 - 0.3 * step) for step in range(11)]
    assert spread(even) == pytest.approx(0.0, abs=1e-13)
    # Gaps on the line in proportion 1 : 3: mean 2, deviations 1 and 1, so (1 + 1) / (2 * 2).
    assert spread([(0.0, 4.0), (1.0, 3.0), (4.0, 0.0)]) == pytest.approx(0.5, abs=ROUNDING)


def test_front_archive_agrees_with_the_definition() -> None:
    generator = np.random.default_rng(3)
    # A coarse grid makes ties in one and in both objectives common.
    points = generator.integers(0, 12, (400, 2)) / 10.0
    feasible = generator.random(400) < 0.8
    designs = [outcome(i + 1, *point, bool(ok)) for i, (point, ok) in enumerate(zip(points, feasible, strict=True))]
    archive = FrontArchive()
    archive.add(designs)
    expected = {}
    for design in designs:
        if not design.feasible:
            continue
        mine = design.objectives
        rivals = [other.objectives for other in designs if other.feasible and other is not design]
        if any(r[0] <= mine[0] and r[1] <= mine[1] and r != mine for r in rivals):
            continue
        expected.setdefault(mine, design.evaluation_id)  # the first of equal designs stays
    assert dict(zip(archive.objectives, archive.ids, strict=True)) == expected
    assert archive.objectives == sorted(archive.objectives)


def test_failed_and_infeasible_designs_are_never_in_a_front() -> None:
    archive = FrontArchive()
    archive.add([outcome(1, 0.1, 0.1, feasible=False), Outcome(2, None, (), False), outcome(3, 1.0, 1.0)])
    assert archive.ids == (3,)
    assert feasible_share([outcome(1, 0.1, 0.1, feasible=False), outcome(3, 1.0, 1.0)]) == 0.5
    assert feasible_share([]) == 0.0


def test_compromise_is_nearest_to_utopia_in_normalised_objectives() -> None:
    # Normalised: (0, 1), (0.3, 0.2), (0.6, 0.1), (1, 0); squared distances 1, 0.13, 0.37, 1.
    front = [(1.0, 300.0), (1.3, 220.0), (1.6, 210.0), (2.0, 200.0)]
    assert compromise(front) == 1
    assert compromise([]) is None
    assert compromise([(1.0, 1.0)]) == 0
    # Weight moves the choice along the front, to the ends at the ends.
    assert compromise(front, (1.0, 0.0)) == 0
    assert compromise(front, (0.0, 1.0)) == 3
    # 0.25 * 0.6 and 0.1 against 0.25 * 0.3 and 0.2: the third comes nearer.
    assert compromise(front, (0.25, 1.0)) == 2
    for weights in ((0.0, 0.0), (-1.0, 2.0), (float("nan"), 1.0), (float("inf"), 1.0)):
        with pytest.raises(InputError):
            compromise(front, weights)


def test_knee_is_the_farthest_from_the_line_between_the_ends() -> None:
    # A front with its corner at (0.1, 0.15) and a point nearer to utopia in one objective only.
    front = [(0.0, 1.0), (0.05, 0.6), (0.1, 0.15), (0.5, 0.1), (1.0, 0.0)]
    assert knee(front) == 2
    # A front that bulges away from utopia has no knee: the compromise stands in.
    away = [(0.0, 1.0), (0.7, 0.8), (0.8, 0.7), (1.0, 0.0)]
    assert knee(away) == compromise(away)
    assert knee([]) is None
