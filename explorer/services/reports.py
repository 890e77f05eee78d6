"""A run's report for the page, made by a process of its own: drawing it would hold the page for seconds."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from hpsop_core.errors import InputError

_LONGEST_SECONDS = 180.0
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def run_report(run: Path) -> bytes:
    """The report of a run as it is now: one HTML page.

    Raises:
        InputError: it cannot be made; the text says why.
    """
    root = str(Path(__file__).resolve().parents[2])
    paths = [root, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    with tempfile.TemporaryDirectory(prefix="hpsop-report-") as folder:
        target = Path(folder) / "report.html"
        try:
            done = subprocess.run(
                [sys.executable, "-P", "-m", "hpsop_core.cli", "report", str(run), "--to", str(target)],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=_LONGEST_SECONDS,
                check=False,
                env={**os.environ, **_ONE_THREAD, "PYTHONPATH": os.pathsep.join(paths)},
            )
        except subprocess.TimeoutExpired:
            raise InputError(f"report: not made within {_LONGEST_SECONDS:g} s; try 'hpsop report {run}'") from None
        except OSError as error:
            raise InputError(f"report: its process does not start ({error.strerror})") from None
        if done.returncode or not target.is_file():
            # its line begins with the command's name
            said = done.stderr.decode("utf-8", "replace").strip().split("\n")[-1].removeprefix("hpsop: ")
            raise InputError(said or "report: its process ended without a word")
        return target.read_bytes()
