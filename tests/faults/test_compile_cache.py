"""Kernels are compiled where nothing can be kept, and again where what was kept is damaged."""

from __future__ import annotations

import contextlib
import os
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

KERNEL = """
from hpsop_core.compiled import is_missing, njit

@njit()
def doubled(x):
    return 2.0 * x

missing = is_missing(doubled)
print(doubled(21.0))
print(missing, is_missing(doubled))
"""


# Defines the kernel anew, and so takes it from the cache, for each line that it is given: numba is imported once.
AGAIN = """
import runpy, sys

for line in sys.stdin:
    runpy.run_path(sys.argv[1])
    sys.stdout.flush()
"""


@contextlib.contextmanager
def _runs(folder: Path, cache: Path) -> Iterator[Callable[[], str]]:
    """A process, and what has it run the kernel once and tells what was printed; nothing stands on standard error."""
    process = subprocess.Popen(
        [sys.executable, "-c", AGAIN, folder / "kernel.py"],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "NUMBA_CACHE_DIR": str(cache)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdin is not None and process.stdout is not None
    stdin, stdout = process.stdin, process.stdout

    def run() -> str:
        stdin.write("\n")
        stdin.flush()
        return f"{stdout.readline().strip()} {stdout.readline().strip()}"

    try:
        yield run
    finally:
        rest, told = process.communicate(timeout=60)
    assert (process.returncode, rest, told) == (0, "", "")


def test_a_damaged_cache_is_made_anew(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL, encoding="utf-8")
    cache = tmp_path / "cache"
    with _runs(tmp_path, cache) as run:
        assert run() == "42.0 True False"
    with _runs(tmp_path, cache) as run:
        assert run() == "42.0 False False"
        for pattern in ("*.nbi", "*.nbc"):
            files = list(cache.rglob(pattern))
            assert files
            for content in (b"", b"\x80\x04nonsense", files[0].read_bytes()[:40]):
                for file in cache.rglob(pattern):
                    file.write_bytes(content)
                assert run().startswith("42.0 ")
                assert run().startswith("42.0 ")


def test_a_bit_of_machine_code_is_not_run(tmp_path: Path) -> None:
    """What can be unpickled may still be other code than was compiled: a constant of the kernel is another one."""
    (tmp_path / "kernel.py").write_text(KERNEL.replace("2.0 * x", "x * 1234.5 / 617.25"), encoding="utf-8")
    cache = tmp_path / "cache"
    with _runs(tmp_path, cache) as run:
        assert run().startswith("42.0 ")
        _damage(cache)
        assert run().startswith("42.0 ")


def _damage(cache: Path) -> None:
    """Another constant in the machine code."""
    constant = struct.pack("<d", 1234.5)
    kept = [file for file in cache.rglob("*.nbc") if constant in file.read_bytes()]
    assert kept
    for file in kept:
        file.write_bytes(file.read_bytes().replace(constant, struct.pack("<d", 9876.5)))


def test_without_a_folder_that_can_be_written_kernels_are_compiled_for_the_process(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL, encoding="utf-8")
    # a file where the folder should be: also root cannot write into it
    (tmp_path / "file").write_text("", encoding="utf-8")
    with _runs(tmp_path, tmp_path / "file" / "cache") as run:
        assert run().startswith("42.0 ")
