"""What a place where evaluations run must offer; ``executor`` has local processes, ``dask_workers`` a cluster."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Protocol

from hpsop_core.errors import InputError
from hpsop_core.runs.control import RunControl


class WorkersUnavailableError(InputError):
    """No worker can be had: processes cannot start, or the cluster that was named does not answer."""


class WorkersLostError(WorkersUnavailableError):
    """Workers that were there cannot be reached just now; ``Workers.reach`` may succeed later."""


class Workers(Protocol):
    """An executor that can be thrown away and made anew."""

    @property
    def slots(self) -> int:
        """Evaluations that really run side by side; no more are ever submitted, so each starts at once."""

    def look(self) -> None:
        """See whether they are still there, and how many; called all the while that evaluations are under way.

        Raises:
            WorkersLostError: they cannot be reached.
            WorkersUnavailableError: one has joined that cannot be used.
        """

    @property
    def description(self) -> str:
        """For people."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start a call.

        Raises:
            concurrent.futures.BrokenExecutor: a worker died while it was idle; call ``rebuild``.
        """

    @property
    def blamable(self) -> bool:
        """Whether a broken executor means that an evaluation under way took its worker along."""

    @property
    def versions(self) -> dict[str, dict[str, str]]:
        """Software versions by worker, of those that are not this program's own processes."""

    def warm(self, level: int, control: RunControl, task: Callable[..., None], *arguments: Any) -> None:
        """Call once in each worker that has not been warmed for this level; waits for it, or for a stop.

        Raises:
            WorkersUnavailableError: no workers can be had any more.
        """

    def rebuild(self) -> None:
        """Kill whatever runs and start again.

        Raises:
            WorkersLostError: a cluster does not answer.
            WorkersUnavailableError: no new workers can be had.
        """

    def reach(self) -> None:
        """Have workers again after they died or were lost; where some live and answer, they are left as they are.

        Raises:
            WorkersLostError, WorkersUnavailableError: as ``rebuild``.
        """

    def close(self) -> None:
        """Leave no process behind."""
