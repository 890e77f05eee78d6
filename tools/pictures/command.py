"""The command line that the scripts of pictures share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path


def write_pictures(
    description: str, pictures: Mapping[str, Callable[[Path], None]], arguments: Sequence[str] | None = None
) -> int:
    """Draw every picture into the folder of ``--to``; returns the exit status.

    Args:
        description: of the command.
        pictures: file name -> what draws it.
        arguments: the command's; those of the process by default.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--to", required=True, type=Path, help="folder for the PNG files")
    folder: Path = parser.parse_args(arguments).to
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, draw in pictures.items():
            draw(folder / name)
    except OSError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0
