"""The half-breadth table that thin-ship theory reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.typing_aliases import Array, IntArray

# The row z = 0 stands for the flat of bottom; it is read just above the baseline, as a fraction of the draft.
BOTTOM_READING = 4e-4
GIRTH_POINTS = 401


@dataclass(frozen=True, eq=False)
class OffsetTable:
    """Half-breadths y(x, z) of the underwater hull, single-valued.

    Attributes:
        x: (nx,) stations from AP, m, rising, from the aft end of the waterline (or body) to the foremost point.
        z: (nz,) heights from the baseline to the draft, m, rising.
        y: (nx, nz) half-breadths, m, >= 0; 0 outside the hull, the row z = 0 is the flat-of-bottom half-breadth.
    """

    x: Array
    z: Array
    y: Array


def section_half_breadths(section: Array, heights: Array, draft: float) -> Array:
    """Half-breadths of one section curve at given heights; 0 below and above it.

    Args:
        section: (k, 3) points along the section, v from the bottom to the top.
        heights: (nz,) in m, rising; the first one, if it is not above the baseline, stands for the flat of bottom.
        draft: m, sets the height at which the row z = 0 is read.
    """
    height = np.maximum.accumulate(section[:, 2])
    reading = np.maximum(heights, min(float(heights[0]), 0.0) + BOTTOM_READING * draft)
    inside = (reading >= height[0] - 1e-9) & (reading <= height[-1] + 1e-6 * draft)
    # Equal heights (a flat bottom) would make interpolation ambiguous: a rising trace of one picometre a point.
    height = height + 1e-12 * np.arange(len(height))
    return np.where(inside, np.maximum(np.interp(reading, height, section[:, 1]), 0.0), 0.0)


def tabulate(
    surfaces: Sequence[NurbsSurface], parameters: Sequence[Array], stations: Sequence[IntArray], x: Array, z: Array
) -> Array:
    """Half-breadths (nx, nz) of the union of patches at stations x and heights z.

    Args:
        surfaces: underwater patches.
        parameters: for every patch, u of the stations that it covers.
        stations: for every patch, indices into x of those stations.
        x, z: the table's axes, m.
    """
    table = np.zeros((len(x), len(z)))
    # Points gather towards both ends of the girth, where keel and waterline bend most.
    v = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, GIRTH_POINTS))
    draft = float(z[-1])
    for surface, u, index in zip(surfaces, parameters, stations, strict=True):
        if len(u) == 0:
            continue
        points = surface.evaluate(u, v)
        for k, section in zip(index, points, strict=True):
            table[k] = np.maximum(table[k], section_half_breadths(section, z, draft))
    return table
