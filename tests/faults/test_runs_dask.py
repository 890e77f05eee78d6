"""A real Dask scheduler and two worker processes on loopback: the same bits, and a worker may die."""

from __future__ import annotations

import os
import re
import signal
import socket
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
from hpsop_core.runs.dask_workers import DaskWorkers
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


class Cluster:
    """A scheduler on a port of its own and a worker, to be killed and started again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = free_port()
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, path: str = "") -> None:
        """Both; ``path`` goes before the workers' own Python path."""
        self.scheduler()
        self.worker(path)

    def scheduler(self) -> None:
        self._begin("scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")

    def worker(self, path: str = "") -> None:
        address = f"tcp://127.0.0.1:{self.port}"
        self._begin("worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", path=path)

    def _begin(self, *words: str, path: str = "") -> None:
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([*([path] if path else []), str(HERE), str(HERE.parents[1])]),
            "OPENBLAS_NUM_THREADS": "1",
        }
        with open(self.folder / "log", "ab") as log:
            self.processes.append(
                subprocess.Popen(
                    [sys.executable, "-m", "dask", *words], stdout=log, stderr=log, env=environment, cwd=self.folder
                )
            )

    def kill(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()
        self.processes = []


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def own_cluster(tmp_path: Path) -> Iterator[Cluster]:
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.kill()


def test_workers_of_other_versions_are_refused_also_when_they_join_late(tmp_path: Path, own_cluster: Cluster) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "sitecustomize.py").write_text(
        "import importlib.metadata as m\nold = m.version\n"
        "m.version = lambda name: '0.1' if name == 'numba' else old(name)\n"
    )
    own_cluster.start()
    executor = f"dask:127.0.0.1:{own_cluster.port}"
    path = tmp_path / "run.hpsop"
    with RunController(path, small_case(), executor=executor, physics=physics(quick_physics.slower)) as run:
        run.start()
        wait_until(lambda: sum(run.snapshot().evaluations) >= 2, 90.0)
        own_cluster.worker(str(other))
        with pytest.raises(InputError, match=r"has other versions \(numba 0\.1, here .*install the same on every"):
            run.wait(60.0)
    state, reason = open_run(path).state()
    assert state == "failed" and "numba 0.1" in reason
    with pytest.raises(InputError, match=r"numba 0\.1, here"):
        optimize(small_case(), tmp_path / "new.hpsop", executor=executor, physics=physics())


def test_a_lost_scheduler_pauses_the_run_with_one_line_until_it_is_back(tmp_path: Path, own_cluster: Cluster) -> None:
    path, local = tmp_path / "run.hpsop", tmp_path / "local.hpsop"
    optimize(small_case(), local, workers=1, physics=physics())
    own_cluster.start()
    executor = f"dask:127.0.0.1:{own_cluster.port}"
    # Dask's client may have found the new scheduler by itself; its worker has no nanny, and a restart would end it.
    workers = DaskWorkers(f"127.0.0.1:{own_cluster.port}")
    workers.reach()
    assert workers.submit(abs, -1).result(60.0) == 1 and own_cluster.processes[-1].poll() is None
    workers.close()
    with RunController(path, small_case(), executor=executor, physics=physics(quick_physics.slow)) as run:
        run.start()
        wait_until(lambda: run.snapshot().generation >= 1, 90.0)
        own_cluster.kill()
        wait_until(lambda: run.snapshot().state == "paused", 60.0)
        lost = f"the Dask scheduler at 127.0.0.1:{own_cluster.port} does not answer"
        assert run.snapshot().reason == f"{lost}; the run goes on when it does, or stop it"
        own_cluster.start()
        assert run.wait(120.0)
        assert run.snapshot().state == "finished"
    assert content(path) == content(local)
    finished = open_run(path)
    assert finished.failures() == ()
    notes = [line["text"] for line in finished.summary()["journal"]]
    assert any("evaluated by 1 workers" in note and '"numba"' in note for note in notes)
    # Stop acts also while it is away.
    with RunController(path, executor=executor, physics=physics(quick_physics.slow), generations=12) as run:
        run.start()
        wait_until(lambda: run.snapshot().generation >= 7, 90.0)
        own_cluster.kill()
        wait_until(lambda: run.snapshot().state == "paused", 60.0)
        run.stop()
        assert run.wait(30.0) and run.snapshot().state == "stopped"


def test_no_scheduler_is_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no scheduler with workers answers"):
        optimize(small_case(), tmp_path / "a.hpsop", executor="dask:127.0.0.1:9", physics=physics())
    with pytest.raises(InputError, match="the Dask cluster decides"):
        optimize(small_case(), tmp_path / "b.hpsop", executor="dask:127.0.0.1:9", workers=2, physics=physics())
