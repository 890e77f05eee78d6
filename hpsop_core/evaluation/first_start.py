"""The first start after an installation: the true level's kernels are compiled, once, by two processes.

numba keeps what it compiled (``compiled``); whoever compiles alone waits five seconds, two processes three.
``python -m hpsop_core.evaluation.first_start`` is the second one, and what an installation may run beforehand.
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
from collections.abc import Callable

from hpsop_core.case.case import DEFAULT_CASE, Case, load_case
from hpsop_core.compiled import is_missing
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.evaluation.propeller_answer import blade_drag, propeller_answer, propeller_variables
from hpsop_core.evaluation.shapes import design_hull

_LONGEST = 120.0  # seconds that the second process is waited for; without it this one compiles alone


def compile_kernels(case: Case, tell: Callable[[str], None]) -> None:
    """Compile what the true level needs, where that has not been done; nothing fails here that would not fail later.

    Args:
        case: whose initial propeller is solved on the way; its answer is remembered.
        tell: told that this takes a moment, if it does.
    """
    from hpsop_core.hydro.singularities import dipole_panels, source_panels

    kernels = (source_panels._panel_velocities, dipole_panels._body_influence)
    if not any(map(is_missing, kernels)):
        return
    tell("the solvers are being compiled, once after an installation: some seconds")
    with (
        contextlib.suppress(OSError, subprocess.TimeoutExpired),
        subprocess.Popen(
            [sys.executable, "-m", __spec__.name],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as second,
    ):
        key = propeller_variables(case.propeller, case.initial.variables)
        try:
            with contextlib.suppress(SolverFailure):
                propeller_answer(key, TRUTH.number, blade_drag(case.constants))
            second.wait(_LONGEST)
        finally:
            second.kill()


def compile_waves() -> None:
    """Compile what solves waves, by solving the shipped hull's."""
    case = load_case(DEFAULT_CASE)
    TRUTH.solve_waves(design_hull(case, case.initial.variables), case.froude_numbers[:1])


if __name__ == "__main__":
    compile_waves()
