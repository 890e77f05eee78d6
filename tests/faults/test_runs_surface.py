"""Runs with a learnt surface: what is predicted, what is solved, and the same bits however often they are killed.

The surface is a stand-in whose error depends on every design that it was learnt from: learnt from others, or at another
moment, it would give other bits.
"""

from __future__ import annotations

import random
import sqlite3
import time
from pathlib import Path

from quick_physics import learning, learning_physics, lot, surface_case
from run_files import content, count_finished, small_case, wait_until
from test_runs_resume import begin, kill

from hpsop_core.case.case import Case
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.reader import RunReader

PLAN = (2, 10, 18, 4)  # workers, population, generations, level-1 generations


def case_of(generations: int = PLAN[2]) -> Case:
    return surface_case(small_case(population=PLAN[1], generations=generations, level1_generations=PLAN[3]))


def whole_run(path: Path, workers: int = 1, generations: int = PLAN[2]) -> RunReader:
    return optimize(case_of(), path, generations=generations, workers=workers, physics=learning_physics(learning))


def surfaces(path: Path) -> dict[int, tuple[str, int, int]]:
    """id -> (variables, surface, generation) of level 2."""
    connection = sqlite3.connect(path)
    rows = connection.execute("SELECT id, variables, surface, generation FROM evaluations WHERE level = 2").fetchall()
    connection.close()
    return {number: (variables, surface, generation) for number, variables, surface, generation in rows}


def test_first_and_last_generation_are_solved(tmp_path: Path) -> None:
    run = whole_run(tmp_path / "run.hpsop")
    rows, generations = surfaces(run.path), run.generations()
    first, last = generations[PLAN[3]], generations[-1]
    assert len(first.asked) == PLAN[1] + 6, "the sample to learn from stands beside the population"
    assert all(rows[number][1] == 0 for number in (*first.asked, *last.asked))
    assert last.front and not any(record.evaluation.predicted for record in run.front())
    level2 = run.summary()["evaluations"]["2"]
    assert level2["predicted"] == sum(surface > 0 for _, surface, _ in rows.values()) > level2["count"] / 2


def test_no_answer_is_older_than_its_surface(tmp_path: Path) -> None:
    """Also members that survived were asked again when the surface was learnt anew; what was solved stays solved."""
    run = whole_run(tmp_path / "run.hpsop")
    rows = surfaces(run.path)
    solved_in = {variables: generation for variables, surface, generation in rows.values() if surface == 0}
    newest, renewed = 0, 0
    for generation in run.generations()[PLAN[3] :]:
        used = {rows[number][1] for number in generation.members} - {0}
        assert len(used) <= 1, "answers of two surfaces stand side by side"
        if used:
            assert used.pop() >= newest
        newest_now = max([newest, *(rows[number][1] for number in generation.asked)])
        renewed += newest_now > newest
        newest = newest_now
        for number in generation.asked:
            variables, surface, _ = rows[number]
            assert surface == 0 or solved_in.get(variables, 10**9) >= generation.number
    assert renewed >= 3


def test_what_the_surface_doubts_is_solved(tmp_path: Path) -> None:
    run = whole_run(tmp_path / "run.hpsop")
    records = run.designs([number for number, (_, surface, _) in surfaces(run.path).items() if surface > 0])
    assert records and all(record.evaluation.predicted for record in records)
    assert all(lot(record.evaluation.variables, 2) >= 0.2 for record in records)


def test_the_error_found_stands_in_the_summary(tmp_path: Path) -> None:
    run = whole_run(tmp_path / "run.hpsop")
    found = run.summary()["surface"]
    assert found["solved_after_prediction"] > 0
    rows = surfaces(run.path)
    designs = {record.id: record.evaluation for record in run.designs(list(rows))}
    last: dict[str, int] = {}
    worst = 0.0
    for number in sorted(rows):
        variables, surface, _ = rows[number]
        if surface:
            last[variables] = number
        elif variables in last:
            one, two = designs[last[variables]].objectives["f1"], designs[number].objectives["f1"]
            worst = max(worst, abs(one / two - 1.0))
    assert found["greatest_difference"]["f1"] == worst > 0.0
    assert set(found["surfaces"]) == {str(n) for n in range(1, 1 + max(row[1] for row in rows.values()))}


def test_any_number_of_workers_gives_the_same_bits(tmp_path: Path) -> None:
    assert content(whole_run(tmp_path / "one.hpsop", 1).path) == content(whole_run(tmp_path / "two.hpsop", 2).path)


def test_killed_runs_end_like_an_unbroken_one(tmp_path: Path) -> None:
    whole, killed = whole_run(tmp_path / "whole.hpsop").path, tmp_path / "killed.hpsop"
    total, dice, hits = count_finished(whole), random.Random(5), 0
    for done, share in enumerate((0.4, 0.55, 0.7, 0.85)):
        process = begin(killed, "slow_learning", (1 + done % 2, *PLAN[1:]))
        target = int(share * total)
        wait_until(
            lambda target=target, process=process: count_finished(killed) >= target or process.poll() is not None, 120.0
        )
        time.sleep(0.1 * dice.random())
        hits += process.poll() is None
        kill(process)
    assert hits >= 2, "the runs were too quick for the kills"
    optimize(case_of(), killed, workers=2, physics=learning_physics(learning))
    assert content(killed) == content(whole)


def test_a_finished_run_that_goes_on_keeps_what_it_had_and_ends_solved(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    before = content(whole_run(path).path)
    longer = whole_run(path, generations=PLAN[2] + 4)
    after = content(path)
    assert after["generations"][: PLAN[2]] == before["generations"]
    assert after["evaluations"][: len(before["evaluations"])] == before["evaluations"]
    assert not any(record.evaluation.predicted for record in (*longer.front(PLAN[2]), *longer.front()))
    # And once more: the generation that was the last one then is asked as it was.
    again = whole_run(path, generations=PLAN[2] + 5)
    assert content(path)["generations"][: PLAN[2] + 4] == after["generations"]
    assert not any(record.evaluation.predicted for record in again.front())


def test_without_it_nothing_is_predicted(tmp_path: Path) -> None:
    run = optimize(small_case(), tmp_path / "run.hpsop", workers=1, physics=learning_physics(learning))
    assert {surface for _, surface, _ in surfaces(run.path).values()} == {0}
    assert "surface" not in run.summary()
