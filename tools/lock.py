"""Pins with hashes for this Python and machine: constraints/<python>-<machine>.txt, ...-tests.txt and ...-docs.txt.

`make lock` runs it after constraints.txt was changed. pip resolves what `pip install .` (and '.[test]') would take
under constraints.txt, and says the hash of every file; `make` installs those files and nothing else wherever such a
list fits.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "constraints"


def name_here() -> str:
    """Of the list for this interpreter on this kind of machine, for example "cp311-linux-x86_64"."""
    return f"cp{sys.version_info.major}{sys.version_info.minor}-{sysconfig.get_platform()}"


def resolved(what: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Package -> (version, sha256) of all that pip would install for ``what``, whether it is here already or not.

    Raises:
        subprocess.CalledProcessError: pip finds no solution, or no index.
    """
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--quiet", "--ignore-installed"]
    command += ["--only-binary", ":all:", "--constraint", str(ROOT / "constraints.txt"), "--report", "-", *what]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    found: dict[str, tuple[str, str]] = {}
    entries: list[dict[str, Any]] = json.loads(done.stdout)["install"]
    for entry in entries:
        info = entry["download_info"].get("archive_info")
        if info is not None:  # hpsop itself is a folder
            metadata = entry["metadata"]
            found[metadata["name"].lower()] = (metadata["version"], info["hashes"]["sha256"])
    return found


def write(path: Path, pins: dict[str, tuple[str, str]], what: str) -> None:
    """One list, sorted."""
    lines = [f"# {what} under constraints.txt, with the hash of each file; written by 'make lock'\n"]
    for name, (version, digest) in sorted(pins.items()):
        lines.append(f"{name}=={version} \\\n    --hash=sha256:{digest}\n")
    path.parent.mkdir(exist_ok=True)
    path.write_text("".join(lines), encoding="utf-8")
    sys.stdout.write(f"{path.relative_to(ROOT)}: {len(pins)} packages\n")


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns the exit status."""
    argparse.ArgumentParser(prog="python -m tools.lock", description=__doc__).parse_args(argv)
    # setuptools builds hpsop itself: from the list too, and not from wherever a build would fetch it
    write(FOLDER / f"{name_here()}.txt", resolved([".", "setuptools>=77"]), "what hpsop needs")
    write(FOLDER / f"{name_here()}-tests.txt", resolved([".[test]", "setuptools>=77"]), "what hpsop and its tests need")
    write(FOLDER / f"{name_here()}-docs.txt", resolved([".[docs]", "setuptools>=77"]), "what hpsop and its site need")
    return 0


if __name__ == "__main__":
    sys.exit(main())
