"""The paper's search over two levels of fidelity, as a state machine without files, processes or clocks.

The plan of a run of N generations, n of them at level 1:

* Generation 1 is the initial sample: a Latin hypercube with the initial design's projection on the bounds in it.
* Level 1 goes on to generation n, or until its hypervolume has grown by less than a stated share over a window of
  generations. Then level 1's last population is the first one of level 2, where it is evaluated anew: that is a
  generation too. A stated share of it is replaced by a fresh Latin hypercube, and the initial design is kept in it.
* Level 2 has all the rest: N stays what was asked, also when level 1 stagnated early. With ``optimization.surface`` it
  asks a learnt surface first: see ``surface_plan``.

Everything is a function of the settings, the seed and the answers told: to resume a run is to ask and answer again.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.case.sections import OptimizationSection
from hpsop_core.case.variables import DesignSpace, DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.optimization.decision import compromise, knee
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.indicators import FrontArchive, feasible_share, hypervolume, spread
from hpsop_core.optimization.nsga2 import Nsga2, Operators
from hpsop_core.optimization.problem import Candidate, Outcome, algorithm_view
from hpsop_core.optimization.sampling import derived_seed, latin_hypercube
from hpsop_core.optimization.surface_plan import SurfacePlan, front_to_check, spread_out
from hpsop_core.typing_aliases import Array

_SAMPLE, _SEARCH = 0, 1  # purposes of derived seeds


class TwoLevelSearch:
    """Proposes the designs of one generation after another; see the module's text for the plan.

    Args:
        space: the design space.
        settings: the case's ``[optimization]``.
        initial: the initial design, inside the bounds or not.
        seeds: designs, for example an old run's front, whose projections take places in the first sample.

    Raises:
        InputError: every variable is fixed.
    """

    def __init__(
        self,
        space: DesignSpace,
        settings: OptimizationSection,
        initial: DesignVariables,
        seeds: Sequence[DesignVariables] = (),
    ) -> None:
        if not space.free:
            raise InputError("bounds: every variable is fixed; give at least one a lower bound below its upper one")
        self._space = space
        self._settings = settings
        self._initial = space.project(initial)
        self._seeds = tuple(space.project(seed) for seed in seeds)
        self._generations = settings.generations
        self._level1_generations = settings.level1_generations
        self._number = 0
        self._level = FAST if settings.level1_generations > 0 else TRUTH
        self._algorithm: Nsga2 | None = None
        self._archive = FrontArchive()
        self._outcomes: dict[int, Outcome] = {}
        self._variables: dict[int, DesignVariables] = {}
        self._archive_hypervolumes: list[float] = []
        self._asked: tuple[Candidate, ...] = ()
        self._last_members: tuple[int, ...] = ()
        self._last_front: tuple[int, ...] = ()
        self._plan = SurfacePlan(settings)
        self._level2_told = 0
        self._renewals = 0
        self._renew = False
        self._solving = False
        self._exhausted = False

    @property
    def generations(self) -> int:
        """The total asked for."""
        return self._generations

    @property
    def number(self) -> int:
        """Generations told so far."""
        return self._number

    @property
    def level(self) -> int:
        """The level of the next generation."""
        return self._level.number

    @property
    def _level2_comes(self) -> bool:
        """Whether this is level 1 with level 2 planned after it."""
        return self._level is FAST and self._level1_generations < self._generations

    @property
    def finished(self) -> bool:
        """Whether every generation is told, or no new design can be made."""
        return self._exhausted or self._number >= self._generations

    def extend(self, generations: int) -> None:
        """Ask for a greater total. A run that never leaves level 1 stays there, any other gets more of level 2.

        Raises:
            ValueError: fewer than are already planned.
        """
        if generations < self._generations:
            raise ValueError(f"{generations} generations are fewer than the {self._generations} planned")
        if self._level1_generations >= self._generations:
            self._level1_generations = generations
        self._generations = generations

    def close(self, generation: int) -> None:
        """With a surface: solve this generation of level 2 as a whole, because it is the last one that is asked for.

        To be said again, with the same numbers, when a run is asked anew that went on after such a generation.
        """
        self._plan.close(generation)

    def ask(self) -> tuple[Candidate, ...]:
        """The designs of the next generation, in order; empty when the search is finished. Repeatable until told."""
        if self._asked or self.finished:
            return self._asked
        solved = self._to_be_solved()
        named: dict[DesignVariables, str] = {}
        if self._algorithm is None:
            if self._number == 0:
                vectors, origins = self._first_population()
            else:
                vectors, origins = self._renewed() if self._renewals else self._handed_over()
            purpose = (_SEARCH, self._renewals) if self._renewals else (_SEARCH,)
            seed = derived_seed(self._settings.seed, self._level.number, *purpose)
            self._algorithm = Nsga2(self._space, self._operators, vectors, seed)
            named = {self._space.decode(vector): origin for vector, origin in zip(vectors, origins, strict=True)}
        asked = self._algorithm.ask()
        if asked is None:
            return self._nothing_new()
        designs = [self._space.decode(vector) for vector in asked]
        self._asked = tuple(
            Candidate(
                self._level.number,
                design,
                named.get(design, "offspring"),
                0 if solved is None or design in solved else self._plan.surface,
            )
            for design in designs
        )
        return self._asked

    def _to_be_solved(self) -> frozenset[DesignVariables] | None:
        """Designs of the next generation that are solved, where others are a surface's; None: all of them.

        Where the population is asked again it begins a new search.
        """
        plan = self._plan
        self._solving = True
        if self._level is not TRUTH or not self._settings.surface or self._level2_told == 0:
            return None
        closes = plan.closes(self._number + 1)
        doubted = not closes and plan.doubted
        checks = not closes and not doubted and plan.checks
        if closes or checks or doubted or self._renew:
            self._algorithm = None
            self._renewals += 1
        self._renew = self._solving = closes or checks
        if closes:
            return None
        if checks:
            chosen = front_to_check(self._last_front, self._outcomes, self._settings.surface_checks)
            return frozenset(self._variables[number] for number in chosen)
        if plan.learns:
            plan.next_surface()
        return frozenset()

    def _nothing_new(self) -> tuple[Candidate, ...]:
        # A space with few integer designs can be used up. Level 1 then hands over, level 2 ends.
        if self._level2_comes:
            self._begin_level2()
            return self.ask()
        if self._level is TRUTH and self._settings.surface and not self._plan.closes(self._number):
            # What is shown at the end is solved, also where the end comes early.
            self._plan.close(self._number + 1)
            return self.ask()
        self._exhausted = True
        return ()

    def tell(self, outcomes: Sequence[Outcome]) -> Generation:
        """Answer the last ``ask``, in the order asked.

        Returns:
            The generation.

        Raises:
            ValueError: nothing was asked, or the number of outcomes differs.
        """
        if not self._asked or self._algorithm is None or len(outcomes) != len(self._asked):
            raise ValueError("tell must answer the last ask, design for design")
        settings = self._settings
        doubts = sum(not outcome.predicted and outcome.evaluation_id not in self._outcomes for outcome in outcomes)
        for candidate, outcome in zip(self._asked, outcomes, strict=True):
            self._outcomes[outcome.evaluation_id] = outcome
            self._variables[outcome.evaluation_id] = candidate.variables
        # Level 2 finds a little more thrust: designs bred on level 1's limit of cavitation would be beyond level 2's.
        margin = settings.handover_margin if self._level2_comes else 0.0
        view = algorithm_view(list(outcomes), settings.constraint_handling, settings.penalty_factor, margin)
        self._algorithm.tell([outcome.evaluation_id for outcome in outcomes], *view)
        self._archive.add(outcomes)
        self._archive_hypervolumes.append(hypervolume(self._archive.objectives))
        self._number += 1
        self._asked = ()
        if self._level is TRUTH:
            self._level2_told += 1
            if self._solving:
                self._plan.solved()
            else:
                self._plan.told(doubts)
        members = self._algorithm.population
        self._last_members = members
        survivors = [self._outcomes[member] for member in members]
        front = FrontArchive()
        front.add(survivors)
        self._last_front = front.ids
        chosen, bend = compromise(front.objectives), knee(front.objectives)
        generation = Generation(
            number=self._number,
            level=self._level.number,
            asked=tuple(outcome.evaluation_id for outcome in outcomes),
            members=members,
            front=front.ids,
            hypervolume=hypervolume(front.objectives),
            spread=spread(front.objectives),
            feasible_share=feasible_share(survivors),
            failures=sum(outcome.failed for outcome in outcomes),
            compromise=None if chosen is None else front.ids[chosen],
            knee=None if bend is None else front.ids[bend],
            note=self._end_of_level(),
        )
        if generation.note and self._number < self._generations:
            self._begin_level2()
        return generation

    def _end_of_level(self) -> str:
        if self._level is TRUTH:
            return ""
        if self._number >= self._level1_generations:
            return "" if self._number >= self._generations else "level 1 has had its generations"
        window, tolerance = self._settings.stagnation_window, self._settings.stagnation_tolerance
        if tolerance <= 0.0 or len(self._archive_hypervolumes) <= window:
            return ""
        # Of everything seen, not of the front: that one never falls, so a gain is a gain.
        before, now = self._archive_hypervolumes[-1 - window], self._archive_hypervolumes[-1]
        # A front that does not exist yet, or lies beyond the reference point, is no front that stagnates.
        if before > 0.0 and now - before < tolerance * before and self._level1_generations < self._generations:
            return f"level 1's hypervolume grew by less than {tolerance:g} of itself in {window} generations"
        return ""

    def _begin_level2(self) -> None:
        self._level = TRUTH
        self._algorithm = None
        self._archive = FrontArchive()
        self._archive_hypervolumes = []

    @property
    def _operators(self) -> Operators:
        settings = self._settings
        return Operators(
            population=settings.population,
            crossover_probability=settings.crossover_probability,
            crossover_eta=settings.crossover_eta,
            mutation_probability=settings.mutation_probability,
            mutation_eta=settings.mutation_eta,
        )

    def _first_population(self) -> tuple[Array, list[str]]:
        population = self._settings.population
        placed: dict[DesignVariables, str] = {}
        if self._settings.keep_initial:
            placed[self._initial] = "sample"
        for seed in self._seeds:
            if len(placed) < population:
                placed.setdefault(seed, "seed")
        # Without level 1 nobody knows what is feasible: the surface's sample is more of the same.
        more = self._settings.surface_sample if self._level is TRUTH and self._settings.surface else 0
        return self._filled(placed, population + more, "sample")

    def _handed_over(self) -> tuple[Array, list[str]]:
        population = self._settings.population
        fresh = int(np.floor(self._settings.reseed_share * population + 0.5))
        kept = [self._variables[member] for member in self._last_members][: population - fresh]
        # Without re-seeding the last generation of level 1 goes over as it is: the paper's hand-over.
        if self._settings.keep_initial and fresh > 0 and self._initial not in kept:
            kept = [*kept[: max(0, population - fresh - 1)], self._initial]
        vectors, origins = self._filled(dict.fromkeys(kept[:population], "handover"), population, "reseed")
        if self._settings.surface:
            sample = self._feasible_sample(vectors)
            vectors, origins = np.vstack((vectors, sample)), [*origins, *(["sample"] * len(sample))]
        return vectors, origins

    def _feasible_sample(self, placed: Array) -> Array:
        """Designs that level 1 found feasible, far from each other and from those placed, to learn from."""
        feasible = [self._variables[number] for number, outcome in self._outcomes.items() if outcome.feasible]
        vectors = np.array([self._space.encode(design) for design in feasible]).reshape(-1, len(self._space.free))
        extent = self._space.relaxed_upper - self._space.relaxed_lower
        return np.asarray(vectors[spread_out(vectors / extent, placed / extent, self._settings.surface_sample)])

    def _renewed(self) -> tuple[Array, list[str]]:
        """The population as it is, to be asked again."""
        designs = [self._variables[member] for member in self._last_members]
        return np.array([self._space.encode(design) for design in designs]), ["renewal"] * len(designs)

    def _filled(self, placed: dict[DesignVariables, str], population: int, origin: str) -> tuple[Array, list[str]]:
        # Only a re-seeded hand-over or a first sample has room; level 1 may also have ended on a small population.
        missing = population - len(placed)
        sample = latin_hypercube(self._space, missing, derived_seed(self._settings.seed, self._level.number, _SAMPLE))
        given = [self._space.encode(design) for design in placed]
        vectors = np.array(given).reshape(len(placed), len(self._space.free))
        return np.vstack((vectors, sample)), [*placed.values(), *([origin] * missing)]
