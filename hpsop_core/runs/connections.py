"""How a run file is opened, for writing and for reading, and what stands beside it."""

from __future__ import annotations

import contextlib
import errno
import os
import sqlite3
import tempfile
import time
from pathlib import Path
from urllib.parse import quote

from hpsop_core.errors import InputError

_LONGEST_CELL = 256 * 2**20  # bytes; a cell that claims more would be memory for nothing
_PAGE_SIZE = 16384
_ROOM = 65536  # bytes: what SQLite wants beside a file before it reads or writes a first word of it
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def real_path(path: Path) -> Path:
    """The file itself where ``path`` is a symbolic link: its companions (``-wal``, ``.lock``) stand beside it.

    Raises:
        InputError: a path that no file can have, or links in a circle.
    """
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{str(path)[:200]!r}: is no path to a file ({error}); choose another name") from error


def log_path(path: Path) -> Path:
    """SQLite's write-ahead log of a run file; ``path`` must be the real one."""
    return path.with_name(path.name + "-wal")


def is_log_empty(path: Path) -> bool:
    """Whether the log of a run file, if it has one, holds nothing."""
    try:
        return log_path(path).stat().st_size == 0
    except OSError:
        return True


def connect_writer(path: Path) -> sqlite3.Connection:
    """A connection that may write; the caller holds the writer's lock. Not yet in WAL mode: see ``begin_log``."""
    connection = sqlite3.connect(path, timeout=10.0, isolation_level=None, check_same_thread=False)
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LONGEST_CELL)
    # Only a new file obeys: on the usual 4096 bytes an evaluation of 1 kB would leave a quarter of every page empty.
    connection.execute(f"PRAGMA page_size = {_PAGE_SIZE}")
    # NORMAL: a commit is in the kernel's hands when it returns, so no kill of the process loses it; only a power
    # failure may take the last few (never the file).
    connection.execute("PRAGMA synchronous = NORMAL")
    _trust_nothing(connection)
    return connection


def begin_log(connection: sqlite3.Connection) -> None:
    """Write ahead from now on: readers see whole generations while the run is written.

    Only when the tables are there: a file that is in WAL mode and holds nothing has lost its log.
    """
    connection.execute("PRAGMA journal_mode = WAL")
    # The run checkpoints at each generation; this is for generations of a thousand designs.
    connection.execute("PRAGMA wal_autocheckpoint = 256")


def checkpoint(connection: sqlite3.Connection) -> None:
    """Bring the log into the file and empty it, as far as readers allow just now; never waits for one, never fails."""
    with contextlib.suppress(sqlite3.Error):
        connection.execute("PRAGMA busy_timeout = 0")
        row = connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        if row is not None and row[0]:
            connection.execute("PRAGMA wal_checkpoint(PASSIVE)")
    with contextlib.suppress(sqlite3.Error):
        connection.execute("PRAGMA busy_timeout = 10000")


def without_room(path: Path, error: sqlite3.Error) -> str:
    """Why there is no room for a file that SQLite could not read or write: of a full disk it says "disk I/O error".

    Args:
        path: of the run file.
        error: SQLite's.

    Returns:
        The words, or "" where the reason is another one.
    """
    name = getattr(error, "sqlite_errorname", "")
    if name == "SQLITE_FULL":
        return "its disk is full"
    if name.startswith("SQLITE_IOERR"):
        try:
            with tempfile.TemporaryFile(dir=real_path(path).parent) as file:
                os.posix_fallocate(file.fileno(), 0, _ROOM)
        except OSError as problem:
            if problem.errno in _NO_ROOM:
                return f"its disk is full ({problem.strerror})"
    return ""


def connect_reader(path: Path) -> sqlite3.Connection:
    """A connection that never writes, also where the folder is read-only.

    Args:
        path: the real path (``real_path``).

    Raises:
        InputError: there is no such file.
    """
    if not os.path.isfile(path):
        if os.path.isdir(path) or not os.path.lexists(path):
            raise InputError(f"{path}: no such run file; start one with 'hpsop optimize CASE --run {path}'")
        raise InputError(f"{path}: is no regular file; choose another file")
    attempts = 3
    while True:
        address = f"file:{quote(str(path))}?mode=ro"
        # What a writer leaves that found no room is an empty log, and then there is none for a reader's side files.
        nothing = not log_path(path).exists() or (attempts == 1 and is_log_empty(path))
        if nothing and not path.with_name(path.name + "-journal").exists():
            # Nobody has it open for writing. Without this flag SQLite would want to make side files for a WAL file,
            # which fails in a read-only folder and leaves litter in any other.
            address += "&immutable=1"
        connection = sqlite3.connect(address, uri=True, timeout=10.0, isolation_level=None, check_same_thread=False)
        connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LONGEST_CELL)
        try:
            connection.execute("PRAGMA schema_version").fetchone()
            _trust_nothing(connection)
            return connection
        except sqlite3.OperationalError:
            # The writer has just come or gone, between our look at its log and our opening of the file.
            connection.close()
            attempts -= 1
            if attempts == 0:
                raise
            time.sleep(0.05)
        except sqlite3.DatabaseError:
            return connection  # no database at all: the caller asks and hears it again, with the words for people


def _trust_nothing(connection: sqlite3.Connection) -> None:
    connection.execute("PRAGMA trusted_schema = OFF")
    connection.execute("PRAGMA cell_size_check = ON")
