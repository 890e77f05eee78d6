"""Steps that can be taken back, and taken again."""

from __future__ import annotations

import time
from collections.abc import Hashable
from typing import Generic, TypeVar

State = TypeVar("State")

_MOST_STEPS = 100
# changes of one thing that follow each other so closely are one step: a drag, a number typed digit by digit
_ONE_STEP_SECONDS = 1.0


class History(Generic[State]):
    """What something was before each step, back and forth.

    The present state is its owner's: it is handed in when a step is made, taken back or taken again.
    """

    def __init__(self) -> None:
        self._before: list[State] = []
        self._after: list[State] = []
        self._what: Hashable = None
        self._changed = 0.0

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether a step was taken back and nothing has been changed since."""
        return bool(self._after)

    def record(self, before: State, what: Hashable, now: float | None = None) -> None:
        """Something has been changed.

        Args:
            before: the state as it was.
            what: that was changed; changes of the same in quick succession are one step.
            now: seconds of a clock that never turns back; this process's own by default.
        """
        now = time.monotonic() if now is None else now
        goes_on = what == self._what and now - self._changed < _ONE_STEP_SECONDS and self._before
        self._what, self._changed = what, now
        self._after.clear()
        if not goes_on:
            self._before.append(before)
            del self._before[:-_MOST_STEPS]

    def undo(self, present: State) -> State | None:
        """The state before the last step, or None where there is none."""
        return self._turn(self._before, self._after, present)

    def redo(self, present: State) -> State | None:
        """The state that the last undo left, or None where there is none."""
        return self._turn(self._after, self._before, present)

    def clear(self) -> None:
        """Forget every step."""
        self._before.clear()
        self._after.clear()
        self._what = None

    def _turn(self, source: list[State], target: list[State], present: State) -> State | None:
        if not source:
            return None
        target.append(present)
        self._what = None
        return source.pop()
