"""One's own hull or propeller from a file, ready to be computed: no case is needed."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.assets import SHIPPED_HULLS, SHIPPED_PROPELLERS
from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull
from hpsop_core.geometry.hull.input import Axes, HullFile, ReadOptions, read_hull
from hpsop_core.geometry.propeller import propeller as propellers
from hpsop_core.geometry.propeller.propeller import Propeller, propeller_family
from hpsop_core.model_test import MODEL_DIAMETER

FEWEST_BLADES, MOST_BLADES = 2, 7
# Meshes that say nothing of their unit.
UNITLESS_SUFFIXES = (".stl", ".obj", ".ply", ".off")


def load_hull(
    source: str | Path,
    length: float | None = None,
    draft: float | None = None,
    unit: str | None = None,
    axes: str | Axes = "",
    breadth: float | None = None,
) -> Hull:
    """A hull from a file, or a shipped one.

    Args:
        source: a table of offsets, an STL, OBJ, PLY, OFF, GLB, 3dm, STEP or IGES file (docs/bring-your-ship.md), or a
            shipped hull's name ("dtc").
        length: Lpp in m; needed with a file, which is never scaled to it.
        draft: still water above the baseline in m; needed with a file.
        unit: of the file's lengths: "m", "mm", "cm", "ft", "in" or "ft-in-8"; needed with an STL, OBJ, PLY or OFF.
        axes: how the file's axes lie in the ship, for example "bow=-x,origin=fp,waterline=z0".
        breadth: in m, of a table in fractions of B/2 that does not state it.

    Returns:
        The hull at its own dimensions, frozen. ``hull.hydrostatics`` has its figures, ``hull.parent.fit_report`` how
        far the surface leaves the points that it was fitted to (None for a shipped hull), ``hull.warnings`` what to
        look at; ``geometry.hull.input.read_hull`` says all that was understood.

    Raises:
        InputError: a file that cannot be used; one line with file, row and remedy.
    """
    if str(source) in SHIPPED_HULLS:
        if length is not None or draft is not None or unit is not None:
            raise InputError(f"hull '{source}' is shipped with its own length, draft and unit; leave them away")
        parent = load_parent_hull(str(source))
    else:
        try:
            options = ReadOptions(
                length, draft, breadth, unit, axes if isinstance(axes, Axes) else Axes.from_words(axes)
            )
        except InputError as problem:
            raise InputError(f"{Path(source).name}: {problem}") from problem
        return read_own_hull(source, options).hull
    return parent.transform(parent.length, parent.breadth, parent.draft)


def read_own_hull(source: str | Path, options: ReadOptions) -> HullFile:
    """A hull from a file with what was understood of it; length, draft and a mesh's unit are never assumed here.

    Raises:
        InputError: one of them is not stated, or a file that cannot be used.
    """
    path = Path(source)
    if options.length is None or options.draft is None:
        raise InputError(f"{path.name}: a hull from a file needs length (Lpp) and draft, in metres")
    if path.suffix.lower() in UNITLESS_SUFFIXES and options.unit is None:
        raise InputError(f"{path.name}: {path.suffix[1:].upper()} files carry no unit; give unit m, mm, cm, ft or in")
    return read_hull(path, options)


def load_propeller(source: str | Path, blade_count: int | None = None, diameter: float = MODEL_DIAMETER) -> Propeller:
    """A propeller from a radial table, or a shipped one.

    Args:
        source: a CSV file with ``r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c``, or a shipped propeller's name ("p4119").
        blade_count: Z, 2 to 7; needed with a file, which is taken as drawn for it.
        diameter: D in m; model scale by default.

    Returns:
        The propeller, frozen, with its table as it stands.

    Raises:
        InputError: a file that cannot be used (one line with file, line and remedy), a number of blades or a diameter
            that cannot be.
    """
    if str(source) in SHIPPED_PROPELLERS:
        own = SHIPPED_PROPELLERS[str(source)]
        return propeller_family(propellers.load_propeller(str(source)), diameter, blade_count or own)
    path = Path(source)
    if blade_count is None:
        raise InputError(f"{path.name}: a radial table needs the number of blades that it was drawn for, 2 to 7")
    if not FEWEST_BLADES <= blade_count <= MOST_BLADES:
        raise InputError(f"{path.name}: {blade_count} blades; give {FEWEST_BLADES} to {MOST_BLADES}")
    return propeller_family(propellers.radial_table_from_csv(path, blade_count), diameter, blade_count)
