"""The page's house: its rooms import downwards, state and HTML go one way."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted(ROOT.glob("explorer/**/*.py"))
# Lowest first; a module may import modules of its own room and of lower ones. What stands alone at the top is named.
ROOMS = {"server": 1, "state": 2, "charts": 3, "scene": 3, "services": 4, "views": 5, "layout": 6, "app": 7, "start": 8}
# The state's own attributes, which views must not set, are reached by these names.
STATE_NAMES = {"session", "_session", "app", "_app"}
HTML_DOOR = "explorer.server.html_slot"


def name_of(path: Path) -> str:
    """The module's dotted name; a package's for its ``__init__``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): path for path in SOURCES}


def imported(path: Path) -> set[str]:
    """Modules of the page that a file imports, anywhere in it."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.update({node.module, *(f"{node.module}.{alias.name}" for alias in node.names)})
    return {name for name in found if name in MODULES and name != "explorer"}


def room(module: str) -> int:
    """How high a module lies."""
    return ROOMS[module.split(".")[1]]


@pytest.mark.parametrize("module", [name for name in MODULES if name != "explorer"])
def test_rooms_import_downwards(module: str):
    upwards = sorted(name for name in imported(MODULES[module]) if room(name) > room(module))
    assert not upwards, f"{module} imports upwards: {upwards}"


@pytest.mark.parametrize("module", [name for name in MODULES if name.startswith("explorer.views") or "layout" in name])
def test_views_change_the_state_by_its_methods_only(module: str):
    broken = []
    for node in ast.walk(ast.parse(MODULES[module].read_text(encoding="utf-8"))):
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
        )
        broken += [target.lineno for target in targets if _of_the_state(target)]
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            # only the state itself tells the hub
            tells = node.func.attr == "tell_all" or (node.func.attr == "changed" and _ends(node.func.value) == "hub")
            broken += [node.lineno] if tells else []
    assert not broken, f"{module}, lines {broken}: call a method of Session or AppState instead"


def _of_the_state(target: ast.expr) -> bool:
    """Whether an assignment changes an attribute of the state, or an entry of one."""
    while isinstance(target, ast.Subscript):
        target = target.value
    return isinstance(target, ast.Attribute) and _ends(target.value) in STATE_NAMES


def _ends(value: ast.expr) -> str:
    return value.attr if isinstance(value, ast.Attribute) else value.id if isinstance(value, ast.Name) else ""


@pytest.mark.parametrize("module", MODULES)
def test_html_goes_to_the_browser_through_one_door(module: str):
    used = [
        node.lineno
        for node in ast.walk(ast.parse(MODULES[module].read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute)
        and (node.attr == "add_html" or (node.attr == "content" and isinstance(node.ctx, ast.Store)))
    ]
    assert bool(used) == (module == HTML_DOOR), f"{module}, lines {used}"
