"""One thread of linear algebra while numbers are made, so that the same input gives the same bits everywhere.

With several threads OpenBLAS cuts products and factorisations into other pieces and rounds their sums differently: the
last bits of a result would depend on the machine's cores and on environment variables, and a run continued elsewhere
would not repeat itself.  numpy and scipy each bring a copy of OpenBLAS; both are held.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from typing import Any

import threadpoolctl


class _Holder:
    """Which threads hold the libraries at one thread; the last to leave gives back what the first found.

    The limit belongs to the process. Without counting, a thread of the page that finishes first would give the second
    thread back to a computation that is still under way.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._depth = threading.local()
        self._holding = 0
        self._controller: Any = None
        self._found: Any = None

    def enter(self) -> None:
        depth = getattr(self._depth, "value", 0)
        if depth == 0:
            with self._lock:
                # Every thread asks for itself: where OpenBLAS runs on OpenMP the limit is each thread's own.
                found = self._limit()
                if self._holding == 0:
                    self._found = found
                self._holding += 1
        self._depth.value = depth + 1

    def leave(self) -> None:
        self._depth.value -= 1
        if self._depth.value == 0:
            with self._lock:
                self._holding -= 1
                if self._holding == 0:
                    _take_control()
                    self._found.restore_original_limits()
                    _take_control()

    def _limit(self) -> Any:
        if self._controller is None:
            # The controller knows the libraries that are loaded when it is made.
            import scipy.linalg  # noqa: F401  (and numpy with it)

            self._controller = threadpoolctl.ThreadpoolController()
        _take_control()
        return self._controller.limit(limits=1)


def _take_control() -> None:
    """Since version 3.7 threadpoolctl obeys the first thread that asks, and silently no other until that one ends."""
    clear = getattr(threadpoolctl.OpenBLASController, "clear_controlling_thread", None)
    if clear is not None:
        clear(force=True)


_holder = _Holder()


@contextlib.contextmanager
def one_blas_thread() -> Iterator[None]:
    """Hold BLAS and LAPACK at one thread; a context, or with parentheses a decorator. Nests, and is safe in threads."""
    _holder.enter()
    try:
        yield
    finally:
        _holder.leave()
