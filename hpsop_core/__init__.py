"""hpsop: hydrodynamic optimisation of a ship's hull and propeller as one system. The method, headless.

>>> from hpsop_core import load_case, evaluate, optimize, open_run
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hpsop_core.case.case import load_case
    from hpsop_core.evaluation.evaluate import evaluate
    from hpsop_core.runs import open_run, optimize

__version__ = "0.1.0"
__all__ = ["__version__", "evaluate", "load_case", "open_run", "optimize"]

_HOMES = {
    "load_case": "hpsop_core.case.case",
    "evaluate": "hpsop_core.evaluation.evaluate",
    "optimize": "hpsop_core.runs",
    "open_run": "hpsop_core.runs",
}


def __getattr__(name: str) -> Any:
    """The Python interface, imported when it is first used: a mistyped command answers without loading the solvers."""
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'hpsop_core' has no attribute '{name}'")
