"""The commands ``hull`` and ``propeller``: what was understood of a user's own file."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.case.fields import FieldRule
from hpsop_core.cli.arguments import add_json, checked_option, print_json
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.geometry.hull.input.options import UNITS, Axes, ReadOptions
from hpsop_core.writing import refuse_to_replace, write_whole

LENGTH_RULE = FieldRule("number", "", "m", 0.1, 600.0)
DRAFT_RULE = FieldRule("number", "", "m", 0.005, 40.0)
BREADTH_RULE = FieldRule("number", "", "m", 0.02, 100.0)
AXES_WORDS = "bow=+x|-x,origin=ap|midship|fp,waterline=draft|z0,up=z|-z|y|-y"


def add_reading(parser: argparse.ArgumentParser) -> None:
    """--length, --draft, --breadth, --unit and --axes."""
    parser.add_argument("--length", metavar="L", help="Lpp in m")
    parser.add_argument("--draft", metavar="D", help="still water above the baseline in m")
    parser.add_argument("--breadth", metavar="B", help="in m; for a table in fractions of B/2 that does not state it")
    parser.add_argument("--unit", metavar="|".join(UNITS), help="the file's unit of length")
    parser.add_argument("--axes", metavar=AXES_WORDS, help="how the file's axes lie in the ship; any of these")


def read_options(arguments: argparse.Namespace) -> ReadOptions:
    """What the options of ``add_reading`` say.

    Raises:
        InputError: a number outside its limits, an unknown unit or axis.
    """
    return ReadOptions(
        length=checked_option(arguments.length, LENGTH_RULE, "--length"),
        draft=checked_option(arguments.draft, DRAFT_RULE, "--draft"),
        breadth=checked_option(arguments.breadth, BREADTH_RULE, "--breadth"),
        unit=arguments.unit,
        axes=Axes.from_words(arguments.axes or ""),
    )


def add_parsers(commands: Any) -> None:
    """Add the two commands to the parser."""
    hull = commands.add_parser("hull", help="what is understood of a hull file: figures, picture, a ready case")
    hull.add_argument("file", metavar="FILE", help="table (CSV, text), STL, OBJ, PLY, OFF, GLB, 3dm, STEP or IGES")
    add_reading(hull)
    hull.add_argument("--picture", metavar="OUT.svg|png", help="body plan, profile and sectional areas")
    hull.add_argument("--case", metavar="OUT.toml", help="a case file for this ship")
    hull.add_argument("--force", action="store_true", help="replace a case file, or a --picture that is none")
    add_json(hull)
    hull.set_defaults(handler=_hull)

    propeller = commands.add_parser("propeller", help="what is understood of a propeller's radial table")
    propeller.add_argument("file", metavar="FILE", help="r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c under any names in use")
    propeller.add_argument("--blades", metavar="Z", required=True, help="number of blades")
    propeller.add_argument("--picture", metavar="OUT.svg|png", help="outline, sections, pitch and thickness")
    propeller.add_argument("--force", action="store_true", help="replace a --picture that is there and is none")
    add_json(propeller)
    propeller.set_defaults(handler=_propeller)


def _hull(arguments: argparse.Namespace) -> int:
    from hpsop_core.geometry.hull.input import read_hull

    options = read_options(arguments)
    picture = _picture_path(arguments.picture, arguments.force)
    case_path = None if arguments.case is None else Path(arguments.case)
    if case_path is not None:
        refuse_to_replace(case_path, arguments.force)
    file = read_hull(arguments.file, options)
    written = []
    left = ""
    if picture is not None:
        from hpsop_core.charts.own_files import hull_sheet

        _write_picture(hull_sheet(file), picture)
        written.append(picture)
    if case_path is not None:
        from hpsop_core.case.ready_case import ready_case

        path = os.path.relpath(Path(arguments.file).resolve(), case_path.resolve().parent)
        case, left = _solvable(ready_case(file, path, options), Path(arguments.file).resolve())
        write_whole(case_path, case.to_toml())
        written.append(case_path)
    if arguments.json:
        told = file.understood.as_dict()
        warnings = [*file.understood.warnings, *([left] if left else [])]
        print_json({**told, "warnings": warnings, "written": [str(path) for path in written]})
    else:
        lines = [str(file.understood), *([f"warning: {left}"] if left else [])]
        print("\n".join([*lines, *(f"written: {path}" for path in written)]))
    return 0


def _solvable(case: Case, file: Path) -> tuple[Case, str]:
    """The case as it can be solved, and what had to be left for that; it names its file relative to itself."""
    from hpsop_core.evaluation.solvable import solvable_case

    try:
        solved, left = solvable_case(case.replaced("hull", file=str(file)))
    except HpsopError as error:
        return case, f"the case has no numbers as it stands ({error}); change its speeds, propeller or bounds"
    return solved.replaced("hull", file=case.hull.file), left


def _propeller(arguments: argparse.Namespace) -> int:
    from hpsop_core.geometry.propeller.input import read_propeller

    blades = int(checked_option(arguments.blades, FieldRule("integer", "", "", 2, 7), "--blades") or 0)
    picture = _picture_path(arguments.picture, arguments.force)
    told = read_propeller(arguments.file, blades)
    if picture is not None:
        from hpsop_core.charts.own_files import propeller_sheet

        _write_picture(propeller_sheet(told), picture)
    if arguments.json:
        print_json({**told.as_dict(), "written": [] if picture is None else [str(picture)]})
    else:
        print("\n".join([str(told), *([] if picture is None else [f"written: {picture}"])]))
    return 0


def _picture_path(word: str | None, force: bool) -> Path | None:
    """Where the picture goes: over an older picture, and over nothing else; checked before anything is read."""
    if word is None:
        return None
    path = Path(word)
    if path.suffix.lower() not in (".svg", ".png"):
        raise InputError(f"--picture {word}: a picture ends in .svg or .png")
    refuse_to_replace(path, force or _is_picture(path))
    return path


def _is_picture(path: Path) -> bool:
    try:
        with open(path, "rb") as stream:
            begin = stream.read(1000)
    except OSError:
        return False
    return not begin or begin.startswith(b"\x89PNG") or b"<svg" in begin


def _write_picture(svg: str, path: Path) -> None:
    """The sheet as SVG, or as PNG where the file's ending says so.

    Raises:
        InputError: the file cannot be written.
    """
    from hpsop_core.charts.raster import png_of

    write_whole(path, svg if path.suffix.lower() == ".svg" else png_of(svg))
