"""Compiled kernels, kept on the disk where that is possible.

numba keeps what it compiled beside the source or in the user's cache folder. Where neither can be written (an
installation for all, an account without a home) it refuses to compile at all, and a damaged file of its cache ends the
program, or where the damage lies in machine code computes something else: here the kernels are compiled for this
process alone, or once more where a checksum of what was kept is wrong.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
from collections.abc import Callable
from typing import Any, TypeVar

import numba

_LOG = logging.getLogger("hpsop")
_DIGEST = hashlib.sha256().digest_size
_Function = TypeVar("_Function", bound=Callable[..., Any])


def njit(**options: Any) -> Callable[[_Function], _Function]:
    """As ``numba.njit`` with a cache, which is done without or made anew where it must be."""

    def compiled(function: _Function) -> _Function:
        try:
            dispatcher: Any = numba.njit(cache=True, **options)(function)
        except RuntimeError:
            # no folder that can be written
            plain: _Function = numba.njit(**options)(function)
            return plain
        _mend(dispatcher)
        kept: _Function = dispatcher
        return kept

    return compiled


def is_missing(function: Any) -> bool:
    """Whether a function of ``njit`` has yet to be compiled though it could be kept."""
    file = getattr(getattr(function, "_cache", None), "_cache_file", None)
    return file is not None and not os.path.exists(file._index_path)


def _mend(dispatcher: Any) -> None:
    """A cache that cannot be read, or written, is as good as none; what is damaged is taken away."""
    cache = dispatcher._cache
    _check(cache._cache_file)
    load, save = cache.load_overload, cache.save_overload

    def load_overload(signature: Any, target: Any) -> Any:
        try:
            return load(signature, target)
        # whatever the bytes of a damaged pickle may raise
        except Exception as error:  # noqa: BLE001
            _LOG.info("a compiled kernel's cache is damaged and made anew: %s", error)
            with contextlib.suppress(OSError, AttributeError):
                os.unlink(cache._cache_file._index_path)
            return None

    def save_overload(signature: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            save(signature, data)

    cache.load_overload, cache.save_overload = load_overload, save_overload


def _check(file: Any) -> None:
    """Kernels are kept with a checksum behind them, which unpickling passes over, and taken only with a right one."""
    dump, load = file._dump, file._load_data

    def dumped(content: Any) -> bytes:
        data: bytes = dump(content)
        return data + hashlib.sha256(data).digest()

    def load_data(name: str) -> Any:
        with open(file._data_path(name), "rb") as stream:
            data = stream.read()
        if hashlib.sha256(data[:-_DIGEST]).digest() != data[-_DIGEST:]:
            raise ValueError(f"{name} is not what was written")
        return load(name)

    file._dump, file._load_data = dumped, load_data
