"""The run file's tables and its version."""

from __future__ import annotations

import importlib.metadata
import platform
import re
import sqlite3
from functools import lru_cache
from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.runs.checksums import DamagedRunError

APPLICATION_ID = 0x48505350
"""Stands in the file's header, so that any tool can tell a run file from another SQLite file ("HPSP")."""

SCHEMA_VERSION = 4
OLDEST_SCHEMA = 2
"""The oldest version that is read; 1 was never published. 3 keeps more of the initial design's numbers in a reference
(an old one stays as it is: whoever reads it knows the three numbers that it has); 4 has checksums and files."""

CHECKSUMS_SINCE = 4

HAND_IDS_BEGIN = 1_000_000_001
"""Ids of designs made by hand begin here: the search's own ids count from 1 in the order asked, come what may."""


def initial_id(level: int) -> int:
    """The id that a run gives the initial design at a level (1 or 2), before the search's own ids begin.

    For the writer, who numbers designs. Readers ask for the design of the origin "initial" instead.
    """
    return level


FIRST_SEARCH_ID = 3
"""Ids of the search's own designs begin after the initial design's."""

COLUMNS: dict[str, tuple[str, ...]] = {
    "run": ("key", "value"),
    "files": ("section", "field", "name", "sha256", "content"),
    "reference": ("level", "data"),
    "evaluations": (
        "id",
        "level",
        "variables",
        "origin",
        "generation",
        "surface",
        "status",
        "stage",
        "reason",
        "feasible",
        "first_objective",
        "second_objective",
        "elapsed",
        "finished_at",
        "fingerprint",
        "result",
    ),
    "generations": ("number", "level", "data", "elapsed", "finished_at"),
    "journal": ("id", "at", "text"),
}
"""The tables' columns, in the order in which a record's checksum goes over them; each has "checksum" after these."""


def cells(table: str, version: int) -> str:
    """A table's columns for a SELECT; what a file of an earlier version has not stands at its only value."""
    return ",".join("0" if name == "surface" and version < CHECKSUMS_SINCE else name for name in COLUMNS[table])


RUN_KEYS = ("case", "case_name", "seeds", "generations", "versions", "created_at", "state", "reason")
"""What every run file has in its table ``run``; those with checksums also "tally" and "open"."""

_TABLES = """
CREATE TABLE run (key TEXT PRIMARY KEY, value TEXT NOT NULL, checksum INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE files (
    section TEXT NOT NULL,        -- of the case, and its field, that name the file
    field TEXT NOT NULL,
    name TEXT NOT NULL,           -- the file's own, without folder
    sha256 TEXT NOT NULL,         -- of its bytes
    content BLOB NOT NULL,        -- its bytes, deflated
    checksum INTEGER NOT NULL,
    PRIMARY KEY (section, field)
) WITHOUT ROWID;
CREATE TABLE reference (level INTEGER PRIMARY KEY, data TEXT NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE evaluations (
    id INTEGER PRIMARY KEY,
    level INTEGER NOT NULL,
    variables TEXT NOT NULL,      -- the design variables as JSON, every digit
    origin TEXT NOT NULL,         -- initial, sample, seed, offspring, handover, reseed, renewal, hand
    generation INTEGER NOT NULL,  -- that asked for it first; 0 is before all
    surface INTEGER NOT NULL,     -- 0: solved; n: predicted by the nth learnt surface
    status TEXT NOT NULL,
    stage TEXT NOT NULL,
    reason TEXT NOT NULL,
    feasible INTEGER NOT NULL,
    first_objective REAL,
    second_objective REAL,
    elapsed REAL NOT NULL,
    finished_at REAL NOT NULL,    -- seconds since 1970
    fingerprint INTEGER NOT NULL, -- of level, variables and surface
    result BLOB NOT NULL,         -- the evaluation's whole JSON, packed (packing.py)
    checksum INTEGER NOT NULL     -- of all cells before it (checksums.py), here and in the other tables
);
CREATE UNIQUE INDEX one_evaluation ON evaluations (fingerprint) WHERE origin <> 'hand';
CREATE INDEX failed_evaluations ON evaluations (status) WHERE status <> 'ok';
CREATE TABLE generations (
    number INTEGER PRIMARY KEY,
    level INTEGER NOT NULL,
    data TEXT NOT NULL,           -- members, front, indicators, choices as JSON
    elapsed REAL NOT NULL,
    finished_at REAL NOT NULL,
    checksum INTEGER NOT NULL
);
CREATE TABLE journal (id INTEGER PRIMARY KEY, at REAL NOT NULL, text TEXT NOT NULL, checksum INTEGER NOT NULL);
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


def schema_version(connection: sqlite3.Connection, path: Path) -> int:
    """The file's schema version; 0 for an empty file.

    Raises:
        InputError: another program's, or from a newer hpsop; one line that says which.
        DamagedRunError: its tables are not those of its version.
        sqlite3.Error: no SQLite file, or a damaged one (see ``checksums.damage_told``).
    """
    application = connection.execute("PRAGMA application_id").fetchone()[0]
    version = int(connection.execute("PRAGMA user_version").fetchone()[0])
    found = _declarations(connection)
    if application == 0 and not found:
        return 0
    if application != APPLICATION_ID:
        raise InputError(f"{path}: is a database of another program; choose another file")
    if version > SCHEMA_VERSION:
        raise InputError(
            f"{path}: was written by a newer hpsop (schema {version}, this one knows {SCHEMA_VERSION}); update hpsop"
        )
    if version < OLDEST_SCHEMA:
        raise InputError(f"{path}: has schema {version}, which this hpsop no longer reads; open it with an older hpsop")
    if version == SCHEMA_VERSION and found != _own_declarations():
        raise DamagedRunError(path, "its tables are not declared as they were")
    # A view in a table's place may be any computation.
    if any(kind == "view" for kind, _, _ in found):
        raise DamagedRunError(path, "it holds a view, which no run has")
    return version


def _declarations(connection: sqlite3.Connection) -> frozenset[tuple[str, str, str]]:
    """(kind, name, SQL in single spaces) of tables, indices and triggers."""
    rows = connection.execute("SELECT type, name, sql FROM sqlite_master WHERE sql IS NOT NULL").fetchall()
    return frozenset((str(kind), str(name), re.sub(r"\s+", " ", str(sql)).strip()) for kind, name, sql in rows)


@lru_cache(maxsize=1)
def _own_declarations() -> frozenset[tuple[str, str, str]]:
    connection = sqlite3.connect(":memory:", isolation_level=None)
    try:
        create_tables(connection)
        return _declarations(connection)
    finally:
        connection.close()
