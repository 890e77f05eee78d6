"""The run file, as its one writer sees it."""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.runs.lock import WriterLock
from hpsop_core.runs.packing import dictionary_of, pack, unpack
from hpsop_core.runs.records import fingerprint, generation_from_text, generation_text, json_text, variables_text
from hpsop_core.runs.schema import (
    HAND_IDS_BEGIN,
    connect_writer,
    create_tables,
    migrate,
    schema_version,
    software_versions,
)


class StoreUnwritableError(HpsopError):
    """The file cannot be written just now (disk full, read-only, gone); the same write may be tried again later."""


class RunStore:
    """One run in one SQLite file (WAL), open for writing. What it promises:

    1. A finished evaluation is never lost. Once ``record_evaluation`` has returned, no kill of any process takes it
       back; what was half written when the kill came is not in the file at all. (A power failure may take the last few
       evaluations, never the file: they are computed again.)
    2. A finished evaluation or generation is never changed or deleted; the file itself refuses it.
    3. The search's evaluations are numbered from 1 in the order asked, and each (level, variables) stands there once.
       Designs made by hand have numbers of their own and never mix with them.
    4. There is one writer. A second one is refused and told who the first one is; a writer that was killed leaves no
       lock behind.
    5. Readers read while it is written (``RunReader``): they never wait for the writer nor make it wait, and see a
       generation whole or not at all.
    6. A write that fails raises ``StoreUnwritableError`` and leaves the file as it was; it may be tried again.
    7. An older file opens, or the refusal says why not. A file of another program is never touched.

    The file holds the exact case, the seeds, software versions, references, evaluations, generations, and a journal of
    what happened to the run. Every number comes back with every digit. Keep it on a local disk: the locks of network
    file systems do not keep these promises.

    Args:
        path: the file. One that holds a run is opened as it is.
        case: begins a new run where there is none yet (no file, or an empty one).
        seeds: of a new run: designs to start from.

    Attributes:
        created: whether the run was begun by this very call.

    Raises:
        InputError: no run and no case, not a run file, a newer schema, or a second writer.
    """

    def __init__(self, path: Path, case: Case | None = None, seeds: Sequence[DesignVariables] = ()) -> None:
        self.path = path
        self.created = False
        self._guard = threading.RLock()
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file, for example {path / 'run.hpsop'}")
        self._lock = WriterLock(path)
        try:
            self._connection = self._opened(case, seeds)
            self._file = os.stat(path)
            self._case = case_from_toml(self.value("case"), str(path))
            self._seeds = tuple(DesignVariables.from_dict(seed) for seed in json.loads(self.value("seeds")))
        except BaseException:
            self._lock.release()
            raise

    def _opened(self, case: Case | None, seeds: Sequence[DesignVariables]) -> sqlite3.Connection:
        path = self.path
        missing = InputError(f"{path}: holds no run; start one with 'hpsop optimize CASE --run {path}'")
        if case is None and not path.is_file():
            raise missing
        try:
            connection = sqlite3.connect(path, isolation_level=None)
            version = schema_version(connection, path)
            connection.close()
            self.created = version == 0
            if version > 0:
                connection = connect_writer(path)
                migrate(connection, version)
            elif case is None:
                raise missing
            else:
                connection = connect_writer(path)
                _create(connection, case, seeds)
        except sqlite3.Error as error:
            raise InputError(f"{path}: cannot be written ({error}); make room or choose another place") from error
        return connection

    def close(self) -> None:
        """Close the file and give the lock back; doing so twice does nothing."""
        with self._guard:
            # A disk that is full now must not keep the run from closing: the write-ahead log stays and is read again.
            with contextlib.suppress(sqlite3.Error):
                self._connection.close()
            self._lock.release()

    # -- what was asked --------------------------------------------------------------------------------------------

    @property
    def case(self) -> Case:
        """The exact case, its ``[optimization]`` as the run was started with."""
        return self._case

    @property
    def seeds(self) -> tuple[DesignVariables, ...]:
        """Designs that the run was started from."""
        return self._seeds

    @property
    def generations(self) -> int:
        """Generations asked for in total, extensions included."""
        return int(self.value("generations"))

    def value(self, key: str, default: str = "") -> str:
        """A value of the run by its key."""
        with self._guard:
            row = self._connection.execute("SELECT value FROM run WHERE key = ?", (key,)).fetchone()
        return default if row is None else str(row[0])

    def set_values(self, **values: str) -> None:
        """Set values of the run, all or none.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            for key, value in values.items():
                connection.execute("INSERT OR REPLACE INTO run VALUES (?, ?)", (key, value))

    def note(self, text: str) -> None:
        """Add a line to the run's journal.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            connection.execute("INSERT INTO journal (at, text) VALUES (?, ?)", (time.time(), text))

    # -- references ------------------------------------------------------------------------------------------------

    def reference(self, level: int) -> str | None:
        """A level's reference as JSON text, or None if it is not stored yet."""
        with self._guard:
            row = self._connection.execute("SELECT data FROM reference WHERE level = ?", (level,)).fetchone()
        return None if row is None else str(row[0])

    def record_reference(self, level: int, text: str) -> None:
        """Store a level's reference as JSON text.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            connection.execute("INSERT INTO reference VALUES (?, ?)", (level, text))

    # -- evaluations -----------------------------------------------------------------------------------------------

    def outcomes(self) -> dict[tuple[int, str], Outcome]:
        """Every evaluation of the search by (level, variables text)."""
        with self._guard:
            rows = self._connection.execute(
                "SELECT level, variables, id, result FROM evaluations WHERE origin <> 'hand'"
            ).fetchall()
            dictionary = bytes.fromhex(self.value("dictionary"))
        return {
            (level, text): Outcome.from_json(number, unpack(result, dictionary, text))
            for level, text, number, result in rows
        }

    def elapsed_of(self, number: int) -> float | None:
        """How long an evaluation took in s, or None if there is none of that number."""
        with self._guard:
            row = self._connection.execute("SELECT elapsed FROM evaluations WHERE id = ?", (number,)).fetchone()
        return None if row is None else float(row[0])

    def failure_of(self, number: int) -> str:
        """Stage and reason of a failed evaluation; "" for any other."""
        with self._guard:
            row = self._connection.execute(
                "SELECT stage, reason FROM evaluations WHERE id = ? AND status <> 'ok'", (number,)
            ).fetchone()
        return "" if row is None else f"{row[0]}: {row[1]}"

    def record_evaluation(self, number: int, candidate: Candidate, generation: int, result: str) -> Outcome:
        """Store a finished evaluation of the search; when this returns, it is never lost.

        Args:
            number: its id.
            candidate: what was asked.
            generation: that asked for it.
            result: the evaluation's JSON text.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        data = json.loads(result)
        with self._writing() as connection:
            variables, origin = candidate.variables, candidate.origin
            _insert(connection, number, candidate.level, variables, origin, generation, data)
        return Outcome.from_json(number, data)

    def record_by_hand(self, evaluation: Evaluation) -> int:
        """Store a design that a person made; it never enters the search.

        Returns:
            Its id; the old one if the same design at the same level was made by hand before.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        text = variables_text(evaluation.variables)
        data = evaluation.as_dict()
        with self._writing() as connection:
            row = connection.execute(
                "SELECT id FROM evaluations WHERE id >= ? AND level = ? AND variables = ?",
                (HAND_IDS_BEGIN, evaluation.level, text),
            ).fetchone()
            if row is not None:
                return int(row[0])
            last = connection.execute("SELECT max(id) FROM evaluations WHERE origin = 'hand'").fetchone()[0]
            number = HAND_IDS_BEGIN if last is None else int(last) + 1
            _insert(connection, number, evaluation.level, evaluation.variables, "hand", 0, data)
        return number

    # -- generations -----------------------------------------------------------------------------------------------

    def generation(self, number: int) -> Generation | None:
        """A finished generation, or None."""
        with self._guard:
            row = self._connection.execute("SELECT data FROM generations WHERE number = ?", (number,)).fetchone()
        return None if row is None else generation_from_text(row[0])

    def generation_times(self) -> list[tuple[int, float]]:
        """(level, wall time in s) of every finished generation, in order."""
        with self._guard:
            rows = self._connection.execute("SELECT level, elapsed FROM generations ORDER BY number").fetchall()
        return [(int(level), float(elapsed)) for level, elapsed in rows]

    def record_generation(self, generation: Generation, elapsed: float) -> None:
        """Store a finished generation.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        row = (generation.number, generation.level, generation_text(generation), elapsed, time.time())
        with self._writing() as connection:
            connection.execute("INSERT INTO generations VALUES (?, ?, ?, ?, ?)", row)

    # -- writing ---------------------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        with self._guard:
            self._check_file()
            connection = self._connection
            try:
                connection.execute("BEGIN IMMEDIATE")
                yield connection
                connection.execute("COMMIT")
            except BaseException as error:
                if connection.in_transaction:
                    with contextlib.suppress(sqlite3.Error):
                        connection.execute("ROLLBACK")
                if isinstance(error, sqlite3.OperationalError):
                    raise StoreUnwritableError(f"{self.path}: {error}") from error
                raise

    def _check_file(self) -> None:
        # SQLite goes on writing to a file that has lost its name, and all would be gone at the end.
        try:
            there = os.stat(self.path)
        except OSError as error:
            raise StoreUnwritableError(f"{self.path}: the file is gone ({error.strerror})") from error
        if (there.st_ino, there.st_dev) != (self._file.st_ino, self._file.st_dev):
            raise StoreUnwritableError(f"{self.path}: another file stands in its place")


