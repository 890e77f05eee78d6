"""A small orthographic renderer with a depth buffer, for pictures in the documentation.

matplotlib sorts whole faces by distance, which tears long thin faces apart; a depth buffer does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.typing_aliases import Array, IntArray


@dataclass(frozen=True, eq=False)
class ShadedPart:
    """Vertices (n, 3), faces (m, 3) and a colour (3,) of 0..1."""

    vertices: Array
    faces: IntArray
    colour: tuple[float, float, float]


def vertex_normals(vertices: Array, faces: IntArray) -> Array:
    """Unit normals (n, 3), area-weighted means of the faces about every vertex."""
    corners = vertices[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, faces[:, k], flat)
    size = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray(total / np.where(size > 0.0, size, 1.0))


def _camera(azimuth: float, elevation: float) -> Array:
    """Rows: right, up, towards the viewer; angles in degrees, azimuth from the x axis about z."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(towards, right), towards])


def render(
    parts: Sequence[ShadedPart],
    azimuth: float,
    elevation: float,
    focus: tuple[tuple[float, float, float], float] | None,
    width: int,
    height: int,
) -> Array:
    """An image (height, width, 3) of 0..1 on white.

    Args:
        parts: what is shown.
        azimuth, elevation: where the viewer stands, degrees.
        focus: the point in the middle of the picture and half of the picture's width, m; None fits everything.
        width, height: pixels; the scale is the same in both directions.
    """
    camera = _camera(azimuth, elevation)
    placed = [part.vertices @ camera.T for part in parts]
    if focus is None:
        every = np.concatenate(placed)
        low, high = every.min(axis=0), every.max(axis=0)
        centre = 0.5 * (low + high)
        scale = 0.94 * min(width / (high[0] - low[0]), height / (high[1] - low[1]))
    else:
        centre = camera @ np.array(focus[0])
        scale = 0.5 * width / focus[1]
    image = np.ones((height, width, 3))
    depth = np.full((height, width), -np.inf)
    # Over the viewer's left shoulder: whatever faces the viewer is lit.
    light = camera.T @ np.array([-0.3, 0.25, 0.9])
    light /= np.linalg.norm(light)
    for part, seen in zip(parts, placed, strict=True):
        brightness = 0.35 + 0.65 * np.clip(vertex_normals(part.vertices, part.faces) @ light, 0.0, 1.0)
        pixel = np.column_stack(
            [
                0.5 * width + scale * (seen[:, 0] - centre[0]),
                0.5 * height - scale * (seen[:, 1] - centre[1]),
                seen[:, 2],
            ]
        )
        colour = np.array(part.colour)
        for a, b, c in part.faces:
            _fill(image, depth, pixel[[a, b, c]], brightness[[a, b, c]], colour)
    return image


def _fill(image: Array, depth: Array, corners: Array, brightness: Array, colour: Array) -> None:
    """Draws one triangle into the image where it is nearest."""
    height, width = depth.shape
    low = np.maximum(np.floor(corners[:, :2].min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corners[:, :2].max(axis=0)).astype(int) + 1, [width, height])
    if np.any(low >= high):
        return
    (x0, y0), (x1, y1), (x2, y2) = corners[:, :2]
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if abs(area) < 1e-12:
        return
    x = np.arange(low[0], high[0])[None, :] + 0.5
    y = np.arange(low[1], high[1])[:, None] + 0.5
    second = ((x - x0) * (y2 - y0) - (x2 - x0) * (y - y0)) / area
    third = ((x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)) / area
    first = 1.0 - second - third
    inside = (first >= -1e-9) & (second >= -1e-9) & (third >= -1e-9)
    distance = first * corners[0, 2] + second * corners[1, 2] + third * corners[2, 2]
    rows, columns = slice(low[1], high[1]), slice(low[0], high[0])
    nearest = inside & (distance > depth[rows, columns])
    depth[rows, columns] = np.where(nearest, distance, depth[rows, columns])
    shade = (first * brightness[0] + second * brightness[1] + third * brightness[2])[..., None] * colour
    image[rows, columns] = np.where(nearest[..., None], np.clip(shade, 0.0, 1.0), image[rows, columns])
