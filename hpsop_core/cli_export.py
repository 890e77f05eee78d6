"""The command ``export``."""

from __future__ import annotations

import argparse
from typing import Any

from hpsop_core.runs.reader import open_run
from hpsop_core.runs.records import identifier


def add_parsers(commands: Any) -> None:
    """Add the command to the parser."""
    export = commands.add_parser("export", help="a design as CAD, meshes and tables")
    export.add_argument("run", metavar="RUN.hpsop")
    export.add_argument("--design", metavar="ID|initial|compromise", required=True, help="which (also: knee)")
    export.add_argument("--to", metavar="FOLDER", required=True, help="where; made if it is not there")
    export.add_argument("--formats", metavar="stl,glb,3dm,dxf,csv,json", help="all of these by default")
    export.add_argument("--force", action="store_true", help="replace files in a folder that is not empty")
    export.set_defaults(handler=_export)


def _export(arguments: argparse.Namespace) -> int:
    from hpsop_core.export.design_files import FORMATS, export_design

    formats = FORMATS if arguments.formats is None else [w.strip() for w in arguments.formats.split(",") if w.strip()]
    files = export_design(
        open_run(arguments.run), identifier(arguments.design), arguments.to, formats, arguments.force
    )
    for file in files:
        print(f"{file}  {file.stat().st_size / 1000.0:,.0f} kB")
    return 0
