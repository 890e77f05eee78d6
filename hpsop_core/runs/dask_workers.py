"""A Dask cluster as the place where evaluations run, by ``Client.get_executor()``."""

from __future__ import annotations

import contextlib
import importlib
import importlib.metadata
import logging
import platform
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from typing import Any

from hpsop_core.runs.control import RunControl
from hpsop_core.runs.workers import WorkersLostError, WorkersUnavailableError

_CLUSTER_INTERVAL = 2.0  # seconds between looks at which workers a cluster has
_PACKAGES = ("numpy", "scipy", "numba", "hpsop")


def worker_versions() -> dict[str, str]:
    """What decides the bits of an evaluation, in the process that asks: Python's minor version and the packages'."""
    found = {"python": ".".join(platform.python_version_tuple()[:2])}
    for name in _PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            # hpsop run from a checkout that was never installed
            module = importlib.import_module("hpsop_core.version") if name == "hpsop" else None
            found[name] = "none" if module is None else str(module.__version__)
    return found


class DaskWorkers:
    """The workers of a Dask scheduler that have this program's versions; where one has others, none is used.

    Args:
        address: "HOST:PORT" of the scheduler.

    Raises:
        WorkersUnavailableError: the scheduler does not answer, has no workers, or one of other versions.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._client: Any = None
        self._executor: Executor | None = None
        self._versions: dict[str, dict[str, str]] = {}
        self._threads = 1
        self._asked = float("-inf")
        # It reports what this class says in one line.
        for name in ("distributed", "distributed.client", "distributed.core", "distributed.comm"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._connect(30)

    def _connect(self, seconds: float) -> None:
        import distributed  # an optional dependency, and slow to import

        client: Any = distributed.Client
        target = self._address if "://" in self._address else f"tcp://{self._address}"
        try:
            self._client = client(target, timeout=5, set_as_default=False)
            self._client.wait_for_workers(1, timeout=seconds)
            self._count()
        except (OSError, TimeoutError, ValueError) as error:
            self._leave()
            raise WorkersUnavailableError(
                f"--executor dask:{self._address}: no scheduler with workers answers there "
                f"({error or type(error).__name__}); start 'dask scheduler' and 'dask worker'"
            ) from error
        except WorkersUnavailableError:
            self._leave()
            raise

    def _admit(self, workers: list[str]) -> None:
        """Ask new workers for their versions; evaluations go to those alone that have been asked.

        Raises:
            WorkersUnavailableError: one has others.
        """
        fresh = [worker for worker in workers if worker not in self._versions]
        if fresh:
            found: dict[str, Any] = self._client.run(worker_versions, workers=fresh, on_error="return")
            for worker, versions in found.items():
                self._refuse_others(worker, versions)
                self._versions[worker] = versions
        self._versions = {worker: self._versions[worker] for worker in workers if worker in self._versions}
        if self._executor is None or fresh:
            # A task that kills its worker is not tried on every worker in turn: the run decides about a second try.
            self._executor = self._client.get_executor(
                retries=0, workers=list(self._versions), allow_other_workers=False
            )

    def _refuse_others(self, worker: str, versions: Any) -> None:
        own = worker_versions()
        if not isinstance(versions, dict):
            # It cannot even import this module.
            raise WorkersUnavailableError(
                f"--executor dask:{self._address}: the worker {worker} does not know this hpsop "
                f"({' '.join(str(versions).split())[:100]}); install hpsop {own['hpsop']} there"
            )
        others = [
            f"{name} {versions.get(name)}, here {mine}" for name, mine in own.items() if versions.get(name) != mine
        ]
        if others:
            raise WorkersUnavailableError(
                f"--executor dask:{self._address}: the worker {worker} has other versions ({'; '.join(others)}), and "
                "would give other numbers; install the same on every machine"
            )

    @property
    def slots(self) -> int:
        """Threads of all workers, as last seen; they may come and go."""
        return self._threads

    def look(self) -> None:
        """Ask which workers there are, every few seconds.

        Raises:
            WorkersLostError: the scheduler does not answer. This alone tells of it while results are being fetched: a
                future whose result was under way when the scheduler died is never done.
        """
        if self._client is None or self._client.status != "running":
            raise self._lost()
        if time.monotonic() - self._asked > _CLUSTER_INTERVAL:
            with self._answering():
                self._count()

    def _count(self) -> None:
        self._asked = time.monotonic()
        threads: dict[str, int] = self._client.nthreads()
        self._admit(list(threads))
        self._threads = max(1, sum(count for worker, count in threads.items() if worker in self._versions))

    @property
    def description(self) -> str:
        """For people."""
        return f"Dask at {self._address}, {self._threads} threads"

    @property
    def blamable(self) -> bool:
        """Dask itself finds out which task kills its workers; what breaks here is the way to the scheduler."""
        return False

    @property
    def versions(self) -> dict[str, dict[str, str]]:
        """By the workers' addresses."""
        return self._versions

    def warm(self, level: int, control: RunControl, task: Callable[..., None], *arguments: Any) -> None:
        """Nothing: which worker a call goes to is Dask's business."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call on the cluster.

        Raises:
            WorkersLostError: the scheduler does not answer.
        """
        if self._executor is None or self._client.status != "running":
            raise self._lost()
        with self._answering():
            return self._executor.submit(function, *arguments)

    def _lost(self) -> WorkersLostError:
        return WorkersLostError(f"the Dask scheduler at {self._address} does not answer")

    @contextlib.contextmanager
    def _answering(self) -> Iterator[None]:
        try:
            yield
        except WorkersUnavailableError:
            raise
        except Exception as error:
            raise self._lost() from error

    def rebuild(self) -> None:
        """Restart the scheduler's workers: a hanging call cannot be stopped otherwise. Use a scheduler of your own.

        Raises:
            WorkersLostError: it does not answer, or has no workers.
            WorkersUnavailableError: a worker has other versions.
        """
        self._versions, self._executor = {}, None
        if self._client is not None and self._client.status == "running":
            with contextlib.suppress(Exception):
                self._client.restart(timeout=30)
                self._client.wait_for_workers(1, timeout=30)
                self._count()
                return
        self.reach()

    def reach(self) -> None:
        """Connect anew. Nothing is restarted: a worker without a nanny, which had come back, would end by it for good.

        Raises:
            WorkersLostError, WorkersUnavailableError: as ``rebuild``.
        """
        self._versions = {}
        self._leave()
        try:
            self._connect(5)
        except WorkersUnavailableError as error:
            if isinstance(error.__cause__, (OSError, TimeoutError, ValueError)):
                raise self._lost() from error
            raise

    def close(self) -> None:
        """Leave the cluster; what still runs there is cancelled."""
        if self._executor is not None:
            with contextlib.suppress(Exception):
                self._executor.shutdown(wait=False)
        self._leave()

    def _leave(self) -> None:
        client, self._client, self._executor = self._client, None, None
        if client is not None:
            with contextlib.suppress(Exception):
                client.close(timeout=5)
