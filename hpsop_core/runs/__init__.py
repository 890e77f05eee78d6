"""Runs: the file that never loses anything, the workers, and the controller that drives a run.

A file for a thought. The run file: ``store`` (as its writer sees it), ``reader`` (as everyone else does), ``content``
(its records), ``schema`` (its tables), ``migrations`` (from older tables), ``connections``, ``lock``, ``checksums``
(damage is found), ``records``, ``fronts`` (the best of everything solved), ``packing`` (rows of few bytes), ``ship``
(an own hull's and propeller's files aboard).
Where evaluations run: ``workers`` (what is asked of such a place), ``executor`` (local processes), ``dask_workers`` (a
cluster), ``tasks`` (what a worker does), ``parcels`` (what it is sent once), ``results`` (what it sends back),
``preload`` (what it has imported before it starts), ``batch`` (evaluating a generation on workers that may die). The
run: ``replay`` (the loop, and why resuming is the same loop), ``ledger`` (which number stands for which design),
``learning`` (the surfaces that a run learns), ``refinement`` (errors of its final designs), ``time_left``; ``control``,
``events`` and ``controller`` (a run in the hands of a person).
"""

from __future__ import annotations

from hpsop_core.runs.controller import RunController, front_designs, optimize
from hpsop_core.runs.reader import RunReader, open_run

__all__ = ["RunController", "RunReader", "front_designs", "open_run", "optimize"]
