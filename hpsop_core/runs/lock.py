"""One writer a run file: an operating system's lock that ends with its process, however that ends."""

from __future__ import annotations

import fcntl
import json
import os
import socket
import time
from pathlib import Path
from typing import Any

from hpsop_core.errors import InputError
from hpsop_core.runs.connections import real_path

_PATIENCE = 0.5  # seconds: a reader's test of the lock lasts microseconds


def lock_path(run_path: Path) -> Path:
    """The lock file that stands beside a run file while it is written: beside the file itself, not a link to it."""
    real = real_path(run_path)
    return real.with_name(real.name + ".lock")


def refuse_second_name(run_path: Path) -> None:
    """A file with two names has two logs and two locks, and two programs would write it at once.

    Raises:
        InputError: the file has hard links.
    """
    try:
        names = os.stat(run_path).st_nlink
    except OSError:
        return
    if names > 1:
        raise InputError(
            f"{run_path}: has {names} names (hard links), and another program may be writing it by another one; "
            "copy it and use the copy"
        )


class WriterLock:
    """The right to write a run file, held from construction to ``release``.

    The lock is the kernel's (flock) on a file beside the run file, so a lock left by a killed process blocks nobody.
    The lock file tells who holds it. Not for network file systems.

    Raises:
        InputError: another process (or this one) is writing the run, or the folder cannot be written.
    """

    def __init__(self, run_path: Path) -> None:
        self._run_path = run_path
        self._path = lock_path(run_path)
        self._descriptor: int | None = self._acquired()
        owner = {"process": os.getpid(), "host": socket.gethostname(), "since": time.strftime("%Y-%m-%d %H:%M:%S")}
        try:
            os.ftruncate(self._descriptor, 0)
            os.pwrite(self._descriptor, json.dumps(owner).encode(), 0)
        except OSError:
            # A full disk: the lock holds all the same, only its owner's name is missing.
            os.ftruncate(self._descriptor, 0)

    def _acquired(self) -> int:
        give_up = time.monotonic() + _PATIENCE
        while True:
            try:
                descriptor = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
            except OSError as error:
                raise InputError(
                    f"{self._run_path}: the folder cannot be written ({error.strerror}); choose another place for --run"
                ) from error
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                os.close(descriptor)
                if time.monotonic() > give_up:
                    raise InputError(self._refusal()) from None
                time.sleep(0.02)
                continue
            if _same_file(descriptor, self._path):
                return descriptor
            # Its last owner removed the file between our open and our lock: lock the one that stands there now.
            os.close(descriptor)

    def _refusal(self) -> str:
        owner = lock_owner(self._run_path)
        who = "another process"
        if owner:
            who = f"process {owner.get('process')} on {owner.get('host')} since {owner.get('since')}"
        return f"{self._run_path}: is being written by {who}; stop that one first or choose another file"

    def release(self) -> None:
        """Give the lock back; doing so twice does nothing."""
        if self._descriptor is None:
            return
        self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None


def _same_file(descriptor: int, path: Path) -> bool:
    try:
        there = os.stat(path)
    except FileNotFoundError:
        return False
    mine = os.fstat(descriptor)
    return (mine.st_ino, mine.st_dev) == (there.st_ino, there.st_dev)


def lock_owner(run_path: Path) -> dict[str, Any]:
    """Who wrote the lock file last: process, host, since; empty if unknown."""
    try:
        owner = json.loads(lock_path(run_path).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return owner if isinstance(owner, dict) else {}


def is_being_written(run_path: Path) -> bool:
    """Whether some process holds the writer's lock just now."""
    try:
        descriptor = os.open(lock_path(run_path), os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False
