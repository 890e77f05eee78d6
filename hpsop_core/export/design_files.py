"""A design of a run as files to take away: CAD, meshes, tables, numbers."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation, Ok
from hpsop_core.export import tables
from hpsop_core.export.design import LeavingDesign, leaving_design
from hpsop_core.export.formats import USUAL_FORMATS, checked_formats
from hpsop_core.geometry.propeller.surface import EDGE_THICKNESS_RATIO
from hpsop_core.runs.reader import RunReader
from hpsop_core.scratch import scratch_folder
from hpsop_core.version import __version__

_ABOUT = """\
{title}
Exported by hpsop {version}.

Metres and SI units. Ship axes: x forward from the after perpendicular, y to port, z up from the baseline; the propeller
stands in its place behind the hull. (design.glb alone follows glTF: y up, starboard = +z.)

{files}
The surfaces are the very ones that were computed: the NURBS leave the evaluated hull by at most {deviation:.2g} m
(beside seams, which were given a common tangent, and where the longitudinal shift is refitted), the meshes of hull.stl
enclose the hull to its deck. Root fillets of the blades are in the meshes only. Trailing edges and tips of the blades
are {edge:.2g} m thick (the solvers' panels close to nothing).
{warnings}"""

_MEANING = {
    "hull.stl": "the whole hull to its deck, one closed solid",
    "propeller.stl": "blades, fillets, hub and cap, one closed solid, in its place",
    "design.glb": "hull and propeller for viewers",
    "design.3dm": "rational NURBS surfaces of hull (both sides), deck, flat ends, blades and hub, on layers",
    "design.step": "hull and propeller as a closed solid each, faces named; millimetres",
    "design.iges": "the same as IGES, manifold solids (entity 186); millimetres",
    "lines.dxf": "stations, waterlines, buttocks, profile (port side) and blade sections as 3D polylines",
    "drawings.dxf": "lines plan and propeller drawing as two layouts on A1; millimetres of paper",
    "drawings.pdf": "the same two sheets as pages of A1, to print",
    "lines_plan.svg": "the lines plan on A1, to print",
    "propeller_drawing.svg": "the propeller drawing on A1, to print",
    "waves_N.vtp": "the water surface at condition N, for ParaView",
    "pressure_hull_N.vtp": "pressures on the hull at condition N, of level 2",
    "pressure_blades_N.vtp": "pressures on blades and hub at condition N, of level 2",
    "hull.gdf": "panels below the waterline for seakeeping programs; origin amidships on the waterline",
    "propeller.pff": "the blade's sections in the propeller free format; millimetres",
    "openfoam": "a case for OpenFOAM: towed, then driven by an actuator disc; its README.txt says what to run",
    "offsets.csv": "half-breadths; 'hpsop resistance --offsets offsets.csv' reads it again",
    "propeller.csv": "radial table; 'hpsop open-water --geometry propeller.csv' reads it again",
    "hydrostatics.csv": "hydrostatics and sectional areas",
    "resistance.csv": "resistance over Froude number",
    "open_water.csv": "KT, KQ and efficiency over J",
    "design.json": "everything that is known of the design, with the keys of 'hpsop evaluate --json'",
}


def export_design(
    run: RunReader | Case,
    design: int | str | DesignVariables,
    folder: str | Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
) -> tuple[Path, ...]:
    """Write a design's files into a folder: all of them, or none.

    Args:
        run: the run that has it, or a case.
        design: of a run its id, "initial", "compromise" or "knee"; of a case "initial" or variables, evaluated at
            level 2, or at level 1 where the case is searched at level 1 alone.
        folder: made if it is not there.
        formats: any of ``formats.FORMATS``; ``formats.USUAL_FORMATS`` by default.
        force: write into a folder that holds something already; files of the same name are replaced, others stay.

    Returns:
        The files written.

    Raises:
        InputError: no such design or format, a failed design, or a folder that cannot be used.
        SolverFailure: the form or its resistance curve cannot be computed.
    """
    wanted = checked_formats(USUAL_FORMATS if formats is None else formats)
    target = Path(folder)
    if isinstance(run, Case):
        _check_target(target, force)
        return _written(_of_case(run, design), target, wanted)
    if isinstance(design, DesignVariables):
        raise InputError("export: a run's design is named by its id, initial, compromise or knee, not by variables")
    run.check_ship()
    record = run.design(design)
    evaluation = record.evaluation
    if not evaluation.ok:
        raise InputError(
            f"{run.path}: design {record.id} failed ({evaluation.reason}) and has no shape; choose another one"
        )
    _check_target(target, force)
    stored = run.reference(evaluation.level)
    reference = reference_for(run.case, evaluation.level) if stored is None else Reference.from_dict(stored)
    data = leaving_design(run.case, evaluation, f"design {record.id}", record.as_dict(), reference)
    return _written(data, target, wanted)


def _of_case(case: Case, design: int | str | DesignVariables) -> LeavingDesign:
    if design == "initial":
        variables = case.initial.variables
    elif isinstance(design, DesignVariables):
        variables = design
    else:
        raise InputError(f"--design {design}: a case has its initial design only; name a run file for others")
    # A case that is set up with level 1 alone is one for which level 2 has no numbers.
    alone = case.optimization.level1_generations >= case.optimization.generations
    level = (FAST if alone else TRUTH).number
    reference = reference_for(case, level)
    evaluation = evaluate(case, variables, level, reference)
    if not evaluation.ok:
        raise SolverFailure(evaluation.stage, evaluation.reason)
    label = "initial design" if variables == case.initial.variables else "design"
    return leaving_design(case, evaluation, label, evaluation.as_dict(), reference)


def zip_design(
    case: Case, evaluation: Evaluation, label: str, reference: Reference, formats: Sequence[str] = USUAL_FORMATS
) -> bytes:
    """The files of ``export_design`` as one ZIP archive, for a download.

    Args:
        case: that the design belongs to.
        evaluation: the design, one that did not fail; it need not stand in a run.
        label: its name in the files, for example "design 12".
        reference: of the case at the evaluation's level.
        formats: any of ``formats.FORMATS``.

    Raises:
        InputError: an unknown format, a failed design, or no room for the files.
        SolverFailure: the form or its resistance curve cannot be computed.
    """
    wanted = checked_formats(formats)
    if not isinstance(evaluation, Ok):
        raise InputError(f"{label} failed ({evaluation.reason}) and has no shape; choose another one")
    data = leaving_design(case, evaluation, label, evaluation.as_dict(), reference)
    with scratch_folder("export") as workshop:
        folder = workshop / "design"
        _written(data, folder, wanted)
        return Path(shutil.make_archive(str(workshop / "archive"), "zip", folder)).read_bytes()


def _written(data: LeavingDesign, target: Path, formats: Sequence[str]) -> tuple[Path, ...]:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # On the same file system as the target, so that every file appears whole or not at all.
        with scratch_folder("export", beside=target) as workshop:
            made = [file.relative_to(workshop) for file in _write(data, workshop, formats)]
            for file in made:
                (target / file.parent).mkdir(parents=True, exist_ok=True)
                os.replace(workshop / file, target / file)
    except OSError as error:
        raise InputError(f"{target}: cannot be written ({error.strerror or error}); choose another folder") from error
    return tuple(target / file for file in made)


def _check_target(target: Path, force: bool) -> None:
    if os.path.exists(target) and not os.path.isdir(target):
        raise InputError(f"{target}: is a file; --to needs a folder")
    try:
        occupied = os.path.isdir(target) and any(target.iterdir())
    except OSError as error:
        raise InputError(f"{target}: cannot be read ({error.strerror}); choose another folder") from error
    if occupied and not force:
        raise InputError(f"{target}: is not empty; give --force to replace files in it, or another folder")


def _write(design: LeavingDesign, folder: Path, formats: Sequence[str]) -> list[Path]:
    deviation = 0.0
    if "stl" in formats:
        from hpsop_core.export.meshes import write_stl

        write_stl(folder / "hull.stl", folder / "propeller.stl", design.hull, design.propeller)
    if "glb" in formats:
        from hpsop_core.export.meshes import write_glb

        write_glb(folder / "design.glb", design.hull, design.propeller)
    if {"3dm", "step", "iges"} & set(formats):
        deviation = _write_surfaces(design, folder, formats)
    if "dxf" in formats:
        from hpsop_core.export.lines import write_dxf

        write_dxf(folder / "lines.dxf", design.hull, design.propeller)
    if "vtk" in formats:
        from hpsop_core.export.vtp import write_fields

        write_fields(folder, design)
    if "openfoam" in formats:
        from hpsop_core.export.openfoam.case import write_openfoam

        write_openfoam(folder / "openfoam", design)
    texts: dict[str, str] = {}
    if {"dxf", "svg", "pdf"} & set(formats):
        texts |= _drawings(design, folder, formats)
    if "csv" in formats:
        texts |= {
            "offsets.csv": tables.offsets_table(design.hull),
            "propeller.csv": tables.propeller_table(design.propeller),
            "hydrostatics.csv": tables.hydrostatics_table(design.hull),
            "resistance.csv": tables.resistance_table(design.case, design.evaluation, design.reference),
            "open_water.csv": tables.open_water_table(design.evaluation),
        }
    if "json" in formats:
        texts["design.json"] = json.dumps(design.document, indent=1, allow_nan=False) + "\n"
    if "pff" in formats:
        from hpsop_core.export.pff import propeller_pff

        texts["propeller.pff"] = propeller_pff(design.propeller, design.title)
    if "gdf" in formats:
        from hpsop_core.export.panel_files import panels_gdf

        texts["hull.gdf"] = panels_gdf(design.hull, design.title)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    made = sorted(folder.iterdir(), key=_place)
    about = _ABOUT.format(
        title=design.title,
        version=__version__,
        files="".join(f"{file.name:<22s}{_MEANING[_kind(file)]}\n" for file in made),
        deviation=max(deviation, 1e-6),
        edge=EDGE_THICKNESS_RATIO * design.propeller.diameter,
        warnings="".join(f"\nWarning: {text}\n" for text in design.evaluation.warnings),
    )
    readme = folder / "README.txt"
    readme.write_text(about, encoding="utf-8")
    inside = (sorted(item.rglob("*")) if item.is_dir() else [item] for item in made)
    return [*(file for files in inside for file in files if file.is_file()), readme]


def _drawings(design: LeavingDesign, folder: Path, formats: Sequence[str]) -> dict[str, str]:
    """The sheets: written as DXF and PDF, returned as SVG by name."""
    from hpsop_core.export.sheets.lines_plan import lines_plan
    from hpsop_core.export.sheets.paper import sheet_svg, write_sheets_dxf
    from hpsop_core.export.sheets.pdf import sheets_pdf
    from hpsop_core.export.sheets.propeller_drawing import propeller_drawing

    sheets = lines_plan(design), propeller_drawing(design)
    if "dxf" in formats:
        write_sheets_dxf(folder / "drawings.dxf", sheets)
    if "pdf" in formats:
        (folder / "drawings.pdf").write_bytes(sheets_pdf(sheets, design.title))
    if "svg" not in formats:
        return {}
    return {"lines_plan.svg": sheet_svg(sheets[0]), "propeller_drawing.svg": sheet_svg(sheets[1])}


def _write_surfaces(design: LeavingDesign, folder: Path, formats: Sequence[str]) -> float:
    """The formats made of NURBS surfaces; the hull's largest deviation in m."""
    from hpsop_core.export.surfaces import design_surfaces

    title = design.title
    surfaces, deviation = design_surfaces(design.hull, design.propeller)
    if "3dm" in formats:
        from hpsop_core.export.rhino import write_3dm

        write_3dm(folder / "design.3dm", surfaces, title)
    if {"step", "iges"} & set(formats):
        from hpsop_core.export.solids import propeller_solid, sewn_solid, write_iges, write_step

        of_propeller = [part for part in surfaces if part.group == "propeller"]
        of_hull = [part for part in surfaces if part.group != "propeller"]
        solids = (sewn_solid("hull", of_hull), propeller_solid(of_propeller))
        if "step" in formats:
            write_step(folder / "design.step", solids, title)
        if "iges" in formats:
            write_iges(folder / "design.iges", solids, title)
    return deviation


def _kind(file: Path) -> str:
    """The key of a file's meaning: its name, with the number of the condition left open."""
    return re.sub(r"_\d+\.vtp$", "_N.vtp", file.name)


def _place(file: Path) -> tuple[int, str]:
    return list(_MEANING).index(_kind(file)), file.name
