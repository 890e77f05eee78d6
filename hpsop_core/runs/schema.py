"""The run file's tables, its version, and how its connections are opened."""

from __future__ import annotations

import importlib.metadata
import platform
import sqlite3
import time
from pathlib import Path
from urllib.parse import quote

from hpsop_core.errors import InputError

APPLICATION_ID = 0x48505350
"""Stands in the file's header, so that any tool can tell a run file from another SQLite file ("HPSP")."""

SCHEMA_VERSION = 3

HAND_IDS_BEGIN = 1_000_000_001
"""Ids of designs made by hand begin here: the search's own ids count from 1 in the order asked, come what may."""


def initial_id(level: int) -> int:
    """The id that a run gives the initial design at a level (1 or 2), before the search's own ids begin.

    For the writer, who numbers designs. Readers ask for the design of the origin "initial" instead.
    """
    return level


FIRST_SEARCH_ID = 3
"""Ids of the search's own designs begin after the initial design's."""

# How to lift a file from an older schema, by the version it has. Version 1 was never published.
MIGRATIONS: dict[int, str] = {
    # 3 keeps more of the initial design's numbers in a reference. An old reference stays as it is: whoever reads it
    # knows the three numbers that it has.
    2: "SELECT 1",
}

_TABLES = """
CREATE TABLE run (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE reference (level INTEGER PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE evaluations (
    id INTEGER PRIMARY KEY,
    level INTEGER NOT NULL,
    variables TEXT NOT NULL,      -- the nine variables as JSON, every digit
    origin TEXT NOT NULL,         -- initial, sample, seed, offspring, handover, reseed, hand
    generation INTEGER NOT NULL,  -- that asked for it first; 0 is before all
    status TEXT NOT NULL,
    stage TEXT NOT NULL,
    reason TEXT NOT NULL,
    feasible INTEGER NOT NULL,
    first_objective REAL,
    second_objective REAL,
    elapsed REAL NOT NULL,
    finished_at REAL NOT NULL,    -- seconds since 1970
    fingerprint INTEGER NOT NULL, -- of level and variables
    result BLOB NOT NULL          -- the evaluation's whole JSON, packed (packing.py)
);
CREATE UNIQUE INDEX one_evaluation ON evaluations (fingerprint) WHERE origin <> 'hand';
CREATE INDEX failed_evaluations ON evaluations (status) WHERE status <> 'ok';
CREATE TABLE generations (
    number INTEGER PRIMARY KEY,
    level INTEGER NOT NULL,
    data TEXT NOT NULL,           -- members, front, indicators, choices as JSON
    elapsed REAL NOT NULL,
    finished_at REAL NOT NULL
);
CREATE TABLE journal (id INTEGER PRIMARY KEY, at REAL NOT NULL, text TEXT NOT NULL);
CREATE TRIGGER evaluations_stay BEFORE UPDATE ON evaluations
    BEGIN SELECT RAISE(ABORT, 'a finished evaluation is never changed'); END;
CREATE TRIGGER evaluations_remain BEFORE DELETE ON evaluations
    BEGIN SELECT RAISE(ABORT, 'a finished evaluation is never deleted'); END;
CREATE TRIGGER generations_stay BEFORE UPDATE ON generations
    BEGIN SELECT RAISE(ABORT, 'a finished generation is never changed'); END;
CREATE TRIGGER generations_remain BEFORE DELETE ON generations
    BEGIN SELECT RAISE(ABORT, 'a finished generation is never deleted'); END;
"""


def software_versions() -> dict[str, str]:
    """What the bits of a run depend on: hpsop, the libraries, Python, the platform."""
    versions = {name: importlib.metadata.version(name) for name in ("numpy", "scipy", "pymoo")}
    try:
        versions["hpsop"] = importlib.metadata.version("hpsop")
    except importlib.metadata.PackageNotFoundError:
        # Run from a checkout that was never installed.
        from hpsop_core.version import __version__

        versions["hpsop"] = __version__
    versions["python"] = platform.python_version()
    versions["platform"] = f"{platform.system()} {platform.machine()}"
    return versions


def create_tables(connection: sqlite3.Connection) -> None:
    """Make the tables, inside the caller's transaction."""
    # executescript would commit the caller's transaction; a trigger's body holds semicolons of its own.
    statement = ""
    for line in _TABLES.splitlines():
        statement += line.split("--")[0] + "\n"
        if sqlite3.complete_statement(statement):
            connection.execute(statement)
            statement = ""
    connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")


def connect_writer(path: Path) -> sqlite3.Connection:
    """A connection that may write; the caller holds the writer's lock."""
    connection = sqlite3.connect(path, timeout=10.0, isolation_level=None, check_same_thread=False)
    # Only a new file obeys: on the usual 4096 bytes an evaluation of 1 kB would leave a quarter of every page empty.
    connection.execute("PRAGMA page_size = 16384")
    # WAL: readers see whole generations while the run is written. NORMAL: a commit is in the kernel's hands when it
    # returns, so no kill of the process loses it; only a power failure may take the last few (never the file).
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    return connection


def connect_reader(path: Path) -> sqlite3.Connection:
    """A connection that never writes, also where the folder is read-only.

    Raises:
        InputError: there is no such file.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such run file; start one with 'hpsop optimize CASE --run {path}'")
    attempts = 3
    while True:
        address = f"file:{quote(str(path.resolve()))}?mode=ro"
        if not path.with_name(path.name + "-wal").exists():
            # Nobody has it open for writing. Without this flag SQLite would want to make side files for a WAL file,
            # which fails in a read-only folder and leaves litter in any other.
            address += "&immutable=1"
        connection = sqlite3.connect(address, uri=True, timeout=10.0, isolation_level=None, check_same_thread=False)
        try:
            connection.execute("PRAGMA schema_version").fetchone()
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


def schema_version(connection: sqlite3.Connection, path: Path) -> int:
    """The file's schema version; 0 for an empty file.

    Raises:
        InputError: no SQLite file, another program's, or from a newer hpsop; one line that says which.
    """
    try:
        application = connection.execute("PRAGMA application_id").fetchone()[0]
        version = int(connection.execute("PRAGMA user_version").fetchone()[0])
        tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    except sqlite3.DatabaseError as error:
        raise InputError(f"{path}: cannot be read as a run file ({error}); choose another file") from error
    if application == 0 and tables == 0:
        return 0
    if application != APPLICATION_ID:
        raise InputError(f"{path}: is a database of another program; choose another file")
    if version > SCHEMA_VERSION:
        raise InputError(
            f"{path}: was written by a newer hpsop (schema {version}, this one knows {SCHEMA_VERSION}); update hpsop"
        )
    if any(step not in MIGRATIONS for step in range(version, SCHEMA_VERSION)):
        raise InputError(f"{path}: has schema {version}, which this hpsop no longer reads; open it with an older hpsop")
    return version


def migrate(connection: sqlite3.Connection, version: int) -> None:
    """Lift an older file to this schema, all or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        for step in range(version, SCHEMA_VERSION):
            connection.execute(MIGRATIONS[step])
        connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
        connection.execute("COMMIT")
    except sqlite3.Error:
        connection.execute("ROLLBACK")
        raise
