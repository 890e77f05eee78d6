"""Each setting of [optimization], by what it must do to a search of which everything is known."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from hand_calculation import BASE

from hpsop_core.case.case import Case
from hpsop_core.case.fields import rules
from hpsop_core.case.sections import OptimizationSection
from hpsop_core.case.variables import DesignVariables
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.optimization.two_level import TwoLevelSearch

Answer = Callable[[Candidate], tuple[tuple[float, float], float]]
# The blade count mutates by an operator of its own: without it every gene is a number on its range.
SPACE = BASE.with_bounds({"blade_count": (4, 4)})


def settings(**changes: object) -> Case:
    plan: dict[str, object] = {
        "population": 16,
        "generations": 6,
        "level1_generations": 6,
        "constraint_handling": "feasibility_first",
    }
    return SPACE.replaced("optimization", **{**plan, **changes})


def shares(case: Case, design: DesignVariables) -> np.ndarray:
    """Each free variable's place in its range, 0 to 1."""
    space = case.bounds
    at = space.encode(design)
    return (at - space.relaxed_lower) / (space.relaxed_upper - space.relaxed_lower)


class Driven:
    """A search to its end, or for some generations, with every design and outcome kept."""

    def __init__(self, case: Case, answer: Answer, generations: int | None = None) -> None:
        self.case = case
        self.designs: dict[int, DesignVariables] = {}
        self.outcomes: dict[int, Outcome] = {}
        self.asked: list[tuple[Candidate, ...]] = []
        self.told: list[Generation] = []
        ids: dict[tuple[float, ...], int] = {}
        search = TwoLevelSearch(case.bounds, case.optimization, case.initial.variables)
        while not search.finished and (generations is None or len(self.told) < generations):
            candidates = search.ask()
            if not candidates:
                break
            self.asked.append(candidates)
            outcomes = []
            for candidate in candidates:
                number = ids.setdefault(candidate.key, len(ids) + 1)
                objectives, g = answer(candidate)
                self.designs[number] = candidate.variables
                outcome = Outcome(number, objectives, (max(0.0, g),), g <= 0.0)
                self.outcomes[number] = outcome
                outcomes.append(outcome)
            self.told.append(search.tell(outcomes))
        self.finished = search.finished


def opposed(case: Case) -> Answer:
    """Two objectives that oppose each other along the first variable: every design stands on the front."""

    def answer(candidate: Candidate) -> tuple[tuple[float, float], float]:
        first = float(shares(case, candidate.variables)[0])
        return (first, 1.0 - first), -1.0

    return answer


