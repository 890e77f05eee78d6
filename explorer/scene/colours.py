"""Colour scales with their legends: a pressure map, a sea."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explorer.quantities import number_text

# Stops of the scales, dark to light; the sea's middle is the undisturbed surface.
_SEA = ((8, 38, 84), (33, 102, 150), (112, 171, 205), (188, 220, 235), (255, 255, 255))
_PRESSURE = ((49, 54, 149), (116, 173, 209), (224, 236, 239), (253, 174, 97), (165, 0, 38))
_STEPS = 9


def _colours(
    values: NDArray[np.float64], low: float, high: float, stops: tuple[tuple[int, int, int], ...]
) -> NDArray[np.uint8]:
    place = np.clip((values - low) / max(high - low, 1e-12), 0.0, 1.0) * (len(stops) - 1)
    table = np.array(stops, dtype=float)
    return np.stack(
        [np.interp(place, np.arange(len(stops)), table[:, channel]) for channel in range(3)], axis=-1
    ).astype(np.uint8)


def sea_colours(elevation: NDArray[np.float64], reach: float) -> NDArray[np.uint8]:
    """Colours (..., 3) of wave heights; ``reach`` (m) is where the scale ends on both sides."""
    return _colours(elevation, -reach, reach, _SEA)


def pressure_colours(coefficient: NDArray[np.float64], low: float, high: float) -> NDArray[np.uint8]:
    """Colours (..., 3) of pressure coefficients."""
    return _colours(coefficient, low, high, _PRESSURE)


def _legend(
    title: str, low: float, high: float, decimals: int, stops: tuple[tuple[int, int, int], ...], note: str
) -> str:
    ramp = ", ".join(f"rgb({r},{g},{b})" for r, g, b in stops)
    return (
        f'<div class="colorbar"><span>{title}</span><span>{number_text(low, decimals)}</span>'
        f'<span class="ramp" style="background:linear-gradient(90deg, {ramp})"></span>'
        f'<span>{number_text(high, decimals)}</span></div><div class="soft">{note}</div>'
    )


def sea_legend(reach: float, note: str) -> str:
    """The legend of wave heights in metres."""
    return _legend("wave height [m]", -reach, reach, 2 if reach < 1.0 else 1, _SEA, note)


def pressure_legend(title: str, low: float, high: float, note: str) -> str:
    """The legend of a pressure coefficient."""
    return _legend(title, low, high, 2, _PRESSURE, note)
