"""One thread that always does the newest thing asked for.

viser runs callbacks in a pool, overlapping and unordered; a person who drags a slider asks for a hundred results and
wants the last. A ``LatestWorker`` runs tasks one after another; a task given under a key that still waits replaces the
waiting one.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable

_LOG = logging.getLogger("hpsop.explorer")


class LatestWorker:
    """A daemon thread with one waiting slot for each key.

    Args:
        name: of the thread.
        on_error: told about an exception of a task (which never ends the thread).
        settle: seconds to wait before each task, in which newer ones may replace it.
    """

    def __init__(self, name: str, on_error: Callable[[BaseException], None] | None = None, settle: float = 0.0) -> None:
        self._settle = settle
        self._tasks: OrderedDict[str, Callable[[], None]] = OrderedDict()
        self._condition = threading.Condition()
        self._closed = False
        self._busy = False
        self._serial = 0
        self._on_error = on_error
        self._thread = threading.Thread(target=self._loop, name=name, daemon=True)
        self._thread.start()

    def latest(self, key: str, task: Callable[[], None]) -> None:
        """Run ``task`` soon; a task that still waits under the same key is forgotten."""
        with self._condition:
            if not self._closed:
                self._tasks[key] = task
                self._condition.notify_all()

    def every(self, task: Callable[[], None]) -> None:
        """Run ``task`` soon, whatever comes after it."""
        with self._condition:
            self._serial += 1
            key = f"#{self._serial}"
        self.latest(key, task)

    def waiting(self, key: str) -> bool:
        """Whether a newer task already waits under ``key`` (so that the present one may give up)."""
        with self._condition:
            return key in self._tasks

    def wait_until_idle(self, timeout: float) -> bool:
        """Block until nothing waits or runs; False when ``timeout`` seconds were not enough."""
        with self._condition:
            return self._condition.wait_for(lambda: not self._tasks and not self._busy, timeout)

    def close(self) -> None:
        """Forget what waits and end the thread after the present task."""
        with self._condition:
            self._closed = True
            self._tasks.clear()
            self._condition.notify_all()

    def _loop(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._closed or bool(self._tasks))
                if self._closed:
                    return
                self._busy = True
            if self._settle:
                time.sleep(self._settle)
            with self._condition:
                if self._closed:
                    self._busy = False
                    return
                _, task = self._tasks.popitem(last=False)
            try:
                task()
            # A view that stumbles must not take the page down; the user is told, the log keeps the trace.
            except Exception as error:  # noqa: BLE001
                if not self._closed:
                    _LOG.exception("a view failed")
                    if self._on_error is not None:
                        self._on_error(error)
            finally:
                with self._condition:
                    self._busy = False
                    self._condition.notify_all()
