"""docs/licences.md: what the page and the method are installed with, under which licence.

Run `python -m tools.licences` in the environment that `make` has set up; tests/regression/test_supply_chain.py fails
when the page no longer names every dependency.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import re
import sys
from collections.abc import Sequence
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "licences.md"
_CLASSIFIER = "License :: OSI Approved :: "
# What a package's own metadata leaves open, read in its licence file.
_READ_BY_HAND = {"graphemeu": "MIT"}
# Licences that ask for more than to be named.
NOT_PERMISSIVE = re.compile(r"GPL|MPL|Mozilla|EPL|CDDL", re.IGNORECASE)

_HEAD = """# Licences

hpsop itself is MIT. This lists what `pip install .` brings along (`dask`, `cad`, `docs` and `test` are extras, not
in it); it is written by `python -m tools.licences`.

Nothing of these packages is copied into hpsop or shipped with it: pip fetches each from its own project, and hpsop
imports it. Those that ask for more than to be named:

* **moocore (LGPL)**, which pymoo needs: a library that is linked when it is imported and can be replaced by another
  version of it, as the LGPL asks. hpsop does not call it.
* **certifi and tqdm (MPL)**: the MPL asks that changed *files* of theirs stay open. None is changed.

Who ships an environment with all of it (a container, an installer) ships those too, and owes their sources or where
they are: their projects on PyPI.

| Package | Licence |
|---|---|
"""


def normal(name: str) -> str:
    """A package's name in its one spelling."""
    return re.sub(r"[-_.]+", "-", name).lower()


def needed() -> list[str]:
    """Names of everything that hpsop needs at run time on this machine, directly or not."""
    found: dict[str, str] = {}
    waiting = ["hpsop"]
    while waiting:
        name = waiting.pop()
        for text in importlib.metadata.requires(name) or []:
            requirement = Requirement(text)
            if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
                continue
            if normal(requirement.name) not in found:
                found[normal(requirement.name)] = requirement.name
                waiting.append(requirement.name)
    return sorted(found)


def licence(name: str) -> str:
    """A package's licence in few words."""
    if name in _READ_BY_HAND:
        return _READ_BY_HAND[name]
    metadata = importlib.metadata.metadata(name)
    stated = metadata.get("License-Expression") or ""
    classified = [
        line.removeprefix(_CLASSIFIER) for line in metadata.get_all("Classifier") or [] if _CLASSIFIER in line
    ]
    words = (metadata.get("License") or "").strip().splitlines()
    text = stated or ", ".join(classified) or (words[0] if words else "")
    return text if text and len(text) < 100 else "see its project"


def page() -> str:
    """The whole page."""
    rows = []
    for name in needed():
        text = licence(name)
        rows.append(f"| {name} | {f'**{text}**' if NOT_PERMISSIVE.search(text) else text} |\n")
    return _HEAD + "".join(rows)


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns the exit status."""
    argparse.ArgumentParser(prog="python -m tools.licences", description=__doc__).parse_args(argv)
    PAGE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{PAGE.relative_to(ROOT)} written\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
