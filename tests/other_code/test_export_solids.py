"""STEP and IGES read again by OpenCASCADE: closed, valid, of the right size, in millimetres, with their names."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hpsop_core import load_hull, load_propeller, to_geomdl
from hpsop_core.export.exchange import from_opencascade, from_rhino, opencascade_surface, rhino_surface
from hpsop_core.export.solids import propeller_solid, sewn_solid, write_iges, write_step
from hpsop_core.export.surfaces import design_surfaces, hull_surfaces
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.geometry.propeller.mesh import propeller_mesh
from hpsop_core.geometry.propeller.propeller import Propeller, propeller_family
from hpsop_core.geometry.propeller.propeller import load_propeller as load_parent_propeller

pytest.importorskip("OCP", reason="OpenCASCADE is an extra: pip install 'hpsop[cad]'")

SERIES_60 = Path(__file__).parents[1] / "data" / "hulls" / "s60_cb060.csv"
U, V = np.linspace(0.0, 1.0, 17), np.linspace(0.0, 1.0, 13)


@pytest.fixture(scope="module")
def hull() -> Hull:
    """One whose sections were shifted as far as a search may."""
    parent = load_parent_hull()
    return parent.transform(380.0, 47.0, 14.9, 0.73 * 380.0 * 47.0 * 14.9, -2.0)


@pytest.fixture(scope="module")
def propeller() -> Propeller:
    return propeller_family(load_parent_propeller("p4119"), 9.0, 5, 1.05, 0.8)


@pytest.fixture(scope="module")
def folder(hull: Hull, propeller: Propeller, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("solids")
    surfaces, _ = design_surfaces(hull, propeller)
    screw = [part for part in surfaces if part.group == "propeller"]
    solids = [sewn_solid("hull", [part for part in surfaces if part not in screw]), propeller_solid(screw)]
    write_step(target / "design.step", solids, "a ship")
    write_iges(target / "design.iges", solids, "a ship")
    return target


def read(path: Path) -> dict[str, Any]:
    """Name -> shape of every free shape of a file, in mm whatever the file's unit is."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.IGESCAFControl import IGESCAFControl_Reader
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    reader = STEPCAFControl_Reader() if path.suffix == ".step" else IGESCAFControl_Reader()
    reader.SetNameMode(True)
    reader.ReadFile(str(path))
    assert reader.Transfer(document)
    labels = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(labels)
    found = {}
    for k in range(1, labels.Length() + 1):
        name = TDataStd_Name()
        assert labels.Value(k).FindAttribute(TDataStd_Name.GetID_s(), name)
        found[name.Get().ToExtString()] = XCAFDoc_ShapeTool.GetShape_s(labels.Value(k))
    return found


