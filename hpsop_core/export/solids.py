"""A design as solids for a CAD system: STEP and IGES, written by OpenCASCADE (the extra ``hpsop[cad]``).

A body is sewn from the NURBS surfaces of ``surfaces`` and is refused where it is not one closed, valid solid: a file
with gaps would have to be mended by whoever receives it. Lengths in the files are millimetres, as yards have them and
as OpenCASCADE counts inside, so that its tolerances hold; ship axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hpsop_core.errors import SolverFailure
from hpsop_core.export.exchange import opencascade_surface
from hpsop_core.export.surfaces import COLOURS, NamedSurface
from hpsop_core.version import __version__

MILLIMETRES = 1e3
# Tried in turn, mm: what patches share agrees to a thousandth of a millimetre on the shipped hull, on a fitted one to
# less than a weld's root gap.
_SEWING_TOLERANCES = (0.1, 1.0, 5.0)


@dataclass(frozen=True, eq=False)
class NamedSolid:
    """A body with its name; ``shape`` is a ``TopoDS_Solid`` in mm, ``faces`` its named faces with their groups."""

    name: str
    shape: Any
    faces: tuple[tuple[str, str, Any], ...]


def sewn_solid(name: str, parts: Sequence[NamedSurface]) -> NamedSolid:
    """One closed solid from surfaces that meet.

    Raises:
        SolverFailure: they leave gaps, or the body is not valid; with the number of open edges.
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    faces = [
        (part, BRepBuilderAPI_MakeFace(opencascade_surface(part.surface.to_geomdl(), MILLIMETRES), 1e-6).Face())
        for part in parts
    ]
    open_edges = 0
    for tolerance in _SEWING_TOLERANCES:
        sewing = BRepBuilderAPI_Sewing(tolerance)
        for _, face in faces:
            sewing.Add(face)
        sewing.Perform()
        open_edges = sewing.NbFreeEdges() + sewing.NbMultipleEdges()
        shell = sewing.SewedShape()
        if open_edges or shell.ShapeType() != TopAbs_ShapeEnum.TopAbs_SHELL:
            continue
        solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shell)).Solid()
        BRepLib.OrientClosedSolid_s(solid)
        if is_valid(solid):
            return NamedSolid(name, solid, tuple((p.name, p.group, sewing.Modified(face)) for p, face in faces))
    raise SolverFailure(
        "export", f"the surfaces of the {name} do not make one solid ({open_edges} open edges); take 3dm"
    )


def propeller_solid(parts: Sequence[NamedSurface]) -> NamedSolid:
    """Blades and hub as one solid: each sewn from its faces ("blade 1 back", "hub"), then joined. Without fillets.

    Raises:
        SolverFailure: they do not make one valid body.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.collections import List_TopoDS_Shape
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    bodies: dict[str, list[NamedSurface]] = {}
    for part in parts:
        words = part.name.split()
        bodies.setdefault(" ".join(words[:2]) if words[0] == "blade" else "hub", []).append(part)
    hub = sewn_solid("hub", bodies.pop("hub"))
    blades = [sewn_solid(name, own) for name, own in bodies.items()]
    join = BRepAlgoAPI_Fuse()
    for given, solids in ((join.SetArguments, [hub]), (join.SetTools, blades)):
        shapes = List_TopoDS_Shape()
        for solid in solids:
            shapes.Append(solid.shape)
        given(shapes)
    join.Build()
    found = TopExp_Explorer(join.Shape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    if not join.IsDone() or not found.More() or not is_valid(found.Current()):
        raise SolverFailure("export", "blades and hub of the propeller do not make one solid; take 3dm")
    solid = found.Current()
    found.Next()
    if found.More():
        raise SolverFailure("export", "a blade of the propeller does not touch its hub; take 3dm")
    faces: list[tuple[str, str, Any]] = []
    for name, group, face in (face for body in (hub, *blades) for face in body.faces):
        kept = list(join.Modified(face)) or ([] if join.IsDeleted(face) else [face])
        faces.extend((name, group, part) for part in kept)
    return NamedSolid("propeller", solid, tuple(faces))


def is_valid(shape: Any) -> bool:
    """Whether OpenCASCADE's own check finds nothing wrong with a shape."""
    from OCP.BRepCheck import BRepCheck_Analyzer

    return bool(BRepCheck_Analyzer(shape).IsValid())


def write_step(path: Path, solids: Sequence[NamedSolid], title: str) -> None:
    """STEP (AP214, mm): each solid a named product, its faces named and coloured.

    Raises:
        OSError: the file cannot be written.
    """
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
    from OCP.TCollection import TCollection_HAsciiString

    STEPCAFControl_Controller.Init_s()
    _silence()
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    writer = STEPCAFControl_Writer()
    done = writer.Transfer(_document(solids))
    header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    header.SetName(TCollection_HAsciiString(path.name))
    header.SetDescriptionValue(1, TCollection_HAsciiString(title))
    header.SetOriginatingSystem(TCollection_HAsciiString(f"hpsop {__version__}"))
    if not done or writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise OSError(f"{path}: could not be written")


def write_iges(path: Path, solids: Sequence[NamedSolid], title: str) -> None:
    """IGES 5.3 (mm): each body a manifold solid (entity 186), named and coloured.

    Raises:
        OSError: the file cannot be written.
    """
    from OCP.IGESCAFControl import IGESCAFControl_Writer
    from OCP.IGESControl import IGESControl_Controller
    from OCP.Interface import Interface_Static

    IGESControl_Controller.Init_s()
    _silence()
    Interface_Static.SetIVal_s("write.iges.brep.mode", 1)
    Interface_Static.SetCVal_s("write.iges.unit", "MM")
    Interface_Static.SetCVal_s("write.iges.header.product", title[:72])
    writer = IGESCAFControl_Writer()
    if not writer.Transfer(_document(solids)) or not writer.Write(str(path)):
        raise OSError(f"{path}: could not be written")


def _silence() -> None:
    """OpenCASCADE reports every transfer on standard output, which belongs to the command."""
    from OCP.Message import Message, Message_PrinterOStream

    Message.DefaultMessenger_s().RemovePrinters(Message_PrinterOStream.get_type_descriptor_s())


def _document(solids: Sequence[NamedSolid]) -> Any:
    """An XCAF document with the solids, their names and colours."""
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application
    from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1.0 / MILLIMETRES)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    for solid in solids:
        label = shapes.AddShape(solid.shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(solid.name))
        for name, group, face in solid.faces:
            red, green, blue = (value / 255.0 for value in COLOURS[group][:3])
            part = shapes.AddSubShape(label, face)
            TDataStd_Name.Set_s(part, TCollection_ExtendedString(name))
            shade = Quantity_Color(red, green, blue, Quantity_TypeOfColor.Quantity_TOC_sRGB)
            colours.SetColor(part, shade, XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    return document
