"""Opening a file that a stranger named: a regular one, of a bounded size, or one line that says why not.

A pipe would be waited for for ever and a device read until memory is full; a name may be longer than any file system
takes or hold a NUL, for which the system calls have other errors than for a file that is not there.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from hpsop_core.errors import InputError, shown

LARGEST_CASE = 4 << 20  # bytes; a case holds some thousand
LARGEST_MESH = 1 << 30  # bytes; a hull of ten million triangles in binary STL


def file_name(path: Path) -> str:
    """A path as messages name it: whole where it is short, its end where not."""
    text = str(path)
    return text if len(text) <= 200 and text.isprintable() else shown(text[-60:])


def check_regular(path: Path, most: int, what: str) -> None:
    """That a path is a file which can be read as a whole.

    Args:
        path: as it was named.
        most: bytes that are taken.
        what: the file should hold, for the message: "a table of offsets".

    Raises:
        InputError: no such file, no name for a file, a folder, pipe or device, unreadable, or too large.
    """
    name = file_name(path)
    try:
        status = path.stat()
    except FileNotFoundError as problem:
        raise InputError(f"{name}: cannot be read (no such file); name {what}") from problem
    except (OSError, ValueError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) else str(problem)
        raise InputError(f"{name}: cannot be read ({reason}); name {what}") from problem
    if not stat.S_ISREG(status.st_mode):
        kind = "a folder" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
        raise InputError(f"{name}: cannot be read: it is {kind}, not a file; name {what}")
    if status.st_size > most:
        raise InputError(f"{name}: is larger than {most >> 20} MB; {what} is far smaller")


def read_bytes(path: Path, most: int, what: str) -> bytes:
    """The content of a file.

    Args, raises: as ``check_regular``.
    """
    check_regular(path, most, what)
    try:
        # between the look and the opening it may have become a pipe: never wait for one
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(handle, "rb") as file:
            content = file.read(most + 1)
    except OSError as problem:
        raise InputError(f"{file_name(path)}: cannot be read ({problem.strerror}); name {what}") from problem
    if len(content) > most:
        raise InputError(f"{file_name(path)}: is larger than {most >> 20} MB; {what} is far smaller")
    return content
