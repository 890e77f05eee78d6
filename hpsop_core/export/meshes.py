"""A design as triangle meshes: STL in named regions for solvers and printers, GLB for viewers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from hpsop_core.export.slivers import without_slivers
from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.mesh import REGIONS, hull_mesh, hull_view_parts
from hpsop_core.geometry.propeller.mesh import propeller_mesh, propeller_topology
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.typing_aliases import Array, IntArray

# glTF's y is up: x forward stays, our z becomes its y, our y its -z.
_TO_GLTF = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_SHARP_EDGE = float(np.radians(35.0))
_VERTEX = "vertex %.6f %.6f %.6f\n"
_FACET = f"facet normal %.4f %.4f %.4f\nouter loop\n{3 * _VERTEX}endloop\nendfacet\n"
_FACETS_AT_ONCE = 5000
_COLOURS = {"underwater": (150, 60, 50, 255), "topsides": (70, 95, 120, 255), "propeller": (190, 150, 60, 255)}


def placed_propeller_mesh(hull: Hull, propeller: Propeller) -> trimesh.Trimesh:
    """The closed mesh of blades and hub behind the hull, export resolution, m, ship axes."""
    mesh = propeller_mesh(propeller, "export")
    mesh.apply_transform(propeller_placement(hull, propeller))
    return mesh


def write_stl(hull_path: Path, propeller_path: Path, hull: Hull, propeller: Propeller) -> None:
    """Two closed solids in ship axes, m: the whole hull to its deck, and the propeller in its place.

    Text files with a ``solid`` for each region, as mesh generators name patches: "hull", "deck" and "transom"; "blades"
    (with their fillets) and "hub". Slivers are taken away, down to half a degree at the root of a trailing edge.

    Raises:
        OSError: a file cannot be written.
    """
    write_hull_stl(hull_path, hull)
    screw, topology = placed_propeller_mesh(hull, propeller), propeller_topology(propeller.blade_count, "export")
    regions = np.repeat([0, 1], [len(topology.blades), len(topology.hub)])
    # The edges of a trailing edge are not kept: where it runs into the fillet, it is narrower than any mesh.
    cleaned = without_slivers(np.array(screw.vertices), np.array(screw.faces), regions, np.pi)
    _write_regions(propeller_path, ("blades", "hub"), *cleaned)


def write_hull_stl(path: Path, hull: Hull) -> None:
    """The hull alone, as ``write_stl`` writes it.

    Raises:
        OSError: the file cannot be written.
    """
    ship = hull_mesh(hull, "export")
    region = np.asarray(ship.face_attributes["region"], dtype=np.int64)
    # Above and below the waterline are cleaned apart, so that it stays a line of edges.
    wet = np.asarray(ship.face_attributes["underwater"], dtype=np.int64)
    vertices, faces, place = without_slivers(
        np.array(ship.vertices), np.array(ship.faces), 2 * region + wet, _SHARP_EDGE
    )
    _write_regions(path, REGIONS, vertices, faces, place // 2)


def _write_regions(path: Path, names: Sequence[str], vertices: Array, faces: IntArray, place: IntArray) -> None:
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows: Array = np.concatenate([normals, corners.reshape(-1, 9)], axis=1)
    with path.open("w", encoding="ascii") as file:
        for number, name in enumerate(names):
            chosen = rows[place == number]
            if len(chosen):
                file.write(f"solid {name}\n")
                for some in np.array_split(chosen, len(chosen) // _FACETS_AT_ONCE + 1):
                    file.write(_FACET * len(some) % tuple(some.ravel().tolist()))
                file.write(f"endsolid {name}\n")


def write_glb(path: Path, hull: Hull, propeller: Propeller) -> None:
    """One scene with "underwater", "topsides" and "propeller" as named, coloured nodes; m, y up as glTF asks.

    Raises:
        OSError: the file cannot be written.
    """
    visual: Any = trimesh.visual
    scene: Any = trimesh.Scene()
    parts = {
        name: trimesh.Trimesh(vertices, faces, process=False)
        for name, (vertices, faces) in hull_view_parts(hull, "export").items()
    }
    parts["propeller"] = placed_propeller_mesh(hull, propeller)
    for name, mesh in parts.items():
        material = visual.material.PBRMaterial(
            name=name, baseColorFactor=_COLOURS[name], metallicFactor=0.1, roughnessFactor=0.6, doubleSided=True
        )
        mesh.visual = visual.TextureVisuals(material=material)
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=_TO_GLTF)
    path.write_bytes(scene.export(file_type="glb", include_normals=True))
