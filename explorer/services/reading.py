"""Files of unknown origin are read in a process of their own, which may take too long, too much, or die."""

from __future__ import annotations

import contextlib
import pickle
import subprocess
import threading
import time
from collections.abc import Callable
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path

from explorer.server.uploads import LARGEST_FILE, shown_name
from explorer.services.reading_job import Answer, HullJob, PropellerJob, Refused
from explorer.services.reading_process import READY
from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign.apart import own_python
from hpsop_core.geometry.hull.input import ReadOptions
from hpsop_core.geometry.hull.input.mesh import SUFFIXES as MESH_SUFFIXES
from hpsop_core.geometry.hull.input.surfaces import SUFFIXES as SURFACE_SUFFIXES
from hpsop_core.scratch import scratch_folder

LONGEST_SECONDS = 60.0
MOST_MEMORY = 2 * 2**30
_START_SECONDS = 120.0
_LOOK_SECONDS = 0.05
# a reading that nobody waits for any more is given so long to end by itself before its process is ended
_GRACE_SECONDS = 3.0
_LARGEST_ANSWER = 256 * 2**20
_KINDS = (*MESH_SUFFIXES, *SURFACE_SUFFIXES)
# A hull file by its ending; others are opened with the word "hull" before them.
HULL_SUFFIXES = (*_KINDS, ".csv", ".txt", ".dat", ".tsv")


def kind_of(name: str) -> str:
    """The ending under which a file is read: one of those that are known, else a table as text."""
    ending = Path(name).suffix.lower()
    return ending if ending in _KINDS else ".csv"


def hull_file(path: str) -> tuple[str, bytes]:
    """Name and bytes of a hull file of this machine.

    Raises:
        InputError: it cannot be read, or is larger than a file may be.
    """
    file = Path(path)
    try:
        if not file.is_file():
            raise InputError(f"{path}: no such file; give a table of offsets, a mesh or a surface model of a hull")
        if file.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path}: larger than {LARGEST_FILE >> 20} MB; thin it, or use 'hpsop hull' and its case")
        return shown_name(file.name), file.read_bytes()
    except (OSError, ValueError) as error:
        raise InputError(f"{path[:200]}: cannot be read ({error})") from None


class ReadingProcess:
    """One process that reads one file after another; ended and begun anew where a file is too much for it.

    Args:
        seconds: for one file.
        memory: bytes of address space that the process may map.
    """

    def __init__(self, seconds: float = LONGEST_SECONDS, memory: int = MOST_MEMORY) -> None:
        self._seconds = seconds
        self._memory = memory
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        self._lock = threading.Lock()
        self._closed = False

    def warm(self) -> None:
        """Start the process where there is none, so that it has imported its readers when the file is there."""
        with self._lock, contextlib.suppress(InputError):
            self._start()

    def hull(
        self,
        name: str,
        content: bytes,
        options: ReadOptions,
        shaft_height: float | None = None,
        boss_x: float | None = None,
        unwanted: Callable[[], bool] = lambda: False,
    ) -> Answer:
        """A hull file read; ``unwanted`` says meanwhile whether nobody waits for it any more."""
        return self._read(
            content,
            kind_of(name),
            name,
            lambda path: HullJob(path, name, options, shaft_height, boss_x),
            unwanted,
        )

    def propeller(self, name: str, content: bytes, blade_count: int) -> Answer:
        """A propeller's radial table read."""
        return self._read(content, ".csv", name, lambda path: PropellerJob(path, name, blade_count), lambda: False)

    def close(self) -> None:
        """Leave no process behind."""
        self._closed = True
        self._end()

    def _read(
        self,
        content: bytes,
        kind: str,
        name: str,
        job: Callable[[Path], HullJob | PropellerJob],
        unwanted: Callable[[], bool],
    ) -> Answer:
        try:
            with self._lock, scratch_folder("ship") as folder:
                path = folder / f"own-file{kind}"
                path.write_bytes(content)
                return self._told(job(path), name, unwanted)
        except InputError as error:
            return Refused(str(error))
        except OSError as error:
            return Refused(f"{name}: cannot be kept while it is read ({error.strerror}); set TMPDIR elsewhere")

    def _told(self, job: HullJob | PropellerJob, name: str, unwanted: Callable[[], bool]) -> Answer:
        try:
            connection = self._start()
            connection.send_bytes(pickle.dumps(job))
            return self._answer(connection, name, unwanted)
        except (EOFError, OSError):
            self._end()
            return Refused(f"{name}: the process that read it died; is the file damaged, or far too large?")

    def _answer(self, connection: Connection, name: str, unwanted: Callable[[], bool]) -> Answer:
        begun = time.monotonic()
        while not connection.poll(_LOOK_SECONDS):
            spent = time.monotonic() - begun
            if spent > self._seconds:
                self._end()
                return Refused(f"{name}: not read within {self._seconds:g} s; thin it and try again")
            if spent > _GRACE_SECONDS and unwanted():
                self._end()
                return Refused(f"{name}: read anew")
        # The process runs our own code with our own rights: what it sends is bounded against a flood only.
        found: Answer = pickle.loads(connection.recv_bytes(_LARGEST_ANSWER))  # noqa: S301
        return found

    def _start(self) -> Connection:
        """The connection to a process that is ready.

        Raises:
            InputError: none can be had.
        """
        if self._closed:
            raise InputError("the page is being closed")
        if self._process is not None and self._process.poll() is None and self._connection is not None:
            return self._connection
        self._end()
        ours, theirs = Pipe()
        handle = theirs.fileno()
        command, environment = own_python("explorer.services.reading_process")
        self._process = subprocess.Popen(
            [*command, str(handle), str(self._memory)],
            pass_fds=(handle,),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=environment,
        )
        theirs.close()
        self._connection = ours
        try:
            ready = ours.poll(_START_SECONDS) and ours.recv_bytes() == READY
        except (EOFError, OSError):
            ready = False
        if not ready:
            self._end()
            raise InputError("the process that reads files does not start; start hpsop-explore again")
        return ours

    def _end(self) -> None:
        process, connection = self._process, self._connection
        self._process = self._connection = None
        if process is not None:
            process.kill()
            process.wait()
        if connection is not None:
            connection.close()
