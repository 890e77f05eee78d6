"""The water surface of a design at a condition: level 2's own solution, or level 1's Kelvin pattern.

Level 1 draws the free waves of thin-ship theory. Each slice of the hull sends its waves astern only,

    zeta(x, y) = 4 k0/pi int_0^inf s cos(k0 s u y) Re{ exp(-i k0 s x) F(u; x) } du,     s = sqrt(1 + u^2),

x aft, F the Kochin function of the slices ahead of x (sources dY/dx, Havelock's point source superposed), so that far
astern |F| is the spectrum whose energy Michell's integral counts. The near field that decays is left out, and so are
waves steeper than the grid can carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.hydro.rankine.solver import solve

Array = NDArray[np.float64]
_COLUMNS, _ROWS = 264, 68
_DOWNSTREAM, _UPSTREAM, _HALF_WIDTH = 1.1, 0.25, 0.62
# a shown sea ends softly over this part of its width and of its length
_RIM = 0.18
# inside the hull the sheet may go on a little: what matters is that no gap shows between water and hull, m
_OVERLAP = 0.6
_LARGEST_TANGENT = 2.6
_TANGENTS = 260


@dataclass(frozen=True)
class WaveField:
    """A water surface in ship axes.

    Attributes:
        x, y, elevation: (nx, ny) m, port side; elevation above the static waterline.
        note: what it is, for the legend.
    """

    x: Array
    y: Array
    elevation: Array
    note: str


def panel_waves(hull: Hull, froude_number: float) -> WaveField:
    """Level 2's surface.

    Raises:
        SolverFailure: the Rankine solver gives no answer.
    """
    condition = solve(hull, (froude_number,), fields=True).conditions[0]
    fields = condition.fields
    if fields is None:
        raise ValueError("the solver was asked for fields")
    # Coordinates in straight lines: a spline through the rows' step around the stern would fold the sheet.
    x, y, elevation = _finer(fields.x, 1), _finer(fields.y, 1), _finer(fields.elevation, 3)
    x, y, elevation = _up_to_the_hull(hull, x, y, elevation)
    return WaveField(x, y, elevation, f"level 2, Rankine panels, Fn {froude_number:.3f}")


def _up_to_the_hull(hull: Hull, x: Array, y: Array, elevation: Array) -> tuple[Array, Array, Array]:
    """One more row of points, on the centreplane or just inside the hull: panels' centres begin half a panel out."""
    inner = np.minimum(np.maximum(_half_breadth_at(hull, x[:, 0]) - _OVERLAP, 0.0), y[:, 0])
    return tuple(  # type: ignore[return-value]
        np.concatenate([edge[:, None], values], axis=1)
        for edge, values in ((x[:, 0], x), (inner, y), (elevation[:, 0], elevation))
    )


def _finer(values: Array, degree: int) -> Array:
    """A grid drawn through by splines of a degree, so that the eye sees waves and not cells; its own points stay."""
    rows = np.arange(values.shape[0])
    columns = np.arange(values.shape[1])
    spline = RectBivariateSpline(rows, columns, values, kx=degree, ky=degree)
    return np.asarray(
        spline(np.linspace(0, rows[-1], 3 * rows[-1] + 1), np.linspace(0, columns[-1], 4 * columns[-1] + 1))
    )


def kelvin_waves(hull: Hull, froude_number: float, calibration: float) -> WaveField:
    """Level 1's Kelvin pattern.

    Args:
        hull: the design's.
        froude_number: on its length.
        calibration: the factor on its wave resistance; heights take its root.
    """
    length, k0 = hull.length, 1.0 / froude_number**2
    tangent, middle, ahead = kochin_functions(hull, froude_number)
    secant = np.sqrt(1.0 + tangent**2)
    x_aft = np.linspace(-_UPSTREAM, 1.0 + _DOWNSTREAM, _COLUMNS)
    spread = np.linspace(0.0, 1.0, _ROWS) ** 1.3
    inner = _half_breadth_at(hull, length * (1.0 - x_aft)) / length
    y = inner[:, None] + (_HALF_WIDTH - inner[:, None]) * spread
    spectrum = ahead[:, np.searchsorted(middle, x_aft)] * np.exp(-1j * k0 * np.outer(secant, x_aft))
    # a soft end of the spectrum: a hard one would ring
    taper = 0.5 * (1.0 + np.cos(np.pi * np.clip((tangent / _LARGEST_TANGENT - 0.6) / 0.4, 0.0, 1.0)))
    amplitude = spectrum.real * (taper * secant)[:, None]
    across = np.cos(k0 * (secant * tangent)[:, None, None] * y[None, :, :])
    elevation = (4.0 * k0 / np.pi) * (_LARGEST_TANGENT / _TANGENTS) * np.einsum("uj,ujr->jr", amplitude, across)
    height = elevation * length * np.sqrt(max(calibration, 0.0))
    x = np.repeat((length * (1.0 - x_aft))[:, None], _ROWS, axis=1)
    scaled = "" if abs(calibration - 1.0) < 1e-9 else f", heights × √{calibration:.3g}"
    note = f"level 1, Kelvin pattern of Michell's spectrum{scaled}"
    return WaveField(x, y * length, height, note)


