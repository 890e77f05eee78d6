"""What stands around the ship: calm water that ends softly, and a sky for the light and the dark page."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

# the sea's colour on the light and on the dark page
_WATER = {False: (52, 122, 164), True: (26, 74, 108)}
_OPACITY = 0.46
_TEXELS = 384
# ripples: lengths over the sheet's half width, the wind's direction, and how much of the light they take
_RIPPLES, _WIND, _CONTRAST = (0.028, 0.12), 0.7, {False: 34.0, True: 22.0}
_SHADES = 16
# The sky's colours from nadir over horizon to zenith, by the sine of the height; under the horizon lies more sea than
# is drawn. viser's tone mapping turns grey what is brighter than these.
_HEIGHTS = (-1.0, -0.25, -0.02, 0.02, 0.30, 1.0)
_SKY = {
    False: ((198, 214, 223), (188, 208, 221), (164, 196, 216), (211, 218, 223), (176, 203, 224), (128, 172, 218)),
    True: ((20, 26, 33), (22, 30, 38), (26, 36, 46), (48, 57, 67), (32, 39, 48), (20, 24, 30)),
}


@cache
def calm_water(dark: bool) -> bytes:
    """A sheet from -1 to 1 at z = 0, rippled, whose opacity falls to nothing at its rim: a sea has no edge.

    A GLB file, lit by itself: a lit sheet costs a screen without graphics hardware as much as the ship. The ripples are
    paint: what waves the ship makes is another drawing.
    """
    place = (np.arange(_TEXELS) + 0.5) / _TEXELS * 2.0 - 1.0
    radius = np.hypot(*np.meshgrid(place, place))
    fade = np.clip((1.0 - radius) / 0.6, 0.0, 1.0)
    texture = np.zeros((_TEXELS, _TEXELS, 4), dtype=np.uint8)
    light = _CONTRAST[dark] * _ripples(place)
    texture[..., :3] = np.clip(np.array(_WATER[dark]) + light[..., None] * np.array([0.8, 1.0, 1.0]), 0.0, 255.0)
    texture[..., 3] = np.round(255.0 * _OPACITY * fade**2 * (3.0 - 2.0 * fade))
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.fromarray(texture, "RGBA"),
        alphaMode="BLEND",
        doubleSided=True,
        metallicFactor=0.0,
        roughnessFactor=1.0,
    )
    sheet = trimesh.Trimesh(
        corners,
        np.array([[0, 1, 2], [0, 2, 3]]),
        visual=trimesh.visual.TextureVisuals(uv=0.5 * (corners[:, :2] + 1.0), material=material),
        process=False,
    )
    return _file(sheet)


def _ripples(place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Light on a slightly moved surface, -1 to 1 in steps, on the square of these places; the same every time."""
    chance = np.random.default_rng(20)
    x, y = np.meshgrid(place, place)
    slope = np.zeros_like(x)
    for length in np.geomspace(*_RIPPLES, 24):
        angle, phase = _WIND + chance.normal(0.0, 0.5), chance.uniform(0.0, 2.0 * np.pi)
        slope += np.cos(2.0 * np.pi / length * (np.cos(angle) * x + np.sin(angle) * y) + phase)
    slope /= np.abs(slope).max()
    # few shades: the picture travels to the browser
    return np.asarray(np.round(slope * 0.5 * _SHADES) / (0.5 * _SHADES))


@cache
def sky(dark: bool) -> bytes:
    """A sphere of radius 1 with the sky on its inside, lit by itself, as a GLB file."""
    sphere = trimesh.creation.uv_sphere(radius=1.0, count=(24, 24))
    height = np.linspace(1.0, -1.0, 512)
    colours = np.array(_SKY[dark], dtype=float)
    column = np.stack([np.interp(height, _HEIGHTS, colours[:, channel]) for channel in range(3)], axis=-1)
    picture = np.repeat(np.round(column).astype(np.uint8)[:, None, :], 4, axis=1)
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.fromarray(picture, "RGB"), doubleSided=True, metallicFactor=0.0, roughnessFactor=1.0
    )
    uv = np.column_stack([np.full(len(sphere.vertices), 0.5), 0.5 + 0.499 * sphere.vertices[:, 2]])
    shell = trimesh.Trimesh(
        sphere.vertices,
        sphere.faces,
        visual=trimesh.visual.TextureVisuals(uv=uv, material=material),
        process=False,
    )
    return _file(shell)


def backdrop(dark: bool, height: int) -> NDArray[np.uint8]:
    """What stands behind a picture that the sky itself is not in: (height, 1, 3), from the sky down to the sea."""
    colours = np.array(_SKY[dark], dtype=float)
    down = np.linspace(0.5, -0.5, height)
    column = np.stack([np.interp(down, _HEIGHTS, colours[:, channel]) for channel in range(3)], axis=-1)
    return np.round(column).astype(np.uint8)[:, None, :]


def _file(surface: trimesh.Trimesh) -> bytes:
    return bytes(trimesh.exchange.gltf.export_glb(trimesh.Scene(surface), tree_postprocessor=_unlit))


def _unlit(tree: dict[str, Any]) -> None:
    """Colours as they are, whatever lamps there are."""
    tree["extensionsUsed"] = [*tree.get("extensionsUsed", []), "KHR_materials_unlit"]
    for material in tree["materials"]:
        material["extensions"] = {"KHR_materials_unlit": {}}
