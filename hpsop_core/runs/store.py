"""The run file, as its one writer sees it."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import sqlite3
import threading
import time
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate, Outcome
from hpsop_core.runs.checksums import Tally, checksum, damage_told
from hpsop_core.runs.connections import (
    begin_log,
    checkpoint,
    connect_writer,
    is_log_empty,
    log_path,
    real_path,
    without_room,
)
from hpsop_core.runs.content import RunContent
from hpsop_core.runs.lock import WriterLock, refuse_second_name
from hpsop_core.runs.migrations import lift
from hpsop_core.runs.packing import pack
from hpsop_core.runs.records import (
    fingerprint,
    generation_from_text,
    generation_text,
    generations_asked,
    json_text,
    variables_text,
)
from hpsop_core.runs.results import Result
from hpsop_core.runs.schema import (
    COLUMNS,
    HAND_IDS_BEGIN,
    SCHEMA_VERSION,
    create_tables,
    schema_version,
    software_versions,
)
from hpsop_core.runs.ship import ShipFile, named_files, read_files, refuse_changed_ship, with_files, with_names


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

    8. A record that is not what was written is said, never given back as a number: each has a checksum.
    9. The file alone holds the case, its hull and propeller files, and all but the generation under way (a copy of it
       too, if it was not made during the milliseconds of a checkpoint); its log is empty after each generation.

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
        InputError: no run and no case, not a run file, a newer schema, a second writer, a file whose log is lost
            before anything was in it, or a case that could not be read again.
        DamagedRunError: what stands in it was not written so.
    """

    def __init__(self, path: Path, case: Case | None = None, seeds: Sequence[DesignVariables] = ()) -> None:
        self.path = path
        self.created = False
        self._guard = threading.RLock()
        self._dictionary = b""
        self._real = real_path(path)
        self._had_log = os.path.lexists(log_path(self._real))
        if os.path.isdir(path):
            raise InputError(f"{path}: is a folder; name a file, for example {path / 'run.hpsop'}")
        self._lock = WriterLock(path)
        try:
            refuse_second_name(path)
            self._connection = self._opened(case, seeds)
            try:
                self._file = os.stat(self._real)
                with damage_told(path):
                    self._load()
            except BaseException:
                self._connection.close()
                raise
        except BaseException:
            self._leave_as_found()
            self._lock.release()
            raise

    def _opened(self, case: Case | None, seeds: Sequence[DesignVariables]) -> sqlite3.Connection:
        path = self.path
        missing = InputError(f"{path}: holds no run; start one with 'hpsop optimize CASE --run {path}'")
        lost = self._lost_log()
        if lost:
            raise InputError(lost)
        if case is None and not os.path.isfile(path):
            raise missing
        there = os.path.exists(self._real)
        connection = None
        try:
            with damage_told(path, "be written", "make room or choose another place"):
                connection = connect_writer(self._real)
                version = schema_version(connection, path)
                self.created = version == 0
                if version == 0:
                    if self._real.stat().st_size > 0:
                        raise InputError(
                            f"{path}: is a database without content: a copy of a run without its {path.name}-wal, "
                            "perhaps; copy both, or delete it to begin anew"
                        )
                    if case is None:
                        raise missing
                    _create(connection, case, seeds)
                elif version < SCHEMA_VERSION:
                    lift(connection, path)
                begin_log(connection)
        except BaseException:
            if connection is not None:
                connection.close()
            with contextlib.suppress(OSError):
                if not there and self._real.stat().st_size == 0:
                    self._real.unlink()
            raise
        return connection

    def _leave_as_found(self) -> None:
        """After an opening that failed: a log that this very opening made, and in which nothing stands, goes again."""
        if not self._had_log and is_log_empty(self._real):
            with contextlib.suppress(OSError):
                for suffix in ("-wal", "-shm"):
                    self._real.with_name(self._real.name + suffix).unlink(missing_ok=True)

    def _lost_log(self) -> str:
        """Why a new run must not begin here though there is no run: what is left of another one; else ""."""
        log = log_path(self._real)
        with contextlib.suppress(OSError):
            if log.stat().st_size > 0 and not (self._real.exists() and self._real.stat().st_size > 0):
                return (
                    f"{self.path}: is gone or empty, but {log.name} still holds evaluations of it; "
                    f"put the file back, or delete {log.name} to begin anew"
                )
        return ""

    def _load(self) -> None:
        content = RunContent(self._connection, self.path, SCHEMA_VERSION)
        values = content.values()
        self._tally = content.tally
        stored = case_from_toml(values["case"], str(self.path))
        self._files = content.files()
        self._case = with_files(stored, self._files)
        self._seeds = tuple(DesignVariables.from_dict(seed) for seed in json.loads(values["seeds"]))
        if not self._files:
            self._take_aboard(stored)
        if values["open"] and not self.created and not self._had_log:
            self.note(
                f"opened without its {self._real.name}-wal: what came after the last generation is computed again"
            )
        try:
            self.set_values(open="1")
        except StoreUnwritableError as error:
            raise InputError(f"{error}; make room or choose another place") from error
        self.checkpoint()

    def _take_aboard(self, case: Case) -> None:
        """A run of an earlier version named files elsewhere: from now on it holds them, if they are still the same.

        Raises:
            InputError: one is gone or was changed since the run was begun.
        """
        if not named_files(case):
            return
        row = next(self._content().rows("evaluations", "WHERE origin = 'initial' AND status = 'ok' LIMIT 1"), None)
        if row is not None:
            refuse_changed_ship(self.path, case, self._content().document(row))
        files = read_files(case)
        with self._writing() as connection:
            self._insert_files(connection, files)
            self._put_values(connection, {"case": with_names(case, files).to_toml()})
        self._files, self._case = files, with_files(case, files)

    def _content(self) -> RunContent:
        return RunContent(self._connection, self.path, SCHEMA_VERSION)

    def close(self) -> None:
        """Close the file and give the lock back; doing so twice does nothing."""
        with self._guard:
            # A disk that is full now must not keep the run from closing: the write-ahead log stays and is read again.
            with contextlib.suppress(sqlite3.Error, StoreUnwritableError):
                self.set_values(open="")
            with contextlib.suppress(sqlite3.Error):
                self._connection.close()
            self._lock.release()

    def checkpoint(self) -> None:
        """Bring what is in the log into the file itself; what readers hinder is done the next time."""
        with self._guard:
            checkpoint(self._connection)

    # -- what was asked --------------------------------------------------------------------------------------------

    @property
    def case(self) -> Case:
        """The exact case, its ``[optimization]`` as the run was started with."""
        return self._case

    @property
    def files(self) -> tuple[ShipFile, ...]:
        """The files of the case's own hull and propeller."""
        return self._files

    @property
    def seeds(self) -> tuple[DesignVariables, ...]:
        """Designs that the run was started from."""
        return self._seeds

    @property
    def generations(self) -> int:
        """Generations asked for in total, extensions included."""
        with damage_told(self.path):
            return generations_asked({"generations": self.value("generations")})

    def value(self, key: str, default: str = "") -> str:
        """A value of the run by its key."""
        with self._guard, damage_told(self.path):
            row = next(self._content().rows("run", "WHERE key = ?", (key,)), None)
        return default if row is None else str(row[1])

    def set_values(self, **values: str) -> None:
        """Set values of the run, all or none.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            self._put_values(connection, values)

    def note(self, text: str) -> None:
        """Add a line to the run's journal.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            last = connection.execute("SELECT max(id) FROM journal").fetchone()[0]
            self._insert(connection, "journal", (int(last or 0) + 1, time.time(), text))

    # -- references ------------------------------------------------------------------------------------------------

    def reference(self, level: int) -> str | None:
        """A level's reference as JSON text, or None if it is not stored yet."""
        with self._guard, damage_told(self.path):
            row = next(self._content().rows("reference", "WHERE level = ?", (level,)), None)
        return None if row is None else str(row[1])

    def record_reference(self, level: int, text: str) -> None:
        """Store a level's reference as JSON text.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            self._insert(connection, "reference", (level, text))

    # -- evaluations -----------------------------------------------------------------------------------------------

    def outcomes(self) -> dict[int, tuple[int, str, Outcome]]:
        """Every evaluation of the search by its id: (level, variables text, outcome)."""
        found = {}
        with self._guard, damage_told(self.path):
            content = self._content()
            for row in content.all_rows("evaluations"):
                record = dict(zip(COLUMNS["evaluations"], row, strict=True))
                if record["origin"] != "hand":
                    outcome = Outcome.from_json(record["id"], content.document(row))
                    found[record["id"]] = record["level"], record["variables"], outcome
        return found

    def documents(self, ids: Sequence[int]) -> list[dict[str, Any]]:
        """The JSON documents of evaluations, in the order given."""
        documents = []
        with self._guard, damage_told(self.path):
            content = self._content()
            for number in ids:
                row = next(content.rows("evaluations", "WHERE id = ?", (number,)), None)
                if row is None:
                    raise KeyError(number)
                documents.append(content.document(row))
        return documents

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

    def record_evaluation(self, number: int, candidate: Candidate, generation: int, result: Result) -> Outcome:
        """Store a finished evaluation of the search; when this returns, it is never lost.

        Args:
            number: its id.
            candidate: what was asked.
            generation: that asked for it.
            result: what it came to.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        return self.record_evaluations([(number, candidate, result)], generation)[0]

    def record_evaluations(self, results: Sequence[tuple[int, Candidate, Result]], generation: int) -> list[Outcome]:
        """Store finished evaluations of the search in one transaction: all of them, or none.

        Args:
            results: of each its id, what was asked, and what it came to.
            generation: that asked for them.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        with self._writing() as connection:
            for number, candidate, result in results:
                self._insert_evaluation(connection, number, candidate, generation, result)
        return [dataclasses.replace(result.outcome, evaluation_id=number) for number, _, result in results]

    def record_by_hand(self, evaluation: Evaluation) -> int:
        """Store a design that a person made; it never enters the search.

        Returns:
            Its id; the old one if the same design at the same level was made by hand before.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        text = variables_text(evaluation.variables)
        candidate = Candidate(evaluation.level, evaluation.variables, "hand")
        result = Result.of(evaluation.as_dict())
        with self._writing() as connection:
            row = connection.execute(
                "SELECT id FROM evaluations WHERE id >= ? AND level = ? AND variables = ?",
                (HAND_IDS_BEGIN, evaluation.level, text),
            ).fetchone()
            if row is not None:
                return int(row[0])
            last = connection.execute("SELECT max(id) FROM evaluations WHERE origin = 'hand'").fetchone()[0]
            number = HAND_IDS_BEGIN if last is None else int(last) + 1
            self._insert_evaluation(connection, number, candidate, 0, result)
        return number

    # -- generations -----------------------------------------------------------------------------------------------

    def generation(self, number: int) -> Generation | None:
        """A finished generation, or None."""
        with self._guard, damage_told(self.path):
            row = next(self._content().rows("generations", "WHERE number = ?", (number,)), None)
            return None if row is None else generation_from_text(row[2])

    def generation_times(self) -> list[tuple[int, float]]:
        """(level, wall time in s) of every finished generation, in order."""
        with self._guard, damage_told(self.path):
            rows = self._content().all_rows("generations")
        return [(int(level), float(elapsed)) for _, level, _, elapsed, _ in rows]

    def record_generation(self, generation: Generation, elapsed: float) -> None:
        """Store a finished generation, and bring all that there is into the file itself.

        Raises:
            StoreUnwritableError: the file cannot be written.
        """
        row = (int(generation.number), int(generation.level), generation_text(generation), float(elapsed), time.time())
        with self._writing() as connection:
            self._insert(connection, "generations", row)
        self.checkpoint()

    # -- writing ---------------------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        with self._guard:
            self._check_file()
            connection = self._connection
            before = self._tally.copy()
            try:
                connection.execute("BEGIN IMMEDIATE")
                yield connection
                if self._tally != before:
                    self._put_values(connection, {"tally": self._tally.text()})
                connection.execute("COMMIT")
            except BaseException as error:
                self._tally = before
                self._dictionary = b""  # what this write would have brought is gone with it
                if connection.in_transaction:
                    with contextlib.suppress(sqlite3.Error):
                        connection.execute("ROLLBACK")
                if isinstance(error, sqlite3.DatabaseError) and not isinstance(
                    error, (sqlite3.IntegrityError, sqlite3.ProgrammingError)
                ):
                    full = without_room(self.path, error)
                    raise StoreUnwritableError(f"{self.path}: {full or error}") from error
                raise

    def _check_file(self) -> None:
        # SQLite goes on writing to a file that has lost its name, and all would be gone at the end.
        try:
            there = os.stat(self._real)
        except OSError as error:
            raise StoreUnwritableError(f"{self.path}: the file is gone ({error.strerror}); put it back") from error
        if (there.st_ino, there.st_dev) != (self._file.st_ino, self._file.st_dev):
            raise StoreUnwritableError(f"{self.path}: another file stands in its place; put the run's own back")
        if there.st_size < self._file.st_size:
            # A run file never shrinks.
            raise StoreUnwritableError(
                f"{self.path}: was cut short by another program (from {self._file.st_size} to {there.st_size} bytes); "
                "what is left cannot be trusted: stop this run and start it anew in another file"
            )
        self._file = there

    def _put_values(self, connection: sqlite3.Connection, values: dict[str, str]) -> None:
        connection.executemany(
            "INSERT OR REPLACE INTO run VALUES (?, ?, ?)",
            [(key, value, checksum("run", (key, value))) for key, value in values.items()],
        )

    def _insert(self, connection: sqlite3.Connection, table: str, row: tuple[Any, ...]) -> None:
        value = checksum(table, row)
        connection.execute(f"INSERT INTO {table} VALUES ({','.join('?' * (len(row) + 1))})", (*row, value))
        self._tally.add(table, value)

    def _insert_files(self, connection: sqlite3.Connection, files: Sequence[ShipFile]) -> None:
        for file in files:
            row = (file.section, file.field, file.name, file.sha256, zlib.compress(file.content, 6))
            self._insert(connection, "files", row)

    def _insert_evaluation(
        self, connection: sqlite3.Connection, number: int, candidate: Candidate, generation: int, result: Result
    ) -> None:
        # Remembered once it is read from the file: a write that fails takes its dictionary along.
        self._dictionary = self._dictionary or bytes.fromhex(self.value("dictionary"))
        dictionary = self._dictionary or result.essence
        if not self._dictionary:
            self._put_values(connection, {"dictionary": dictionary.hex()})
        text = variables_text(candidate.variables)
        surface = candidate.surface if result.outcome.predicted else 0
        first, second = result.outcome.objectives or (None, None)
        row = (
            int(number),
            int(candidate.level),
            text,
            candidate.origin,
            int(generation),
            int(surface),
            result.status,
            result.stage,
            result.reason,
            int(result.feasible),
            first,
            second,
            result.elapsed,
            time.time(),
            fingerprint(candidate.level, text, surface),
            pack(result.essence, dictionary),
        )
        self._insert(connection, "evaluations", row)
        if candidate.origin == "hand":
            self._tally.counts["hand"] = self._tally.counts.get("hand", 0) + 1


