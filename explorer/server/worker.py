"""One thread that always does the newest thing asked for.

viser runs callbacks in a pool, overlapping and unordered; a person who drags a slider asks for a hundred results and
wants the last. A ``LatestWorker`` runs tasks one after another; a task given under a key that still waits replaces the
waiting one. What a person's gesture asks for goes before what a run's news ask for, and so does what follows from it.
"""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator

_LOG = logging.getLogger("hpsop.explorer")


class Turn:
    """One after another of what several threads do in the background, as far as nobody waits long for the others.

    All at once they would share Python's lock with whatever answers a gesture, and each would take as long as all.

    Args:
        patience: seconds after which a thread no longer waits for its turn: another's task may take that much longer.
    """

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self._lock = threading.Lock()

    @contextlib.contextmanager
    def taken(self) -> Iterator[None]:
        """Within, the others wait."""
        own = self._lock.acquire(timeout=self._patience)
        try:
            yield
        finally:
            if own:
                self._lock.release()


class LatestWorker:
    """A daemon thread with one waiting slot for each key.

    Args:
        name: of the thread.
        on_error: told about an exception of a task (which never ends the thread).
        settle: seconds to wait before each task, in which newer ones may replace it.
        calm: seconds after a gesture's task in which nothing else begins: its answer has to reach the screen.
        turn: shared with other threads, or None.
    """

    def __init__(
        self,
        name: str,
        on_error: Callable[[BaseException], None] | None = None,
        settle: float = 0.0,
        calm: float = 0.0,
        turn: Turn | None = None,
    ) -> None:
        self._settle = settle
        self._turn = turn
        self._calm = calm
        self._calm_until = 0.0
        self._first: OrderedDict[str, Callable[[], None]] = OrderedDict()
        self._tasks: OrderedDict[str, Callable[[], None]] = OrderedDict()
        self._condition = threading.Condition()
        self._closed = False
        self._busy = False
        self._pressed = False
        self._serial = 0
        self._on_error = on_error
        self._thread = threading.Thread(target=self._loop, name=name, daemon=True)
        self._thread.start()

    def latest(self, key: str, task: Callable[[], None], first: bool = False, last: bool = False) -> None:
        """Run ``task`` soon; a task that still waits under the same key is forgotten.

        Args:
            key: of the waiting slot.
            task: what to do.
            first: before all that waits without it. A task that ran first passes it on to what it asks for.
            last: among what waits without it, whoever asks.
        """
        with self._condition:
            if self._closed:
                return
            first = not last and (first or (self._pressed and threading.current_thread() is self._thread))
            if first:
                self._tasks.pop(key, None)
            (self._first if first or key in self._first else self._tasks)[key] = task
            self._condition.notify_all()

    def every(self, task: Callable[[], None], first: bool = False) -> None:
        """Run ``task`` soon, whatever comes after it; ``first`` as in ``latest``."""
        with self._condition:
            self._serial += 1
            key = f"#{self._serial}"
        self.latest(key, task, first)

    def waiting(self, key: str) -> bool:
        """Whether a newer task already waits under ``key`` (so that the present one may give up)."""
        with self._condition:
            return key in self._first or key in self._tasks

    def wait_until_idle(self, timeout: float) -> bool:
        """Block until nothing waits or runs; False when ``timeout`` seconds were not enough."""
        with self._condition:
            return self._condition.wait_for(lambda: not self._waits() and not self._busy, timeout)

    def wait_until_answered(self, timeout: float) -> None:
        """Block while a person's gesture waits or is in work, ``timeout`` seconds at most."""
        with self._condition:
            self._condition.wait_for(lambda: not self._first and not (self._busy and self._pressed), timeout)

    def _waits(self) -> bool:
        return bool(self._first) or bool(self._tasks)

    def close(self) -> None:
        """Forget what waits and end the thread after the present task."""
        with self._condition:
            self._closed = True
            self._first.clear()
            self._tasks.clear()
            self._condition.notify_all()

    def _loop(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._closed or self._waits())
                if self._closed:
                    return
                self._busy = True
                calm = self._calm_until - time.monotonic()
                if calm > 0.0 and not self._first:
                    self._condition.wait_for(lambda: self._closed or bool(self._first), calm)
            if self._settle:
                time.sleep(self._settle)
            with self._turn.taken() if self._turn is not None else contextlib.nullcontext():
                self._run_next()

    def _run_next(self) -> None:
        with self._condition:
            if self._closed:
                self._busy = False
                return
            self._pressed = bool(self._first)
            _, task = (self._first or self._tasks).popitem(last=False)
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
                if self._pressed:
                    self._calm_until = time.monotonic() + self._calm
                self._condition.notify_all()
