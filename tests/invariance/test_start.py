"""A command loads what it needs and no more: what it loads is most of the time that a first answer takes."""

from __future__ import annotations

import argparse
import subprocess
import sys

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


def _commands(parser: argparse.ArgumentParser) -> set[str]:
    actions = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    return {name for action in actions for name in action.choices}


@pytest.mark.parametrize("name", [name for names in _ROOMS.values() for name in names])
def test_a_command_is_where_it_is_looked_for(name: str) -> None:
    assert name in _commands(build_parser(name))


def test_help_names_all_commands() -> None:
    named = {name for names in _ROOMS.values() for name in names}
    assert _commands(build_parser()) == _commands(build_parser("evalaute")) == named
