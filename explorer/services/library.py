"""The user's folder of runs."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import re
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from explorer.services.run_labels import RunLabel, RunLabels
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.reader import RunReader, open_run

_STATES = {
    "finished": "finished",
    "stopped": "stopped",
    "running": "running",
    "paused": "paused",
    "failed": "failed",
    "interrupted": "interrupted",
    "new": "not started",
}

NOT_READABLE = "not readable"
"""Stands as the title of a file that cannot be opened; its summary says why."""


@dataclass(frozen=True)
class LibraryEntry:
    """One run of the folder.

    Attributes:
        name: of the file.
        title: the case's.
        summary: state, generations, evaluations.
        modified: seconds since 1970.
        deletable: nobody writes it.
        continuable: nobody writes it and it has generations left.
        label: what people call it.
        shipped: it is the demonstration, which comes with hpsop.
    """

    name: str
    title: str
    summary: str
    modified: float
    deletable: bool
    continuable: bool = False
    label: RunLabel = field(default_factory=RunLabel)
    shipped: bool = False


def runs_folder() -> tuple[Path, str]:
    """Where runs are saved, and what to tell the user about it, or "".

    HPSOP_RUNS, or hpsop/runs in the user's data folder; for an account without a home that can be written a new
    temporary folder, which stays. Where there is not even that, runs can be looked at and none started.

    Raises:
        InputError: HPSOP_RUNS names a home that does not exist.
    """
    stated, data = os.environ.get("HPSOP_RUNS"), os.environ.get("XDG_DATA_HOME")
    if stated:
        try:
            return Path(stated).expanduser(), ""
        except RuntimeError as error:
            raise InputError(f"HPSOP_RUNS={stated}: is no folder ({error}); set it to one") from None
    # an account may have no home at all (RuntimeError)
    with contextlib.suppress(OSError, RuntimeError):
        folder = (Path(data) if data else Path.home() / ".local" / "share") / "hpsop" / "runs"
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK | os.X_OK):
            return folder, ""
    remedy = "set HPSOP_RUNS to a folder of yours"
    try:
        folder = Path(tempfile.mkdtemp(prefix="hpsop-runs-"))
    except OSError:
        return Path("hpsop-runs"), f"no home folder can be written: runs cannot be saved; {remedy}"
    return folder, f"no home folder can be written: runs are saved in {folder}; {remedy} to find them again"


class RunLibrary:
    """The folder's runs; a name from a browser is only ever compared with the names that are there.

    Args:
        folder: of the runs.
        demonstration: a finished run that stands among them for ever, and is never written; None where there is none.

    Attributes:
        labels: what people call the runs.
    """

    def __init__(self, folder: Path, demonstration: Path | None = None) -> None:
        self.folder = folder
        self.demonstration = demonstration
        self.labels = RunLabels(folder)
        self._known: dict[str, tuple[tuple[float, int], LibraryEntry]] = {}

    def new_path(self, case_name: str) -> Path:
        """A name that is not taken.

        Raises:
            InputError: the folder cannot be made.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{self.folder}: cannot be made ({error.strerror}); set HPSOP_RUNS to a folder") from None
        stem = re.sub(r"[^A-Za-z0-9_-]+", "-", case_name).strip("-") or "run"
        base = f"{stem}-{time.strftime('%Y%m%d-%H%M%S')}"
        path = self.folder / f"{base}.hpsop"
        count = 2
        while path.exists():
            path = self.folder / f"{base}-{count}.hpsop"
            count += 1
        return path

    def path(self, name: str) -> Path | None:
        """The file of that name, if the folder has it."""
        for path in self._files():
            if path.name == name:
                return path
        shipped = self.demonstration
        return shipped if shipped is not None and shipped.name == name else None

    def is_shipped(self, path: Path) -> bool:
        """Whether it is the demonstration, which is only read."""
        return path == self.demonstration

    def entries(self) -> list[LibraryEntry]:
        """Every run, newest first, the demonstration last; a file that is no run says so."""
        labels = self.labels.all()
        runs = [dataclasses.replace(item, label=labels.get(item.name, RunLabel())) for item in self._own_entries()]
        shipped = self.demonstration
        if shipped is not None and all(item.name != shipped.name for item in runs):
            known = self._known.get("")
            if known is None:
                known = self._known[""] = ((0.0, 0), _entry(shipped, 0.0))
            runs.append(
                dataclasses.replace(
                    known[1],
                    deletable=False,
                    continuable=False,
                    label=labels.get(shipped.name, RunLabel()),
                    shipped=True,
                )
            )
        return runs

    def _own_entries(self) -> list[LibraryEntry]:
        found = []
        for path in self._files():
            try:
                status = path.stat()
                journal = path.with_name(path.name + "-wal")
                modified = max(status.st_mtime, journal.stat().st_mtime if journal.exists() else 0.0)
            except OSError:
                continue
            stamp = (modified, status.st_size)
            known = self._known.get(path.name)
            if known is None or known[0] != stamp:
                known = (stamp, _entry(path, modified))
                # a writer may end, or be killed, without another word in the file: looked at again until it is gone
                if known[1].deletable:
                    self._known[path.name] = known
            found.append(known[1])
        return sorted(found, key=lambda entry: -entry.modified)

    def refuse(self, path: Path, reason: str) -> None:
        """List a run as not readable: its damage lies deeper than a listing looks."""
        with contextlib.suppress(OSError):
            status = path.stat()
            entry = LibraryEntry(path.name, NOT_READABLE, reason, status.st_mtime, True)
            self._known[path.name] = ((status.st_mtime, status.st_size), entry)

    def delete(self, name: str) -> None:
        """Delete a run for good.

        Raises:
            InputError: there is none of that name, or somebody writes it.
        """
        path = self.path(name)
        if path is None:
            raise InputError(f"{name}: no such run in {self.folder}")
        if self.is_shipped(path):
            raise InputError("the demonstration comes with hpsop and stays")
        if is_being_written(path):
            raise InputError(f"{name}: is being written; stop that run first")
        try:
            for suffix in ("", "-wal", "-shm", ".lock"):
                path.with_name(path.name + suffix).unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{name}: cannot be deleted ({error.strerror})") from None
        self.labels.write(name, "", "")

    def _files(self) -> list[Path]:
        try:
            return sorted(path for path in self.folder.iterdir() if path.suffix == ".hpsop" and path.is_file())
        except OSError:
            return []


def _entry(path: Path, modified: float) -> LibraryEntry:
    try:
        reader: RunReader = open_run(path)
        state, _ = reader.state()
        done, evaluations = reader.progress()
        total = reader.generations_asked()
        summary = f"{_STATES.get(state, state)}, generation {done} of {total}, {evaluations} evaluations"
        free = not is_being_written(path)
        # Also a failed run may go on: what ended it may have been the machine.
        left = done < total
        return LibraryEntry(path.name, reader.case.title, summary, modified, free, free and left)
    except HpsopError as error:
        return LibraryEntry(path.name, NOT_READABLE, str(error), modified, True)
