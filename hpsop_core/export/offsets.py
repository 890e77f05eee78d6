"""A hull as a table of half-breadths, in the form in which users give theirs."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.offset_table import GIRTH_POINTS, section_half_breadths
from hpsop_core.typing_aliases import Array


def half_breadths(hull: Hull, x: Array, z: Array) -> Array:
    """Half-breadths, shape (nx, nz), of the whole hull with its topsides; 0 outside of it.

    Args:
        hull: the hull.
        x: stations in m forward of AP, shape (nx,).
        z: heights in m above the baseline, shape (nz,).
    """
    table = np.zeros((len(x), len(z)))
    v = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, GIRTH_POINTS))
    for patch in hull.patches:
        ends = patch.evaluate(np.array([0.0, 1.0]), np.array([0.0]))[:, 0, 0]
        covered = np.flatnonzero((x >= ends[0]) & (x <= ends[1]))
        if len(covered):
            for station, section in zip(covered, patch.evaluate(patch.parameter(x[covered]), v), strict=True):
                table[station] = np.maximum(table[station], section_half_breadths(section, z, hull.draft))
    return table


def offsets_csv(hull: Hull, x: Array, z: Array) -> str:
    """The table as text: ``station_x_m,waterline_z_m,half_breadth_m``, a row a point, in metres."""
    table = half_breadths(hull, x, z)
    lines = ["station_x_m,waterline_z_m,half_breadth_m"]
    for station, row in zip(x, table, strict=True):
        lines += [f"{station:.4f},{height:.4f},{value:.5f}" for height, value in zip(z, row, strict=True)]
    return "\n".join(lines) + "\n"
