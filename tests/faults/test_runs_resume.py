"""Runs that are killed at any moment, started again, and end as if nothing had happened."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from quick_physics import counting, evaluate, marking, physics
from run_files import content, count_finished, descendants, finished_designs, forge, is_alive, small_case, wait_until

from hpsop_core.errors import InputError
from hpsop_core.runs.controller import optimize
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.reader import open_run

HERE = Path(__file__).resolve().parent


def begin(path: Path, name: str, plan: tuple[int, int, int, int], marks: Path | None = None) -> subprocess.Popen[bytes]:
    """A run in a process of its own; plan: workers, population, generations, level-1 generations."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parents[1])])}
    arguments = [sys.executable, str(HERE / "run_in_process.py"), str(path), name, str(marks or ""), *map(str, plan)]
    return subprocess.Popen(arguments, env=environment, stderr=subprocess.DEVNULL, start_new_session=True)


def kill(process: subprocess.Popen[bytes]) -> None:
    """SIGKILL to the run's process alone; its workers must notice by themselves."""
    family = descendants(process.pid)
    process.send_signal(signal.SIGKILL)
    process.wait()
    wait_until(lambda: not any(is_alive(child) for child in family))


def run_with_kills(
    path: Path, name: str, plan: tuple[int, int, int, int], total: int, kills: int, seed: int, marks: Path | None = None
) -> int:
    """Run to the end under random kills, with 1, 2 and 3 workers in turn; returns how many kills there were."""
    dice = random.Random(seed)
    done = 0
    while True:
        # Every start with another number of workers: that changes nothing either.
        process = begin(path, name, (1 + (plan[0] + done) % 3, *plan[1:]), marks)
        if done == kills:
            assert process.wait(timeout=300) == 0
            return done
        before = count_finished(path)
        # Within the very first moments (the file is just being made), or at any evaluation that is still to come.
        target = before if dice.random() < 0.2 else dice.randint(before, max(before, int(total * (done + 1) / kills)))
        pause = dice.random() * 0.1
        wait_until(
            lambda target=target, process=process: count_finished(path) >= target or process.poll() is not None,
            240.0,
        )
        if target == before:
            pause += dice.random() * 2.0  # somewhere in the imports, the opening of the file or the replay
        time.sleep(pause)
        if process.poll() is not None:
            assert process.returncode == 0
            return done
        known = finished_designs(path)
        calls = _calls(marks)
        kill(process)
        done += 1
        assert known <= finished_designs(path), "a finished evaluation was lost"
        assert not is_being_written(path)
        if marks is not None:
            _remember(marks, calls, known)


def _calls(marks: Path | None) -> int:
    if marks is None or not (marks / "calls").exists():
        return 0
    return len((marks / "calls").read_text().splitlines())


def _remember(marks: Path, calls: int, known: set[tuple[int, str]]) -> None:
    with open(marks / "known", "a", encoding="utf-8") as stream:
        stream.writelines(f"{calls}\t{level} {variables}\n" for level, variables in known)


def test_killed_runs_end_like_an_unbroken_one(tmp_path: Path) -> None:
    """Quick evaluations, many designs: kills fall anywhere in the run, its beginning and the hand-over included."""
    plan = (2, 10, 8, 5)
    marks = tmp_path / "marks"
    marks.mkdir()
    whole, killed = tmp_path / "whole.hpsop", tmp_path / "killed.hpsop"
    case = small_case(population=10, generations=8, level1_generations=5)
    optimize(case, whole, workers=1, physics=physics(evaluate))
    assert run_with_kills(killed, "counting", plan, 80, kills=3, seed=11, marks=marks) >= 2
    assert content(killed) == content(whole)
    assert open_run(killed).state() == ("finished", "")
    _assert_nothing_finished_was_computed_again(marks)


def _assert_nothing_finished_was_computed_again(marks: Path) -> None:
    calls = [line.replace(" ", "") for line in (marks / "calls").read_text().splitlines()]
    for line in (marks / "known").read_text().splitlines():
        count, _, design = line.partition("\t")
        assert design.replace(" ", "") not in calls[int(count) :]


@pytest.mark.parametrize("workers", [1, 3])
def test_any_number_of_workers_gives_the_same_bits(tmp_path: Path, workers: int) -> None:
    paths = [tmp_path / "two.hpsop", tmp_path / "other.hpsop"]
    for path, count in zip(paths, (2, workers), strict=True):
        optimize(small_case(), path, workers=count, physics=physics(evaluate))
    assert content(paths[0]) == content(paths[1])


def test_finished_and_extended_runs_are_started_again_with_the_same_command(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    case = small_case()
    counted = marking(counting, tmp_path)
    optimize(case, path, workers=1, physics=counted)
    calls = _calls(tmp_path)
    before = content(path)
    optimize(case, path, workers=1, physics=counted)
    assert content(path) == before and _calls(tmp_path) == calls, "a finished run is only read"
    run = optimize(case, path, generations=8, workers=1, physics=counted)
    after = content(path)
    assert [g.level for g in run.generations()] == [1] * 4 + [2] * 4
    assert after["evaluations"][: len(before["evaluations"])] == before["evaluations"]
    assert after["generations"][:6] == before["generations"]
    with pytest.raises(InputError, match="as many or more"):
        optimize(case, path, generations=5, workers=1, physics=physics(evaluate))
    with pytest.raises(InputError, match="seed = 1"):
        optimize(case, path, seed=3, workers=1, physics=physics(evaluate))
    other = case.with_bounds({"draft": (14.1, 14.5)})
    with pytest.raises(InputError, match="holds a run of the case"):
        optimize(other, path, workers=1, physics=physics(evaluate))


def test_a_file_that_does_not_replay_is_refused_with_the_versions(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    case = small_case(generations=3, level1_generations=3)
    optimize(case, path, workers=1, physics=physics(evaluate))
    forge(
        path,
        """UPDATE run SET value = replace(value, '"pymoo":"', '"pymoo":"0.1-') WHERE key = 'versions'""",
        "UPDATE generations SET data = replace(data, '\"spread\":', '\"spread\":1') WHERE number = 2",
    )
    with pytest.raises(InputError, match=r"generation 2 comes out.*made with pymoo 0\.1"):
        optimize(case, path, generations=4, workers=1, physics=physics(evaluate))
    assert open_run(path).state()[0] == "failed"


@pytest.mark.soak
def test_fifty_kills_over_real_runs_of_both_levels(tmp_path: Path) -> None:
    _real_runs(tmp_path, runs=5, kills=10)


def test_four_kills_over_a_real_run_of_both_levels(tmp_path: Path) -> None:
    _real_runs(tmp_path, runs=1, kills=4)


def _real_runs(tmp_path: Path, runs: int, kills: int) -> None:
    plan = (2, 4, 4, 2)
    case = small_case(population=4, generations=4, level1_generations=2)
    whole = tmp_path / "whole.hpsop"
    optimize(case, whole, workers=3)
    expected = content(whole)
    assert {row[1] for row in expected["evaluations"]} == {"1", "2"}
    happened = 0
    for number in range(runs):
        killed = tmp_path / f"killed{number}.hpsop"
        happened += run_with_kills(killed, "real", plan, 16, kills, seed=number)
        assert content(killed) == expected
    assert happened == runs * kills
