"""What is installed with hpsop, what the source archive holds, and that nothing calls out."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import pytest
from no_calls_out import CALLS_OUT

from tools import licences

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
HASHED = sorted((ROOT / "constraints").glob("*.txt"))


def pins(path: Path) -> dict[str, str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    found = [re.match(r"([A-Za-z0-9._-]+)==([^\s\\]+)", line) for line in lines]
    return {licences.normal(match[1]): match[2] for match in found if match}


def test_every_dependency_stands_in_the_list_of_licences() -> None:
    text = licences.PAGE.read_text(encoding="utf-8")
    listed = dict(re.findall(r"^\| ([\w.-]+) \| (.+) \|$", text, re.MULTILINE))
    missing = [name for name in licences.needed() if name not in listed]
    assert not missing, f"run python -m tools.licences; not listed: {missing}"
    unknown = [name for name, words in listed.items() if "see its project" in words]
    assert not unknown
    # whatever is not purely permissive is explained above the table
    explained = text.partition("| Package |")[0]
    for name, words in listed.items():
        if licences.NOT_PERMISSIVE.search(words):
            assert name in explained, name


@pytest.mark.parametrize("path", HASHED, ids=lambda path: path.name)
def test_hashed_pins_are_the_pins(path: Path) -> None:
    """One command writes them (`make lock`); a version that was changed by hand in one place only is found here."""
    pinned = pins(ROOT / "constraints.txt")
    hashed = pins(path)
    assert len(hashed) > 20
    for name, version in hashed.items():
        assert pinned.get(name, version) == version, name
    text = path.read_text(encoding="utf-8")
    assert len(re.findall(r"--hash=sha256:[0-9a-f]{64}\b", text)) >= len(hashed)


def test_the_source_archive_is_complete(tmp_path: Path) -> None:
    """Built from what git tracks, it holds all of it, so that `make test` runs from it."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("no checkout")
    tracked = [name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]
    source = tmp_path / "source"
    for name in tracked:
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, source / name)
    code = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], cwd=source, capture_output=True, text=True, check=False
    )
    if "No module named 'setuptools'" in done.stderr:
        pytest.skip("setuptools is not installed beside the tests")
    assert done.returncode == 0, done.stderr[-2000:]
    (archive,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(archive) as file:
        held = {name.partition("/")[2] for name in file.getnames()}
    missing = sorted(set(tracked) - held - {".gitignore", ".gitattributes", "MANIFEST.in"})
    assert not missing


def test_the_versions_of_python_that_are_named_are_those_that_are_allowed() -> None:
    named = [line.rpartition(" ")[2] for line in PROJECT["classifiers"] if re.search(r"Python :: 3\.\d+$", line)]
    assert named == ["3.11", "3.12", "3.13"]
    assert PROJECT["requires-python"] == ">=3.11"
    assert f"{sys.version_info.major}.{sys.version_info.minor}" in named


def test_a_call_out_is_noticed() -> None:
    """The guard of the whole suite (tests/conftest.py): a connection that leaves the machine is refused and counted."""
    before = len(CALLS_OUT)
    for call in (
        lambda: socket.create_connection(("203.0.113.7", 80), timeout=1.0),
        lambda: socket.getaddrinfo("hpsop.example", 80),
        lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"x", ("203.0.113.7", 53)),
    ):
        with pytest.raises(PermissionError, match="leaves the machine"):
            call()
    assert len(CALLS_OUT) == before + 3
    del CALLS_OUT[before:]
