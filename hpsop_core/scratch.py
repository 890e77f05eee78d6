"""Temporary folders: what a killed program could not take away is taken away by the next one.

Who makes a folder holds the kernel's lock on it as long as it lives. One that nobody holds belonged to a program that
was killed, and goes when the next folder is made in the same place.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterator
from multiprocessing.util import Finalize
from pathlib import Path

from hpsop_core.errors import InputError

_MARK = "hpsop-tmp-"
# Nothing that a person would call a folder of results, which may well begin with hpsop: it would be deleted.
_OURS = re.compile(rf"\.?{_MARK}[a-z]+-[a-z0-9_]{{8}}")
# s: a folder is made a moment before it is locked
_YOUNG = 60.0
# multiprocessing removes its own temporary folder at -100
_LAST = -200


@contextlib.contextmanager
def scratch_folder(purpose: str, beside: Path | None = None) -> Iterator[Path]:
    """A folder of one's own until the end of the block.

    Args:
        purpose: a word of its name.
        beside: the file or folder that what is made in it will be moved to, so that it appears whole or not at all; by
            default the folder stands among the system's temporary ones.

    Raises:
        InputError: there is no place for a temporary folder.
        OSError: the folder of ``beside`` cannot be written.
    """
    folder, lock = _made(purpose, beside)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def lasting_scratch_folder(purpose: str) -> Path:
    """The same until this program ends.

    Raises:
        InputError: there is no place for a temporary folder.
    """
    folder, lock = _made(purpose, None)

    def remove() -> None:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)

    # After multiprocessing's own folder, which may stand in it; and not when a forked child ends.
    Finalize(None, remove, exitpriority=_LAST)
    return folder


def _made(purpose: str, beside: Path | None) -> tuple[Path, int]:
    if beside is not None:
        clear_scratch(beside.parent)
        return _locked(Path(tempfile.mkdtemp(prefix=f".{_MARK}{purpose}-", dir=beside.parent)))
    try:
        clear_scratch(Path(tempfile.gettempdir()))
        return _locked(Path(tempfile.mkdtemp(prefix=f"{_MARK}{purpose}-")))
    except OSError as error:
        raise InputError(f"no temporary folder can be made ({error.strerror}); set TMPDIR to one with room") from error


def _locked(folder: Path) -> tuple[Path, int]:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    # where there are no locks, nothing is cleared either
    with contextlib.suppress(OSError):
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return folder, handle


def clear_scratch(place: Path) -> None:
    """Take away what killed programs of this user left in a place."""
    with contextlib.suppress(OSError), os.scandir(place) as entries:
        for entry in entries:
            if _OURS.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                with contextlib.suppress(OSError):
                    _clear_one(Path(entry.path))


def _clear_one(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        status = os.fstat(handle)
        if status.st_uid != os.geteuid() or time.time() - status.st_mtime < _YOUNG:
            return
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)
    finally:
        os.close(handle)
