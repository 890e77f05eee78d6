"""What stands in a run file, read through one connection, each record held against its checksum."""

from __future__ import annotations

import itertools
import sqlite3
import zlib
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from hpsop_core.runs.checksums import DamagedRunError, Tally, checked
from hpsop_core.runs.packing import unpack
from hpsop_core.runs.records import check_agreement
from hpsop_core.runs.schema import CHECKSUMS_SINCE, COLUMNS, RUN_KEYS, cells
from hpsop_core.runs.ship import LARGEST_FILE, ShipFile

_BETWEEN = 32  # records


class RunContent:
    """The records of a run file. Errors of a damaged file come out as they are: see ``checksums.damage_told``.

    Args:
        connection: to the file; closed by its owner.
        path: the file's name, for errors.
        version: its schema.
    """

    def __init__(self, connection: sqlite3.Connection, path: Path, version: int) -> None:
        self._connection = connection
        self._path = path
        self._version = version
        self._sealed = version >= CHECKSUMS_SINCE
        self._dictionary: bytes | None = None

    @property
    def sealed(self) -> bool:
        """Whether each record has a checksum: what was read of one is then what was written."""
        return self._sealed

    def values(self) -> dict[str, str]:
        """The table ``run``.

        Raises:
            DamagedRunError: a key is missing or a value is not what was written.
        """
        values = {str(key): str(value) for key, value in self.rows("run")}
        missing = [key for key in (*RUN_KEYS, *(("tally", "open") if self._sealed else ())) if key not in values]
        if missing:
            raise DamagedRunError(self._path, f"it has no '{missing[0]}'")
        if self._dictionary is None:
            self._dictionary = bytes.fromhex(values.get("dictionary", ""))
        return values

    def rows(
        self,
        table: str,
        condition: str = "",
        arguments: Sequence[Any] = (),
        checksums: list[int] | None = None,
        between: Callable[[], None] | None = None,
    ) -> Iterator[tuple[Any, ...]]:
        """Records of a table, with the columns of ``schema.COLUMNS``.

        Args:
            table: its name.
            condition: SQL after the table's name ("WHERE ... ORDER BY ...").
            arguments: of the condition.
            checksums: takes those of the records, in their order.
            between: called every millisecond or two of a long table, by whom something may be more urgent.

        Raises:
            DamagedRunError: a record is not what was written.
        """
        names = f"{cells(table, self._version)},{'checksum' if self._sealed else 'NULL'}"
        selected = self._connection.execute(f"SELECT {names} FROM {table} {condition}", arguments)
        for number, row in enumerate(selected, 1):
            if between is not None and number % _BETWEEN == 0:
                between()
            cells_of = checked(self._path, table, row)
            if checksums is not None:
                checksums.append(row[-1])
            yield cells_of

    def all_rows(self, table: str, between: Callable[[], None] | None = None) -> list[tuple[Any, ...]]:
        """Every record of a table, ascending in its first column; none may be missing. ``between`` as in ``rows``.

        Raises:
            DamagedRunError: one is missing, one too many, or not what was written.
        """
        checksums: list[int] = []
        rows = self.sorted_rows(table, checksums=checksums, between=between)
        if self._sealed:
            # Of what was read: a tree that holds a record twice gives good checksums.
            self.tally.check(self._path, table, checksums)
        return rows

    def sorted_rows(
        self,
        table: str,
        condition: str = "",
        arguments: Sequence[Any] = (),
        checksums: list[int] | None = None,
        between: Callable[[], None] | None = None,
    ) -> list[tuple[Any, ...]]:
        """As ``rows``, ascending in the table's first column.

        Raises:
            DamagedRunError: they are not, though SQLite was asked for it: the file's tree is not in order.
        """
        order = COLUMNS[table][0]
        rows = list(self.rows(table, f"{condition} ORDER BY {order}", arguments, checksums, between))
        if any(not one[0] <= two[0] for one, two in itertools.pairwise(rows)):
            raise DamagedRunError(self._path, f"its table '{table}' is not in order")
        return rows

    @cached_property
    def tally(self) -> Tally:
        """How many records there are; counted where an earlier version did not."""
        if self._sealed:
            return Tally.of_text(self.values()["tally"])
        counts = {
            table: int(self._connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0])
            for table in ("evaluations", "generations", "journal", "reference")
        }
        hand = "SELECT count(*) FROM evaluations WHERE origin = 'hand'"
        return Tally({**counts, "hand": int(self._connection.execute(hand).fetchone()[0])})

    @property
    def dictionary(self) -> bytes:
        """What the evaluations are packed with; it is there when an evaluation is, and never changes then."""
        if self._dictionary is None:
            self.values()
        if not self._dictionary:
            raise KeyError("dictionary")
        return self._dictionary

    def document(self, row: Sequence[Any]) -> dict[str, Any]:
        """The JSON of an evaluation.

        Raises:
            DamagedRunError: it contradicts its row.
        """
        record = dict(zip(COLUMNS["evaluations"], row, strict=True))
        document = unpack(record["result"], self.dictionary, record["variables"])
        check_agreement(self._path, record, document)
        return document

    def files(self) -> tuple[ShipFile, ...]:
        """The files of the case's own hull and propeller.

        Raises:
            DamagedRunError: the bytes are not those that were taken aboard.
        """
        if not self._sealed:
            return ()
        files = []
        for section, field, name, sha256, content in self.all_rows("files"):
            unpacker = zlib.decompressobj()
            file = ShipFile(section, field, name, unpacker.decompress(content, LARGEST_FILE + 1))
            if not unpacker.eof or file.sha256 != sha256:
                raise DamagedRunError(self._path, f"the file {name} that it holds is not the one that it was given")
            files.append(file)
        return tuple(files)
