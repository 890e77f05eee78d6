"""The two-level search without files or processes: its plan, its hand-over, and what it does to failures."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import pytest

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.optimization import two_level
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.indicators import hypervolume
from hpsop_core.optimization.problem import FAILED_VIOLATION, Candidate, Outcome, algorithm_view
from hpsop_core.optimization.two_level import TwoLevelSearch
from hpsop_core.typing_aliases import Array
from tests.two_speeds import TWO_SPEEDS


def answer(case: Case, candidate: Candidate) -> tuple[tuple[float, float], tuple[float, ...]]:
    """Two conflicting objectives near 1 with a constraint that a third of the space violates."""
    space = case.bounds
    shares = [
        (value - low) / (high - low) if high > low else 0.0
        for value, low, high in zip(candidate.variables.key(), space.lower, space.upper, strict=True)
    ]
    shift = 0.02 * (candidate.level - 1)
    first = 0.75 + 0.3 * shares[0] + 0.2 * sum((share - 0.5) ** 2 for share in shares[2:]) + shift
    second = 1.05 - 0.3 * math.sqrt(max(0.0, shares[0])) + 0.2 * sum((s - 0.4) ** 2 for s in shares[2:]) + shift
    return (first, second), (0.3 - shares[1],)


class Play:
    """A search driven to its end in memory."""

    def __init__(
        self,
        case: Case,
        fails: Callable[[DesignVariables], bool] = lambda variables: False,
        seeds: tuple[DesignVariables, ...] = (),
        extend_to: int | None = None,
    ) -> None:
        self.case = case
        self.ids: dict[tuple[float, ...], int] = {}
        self.outcomes: dict[int, Outcome] = {}
        self.candidates: dict[int, Candidate] = {}
        self.asked: list[tuple[Candidate, ...]] = []
        self.generations: list[Generation] = []
        search = TwoLevelSearch(case.bounds, case.optimization, case.initial.variables, seeds)
        if extend_to is not None:
            search.extend(extend_to)
        while not search.finished:
            candidates = search.ask()
            if not candidates:
                break
            assert search.ask() == candidates, "asking twice must not draw new numbers"
            self.asked.append(candidates)
            self.generations.append(search.tell([self.outcome(c, fails) for c in candidates]))

    def outcome(self, candidate: Candidate, fails: Callable[[DesignVariables], bool]) -> Outcome:
        number = self.ids.setdefault(candidate.key, len(self.ids) + 1)
        self.candidates[number] = candidate
        if fails(candidate.variables):
            result = Outcome(number, None, (), False)
        else:
            objectives, constraints = answer(self.case, candidate)
            feasible = all(g <= 1e-6 for g in constraints)
            result = Outcome(number, objectives, tuple(max(0.0, g) for g in constraints), feasible)
        self.outcomes[number] = result
        return result

    def designs(self, ids: tuple[int, ...]) -> list[DesignVariables]:
        return [self.candidates[number].variables for number in ids]


def small_case(name: str = TWO_SPEEDS, **settings: object) -> Case:
    defaults: dict[str, object] = {"population": 12, "generations": 10, "level1_generations": 6}
    return load_case(name).replaced("optimization", **{**defaults, **settings})


def test_generations_and_levels_are_counted_as_the_plan_says() -> None:
    play = Play(small_case())
    assert [generation.number for generation in play.generations] == list(range(1, 11))
    assert [generation.level for generation in play.generations] == [1] * 6 + [2] * 4
    assert all(len(asked) == 12 for asked in play.asked)
    notes = [generation.number for generation in play.generations if generation.note]
    assert notes == [6]


@pytest.mark.parametrize(("level1", "levels"), [(0, [2] * 10), (10, [1] * 10)])
def test_one_level_alone(level1: int, levels: list[int]) -> None:
    assert [generation.level for generation in Play(small_case(level1_generations=level1)).generations] == levels


def test_the_same_answers_give_the_same_search() -> None:
    first, second = Play(small_case()), Play(small_case())
    assert first.asked == second.asked
    assert first.generations == second.generations
    other = Play(small_case(seed=2))
    assert other.asked[0] != first.asked[0]


def test_more_generations_begin_with_the_same_ones() -> None:
    short, extended = Play(small_case()), Play(small_case(), extend_to=14)
    assert extended.generations[:10] == short.generations
    assert [generation.level for generation in extended.generations] == [1] * 6 + [2] * 8
    only_level1 = Play(small_case(level1_generations=10), extend_to=13)
    assert [generation.level for generation in only_level1.generations] == [1] * 13


def test_the_initial_design_is_in_the_first_sample_projected_on_the_bounds() -> None:
    case = small_case()
    case = case.with_bounds({"diameter": (9.2, 9.5)})
    initial = case.initial.variables
    assert case.bounds.project(initial) != initial
    sample = [candidate.variables for candidate in Play(case).asked[0]]
    assert case.bounds.project(initial) in sample
    assert initial not in sample
    assert all(case.bounds.project(design) == design for design in sample)


def test_the_recommended_hand_over_keeps_the_best_the_initial_and_reseeds_the_share() -> None:
    play = Play(small_case(population=20, reseed_share=0.25))
    last = play.generations[5]
    handed = play.asked[6]
    origins = [candidate.origin for candidate in handed]
    designs = [candidate.variables for candidate in handed]
    assert origins.count("reseed") == 5
    assert origins.count("handover") == 15
    assert play.case.bounds.project(play.case.initial.variables) in designs
    members = play.designs(last.members)
    kept = [design for design, origin in zip(designs, origins, strict=True) if origin == "handover"]
    # The best first; one place may be the initial design's.
    assert kept[:14] == members[:14]
    # Latin hypercube of five samples on five blade counts: one each.
    assert sorted(c.variables.blade_count for c in handed if c.origin == "reseed") == [3, 4, 5, 6, 7]


def test_the_published_hand_over_takes_the_last_generation_as_it_is() -> None:
    play = Play(small_case("dtc-p4119-paper"))
    assert play.case.optimization.reseed_share == 0.0
    handed = [candidate.variables for candidate in play.asked[6]]
    members = play.designs(play.generations[5].members)
    assert sorted(design.key() for design in handed) == sorted(design.key() for design in members)


def test_stagnation_hands_over_early_and_level_2_has_the_rest() -> None:
    case = small_case(generations=60, level1_generations=50, stagnation_window=5, stagnation_tolerance=0.05)
    play = Play(case)
    levels = [generation.level for generation in play.generations]
    handed_over = levels.index(2)
    assert 6 <= handed_over < 50
    assert len(levels) == 60
    assert "hypervolume grew by less" in play.generations[handed_over - 1].note
    # The criterion by its words, on everything seen at level 1 up to then.
    seen: list[tuple[float, float]] = []
    volumes = []
    for asked in play.asked[:handed_over]:
        outcomes = [play.outcomes[play.ids[candidate.key]] for candidate in asked]
        seen += [outcome.objectives for outcome in outcomes if outcome.feasible and outcome.objectives]
        volumes.append(hypervolume(seen))
    stagnant = [n for n in range(5, len(volumes)) if volumes[n] - volumes[n - 5] < 0.05 * volumes[n - 5]]
    assert stagnant[0] == handed_over - 1


@pytest.mark.parametrize("handling", ["penalty", "feasibility_first"])
def test_failures_are_never_in_a_front_and_do_not_take_over(handling: str) -> None:
    def fails(variables: DesignVariables) -> bool:
        return int(variables.draft * 1e9) % 4 == 0  # a quarter of all designs, anywhere in the space

    play = Play(small_case(constraint_handling=handling), fails)
    assert sum(outcome.failed for outcome in play.outcomes.values()) > 15
    for generation in play.generations:
        assert all(play.outcomes[number].feasible for number in generation.front)
        assert generation.failures == sum(play.outcomes[number].failed for number in generation.asked)
    for last in (play.generations[5], play.generations[-1]):
        assert not any(play.outcomes[number].failed for number in last.members)


@pytest.mark.parametrize("handling", ["penalty", "feasibility_first"])
def test_fronts_are_feasible_members_that_nobody_beats(handling: str) -> None:
    play = Play(small_case(constraint_handling=handling, population=16))
    for generation in play.generations:
        front = [play.outcomes[number] for number in generation.front]
        assert set(generation.front) <= set(generation.members)
        rivals = [play.outcomes[n].objectives for n in generation.members if play.outcomes[n].feasible]
        for outcome in front:
            mine = outcome.objectives
            assert outcome.feasible and mine is not None
            assert not any(r[0] <= mine[0] and r[1] <= mine[1] and r != mine for r in rivals if r)
        assert generation.hypervolume == hypervolume([outcome.objectives for outcome in front if outcome.objectives])
        assert generation.compromise in generation.front and generation.knee in generation.front
        share = sum(play.outcomes[n].feasible for n in generation.members) / len(generation.members)
        assert generation.feasible_share == share


def test_the_penalty_is_the_papers_and_reported_objectives_stay_without_it() -> None:
    violated = Outcome(1, (0.9, 0.8), (0.02, 0.0, 0.03), False)
    objectives, constraint = algorithm_view([violated], "penalty", 10.0)
    # Sums of two-digit decimals: rounding only.
    assert objectives[0] == pytest.approx([0.9 + 0.5, 0.8 + 0.5], abs=1e-14)
    assert constraint[0, 0] == 0.0
    assert violated.objectives == (0.9, 0.8)
    objectives, constraint = algorithm_view([violated], "feasibility_first", 10.0)
    assert tuple(objectives[0]) == (0.9, 0.8)
    assert constraint[0, 0] == pytest.approx(0.05, abs=1e-15)
    failed = Outcome(2, None, (), False)
    for handling in ("penalty", "feasibility_first"):
        objectives, constraint = algorithm_view([failed], handling, 10.0)
        # also by its objectives alone it stands behind everything that was computed, whose own are of order one
        assert objectives.min() > 100.0
        assert constraint[0, 0] == FAILED_VIOLATION
        assert all(math.isfinite(value) for value in objectives[0])


def test_the_hand_over_margin_tightens_what_the_search_sees_and_nothing_that_is_reported() -> None:
    kept = Outcome(1, (0.9, 0.8), (0.0, 0.0), True, cavitation=-0.015)
    broken = Outcome(2, (0.9, 0.8), (0.0, 0.03), False, cavitation=0.03)
    free = Outcome(3, (0.9, 0.8), (0.0,), True)
    objectives, _ = algorithm_view([kept, broken, free], "penalty", 10.0, 0.02)
    # 10 (g3 + margin), once: two-digit decimals, rounding only.
    assert objectives[:, 0] == pytest.approx([0.95, 1.4, 0.9], abs=1e-14)
    _, constraint = algorithm_view([kept, broken, free], "feasibility_first", 10.0, 0.02)
    assert constraint[:, 0] == pytest.approx([0.005, 0.05, 0.0], abs=1e-15)
    without, _ = algorithm_view([kept], "penalty", 10.0)
    assert without[0, 0] == 0.9 and kept.feasible


@pytest.mark.parametrize(("level1", "margins"), [(4, [0.02] * 4 + [0.0] * 2), (6, [0.0] * 6)])
def test_the_margin_holds_where_level_2_is_to_come(
    monkeypatch: pytest.MonkeyPatch, level1: int, margins: list[float]
) -> None:
    seen: list[float] = []

    def watched(outcomes: list[Outcome], handling: str, factor: float, margin: float) -> tuple[Array, Array]:
        seen.append(margin)
        return algorithm_view(outcomes, handling, factor, margin)

    monkeypatch.setattr(two_level, "algorithm_view", watched)
    Play(small_case(population=8, generations=6, level1_generations=level1))
    assert seen == margins


def test_constraints_that_do_not_apply_are_left_out_and_feasibility_has_its_tolerance() -> None:
    data = {
        "status": "ok",
        "objectives": {"f1": 1.0, "f2": 1.0},
        "constraints": {"displacement": 9e-7, "diameter_to_draft": -0.2, "cavitation": None},
        "feasible": True,
    }
    assert Outcome.from_json(1, data).feasible
    above = {**data, "constraints": {**data["constraints"], "displacement": 2e-6}, "feasible": False}
    assert not Outcome.from_json(1, above).feasible
    # Called infeasible although every constraint shown is kept: it must not pass for a good design.
    hidden = Outcome.from_json(1, {**data, "feasible": False})
    assert not hidden.feasible and max(hidden.violations) > 0.01
    for number in (float("nan"), float("inf"), None):
        assert Outcome.from_json(1, {**data, "objectives": {"f1": number, "f2": 1.0}}).failed


def test_a_new_run_may_begin_with_an_old_front_in_other_bounds() -> None:
    old = Play(small_case())
    front = tuple(old.designs(old.generations[-1].front))
    case = small_case().with_bounds({"draft": (14.2, 14.3)})
    first = Play(case, seeds=front).asked[0]
    seeded = [candidate.variables for candidate in first if candidate.origin == "seed"]
    expected = dict.fromkeys(case.bounds.project(design) for design in front)
    expected.pop(case.bounds.project(case.initial.variables), None)
    assert seeded == list(expected)[: case.optimization.population - 1]
    assert len(first) == case.optimization.population


def test_a_space_that_is_used_up_ends_the_search() -> None:
    initial = load_case(TWO_SPEEDS).initial.variables.as_dict()
    fixed = {name: (float(value), float(value)) for name, value in initial.items()} | {"blade_count": (3.0, 7.0)}
    case = small_case(population=8).with_bounds(fixed)
    play = Play(case)
    assert {candidate.variables.blade_count for asked in play.asked for candidate in asked} == {3, 4, 5, 6, 7}
    assert {generation.level for generation in play.generations} == {1, 2}
    with pytest.raises(InputError, match="every variable is fixed"):
        Play(case.with_bounds({"blade_count": (4.0, 4.0)}))


def test_settings_are_what_the_case_says() -> None:
    settings = load_case("dtc-p4119-paper").optimization
    assert (settings.population, settings.generations, settings.level1_generations) == (50, 150, 100)
    assert (settings.crossover_probability, settings.mutation_probability) == (0.9, 0.05)
    assert dataclasses.is_dataclass(settings)
