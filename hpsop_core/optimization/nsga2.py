"""NSGA-II at one level of fidelity, asked and told: pymoo proposes, this project evaluates, pauses and stores."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.duplicate import DuplicateElimination
from pymoo.core.mutation import Mutation
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from hpsop_core.case.variables import DesignSpace
from hpsop_core.typing_aliases import Array, BoolArray


@dataclass(frozen=True)
class Operators:
    """NSGA-II's numbers.

    Attributes:
        population: designs a generation.
        crossover_probability, crossover_eta: simulated binary crossover of a pair.
        mutation_probability, mutation_eta: polynomial mutation of a gene (Deb's reading of the paper's 0.05, not that
            of a whole design); the blade count mutates with the same probability by an operator of its own.
    """

    population: int
    crossover_probability: float
    crossover_eta: float
    mutation_probability: float
    mutation_eta: float


def rounded(vectors: Array, blade_count_position: int | None, lower: Array, upper: Array) -> Array:
    """Vectors with the relaxed blade count replaced by the integer it decodes to: equal rows are equal designs."""
    result = vectors.copy()
    if blade_count_position is not None:
        place = blade_count_position
        integers = np.floor(result[:, place] + 0.5)
        result[:, place] = np.clip(integers, np.ceil(lower[place]), np.floor(upper[place]))
    return result


class DecodedDuplicates(DuplicateElimination):  # type: ignore[misc]
    """Two individuals are the same if they decode to the same design."""

    def __init__(self, blade_count_position: int | None, lower: Array, upper: Array) -> None:
        super().__init__()
        self._place = blade_count_position
        self._lower, self._upper = lower, upper

    def _rows(self, population: Any) -> list[bytes]:
        vectors = rounded(population.get("X").astype(np.float64), self._place, self._lower, self._upper)
        # Adding 0.0 makes -0.0 and 0.0 the same bytes.
        return [row.tobytes() for row in vectors + 0.0]

    def _do(self, pop: Any, other: Any, is_duplicate: BoolArray) -> BoolArray:
        known = set() if other is None else set(self._rows(other))
        for index, row in enumerate(self._rows(pop)):
            if row in known:
                is_duplicate[index] = True
            elif other is None:
                known.add(row)
        return is_duplicate


class MixedMutation(Mutation):  # type: ignore[misc]
    """Polynomial mutation of the real genes; the blade count steps by one or is drawn anew, half and half.

    pymoo's mutation of a relaxed integer would change it in 1.5 % of the offspring only.
    """

    def __init__(self, probability: float, eta: float, blade_count_position: int | None) -> None:
        super().__init__(prob=1.0)
        self._polynomial = PM(prob=1.0, prob_var=probability, eta=eta)
        self._probability = probability
        self._place = blade_count_position

    def _do(self, problem: Any, X: Array, *args: Any, random_state: Any = None, **kwargs: Any) -> Array:
        mutated: Array = self._polynomial._do(problem, X, random_state=random_state)
        place = self._place
        if place is None:
            return mutated
        count = len(X)
        lowest, highest = int(np.ceil(problem.xl[place])), int(np.floor(problem.xu[place]))
        blades = np.clip(np.floor(X[:, place] + 0.5), lowest, highest).astype(np.int64)
        mutates = random_state.random(count) < self._probability
        steps = random_state.random(count) < 0.5
        direction = np.where(random_state.random(count) < 0.5, -1, 1)
        # At an end of the range a step can only go inwards.
        direction = np.where(blades == lowest, 1, np.where(blades == highest, -1, direction))
        # A reset draws from the other values: a mutation that changes nothing is none.
        reset = lowest + random_state.integers(0, highest - lowest, count)
        reset = np.where(reset >= blades, reset + 1, reset)
        changed = np.where(steps, blades + direction, reset)
        mutated[:, place] = np.where(mutates, changed.astype(np.float64), X[:, place])
        return mutated


class Nsga2:
    """One NSGA-II, advanced by ``ask`` and ``tell``. Same seed and same answers: same bits, whatever happens between.

    Args:
        space: the design space; at least one variable is free.
        operators: population and operator numbers.
        first_vectors: the first population, shape (n, free).
        seed: of everything random in here.
    """

    def __init__(self, space: DesignSpace, operators: Operators, first_vectors: Array, seed: int) -> None:
        place = space.blade_count_position
        lower, upper = space.relaxed_lower, space.relaxed_upper
        duplicates = DecodedDuplicates(place, lower, upper)
        self._algorithm = NSGA2(
            pop_size=operators.population,
            sampling=np.array(first_vectors, dtype=np.float64),
            crossover=SBX(prob=operators.crossover_probability, eta=operators.crossover_eta),
            mutation=MixedMutation(operators.mutation_probability, operators.mutation_eta, place),
            eliminate_duplicates=duplicates,
            output=None,
        )
        problem = Problem(n_var=len(space.free), n_obj=2, n_ieq_constr=1, xl=lower, xu=upper)
        self._algorithm.setup(problem, seed=seed, termination=NoTermination())
        self._asked: Population | None = None

    def ask(self) -> Array | None:
        """The vectors to evaluate next, shape (m, free), m <= population; None when no new design can be made."""
        if self._asked is None:
            self._asked = self._algorithm.ask()
        if self._asked is None or len(self._asked) == 0:
            return None
        vectors: Array = self._asked.get("X").astype(np.float64)
        return vectors

    def tell(self, tags: list[int], objectives: Array, constraint: Array) -> None:
        """Answer the last ``ask``.

        Args:
            tags: a number for each vector, in the order asked, found again in ``population``.
            objectives: shape (m, 2), finite.
            constraint: shape (m, 1), finite; above 0 is infeasible.

        Raises:
            ValueError: nothing was asked, the sizes differ, or a number is not finite.
        """
        asked = self._asked
        if asked is None or len(asked) != len(tags):
            raise ValueError("tell must answer the last ask, design for design")
        if not (np.all(np.isfinite(objectives)) and np.all(np.isfinite(constraint))):
            # A NaN here would silently become the only optimum for the rest of the run.
            raise ValueError("the algorithm may only be told finite numbers")
        asked.set("F", objectives)
        asked.set("G", constraint)
        asked.set("H", np.zeros((len(tags), 0)))
        for individual, tag in zip(asked, tags, strict=True):
            individual.evaluated.update(("F", "G", "H"))
            individual.set("tag", tag)
        self._algorithm.tell(infills=asked)
        self._asked = None

    @property
    def population(self) -> tuple[int, ...]:
        """Tags of the surviving population, best first: by violation, then rank, then crowding."""
        members = self._algorithm.pop
        violation = members.get("CV").astype(np.float64)[:, 0]
        infeasible = violation > 0.0
        # Infeasible members are ordered by violation alone: pymoo gives them no rank of their own.
        ranks = np.where(infeasible, 0.0, np.array([_number(member, "rank") for member in members]))
        crowding = np.where(infeasible, 0.0, np.array([_number(member, "crowding") for member in members]))
        order = np.lexsort((-crowding, ranks, violation))
        return tuple(int(members[int(index)].get("tag")) for index in order)


def _number(individual: Any, name: str) -> float:
    value = individual.get(name)
    return 0.0 if value is None else float(value)
