"""A sheet of paper: frame, title block, views at a scale; lines and words in mm from the left lower corner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new

from hpsop_core.markup import fill, joined, xml_text
from hpsop_core.typing_aliases import Array

WIDTH, HEIGHT = 841.0, 594.0
"""A1 across, mm."""

MARGIN = 10.0
TITLE_WIDTH, TITLE_HEIGHT = 230.0, 52.0
STANDARD_SCALES = tuple(base * 10.0**power for power in range(5) for base in (1.0, 2.0, 2.5, 5.0))
"""1 to so many; the usual ones."""

# Of each layer: width of the line in mm, colour, and DXF's colour number.
LAYERS = {
    "FRAME": (0.5, "#000000", 7),
    "OUTLINE": (0.5, "#000000", 7),
    "LINES": (0.25, "#1a4f8b", 5),
    "WATER": (0.35, "#b03a2e", 1),
    "GRID": (0.13, "#888888", 8),
    "WORDS": (0.25, "#000000", 7),
}


@dataclass(frozen=True, eq=False)
class View:
    """Where a view stands: ``paper = origin + 1000 metres / scale``, mm.

    Attributes:
        x, y: of the view's origin on the paper, mm.
        scale: 1 to so many.
    """

    x: float
    y: float
    scale: float

    def on_paper(self, points: Array) -> Array:
        """(n, 2) m as (n, 2) mm."""
        return np.asarray(np.array([self.x, self.y]) + 1000.0 / self.scale * np.asarray(points))


@dataclass(eq=False)
class Sheet:
    """Being drawn: lines as (layer, (n, 2) mm), words as (x, y, height mm, text, "left" or "middle")."""

    name: str
    lines: list[tuple[str, Array]] = field(default_factory=list)
    words: list[tuple[float, float, float, str, str]] = field(default_factory=list)

    def line(self, layer: str, points: Array) -> None:
        """A polyline in mm."""
        self.lines.append((layer, np.asarray(points, dtype=np.float64)))

    def box(self, layer: str, left: float, bottom: float, width: float, height: float) -> None:
        """A rectangle in mm."""
        right, top = left + width, bottom + height
        self.line(layer, np.array([(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]))

    def word(self, x: float, y: float, text: str, height: float = 2.5, place: str = "left") -> None:
        """A line of words from, or about, x on the base line y."""
        self.words.append((x, y, height, text, place))

    def table(self, x: float, top: float, rows: Sequence[tuple[str, str]], width: float = 105.0) -> None:
        """Names and values below each other, in a box."""
        step = 5.0
        self.box("GRID", x, top - step * len(rows) - 2.0, width, step * len(rows) + 2.0)
        for number, (name, value) in enumerate(rows):
            base = top - step * (number + 1)
            self.word(x + 2.0, base, name)
            self.word(x + 0.62 * width, base, value)

    def frame(self, title: str, lines: Sequence[str]) -> None:
        """Frame and title block."""
        self.box("FRAME", MARGIN, MARGIN, WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN)
        left = WIDTH - MARGIN - TITLE_WIDTH
        self.box("FRAME", left, MARGIN, TITLE_WIDTH, TITLE_HEIGHT)
        self.word(left + 4.0, MARGIN + TITLE_HEIGHT - 10.0, title, 6.0)
        for number, line in enumerate(lines):
            self.word(left + 4.0, MARGIN + TITLE_HEIGHT - 18.0 - 6.0 * number, line, 2.8)


def standard_scale(size: float, room: float) -> float:
    """The least usual scale at which ``size`` m take no more than ``room`` mm."""
    return float(next(scale for scale in STANDARD_SCALES if 1000.0 * size / scale <= room))


def sheet_svg(sheet: Sheet) -> str:
    """The sheet in its true size, mm."""
    parts = [fill('<rect width="{:g}" height="{:g}" fill="white"/>', WIDTH, HEIGHT)]
    for layer, points in sheet.lines:
        width, colour, _ = LAYERS[layer]
        path = " ".join(f"{x:.3f},{HEIGHT - y:.3f}" for x, y in points)
        parts.append(fill('<polyline points="{}" fill="none" stroke="{}" stroke-width="{:g}"/>', path, colour, width))
    for x, y, height, text, place in sheet.words:
        line = '<text x="{:.3f}" y="{:.3f}" font-size="{:g}" font-family="sans-serif" text-anchor="{}">{}</text>'
        parts.append(fill(line, x, HEIGHT - y, 1.35 * height, "middle" if place == "middle" else "start", text))
    head = fill(
        '<svg xmlns="http://www.w3.org/2000/svg" width="{:g}mm" height="{:g}mm" viewBox="0 0 {:g} {:g}">',
        WIDTH, HEIGHT, WIDTH, HEIGHT,
    )  # fmt: skip
    return xml_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{head}{joined(parts)}</svg>\n')


def write_sheets_dxf(path: Path, sheets: Sequence[Sheet]) -> None:
    """Every sheet as a layout of one DXF file, in mm at paper size.

    Raises:
        OSError: the file cannot be written.
    """
    drawing: Any = new("R2010", setup=True)
    drawing.header["$INSUNITS"] = 4
    for layer, (width, _, colour) in LAYERS.items():
        drawing.layers.add(layer, color=colour, lineweight=round(100 * width))
    for sheet in sheets:
        layout = drawing.layouts.new(sheet.name)
        layout.page_setup(size=(WIDTH, HEIGHT), margins=(0, 0, 0, 0), units="mm")
        for layer, points in sheet.lines:
            layout.add_lwpolyline(points.tolist(), dxfattribs={"layer": layer})
        for x, y, height, text, place in sheet.words:
            word = layout.add_text(text, height=height, dxfattribs={"layer": "WORDS"})
            align = TextEntityAlignment.CENTER if place == "middle" else TextEntityAlignment.LEFT
            word.set_placement((x, y), align=align)
    drawing.layouts.delete("Layout1")
    drawing.saveas(path)
