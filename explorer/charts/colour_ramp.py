"""A number's colour: a few steps that stay apart on the light and on the dark page."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hpsop_core.markup import Markup, fill
from hpsop_core.quantities import Quantity, number_text

COLOURS = ("#5b4bd6", "#2f7fd0", "#159f9a", "#5fa137", "#cf8f13", "#d8503f")
"""From the least to the greatest."""


def steps(values: NDArray[np.float64], limits: tuple[float, float], count: int) -> NDArray[np.int64]:
    """The step of each value (n,), 0 to ``count`` - 1; -1 where there is no number."""
    low, high = limits
    share = (values - low) / (high - low) if high > low else np.full(values.shape, 0.5)
    found = np.clip(np.floor(np.nan_to_num(share, nan=0.0) * count), 0, count - 1).astype(np.int64)
    return np.where(np.isfinite(values), found, -1)


def colour_of(value: float, limits: tuple[float, float]) -> str:
    """The colour of one number, "" where there is none."""
    step = int(steps(np.array([value]), limits, len(COLOURS))[0])
    return COLOURS[step] if step >= 0 else ""


def finite_limits(values: NDArray[np.float64]) -> tuple[float, float]:
    """The least and the greatest number; (0, 1) where there is none."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def ramp(quantity: Quantity, limits: tuple[float, float]) -> Markup:
    """The legend of a colour."""
    share = 100.0 / len(COLOURS)
    stops = ", ".join(
        f"{colour} {share * index:.3g}%, {colour} {share * (index + 1):.3g}%" for index, colour in enumerate(COLOURS)
    )
    return fill(
        '<div class="scale"><div class="scale-title">colour: {}</div><div class="ramp" '
        'style="background:linear-gradient(90deg, {})"></div><div class="scale-ticks"><span>{}</span><span>{}</span>'
        "</div></div>",
        f"{quantity.label}{quantity.place}{f' [{quantity.unit}]' if quantity.unit else ''}",
        stops,
        number_text(limits[0], quantity.decimals),
        number_text(limits[1], quantity.decimals),
    )
