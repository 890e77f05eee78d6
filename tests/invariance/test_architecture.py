"""The house: imports run downwards and without circles, files stay one thought long, folders say what is in them.

Every import counts, those inside functions and those for type checkers as well: a file that cannot be read without
another one depends on it, whenever Python happens to load it.
"""

from __future__ import annotations

import ast
import graphlib
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest

from hpsop_core.version import __version__

ROOT = Path(__file__).resolve().parents[2]
TREES = ("hpsop_core", "explorer", "tools")
# Lowest first: rooms of hpsop_core import only from those before them, and from themselves. The last two stand upon it.
ORDER = (
    "typing_aliases",
    "errors",
    "reading",
    "scratch",
    "writing",
    "version",
    "model_test",
    "markup",
    "units",
    "lean_imports",
    "one_thread",
    "standard_streams",
    "kept_memory",
    "compiled",
    "assets",
    "geometry",
    "hydro",
    "machinery",
    "case",
    "evaluation",
    "quantities",
    "charts",
    "optimization",
    "runs",
    "export",
    "report",
    "validation",
    "reproduction",
    "interface",
    "cli",
    "explorer",
    "tools",
)
LONGEST_FILE = 700
# Of a browser, of the page, or of the pictures of the documentation: the method runs without.
NOT_IN_THE_CORE = ("explorer", "tools", "tests", "viser", "playwright", "websockets", "matplotlib")


def module_name(path: Path) -> str:
    """Dotted name of a file relative to the root; a package's is that of its folder."""
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def sources(root: Path = ROOT) -> dict[str, Path]:
    """Module name -> file of everything in the trees."""
    found = [path for tree in TREES for path in sorted((root / tree).rglob("*.py"))]
    return {module_name(path.relative_to(root)): path for path in found}


def imported(module: str, modules: Mapping[str, Path]) -> set[str]:
    """What a module imports anywhere in it: modules of the project under their own names, all others as written."""
    path = modules[module]
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) + 1 - node.level] if node.level else []
            base = ".".join([*start, *([node.module] if node.module else [])])
            whole = [f"{base}.{alias.name}" for alias in node.names]
            names.update(name if name in modules else base for name in whole)
        elif isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__"):
            names.update(arg.value for arg in node.args if isinstance(arg, ast.Constant) and isinstance(arg.value, str))
    return names


def _called(call: ast.Call) -> str:
    return str(getattr(call.func, "attr", getattr(call.func, "id", "")))


def import_graph(modules: Mapping[str, Path]) -> dict[str, set[str]]:
    """Module -> modules of the project that it imports."""
    return {name: imported(name, modules) & modules.keys() - {name} for name in modules}


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """Nodes of one circle, each imported by the one before it; empty where there is none."""
    try:
        tuple(graphlib.TopologicalSorter(graph).static_order())
    except graphlib.CycleError as found:
        return list(reversed(found.args[1]))
    return []


def room(module: str) -> str:
    """The entry of ``ORDER`` that a module belongs to."""
    tree, *rest = module.split(".")
    if tree != "hpsop_core":
        return tree
    return rest[0] if rest else "interface"


MODULES = sources()
GRAPH = import_graph(MODULES)


def test_every_room_has_its_place_in_the_order() -> None:
    assert sorted({room(module) for module in MODULES}) == sorted(ORDER), "ORDER names each room of the tree once"


def test_imports_run_downwards() -> None:
    upwards = [
        f"{module} imports {other}"
        for module, others in GRAPH.items()
        for other in sorted(others)
        if ORDER.index(room(other)) > ORDER.index(room(module))
    ]
    assert not upwards, upwards


def test_no_circle_of_modules() -> None:
    assert not circle(GRAPH), " -> ".join(circle(GRAPH))


def test_no_circle_of_folders() -> None:
    """A folder that holds no other is one node; the files of one that does stand beside its folders."""
    parents = {path.parent.parent for path in MODULES.values()}

    def node(module: str) -> str:
        folder = MODULES[module].parent
        return module if folder in parents else str(folder.relative_to(ROOT))

    folders: dict[str, set[str]] = {}
    for module, others in GRAPH.items():
        folders.setdefault(node(module), set()).update(node(other) for other in others if node(other) != node(module))
    assert not circle(folders), " -> ".join(circle(folders))


