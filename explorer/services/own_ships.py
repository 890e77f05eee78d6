"""A ship of the user's own: read as it was said, read again when more is said, and made the case.

What people bring is held in memory. What is kept beside the runs, for the case to name, is the table as it was
understood (ship axes, metres), under the hash of its own content: the page and the workers of a run read that, and
nothing of the original file.
"""

from __future__ import annotations

import dataclasses
import hashlib
import os
import re
import time
from pathlib import Path
from typing import Any, Protocol

from explorer.server.worker import LatestWorker
from explorer.services.reading import ReadingProcess
from explorer.services.reading_job import Answer, Refused
from explorer.state.own_ship import OwnShip, UserFile
from hpsop_core.case.case import Case
from hpsop_core.case.ready_case import ready_case
from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input import HullFile, ReadOptions, normalised_options, normalised_text
from hpsop_core.geometry.propeller.input import UnderstoodPropeller
from hpsop_core.geometry.propeller.input.normalised import normalised_text as propeller_text

# Typing rests so long before a file is read again.
_SETTLE_SECONDS = 0.35


class Desk(Protocol):
    """Where the ship lies that is being brought in; explorer/state/app_state.py is the page's."""

    ship: OwnShip

    def change_ship(self, **changes: Any) -> OwnShip:
        """Change something of it."""

    def drafted(self) -> Case:
        """The case as it is set up now.

        Raises:
            InputError: the settings do not make a case.
        """


