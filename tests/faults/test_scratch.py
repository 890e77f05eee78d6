"""Temporary folders of killed programs are taken away by the next one, and nothing else is."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from hpsop_core.errors import InputError
from hpsop_core.scratch import clear_scratch, lasting_scratch_folder, scratch_folder

_HOLDER = """
import sys, time
from pathlib import Path
from hpsop_core.scratch import lasting_scratch_folder, scratch_folder
(lasting_scratch_folder("workers") / "socket").touch()
with scratch_folder("export", beside=Path("design")) as folder:
    (folder / "hull.stl").write_text("solid")
    print("ready", flush=True)
    time.sleep(600)
"""


def aged(folder: Path) -> None:
    long_ago = time.time() - 3600.0
    os.utime(folder, (long_ago, long_ago))


def test_folders_of_a_killed_program_go_and_no_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    process = subprocess.Popen(
        [sys.executable, "-c", _HOLDER],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(Path(__file__).parents[2])},
        stdout=subprocess.PIPE,
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        own = lasting_scratch_folder("workers")
        held = [folder for folder in tmp_path.iterdir() if folder != own]
        assert len(held) == 2
        kept = [tmp_path / name for name in ("hpsop-results", ".hpsop-tmp-mine", "hpsop-tmp-report")]
        for folder in kept:
            folder.mkdir()
        for folder in tmp_path.iterdir():
            aged(folder)
        clear_scratch(tmp_path)
        assert all(folder.is_dir() for folder in (*held, *kept, own)), "somebody works in them, or they are no scratch"
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()
    clear_scratch(tmp_path)
    assert not any(folder.exists() for folder in held)
    assert all(folder.is_dir() for folder in (*kept, own))


def test_a_folder_goes_with_its_block_and_old_ones_when_it_is_made(tmp_path: Path) -> None:
    left = tmp_path / ".hpsop-tmp-export-abcd_123"
    (left / "inside").mkdir(parents=True)
    aged(left)
    target = tmp_path / "design"
    with scratch_folder("export", beside=target) as folder:
        assert not left.exists()
        (folder / "file").touch()
    assert list(tmp_path.iterdir()) == []


def test_no_place_for_a_temporary_folder_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    with pytest.raises(InputError, match="set TMPDIR"), scratch_folder("export"):
        pass


def test_the_workers_socket_stands_in_such_a_folder() -> None:
    """multiprocessing's own folder would stay for ever where the run was killed."""
    script = (
        "from hpsop_core.runs.executor import LocalWorkers\n"
        "from pathlib import Path\n"
        "LocalWorkers.prepare()\n"
        "print([path.parent.parent.name[:18] for path in Path('.').rglob('listener-*')])\n"
    )
    # pytest's own folders have names too long for a socket
    with tempfile.TemporaryDirectory(prefix="h", dir="/tmp") as place:
        done = subprocess.run(
            [sys.executable, "-c", script],
            cwd=place,
            env={**os.environ, "TMPDIR": place, "PYTHONPATH": str(Path(__file__).parents[2])},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.stdout.strip() == "['hpsop-tmp-workers-']", done.stderr
        assert not done.stderr
        # and after an end in good order there is nothing left
        assert os.listdir(place) == []
