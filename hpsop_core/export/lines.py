"""A design's lines as a DXF drawing in three dimensions: stations, waterlines, buttocks, profile, blade sections."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from ezdxf import units
from ezdxf.filemanagement import new

from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.mesh import hull_mesh
from hpsop_core.geometry.propeller.nurbs import blade_outlines
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.surface import rotate_blade
from hpsop_core.typing_aliases import Array

STATIONS = np.concatenate([np.arange(0.0, 1.0, 0.25), np.arange(1.0, 9.0, 0.5), np.arange(9.0, 10.01, 0.25)])
"""Of ten, from AP to FP: quarters at the ends, halves between."""

ENDS = (-0.018, -0.012, -0.006, 1.008, 1.016, 1.024)
"""Sections beyond the perpendiculars, in lengths from AP; those that miss the hull are left out."""

WATERLINES = np.concatenate([np.arange(0.1, 1.0, 0.1), [1.0], np.arange(1.2, 4.0, 0.2)])
"""In drafts above the baseline, up to the deck."""

BUTTOCKS = np.array([0.1, 0.2, 0.3, 0.4])
"""In breadths from the centreplane."""

SECTION_RADII = (0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
_BLADE_POINTS = 41
# A plane that passes through vertices of the mesh cuts ambiguous triangles: it is moved by this part of the length.
_ASIDE = 1e-6
_COLOURS = {"STATIONS": 5, "WATERLINES": 4, "DESIGN_WATERLINE": 1, "BUTTOCKS": 3, "PROFILE": 7, "BLADE_SECTIONS": 30}


def chained(segments: Array) -> list[Array]:
    """Segments (n, 2, 3) joined end to end into polylines (k, 3), longest first; ends within a micrometre are one."""
    keys = np.round(segments.reshape(-1, 3) * 1e6).astype(np.int64)
    _, node = np.unique(keys, axis=0, return_inverse=True)
    ends = node.reshape(-1, 2)
    points = {int(n): p for n, p in zip(node, segments.reshape(-1, 3), strict=True)}
    neighbours: dict[int, list[int]] = {}
    for a, b in ends:
        if a != b:
            neighbours.setdefault(int(a), []).append(int(b))
            neighbours.setdefault(int(b), []).append(int(a))
    lines = []
    # Open lines first, from their ends; what is left is closed.
    for start in sorted(neighbours, key=lambda n: len(neighbours[n]) == 2):
        while neighbours[start]:
            line, here = [start], start
            while neighbours[here]:
                there = neighbours[here].pop()
                neighbours[there].remove(here)
                line.append(there)
                here = there
            lines.append(np.array([points[n] for n in line]))
    return sorted(lines, key=len, reverse=True)


def _cut(mesh: trimesh.Trimesh, axis: int, at: float, length: float) -> list[Array]:
    """Port-side lines in which the plane with that coordinate cuts the mesh."""
    intersections: Any = trimesh.intersections
    normal = np.eye(3)[axis]
    segments = intersections.mesh_plane(mesh, normal, normal * (at + _ASIDE * length))
    if axis != 1:
        middle = segments[..., 1].mean(axis=1)
        segments = segments[middle >= -1e-9]
    return chained(np.asarray(segments)) if len(segments) else []


def design_lines(hull: Hull, propeller: Propeller) -> Iterator[tuple[str, Array]]:
    """(layer, polyline (k, 3) in m, ship axes): the hull's port side, and the sections of every blade."""
    for lines in hull.sections(np.concatenate([STATIONS / 10.0, ENDS]) * hull.length):
        for line in lines:
            yield "STATIONS", line
    mesh = hull_mesh(hull, "export")
    deck = hull.parent.deck_height * hull.scale[2]
    for z in WATERLINES[WATERLINES * hull.draft < deck] * hull.draft:
        layer = "DESIGN_WATERLINE" if abs(z - hull.draft) < 1e-9 * hull.draft else "WATERLINES"
        for line in _cut(mesh, 2, float(z), hull.length):
            yield layer, line
    for y in BUTTOCKS * hull.breadth:
        for line in _cut(mesh, 1, float(y), hull.length):
            yield "BUTTOCKS", line
    for line in _cut(mesh, 1, 0.0, hull.length):
        yield "PROFILE", line
    placement = propeller_placement(hull, propeller)
    outlines = blade_outlines(propeller, np.array(SECTION_RADII), _BLADE_POINTS)
    for blade in range(propeller.blade_count):
        for line in rotate_blade(outlines, blade, propeller.blade_count) @ placement[:3, :3].T + placement[:3, 3]:
            yield "BLADE_SECTIONS", line


def write_dxf(path: Path, hull: Hull, propeller: Propeller) -> None:
    """Write the lines, a layer a kind, as 3D polylines in metres.

    Raises:
        OSError: the file cannot be written.
    """
    drawing: Any = new("R2010", setup=False)
    drawing.units = units.M
    space = drawing.modelspace()
    for layer, line in design_lines(hull, propeller):
        if layer not in drawing.layers:
            drawing.layers.add(layer, color=_COLOURS[layer])
        space.add_polyline3d(line.tolist(), dxfattribs={"layer": layer})
    drawing.saveas(path)
