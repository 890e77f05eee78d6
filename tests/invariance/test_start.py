"""A command loads what it needs and no more: what it loads is most of the time that a first answer takes."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from hpsop_core.cli.main import _ROOMS, build_parser

# What a level-1 evaluation of a shipped case has no use for, each a tenth of a second or more with what it loads.
NOT_FOR_ONE_ANSWER = (
    "dask",
    "geomdl",
    "hpsop_core.geometry.hull.fit",
    "hpsop_core.optimization.nsga2",
    "hpsop_core.runs",
    "matplotlib",
    "numba",
    "numpy.f2py.crackfortran",
    "numpy.testing._private",
    "pymoo",
    "scipy.ndimage",
    "scipy.stats",
    "trimesh",
    "viser",
)
COMMAND = "import sys; from hpsop_core.cli.main import main; main(['evaluate', 'dtc-p4119']); print(*sys.modules)"


def test_one_answer_loads_its_solvers_alone() -> None:
    done = subprocess.run([sys.executable, "-c", COMMAND], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert "hpsop_core.hydro.michell" in loaded
    assert not loaded & set(NOT_FOR_ONE_ANSWER)


def test_a_front_that_has_its_errors_is_shown_without_a_solver() -> None:
    command = (
        "import sys; from hpsop_core.cli.main import main; from hpsop_core.assets import asset_path;"
        "main(['show', str(asset_path('demo') / 'dtc-p4119.hpsop'), '--front']); print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert "hpsop_core.evaluation.stated_errors" in loaded
    assert not loaded & {*NOT_FOR_ONE_ANSWER, "scipy.interpolate"} - {"hpsop_core.runs"}


def test_the_page_has_its_address_before_what_only_a_chart_asks_for() -> None:
    command = "import sys; import explorer.app; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    assert not set(done.stdout.split()) & {"dask", "geomdl", "matplotlib", "numba", "pymoo", "scipy.stats"}


def test_what_libraries_look_for_is_there_again_afterwards() -> None:
    command = (
        "import inspect, sys\n"
        "from hpsop_core.lean_imports import lean_imports\n"
        "with lean_imports():\n"
        "    import scipy.special, numba\n"
        "assert not {'cffi', 'yaml', 'numpy.f2py.crackfortran', 'numpy.testing._private'} & set(sys.modules)\n"
        "import cffi, numpy\n"
        "numpy.testing.assert_array_equal(numpy.zeros(2), 0.0)\n"
        "assert numpy.f2py.get_include() and inspect.getdoc(inspect.getdoc)\n"
    )
    subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)


def test_a_worker_that_the_page_starts_does_not_load_the_page() -> None:
    """multiprocessing imports the program's main module, the command's script, in each of them."""
    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    module, _, name = project["project"]["scripts"]["hpsop-explore"].partition(":")
    command = f"import sys; from {module} import {name}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    assert not set(done.stdout.split()) & {"numpy", "viser", "explorer.app"}


def test_the_page_s_command_ends_though_a_thread_does_not() -> None:
    """One that waits for a browser's answer, say: Python would wait for it after everything is closed."""
    command = (
        "import atexit, sys, threading, time, types; sys.modules['explorer.app'] = page = types.ModuleType('app');"
        "page.main = lambda: threading.Thread(target=time.sleep, args=(3600,)).start() or print('closed') or 2;"
        "atexit.register(print, 'tidied'); from explorer.start import main; sys.exit(main())"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (2, "closed\ntidied\n", "")


def _commands(parser: argparse.ArgumentParser) -> set[str]:
    actions = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    return {name for action in actions for name in action.choices}


def test_an_interrupt_while_the_page_loads_is_one_line() -> None:
    """A second or two, in which nothing listens to Ctrl-C yet."""
    command = (
        "import os, signal, sys\n"
        "class Pressed:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'explorer.layout': os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Pressed())\n"
        "from explorer.start import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "hpsop-explore: interrupted\n")


@pytest.mark.parametrize("name", [name for names in _ROOMS.values() for name in names])
def test_a_command_is_where_it_is_looked_for(name: str) -> None:
    assert name in _commands(build_parser(name))


def test_help_names_all_commands() -> None:
    named = {name for names in _ROOMS.values() for name in names}
    assert _commands(build_parser()) == _commands(build_parser("evalaute")) == named