def kochin_functions(hull: Hull, froude_number: float) -> tuple[Array, Array, NDArray[np.complex128]]:
    """What the slices of a hull ahead of each place send astern, by thin-ship theory; lengths in ship lengths.

    Returns:
        u = tan(theta), shape (k,), at the middles of equal steps; the slices' places aft of FP, shape (n,); and F,
        shape (k, n + 1): column j holds the first j slices, the last one all.
    """
    table = hull.offset_table()
    length, k0 = hull.length, 1.0 / froude_number**2
    # aft from FP, in lengths; sources are dY along the flow
    stations = (length - table.x[::-1]) / length
    half_breadth = table.y[::-1] / length
    depth = (table.z - table.z[-1]) / length
    rises = np.diff(half_breadth, axis=0)
    middle = 0.5 * (stations[1:] + stations[:-1])
    tangent = (np.arange(_TANGENTS) + 0.5) * (_LARGEST_TANGENT / _TANGENTS)
    secant = np.sqrt(1.0 + tangent**2)
    decay = k0 * secant**2
    top, bottom = np.exp(np.outer(decay, depth[1:])), np.exp(np.outer(decay, depth[:-1]))
    weights = (top - bottom) / decay[:, None]
    sources = weights @ (0.5 * (rises[:, 1:] + rises[:, :-1])).T
    phase = np.exp(1j * k0 * secant[:, None] * middle)
    ahead = np.concatenate([np.zeros((_TANGENTS, 1)), np.cumsum(sources * phase, axis=1)], axis=1)
    return tangent, middle, ahead


def _half_breadth_at(hull: Hull, x: Array) -> Array:
    """The waterline's half-breadth in m at stations x (m from AP), zero outside the hull."""
    line = hull.waterline()
    return np.interp(x, line[:, 0], line[:, 1], left=0.0, right=0.0)


@dataclass(frozen=True)
class WaveSurface:
    """Both sides of a water surface as one mesh.

    Attributes:
        vertices: (n, 3) m in ship axes at true scale; faces: (m, 3).
        elevation: (n,) m.
        opacity: (n,) from 1 to 0 at the rim.
    """

    vertices: Array
    faces: NDArray[np.int64]
    elevation: Array
    opacity: Array


def wave_surface(field: WaveField, draft: float) -> WaveSurface:
    """The field as a mesh about the waterline at ``draft`` (m)."""
    nx, ny = field.x.shape
    index = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    # rows run aft and columns to port: turned round, so that the faces look up
    faces = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    if field.x[0, 0] < field.x[-1, 0]:
        faces = faces[:, ::-1]
    port = np.stack([field.x, field.y, draft + field.elevation], axis=-1).reshape(-1, 3)
    heights, opacity = field.elevation.ravel(), _soft_rim(field).ravel()
    return WaveSurface(
        np.concatenate([port, port * np.array([1.0, -1.0, 1.0])]),
        np.concatenate([faces, faces[:, ::-1] + nx * ny]),
        np.concatenate([heights, heights]),
        np.concatenate([opacity, opacity]),
    )


def _soft_rim(field: WaveField) -> Array:
    """1 within, falling to 0 at the ends and at the outer edge."""
    x, width = field.x, np.abs(field.y[:, -1:]).max()
    along = np.minimum(x - x.min(), x.max() - x) / (_RIM * (x.max() - x.min()))
    across = (width - np.abs(field.y)) / (2.0 * _RIM * width)
    part = np.clip(along, 0.0, 1.0) * np.clip(across, 0.0, 1.0)
    return np.asarray(part * part * (3.0 - 2.0 * part))
