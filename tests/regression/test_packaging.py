"""What is installed, and that the declared lower bounds are the versions that `make test-oldest` runs with."""

from __future__ import annotations

import importlib.metadata
import json
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def pinned(file: str) -> dict[str, str]:
    lines = (ROOT / file).read_text(encoding="utf-8").splitlines()
    pairs = [line.split("==") for line in lines if line and not line.startswith("#")]
    return {normal(name): version for name, version in pairs}


def numbers(version: str) -> tuple[int, ...]:
    found = [int(part) for part in re.findall(r"\d+", version)]
    while found and found[-1] == 0:
        found.pop()
    return tuple(found)


def needs() -> list[tuple[str, str]]:
    """(name, lower bound) of every dependency at run time and of the extra `dask`."""
    lines = [*PROJECT["project"]["dependencies"], *PROJECT["project"]["optional-dependencies"]["dask"]]
    return [(normal(m[1]), m[2]) for line in lines if (m := re.match(r"([\w.-]+)(?:\[\w+\])?[>=]=([\d.]+)", line))]


def test_every_need_has_a_lower_bound_that_the_oldest_versions_are() -> None:
    oldest, newest = pinned("constraints-oldest.txt"), pinned("constraints.txt")
    declared = needs()
    assert len(declared) == len(PROJECT["project"]["dependencies"]) + 1
    for name, lower in declared:
        assert numbers(oldest[name]) == numbers(lower), name
        assert name in newest and numbers(newest[name]) >= numbers(lower), name


def test_one_version_stands_everywhere() -> None:
    from hpsop_core import __version__

    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    stated = re.findall(r"^version: (.+)$", citation, re.MULTILINE)
    assert [PROJECT["project"]["version"], *stated] == [__version__, __version__]
    assert re.search(r"^date-released: \d{4}-\d\d-\d\d$", citation, re.MULTILINE)
    assert re.search(r"^license: MIT$", citation, re.MULTILINE) and PROJECT["project"]["license"] == "MIT"


def test_contents_of_the_wheel() -> None:
    distribution = importlib.metadata.distribution("hpsop")
    record = distribution.read_text("direct_url.json")
    # A checkout that was ever installed shows an egg-info, which has no such record.
    if record is None or json.loads(record).get("dir_info", {}).get("editable"):
        pytest.skip("installed from the checkout; `make test-oldest` looks into the wheel")
    files = {file.as_posix() for file in distribution.files or ()}
    tops = {file.split("/")[0] for file in files if ".dist-info/" not in file and not file.startswith("..")}
    assert tops == {"hpsop_core", "explorer", "hpsop_assets"}
    assert {"hpsop_core/py.typed", "hpsop_core/cli/__main__.py"} <= files
    for folder, ending in (("explorer/assets/", ".js"), ("hpsop_assets/cases/", ".toml"), ("hpsop_assets/", ".hpsop")):
        assert any(file.startswith(folder) and file.endswith(ending) for file in files), folder


def test_the_files_that_are_listed_for_the_oldest_versions_exist() -> None:
    text = (ROOT / "tests" / "conftest.py").read_text(encoding="utf-8")
    listed = re.findall(r'^    "([\w/]+\.py)":', text, re.MULTILINE)
    assert len(listed) > 10
    assert [name for name in listed if not (ROOT / "tests" / name).exists()] == []
