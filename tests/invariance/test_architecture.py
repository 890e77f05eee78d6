"""The house: imports run downwards only, and files stay one thought long."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# Lowest first; a module may import its own layer and lower ones.
LAYERS = {
    "geometry": 1,
    "hydro": 2,
    "evaluation": 3,
    "quantities": 4,
    "optimization": 5,
    "runs": 6,
    "export": 7,
    "report": 8,
    "validation": 8,
    "reproduction": 9,
    "cli": 10,
    "explorer": 10,
}


def layer(module: str) -> int:
    """The layer of a module; everything that is not named above is foundation (errors, case, design, ...)."""
    package, *rest = module.split(".")
    if package == "explorer":
        return LAYERS["explorer"]
    name = rest[0] if rest else ""
    return LAYERS.get(name, 0)


def imported(path: Path) -> set[str]:
    """Modules of this project that a file imports anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    return {name for name in names if name.split(".")[0] in ("hpsop_core", "explorer")}


SOURCES = sorted([*ROOT.glob("hpsop_core/**/*.py"), *ROOT.glob("explorer/**/*.py")])


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_run_downwards(path: Path) -> None:
    module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    if module == "hpsop_core.__init__":
        return  # it re-exports the Python interface of every layer
    upwards = sorted(name for name in imported(path) if layer(name) > layer(module))
    assert not upwards, f"{module} imports upwards: {upwards}"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_geometry_and_hydro_hold_no_case_data(path: Path) -> None:
    if {"geometry", "hydro"} & set(path.relative_to(ROOT).parts):
        assert not {name for name in imported(path) if name.startswith("hpsop_core.case.case")}


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_is_one_thought(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 700


@pytest.mark.parametrize("path", sorted(ROOT.glob("explorer/**/*.py")), ids=lambda path: str(path.relative_to(ROOT)))
def test_the_page_asks_for_answers_and_computes_none(path: Path) -> None:
    # a solver is asked by hpsop_core.evaluation: what the page shows has then one calibration, one failure, one test
    assert not {name for name in imported(path) if name.startswith("hpsop_core.hydro")}
