"""Kernels are compiled where nothing can be kept, and again where what was kept is damaged."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
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


def _run(folder: Path, cache: str) -> str:
    done = subprocess.run(
        [sys.executable, folder / "kernel.py"],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "NUMBA_CACHE_DIR": cache},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return " ".join(done.stdout.split())


def test_a_damaged_cache_is_made_anew(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL, encoding="utf-8")
    cache = tmp_path / "cache"
    assert _run(tmp_path, str(cache)) == "42.0 True False"
    assert _run(tmp_path, str(cache)) == "42.0 False False"
    for pattern in ("*.nbi", "*.nbc"):
        files = list(cache.rglob(pattern))
        assert files
        for content in (b"", b"\x80\x04nonsense", files[0].read_bytes()[:40]):
            for file in cache.rglob(pattern):
                file.write_bytes(content)
            assert _run(tmp_path, str(cache)).startswith("42.0")
            assert _run(tmp_path, str(cache)).startswith("42.0")


def test_a_bit_of_machine_code_is_not_run(tmp_path: Path) -> None:
    """What can be unpickled may still be other code than was compiled: a constant of the kernel is another one."""
    (tmp_path / "kernel.py").write_text(KERNEL.replace("2.0 * x", "x * 1234.5 / 617.25"), encoding="utf-8")
    cache = tmp_path / "cache"
    assert _run(tmp_path, str(cache)).startswith("42.0 ")
    constant = struct.pack("<d", 1234.5)
    kept = [file for file in cache.rglob("*.nbc") if constant in file.read_bytes()]
    assert kept
    for file in kept:
        file.write_bytes(file.read_bytes().replace(constant, struct.pack("<d", 9876.5)))
    assert _run(tmp_path, str(cache)).startswith("42.0 ")


def test_without_a_folder_that_can_be_written_kernels_are_compiled_for_the_process(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL, encoding="utf-8")
    # a file where the folder should be: also root cannot write into it
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert _run(tmp_path, str(tmp_path / "file" / "cache")).startswith("42.0")
