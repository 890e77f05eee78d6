"""What a person may ask of a running run, from any thread."""

from __future__ import annotations

import threading
import time


class RunControl:
    """Pause, resume, stop and extend, asked by any thread and obeyed by the one that drives the run."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._paused = False
        self._stopped = False
        self._extension = 0

    def pause(self) -> None:
        """Start no more evaluations until ``resume``."""
        with self._condition:
            self._paused = True
            self._condition.notify_all()

    def resume(self) -> None:
        """Go on."""
        with self._condition:
            self._paused = False
            self._condition.notify_all()

    def stop(self) -> None:
        """End the run after the evaluations that are under way."""
        with self._condition:
            self._stopped = True
            self._condition.notify_all()

    def extend(self, generations: int) -> None:
        """Ask for so many more generations."""
        with self._condition:
            self._extension += generations
            self._condition.notify_all()

    @property
    def extension(self) -> int:
        """Generations asked for and not yet taken."""
        return self._extension

    def take_extension(self) -> int:
        """Generations asked for since the last call."""
        with self._condition:
            extension, self._extension = self._extension, 0
            return extension

    @property
    def paused(self) -> bool:
        """Whether the run shall pause."""
        return self._paused

    @property
    def stopped(self) -> bool:
        """Whether the run shall end."""
        return self._stopped

    def wait_while_paused(self) -> None:
        """Return when the run shall go on or end."""
        with self._condition:
            self._condition.wait_for(lambda: self._stopped or not self._paused)

    def wait(self, seconds: float) -> None:
        """Return after some seconds, or at once when the run shall end."""
        give_up = time.monotonic() + seconds
        with self._condition:
            self._condition.wait_for(lambda: self._stopped, timeout=max(0.0, give_up - time.monotonic()))
