"""The three streams of a program as its starter left them: closed ones, and terminals that lack letters."""

from __future__ import annotations

import io
import os
import sys


def mend_standard_streams() -> None:
    """Let whatever is printed be printed, or lead to nothing; for a command, before it opens a file.

    A stream that was closed (``hpsop ... >&-``, some services) leads to nothing: Python has no object for it, and the
    next file that is opened would get its number, into which a library may print. A letter that the encoding lacks (C
    locale, PYTHONIOENCODING=ascii) is printed as its escape instead of ending the command.
    """
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            # the system gives the least number that is free: that of the stream itself
            descriptor = os.open(os.devnull, os.O_RDWR)
            setattr(sys, name, os.fdopen(descriptor, "r" if name == "stdin" else "w", encoding="utf-8", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="backslashreplace")
