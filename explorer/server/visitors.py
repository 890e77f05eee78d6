"""Builds something for each browser and takes it down again, however short the visit.

viser runs callbacks of coming and leaving in a pool of threads, overlapping: a browser that left while its page was
being built could be taken down before it was there, and stayed for ever. Here coming and leaving are noted on viser's
own event loop, in their true order; what has left is not built, or taken down as soon as it is.
"""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import viser

from explorer.server.process import tidy
from explorer.server.worker import LatestWorker

_LOG = logging.getLogger("hpsop.explorer")
_BUILDERS = 4
# something has gone for so long before it is tidied away, and so long after that nothing is
_TIDY_SECONDS, _TIDY_REST = 2.0, 15.0
# browsers whose leaving cannot wait so long: a megabyte each
_MANY = 20


class _Visit:
    """One browser: what to do when it leaves, once that is known."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._take_down: Callable[[], None] | None = None
        self.gone = False

    def built(self, take_down: Callable[[], None]) -> None:
        with self._lock:
            if not self.gone:
                self._take_down = take_down
                return
        take_down()

    def leave(self) -> Callable[[], None] | None:
        with self._lock:
            self.gone = True
            return self._take_down


def _logged(task: Callable[..., None], *arguments: object) -> None:
    try:
        task(*arguments)
    # one browser's page that cannot be built must not cost the others theirs
    except Exception:  # noqa: BLE001
        _LOG.exception("the page of a browser could not be built")


class Visitors:
    """Who is there.

    Args:
        server: whose browsers.
        build: makes a browser's page, and returns what takes it down again; called in a thread, never after the browser
            has left.
    """

    def __init__(self, server: viser.ViserServer, build: Callable[[viser.ClientHandle], Callable[[], None]]) -> None:
        self._server = server
        self._build = build
        self._visits: dict[int, _Visit] = {}
        self._builders = ThreadPoolExecutor(_BUILDERS, thread_name_prefix="visitors")
        self._urgent = threading.Event()
        self._departed = 0
        self._tidied = -_TIDY_REST
        self._housekeeper = LatestWorker("housekeeper", settle=_TIDY_SECONDS)
        # coroutines run on viser's event loop, one after another
        server.on_client_connect(self._came)
        server.on_client_disconnect(self._left)

    async def _came(self, client: viser.ClientHandle) -> None:
        # what a browser said just before it left may be heard after it
        if client.client_id in self._visits or client.client_id not in self._server._websock_server._live_connections:
            return
        visit = self._visits[client.client_id] = _Visit()
        self._submit(self._make, client, visit)

    async def _left(self, client: viser.ClientHandle) -> None:
        visit = self._visits.pop(client.client_id, None)
        take_down = visit.leave() if visit is not None else None
        if take_down is not None:
            self._submit(take_down)
        self._departed += 1
        if self._departed >= _MANY:
            self._urgent.set()
        self.tidy_soon()

    def tidy_soon(self) -> None:
        """Give memory back in a moment: something large has gone."""
        self._housekeeper.latest("tidy", self._tidy)

    def _tidy(self) -> None:
        # it stops every thread for a tenth of a second: who comes and goes all the time must not do that as often
        self._urgent.wait(max(self._tidied + _TIDY_REST - time.monotonic(), 0.0))
        self._urgent.clear()
        self._departed = 0
        tidy()
        self._tidied = time.monotonic()

    def _make(self, client: viser.ClientHandle, visit: _Visit) -> None:
        if not visit.gone:
            visit.built(self._build(client))

    def _submit(self, task: Callable[..., None], *arguments: object) -> None:
        # the server may be ending, and everything with it
        with contextlib.suppress(RuntimeError):
            self._builders.submit(_logged, task, *arguments)

    def close(self) -> None:
        """Build no more."""
        self._urgent.set()
        self._builders.shutdown(wait=False, cancel_futures=True)
        self._housekeeper.close()
