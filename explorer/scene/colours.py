"""Colour scales with their legends, and surfaces painted with them: a pressure map, a sea."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

from hpsop_core.markup import Markup, fill, joined
from hpsop_core.quantities import number_text

Stops = tuple[tuple[int, int, int], ...]
# From low to high. The sea's middle is the undisturbed surface, troughs dark and crests light; pressure runs from
# suction (blue) over a pale middle to stagnation (red).
SEA: Stops = ((10, 42, 92), (30, 98, 148), (104, 168, 204), (190, 222, 236), (255, 255, 255))
PRESSURE: Stops = ((49, 54, 149), (116, 173, 209), (232, 238, 240), (253, 174, 97), (165, 0, 38))
Limits = tuple[float, float, float]
_TEXELS, _OPACITIES = 256, 32
# How much of a surface's light is its own: all of it would be as true as the legend and as flat as paper.
_GLOW = 0.55


def ramp(stops: Stops, count: int) -> NDArray[np.uint8]:
    """``count`` colours (count, 3) from the first stop to the last."""
    place = np.linspace(0.0, len(stops) - 1.0, count)
    table = np.array(stops, dtype=float)
    return np.round(
        np.stack([np.interp(place, np.arange(len(stops)), table[:, channel]) for channel in range(3)], axis=-1)
    ).astype(np.uint8)


def painted(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    values: NDArray[np.float64],
    limits: Limits,
    stops: Stops,
    opacity: NDArray[np.float64] | None = None,
) -> trimesh.Trimesh:
    """A surface coloured by a value at each vertex.

    The colours come from a texture, value to the right and opacity upwards, so that they are interpolated along the
    scale itself and not from one vertex's red to the next one's blue.

    Args:
        vertices, faces: (n, 3) and (m, 3).
        values: (n,), clipped to ``limits``.
        limits: where the scale begins, has its middle, and ends.
        stops: of the scale.
        opacity: (n,) from 0 to 1, or None for a solid surface.
    """
    along = np.interp(values, limits, (0.0, 0.5, 1.0))
    up = np.ones(len(values)) if opacity is None else np.clip(opacity, 0.0, 1.0)
    # the centres of the outer texels are the ends of the scale: beyond them a texture starts again from the other side
    uv = np.column_stack(
        [(0.5 + along * (_TEXELS - 1)) / _TEXELS, (0.5 + up * (_OPACITIES - 1)) / _OPACITIES],
    )
    texture = np.zeros((_OPACITIES, _TEXELS, 4), dtype=np.uint8)
    texture[..., :3] = ramp(stops, _TEXELS)
    # the first row of an image is its upper edge
    texture[..., 3] = np.round(np.linspace(255.0, 0.0, _OPACITIES))[:, None]
    colours = Image.fromarray(texture, "RGBA")
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=colours,
        baseColorFactor=[1.0 - _GLOW] * 3 + [1.0],
        emissiveTexture=colours.convert("RGB"),
        emissiveFactor=[_GLOW] * 3,
        alphaMode="OPAQUE" if opacity is None else "BLEND",
        doubleSided=True,
        metallicFactor=0.0,
        roughnessFactor=0.9,
    )
    mesh = trimesh.Trimesh(
        vertices, faces, visual=trimesh.visual.TextureVisuals(uv=uv, material=material), process=False
    )
    # Without normals in the file a browser shades every triangle flat; once asked for, they are exported.
    _ = mesh.vertex_normals
    return mesh


def around_zero(values: NDArray[np.float64], weights: NDArray[np.float64]) -> Limits:
    """Limits that leave out the outermost 0.3 % of a surface on either side, with zero in the middle.

    Each half has its own length, so that weak suction and strong pressure are both seen.

    Args:
        values: (n,).
        weights: (n,) the surface that each value stands for.
    """
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    low, high = (float(values[order][np.searchsorted(share, part)]) for part in (0.003, 0.997))
    return min(low, -0.01), 0.0, max(high, 0.01)


def _legend(title: Markup, limits: Limits, decimals: int, stops: Stops, note: Markup) -> Markup:
    colours = ", ".join(f"rgb({r},{g},{b})" for r, g, b in stops)
    return fill(
        '<div class="scale"><div class="scale-title">{}</div>'
        '<div class="ramp" style="background:linear-gradient(90deg, {})"></div>'
        '<div class="scale-ticks">{}</div><div class="soft">{}</div></div>',
        title,
        colours,
        joined(fill("<span>{}</span>", number_text(value, decimals)) for value in limits),
        note,
    )


def sea_legend(reach: float, note: Markup) -> Markup:
    """The legend of wave elevations from -reach to reach, m."""
    return _legend(Markup("wave elevation ζ [m]"), (-reach, 0.0, reach), 2 if reach < 1.0 else 1, SEA, note)


def pressure_legend(title: Markup, limits: Limits, note: Markup) -> Markup:
    """The legend of a pressure coefficient."""
    return _legend(title, limits, 2, PRESSURE, note)