def _create(connection: sqlite3.Connection, case: Case, seeds: Sequence[DesignVariables]) -> None:
    values = {
        "case": case.to_toml(),
        "case_name": case.name,
        "seeds": json_text([seed.as_dict() for seed in seeds]),
        "generations": str(case.optimization.generations),
        "versions": json_text(software_versions()),
        "created_at": repr(time.time()),
        "state": "new",
        "reason": "",
    }
    connection.execute("BEGIN IMMEDIATE")
    try:
        create_tables(connection)
        connection.executemany("INSERT INTO run VALUES (?, ?)", values.items())
        connection.execute("COMMIT")
    except sqlite3.Error:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


def _insert(
    connection: sqlite3.Connection,
    number: int,
    level: int,
    variables: DesignVariables,
    origin: str,
    generation: int,
    data: dict[str, Any],
) -> None:
    found = connection.execute("SELECT value FROM run WHERE key = 'dictionary'").fetchone()
    dictionary = dictionary_of(data) if found is None else bytes.fromhex(found[0])
    if found is None:
        connection.execute("INSERT INTO run VALUES ('dictionary', ?)", (dictionary.hex(),))
    text = variables_text(variables)
    row = (
        number,
        level,
        text,
        origin,
        generation,
        data["status"],
        data.get("stage", ""),
        data["reason"],
        int(data["feasible"]),
        data["objectives"]["f1"],
        data["objectives"]["f2"],
        data["elapsed"],
        time.time(),
        fingerprint(level, text),
        pack(data, dictionary),
    )
    connection.execute(f"INSERT INTO evaluations VALUES ({','.join('?' * len(row))})", row)