def test_the_core_knows_no_page_and_no_browser() -> None:
    found = [
        f"{module} imports {name}"
        for module in MODULES
        if room(module) not in ("explorer", "tools")
        for name in sorted(imported(module, MODULES))
        if name.split(".")[0] in NOT_IN_THE_CORE
    ]
    assert not found, found


def test_the_page_asks_for_answers_and_computes_none() -> None:
    # Solvers are asked by hpsop_core.evaluation: what the page shows has then one calibration, one failure, one test.
    found = [f"{module} imports {other}" for module, others in GRAPH.items() if room(module) == "explorer"
             for other in sorted(others) if room(other) == "hydro"]  # fmt: skip
    assert not found, found


# g, water's density, knots in m/s and km/h: whoever writes one of them is about to compute something.
CONSTANTS_OF_PHYSICS = (9.80665, 9.81, 1025.0, 1026.0, 999.1, 1000.0 / 1852.0, 1852.0, 0.5144, 0.514444)


def test_the_page_holds_no_constant_of_physics() -> None:
    found = [
        f"{module}:{node.lineno} {node.value}"
        for module, path in MODULES.items()
        if room(module) == "explorer"
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and node.value in CONSTANTS_OF_PHYSICS
    ]
    assert not found, found


def test_geometry_and_hydro_hold_no_case_data() -> None:
    found = [f"{module} imports {other}" for module, others in GRAPH.items()
             if room(module) in ("geometry", "hydro", "machinery")
             for other in sorted(others) if room(other) == "case"]  # fmt: skip
    assert not found, found


def test_kernels_stand_alone() -> None:
    kernels = [module for module in MODULES if module.startswith("hpsop_core.hydro.singularities.")]
    outside = {other for module in kernels for other in GRAPH[module]} - set(kernels)
    # what types are called, and how a function is compiled
    outside -= {"hpsop_core.typing_aliases", "hpsop_core.compiled"}
    assert kernels
    assert not outside, outside


def test_a_file_is_one_thought() -> None:
    lengths = {module: len(path.read_text(encoding="utf-8").splitlines()) for module, path in MODULES.items()}
    long = {module: length for module, length in lengths.items() if length > LONGEST_FILE}
    assert not long, long


def unnamed(folder: Path) -> list[str]:
    """Files and folders of a package that its docstring does not name."""
    first = folder / "__init__.py"
    plan = (ast.get_docstring(ast.parse(first.read_text(encoding="utf-8"))) if first.exists() else None) or ""
    inside = [path.stem for path in folder.glob("*.py") if not path.stem.startswith("__")]
    inside += [path.parent.name for path in folder.glob("*/__init__.py")]
    return sorted(name for name in inside if not re.search(rf"\b{name}\b", plan))


FOLDERS = sorted({path.parent for path in MODULES.values()})


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.relative_to(ROOT)))
def test_a_folder_has_its_floor_plan(folder: Path) -> None:
    missing = unnamed(folder)
    assert not missing, f"{folder.relative_to(ROOT)}/__init__.py does not say what these are for: {missing}"


def test_packages_installed_are_the_folders_of_the_tree() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    declared = project["tool"]["setuptools"]["packages"]
    folders = {".".join(folder.relative_to(ROOT).parts) for folder in FOLDERS}
    installed = {name for name in folders if name.split(".")[0] != "tools"}
    # assets/ is installed as a package of data.
    assert sorted(declared) == sorted({*installed, "hpsop_assets"})


def test_one_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert __version__ == project["project"]["version"]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("from hpsop_core.b import B\n", "def late():\n    from hpsop_core.a import A\n"),
        ("import hpsop_core.b\n", "if TYPE_CHECKING:\n    from hpsop_core import a\n"),
        ("from .b import B\n", "import importlib\nimportlib.import_module('hpsop_core.a')\n"),
        ("from hpsop_core.b import B\n", "from . import a\n"),
    ],
)
def test_a_circle_is_found_however_it_is_imported(tmp_path: Path, first: str, second: str) -> None:
    folder = tmp_path / "hpsop_core"
    folder.mkdir()
    for name, text in (("__init__", ""), ("a", first), ("b", second)):
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    found = circle(import_graph(sources(tmp_path)))
    assert set(found) == {"hpsop_core.a", "hpsop_core.b"}
    (folder / "b.py").write_text("", encoding="utf-8")
    assert not circle(import_graph(sources(tmp_path)))
