"""Evaluations that raise, lie, hang or take their process along; disks that are full: the run goes on."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
import quick_physics
from quick_physics import lot, marking, physics
from run_files import content, descendants, is_alive, small_case, wait_until

from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.executor import LocalWorkers
from hpsop_core.runs.reader import RunReader, open_run
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import reference_task
from hpsop_core.runs.workers import WorkersUnavailableError
from tests.patience import patience

HERE = Path(__file__).resolve().parent


def assert_whole(run: RunReader, population: int, generations: int) -> None:
    """The run is complete and no failed design is where it must not be."""
    assert run.state() == ("finished", "")
    assert len(run.generations()) == generations
    failed = {failure.id for failure in run.failures()}
    for generation in run.generations():
        assert len(generation.asked) == population
        assert failed.isdisjoint(generation.front)
        assert generation.failures == len(failed.intersection(generation.asked))


def no_worker_left(before: set[int]) -> None:
    """Of all that this process began there is at most the idle fork server and Python's resource tracker."""
    wait_until(lambda: not any(is_alive(process) for process in _grandchildren() - before))


def _grandchildren() -> set[int]:
    # Workers are the fork server's children, and so our grandchildren.
    below = descendants(os.getpid())
    return set().union(*(descendants(process) for process in below))


@pytest.mark.parametrize("workers", [1, 2])
def test_exceptions_nans_and_exits_are_recorded_and_the_run_completes(tmp_path: Path, workers: int) -> None:
    before = descendants(os.getpid())
    case = small_case(population=20, generations=8, level1_generations=5)
    run = optimize(case, tmp_path / "run.hpsop", workers=workers, physics=physics(quick_physics.every_fault))
    assert_whole(run, 20, 8)
    no_worker_left(before)
    failures = run.failures()
    assert len(failures) > 20
    for failure in failures:
        number = lot(failure.variables, failure.level)
        expected = [
            (0.05, "rankine", "the linear system is singular"),
            (0.10, "evaluation", "ZeroDivisionError: a solver's defect"),
            (0.15, "check", "objectives.f1 is nan"),
            (0.20, "check", "constraints.displacement is inf"),
            (0.25, "check", "objectives.f1 is missing"),
            (0.30, "worker", "SystemExit: 3"),
        ]
        stage, reason = next((stage, reason) for limit, stage, reason in expected if number < limit)
        assert (failure.stage, failure.reason) == (stage, reason)
    # The file holds nothing that is not a number.
    assert "NaN" not in str(content(tmp_path / "run.hpsop")) and "Infinity" not in str(content(tmp_path / "run.hpsop"))


def test_a_case_that_cannot_be_is_refused_with_its_own_remedy() -> None:
    # What a worker sends back: it is told to a person as it is.
    assert reference_task(quick_physics.refused_reference, small_case(), 1) == (False, "engine: too small; state more")
    done, told = reference_task(quick_physics.broken_reference, small_case(), 1)
    assert not done and told == (
        "the initial design cannot be computed at level 1 (ZeroDivisionError: a defect); change [initial]"
    )


def test_workers_that_die_are_replaced_and_only_the_guilty_design_fails(tmp_path: Path) -> None:
    before = descendants(os.getpid())
    contents = []
    for workers in (1, 3):
        path = tmp_path / f"{workers}.hpsop"
        run = optimize(small_case(), path, workers=workers, physics=physics(quick_physics.dying))
        assert_whole(run, 10, 6)
        failures = run.failures()
        assert failures and all(lot(failure.variables, failure.level) < 0.05 for failure in failures)
        reasons = {(failure.stage, failure.reason) for failure in failures}
        assert reasons == {("worker", "its worker process died twice")}
        contents.append(content(path))
    assert contents[0] == contents[1], "who shared a pool with whom must not matter"
    no_worker_left(before)


