"""What stands between the page and hpsop_core, in one piece."""

from __future__ import annotations

from dataclasses import dataclass

from explorer.services.designs import Designs
from explorer.services.display import Display
from explorer.services.library import RunLibrary
from explorer.services.runs import Runs


@dataclass(frozen=True)
class Services:
    """What views may ask for.

    Attributes:
        designs: numbers, curves, shapes and fields of a design.
        runs: the run on display and the folder of runs.
    """

    designs: Designs
    runs: Runs


def open_services(display: Display, library: RunLibrary, workers: int | None = None) -> Services:
    """Services that show on ``display`` what changes.

    Args:
        display: the page's state.
        library: the user's runs.
        workers: local processes of a run; all cores by default.
    """
    designs = Designs(display)
    return Services(designs, Runs(display, designs, library, workers))
