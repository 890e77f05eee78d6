"""Where evaluations run: local processes or a Dask cluster, each through a ``concurrent.futures.Executor``."""

from __future__ import annotations

import concurrent.futures
import contextlib
import importlib.util
import multiprocessing
import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from typing import Any, Protocol

from hpsop_core.errors import InputError
from hpsop_core.runs.tasks import start_worker, warm_up_task

_START_LIMIT = 120.0  # seconds for all workers of a pool to import what they need
_MOST_WORKERS_PER_CORE = 16  # each holds some 200 MB; more than one a core gains nothing
_CLUSTER_INTERVAL = 2.0  # seconds between looks at how many threads a cluster has
_THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


class WorkersUnavailableError(InputError):
    """No worker can be had: processes cannot start, or the cluster that was named does not answer."""


class Workers(Protocol):
    """An executor that can be thrown away and made anew."""

    @property
    def slots(self) -> int:
        """Evaluations that really run side by side; no more are ever submitted, so each starts at once."""

    @property
    def description(self) -> str:
        """For people."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call.

        Raises:
            concurrent.futures.BrokenExecutor: a worker died while it was idle; call ``rebuild``.
        """

    def rebuild(self) -> None:
        """Kill whatever runs and start again.

        Raises:
            WorkersUnavailableError: no new workers can be had.
        """

    def close(self) -> None:
        """Leave no process behind."""


def default_workers() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class LocalWorkers:
    """Processes of this machine.

    They come from a fork server: a small process without threads that has the solvers imported already, so a new worker
    is there in milliseconds and never inherits half a lock from the page's threads.

    Args:
        count: of processes.

    Raises:
        WorkersUnavailableError: the processes cannot start.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._pool: ProcessPoolExecutor | None = None
        self._processes: set[int] = set()
        self._start()

    @property
    def slots(self) -> int:
        """The number of processes."""
        return self._count

    @property
    def description(self) -> str:
        """For people."""
        return f"{self._count} local process" + ("es" if self._count > 1 else "")

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
        with _one_thread_environment(), _signals_blocked():
            multiprocessing.forkserver.ensure_running()
        return "forkserver"

    def _start(self) -> None:
        context = multiprocessing.get_context(self.prepare())
        self._pool = ProcessPoolExecutor(self._count, context, initializer=start_worker)
        try:
            with _one_thread_environment():
                probes = [self._pool.submit(warm_up_task, 0.02) for _ in range(self._count)]
            self._processes = {probe.result(timeout=_START_LIMIT) for probe in probes}
        except (concurrent.futures.BrokenExecutor, concurrent.futures.TimeoutError, EOFError, OSError) as error:
            self.close()
            raise WorkersUnavailableError(
                "worker processes do not start; a script that calls optimize() must do so below "
                "'if __name__ == \"__main__\":'"
            ) from error

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call in a worker."""
        if self._pool is None:
            raise concurrent.futures.BrokenExecutor("the workers are closed")
        return self._pool.submit(function, *arguments)

    def rebuild(self) -> None:
        """Kill every worker, whatever it does, and start new ones."""
        self._kill()
        self._start()

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
        pool.shutdown(wait=True, cancel_futures=True)
        self._processes = set()

    def close(self) -> None:
        """Kill every worker; doing so twice does nothing."""
        self._kill()


class DaskWorkers:
    """The workers of a Dask scheduler, by ``Client.get_executor()``.

    Args:
        address: "HOST:PORT" of the scheduler.

    Raises:
        WorkersUnavailableError: the scheduler does not answer, or has no workers.
    """

    def __init__(self, address: str) -> None:
        import distributed  # an optional dependency, and slow to import

        client: Any = distributed.Client
        self._address = address
        target = address if "://" in address else f"tcp://{address}"
        try:
            self._client: Any = client(target, timeout=5, set_as_default=False)
            self._client.wait_for_workers(1, timeout=30)
        except (OSError, TimeoutError, ValueError) as error:
            raise WorkersUnavailableError(
                f"--executor dask:{address}: no scheduler with workers answers there "
                f"({error or type(error).__name__}); start 'dask scheduler' and 'dask worker'"
            ) from error
        self._asked, self._threads = float("-inf"), 1
        # A task that kills its worker is not tried on every worker in turn: the run decides about a second try.
        self._executor: Executor = self._client.get_executor(retries=0)

    @property
    def slots(self) -> int:
        """Threads of all workers; they may come and go."""
        now = time.monotonic()
        if now - self._asked > _CLUSTER_INTERVAL:
            self._asked = now
            self._threads = max(1, int(sum(self._client.nthreads().values())))
        return self._threads

    @property
    def description(self) -> str:
        """For people."""
        return f"Dask at {self._address}, {self.slots} threads"

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call on the cluster."""
        try:
            return self._executor.submit(function, *arguments)
        except Exception as error:
            raise concurrent.futures.BrokenExecutor(f"Dask at {self._address}: {error}") from error

    def rebuild(self) -> None:
        """Restart the scheduler's workers: a hanging call cannot be stopped otherwise. Use a scheduler of your own."""
        try:
            self._client.restart(timeout=30)
            self._client.wait_for_workers(1, timeout=30)
        except Exception as error:
            raise WorkersUnavailableError(f"Dask at {self._address} does not answer: {error}") from error
        self._executor = self._client.get_executor(retries=0)

    def close(self) -> None:
        """Leave the cluster; what still runs there is cancelled."""
        self._executor.shutdown(wait=False)
        self._client.close(timeout=5)


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


def make_workers(executor: str, count: int | None) -> Workers:
    """Workers as ``--executor`` and ``--workers`` name them.

    Args:
        executor: "local" or "dask:HOST:PORT".
        count: local processes; all cores by default.

    Raises:
        InputError: as ``checked_executor``.
        WorkersUnavailableError: they cannot be had.
    """
    address = checked_executor(executor, count)
    if address:
        return DaskWorkers(address)
    return LocalWorkers(default_workers() if count is None else count)


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


@contextlib.contextmanager
def _signals_blocked() -> Iterator[None]:
    # A process inherits the mask: Ctrl-C in a terminal, or a service manager's SIGTERM to all, shall not tear the fork
    # server away from under the run that is just being stopped in good order.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
