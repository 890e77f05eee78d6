"""NSGA-II by ask and tell against pymoo's own loop, pymoo's hypervolume, and a problem with a known front."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.indicators.hv import HV
from pymoo.operators.crossover.sbx import SBX
from pymoo.optimize import minimize

from hpsop_core.case.case import load_case
from hpsop_core.case.variables import DesignSpace
from hpsop_core.optimization.indicators import hypervolume
from hpsop_core.optimization.nsga2 import DecodedDuplicates, MixedMutation, Nsga2, Operators, rounded
from hpsop_core.optimization.sampling import latin_hypercube

OPERATORS = Operators(40, 0.9, 15.0, 0.05, 20.0)


@pytest.fixture(scope="module")
def space() -> DesignSpace:
    return load_case("dtc-p4119-paper").bounds


def zdt1(space: DesignSpace, vectors: np.ndarray) -> np.ndarray:
    """Zitzler, Deb, Thiele 2000, T1, of the decoded designs on the unit box; its front is f2 = 1 - sqrt(f1)."""
    decoded = np.array([space.encode(space.decode(vector)) for vector in vectors])
    lower, upper = (np.array([bounds[i] for i in space.free]) for bounds in (space.lower, space.upper))
    unit = (decoded - lower) / (upper - lower)
    g = 1.0 + 9.0 * unit[:, 1:].mean(axis=1)
    return np.column_stack((unit[:, 0], g * (1.0 - np.sqrt(unit[:, 0] / g))))


def advance(space: DesignSpace, generations: int, shuffled: bool = False) -> Nsga2:
    search = Nsga2(space, OPERATORS, latin_hypercube(space, 40, 2), seed=5)
    generator = np.random.default_rng(0)
    for generation in range(generations):
        vectors = search.ask()
        assert vectors is not None
        order = generator.permutation(len(vectors)) if shuffled else np.arange(len(vectors))
        objectives = np.zeros((len(vectors), 2))
        objectives[order] = zdt1(space, vectors[order])
        tags = [1000 * generation + row for row in range(len(vectors))]
        search.tell(tags, objectives, np.zeros((len(vectors), 1)))
    return search


def test_ask_and_tell_give_the_bits_of_pymoos_own_loop(space) -> None:
    class Theirs(Problem):
        def _evaluate(self, x, out, *args, **kwargs) -> None:
            out["F"] = zdt1(space, x)
            out["G"] = np.zeros((len(x), 1))

    lower, upper = space.relaxed_lower, space.relaxed_upper
    problem = Theirs(n_var=len(lower), n_obj=2, n_ieq_constr=1, xl=lower, xu=upper)
    place = space.blade_count_position
    algorithm = NSGA2(
        pop_size=40,
        sampling=latin_hypercube(space, 40, 2),
        crossover=SBX(prob=0.9, eta=15.0),
        mutation=MixedMutation(0.05, 20.0, place),
        eliminate_duplicates=DecodedDuplicates(place, lower, upper),
    )
    result = minimize(problem, algorithm, ("n_gen", 12), seed=5)
    ours = advance(space, 12)
    mine = {member.X.tobytes() for member in ours._algorithm.pop}
    assert mine == {member.X.tobytes() for member in result.pop}


def test_order_of_evaluation_does_not_matter(space) -> None:
    assert advance(space, 8).population == advance(space, 8, shuffled=True).population


def test_it_finds_the_front_of_zdt1(space) -> None:
    search = advance(space, 120)
    front = search._algorithm.pop.get("F")
    # The area below (1, 1) beyond the true front is 2/3. Forty points on it leave a staircase of about 1 % of it; the
    # blade count is an integer that must find its best value. 4 % is what forty points in 120 generations should reach.
    assert hypervolume([tuple(point) for point in front], (1.0, 1.0)) > 0.96 * 2.0 / 3.0
    assert np.all(np.floor(search._algorithm.pop.get("X")[:, space.blade_count_position] + 0.5) == 3)


def test_hypervolume_agrees_with_pymoo() -> None:
    points = np.random.default_rng(1).random((60, 2)) * 1.5
    expected = HV(ref_point=np.array([1.2, 1.2]))(points)
    # The same sum of rectangles in another order.
    assert hypervolume([tuple(point) for point in points]) == pytest.approx(expected, rel=1e-12)


def test_mutation_changes_five_percent_of_the_genes_and_of_the_blade_counts(space) -> None:
    lower, upper = space.relaxed_lower, space.relaxed_upper
    place = space.blade_count_position
    problem = Problem(n_var=len(lower), n_obj=2, xl=lower, xu=upper)
    count = 20000
    generator = np.random.default_rng(7)
    before = lower + generator.random((count, len(lower))) * (upper - lower)
    after = MixedMutation(0.05, 20.0, place)._do(problem, before, random_state=generator)
    changed = after != before
    # Standard deviation of the observed share: sqrt(.05 .95 / 20000) = .0015; four of them.
    assert changed.mean(axis=0) == pytest.approx(np.full(len(lower), 0.05), abs=0.006)
    old, new = (np.floor(x[:, place] + 0.5).astype(int) for x in (before, after))
    moved = old[changed[:, place]] != new[changed[:, place]]
    assert moved.all(), "a mutation of the blade count must change it"
    assert set(new) == {3, 4, 5, 6, 7}
    assert np.all(after >= lower) and np.all(after <= upper)


def test_duplicates_are_judged_on_decoded_designs(space) -> None:
    vectors = np.vstack([latin_hypercube(space, 1, 1)] * 3)
    place = space.blade_count_position
    vectors[0, place], vectors[1, place], vectors[2, place] = 3.6, 4.4, 4.6
    decoded = rounded(vectors, place, space.relaxed_lower, space.relaxed_upper)
    assert np.array_equal(decoded[0], decoded[1]) and not np.array_equal(decoded[0], decoded[2])
    assert space.decode(vectors[0]) == space.decode(vectors[1])
    search = Nsga2(space, OPERATORS, vectors, seed=1)
    asked = search.ask()
    assert asked is not None and len(asked) == 2


def test_the_algorithm_never_hears_a_nan(space) -> None:
    search = Nsga2(space, OPERATORS, latin_hypercube(space, 40, 2), seed=5)
    asked = search.ask()
    assert asked is not None
    objectives = zdt1(space, asked)
    objectives[3, 0] = np.nan
    with pytest.raises(ValueError, match="finite"):
        search.tell(list(range(40)), objectives, np.zeros((40, 1)))
    with pytest.raises(ValueError, match="design for design"):
        search.tell([1, 2], objectives[:2], np.zeros((2, 1)))
