"""hpsop: hydrodynamic optimisation of a ship's hull and propeller as one system. The method, headless.

The whole Python interface; the command ``hpsop`` is thin over it:

=================  =====================================================================================
load_case          a case: what is optimised, within what, on which conditions
evaluate           everything about one design of a case at a level of fidelity; a failure is a value
optimize           a search to its end, or on with one that was interrupted; a run file keeps everything
open_run           what a run file holds, also while it is being written
resistance         resistance of a design, or of a hull at hand, over Froude numbers
open_water         KT, KQ and efficiency of a design's propeller, or of one at hand, over J
hydrostatics       volume, coefficients and centres of a design's hull, or of one at hand
waves, pressures   the wave field and the pressures on hull and blades of a design
load_hull          a hull from a table of offsets or a closed mesh
load_propeller     a propeller from a radial table
export             a design of a run as CAD, meshes and tables
report             a run as one HTML file
to_geomdl          hull or propeller as geomdl's NURBS surfaces
=================  =====================================================================================

>>> from hpsop_core import evaluate, load_case
>>> evaluate(load_case("dtc-p4119-paper")).objectives["f1"]
1.0

What stands where, from the ground up: ``typing_aliases``, ``errors``, ``reading`` (files that strangers name),
``scratch`` (temporary folders), ``writing`` (whole files), ``version``, ``model_test``, ``markup`` (escaping),
``lean_imports``, ``one_thread`` (the same bits everywhere), ``standard_streams``, ``compiled`` (kernels),
``kept_memory`` (of solvers) and ``assets`` (shipped files); ``geometry`` (shapes), ``hydro`` (solvers), ``machinery``
(the engine), ``case`` (what the user states), ``evaluation`` (a design's numbers), ``quantities`` (how they are
written), ``charts`` (how they are drawn), ``optimization`` (the search), ``runs`` (the file, the workers, the
controller); ``export``, ``report``, ``validation`` and ``reproduction``; ``cli`` (the commands). Each imports only from
those before it; each folder's docstring says what its files are for.

SI units, radians inside; ship axes x forward from the after perpendicular, y to port, z up (docs/conventions.md).
Everything is frozen. Bad input raises ``hpsop_core.errors.InputError``, one line with the remedy.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from hpsop_core.version import __version__

if TYPE_CHECKING:
    from hpsop_core.case.case import load_case
    from hpsop_core.evaluation.evaluate import evaluate
    from hpsop_core.evaluation.fields import pressures, waves
    from hpsop_core.evaluation.open_water import open_water
    from hpsop_core.evaluation.resistance import hydrostatics, resistance
    from hpsop_core.export.design_files import export_design as export
    from hpsop_core.export.exchange import to_geomdl
    from hpsop_core.geometry.from_files import load_hull, load_propeller
    from hpsop_core.report.report import write_report as report
    from hpsop_core.runs import open_run, optimize

__all__ = [
    "__version__",
    "evaluate",
    "export",
    "hydrostatics",
    "load_case",
    "load_hull",
    "load_propeller",
    "open_run",
    "open_water",
    "optimize",
    "pressures",
    "report",
    "resistance",
    "to_geomdl",
    "waves",
]

_HOMES = {
    "load_case": "hpsop_core.case.case",
    "evaluate": "hpsop_core.evaluation.evaluate",
    "optimize": "hpsop_core.runs",
    "open_run": "hpsop_core.runs",
    "resistance": "hpsop_core.evaluation.resistance",
    "hydrostatics": "hpsop_core.evaluation.resistance",
    "open_water": "hpsop_core.evaluation.open_water",
    "waves": "hpsop_core.evaluation.fields",
    "pressures": "hpsop_core.evaluation.fields",
    "to_geomdl": "hpsop_core.export.exchange",
    "load_hull": "hpsop_core.geometry.from_files",
    "load_propeller": "hpsop_core.geometry.from_files",
}
# Packages that bear the function's own name and answer calls (each says so in its __init__): Python makes a package an
# attribute of its parent once it is imported, so that no function of that name could stay here.
_PACKAGES = ("export", "report")


def __getattr__(name: str) -> Any:
    """The Python interface, imported when it is first used: a mistyped command answers without loading the solvers."""
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    if name in _PACKAGES:
        return importlib.import_module(f"hpsop_core.{name}")
    raise AttributeError(f"module 'hpsop_core' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
