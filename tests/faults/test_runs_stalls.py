"""What is stopped, cold or killed from outside is no failure of a design: the run ends as if nothing had happened."""

from __future__ import annotations

import multiprocessing.forkserver
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
import quick_physics
from quick_physics import marking, physics
from run_files import content, descendants, small_case, wait_until

from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.tasks import Physics

HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("whole") / "whole.hpsop"
    optimize(small_case(evaluation_time_limit=1.0), path, workers=1, physics=physics())
    return path


def test_a_program_that_was_stopped_blames_no_design(tmp_path: Path, whole: Path) -> None:
    """Ctrl-Z for longer than an evaluation may take; the workers that were under way finish, none is replaced."""
    path, script = tmp_path / "run.hpsop", tmp_path / "script.py"
    script.write_text(f"""
import sys
sys.path[:0] = [{str(HERE)!r}, {str(HERE.parents[1])!r}]
from quick_physics import physics, slower
from run_files import small_case
from hpsop_core.runs.controller import optimize
if __name__ == "__main__":
    optimize(small_case(evaluation_time_limit=1.0), {str(path)!r}, workers=2, physics=physics(slower))
""")
    process = subprocess.Popen([sys.executable, str(script)], start_new_session=True)
    try:
        wait_until(lambda: path.exists() and _progress(path) >= 4)
        family = descendants(process.pid)
        os.killpg(process.pid, signal.SIGSTOP)
        time.sleep(3.0)
        os.killpg(process.pid, signal.SIGCONT)
        before = _progress(path)
        wait_until(lambda: _progress(path) >= before + 4)
        assert descendants(process.pid) == family, "a worker was replaced"
        assert process.wait(timeout=120) == 0
    finally:
        process.kill()
        process.wait()
    assert open_run(path).failures() == ()
    assert content(path) == content(whole)


def _progress(path: Path) -> int:
    try:
        return open_run(path).progress()[1]
    except InputError:
        return 0


def test_a_design_that_was_slow_once_is_tried_again(tmp_path: Path, whole: Path) -> None:
    marks, path = tmp_path / "marks", tmp_path / "run.hpsop"
    marks.mkdir()
    case = small_case(evaluation_time_limit=1.0)
    run = optimize(case, path, workers=2, physics=marking(quick_physics.hanging_once, marks))
    assert list(marks.iterdir()), "the fault must have happened"
    assert run.failures() == ()
    assert content(path) == content(whole)


def test_workers_are_warmed_before_their_clock_runs(tmp_path: Path, whole: Path) -> None:
    """A first evaluation that takes twice the limit, at the start and after each worker that died."""
    marks, path = tmp_path / "marks", tmp_path / "run.hpsop"
    marks.mkdir()
    cold = Physics(
        partial(quick_physics.cold_and_dying_once, marks=marks),
        quick_physics.no_reference,
        quick_physics.no_reference_from_dict,
        quick_physics.warm_up,
    )
    run = optimize(small_case(evaluation_time_limit=1.0), path, workers=2, physics=cold)
    assert list(marks.iterdir()), "a worker must have died"
    assert run.failures() == ()
    assert content(path) == content(whole)


def test_a_killed_fork_server_is_started_again(tmp_path: Path, whole: Path) -> None:
    path = tmp_path / "run.hpsop"
    case = small_case(evaluation_time_limit=1.0)
    with RunController(path, case, workers=2, physics=physics(quick_physics.slow)) as controller:
        controller.start()
        wait_until(lambda: controller.snapshot().generation >= 1)
        # Python's own record of it; its workers die with it.
        os.kill(multiprocessing.forkserver._forkserver._forkserver_pid, signal.SIGKILL)
        assert controller.wait(60.0)
    # And once more while nothing runs.
    os.kill(multiprocessing.forkserver._forkserver._forkserver_pid, signal.SIGKILL)
    again = tmp_path / "again.hpsop"
    optimize(case, again, workers=2, physics=physics())
    assert content(path) == content(again) == content(whole)
    assert open_run(path).failures() == ()


def test_a_worker_that_is_killed_under_the_reference_is_replaced(tmp_path: Path, whole: Path) -> None:
    marks, path = tmp_path / "marks", tmp_path / "run.hpsop"
    marks.mkdir()

    def killing(times: int) -> Physics:
        reference = partial(quick_physics.killed_reference, marks=marks, times=times)
        return Physics(quick_physics.evaluate, reference, quick_physics.no_reference_from_dict)

    case = small_case(evaluation_time_limit=1.0)
    optimize(case, path, workers=2, physics=killing(1))
    assert content(path) == content(whole)
    for mark in marks.iterdir():
        mark.unlink()
    with pytest.raises(InputError, match=r"cannot be computed at level 1: 3 worker processes died.*memory"):
        optimize(case, tmp_path / "never.hpsop", workers=2, physics=killing(100))
    # What ended it may have been the machine: the same file goes on.
    optimize(case, tmp_path / "never.hpsop", workers=2, physics=physics())
    assert content(tmp_path / "never.hpsop") == content(whole)
