"""The free waves of a thin ship: the Kelvin pattern whose spectrum is Michell's own.

Each cell of the hull between two stations sends its waves astern only,

    zeta(x, y) = 4 k0/pi int_0^inf s cos(k0 s u y) Re{ exp(-i k0 s x) F(u; x) } du,     s = sqrt(1 + u^2),

x aft, F the Kochin function of the cells ahead of x (sources dY/dx, Havelock's point source superposed). Far astern F
is that of the whole hull, and the energy of its waves is Michell's wave resistance. The near field, which decays, is
left out. Waves shorter than a grid can carry are left out of the elevation, but not of the spectrum: it says which.
Source: Havelock, Proc. Roy. Soc. A 149 (1935); Newman, Marine Hydrodynamics (1977), section 6.14.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.hydro.michell import LARGEST_TANGENT, kochin_by_cell, spectrum_resistance
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array, ComplexArray, IntArray

SOLVER = "kelvin 1.0"
# A wave of fewer cells than this, along or across, is not drawn; one of 1/0.6 as many is drawn whole.
FEWEST_CELLS = 3.0
_WHOLE = 0.6
# Steps of u on the shortest oscillation of the integrand; below 2 the pattern would come back as its own echo.
_STEPS = 2.5
# Rows of a grid lie closer together towards the hull.
_CROWDING = 1.3


@dataclass(frozen=True)
class WaveGrid:
    """Where a pattern is computed, in ship lengths.

    Attributes:
        columns: across the track, equally spaced from ``upstream`` before FP to ``downstream`` behind AP.
        rows: along it, from the hull (or the centreplane) to ``half_width`` on the port side.
        upstream, downstream, half_width: in ship lengths.
    """

    columns: int = 264
    rows: int = 96
    upstream: float = 0.25
    downstream: float = 1.1
    half_width: float = 0.62

    def __post_init__(self) -> None:
        if self.columns < 2 or self.rows < 2:
            raise InputError(f"wave grid: {self.columns} columns and {self.rows} rows; give at least 2 of each")
        if not self.half_width > 0.0 or not self.upstream + 1.0 + self.downstream > 0.0:
            raise InputError("wave grid: its length and its half-width must be positive")

    @property
    def column_step(self) -> float:
        """Between columns, in ship lengths."""
        return (self.upstream + 1.0 + self.downstream) / (self.columns - 1)

    @property
    def row_step(self) -> float:
        """Between the outermost rows, where they lie furthest apart, in ship lengths."""
        return float(self.half_width * (1.0 - (1.0 - 1.0 / (self.rows - 1)) ** _CROWDING))


@dataclass(frozen=True, eq=False)
class WaveSpectrum:
    """The free waves far astern of a hull, lengths in Lpp.

    Attributes:
        froude_number: U/sqrt(g Lpp).
        tangent: (k,) u = tan(theta) from 0 in equal steps, theta the angle between a wave's way and the ship's.
        amplitude: (k,) F(u), the Kochin function, with the root of the calibration.
        drawn: (k,) the part of the amplitude that an elevation on a grid holds, from 1 to 0.
    """

    froude_number: float
    tangent: Array
    amplitude: ComplexArray
    drawn: Array

    @property
    def wave_resistance(self) -> float:
        """Rw/(1/2 rho U^2 Lpp^2) that these waves carry away."""
        return self._resistance(np.abs(self.amplitude) ** 2)

    @property
    def drawn_share(self) -> float:
        """The part of it that the drawn waves carry, from 0 to 1."""
        whole = self.wave_resistance
        return self._resistance(np.abs(self.amplitude * self.drawn) ** 2) / whole if whole > 0.0 else 1.0

    def _resistance(self, power: Array) -> float:
        step = float(self.tangent[1] - self.tangent[0])
        return spectrum_resistance(power, 1.0 / self.froude_number**2, self.tangent, step)


@dataclass(frozen=True, eq=False)
class KelvinWaves:
    """A pattern on the port side, in ship axes (x forward from AP, y to port), metres.

    Attributes:
        x, y, elevation: (columns, rows); columns from upstream, rows from the hull.
        spectrum: of the waves far astern.
    """

    x: Array
    y: Array
    elevation: Array
    spectrum: WaveSpectrum


@one_blas_thread()
def kelvin_waves(
    x: Array,
    z: Array,
    half_breadth: Array,
    length: float,
    froude_number: float,
    waterline: Array,
    *,
    calibration: float = 1.0,
    grid: WaveGrid | None = None,
) -> KelvinWaves:
    """The Kelvin pattern of a table of half-breadths.

    Args:
        x: stations in m from AP, ascending, shape (nx,).
        z: waterlines in m above the baseline, ascending; the last one is the water surface, shape (nz,).
        half_breadth: Y in m, shape (nx, nz).
        length: Lpp in m.
        froude_number: U/sqrt(g Lpp).
        waterline: (n, 2) x ascending and y >= 0 in m, at which the rows begin.
        calibration: factor on the wave resistance; heights take its root.
        grid: where; the default reaches a ship's length astern.

    Raises:
        InputError: the Froude number or the calibration is not a positive finite number (the calibration may be zero).
    """
    if not (math.isfinite(froude_number) and froude_number > 0.0):
        raise InputError(f"Kelvin waves: Froude number {froude_number} must be a positive number")
    if not (math.isfinite(calibration) and calibration >= 0.0):
        raise InputError(f"Kelvin waves: calibration {calibration} must be a finite number of at least 0")
    chosen = grid or WaveGrid()
    wave_number = 1.0 / froude_number**2
    cut = _shortest_drawn(chosen, wave_number)
    step = _tangent_step(chosen, wave_number, cut)
    tangent = np.arange(0.0, LARGEST_TANGENT + 0.5 * step, step)
    # aft from FP: the order in which the flow meets the cells
    stations = (length - x[::-1]) / length
    rises = np.diff(half_breadth[::-1], axis=0) / length
    real, imaginary = kochin_by_cell(stations, (z - z[-1]) / length, rises, wave_number, tangent)
    # column j: the first j cells; the last one: all
    ahead: ComplexArray = np.zeros((len(tangent), rises.shape[0] + 1), dtype=np.complex128)
    ahead[:, 1:] = np.cumsum(real + 1j * imaginary, axis=1)
    ahead *= math.sqrt(calibration)
    # a soft end: a hard one would ring
    drawn = 0.5 * (1.0 + np.cos(np.pi * np.clip((tangent / cut - _WHOLE) / (1.0 - _WHOLE), 0.0, 1.0)))
    spectrum = WaveSpectrum(froude_number, tangent, ahead[:, -1].copy(), drawn)

    x_aft = np.linspace(-chosen.upstream, 1.0 + chosen.downstream, chosen.columns)
    inner = np.interp(length * (1.0 - x_aft), waterline[:, 0], waterline[:, 1], left=0.0, right=0.0) / length
    spread = np.linspace(0.0, 1.0, chosen.rows) ** _CROWDING
    y = inner[:, None] + (chosen.half_width - inner[:, None]) * spread
    passed = np.searchsorted(0.5 * (stations[1:] + stations[:-1]), x_aft).astype(np.int64)
    shown: ComplexArray = (ahead * drawn[:, None])[drawn > 0.0]
    elevation = _elevation(wave_number, tangent, shown, step, x_aft, y, passed)
    return KelvinWaves(
        x=np.repeat((length * (1.0 - x_aft))[:, None], chosen.rows, axis=1),
        y=y * length,
        elevation=elevation * length,
        spectrum=spectrum,
    )


def _elevation(
    wave_number: float, tangent: Array, ahead: ComplexArray, step: float, x_aft: Array, y: Array, passed: IntArray
) -> Array:
    """zeta/Lpp (nx, ny) of the first tangents, as many as ``ahead`` has rows, by the trapezoidal rule."""
    u = tangent[: len(ahead)]
    secant = np.sqrt(1.0 + u**2)
    weight = (4.0 * wave_number / np.pi) * step * secant
    weight[0] *= 0.5
    elevation = np.zeros(y.shape)
    for column, (place, cells) in enumerate(zip(x_aft, passed, strict=True)):
        wave = (np.exp(-1j * wave_number * secant * place) * ahead[:, cells]).real * weight
        elevation[column] = wave @ np.cos(wave_number * np.outer(secant * u, y[column]))
    return elevation


def _shortest_drawn(grid: WaveGrid, wave_number: float) -> float:
    """The tangent of the shortest wave that the grid carries: 2 pi/(k0 s) long along, 2 pi/(k0 s u) across."""
    along = 2.0 * np.pi / (wave_number * FEWEST_CELLS * grid.column_step)
    across = 2.0 * np.pi / (wave_number * FEWEST_CELLS * grid.row_step)
    # s = along, and s u = across with s^2 = 1 + u^2
    by_columns = math.sqrt(max(along**2 - 1.0, 0.0))
    by_rows = math.sqrt(0.5 * (math.sqrt(1.0 + 4.0 * across**2) - 1.0))
    least = min(by_columns, by_rows, LARGEST_TANGENT)
    if not least > 0.0:
        raise InputError(
            f"wave grid: its steps of {grid.column_step:.3g} and {grid.row_step:.3g} ship lengths carry no wave at "
            f"this Froude number ({2.0 * np.pi / wave_number:.3g} ship lengths at most); take more columns and rows"
        )
    return least


def _tangent_step(grid: WaveGrid, wave_number: float, cut: float) -> float:
    """A step of u that resolves the phase k0 (s x + s u y) everywhere on the grid up to the shortest drawn wave."""
    secant = math.sqrt(1.0 + cut**2)
    reach = max(1.0 + grid.downstream, 1.0 + grid.upstream)
    rate = wave_number * (reach * cut / secant + grid.half_width * (secant + cut**2 / secant))
    # the phase of F itself turns with the length of the hull, also beyond the drawn waves
    return 2.0 * np.pi / (_STEPS * max(rate, wave_number))
