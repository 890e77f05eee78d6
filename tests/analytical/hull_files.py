"""Hulls by formulas, written as people write them: the files of the tests of hull input."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import trimesh

from hpsop_core.typing_aliases import Array

# A small hull: volume of the formula (fine Simpson rule) 8,089 m3; of a surface through 21 x 12 readings 8,073 m3.
LENGTH, BREADTH, DRAFT = 120.0, 17.0, 6.5
HEIGHTS = np.array([0, 0.5, 1, 1.6, 2.4, 3.2, 4.1, 5, 5.8, 6.5, 7.5, 9])
STATIONS = np.linspace(0.0, LENGTH, 21)


def half_breadth(x: Array, z: Array) -> Array:
    """Half-breadths (nx, nz), fuller aft than forward."""
    s = (2.0 * x / LENGTH - 1.0)[:, None]
    girth = 1.0 - 0.45 * np.maximum(0.0, 1.0 - z / DRAFT) ** 3
    return BREADTH / 2 * (1.0 - np.abs(s) ** 2.4) * (1.0 - 0.25 * s) / 1.03 * girth


def written(path: Path, text: str, encoding: str = "utf-8") -> Path:
    """The file with that text."""
    path.write_bytes(text.encode(encoding))
    return path


def long_form(
    x: Sequence[float] | Array,
    z: Sequence[float] | Array,
    y: Array,
    header: Sequence[str] = ("station_x_m", "waterline_z_m", "half_breadth_m"),
    separator: str = ",",
    number: Callable[[float], str] = "{:.6g}".format,
    quote: str = "",
) -> str:
    """One reading a row."""
    lines = [separator.join(f"{quote}{name}{quote}" for name in header)]
    for a, row in zip(x, y, strict=True):
        for b, c in zip(z, row, strict=True):
            lines.append(separator.join(f"{quote}{number(float(value))}{quote}" for value in (a, b, c)))
    return "\n".join(lines) + "\n"


def matrix(labels_down: Sequence[str], labels_across: Sequence[str], values: Array, corner: str = "station") -> str:
    """A row a label."""
    lines = [",".join([corner, *labels_across])]
    lines += [",".join([label, *(f"{v:.6g}" for v in row)]) for label, row in zip(labels_down, values, strict=True)]
    return "\n".join(lines) + "\n"


def feet_inches(value: float) -> str:
    """Metres as feet-inches-eighths, to the nearest eighth."""
    eighths = round(value / 0.0254 * 8.0)
    return f"{eighths // 96}-{eighths % 96 // 8}-{eighths % 8}"


def parabolic_mesh(deck: bool = True, freeboard: float = 3.0, fin: bool = False) -> trimesh.Trimesh:
    """A hull of 100 x 10 x 6.25 m: y = B/2 (1 - s^2) (1 + 0.35 s) (1 - t^2) below the draft, upright above."""
    length, breadth, draft, nx = 100.0, 10.0, 6.25, 41
    s = np.linspace(-1.0, 1.0, nx)
    z = np.linspace(0.0, draft, 13)
    if freeboard:
        z = np.concatenate([z, np.linspace(draft, draft + freeboard, 3)[1:]])
    t = np.clip((draft - z) / draft, 0.0, 1.0)
    y = breadth / 2 * ((1.0 - s**2) * (1.0 + 0.35 * s))[:, None] * (1.0 - t**2)
    x = np.repeat(((s + 1.0) / 2 * length)[:, None], len(z), axis=1)
    side = np.stack([x, y, np.repeat(z[None], nx, axis=0)], axis=-1).reshape(-1, 3)
    vertices = np.concatenate([side, side * [1.0, -1.0, 1.0]])
    n, mirrored, faces = len(z), nx * len(z), []
    for i in range(nx - 1):
        for k in range(n - 1):
            a, b, c, d = i * n + k, (i + 1) * n + k, (i + 1) * n + k + 1, i * n + k + 1
            # At the stem the other diagonal leaves no triangle in the centreplane: with it, a fin without thickness.
            cut = [(a, d, b), (b, d, c)] if i == nx - 2 and not fin else [(a, c, b), (a, d, c)]
            faces += cut
            faces += [(p + mirrored, r + mirrored, q + mirrored) for p, q, r in cut]
        if deck:
            a, b = i * n + n - 1, (i + 1) * n + n - 1
            faces += [(a, a + mirrored, b + mirrored), (a, b + mirrored, b)]
    mesh = trimesh.Trimesh(vertices, np.array(faces), process=False)
    mesh.merge_vertices()
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def changed(
    mesh: trimesh.Trimesh, scale: Sequence[float] = (1, 1, 1), shift: Sequence[float] = (0, 0, 0)
) -> trimesh.Trimesh:
    """The mesh scaled, then moved."""
    return trimesh.Trimesh(mesh.vertices * np.array(scale) + np.array(shift), mesh.faces, process=False)