def bred(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """The first sample's genes, and those of the first designs bred from it."""
    run = Driven(case, opposed(case), 2)
    first, second = (np.array([shares(case, item.variables) for item in run.asked[index]]) for index in (0, 1))
    return first, second


def test_without_crossover_and_mutation_nothing_new_is_ever_bred() -> None:
    case = settings(crossover_probability=0.0, mutation_probability=0.0)
    run = Driven(case, opposed(case))
    assert len(run.told) == 1 and run.finished
    assert all(len(other.asked) > 1 for other in (
        Driven(settings(crossover_probability=1.0, mutation_probability=0.0), opposed(case), 2),
        Driven(settings(crossover_probability=0.0, mutation_probability=0.5), opposed(case), 2),
    ))  # fmt: skip


@pytest.mark.parametrize("probability", [0.1, 0.5, 0.9])
def test_so_many_genes_mutate(probability: float) -> None:
    case = settings(population=200, crossover_probability=0.0, mutation_probability=probability)
    parents, children = bred(case)
    genes = parents.shape[1]
    # Without crossover a child is its parent but for what mutated; what did not mutate at all is no new design.
    kept = np.abs(children[:, None, :] - parents[None]) < 1e-12
    changed = genes - kept.sum(axis=2).max(axis=1)
    wanted = genes * probability / (1.0 - (1.0 - probability) ** genes)
    # The scatter of a mean of 200 binomial numbers, four times.
    scatter = 4.0 * np.sqrt(genes * probability * (1.0 - probability) / len(children))
    assert abs(changed.mean() - wanted) < scatter


@pytest.mark.parametrize("eta", [5.0, 20.0, 80.0])
def test_mutations_are_as_far_as_their_index_says(eta: float) -> None:
    case = settings(population=300, crossover_probability=0.0, mutation_probability=0.2, mutation_eta=eta)
    parents, children = bred(case)
    apart = np.abs(children[:, None, :] - parents[None])
    nearest = np.argmax((apart < 1e-12).sum(axis=2), axis=1)
    moved = apart[np.arange(len(children)), nearest]
    moved = moved[moved > 1e-12]
    # Deb and Agrawal 1999: delta = 1 - (2 (1 - u))^(1/(eta + 1)), whose mean is 1/(eta + 2) of the range; near a bound
    # it is cut, which the 20 % allow for, with the scatter of some 400 samples.
    assert moved.mean() == pytest.approx(1.0 / (eta + 2.0), rel=0.2)


def test_crossover_stays_nearer_to_the_parents_with_a_greater_index() -> None:
    def distance(eta: float) -> float:
        case = settings(population=40, crossover_probability=1.0, mutation_probability=0.0, crossover_eta=eta)
        parents, children = bred(case)
        return float(np.abs(children[:, None, :] - parents[None]).min(axis=1).mean())

    # Deb and Agrawal 1995: |1 - beta| is 1/(eta + 2) on the inner half; the parents lie a third of the range apart, so
    # that a child at index 100 is at most some hundredth of it away and at index 2 as far as any design is.
    far, near = distance(2.0), distance(100.0)
    assert near < 0.3 * far


def test_the_crossover_is_had_as_often_as_its_probability_says() -> None:
    def share(probability: float) -> float:
        case = settings(
            population=200, crossover_probability=probability, mutation_probability=0.02, mutation_eta=100.0
        )
        parents, children = bred(case)
        # A child without crossover, and with one gene of hardly more, has all but one or two genes of one parent.
        kept = (np.abs(children[:, None, :] - parents[None]) < 1e-12).sum(axis=2).max(axis=1)
        return float(np.mean(kept < parents.shape[1] - 2))

    assert share(0.0) < 0.02 < share(0.3) < share(1.0)
    assert share(1.0) > 0.3


@pytest.mark.parametrize("keep", [True, False])
def test_the_initial_design_is_kept_where_the_case_says(keep: bool) -> None:
    plan = {"generations": 4, "level1_generations": 2, "reseed_share": 0.25, "keep_initial": keep}
    case = settings(**plan)

    def answer(candidate: Candidate) -> tuple[tuple[float, float], float]:
        # The initial design is the worst there is: only the setting can bring it to level 2.
        worst = 9.0 if candidate.variables == case.initial.variables else 0.0
        first = float(shares(case, candidate.variables)[0])
        return (first + worst, 1.0 - first + worst), -1.0

    run = Driven(case, answer)
    for asked in (run.asked[0], run.asked[2]):
        assert (case.initial.variables in [item.variables for item in asked]) == keep
        assert len(asked) == 16
    if not keep:
        # A Latin hypercube of the whole population: one sample in each sixteenth of each range.
        sample = np.array([shares(case, item.variables) for item in run.asked[0]])
        for column in sample.T:
            assert sorted(np.floor(16 * column).astype(int)) == list(range(16))


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5])
def test_so_many_designs_are_sampled_anew_at_level_2(share: float) -> None:
    case = settings(generations=4, level1_generations=2, reseed_share=share, keep_initial=False)
    run = Driven(case, opposed(case))
    origins = [item.origin for item in run.asked[2]]
    assert origins.count("reseed") == round(16 * share)
    assert origins.count("handover") == 16 - round(16 * share)


@pytest.mark.parametrize("window", [2, 3, 5])
def test_a_level_that_stands_still_ends_after_the_window(window: int) -> None:
    case = settings(
        generations=12, level1_generations=10, stagnation_window=window, stagnation_tolerance=0.01, population=8
    )
    # One and the same point for every design: the hypervolume never grows after the first generation.
    run = Driven(case, lambda candidate: ((0.9, 0.9), -1.0))
    levels = [generation.level for generation in run.told]
    assert levels == [1] * (window + 1) + [2] * (11 - window)


def test_a_level_that_grows_more_than_the_tolerance_goes_on() -> None:
    def levels(tolerance: float) -> list[int]:
        case = settings(
            generations=8, level1_generations=6, stagnation_window=2, stagnation_tolerance=tolerance, population=8
        )
        seen: list[tuple[Candidate, ...]] = []

        def answer(candidate: Candidate) -> tuple[tuple[float, float], float]:
            # Each generation of eight designs better by a tenth of the area below (1.2, 1.2).
            seen.append((candidate,))
            generation = (len(seen) - 1) // 8
            side = (0.1 * 1.1**generation) ** 0.5
            return (1.2 - side, 1.2 - side), -1.0

        return [generation.level for generation in Driven(case, answer).told]

    # Over two generations it grows by 21 %.
    assert levels(0.20) == [1] * 6 + [2] * 2
    assert levels(0.22)[:4] == [1, 1, 1, 2]
    assert levels(0.0) == [1] * 6 + [2] * 2


