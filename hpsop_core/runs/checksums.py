"""A checksum for each record of a run file, and a tally of all: a flipped bit or a lost record is found.

Not a signature: whoever wants to forge a run can. It is for disks, cables and half copies.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import sqlite3
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from hpsop_core.errors import HpsopError, InputError
from hpsop_core.runs.connections import without_room

Cell: TypeAlias = "int | float | str | bytes | None"

_MODULUS = 2**62  # sums of checksums stay within SQLite's integers


class DamagedRunError(InputError):
    """A run file whose content is not what was written into it."""

    def __init__(self, path: Path, what: str) -> None:
        super().__init__(
            f"{path}: is damaged ({what}); take an undamaged copy, or run the case anew: "
            "the same case and seed give the same numbers"
        )


def checksum(table: str, row: Sequence[Cell]) -> int:
    """64 bits of a record, as a signed integer: BLAKE2b over its table's name and its cells.

    Args:
        table: where it stands: the same cells in another table have another checksum.
        row: every cell but the checksum, in the table's order, as SQLite gives them back.
    """
    digest = hashlib.blake2b(digest_size=8)
    # JSON of Python's floats has every digit; a blob stands for itself, with its length among the other cells.
    cells = [len(cell) if isinstance(cell, bytes) else cell for cell in row]
    digest.update(json.dumps([table, cells]).encode())
    for cell in row:
        if isinstance(cell, bytes):
            digest.update(cell)
    return int.from_bytes(digest.digest(), "big", signed=True)


def checked(path: Path, table: str, row: Sequence[Any]) -> tuple[Any, ...]:
    """The record without its checksum, which is its last cell; None there is a record of an earlier version, without.

    Raises:
        DamagedRunError: it does not match.
    """
    cells, found = tuple(row[:-1]), row[-1]
    if found is not None and found != checksum(table, cells):
        raise DamagedRunError(path, f"a record of its table '{table}' does not match its checksum")
    return cells


@dataclass
class Tally:
    """How many records each table has, and the sum of their checksums: kept in the file, changed with every record.

    Attributes:
        counts: records by table; designs made by hand are counted as "hand" beside "evaluations".
        sums: of their checksums, by table.
    """

    counts: dict[str, int] = field(default_factory=dict)
    sums: dict[str, int] = field(default_factory=dict)

    def add(self, table: str, value: int) -> None:
        """One more record with this checksum."""
        self.counts[table] = self.counts.get(table, 0) + 1
        self.sums[table] = (self.sums.get(table, 0) + value) % _MODULUS

    def copy(self) -> Tally:
        """A tally that may change without this one."""
        return Tally(dict(self.counts), dict(self.sums))

    def text(self) -> str:
        """As it stands in the file."""
        return json.dumps({"counts": self.counts, "sums": self.sums}, separators=(",", ":"), sort_keys=True)

    @classmethod
    def of_text(cls, text: str) -> Tally:
        """The tally that ``text`` wrote."""
        data = json.loads(text)
        return cls(
            {str(k): int(v) for k, v in data["counts"].items()}, {str(k): int(v) for k, v in data["sums"].items()}
        )

    def check(self, path: Path, table: str, values: Sequence[int]) -> None:
        """Whether these are the checksums of all records of a table.

        Raises:
            DamagedRunError: one is missing, or one too many.
        """
        expected = self.counts.get(table, 0)
        if len(values) != expected:
            raise DamagedRunError(path, f"its table '{table}' has {len(values)} records instead of {expected}")
        if sum(values) % _MODULUS != self.sums.get(table, 0):
            raise DamagedRunError(path, f"its table '{table}' holds other records than were written")


@contextlib.contextmanager
def damage_told(
    path: Path, cannot: str = "be read as a run file", remedy: str = "choose another file"
) -> Iterator[None]:
    """Whatever goes wrong with a file's content becomes one line for people.

    Args:
        path: of the file.
        cannot, remedy: what SQLite's own errors hinder, and what to do.

    Raises:
        InputError: not a database, or one that cannot be read just now.
        DamagedRunError: anything that a sound run file cannot cause.
    """
    try:
        yield
    except HpsopError:
        raise
    except sqlite3.Error as error:
        full = without_room(path, error)
        if full:
            raise InputError(f"{path}: cannot {cannot}: {full}; make room there, or use another disk") from error
        # Of a text that is none it quotes all.
        raise InputError(f"{path}: cannot {cannot} ({_one_line(error)}); {remedy}") from error
    except MemoryError as error:
        raise DamagedRunError(path, "a record is larger than any can be") from error
    except RecursionError as error:
        raise DamagedRunError(path, "a record is nested deeper than any can be") from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error, zlib.error) as error:
        # ValueError: also of JSON and of texts that are no UTF-8
        raise DamagedRunError(path, f"{type(error).__name__}: {_one_line(error)}") from error


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split())[:100]