class OwnShips:
    """Reads what lies on the desk.

    Args:
        desk: shows what was understood.
        folder: where tables are kept that cases name.
        process: that reads; one of its own by default.
    """

    def __init__(self, desk: Desk, folder: Path, process: ReadingProcess | None = None) -> None:
        self._desk = desk
        self._folder = folder
        self._process = process or ReadingProcess()
        self._worker = LatestWorker("ship", settle=_SETTLE_SECONDS)

    def expect(self) -> None:
        """A file is on its way: have the readers ready."""
        self._worker.latest("warm", self._process.warm)

    def bring_hull(self, name: str, content: bytes) -> None:
        """A hull file is here; what was said about a file of another name is forgotten.

        Args:
            name: for people; nothing is written under it.
            content: its bytes.
        """
        same = self._desk.ship.hull is not None and self._desk.ship.hull.name == name
        said: dict[str, Any] = {} if same else {"options": ReadOptions(), "shaft_height": None, "boss_x": None}
        self._desk.change_ship(hull=UserFile(name, content), read=None, trouble="", reading=True, **said)
        self._worker.latest("hull", self._read_hull)

    def bring_propeller(self, name: str, content: bytes) -> None:
        """A propeller's table is here."""
        file = UserFile(name, content)
        self._desk.change_ship(propeller=file, read_propeller=None, propeller_trouble="", reading=True)
        self._worker.latest("propeller", self._read_propeller)

    def say(self, **said: Any) -> None:
        """Say something about the hull's file: a field of ``ReadOptions``, shaft_height or boss_x.

        Raises:
            InputError: it cannot be; nothing is changed.
        """
        place = {name: said.pop(name) for name in ("shaft_height", "boss_x") if name in said}
        options = dataclasses.replace(self._desk.ship.options, **said)
        self._desk.change_ship(options=options, reading=self._desk.ship.hull is not None, **place)
        if self._desk.ship.hull is not None:
            self._worker.latest("hull", self._read_hull)

    def say_blades(self, blades: int) -> None:
        """Say for how many blades the propeller's table was drawn."""
        self._desk.change_ship(blades=blades, reading=self._desk.ship.propeller is not None)
        if self._desk.ship.propeller is not None:
            self._worker.latest("propeller", self._read_propeller)

    def put_away(self, what: str) -> None:
        """Take a file ("hull" or "propeller") off the desk."""
        if what == "hull":
            self._desk.change_ship(
                hull=None, read=None, trouble="", options=ReadOptions(), shaft_height=None, boss_x=None, reading=False
            )
        else:
            self._desk.change_ship(propeller=None, read_propeller=None, propeller_trouble="", reading=False)

    def close(self) -> None:
        """Leave no process behind."""
        self._worker.close()
        self._process.close()

    # ---- reading ---------------------------------------------------------------------------------------------------
    def _read_hull(self) -> None:
        ship = self._desk.ship
        file = ship.hull
        if file is None:
            return
        said = (file, ship.options, ship.shaft_height, ship.boss_x)
        begun = time.monotonic()
        found = self._process.hull(
            file.name,
            file.content,
            ship.options,
            ship.shaft_height,
            ship.boss_x,
            lambda: self._worker.waiting("hull") or self._desk.ship.hull is not file,
        )
        seconds = time.monotonic() - begun
        now = self._desk.ship
        if (now.hull, now.options, now.shaft_height, now.boss_x) != said:
            return
        done: dict[str, Any] = {"seconds": seconds, "reading": self._worker.waiting("propeller")}
        if isinstance(found, HullFile):
            self._desk.change_ship(read=found, trouble="", **done)
        else:
            self._desk.change_ship(read=None, trouble=_why(found), **done)

    def _read_propeller(self) -> None:
        ship = self._desk.ship
        file = ship.propeller
        if file is None:
            return
        found = self._process.propeller(file.name, file.content, ship.blades)
        if (self._desk.ship.propeller, self._desk.ship.blades) != (file, ship.blades):
            return
        waiting = self._worker.waiting("hull")
        if isinstance(found, UnderstoodPropeller):
            self._desk.change_ship(read_propeller=found, propeller_trouble="", reading=waiting)
        else:
            self._desk.change_ship(read_propeller=None, propeller_trouble=_why(found), reading=waiting)

    # ---- the case --------------------------------------------------------------------------------------------------
    def case(self) -> Case:
        """The case of what was understood: initial design, bounds, conditions and limits for that ship.

        With a propeller alone it is the case as it is set up, with this propeller.

        Raises:
            InputError: nothing that can be used lies there, or a table cannot be kept.
        """
        ship = self._desk.ship
        if ship.reading:
            raise InputError("the file is still being read; wait until its figures stand there")
        for file, read, why in (
            (ship.hull, ship.read, ship.trouble),
            (ship.propeller, ship.read_propeller, ship.propeller_trouble),
        ):
            if file is not None and read is None:
                raise InputError(f"{why or file.name + ': not read'}; put that right, or put the file away")
        propeller = ship.read_propeller
        where = "" if propeller is None else str(self._kept("propeller", propeller_text(propeller.table)))
        if ship.read is not None:
            case = self._hull_case(ship, ship.read, where)
        elif propeller is not None:
            case = self._desk.drafted().replaced(
                "propeller", geometry=where, geometry_blade_count=propeller.blade_count
            )
            case = case.replaced("initial", blade_count=propeller.blade_count)
        else:
            raise InputError("there is no file yet; bring a hull or a propeller first")
        return case if propeller is None else _with_its_area(case, propeller.expanded_area_ratio)

    def _hull_case(self, ship: OwnShip, read: HullFile, propeller: str) -> Case:
        table, told = read.table, read.understood
        path = str(self._kept("hull", normalised_text(table)))
        blades = ship.blades if propeller else None
        made = f"Made on the page of {told.name}: {told.layout}, lengths in {told.unit}; {told.axes}."
        case = ready_case(read, path, normalised_options(table), propeller, blades, made)
        place = {"shaft_height": ship.shaft_height, "boss_x": ship.boss_x}
        case = case.replaced("hull", **{name: value for name, value in place.items() if value is not None})
        stem = re.sub(r"[^A-Za-z0-9]+", "-", Path(told.name).stem).strip("-")[:40].lower()
        size = f"L {told.length:.4g} m, B {told.breadth:.4g} m, T {told.draft:.4g} m"
        return dataclasses.replace(
            case,
            name=stem or "own-ship",
            title=f"{told.name}, {size}",
        )

    def _kept(self, what: str, text: str) -> Path:
        """The file beside the runs that holds this text, under the hash of it.

        Raises:
            InputError: it cannot be written.
        """
        content = text.encode()
        path = self._folder / f"{what}-{hashlib.sha256(content).hexdigest()[:20]}.csv"
        fresh = path.with_suffix(".new")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            fresh.write_bytes(content)
            os.replace(fresh, path)
        except OSError as error:
            raise InputError(
                f"{self._folder}: the table cannot be kept ({error.strerror}); set HPSOP_RUNS to another folder"
            ) from None
        return path.resolve()


def _with_its_area(case: Case, ratio: float) -> Case:
    """The case beginning at the propeller's own expanded area ratio, which its bounds then hold."""
    low, high = case.bounds.as_dict()["expanded_area_ratio"]
    bounds = {"expanded_area_ratio": (min(low, ratio), max(high, ratio))}
    return case.replaced("initial", expanded_area_ratio=ratio).with_bounds(bounds)


def _why(answer: Answer) -> str:
    return answer.why if isinstance(answer, Refused) else "the file is of another kind"
