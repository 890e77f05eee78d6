"""What stands around the ship: calm water that ends softly, and a quiet background for the light and the dark page."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

_WATER = (86, 146, 186)
_OPACITY = 0.42
_TEXELS = 192
# The background from the upper to the lower edge; banding shows where the steps are larger than a grey level.
_SKY = {False: ((226, 234, 242), (250, 251, 252)), True: ((24, 28, 34), (44, 51, 60))}


def calm_water() -> trimesh.Trimesh:
    """A sheet from -1 to 1 at z = 0 whose opacity falls to nothing at its rim: a sea has no edge."""
    place = (np.arange(_TEXELS) + 0.5) / _TEXELS * 2.0 - 1.0
    radius = np.hypot(*np.meshgrid(place, place))
    fade = np.clip((1.0 - radius) / 0.6, 0.0, 1.0)
    texture = np.zeros((_TEXELS, _TEXELS, 4), dtype=np.uint8)
    texture[..., :3] = _WATER
    texture[..., 3] = np.round(255.0 * _OPACITY * fade**2 * (3.0 - 2.0 * fade))
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.fromarray(texture, "RGBA"),
        alphaMode="BLEND",
        doubleSided=True,
        metallicFactor=0.0,
        roughnessFactor=1.0,
    )
    return trimesh.Trimesh(
        corners,
        np.array([[0, 1, 2], [0, 2, 3]]),
        visual=trimesh.visual.TextureVisuals(uv=0.5 * (corners[:, :2] + 1.0), material=material),
        process=False,
    )


def backdrop(dark: bool) -> NDArray[np.uint8]:
    """The background as a small RGB image."""
    upper, lower = (np.array(colour, dtype=float) for colour in _SKY[dark])
    down = np.linspace(0.0, 1.0, 256)[:, None]
    column = np.round(upper + (lower - upper) * down).astype(np.uint8)
    return np.repeat(column[:, None, :], 4, axis=1)