def _create(connection: sqlite3.Connection, case: Case, seeds: Sequence[DesignVariables]) -> None:
    """All of a new run in one transaction: a kill leaves an empty file or a run.

    Raises:
        InputError: the case or one of its files would not be read again.
    """
    files = read_files(case)
    named = with_names(case, files)
    text = named.to_toml()
    if case_from_toml(text, named.name) != named:
        raise InputError(f"{named.name[:60]}: the case would not be the same when it is read again; simplify its texts")
    values = {
        "case": text,
        "case_name": case.name,
        "seeds": json_text([seed.as_dict() for seed in seeds]),
        "generations": str(case.optimization.generations),
        "versions": json_text(software_versions()),
        "created_at": repr(time.time()),
        "state": "new",
        "reason": "",
        "open": "1",
    }
    connection.execute("BEGIN IMMEDIATE")
    try:
        create_tables(connection)
        tally = Tally()
        for file in files:
            row = (file.section, file.field, file.name, file.sha256, zlib.compress(file.content, 6))
            value = checksum("files", row)
            connection.execute("INSERT INTO files VALUES (?, ?, ?, ?, ?, ?)", (*row, value))
            tally.add("files", value)
        values["tally"] = tally.text()
        for key, text in values.items():
            connection.execute("INSERT INTO run VALUES (?, ?, ?)", (key, text, checksum("run", (key, text))))
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise
