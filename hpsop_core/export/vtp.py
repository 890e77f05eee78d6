"""VTP, ParaView's XML file of polygons: the water surface and the pressures on hull and blades."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation import fields
from hpsop_core.evaluation.fields import PressureField, WaveField
from hpsop_core.export.design import LeavingDesign
from hpsop_core.typing_aliases import Array, IntArray


def write_fields(folder: Path, design: LeavingDesign) -> None:
    """Of every condition, numbered from 1: waves_1.vtp, pressure_hull_1.vtp and pressure_blades_1.vtp.

    Waves are those of the design's own level, pressures always level 2's. Ship axes, m, Pa.

    Raises:
        OSError: a file cannot be written.
        SolverFailure, InputError: as ``fields.waves`` and ``fields.pressures``.
    """
    for place in range(len(design.evaluation.conditions)):
        reference = design.reference
        waves = fields.waves(design.case, design.evaluation, condition=place, reference=reference)
        write_waves(folder / f"waves_{place + 1}.vtp", waves)
        try:
            found = fields.pressures(design.case, design.evaluation, condition=place)
        except SolverFailure as failure:
            why = f"format vtk needs level 2's pressures: {failure.reason}; leave vtk out of the formats"
            raise SolverFailure(failure.stage, why) from failure
        write_pressure(folder / f"pressure_hull_{place + 1}.vtp", found.hull)
        write_pressure(folder / f"pressure_blades_{place + 1}.vtp", found.blades)


def write_waves(path: Path, field: WaveField) -> None:
    """The water on both sides: points at their true height, "elevation" in m on the points."""
    rows, columns = field.x.shape
    place = np.arange(rows * columns).reshape(rows, columns)
    port = np.stack([place[:-1, :-1], place[:-1, 1:], place[1:, 1:], place[1:, :-1]], axis=2).reshape(-1, 4)
    points = np.stack([field.x, field.y, field.draft + field.elevation], axis=2).reshape(-1, 3)
    first, second, third = (points[port[:, k]] for k in range(3))
    if np.sum(np.cross(second - first, third - first)[:, 2]) < 0.0:
        port = port[:, ::-1]
    both = np.concatenate([points, points * [1.0, -1.0, 1.0]])
    quads = np.concatenate([port, port[:, ::-1] + len(points)])
    elevation = np.concatenate([field.elevation.ravel()] * 2)
    write_vtp(path, both, quads, point_data={"elevation": elevation})


def write_pressure(path: Path, field: PressureField) -> None:
    """The panels with "pressure_coefficient", "pressure" (Pa, without the hydrostatic part) and "blade" on each."""
    values: dict[str, Array | IntArray] = {
        "pressure_coefficient": field.pressure_coefficient,
        "pressure": field.pressure,
        "uniform_pressure_coefficient": field.uniform_coefficient,
        "blade": field.blade,
    }
    write_vtp(path, field.points, field.quads, cell_data=values)


def write_vtp(
    path: Path,
    points: Array,
    quads: IntArray,
    point_data: Mapping[str, Array | IntArray] | None = None,
    cell_data: Mapping[str, Array | IntArray] | None = None,
) -> None:
    """Quadrilaterals as PolyData in XML text; where two corners are one point, a triangle; less, nothing.

    Args:
        path: the file.
        points: (n, 3).
        quads: (m, 4) indices; the right-hand rule gives the outside.
        point_data: (n,) each, by name.
        cell_data: (m,) each, by name.

    Raises:
        OSError: the file cannot be written.
    """
    corners = points[quads]
    # A corner that is where the one before it is (bows and tips are closed like that) is left out.
    kept = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) > 0.0
    whole = kept.sum(axis=1) >= 3
    kept &= whole[:, None]
    ends = np.cumsum(kept.sum(axis=1)[whole])
    with path.open("w", encoding="ascii") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">\n')
        file.write(
            f'<PolyData>\n<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" '
            f'NumberOfPolys="{int(whole.sum())}">\n'
        )
        file.write(f"<PointData>\n{_arrays(point_data or {})}</PointData>\n")
        chosen = {name: values[whole] for name, values in (cell_data or {}).items()}
        file.write(f"<CellData>\n{_arrays(chosen)}</CellData>\n")
        file.write(f"<Points>\n{_array('Points', points)}</Points>\n")
        file.write(f"<Polys>\n{_array('connectivity', quads[kept])}{_array('offsets', ends)}</Polys>\n")
        file.write("</Piece>\n</PolyData>\n</VTKFile>\n")


def _arrays(data: Mapping[str, Array | IntArray]) -> str:
    return "".join(_array(name, values) for name, values in data.items())


def _array(name: str, values: Array | IntArray) -> str:
    whole = np.issubdtype(values.dtype, np.integer)
    kind = "Int64" if whole else "Float64"
    several = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    text = " ".join(("%d" if whole else "%.9g") % value for value in values.ravel().tolist())
    return f'<DataArray type="{kind}" Name="{name}"{several} format="ascii">\n{text}\n</DataArray>\n'
