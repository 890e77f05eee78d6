"""Panels of the hull below the waterline as GDF, the file of WAMIT that other seakeeping programs read too."""

from __future__ import annotations

import numpy as np

from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.panels import hull_panels

_GRAVITY = 9.80665
# As fine as seakeeping programs want a ship: panels of 2 to 3 % of the length.
_LENGTHWISE, _GIRTHWISE = 48, 12


def panels_gdf(hull: Hull, title: str) -> str:
    """The port half's panels with the centreplane as plane of symmetry, m.

    Axes: x forward from midship (half of Lpp), y to port, z up from the waterline. Corners go counter-clockwise seen
    from the water, as the format asks. What closes a wet transom in level 2 is no hull: it stays open.
    """
    panels = hull_panels(hull, _LENGTHWISE, _GIRTHWISE, tail_wanted=False)
    quads = panels.quads - np.array([0.5 * hull.length, 0.0, hull.draft])
    quads[..., 1] = np.maximum(quads[..., 1], 0.0)
    quads[..., 2] = np.minimum(quads[..., 2], 0.0)
    lines = [title[:72], f"1.0 {_GRAVITY} ULEN GRAV", "0 1 ISX ISY", f"{len(quads)}"]
    lines += [" ".join(f"{value:.6f}" for value in corner) for corner in quads.reshape(-1, 3).tolist()]
    return "\n".join(lines) + "\n"
