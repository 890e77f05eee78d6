"""Freed memory is kept by the process: a solver asks for the same large arrays again with the next design.

glibc gives arrays of more than some 100 kB straight back to the kernel, which must then clear every page anew for the
next design: a quarter of a two-condition wave solution. The limits below keep freed arrays in the process.
"""

from __future__ import annotations

import ctypes
from functools import cache

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # the names' numbers in malloc.h
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
