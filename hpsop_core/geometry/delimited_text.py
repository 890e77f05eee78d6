"""Tables as text the way people save them: encodings, separators, decimal commas, quotes, comments."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hpsop_core.errors import InputError, shown
from hpsop_core.reading import read_bytes

# A table of a ship is far smaller; what is larger is another kind of file.
LARGEST_TEXT = 64 * 1024 * 1024
COMMENT_MARKS = ("#", "%", "//", "!")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f]")
_FEET_INCHES_EIGHTHS = re.compile(r"\s*(\d+)\s*-\s*(\d{1,2})\s*-\s*(\d)\s*(\+|-)?\s*")


@dataclass(frozen=True)
class Line:
    """One line of a table: its number in the file (from 1) and its cells without blanks and quotes."""

    number: int
    cells: tuple[str, ...]


@dataclass(frozen=True)
class TextTable:
    """A delimited text, its lines split into cells.

    Attributes:
        name: of the file, for messages.
        lines: the lines that are neither blank nor comments; the first one is usually the header.
        comments: the comment lines without their marks.
        separator: between cells; " " stands for any run of blanks.
        decimal_comma: whether numbers are written with a comma.
        notes: what was noticed, one line each ("decimal commas", "Latin-1").
    """

    name: str
    lines: tuple[Line, ...]
    comments: tuple[Line, ...]
    separator: str
    decimal_comma: bool
    notes: tuple[str, ...]

    def number(self, cell: str) -> float:
        """The number in a cell; ValueError where there is none. May be NaN or infinite."""
        return float(cell.replace(",", ".")) if self.decimal_comma else float(cell)


def is_number(cell: str) -> bool:
    """Whether a cell holds a finite number, with a decimal point or a decimal comma."""
    try:
        return math.isfinite(float(cell.replace(",", ".")))
    except ValueError:
        return False


def feet_inches_eighths(cell: str) -> float:
    """Feet of a shipyard's notation "12-3-4" (12 ft 3 in and 4 eighths); a trailing + or - is a sixteenth of an inch.

    Raises:
        ValueError: another notation, or a part out of range.
    """
    match = _FEET_INCHES_EIGHTHS.fullmatch(cell)
    if match is None:
        raise ValueError(f"'{cell}' is not feet-inches-eighths")
    feet, inches, eighths = (int(match.group(k)) for k in (1, 2, 3))
    if inches > 11 or eighths > 7:
        raise ValueError(f"'{cell}' is not feet-inches-eighths")
    half = {None: 0.0, "+": 0.5, "-": -0.5}[match.group(4)]
    return feet + (inches + (eighths + half) / 8.0) / 12.0


def decoded(path: Path) -> tuple[str, tuple[str, ...]]:
    """The text of a file in UTF-8, UTF-16 or Latin-1, with or without a byte-order mark, and notes about it.

    Raises:
        InputError: unreadable, too large, or no text.
    """
    raw = read_bytes(path, LARGEST_TEXT, "a table as text")
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if raw.startswith(mark):
            encodings: Sequence[str] = (encoding,)
            break
    else:
        encodings = ("utf-8-sig", "cp1252")
    for encoding in encodings:
        try:
            text = raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        if _CONTROL.search(text):
            break
        return text, () if encoding == "utf-8-sig" else (f"encoded as {encoding}",)
    raise InputError(f"{path}: cannot be read: it is not a text file; give a table as CSV")


def _separator(lines: Sequence[str]) -> str:
    """What most lines are parted by; a comma in lines under a header without one is a decimal comma."""
    for candidate in (";", "\t", ","):
        if 2 * sum(candidate in line for line in lines) > len(lines):
            if candidate == "," and "," not in lines[0] and len(lines[0].split()) > 2:
                return " "
            return candidate
    return " "


def _cells(line: str, separator: str, tabs_run: bool) -> tuple[str, ...]:
    if separator == " ":
        return tuple(cell.strip("\"'") for cell in line.split())
    if tabs_run:
        return tuple(cell.strip().strip('"') for cell in re.split(r"\t+", line.strip("\t ")))
    try:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error as problem:
        raise InputError(f"the line that begins {shown(line)} cannot be read ({problem})") from problem
    return tuple(cell.strip() for cell in cells)


def read_text_table(path: Path) -> TextTable:
    """The cells of a text file.

    Separators are comma, semicolon, tab or blanks, or what a first line ``sep=;`` says. Lines that begin with #, %, !
    or // are comments. Decimal commas are understood where the separator is not a comma.

    Raises:
        InputError: unreadable or no text.
    """
    text, notes = decoded(path)
    return text_table(text, path.name, notes)


def text_table(text: str, name: str, notes: tuple[str, ...] = ()) -> TextTable:
    """As ``read_text_table``, from text at hand."""
    stated: str | None = None
    content: list[tuple[int, str]] = []
    comments: list[Line] = []
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip().lstrip("\ufeff").strip()
        if not bare:
            continue
        if stated is None and not content and bare.strip('"').lower().startswith("sep="):
            stated = bare.strip('"')[4:5] or "\t"
            continue
        mark = next((mark for mark in COMMENT_MARKS if bare.lstrip('"').startswith(mark)), None)
        if mark is not None:
            comments.append(Line(number, (bare.lstrip('"').removeprefix(mark).rstrip('",; \t').strip(),)))
            continue
        content.append((number, line.strip(" \r\n\ufeff")))
    separator = stated
    if separator is None:
        separator = _separator([line for _, line in content]) if content else ","
    # Column names apart by several tabs are lined up for the eye; in the rows below an empty cell may mean something.
    bare_lines = [line.strip("\t ") for _, line in content]
    names = next((line for line in bare_lines if line.count("\t") > 2), "")
    tabs_run = separator == "\t" and "\t\t" in names
    lines = []
    for number, line in content:
        try:
            lines.append(Line(number, _cells(line, separator, tabs_run)))
        except InputError as problem:
            raise InputError(f"{name} row {number}: {problem}") from problem
    comma = separator != "," and any(_DECIMAL_COMMA.fullmatch(cell) for line in lines[1:] for cell in line.cells)
    if comma:
        notes = (*notes, "numbers with a decimal comma")
    return TextTable(name, tuple(lines), tuple(comments), separator, comma, notes)


def extra_cells(table: TextTable, line: Line, columns: int) -> InputError | None:
    """The error for a line that has more cells than there are columns, or None; empty cells at its end do not count."""
    count = len(line.cells)
    while count > columns and not line.cells[count - 1]:
        count -= 1
    if count <= columns:
        return None
    remedy = "use a decimal point" if table.separator == "," else "give one value for each column"
    return InputError(
        f"{table.name} row {line.number}: {count} values for {columns} columns; {remedy}"
        + (", or semicolons between the columns" if table.separator == "," else "")
    )
