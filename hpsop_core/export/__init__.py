"""CAD, meshes and tables of a design; called, it is ``export`` of the Python interface.

* design_files: a design's files into a folder or an archive, all of them or none; formats: which there are; design:
  what every writer gets
* surfaces: NURBS; fairing: their seams; exchange: handed to geomdl, openNURBS and OpenCASCADE; rhino: 3DM; solids:
  STEP and IGES
* meshes: STL and GLB; slivers: taken out of a mesh; lines: DXF
* vtp: waves and pressures for ParaView; panel_files: GDF; pff: the propeller free format
* sheets: drawings on paper, DXF, SVG and PDF
* openfoam: a case for viscous flow
* tables, offsets: CSV

``hpsop_core.export(run, design, folder, formats=None, force=False)`` writes a design's files, all of them or none.

Args:
    run: the run that has it (``open_run``), or a case (``load_case``).
    design: its id, "initial", "compromise" or "knee"; of a case "initial" or variables, evaluated at level 2.
    folder: made if it is not there.
    formats: any of ``formats.FORMATS``; those that need no extra and no further solution by default.
    force: write into a folder that holds something already; files of the same name are replaced, others stay.

Returns:
    The files written; metres and SI units, ship axes (docs/export.md).

Raises:
    InputError: no such design or format, a failed design, or a folder that cannot be used.
    SolverFailure: the form or its resistance curve cannot be computed.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hpsop_core.case.case import Case
    from hpsop_core.case.variables import DesignVariables
    from hpsop_core.runs.reader import RunReader


class _Export(ModuleType):
    def __call__(
        self,
        run: RunReader | Case,
        design: int | str | DesignVariables,
        folder: str | Path,
        formats: Sequence[str] | None = None,
        force: bool = False,
    ) -> tuple[Path, ...]:
        """See the module."""
        from hpsop_core.export.design_files import export_design

        return export_design(run, design, folder, formats, force)


sys.modules[__name__].__class__ = _Export
