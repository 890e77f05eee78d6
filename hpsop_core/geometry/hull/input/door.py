"""The one door for a hull from a file: read, put into ship axes, checked, fitted, told."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.delimited_text import TextTable, read_text_table, text_table
from hpsop_core.geometry.hull.fit_table import SHAFT_HEIGHT_TO_DRAFT, parent_from_table
from hpsop_core.geometry.hull.hull import Hull, ParentHull
from hpsop_core.geometry.hull.input import mesh, surfaces, triangles
from hpsop_core.geometry.hull.input.checks import check_counts, check_points, check_size
from hpsop_core.geometry.hull.input.long_table import COLUMNS, is_long_form, read_long_table
from hpsop_core.geometry.hull.input.matrix_table import is_matrix, read_matrix_table
from hpsop_core.geometry.hull.input.options import Axes, FileTable, ReadOptions
from hpsop_core.geometry.hull.input.ship_table import ShipTable, in_ship_axes
from hpsop_core.geometry.hull.input.slices import sliced
from hpsop_core.geometry.hull.input.surface_checks import check_areas, check_between, check_fit
from hpsop_core.geometry.hull.input.understood import UnderstoodHull, understood
from hpsop_core.geometry.hull.table_stations import HalfBreadths
from hpsop_core.reading import LARGEST_MESH, check_regular

_READERS = {
    **dict.fromkeys(mesh.SUFFIXES, mesh.read_mesh),
    **dict.fromkeys(surfaces.SUFFIXES, surfaces.read_surfaces),
}


@dataclass(frozen=True, eq=False)
class HullFile:
    """A hull as it was read and fitted.

    Attributes:
        table: its half-breadths in ship axes, m.
        parent: the fitted hull.
        understood: what people should check.
    """

    table: ShipTable
    parent: ParentHull
    understood: UnderstoodHull

    @property
    def hull(self) -> Hull:
        """The hull at its own dimensions."""
        return self.parent.transform(self.parent.length, self.parent.breadth, self.parent.draft)


def read_table(path: Path | str, options: ReadOptions) -> ShipTable:
    """The half-breadths of a file in ship axes: a table as it stands, a mesh or surfaces cut into sections.

    The kind is told by the ending: .stl .obj .ply .off .glb .gltf, .3dm, .step .stp .igs .iges; everything else is a
    table as text.

    Raises:
        InputError: one line that names the place in the file and the remedy.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in _READERS:
        check_regular(path, LARGEST_MESH, "a mesh or surfaces of the hull")
        return sliced(triangles.in_ship_axes(_READERS[suffix](path), options))
    return in_ship_axes(_file_table(read_text_table(path), options), options)


def table_from_text(text: str, name: str, options: ReadOptions) -> ShipTable:
    """As ``read_table``, from the text of a table at hand."""
    return in_ship_axes(_file_table(text_table(text, name), options), options)


def _file_table(table: TextTable, options: ReadOptions) -> FileTable:
    if not table.lines:
        raise InputError(f"{table.name}: the file is empty; the first line must be {','.join(COLUMNS)}")
    if not is_long_form(table) and is_matrix(table):
        return read_matrix_table(table, options)
    return read_long_table(table, options)


def hull_from_table(table: ShipTable, shaft_height: float | None = None, boss_x: float | None = None) -> HullFile:
    """The hull that is fitted to a table in ship axes.

    Args:
        table: see ``read_table``.
        shaft_height: of the propeller's shaft above the baseline, m; None finds or assumes it.
        boss_x: where the propeller's hub begins, m from AP; None finds it.

    Raises:
        InputError: the table is no hull; one line that names the place and the remedy.
    """
    check_counts(table)
    unusual = check_size(table)
    check_points(table)
    readings = HalfBreadths(table.name, table.x, table.z, table.y)
    parent = parent_from_table(readings, table.length, table.draft, shaft_height, boss_x)
    check_fit(parent, table)
    check_between(parent, table)
    lacking = check_areas(parent, table)
    where = _shaft_notes(parent, shaft_height, boss_x)
    return HullFile(table, parent, understood(table, parent, (*unusual, *lacking, *where)))


def _shaft_notes(parent: ParentHull, shaft_height: float | None, boss_x: float | None) -> tuple[str, ...]:
    """Where the shaft's place comes from, as far as it was not stated."""
    assumed = abs(parent.shaft_height - SHAFT_HEIGHT_TO_DRAFT * parent.draft) < 1e-9 * parent.draft
    notes = []
    if shaft_height is None and assumed:
        notes.append("shaft height not stated and no boss found: 5.0/14.5 of the draft assumed; state shaft_height")
    elif shaft_height is None:
        notes.append("shaft height found from the boss")
    if boss_x is None:
        found = "the aft end of the boss" if "skeg" in parent.underwater else "the stern profile at the shaft's height"
        notes.append(f"hub from {found}")
    return tuple(notes)


def read_hull(
    path: Path | str,
    options: ReadOptions | None = None,
    shaft_height: float | None = None,
    boss_x: float | None = None,
) -> HullFile:
    """A hull from any file that is understood; what is not stated is taken from the file or assumed, and told.

    Raises:
        InputError: one line that names the place in the file and the remedy.
    """
    try:
        return hull_from_table(read_table(path, options or ReadOptions()), shaft_height, boss_x)
    except (ValueError, IndexError, ArithmeticError, np.linalg.LinAlgError) as problem:
        # What no check foresaw: a file that makes no ship is no reason for a traceback.
        raise InputError(
            f"{Path(path).name}: cannot be understood as a hull ({problem}); compare it with docs/bring-your-ship.md"
        ) from problem


def parent_hull_from_offsets(path: Path | str, length: float, draft: float) -> ParentHull:
    """A parent hull fitted to a table of offsets in ship axes and metres; ``read_hull`` takes every other kind.

    Args:
        path: CSV with the columns station_x_m, waterline_z_m, half_breadth_m (others are ignored), or another layout
            that ``read_table`` understands.
        length: between perpendiculars, m; the table is not scaled to it.
        draft: waterline above z = 0, m.

    Raises:
        InputError: one line that names the row and the remedy.
    """
    name = Path(path).name
    return hull_from_table(read_table(path, _stated(name, length, draft, None))).parent


def parent_hull_from_stl(path: Path | str, unit: str, draft: float, length: float) -> ParentHull:
    """A parent hull fitted to slices of a mesh in ship axes.

    Args:
        path: STL or another mesh: x forward from AP, y to port, z up from the baseline.
        unit: m, mm, cm, ft or in.
        draft, length: of the hull in metres, as for `parent_hull_from_offsets`.

    Raises:
        InputError: one line that says what is wrong and where.
    """
    name = Path(path).name
    return hull_from_table(read_table(path, _stated(name, length, draft, unit))).parent


def _stated(name: str, length: float, draft: float, unit: str | None) -> ReadOptions:
    try:
        return ReadOptions(length=length, draft=draft, unit=unit, axes=Axes())
    except InputError as problem:
        raise InputError(f"{name}: {problem}") from problem
