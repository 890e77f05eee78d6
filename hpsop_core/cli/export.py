"""The commands ``export``, ``report`` and ``reproduce``."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from pathlib import Path
from typing import Any

from hpsop_core.case.case import load_case
from hpsop_core.cli.arguments import add_set, case_and_design
from hpsop_core.cli.driving import INTERRUPTED, Progress, driven
from hpsop_core.errors import InputError
from hpsop_core.export.formats import FORMATS, USUAL_FORMATS
from hpsop_core.runs.controller import RunController
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.records import identifier

CASE_NAME = "dtc-p4119-paper"


def add_parsers(commands: Any) -> None:
    """Add the commands to the parser."""
    export = commands.add_parser("export", help="a design as CAD, meshes and tables")
    export.add_argument("run", metavar="RUN.hpsop | CASE", help="a run file, or a case for its initial design")
    export.add_argument("--design", metavar="ID|initial|compromise", help="which of a run's (also: knee)")
    add_set(export)
    export.add_argument("--to", metavar="FOLDER", required=True, help="where; made if it is not there")
    export.add_argument(
        "--formats", metavar="stl,glb,3dm,...", help=f"any of {','.join(FORMATS)}; {','.join(USUAL_FORMATS)} by default"
    )
    export.add_argument("--force", action="store_true", help="replace files in a folder that is not empty")
    export.set_defaults(handler=_export)

    report = commands.add_parser("report", help="a run as one HTML file to print or pass on")
    report.add_argument("run", metavar="RUN.hpsop", help="finished or not")
    report.add_argument("--to", metavar="report.html", required=True, help="the file")
    report.add_argument("--force", action="store_true", help="replace it if it is there")
    report.set_defaults(handler=_report)

    reproduce = commands.add_parser("reproduce", help="the paper's tables and figures beside ours")
    reproduce.add_argument("--to", metavar="FOLDER", required=True, help="for page, tables, run; a run in it goes on")
    reproduce.add_argument(
        "--run", metavar="RUN.hpsop", help=f"show this run as it is, of {CASE_NAME} or any other case"
    )
    reproduce.add_argument("--generations", type=int, metavar="TOTAL", help="fewer for a first look; 150 by default")
    reproduce.add_argument("--population", type=int, metavar="N", help="fewer for a first look; 50 by default")
    reproduce.add_argument("--workers", type=int, metavar="N", help="local processes; one a core by default")
    reproduce.set_defaults(handler=_reproduce)


def _export(arguments: argparse.Namespace) -> int:
    from hpsop_core import export

    formats = None if arguments.formats is None else [w.strip() for w in arguments.formats.split(",") if w.strip()]
    if _is_run(arguments.run):
        if arguments.design is None:
            raise InputError(f"{arguments.run}: say which design of this run, --design ID|initial|compromise|knee")
        if arguments.changes:
            raise InputError(f"{arguments.run}: --set changes a case's design; a run's are as they are, leave it away")
        files = export(open_run(arguments.run), identifier(arguments.design), arguments.to, formats, arguments.force)
    else:
        if arguments.design not in (None, "initial"):
            raise InputError(
                f"{arguments.run}: is a case, and --design {arguments.design} is of a run; leave it away for the "
                "initial design, or name a run file"
            )
        case, variables = case_and_design(arguments.run, arguments.changes)
        files = export(case, variables, arguments.to, formats, arguments.force)
    for file in files:
        print(_with_size(file))
    return 0


def _is_run(name: str) -> bool:
    """A run file, whatever it is called, or what is called like one; everything else is a case."""
    if name.endswith(".hpsop"):
        return True
    try:
        with open(name, "rb") as file:
            return file.read(15) == b"SQLite format 3"
    except OSError:
        return False


def _report(arguments: argparse.Namespace) -> int:
    from hpsop_core import report

    print(_with_size(report(open_run(arguments.run), arguments.to, arguments.force)))
    return 0


def _reproduce(arguments: argparse.Namespace) -> int:
    from hpsop_core.reproduction.reproduce import checked_run, made_folder, run_path, write_reproduction

    asked = [name for name in ("generations", "population", "workers") if getattr(arguments, name) is not None]
    if arguments.run is not None:
        if asked:
            raise InputError(f"reproduce: --run takes a run as it is; leave --{asked[0]} or --run away")
        run = open_run(arguments.run)
        made_folder(arguments.to)
    else:
        path = run_path(arguments.to)
        if os.path.exists(path) and path.stat().st_size:
            checked_run(open_run(path))
        if not _searched(path, arguments):
            return INTERRUPTED
        run = open_run(path)
    for file in write_reproduction(run, arguments.to):
        print(_with_size(file))
    return 0


def _searched(path: Path, arguments: argparse.Namespace) -> bool:
    """Search to the end, or go on with it; False if a person interrupted it."""
    progress = Progress(sys.stderr)
    with RunController(
        path,
        load_case(CASE_NAME),
        generations=arguments.generations,
        population=arguments.population,
        workers=arguments.workers,
    ) as controller:
        settings, total = controller.case.optimization, controller.snapshot().generations
        progress.line(f"{CASE_NAME}: {total} generations of {settings.population}; {path}")
        controller.subscribe(progress)
        finished = driven(controller, progress)
        snapshot = controller.snapshot()
    progress.end()
    if not finished:
        words = ["hpsop", "reproduce", "--to", arguments.to]
        print(
            f"paused in generation {min(snapshot.generation + 1, snapshot.generations)} of {snapshot.generations}; all "
            f"that is finished is kept. Go on with: {shlex.join(words)}\n"
            f"or see what is there: {shlex.join([*words, '--run', str(path)])}",
            file=sys.stderr,
        )
    return finished


def _with_size(file: Path) -> str:
    return f"{file}  {file.stat().st_size / 1000.0:,.0f} kB"
