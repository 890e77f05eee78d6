"""A real Dask scheduler and two worker processes on loopback: the same bits, and a worker may die."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import quick_physics
from quick_physics import physics
from run_files import content, small_case, wait_until

from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.reader import open_run

pytest.importorskip("distributed")
HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    folder = tmp_path_factory.mktemp("dask")
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parents[1])]),
        "OPENBLAS_NUM_THREADS": "1",
    }
    log = open(folder / "scheduler.log", "w+", encoding="utf-8")  # noqa: SIM115 - closed below
    dask = [sys.executable, "-m", "dask"]
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"],
        stdout=log, stderr=log, text=True, env=environment, cwd=folder,
    )  # fmt: skip
    workers: list[subprocess.Popen[str]] = []
    try:
        address = ""

        def found() -> bool:
            nonlocal address
            match = re.search(r"Scheduler at:\s+tcp://(\S+)", (folder / "scheduler.log").read_text())
            address = match.group(1) if match else ""
            return bool(match)

        wait_until(found, 60.0)
        for number in (1, 2):
            workers.append(
                subprocess.Popen(
                    [*dask, "worker", f"tcp://{address}", "--nthreads", "1", "--no-nanny", "--no-dashboard",
                     "--name", f"worker{number}", "--local-directory", str(folder)],
                    stdout=log, stderr=log, text=True, env=environment, cwd=folder,
                )
            )  # fmt: skip
        yield address, workers
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()
        log.close()


def test_dask_gives_the_bits_of_local_processes_and_survives_the_death_of_a_worker(
    tmp_path: Path, cluster: tuple[str, list[subprocess.Popen[str]]]
) -> None:
    address, workers = cluster
    local, remote, wounded = (tmp_path / f"{name}.hpsop" for name in ("local", "remote", "wounded"))
    optimize(small_case(), local, workers=2, physics=physics())
    messages: list[str] = []
    optimize(
        small_case(),
        remote,
        executor=f"dask:{address}",
        physics=physics(),
        progress=lambda event: messages.append(event.snapshot.workers),
    )
    assert content(remote) == content(local)
    assert f"Dask at {address}, 2 threads" in messages or f"Dask at {address}, 1 threads" in messages
    with RunController(wounded, small_case(), executor=f"dask:{address}", physics=physics(quick_physics.slow)) as run:
        run.start()
        wait_until(lambda: run.snapshot().generation >= 2)
        workers[0].send_signal(signal.SIGKILL)
        workers[0].wait()
        assert run.wait(120.0)
    assert content(wounded) == content(local)
    assert open_run(wounded).failures() == ()


def test_no_scheduler_is_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no scheduler with workers answers"):
        optimize(small_case(), tmp_path / "a.hpsop", executor="dask:127.0.0.1:9", physics=physics())
    with pytest.raises(InputError, match="the Dask cluster decides"):
        optimize(small_case(), tmp_path / "b.hpsop", executor="dask:127.0.0.1:9", workers=2, physics=physics())
