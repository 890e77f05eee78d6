"""What strangers and broken connections do, told to the terminal without flooding it: a line a kind, with a count."""

from __future__ import annotations

import logging
import threading
import time

_LOG = logging.getLogger("hpsop.explorer")
_QUIET_SECONDS = 60.0


class Notices:
    """Tells the first of a kind at once, and those that follow as a number, a line a minute at the most."""

    def __init__(self, quiet: float = _QUIET_SECONDS) -> None:
        self._quiet = quiet
        self._lock = threading.Lock()
        self._told: dict[str, float] = {}
        self._more: dict[str, int] = {}

    def tell(self, kind: str, text: str) -> None:
        """Log ``text``, unless another of its ``kind`` (a word of ours, never a stranger's) was told just now."""
        now = time.monotonic()
        with self._lock:
            if kind in self._told and now - self._told[kind] < self._quiet:
                self._more[kind] = self._more.get(kind, 0) + 1
                return
            self._told[kind] = now
            more = self._more.pop(kind, 0)
        _LOG.warning("%s%s", text, f" ({more} more like it since the last such line)" if more else "")
