"""The command ``hpsop``: thin over the Python interface, one line for every mistake."""

from __future__ import annotations

import argparse
import contextlib
import gc
import importlib
import os
import sys
from collections.abc import Iterator, Sequence
from typing import NoReturn

from hpsop_core.errors import HpsopError, InputError, message_line, shown
from hpsop_core.lean_imports import lean_imports
from hpsop_core.standard_streams import mend_standard_streams
from hpsop_core.version import __version__

USAGE_ERROR = 2


class _Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, with the help that leads on."""

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message_line(message)}; see '{self.prog} --help'", file=sys.stderr)
        raise SystemExit(USAGE_ERROR)


_ROOMS = {
    "own_files": ("hull", "propeller"),
    "physics": ("evaluate", "resistance", "open-water", "validate"),
    "runs": ("optimize", "show"),
    "export": ("export", "report", "reproduce"),
}
"""Which file of this folder has which commands, in the order of the help."""


_SHORT = ("evaluate", "open-water", "propeller", "resistance")


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """The parser of the commands; each sets ``handler``, a function of the parsed arguments.

    Args:
        command: the one that is asked for, whose file alone is then loaded; any other word, or None, for all.
    """
    parser = _Parser(prog="hpsop", description="Optimise a ship's hull and its propeller together.")
    parser.add_argument("--version", action="version", version=f"hpsop {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=_Parser)
    asked = [room for room, names in _ROOMS.items() if command in names]
    for room in asked or _ROOMS:
        importlib.import_module(f"hpsop_core.cli.{room}").add_parsers(commands)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code: 0 done, 1 a computation failed, 2 bad input, 130 interrupted."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if arguments is None:
        mend_standard_streams()
    with _quick() if words and words[0] in _SHORT else contextlib.nullcontext():
        return _run(words)


@contextlib.contextmanager
def _quick() -> Iterator[None]:
    """A context for a command whose time is mostly what it loads."""
    collecting = gc.isenabled()
    # Nearly all that it makes stays to its end: looking for garbage is a tenth of its time.
    gc.disable()
    try:
        with lean_imports():
            yield
    finally:
        if collecting:
            gc.enable()


def _run(words: Sequence[str]) -> int:
    try:
        parsed = build_parser(words[0] if words else None).parse_args(words)
        code = parsed.handler(parsed)
        sys.stdout.flush()
        return int(code)
    except InputError as error:
        print(f"hpsop: {error}", file=sys.stderr)
        return USAGE_ERROR
    except HpsopError as error:
        print(f"hpsop: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("hpsop: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader of our output went away (`hpsop ... | head`); the rest has nowhere to go.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        # a name or a place that only the operating system refuses, at the last moment
        name = "" if error.filename is None else f"{shown(str(error.filename)[-60:])}: "
        print(f"hpsop: {name}{message_line(error.strerror or str(error))}; choose another place", file=sys.stderr)
        return USAGE_ERROR


if __name__ == "__main__":
    raise SystemExit(main())
