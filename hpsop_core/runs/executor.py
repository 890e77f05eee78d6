"""Where evaluations run: processes of this machine, through a ``concurrent.futures.Executor``."""

from __future__ import annotations

import concurrent.futures
import contextlib
import importlib.util
import multiprocessing
import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import signal
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

from hpsop_core.errors import InputError
from hpsop_core.runs.control import RunControl
from hpsop_core.runs.tasks import presence_task, start_worker
from hpsop_core.runs.workers import Workers, WorkersUnavailableError
from hpsop_core.scratch import lasting_scratch_folder

_START_LIMIT = 120.0  # seconds for all workers of a pool to import what they need
_STARTS_TRIED = 3
_WARM_LIMIT = 600.0  # seconds for all workers to compile what they need, and evaluate the initial design
_LONGEST_FOLDER = 72  # letters: multiprocessing adds up to 32 for its own folder and socket
_TICK = 0.1  # seconds between looks at the controls
_MOST_WORKERS_PER_CORE = 16  # each holds some 200 MB; more than one a core gains nothing
_THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def default_workers() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class LocalWorkers:
    """Processes of this machine.

    They come from a fork server: a small process without threads that has the solvers imported already, so a new worker
    is there in milliseconds and never inherits half a lock from the page's threads.

    Args:
        count: of processes.
        control: of the run; a stop is obeyed while they start.

    Raises:
        WorkersUnavailableError: the processes cannot start, or the run was stopped meanwhile.
    """

    def __init__(self, count: int, control: RunControl | None = None) -> None:
        self._count = count
        self._control = RunControl() if control is None else control
        self._pool: ProcessPoolExecutor | None = None
        self._processes: set[int] = set()
        self._warm: set[int] = set()
        self._started = False
        self._start()
        self._started = True

    @property
    def slots(self) -> int:
        """The number of processes."""
        return self._count

    def look(self) -> None:
        """Nothing: the death of a process is told by the calls under way."""

    @property
    def description(self) -> str:
        """For people."""
        return f"{self._count} local process" + ("es" if self._count > 1 else "")

    @property
    def blamable(self) -> bool:
        """A process that died was computing one of the designs under way."""
        return True

    @property
    def versions(self) -> dict[str, dict[str, str]]:
        """None but this program's."""
        return {}

    @staticmethod
    def prepare() -> str:
        """Start the fork server, which then imports the solvers while its caller does other things.

        Returns:
            The start method of the workers.
        """
        if "forkserver" not in multiprocessing.get_all_start_methods():
            return "spawn"
        multiprocessing.forkserver.set_forkserver_preload(["hpsop_core.runs.preload"])
        # First, because its start unblocks the very signals that we block for the fork server's.
        multiprocessing.resource_tracker.ensure_running()
        # A process inherits the mask: Ctrl-C in a terminal, or a service manager's SIGTERM to all, shall not tear the
        # fork server away from under the run that is just being stopped in good order.
        ends = _signals_blocked("SIGINT", "SIGTERM", "SIGHUP")
        with _one_thread_environment(), ends, _temporary_files_in(_own_folder()):
            multiprocessing.forkserver.ensure_running()
        return "forkserver"

    def _start(self) -> None:
        # Workers that were there before may fail to come back because somebody killed the fork server: it is started
        # again. The first time it is the script that is to blame, and trying again would only try it again.
        for attempt in range(_STARTS_TRIED if self._started else 1):
            if attempt:
                time.sleep(0.5 * attempt)
            try:
                self._start_pool()
                return
            except (concurrent.futures.BrokenExecutor, concurrent.futures.TimeoutError, EOFError, OSError) as error:
                self.close()
                reason = error
            if self._control.stopped:
                raise WorkersUnavailableError("the run was stopped while its workers started")
        if self._started:
            raise WorkersUnavailableError(
                f"worker processes cannot be started again ({type(reason).__name__}): is there memory, and room for "
                "processes? What is finished is kept; go on later"
            ) from reason
        raise WorkersUnavailableError(
            "worker processes do not start; a script that calls optimize() must do so below "
            "'if __name__ == \"__main__\":'"
        ) from reason

    def _start_pool(self) -> None:
        context = multiprocessing.get_context(self.prepare())
        self._warm = set()
        self._pool = ProcessPoolExecutor(self._count, context, initializer=start_worker)
        # The pool's threads, which begin here, write to workers that we kill. Python ignores the signal of a broken
        # pipe, but a library in the same process may have taken that back (gmsh does), and it would end the process.
        with _one_thread_environment(), _signals_blocked("SIGPIPE"):
            probes = [self._pool.submit(presence_task, 0.02) for _ in range(self._count)]
        # What a worker imports takes seconds, on a starved machine a minute: who stops the run does not wait for it.
        give_up = time.monotonic() + _START_LIMIT
        while concurrent.futures.wait(probes, timeout=_TICK).not_done:
            if self._control.stopped or time.monotonic() > give_up:
                raise concurrent.futures.TimeoutError
        self._processes = {probe.result() for probe in probes}

    def warm(self, level: int, control: RunControl, task: Callable[..., None], *arguments: Any) -> None:
        """Call once in each process; a process that dies of it is replaced."""
        if level in self._warm:
            return
        # Nothing may be under way: the calls would wait behind it.
        for _ in range(_STARTS_TRIED):
            try:
                calls = [self.submit(task, *arguments) for _ in range(self._count)]
                give_up = time.monotonic() + _WARM_LIMIT
                while concurrent.futures.wait(calls, timeout=_TICK).not_done and not control.stopped:
                    if time.monotonic() > give_up:
                        self.rebuild()
                        break
                for call in calls:
                    if call.done() and not call.cancelled():
                        call.result()
                break
            except concurrent.futures.BrokenExecutor:
                self.rebuild()
        self._warm.add(level)

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call in a worker."""
        if self._pool is None:
            raise concurrent.futures.BrokenExecutor("the workers are closed")
        return self._pool.submit(function, *arguments)

    def rebuild(self) -> None:
        """Kill every worker, whatever it does, and start new ones."""
        self._kill()
        self._start()

    def reach(self) -> None:
        """As ``rebuild``: a pool that lost a process is of no more use."""
        self.rebuild()

    def _kill(self) -> None:
        pool, self._pool = self._pool, None
        if pool is None:
            return
        # The pool knows all its processes, also one that joined late; its own record is private, the warm-up's is not.
        alive = set(getattr(pool, "_processes", None) or ()) | self._processes
        children = {child.pid for child in multiprocessing.active_children()}
        for process in alive & children:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        # Killed in the middle of a message, a worker leaves the pool's thread reading for the rest of it, as long as
        # anybody could still write that: we could, and never do.
        results = getattr(pool, "_result_queue", None)
        if results is not None:
            results._writer.close()
        pool.shutdown(wait=True, cancel_futures=True)
        self._processes = set()

    def close(self) -> None:
        """Kill every worker; doing so twice does nothing."""
        self._kill()


def checked_executor(executor: str, count: int | None) -> str:
    """The address of "dask:HOST:PORT", or "" for "local".

    Raises:
        InputError: no such executor, or a number of workers that it cannot have.
    """
    kind, _, address = executor.partition(":")
    most = _MOST_WORKERS_PER_CORE * default_workers()
    if count is not None and not 1 <= count <= most:
        raise InputError(f"--workers {count}: give 1 to {most} on this machine, best one a core ({default_workers()})")
    if executor == "local":
        return ""
    if kind != "dask" or not address:
        raise InputError(f"--executor {executor}: write local or dask:HOST:PORT")
    port = address.rpartition(":")[2]
    if not (port.isascii() and port.isdigit() and 0 < int(port) < 2**16 and address.partition(":")[0]):
        raise InputError(f"--executor {executor}: write dask:HOST:PORT, for example dask:10.0.0.1:8786")
    if count is not None:
        raise InputError("--workers: the Dask cluster decides how many; leave it away with --executor dask")
    if importlib.util.find_spec("distributed") is None:
        raise InputError("--executor dask: Dask is not installed; pip install 'hpsop[dask]'")
    return address


def make_workers(executor: str, count: int | None, control: RunControl) -> Workers:
    """Workers as ``--executor`` and ``--workers`` name them.

    Args:
        executor: "local" or "dask:HOST:PORT".
        count: local processes; all cores by default.
        control: of the run that wants them.

    Raises:
        InputError: as ``checked_executor``.
        WorkersUnavailableError: they cannot be had.
    """
    address = checked_executor(executor, count)
    if address:
        from hpsop_core.runs.dask_workers import DaskWorkers  # an optional dependency

        return DaskWorkers(address)
    return LocalWorkers(default_workers() if count is None else count, control)


@contextlib.contextmanager
def _one_thread_environment() -> Iterator[None]:
    before = {name: os.environ.get(name) for name in _THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(_THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@cache
def _own_folder() -> Path:
    """Where the fork server's socket stands: multiprocessing's own folder stays for ever where the run was killed."""
    return lasting_scratch_folder("workers")


@contextlib.contextmanager
def _temporary_files_in(folder: Path) -> Iterator[None]:
    before = tempfile.tempdir
    # a socket's path has 107 letters at most
    if len(str(folder)) < _LONGEST_FOLDER:
        tempfile.tempdir = str(folder)
    try:
        yield
    finally:
        tempfile.tempdir = before


@contextlib.contextmanager
def _signals_blocked(*names: str) -> Iterator[None]:
    # Windows has neither the mask nor all of the signals.
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.Signals[name] for name in names})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
