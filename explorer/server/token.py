"""The secret in the page's address: whoever knows it may drive the page, nobody else.

On a login node every account reaches every port of 127.0.0.1, so an address alone keeps nobody out. The token stands in
the address that the terminal shows; a browser that came with it keeps it as a cookie. It stays the same for one folder
of runs, so that a page which is open comes back by itself when its server was killed and started again; deleting the
file makes a new one.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from html import escape
from pathlib import Path

_TOKEN_FILE = "page-token"
_DOOR_FILE = "open-page.html"
_BYTES = 24
_WELL_FORMED = re.compile(r"[A-Za-z0-9_-]{32}")


def token_of(folder: Path) -> str:
    """The token of a folder of runs, made when there is none; a new one each time where it cannot be kept.

    One that another account owns, could have read or written is not trusted and replaced.
    """
    path = folder / _TOKEN_FILE
    kept = _read_private(path)
    if kept is not None:
        return kept
    token = secrets.token_urlsafe(_BYTES)
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        _write_private(path, token)
    # two servers may start at once on one folder: the file decides
    return _read_private(path) or token


def _read_private(path: Path) -> str | None:
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return None
    with os.fdopen(handle, "rb") as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode) or status.st_uid != os.geteuid() or status.st_mode & 0o077:
            return None
        text = file.read(1000).decode("ascii", "replace").strip()
    return text if _WELL_FORMED.fullmatch(text) else None


def _write_private(path: Path, text: str) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)


@contextlib.contextmanager
def door(folder: Path, address: str) -> Iterator[str]:
    """What to hand to a browser program so that it opens ``address``: a private file that leads there.

    The command line of a process is shown to every account of the machine, so the address itself must not stand in it.
    Where no such file can be written it is the address without its token, and the page says what to type.
    """
    path = folder / _DOOR_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        link = escape(address)
        _write_private(
            path,
            f'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={link}">'
            f'<title>hpsop</title><a href="{link}">the design explorer</a>\n',
        )
    except (OSError, ValueError):
        yield address.partition("?")[0]
        return
    try:
        yield path.resolve().as_uri()
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
