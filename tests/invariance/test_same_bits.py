"""The same input gives the same bits: in any process, with any number of cores, whatever else the process does."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.hydro.rankine import solver as rankine
from hpsop_core.one_thread import one_blas_thread
from tests.two_speeds import TWO_SPEEDS

RANKINE = """
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.hydro.rankine.solver import solve
for dimensions in ((340.0, 50.0, 14.2), (361.0, 48.0, 14.4)):
    hull = load_parent_hull().transform(*dimensions)
    result = solve(hull, (0.22, 0.27))
    print(hull.hydrostatics.wetted_surface.hex(), hull.hydrostatics.displaced_volume.hex())
    print([(c.wave_coefficient.hex(), c.wave_coefficient_pressure.hex(), c.trim.hex()) for c in result.conditions])
"""
# Every solver of both levels, through the interface of the commands; printed in full precision.
EVERYTHING = f"""
import dataclasses
from hpsop_core import load_case, evaluate
from hpsop_core.evaluation.curves import resistance_curve
case = load_case({TWO_SPEEDS!r})
for ratio in (0.97, 1.03):
    design = dataclasses.replace(case.initial.variables, displacement_ratio=ratio, blade_count=4)
    for level in (1, 2):
        evaluation = evaluate(case, design, level)
        assert evaluation.ok
        print(repr(dict(evaluation.as_dict(), elapsed=0.0)))
        print(resistance_curve(case, design, level, (0.2, 0.24)))
"""
PROGRAM = RANKINE + EVERYTHING
VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")


def test_same_bits_in_other_processes_and_with_other_thread_settings() -> None:
    answers = {}
    for threads in ("1", "3", None):
        environment = {key: value for key, value in os.environ.items() if key not in VARIABLES}
        if threads is not None:
            environment |= dict.fromkeys(VARIABLES, threads)
        run = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True, timeout=300
        )
        assert run.stdout
        answers[threads] = run.stdout
    assert len(set(answers.values())) == 1, f"thread settings {list(answers)} give different bits"


def threads_of_blas() -> set[int]:
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_limit_holds_until_the_last_thread_leaves() -> None:
    with threadpool_limits(limits=2):
        if threads_of_blas() != {2}:
            pytest.skip("this machine's BLAS cannot have two threads")
        inside, leave = threading.Event(), threading.Event()

        def hold() -> None:
            with one_blas_thread():
                inside.set()
                leave.wait(60.0)

        other = threading.Thread(target=hold)
        other.start()
        assert inside.wait(60.0)
        with one_blas_thread(), one_blas_thread():
            assert threads_of_blas() == {1}
        # The first one still computes.
        assert threads_of_blas() == {1}
        leave.set()
        other.join()
        assert threads_of_blas() == {2}


def test_limit_is_taken_away_after_an_error() -> None:
    with threadpool_limits(limits=2):
        before = threads_of_blas()
        with pytest.raises(ZeroDivisionError), one_blas_thread():
            raise ZeroDivisionError
        assert threads_of_blas() == before


def test_two_threads_at_once_give_the_bits_of_one() -> None:
    hull = load_parent_hull().transform(340.0, 50.0, 14.2)
    coarse = rankine.RankineSettings().refined(0.7)
    with threadpool_limits(limits=2):
        alone = rankine.solve(hull, (0.22, 0.27), coarse)
        answers: list[rankine.RankineResult] = []
        threads = [
            threading.Thread(target=lambda: answers.append(rankine.solve(hull, (0.22, 0.27), coarse))) for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    wanted = [(c.wave_coefficient, c.wave_coefficient_pressure) for c in alone.conditions]
    assert len(answers) == 3
    for answer in answers:
        assert np.array_equal([(c.wave_coefficient, c.wave_coefficient_pressure) for c in answer.conditions], wanted)
