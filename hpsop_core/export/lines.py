"""A design's lines as a DXF drawing in three dimensions: stations, waterlines, buttocks, profile, blade sections."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from ezdxf import units
from ezdxf.filemanagement import new

from hpsop_core.geometry.clearance import propeller_placement
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.hull.lines import plan_lines
from hpsop_core.geometry.propeller.nurbs import blade_outlines
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.geometry.propeller.surface import rotate_blade
from hpsop_core.typing_aliases import Array

SECTION_RADII = (0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
_BLADE_POINTS = 41
_COLOURS = {"STATIONS": 5, "WATERLINES": 4, "DESIGN_WATERLINE": 1, "BUTTOCKS": 3, "PROFILE": 7, "BLADE_SECTIONS": 30}


def design_lines(hull: Hull, propeller: Propeller) -> Iterator[tuple[str, Array]]:
    """(layer, polyline (k, 3) in m, ship axes): the hull's port side, and the sections of every blade."""
    for line in plan_lines(hull):
        yield line.layer, line.points
    placement = propeller_placement(hull, propeller)
    outlines = blade_outlines(propeller, np.array(SECTION_RADII), _BLADE_POINTS)
    for blade in range(propeller.blade_count):
        for line in rotate_blade(outlines, blade, propeller.blade_count) @ placement[:3, :3].T + placement[:3, 3]:
            yield "BLADE_SECTIONS", line


def write_dxf(path: Path, hull: Hull, propeller: Propeller) -> None:
    """Write the lines, a layer a kind, as 3D polylines in metres.

    Raises:
        OSError: the file cannot be written.
    """
    drawing: Any = new("R2010", setup=False)
    drawing.units = units.M
    space = drawing.modelspace()
    for layer, line in design_lines(hull, propeller):
        if layer not in drawing.layers:
            drawing.layers.add(layer, color=_COLOURS[layer])
        space.add_polyline3d(line.tolist(), dxfattribs={"layer": layer})
    drawing.saveas(path)
