"""STEP and IGES files, read and meshed by Open CASCADE: an optional extra, `pip install 'hpsop[cad]'`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign.loose import LooseTriangles
from hpsop_core.typing_aliases import Array, IntArray

_STEP = (".step", ".stp")
# Largest distance of the triangles from the surfaces as a part of the size, and their largest turn, rad.
DEFLECTION, TURN = 1e-4, 0.2


def read_step_or_iges(path: Path) -> LooseTriangles:
    """The faces of a STEP or IGES file as triangles, in millimetres (Open CASCADE converts what the file states).

    Raises:
        InputError: the file cannot be read or holds no faces.
    """
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.IGESControl import IGESControl_Reader
    from OCP.Message import Message
    from OCP.STEPControl import STEPControl_Reader

    # The library reports to standard output, which belongs to the command's own document.
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)
    reader: Any = STEPControl_Reader() if path.suffix.lower() in _STEP else IGESControl_Reader()
    if not path.is_file() or reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise InputError(f"{path.name}: cannot be read as a {path.suffix[1:].upper()} file")
    reader.TransferRoots()
    shape: Any = reader.OneShape()
    size = 0.0 if shape.IsNull() else _size(shape)
    if not 0.0 < size < np.inf:
        raise InputError(f"{path.name}: holds no shape; save the hull's surfaces into it")
    BRepMesh_IncrementalMesh(shape, DEFLECTION * size, False, TURN, True)
    vertices, faces, count = _triangles(shape)
    if len(faces) == 0:
        raise InputError(
            f"{path.name}: holds no surfaces (curves alone cannot be read); save the hull's surfaces into it"
        )
    return LooseTriangles(f"{path.suffix[1:].upper()} file with {count} faces", vertices, faces, "mm")


def _size(shape: Any) -> float:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    if box.IsVoid():
        return 0.0
    low, high = box.CornerMin(), box.CornerMax()
    return float(max(high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()))


def _triangles(shape: Any) -> tuple[Array, IntArray, int]:
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    explorer: Any = TopExp_Explorer(shape, TopAbs_FACE)
    vertices: list[Array] = []
    faces: list[IntArray] = []
    first = count = 0
    while explorer.More():
        face = TopoDS.Face_s(explorer.Current()) if hasattr(TopoDS, "Face_s") else TopoDS.Face(explorer.Current())
        location = TopLoc_Location()
        mesh: Any = BRep_Tool.Triangulation_s(face, location)
        explorer.Next()
        if mesh is None:
            continue
        count += 1
        place = location.Transformation()
        points = [mesh.Node(k + 1).Transformed(place) for k in range(mesh.NbNodes())]
        vertices.append(np.array([[p.X(), p.Y(), p.Z()] for p in points]))
        faces.append(
            np.array([mesh.Triangle(k + 1).Get() for k in range(mesh.NbTriangles())], dtype=np.int64) - 1 + first
        )
        first += len(points)
    if not faces:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), 0
    return np.concatenate(vertices), np.concatenate(faces), count