def test_a_worker_killed_once_by_the_system_leaves_no_trace(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    path, whole = tmp_path / "killed.hpsop", tmp_path / "whole.hpsop"
    run = optimize(small_case(), path, workers=2, physics=marking(quick_physics.dying_once, marks))
    assert_whole(run, 10, 6)
    assert list(marks.iterdir()), "the fault must have happened"
    assert run.failures() == ()
    optimize(small_case(), whole, workers=2, physics=physics())
    assert content(path) == content(whole)


def test_hanging_evaluations_end_at_the_time_limit(tmp_path: Path) -> None:
    before = descendants(os.getpid())
    case = small_case(generations=4, level1_generations=2, evaluation_time_limit=0.5)
    run = optimize(case, tmp_path / "run.hpsop", workers=2, physics=physics(quick_physics.hanging))
    assert_whole(run, 10, 4)
    failures = run.failures()
    hanging = [failure for failure in failures if lot(failure.variables, failure.level) < 0.04]
    assert hanging, "the fault must have happened"
    for failure in hanging:
        assert failure.stage == "time-out" and failure.reason == "took longer than the limit of 0.5 s, twice"
        assert 0.5 <= failure.elapsed < 5.0
    no_worker_left(before)


def test_an_initial_design_that_cannot_be_computed_ends_the_run_with_its_reason(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    with pytest.raises(InputError, match=r"initial design.*fails at level 1 \(hull: no such form\)"):
        optimize(small_case(), path, workers=1, physics=physics(quick_physics.failing_everywhere))
    state, reason = open_run(path).state()
    assert state == "failed" and "no such form" in reason


def test_workers_that_cannot_start_are_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--workers 0"):
        optimize(small_case(), tmp_path / "a.hpsop", workers=0, physics=physics())
    with pytest.raises(InputError, match="local or dask"):
        optimize(small_case(), tmp_path / "a.hpsop", executor="slurm", physics=physics())
    assert not (tmp_path / "a.hpsop").exists()
    # A script without a guard: its workers would start the run again, and again.
    script = tmp_path / "unguarded.py"
    script.write_text(
        f"import sys\nsys.path[:0] = [{str(HERE)!r}, {str(HERE.parents[1])!r}]\n"
        "from quick_physics import physics\nfrom run_files import small_case\n"
        "from hpsop_core.runs.controller import optimize\n"
        f"optimize(small_case(), {str(tmp_path / 'b.hpsop')!r}, workers=2, physics=physics())\n"
    )
    ended = subprocess.run([sys.executable, str(script)], check=False, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 1
    assert WorkersUnavailableError.__name__ in ended.stderr and "__main__" in ended.stderr.splitlines()[-1]


def test_a_full_disk_pauses_the_run_and_room_lets_it_go_on(tmp_path: Path) -> None:
    path, whole = tmp_path / "run.hpsop", tmp_path / "whole.hpsop"
    case = small_case(population=40)  # more than fits on the pages that are there from the beginning
    optimize(case, whole, workers=1, physics=physics())
    controller = RunController(path, case, workers=2, physics=physics())
    reasons: list[str] = []
    with controller:
        connection = controller._store._connection
        pages = connection.execute("PRAGMA page_count").fetchone()[0]
        connection.execute(f"PRAGMA max_page_count = {pages + 1}")
        controller.subscribe(lambda event: reasons.append(event.snapshot.reason))
        controller.start()
        wait_until(lambda: controller.snapshot().state == "paused", 30.0)
        assert "full" in controller.snapshot().reason
        stored = open_run(path).progress()[1]
        time.sleep(0.3)
        assert open_run(path).progress()[1] == stored > 0
        connection.execute("PRAGMA max_page_count = 1000000")
        wait_until(lambda: not controller.running, 30.0)
    assert any("goes on when it can be written again" in reason for reason in reasons)
    assert content(path) == content(whole)
    assert open_run(path).state() == ("finished", "")


def test_a_file_that_may_not_grow_pauses_a_run_of_another_process(tmp_path: Path) -> None:
    """The kernel itself refuses the write (a limit on file sizes), then allows it."""
    path, whole = tmp_path / "run.hpsop", tmp_path / "whole.hpsop"
    script = f"""
import signal, sys
sys.path[:0] = [{str(HERE)!r}, {str(HERE.parents[1])!r}]
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
from quick_physics import physics, slow
from run_files import small_case
from hpsop_core.runs.controller import optimize
if __name__ == "__main__":
    optimize(small_case(), {str(path)!r}, workers=1, physics=physics(slow),
             progress=lambda e: print(e.kind, e.snapshot.state, e.snapshot.reason, flush=True))
"""
    file = tmp_path / "script.py"
    file.write_text(script)
    arguments = [sys.executable, str(file)]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None
    try:
        for line in process.stdout:
            if line.startswith("generation"):
                break
        hard = resource.prlimit(process.pid, resource.RLIMIT_FSIZE)[1]
        size = (tmp_path / "run.hpsop-wal").stat().st_size
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (size, hard))
        line = next(line for line in process.stdout if line.startswith("state paused"))
        assert "run.hpsop" in line and "goes on when it can be written again" in line
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (hard, hard))
        assert process.wait(timeout=patience(60.0)) == 0
    finally:
        process.kill()
        process.wait()
    optimize(small_case(), whole, workers=1, physics=physics())
    assert content(path) == content(whole)


def test_a_worker_killed_in_the_middle_of_its_answer_holds_nobody_up(tmp_path: Path) -> None:
    """The pool's own thread waited for the rest of the answer, and closing for that thread, for ever."""
    mark = tmp_path / "mark"
    workers = LocalWorkers(1)
    answers = workers._pool._result_queue  # type: ignore[union-attr]
    workers.submit(quick_physics.half_an_answer, mark)
    wait_until(mark.exists, 60.0)
    closing = threading.Thread(target=workers.close, daemon=True)
    closing.start()
    closing.join(patience(20.0))
    held_up = closing.is_alive()
    # so that a red test ends
    answers._writer.close()
    assert not held_up


def test_workers_killed_with_work_on_its_way_end_nobody_else(tmp_path: Path) -> None:
    """A library in the same process may have taken back that Python ignores the signal of a broken pipe."""
    file = tmp_path / "script.py"
    file.write_text(
        f"""
import signal, sys, time
sys.path.insert(0, {str(HERE.parents[1])!r})
from hpsop_core.runs.executor import LocalWorkers
if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    workers = LocalWorkers(1)
    workers.submit(time.sleep, 60.0)
    workers.submit(len, bytes(10**6))  # more than a pipe holds: its writer waits for the busy worker
    time.sleep(0.5)
    workers.close()
"""
    )
    assert subprocess.run([sys.executable, str(file)], timeout=patience(60.0)).returncode == 0


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_no_process_is_left_behind_on_any_exit(tmp_path: Path, how: signal.Signals) -> None:
    path = tmp_path / "run.hpsop"
    arguments = [sys.executable, str(HERE / "run_in_process.py"), str(path), "slower", "", "2", "8", "4", "2"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parents[1])])}
    process = subprocess.Popen(arguments, env=environment, stderr=subprocess.DEVNULL, preexec_fn=_heeding)
    wait_until(lambda: path.exists() and _progress(path) >= 3)
    family = descendants(process.pid)
    assert len(family) >= 3, "fork server, resource tracker, workers"
    process.send_signal(how)
    process.wait(timeout=patience(30.0))
    wait_until(lambda: not any(is_alive(child) for child in family))
    RunStore(path).close()  # and the file is free


def _heeding() -> None:
    """Tests that run under nohup hand on that SIGHUP is ignored."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def _progress(path: Path) -> int:
    """Evaluations in a file that may not be a run yet."""
    try:
        return open_run(path).progress()[1]
    except InputError:
        return 0
