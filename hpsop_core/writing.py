"""Files for people: whole or not there at all, and never over one that is there unless they say so."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from hpsop_core.errors import InputError


def refuse_to_replace(path: Path, force: bool) -> None:
    """Before anything is computed.

    Raises:
        InputError: the file is there and nobody said that it may be replaced.
    """
    if os.path.exists(path) and not force:
        raise InputError(f"{path}: is there already; give --force to replace it, or another name")


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file, text as UTF-8, so that it appears whole or not at all.

    Raises:
        InputError: it cannot be written there.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".hpsop-", suffix=path.suffix, dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content.encode("utf-8") if isinstance(content, str) else content)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(name)
            raise
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error}); choose another place") from error


def _umask() -> int:
    # There is no way to ask without setting.
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