@pytest.mark.parametrize("factor", [0.0, 0.5, 1000.0])
def test_survivors_are_the_best_by_the_penalised_objectives(factor: float) -> None:
    case = settings(constraint_handling="penalty", penalty_factor=factor, population=40)

    def answer(candidate: Candidate) -> tuple[tuple[float, float], float]:
        first, second = (float(value) for value in shares(case, candidate.variables)[:2])
        return (first, 1.0 - 0.5 * first + second), 0.5 - second

    run = Driven(case, answer, 2)
    penalised = {
        number: tuple(value + factor * outcome.violations[0] for value in outcome.objectives or ())
        for number, outcome in run.outcomes.items()
    }
    best = {
        number
        for number, own in penalised.items()
        if not any(a <= own[0] and b <= own[1] and (a, b) != own for a, b in penalised.values())
    }
    assert 1 < len(best) < 40
    assert best <= set(run.told[1].members)
    violated = [number for number in best if not run.outcomes[number].feasible]
    assert (len(violated) > 0) == (factor < 1.0)


def test_feasible_designs_come_first_where_the_case_says() -> None:
    def answer_of(case: Case) -> Answer:
        def answer(candidate: Candidate) -> tuple[tuple[float, float], float]:
            first, second = (float(value) for value in shares(case, candidate.variables)[:2])
            return (first + second, 1.0 - first + second), 0.5 - second

        return answer

    feasible_first = settings(constraint_handling="feasibility_first", population=40)
    run = Driven(feasible_first, answer_of(feasible_first), 2)
    feasible = {number for number, outcome in run.outcomes.items() if outcome.feasible}
    assert feasible <= set(run.told[1].members) or set(run.told[1].members) <= feasible
    light = settings(constraint_handling="penalty", penalty_factor=0.0, population=40)
    run = Driven(light, answer_of(light), 2)
    assert not any(run.outcomes[number].feasible for number in run.told[1].members[:5])


@pytest.mark.parametrize("margin", [0.0, 0.05, 0.2])
def test_the_search_keeps_the_hand_over_margin(margin: float) -> None:
    case = settings(
        generations=4, level1_generations=2, handover_margin=margin, penalty_factor=100.0, population=40,
        constraint_handling="penalty",
    )  # fmt: skip
    search = TwoLevelSearch(case.bounds, case.optimization, case.initial.variables)
    outcomes: dict[int, Outcome] = {}
    for _ in range(2):
        told = []
        for candidate in search.ask():
            first, second = (float(value) for value in shares(case, candidate.variables)[:2])
            # g3 = 0.4 - second, and the less area the better.
            g = 0.4 - second
            number = len(outcomes) + 1
            outcomes[number] = Outcome(number, (first, 1.0 - first + second), (max(0.0, g),), g <= 0.0, g)
            told.append(outcomes[number])
        members = search.tell(told).members
    kept = sum(outcomes[number].cavitation <= -margin for number in outcomes if outcomes[number].feasible)
    inside = [number for number in members if outcomes[number].cavitation > -margin]
    # There are more designs that keep the margin than places: none that does not may live, at a penalty of 100.
    assert kept > 20
    best = sorted(outcomes.values(), key=lambda item: max(0.0, item.cavitation + margin))
    allowed = {item.evaluation_id for item in best[: len(members)]} | {
        item.evaluation_id for item in best if item.cavitation <= -margin
    }
    assert set(inside) <= allowed


def test_population_generations_and_seed_are_the_cases() -> None:
    run = Driven(settings(population=10, generations=5, level1_generations=3), opposed(settings()))
    assert [len(asked) for asked in run.asked] == [10] * 5
    assert [generation.level for generation in run.told] == [1, 1, 1, 2, 2]
    first, again, other = (bred(settings(seed=seed))[0].tolist() for seed in (5, 5, 6))
    assert first == again != other


def test_no_setting_is_forgotten_here() -> None:
    told = {
        "population", "generations", "level1_generations", "crossover_probability", "crossover_eta",
        "mutation_probability", "mutation_eta", "seed", "constraint_handling", "penalty_factor", "handover_margin",
        "reseed_share", "keep_initial", "stagnation_window", "stagnation_tolerance",
    }  # fmt: skip
    # The time limit is one of the workers (tests/faults/test_runs_faults.py); what is learnt on the way and the errors
    # at the end have tests of their own (tests/invariance/test_surface.py, test_final_errors.py).
    elsewhere = {
        "evaluation_time_limit",
        "surface",
        "surface_generations",
        "surface_sample",
        "surface_checks",
        "final_errors",
    }
    assert told | elsewhere == set(rules(OptimizationSection))
    assert {field.name for field in dataclasses.fields(OptimizationSection)} == set(rules(OptimizationSection))
