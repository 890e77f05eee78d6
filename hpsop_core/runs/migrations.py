"""Lifting a run file of an earlier version to this one's tables, with every bit of its content."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from pathlib import Path
from typing import Any

from hpsop_core.runs.checksums import Tally, checksum, damage_told
from hpsop_core.runs.packing import unpack
from hpsop_core.runs.records import check_agreement
from hpsop_core.runs.schema import COLUMNS, OLDEST_SCHEMA, cells, create_tables


def lift(connection: sqlite3.Connection, path: Path) -> None:
    """Lift a file of schema 2 or 3 to the present one, all or nothing; what is read comes out the same.

    Its records get their checksums here: each is first read as a reader would, so that no damage is sealed.

    Raises:
        DamagedRunError: a record cannot be read.
        sqlite3.Error: the file cannot be written; it is as it was.
    """
    connection.execute("BEGIN IMMEDIATE")
    try:
        with damage_told(path):
            _check(connection, path)
        tables = [table for table in COLUMNS if table != "files"]
        for kind in ("trigger", "index"):
            names = connection.execute(
                "SELECT name FROM sqlite_master WHERE type = ? AND sql IS NOT NULL", (kind,)
            ).fetchall()
            for (name,) in names:
                connection.execute(f'DROP {kind} "{name}"')
        for table in tables:
            connection.execute(f"ALTER TABLE {table} RENAME TO old_{table}")
        create_tables(connection)
        tally = Tally()
        for table in tables:
            _copy(connection, table, tally)
        for key, value in (("tally", tally.text()), ("open", "")):
            connection.execute("INSERT INTO run VALUES (?, ?, ?)", (key, value, checksum("run", (key, value))))
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise
    # Half of its pages are empty now; that is no reason to refuse the file.
    with contextlib.suppress(sqlite3.Error):
        connection.execute("VACUUM")


def _check(connection: sqlite3.Connection, path: Path) -> None:
    dictionary = b""
    for row in connection.execute(f"SELECT {cells('evaluations', OLDEST_SCHEMA)} FROM evaluations"):
        record: dict[str, Any] = dict(zip(COLUMNS["evaluations"], row, strict=True))
        if not dictionary:
            found = connection.execute("SELECT value FROM run WHERE key = 'dictionary'").fetchone()
            dictionary = bytes.fromhex(found[0])
        check_agreement(path, record, unpack(record["result"], dictionary, record["variables"]))
    for (data,) in connection.execute("SELECT data FROM generations UNION ALL SELECT data FROM reference"):
        json.loads(data)


def _copy(connection: sqlite3.Connection, table: str, tally: Tally) -> None:
    columns = COLUMNS[table]
    marks = ",".join("?" * (len(columns) + 1))
    rows = connection.execute(f"SELECT {cells(table, OLDEST_SCHEMA)} FROM old_{table}")
    while block := rows.fetchmany(500):
        for row in block:
            value = checksum(table, row)
            connection.execute(f"INSERT INTO {table} VALUES ({marks})", (*row, value))
            if table == "run":
                continue
            tally.add(table, value)
            if table == "evaluations" and row[columns.index("origin")] == "hand":
                tally.counts["hand"] = tally.counts.get("hand", 0) + 1
    connection.execute(f"DROP TABLE old_{table}")