def parts(shape: Any, kind: str) -> list[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    found, explorer = [], TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def open_edges(shape: Any) -> int:
    """Edges that are not run through twice, once each way; those without length (a pole) do not count."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS

    uses: list[tuple[Any, list[Any]]] = []
    for edge in parts(shape, "EDGE"):
        if BRep_Tool.Degenerated_s(TopoDS.Edge(edge)):
            continue
        for known, orientations in uses:
            if known.IsSame(edge):
                orientations.append(edge.Orientation())
                break
        else:
            uses.append((edge, [edge.Orientation()]))
    both = {TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED}
    return sum(len(orientations) != 2 or set(orientations) != both for _, orientations in uses)


def volume(shape: Any) -> float:
    """In m3."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-6)
    return float(properties.Mass()) * 1e-9


def below(shape: Any, height: float) -> float:
    """What a hull displaces in m3: OpenCASCADE cuts the solid at that height (m)."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    far = 1e6
    box = BRepPrimAPI_MakeBox(gp_Pnt(-far, -far, -far), gp_Pnt(far, far, 1e3 * height)).Shape()
    return volume(BRepAlgoAPI_Common(shape, box).Shape())


def is_valid(shape: Any) -> bool:
    from OCP.BRepCheck import BRepCheck_Analyzer

    return bool(BRepCheck_Analyzer(shape).IsValid())


@pytest.mark.parametrize("name", ["design.step", "design.iges"])
def test_the_hull_is_one_closed_solid_of_the_ships_volume(folder: Path, hull: Hull, name: str) -> None:
    from OCP.TopoDS import TopoDS_Shape

    shape: TopoDS_Shape = read(folder / name)["hull"]
    assert len(parts(shape, "SOLID")) == 1 and is_valid(shape)
    assert open_edges(shape) == 0
    # Refitting the shift of the sections leaves 1e-5 of the length in x.
    assert below(shape, hull.draft) == pytest.approx(hull.hydrostatics.displaced_volume, rel=1e-4)


@pytest.mark.parametrize("name", ["design.step", "design.iges"])
def test_the_propeller_is_one_closed_solid_behind_the_hull(
    folder: Path, hull: Hull, propeller: Propeller, name: str
) -> None:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    shape = read(folder / name)["propeller"]
    assert len(parts(shape, "SOLID")) == 1 and is_valid(shape)
    assert open_edges(shape) == 0
    # The mesh has fillets, the solid has not: 0.5 % of the volume of five blades and hub, and chords inside curves.
    assert volume(shape) == pytest.approx(propeller_mesh(propeller, "export").volume, rel=0.01)
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, True, False)
    assert 1e-3 * box.CornerMax().X() == pytest.approx(hull.boss_end_x, abs=1e-4)
    assert 1e-3 * box.CornerMax().Z() == pytest.approx(hull.shaft_height + 4.5, abs=0.01)


def test_step_tells_unit_names_and_who_made_it(folder: Path) -> None:
    text = (folder / "design.step").read_text()
    assert "SI_UNIT(.MILLI.,.METRE.)" in text and "('a ship')" in text
    assert "PRODUCT('hull'" in text and "ADVANCED_FACE('main port'" in text
    assert "PRODUCT('propeller'" in text and "ADVANCED_FACE('blade 5 face'" in text
    assert "2HMM" in (folder / "design.iges").read_text().replace("\n", "")


@pytest.mark.parametrize("shape", ["hull", "propeller"])
def test_a_surface_comes_back_from_every_program_as_it_went(shape: str) -> None:
    surfaces = to_geomdl(load_hull("dtc") if shape == "hull" else load_propeller("p4119"))
    chosen = ("main port", "bulb starboard") if shape == "hull" else ("blade 1 back", "hub")
    for name in chosen:
        there = surfaces[name]
        points = NurbsSurface.from_geomdl(there).evaluate(U, V)
        # geomdl's own evaluation of the same surface
        assert np.allclose(there.evaluate_single((0.25, 0.75)), NurbsSurface.from_geomdl(there).evaluate(
            np.array([0.25]), np.array([0.75]))[0, 0], atol=1e-9)  # fmt: skip
        for back in (
            from_rhino(rhino_surface(there)),
            from_opencascade(opencascade_surface(there, 1e3), 1e-3),
        ):
            # millimetres and back, weights in and out: rounding only
            assert np.allclose(NurbsSurface.from_geomdl(back).evaluate(U, V), points, atol=1e-9)


def test_a_flat_end_above_a_post_has_no_strip_without_width() -> None:
    """Series 60 ends flat at AP above its stern post; on the post the face had no width, which no mesher takes."""
    ship = load_hull(SERIES_60, length=121.92, draft=6.5)
    surfaces, _ = hull_surfaces(ship)
    end = next(part.surface for part in surfaces if part.name == "main end port")
    inside = np.linspace(0.05, 0.95, 31)
    edge = end.evaluate(inside, np.array([0.0, 1.0]))
    assert np.min(edge[:, 0, 1]) > 0.0 and np.all(edge[:, 1, 1] == 0.0)
    # it is the hull's own edge
    own = ship.nurbs_patch("main")[0].evaluate(np.zeros(1), np.linspace(0.0, 1.0, 4001))[0]
    assert np.allclose(edge[:, 0, 1], np.interp(edge[:, 0, 2], own[:, 2], own[:, 1]), atol=1e-3)
    solid = sewn_solid("hull", surfaces)
    assert open_edges(solid.shape) == 0
    assert below(solid.shape, ship.draft) == pytest.approx(ship.hydrostatics.displaced_volume, rel=1e-4)


@pytest.mark.parametrize(("body", "size"), [("propeller", 0.6), ("hull", 3.0)])
def test_gmsh_fills_the_solid_with_tetrahedra(folder: Path, body: str, size: float) -> None:
    try:
        import gmsh
    except (ImportError, OSError) as missing:  # its wheel needs libraries of the desktop
        pytest.skip(f"gmsh cannot be loaded: {missing}")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setString("Geometry.OCCTargetUnit", "M")
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.merge(str(folder / "design.step"))
        names = {gmsh.model.getEntityName(3, tag).split("/")[-1]: (3, tag) for _, tag in gmsh.model.getEntities(3)}
        others = [entity for name, entity in names.items() if name != body]
        gmsh.model.occ.remove(others, recursive=True)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(3)
        _, tags, _ = gmsh.model.mesh.getElements(3)
        volumes = gmsh.model.mesh.getElementQualities(tags[0], "volume")
    finally:
        gmsh.finalize()
        # it takes back that Python ignores this signal
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    assert np.min(volumes) > 0.0
    # Flat facets of the asked size cut off that much of a round body.
    assert float(np.sum(volumes)) == pytest.approx(volume(read(folder / "design.step")[body]), rel=0.05)
