"""The command ``hpsop``: thin over the Python interface, one line for every mistake."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from hpsop_core.errors import HpsopError, InputError, message_line, shown
from hpsop_core.version import __version__

USAGE_ERROR = 2


class _Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, with the help that leads on."""

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message_line(message)}; see '{self.prog} --help'", file=sys.stderr)
        raise SystemExit(USAGE_ERROR)


def build_parser() -> argparse.ArgumentParser:
    """The parser of every sub-command; each sets ``handler``, a function of the parsed arguments."""
    # Imported here so that `hpsop --version` and mistakes in the words of a command answer at once.
    from hpsop_core.cli import export, own_files, physics, runs

    parser = _Parser(prog="hpsop", description="Optimise a ship's hull and its propeller together.")
    parser.add_argument("--version", action="version", version=f"hpsop {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=_Parser)
    for room in (own_files, physics, runs, export):
        room.add_parsers(commands)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code: 0 done, 1 a computation failed, 2 bad input, 130 interrupted."""
    try:
        parsed = build_parser().parse_args(arguments)
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
