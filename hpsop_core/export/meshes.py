"""A design as triangle meshes: STL for solvers and printers, GLB for viewers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.stl import export_stl

from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.mesh import hull_mesh, hull_view_parts
from hpsop_core.geometry.propeller.mesh import propeller_mesh
from hpsop_core.geometry.propeller.propeller import Propeller

# glTF's y is up: x forward stays, our z becomes its y, our y its -z.
_TO_GLTF = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_COLOURS = {"underwater": (150, 60, 50, 255), "topsides": (70, 95, 120, 255), "propeller": (190, 150, 60, 255)}


def placed_propeller_mesh(hull: Hull, propeller: Propeller) -> trimesh.Trimesh:
    """The closed mesh of blades and hub behind the hull, export resolution, m, ship axes."""
    mesh = propeller_mesh(propeller, "export")
    mesh.apply_transform(propeller_placement(hull, propeller))
    return mesh


def write_stl(hull_path: Path, propeller_path: Path, hull: Hull, propeller: Propeller) -> None:
    """Two closed solids in ship axes, m: the whole hull to its deck, and the propeller in its place.

    Raises:
        OSError: a file cannot be written.
    """
    solids = {hull_path: hull_mesh(hull, "export"), propeller_path: placed_propeller_mesh(hull, propeller)}
    for path, mesh in solids.items():
        path.write_bytes(export_stl(mesh))


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
