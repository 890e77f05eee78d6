"""From level 1 to level 2 with the real hydrodynamics: the hand-over brings feasible designs, the end a whole front."""

from __future__ import annotations

from pathlib import Path

import pytest

from hpsop_core.case.case import load_case
from hpsop_core.optimization.indicators import FrontArchive, hypervolume
from hpsop_core.optimization.problem import Outcome
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.reader import RunReader
from tests.two_speeds import TWO_SPEEDS

SEEDS = (1, 2, 3)


def run_of(folder: Path, seed: int, population: int, generations: int, level1: int) -> RunReader:
    return optimize(
        load_case(TWO_SPEEDS),
        folder / f"{seed}.hpsop",
        population=population,
        generations=generations,
        level1_generations=level1,
        seed=seed,
        workers=2,
    )


def assert_level_2_begins_feasible(run: RunReader, level1: int) -> None:
    first = run.generations()[level1]
    assert first.level == 2
    # Bred under the same constraints with level 1 calibrated to level 2, most designs should stay feasible; a fifth of
    # the population is fresh and mostly is not. Without g3 at level 1 the share was 0 in 18 hand-overs of 18.
    assert first.feasible_share >= 0.4
    assert not run.failures()
    # 1 but for the rounding of a sum of weighted ratios that are 1.
    assert run.initial(2).evaluation.objectives["f1"] == pytest.approx(1.0, abs=1e-12)
    # The initial design is feasible and was kept: the compromise is at least not worse than it in both objectives.
    chosen = run.design("compromise").evaluation.objectives
    assert min(chosen["f1"], chosen["f2"]) <= 1.0


@pytest.mark.parametrize("seed", SEEDS)
def test_level_2_begins_with_feasible_designs(tmp_path: Path, seed: int) -> None:
    assert_level_2_begins_feasible(run_of(tmp_path, seed, population=10, generations=13, level1=12), level1=12)


@pytest.mark.soak
def test_level_2_ends_on_a_whole_front_for_every_seed(tmp_path: Path) -> None:
    runs = [run_of(tmp_path, seed, population=30, generations=45, level1=30) for seed in SEEDS]
    union = FrontArchive()
    for run in runs:
        assert_level_2_begins_feasible(run, level1=30)
        # Bred with the hand-over margin what is handed over, four fifths, stays feasible but for a design or two.
        assert run.generations()[30].feasible_share >= 0.75
        for record in run.front():
            f = record.evaluation.objectives
            union.add([Outcome(record.id, (f["f1"], f["f2"]), (), True)])
    best = hypervolume(union.objectives)
    ends = [min(point[axis] for point in union.objectives) for axis in (0, 1)]
    for run in runs:
        assert run.generations()[-1].feasible_share >= 0.8
        # A truncated front misses one end and the area beyond it: half or more. Runs that only differ in luck and in a
        # fifth of the full budget should reach 85 % of what all three found together, and both ends within .02. How
        # many designs stand on a front says nothing of that: one that has just been found, with another blade count
        # for example, may beat all the others, and it is alone until the next generation.
        assert run.generations()[-1].hypervolume >= 0.85 * best
        for axis, name in enumerate(("f1", "f2")):
            assert min(record.evaluation.objectives[name] for record in run.front()) <= ends[axis] + 0.02
