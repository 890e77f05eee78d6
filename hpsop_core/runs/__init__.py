"""Runs: the file that never loses anything, the workers, and the controller that drives a run.

A file for a thought: ``store`` (the file, as its writer sees it), ``reader`` (as everyone else does), ``schema``,
``lock``, ``records``, ``packing`` (rows of few bytes); ``executor`` (where evaluations run), ``tasks`` (what a worker
does), ``preload`` (what it has imported before it starts), ``batch`` (evaluating a generation on workers that may die);
``replay`` (the loop, and why resuming is the same loop); ``control``, ``events`` and ``controller`` (a run in the hands
of a person).
"""

from __future__ import annotations

from hpsop_core.runs.controller import RunController, front_designs, optimize
from hpsop_core.runs.reader import RunReader, open_run

__all__ = ["RunController", "RunReader", "front_designs", "open_run", "optimize"]
