"""The radial table of a propeller blade: what describes a blade, and how it is read between its rows."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array

_COLUMNS = ("chord_ratio", "pitch_ratio", "skew", "rake_ratio", "thickness_ratio", "camber_ratio")


@dataclass(frozen=True, eq=False)
class BladeSections:
    """Blade sections at some radii; every array has the shape of ``radius_ratio``.

    Attributes:
        radius_ratio: r/R.
        chord_ratio: chord c/D.
        pitch_ratio: pitch P/D.
        skew: skew angle theta_s in radians, positive moves the section aft along its own helix.
        rake_ratio: rake/D, positive downstream, without the rake that skew induces.
        thickness_ratio: maximum thickness t/c.
        camber_ratio: maximum camber f/c.
    """

    radius_ratio: Array
    chord_ratio: Array
    pitch_ratio: Array
    skew: Array
    rake_ratio: Array
    thickness_ratio: Array
    camber_ratio: Array

    @property
    def pitch_angle(self) -> Array:
        """Geometric pitch angle phi = atan(P/(2 pi r)) in radians."""
        return np.arctan2(self.pitch_ratio, np.pi * self.radius_ratio)


@dataclass(frozen=True, eq=False)
class RadialTable:
    """A blade as rows over the radius, from the hub (first row) to the tip (last row, r/R = 1).

    Between the rows every column is a modified Akima cubic in sqrt(1 - r/R): the chord of a rounded tip goes to zero
    like that root, so that it is smooth in this variable; the cubic is local, hardly overshoots, and scales with its
    data.

    Attributes:
        name: what the table is called.
        radius_ratio: r/R, strictly ascending, (n,), the first is the hub ratio and the last is 1.
        chord_ratio: c/D, (n,), may be zero at the tip.
        pitch_ratio: P/D, (n,).
        skew: skew angle in radians, (n,).
        rake_ratio: rake/D, (n,).
        thickness_ratio: t/c, (n,).
        camber_ratio: f/c, (n,).
        blade_count: number of blades that the table was drawn for; the family's rules start from it.

    Raises:
        InputError: the columns differ in length, hold a non-finite value, or the radii do not ascend to 1.
    """

    name: str
    radius_ratio: Array
    chord_ratio: Array
    pitch_ratio: Array
    skew: Array
    rake_ratio: Array
    thickness_ratio: Array
    camber_ratio: Array
    blade_count: int = 3

    def __post_init__(self) -> None:
        shape = np.shape(self.radius_ratio)
        for field in fields(self):
            if field.name in ("name", "blade_count"):
                continue
            # a copy, so that making it read-only does not freeze the caller's array
            column = np.array(getattr(self, field.name), dtype=np.float64)
            if column.ndim != 1 or column.shape != shape or column.size < 5:
                raise InputError(
                    f"propeller {self.name}: {field.name} needs one value for each of at least 5 radii, "
                    f"it has shape {column.shape}"
                )
            if not np.all(np.isfinite(column)):
                raise InputError(f"propeller {self.name}: {field.name} holds a value that is not a finite number")
            column.setflags(write=False)
            object.__setattr__(self, field.name, column)
        radius = self.radius_ratio
        if np.any(np.diff(radius) <= 0.0) or radius[0] <= 0.0 or abs(radius[-1] - 1.0) > 1e-9:
            raise InputError(f"propeller {self.name}: radius_ratio must ascend from the hub to 1 at the tip")
        if np.any(self.chord_ratio[:-1] <= 0.0) or self.chord_ratio[-1] < 0.0:
            raise InputError(f"propeller {self.name}: chord_ratio must be positive (zero only at the tip)")

    @property
    def hub_ratio(self) -> float:
        """Hub radius over tip radius."""
        return float(self.radius_ratio[0])

    @cached_property
    def _interpolant(self) -> Akima1DInterpolator:
        abscissa = np.sqrt(np.maximum(1.0 - self.radius_ratio, 0.0))[::-1]
        columns = np.stack([getattr(self, name)[::-1] for name in _COLUMNS], axis=1)
        return Akima1DInterpolator(abscissa, columns, axis=0, method="makima", extrapolate=True)

    def at(self, radius_ratio: Array) -> BladeSections:
        """The sections at ``radius_ratio`` (any shape), continued smoothly to 0.9 of the hub radius and held there."""
        radius = np.asarray(radius_ratio, dtype=np.float64)
        values = np.asarray(
            self._interpolant(np.sqrt(1.0 - np.clip(radius, 0.9 * self.hub_ratio, 1.0))), dtype=np.float64
        )
        columns = {name: values[..., i] for i, name in enumerate(_COLUMNS)}
        columns["chord_ratio"] = np.maximum(columns["chord_ratio"], 0.0)
        return BladeSections(radius_ratio=radius, **columns)

    @cached_property
    def at_07R(self) -> BladeSections:
        """The section at 0.7 R, which stands for the blade in so many formulas; each number an array of shape ()."""
        return self.at(np.array(0.7))

    @cached_property
    def expanded_area_ratio_per_blade(self) -> float:
        """Expanded blade area ratio of one blade, (2/pi) int c/D d(r/R); multiply by the number of blades."""
        # Gauss-Legendre between the rows, in the variable in which the chord is a cubic: exact up to rounding.
        ends = np.sqrt(np.maximum(1.0 - self.radius_ratio, 0.0))[::-1]
        nodes, weights = np.polynomial.legendre.leggauss(4)
        half = 0.5 * np.diff(ends)[:, None]
        abscissa = ends[:-1, None] + half * (1.0 + nodes)
        chord = np.asarray(self._interpolant(abscissa), dtype=np.float64)[..., 0]
        return float(2.0 / np.pi * np.sum(half * weights * chord * 2.0 * abscissa))
