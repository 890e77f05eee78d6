"""What services may see and do of the page's state."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from explorer.state.run_picture import RunPicture
from explorer.state.shown import Shown
from hpsop_core.case.case import Case


class Display(Protocol):
    """What services may see and do of the page's state; explorer/state/app_state.py is the page's."""

    @property
    def picture(self) -> RunPicture:
        """The run on display."""

    def drafted(self) -> Case:
        """The case as it is set up now.

        Raises:
            InputError: the settings do not make a case.
        """

    def show_run(self, picture: RunPicture, first: Callable[[], Shown | None]) -> None:
        """Show a newer picture of the run, or another run and the design that is seen first."""

    def wait_until_drawn(self, timeout: float) -> None:
        """Until every page has drawn the run, ``timeout`` seconds at most."""

    def make_way(self, timeout: float) -> None:
        """While any browser's gesture waits for its answer, ``timeout`` seconds at most."""

    def tell_all(self, topic: str) -> None:
        """Something that is not in the picture changed: "library"."""
