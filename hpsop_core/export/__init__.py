"""CAD, meshes and tables of a design; called, it is ``export`` of the Python interface.

* design_files: a design's files into a folder or an archive, all of them or none
* surfaces, rhino: NURBS, and Rhino's file of them
* meshes: STL and GLB; lines: DXF
* tables, offsets: CSV
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hpsop_core.runs.reader import RunReader


class _Export(ModuleType):
    def __call__(
        self,
        run: RunReader,
        design: int | str,
        folder: str | Path,
        formats: Sequence[str] | None = None,
        force: bool = False,
    ) -> tuple[Path, ...]:
        """``design_files.export_design``."""
        from hpsop_core.export.design_files import export_design

        return export_design(run, design, folder, formats, force)


sys.modules[__name__].__class__ = _Export
