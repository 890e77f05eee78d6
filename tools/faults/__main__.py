"""Plant each fault in a copy of the tree and expect red: ``python -m tools.faults`` (``make faults``).

A patch whose text is no longer found exactly once is stale, which is an error: the fault says nothing any more. Before
anything is planted the tests must be green: what is red already notices nothing.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).resolve().parents[2]
WANTED = 0.95
"""Share of the faults that must be noticed."""

# A fault that makes a test wait for ever is noticed: whoever runs the tests sees that they do not end.
_LONGEST = 900.0
_TREES = ("hpsop_core", "explorer", "tests", "tools", "assets", "docs", "examples")
_FILES = ("pyproject.toml", "README.md", "CHANGELOG.md")


@dataclass(frozen=True)
class Fault:
    """A textual patch.

    Attributes:
        name: what is wrong.
        file: from the root of the tree.
        old, new: texts; the old one stands in the file exactly once.
        tests: files or names of tests, of which one should turn red.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def stale(self) -> str:
        """Why the patch says nothing any more; "" where it does."""
        path = ROOT / self.file
        if not path.is_file():
            return f"there is no {self.file}"
        count = path.read_text(encoding="utf-8").count(self.old)
        if count != 1:
            return f"its text stands {count} times in {self.file}"
        missing = [test for test in self.tests if not (ROOT / test.partition("::")[0]).is_file()]
        return f"there is no {missing[0]}" if missing else ""


def catalogue() -> tuple[Fault, ...]:
    """Every fault, in the order of the files."""
    found: list[Fault] = []
    for path in sorted(Path(__file__).parent.glob("*.toml")):
        for place in tomllib.loads(path.read_text(encoding="utf-8"))["place"]:
            found += [
                Fault(item["name"], place["file"], item["old"], item["new"], tuple(item.get("tests", place["tests"])))
                for item in place["faults"]
            ]
    return tuple(found)


def copied(to: Path) -> Path:
    """A copy of the tree as it stands, without what is made from it."""
    for name in _TREES:
        shutil.copytree(ROOT / name, to / name, ignore=shutil.ignore_patterns("__pycache__", "pictures"))
    for name in _FILES:
        shutil.copy(ROOT / name, to / name)
    (to / "hpsop_assets").symlink_to("assets")
    return to


def green(tree: Path, tests: Sequence[str]) -> tuple[bool, str]:
    """Whether the tests pass in a tree, and the first line that says why not."""
    environment = {
        **os.environ, "PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
        "NUMBA_CACHE_DIR": str(tree / "numba"),
    }  # fmt: skip
    words = [sys.executable, "-m", "pytest", "-q", "-x", "--tb=line", "-p", "no:cacheprovider", *tests]
    try:
        ended = subprocess.run(
            words, check=False, capture_output=True, text=True, cwd=tree, env=environment, timeout=_LONGEST
        )
    except subprocess.TimeoutExpired:
        return False, "the tests do not end"
    lines = [line for line in ended.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return ended.returncode == 0, lines[0] if lines else f"pytest ended with {ended.returncode}"


def noticed(tree: Path, fault: Fault) -> tuple[bool, str]:
    """Whether the tests turn red with the fault in the tree, and which does."""
    path = tree / fault.file
    sound = path.read_text(encoding="utf-8")
    _put(path, sound.replace(fault.old, fault.new))
    try:
        passed, why = green(tree, fault.tests)
    finally:
        _put(path, sound)
    return not passed, why


def _put(path: Path, text: str) -> None:
    """Another text, and another time: Python and numba know by size and whole seconds what they have compiled."""
    later = int(path.stat().st_mtime) + 2
    path.write_text(text, encoding="utf-8")
    os.utime(path, (later, later))


def tried(faults: Sequence[Fault], jobs: int, known_green: bool) -> Iterator[tuple[Fault, bool, str, float]]:
    """Each fault with whether it was noticed, by what, and in how many seconds; ``jobs`` trees side by side."""
    with tempfile.TemporaryDirectory(prefix="hpsop-faults-") as folder:
        trees: SimpleQueue[Path] = SimpleQueue()
        for number in range(jobs):
            trees.put(copied(Path(folder) / str(number)))

        def one(fault: Fault) -> tuple[Fault, bool, str, float]:
            tree, started = trees.get(), time.monotonic()
            try:
                red, why = noticed(tree, fault)
            finally:
                trees.put(tree)
            return fault, red, why, time.monotonic() - started

        def sound(tests: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
            tree = trees.get()
            try:
                passed, why = green(tree, tests)
            finally:
                trees.put(tree)
            return tests, "" if passed else why

        with ThreadPoolExecutor(jobs) as pool:
            sets = dict.fromkeys(fault.tests for fault in faults)
            red: dict[tuple[str, ...], str] = {}
            if not known_green:
                print(f"{len(faults)} faults; first the {len(sets)} sets of tests without any ...", flush=True)
                red = {tests: why for tests, why in pool.map(sound, sets) if why}
            for why in red.values():
                print(f"RED      without a fault: {why}", flush=True)
            # What is red already notices nothing.
            yield from pool.map(one, [fault for fault in faults if fault.tests not in red])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run it; 0 if none is stale and enough are noticed."""
    parser = argparse.ArgumentParser(prog="python -m tools.faults", description=__doc__)
    parser.add_argument("--only", metavar="WORD", nargs="+", default=[""], help="faults whose file or name holds one")
    parser.add_argument("--known-green", action="store_true", help="do not run the tests without a fault first")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="trees side by side")
    parser.add_argument("--list", action="store_true", help="name the faults and those that are stale; plant nothing")
    chosen = parser.parse_args(arguments)
    faults = [fault for fault in catalogue() if any(word in f"{fault.file}: {fault.name}" for word in chosen.only)]
    stale = {fault: fault.stale() for fault in faults if fault.stale()}
    for fault, why in stale.items():
        print(f"STALE    {fault.name}: {why}")
    if chosen.list:
        print("\n".join(f"{fault.file}: {fault.name}" for fault in faults))
        print(f"{len(faults)} faults, {len(stale)} stale")
        return 1 if stale else 0
    sound = [fault for fault in faults if fault not in stale]
    count = 0
    for fault, red, why, seconds in tried(sound, chosen.jobs, chosen.known_green):
        count += red
        print(f"{'noticed ' if red else 'SURVIVES'} {seconds:5.1f} s  {fault.file}: {fault.name}"
              + (f"  [{why[:110]}]" if red else ""), flush=True)  # fmt: skip
    print(f"{count} of {len(faults)} faults noticed, {len(stale)} stale")
    return 0 if not stale and count >= WANTED * len(faults) else 1


if __name__ == "__main__":
    raise SystemExit(main())
