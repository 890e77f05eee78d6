"""Axes: limits, round ticks and their labels, linear or logarithmic."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hpsop_core.typing_aliases import Array

Limits = tuple[float, float]
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def nice_step(span: float, count: int) -> float:
    """A tick distance of 1, 2, 2.5 or 5 times a power of ten that divides ``span`` into about ``count`` parts."""
    if not span > 0.0 or not math.isfinite(span):
        return 1.0
    raw = span / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    for factor in (1.0, 2.0, 2.5, 5.0, 10.0):
        if raw <= factor * power * 1.0001:
            return factor * power
    return 10.0 * power


def ticks(limits: Limits, count: int) -> list[float]:
    """Round numbers within the limits."""
    step = nice_step(limits[1] - limits[0], count)
    first = math.ceil(limits[0] / step - 1e-9)
    last = math.floor(limits[1] / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def tick_texts(values: Sequence[float]) -> list[str]:
    """Tick labels with as many decimals as their distance needs and no more."""
    if not values:
        return []
    step = min((b - a for a, b in itertools.pairwise(values)), default=abs(values[0]) or 1.0)
    largest = max(abs(value) for value in values)
    decimals = 0
    while decimals < 8 and abs(round(step, decimals) - step) > 1e-6 * step:
        decimals += 1
    if largest >= 1e5:
        return [f"{value:,.0f}".replace(",", " ") for value in values]
    return [f"{value:.{decimals}f}".replace("-", "−") for value in values]


def logarithmic_ticks(limits: Limits, count: int) -> list[tuple[float, str]]:
    """Powers of ten within the limits with their labels; 2 and 5 times them too where there are few."""
    low, high = (math.log10(value) for value in limits)
    powers = range(math.floor(low), math.ceil(high) + 1)
    every = max(1, math.ceil((high - low) / max(count, 1)))
    steps = (1, 2, 5) if high - low < 2.5 else (1,)
    found = []
    for power in powers:
        for step in steps:
            place = math.log10(step) + power
            if low - 1e-9 <= place <= high + 1e-9 and power % every == 0:
                value = step * 10.0**power
                small = f"{value:.{max(0, -power)}f}" if -3 <= power < 5 else ""
                factor = "" if step == 1 else f"{step}·"
                found.append((value, small or f"{factor}10{str(power).translate(_SUPERSCRIPTS)}"))
    return found


def padded(values: ArrayLike, fraction: float = 0.06, include: Iterable[float] = ()) -> Limits:
    """Limits around finite values with some air; (0, 1) when there are none."""
    numbers = np.concatenate([np.asarray(values, dtype=float).ravel(), np.asarray(list(include), dtype=float)])
    numbers = numbers[np.isfinite(numbers)]
    if numbers.size == 0:
        return (0.0, 1.0)
    low, high = float(numbers.min()), float(numbers.max())
    span = high - low
    if span <= 1e-12 * max(abs(high), 1.0):
        span = max(abs(high), 1e-3) * 0.1
    return (low - fraction * span, high + fraction * span)


@dataclass(frozen=True)
class Axis:
    """One axis of a chart.

    Attributes:
        title: with its unit; an underscore makes a subscript, as in "resistance R_T [MN]".
        limits: of the data; both greater than zero on a logarithmic axis.
        count: about how many ticks.
        logarithmic: whether equal factors are equal distances.

    Raises:
        ValueError: limits that are no interval, or not greater than zero on a logarithmic axis.
    """

    title: str
    limits: Limits
    count: int = 6
    logarithmic: bool = False

    def __post_init__(self) -> None:
        low, high = self.limits
        if not (math.isfinite(low) and math.isfinite(high) and low != high):
            raise ValueError(f"an axis from {low} to {high} has no length")
        if self.logarithmic and not min(low, high) > 0.0:
            raise ValueError(f"a logarithmic axis cannot reach from {low} to {high}: both must be greater than zero")

    def share(self, values: ArrayLike) -> Array:
        """Data to fractions of the axis: 0 at the lower limit, 1 at the upper; NaN where there is no logarithm."""
        numbers = np.asarray(values, dtype=float)
        low, high = self.limits
        if self.logarithmic:
            with np.errstate(divide="ignore", invalid="ignore"):
                numbers = np.where(numbers > 0.0, np.log10(numbers), np.nan)
            low, high = math.log10(low), math.log10(high)
        return np.asarray((numbers - low) / (high - low))

    def ticks(self) -> list[tuple[float, str]]:
        """Places and labels of the ticks."""
        if self.logarithmic:
            return logarithmic_ticks(self.limits, self.count)
        places = ticks(self.limits, self.count)
        return list(zip(places, tick_texts(places), strict=True))
