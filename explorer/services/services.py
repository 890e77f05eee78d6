"""What stands between the page and hpsop_core, in one piece."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from explorer.services.designs import Designs
from explorer.services.display import Display
from explorer.services.library import RunLibrary
from explorer.services.own_ships import Desk, OwnShips
from explorer.services.refining import Refining
from explorer.services.runs import Runs


@dataclass(frozen=True)
class Services:
    """What views may ask for.

    Attributes:
        designs: numbers, curves, shapes and fields of a design.
        runs: the run on display and the folder of runs.
        ships: a ship of the user's own, read and made the case.
        refining: errors when asked.
    """

    designs: Designs
    runs: Runs
    ships: OwnShips
    refining: Refining

    def close(self) -> None:
        """Leave no process behind."""
        self.refining.close()
        self.ships.close()
        self.runs.close()


class Page(Display, Desk, Protocol):
    """The page's state, as services see it."""


def open_services(display: Page, library: RunLibrary, workers: int | None = None) -> Services:
    """Services that show on ``display`` what changes.

    Args:
        display: the page's state.
        library: the user's runs.
        workers: local processes of a run; all cores by default.
    """
    designs = Designs(display)
    ships = OwnShips(display, library.folder / "ships")
    runs = Runs(display, designs, library, workers)
    return Services(designs, runs, ships, Refining(display, designs, runs))
