"""Errors when asked: a design, or the whole front, solved again finer (``hpsop_core.evaluation.errors``)."""

from __future__ import annotations

import threading

from explorer.server.worker import LatestWorker
from explorer.services.designs import Designs
from explorer.services.display import Display
from explorer.services.runs import Runs
from explorer.state.shown import Shown
from hpsop_core.evaluation.levels import TRUTH

TOPIC = "errors"


class Refining:
    """Solves designs finer, one after another on a thread of its own, and keeps what comes out.

    What it finds stands in the page's memory at once, and in the run's file where that can be written.

    Args:
        display: told of each design that is done.
        designs: asked for them, and told their errors.
        runs: keep them in the file.
    """

    def __init__(self, display: Display, designs: Designs, runs: Runs) -> None:
        self._display = display
        self._designs = designs
        self._runs = runs
        self._worker = LatestWorker("refining")
        self._lock = threading.Lock()
        self._waiting: list[Shown] = []
        self._done = self._asked = 0
        self._trouble = ""

    def words(self) -> str:
        """What goes on, for people; "" where nothing does."""
        with self._lock:
            if self._waiting:
                return f"solving design {self._done + 1} of {self._asked} finer …"
            return self._trouble

    @property
    def busy(self) -> bool:
        """Whether designs are waiting."""
        with self._lock:
            return bool(self._waiting)

    def design(self, shown: Shown) -> None:
        """Solve one design finer."""
        self._ask([shown])

    def front(self) -> None:
        """Solve the newest front and the initial design finer."""
        picture = self._display.picture
        newest = picture.generations[-1] if picture.generations else None
        if newest is None or newest.level != TRUTH.number:
            return
        found = [self._designs.initial(TRUTH.number), *(self._designs.shown(number) for number in newest.front)]
        self._ask([shown for shown in found if shown is not None])

    def close(self) -> None:
        """End after the design under way."""
        with self._lock:
            self._waiting = []
        self._worker.close()

    def _ask(self, asked: list[Shown]) -> None:
        wanted = [shown for shown in asked if can_be_refined(shown)]
        with self._lock:
            if not self._waiting:
                self._done = self._asked = 0
            known = {shown.key for shown in self._waiting}
            fresh = [shown for shown in wanted if shown.key not in known]
            self._waiting += fresh
            self._asked += len(fresh)
            self._trouble = ""
        self._display.tell_all(TOPIC)
        self._worker.latest("next", self._next)

    def _next(self) -> None:
        while True:
            with self._lock:
                shown = self._waiting[0] if self._waiting else None
            if shown is None:
                break
            result = self._designs.refine(shown.evaluation.variables)
            if not result.ok:
                self._trouble = f"{shown.label} cannot be solved finer: {result.reason}"
            elif shown.design_id is not None:
                self._runs.keep_errors(shown.design_id, result)
            with self._lock:
                self._waiting = [item for item in self._waiting if item is not shown]
                self._done += 1
            self._display.tell_all(TOPIC)
        # The families of the front follow from the errors.
        self._runs.news()


def can_be_refined(shown: Shown) -> bool:
    """Whether a design has solvers' numbers of the true level, and no errors of its own yet."""
    evaluation = shown.evaluation
    return (
        evaluation.ok
        and evaluation.level == TRUTH.number
        and not evaluation.predicted
        and not evaluation.comparison_errors
    )
