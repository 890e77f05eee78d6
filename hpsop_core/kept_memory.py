"""What becomes of freed memory: a solver keeps it, a process of many threads shares it, a page gives it back.

A solver asks for the same large arrays again with the next design. glibc gives arrays of more than some 100 kB straight
back to the kernel, which must then clear every page anew: a quarter of a two-condition wave solution. The limits below
keep freed arrays in the process.

Threads allocate from arenas of their own, up to eight for each core; what one has freed no other may use, and a thread
that has ended leaves its arena full of holes. A server that makes three threads for each visitor grows so for hours.
"""

from __future__ import annotations

import contextlib
import ctypes
from functools import cache

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8  # the names' numbers in malloc.h
_LARGEST_KEPT = 32 * 1024 * 1024  # the greatest that glibc accepts
_KEPT_AT_MOST = 256 * 1024 * 1024


@cache
def keep_freed_memory() -> bool:
    """Raise glibc's limits, once a process; elsewhere nothing happens. Returns whether they were raised."""
    try:
        library = ctypes.CDLL(None)
        return bool(library.mallopt(_MMAP_THRESHOLD, _LARGEST_KEPT) and library.mallopt(_TRIM_THRESHOLD, _KEPT_AT_MOST))
    except (OSError, AttributeError):
        return False


def share_freed_memory() -> bool:
    """Let all threads take from one stock of freed memory; elsewhere than with glibc nothing happens.

    To be called before there are threads. Python's own lock lets one of them allocate at a time anyhow. Returns whether
    it was done.
    """
    try:
        return bool(ctypes.CDLL(None).mallopt(_ARENA_MAX, 1))
    except (OSError, AttributeError):
        return False


def give_back_memory() -> None:
    """Give freed memory back to the kernel, where glibc can."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
