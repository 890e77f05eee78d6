"""A hull's lines as a draughtsman cuts them: stations, waterlines, buttocks, and the profile."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.mesh import Resolution, hull_mesh
from hpsop_core.typing_aliases import Array

STATIONS = np.concatenate([np.arange(0.0, 1.0, 0.25), np.arange(1.0, 9.0, 0.5), np.arange(9.0, 10.01, 0.25)])
"""Of ten, from AP to FP: quarters at the ends, halves between."""

ENDS = (-0.018, -0.012, -0.006, 1.008, 1.016, 1.024)
"""Sections beyond the perpendiculars, in lengths from AP; those that miss the hull are left out."""

WATERLINES = np.concatenate([np.arange(0.1, 1.0, 0.1), [1.0], np.arange(1.2, 4.0, 0.2)])
"""In drafts above the baseline, up to the deck."""

BUTTOCKS = np.array([0.1, 0.2, 0.3, 0.4])
"""In breadths from the centreplane."""

# A plane that passes through vertices of the mesh cuts ambiguous triangles: it is moved by this part of the length.
_ASIDE = 1e-6


@dataclass(frozen=True, eq=False)
class HullLine:
    """A line of a lines plan.

    Attributes:
        layer: STATIONS, WATERLINES, DESIGN_WATERLINE, BUTTOCKS or PROFILE.
        at: where its plane stands, in m: x of a station, z of a waterline, y of a buttock and of the profile.
        points: (k, 3) in m, ship axes, port side.
    """

    layer: str
    at: float
    points: Array


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


def plan_lines(hull: Hull, resolution: Resolution = "export") -> Iterator[HullLine]:
    """The port side's lines.

    Args:
        hull: the design's.
        resolution: of the mesh that waterlines, buttocks and profile are cut from; stations lie on the surface itself.
    """
    places = np.concatenate([STATIONS / 10.0, ENDS]) * hull.length
    for x, lines in zip(places, hull.sections(places), strict=True):
        for line in lines:
            yield HullLine("STATIONS", float(x), line)
    mesh = hull_mesh(hull, resolution)
    deck = hull.parent.deck_height * hull.scale[2]
    for z in WATERLINES[WATERLINES * hull.draft < deck] * hull.draft:
        layer = "DESIGN_WATERLINE" if abs(z - hull.draft) < 1e-9 * hull.draft else "WATERLINES"
        for line in _cut(mesh, 2, float(z), hull.length):
            yield HullLine(layer, float(z), line)
    for y in BUTTOCKS * hull.breadth:
        for line in _cut(mesh, 1, float(y), hull.length):
            yield HullLine("BUTTOCKS", float(y), line)
    for line in _cut(mesh, 1, 0.0, hull.length):
        yield HullLine("PROFILE", 0.0, line)
