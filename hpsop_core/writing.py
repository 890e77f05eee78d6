"""Files for people: whole or not there at all, and never over one that is there unless they say so."""

from __future__ import annotations

import os
from pathlib import Path

from hpsop_core.errors import InputError
from hpsop_core.scratch import scratch_folder


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
        with scratch_folder("file", beside=path) as folder:
            whole = folder / path.name
            whole.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
            os.replace(whole, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error}); choose another place") from error
