"""The front that is shown, on designs few enough to see which are the best."""

from __future__ import annotations

from hpsop_core.optimization.generation import Generation
from hpsop_core.runs.fronts import FrontHistory
from hpsop_core.runs.records import ArchivePoint

Place = tuple[float, float]


def point(number: int, place: Place | None, level: int = 2, feasible: bool = True, predicted: bool = False):
    return ArchivePoint(number, level, "offspring", 1, place, feasible, predicted)


def generation(number: int, asked: tuple[int, ...], members: tuple[int, ...], level: int = 2) -> Generation:
    return Generation(number, level, asked, members, (), 0.0, None, 1.0, 0, None, None, "")


def test_what_a_full_population_gives_up_stays_on_the_front():
    points = {
        1: point(1, (0.8, 1.0)),
        2: point(2, (1.0, 0.8)),
        3: point(3, (0.9, 0.85)),
        4: point(4, (0.7, 1.1)),
        5: point(5, (0.6, 0.6), feasible=False),
        6: point(6, None),
        7: point(7, (0.8, 1.0)),
    }
    history = FrontHistory(points)
    history.add(generation(1, (1, 2, 3), (1, 2, 3)))
    # a population of three: 3 had to go, and 7 is no better than 1
    found = history.add(generation(2, (4, 5, 6, 7), (4, 7, 2)))
    assert found.ids == (4, 1, 3, 2)
    # rectangles below (1.2, 1.2), by hand
    assert abs(found.hypervolume - (0.5 * 0.1 + 0.4 * 0.1 + 0.3 * 0.15 + 0.2 * 0.05)) < 1e-12
    assert found.compromise in found.ids and found.knee in found.ids


def test_a_level_has_a_front_of_its_own():
    history = FrontHistory({1: point(1, (0.5, 0.5), level=1), 2: point(2, (0.9, 0.9))})
    assert history.add(generation(1, (1,), (1,), level=1)).ids == (1,)
    assert history.add(generation(2, (2,), (2,))).ids == (2,)


def test_a_prediction_stands_on_the_front_only_while_it_is_the_population():
    points = {1: point(1, (0.9, 0.9)), 2: point(2, (0.8, 0.8), predicted=True), 3: point(3, (0.85, 0.95))}
    history = FrontHistory(points)
    assert history.add(generation(1, (1,), (1,))).ids == (1,)
    assert history.add(generation(2, (2,), (2, 1))).ids == (2,)
    # the last generation is solved: the prediction that was too good is gone
    assert history.add(generation(3, (3,), (3, 1))).ids == (3, 1)
