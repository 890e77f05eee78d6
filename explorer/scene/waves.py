"""The water surface of a design as a mesh that an eye takes for water."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from hpsop_core.evaluation.fields import WaveField
from hpsop_core.markup import Markup, fill

Array = NDArray[np.float64]
# a shown sea ends softly over this part of its width and of its length
_RIM = 0.18
# inside the hull the sheet may go on a little: what matters is that no gap shows between water and hull, m
_OVERLAP = 0.6


@dataclass(frozen=True)
class WaveSurface:
    """Both sides of a water surface as one mesh.

    Attributes:
        vertices: (n, 3) m in ship axes at true scale; faces: (m, 3).
        elevation: (n,) m.
        opacity: (n,) from 1 to 0 at the rim.
        note: what it is, for the legend (markup).
    """

    vertices: Array
    faces: NDArray[np.int64]
    elevation: Array
    opacity: Array
    note: Markup


def wave_surface(field: WaveField) -> WaveSurface:
    """The field as a mesh about the waterline."""
    x, y, elevation = _panel_sheet(field) if field.level == 2 else (field.x, field.y, field.elevation)
    nx, ny = x.shape
    index = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    # rows run aft and columns to port: turned round, so that the faces look up
    faces = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    if x[0, 0] < x[-1, 0]:
        faces = faces[:, ::-1]
    port = np.stack([x, y, field.draft + elevation], axis=-1).reshape(-1, 3)
    heights, opacity = elevation.ravel(), _soft_rim(x, y).ravel()
    # both sides share the points on the centreplane, or the light would show a seam there
    off = np.flatnonzero(port[:, 1] != 0.0)
    mirrored = np.arange(nx * ny)
    mirrored[off] = nx * ny + np.arange(len(off))
    return WaveSurface(
        np.concatenate([port, port[off] * np.array([1.0, -1.0, 1.0])]),
        np.concatenate([faces, mirrored[faces[:, ::-1]]]),
        np.concatenate([heights, heights[off]]),
        np.concatenate([opacity, opacity[off]]),
        _note(field),
    )


def _note(field: WaveField) -> Markup:
    if field.spectrum is None:
        return fill("level 2, Rankine panels, Fn {:.3f}; true scale", field.froude_number)
    scaled = abs(field.wave_calibration - 1.0) > 1e-9
    heights = f", heights × √{field.wave_calibration:.3g}" if scaled else ""
    share = f"{100.0 * field.spectrum.drawn_share:.0f} %"
    return fill("level 1, Kelvin pattern{}; true scale<br>the waves drawn carry {} of R<sub>W</sub>", heights, share)


def _panel_sheet(field: WaveField) -> tuple[Array, Array, Array]:
    """The panels' grid drawn through, and up to the hull."""
    # Coordinates in straight lines: a spline through the rows' step around the stern would fold the sheet.
    x, y, elevation = _finer(field.x, 1), _finer(field.y, 1), _finer(field.elevation, 3)
    # One more row of points, on the centreplane or just inside the hull: panels' centres begin half a panel out.
    line = field.waterline
    beside = np.interp(x[:, 0], line[:, 0], line[:, 1], left=0.0, right=0.0)
    inner = np.minimum(np.maximum(beside - _OVERLAP, 0.0), y[:, 0])
    edges = x[:, 0], inner, elevation[:, 0]
    x, y, elevation = (
        np.concatenate([edge[:, None], values], axis=1) for edge, values in zip(edges, (x, y, elevation), strict=True)
    )
    return x, y, elevation


def _finer(values: Array, degree: int) -> Array:
    """A grid drawn through by splines of a degree, so that the eye sees waves and not cells; its own points stay."""
    rows = np.arange(values.shape[0])
    columns = np.arange(values.shape[1])
    spline = RectBivariateSpline(rows, columns, values, kx=degree, ky=degree)
    return np.asarray(
        spline(np.linspace(0, rows[-1], 3 * rows[-1] + 1), np.linspace(0, columns[-1], 4 * columns[-1] + 1))
    )


def _soft_rim(x: Array, y: Array) -> Array:
    """1 within, falling to 0 at the ends and at the outer edge."""
    width = np.abs(y[:, -1:]).max()
    along = np.minimum(x - x.min(), x.max() - x) / (_RIM * (x.max() - x.min()))
    across = (width - np.abs(y)) / (2.0 * _RIM * width)
    part = np.clip(along, 0.0, 1.0) * np.clip(across, 0.0, 1.0)
    return np.asarray(part * part * (3.0 - 2.0 * part))
