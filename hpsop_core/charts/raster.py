"""A sheet of charts as PNG: the elements that charts are made of, drawn by Pillow from their own SVG."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from xml.etree import ElementTree

from PIL import Image, ImageDraw, ImageFont

from hpsop_core.charts.style import PRINT, ROLES, Style

# Drawn this many times as large and reduced: edges come out smooth.
OVERSAMPLING = 3
_TOKEN = re.compile(r"[a-zA-Z]|-?\d*\.?\d+(?:e-?\d+)?")
# The letters that come with Pillow lack these.
_PLAIN = str.maketrans({"−": "-", "²": "2", "³": "3", "·": "."})
_COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "z": 0, "a": 7}


@dataclass(frozen=True)
class _Frame:
    """Where px of an element lie on the picture: turned where ``turned``, scaled, then shifted."""

    scale: float
    left: float
    top: float
    turned: bool = False

    def at(self, x: float, y: float) -> tuple[float, float]:
        if self.turned:
            x, y = y, -x
        return self.left + self.scale * x, self.top + self.scale * y


def png_of(svg: str, style: Style = PRINT, scale: float = 1.6) -> bytes:
    """The picture of a sheet that ``sheet.sheet_svg`` made.

    Args:
        svg: the sheet.
        style: with which it was made.
        scale: pixels a px of the sheet.
    """
    root = ElementTree.fromstring(svg)
    width, height = float(root.get("width", "0")), float(root.get("height", "0"))
    big = scale * OVERSAMPLING
    image = Image.new("RGB", (round(width * big), round(height * big)), "white")
    _draw(root, _Frame(big, 0.0, 0.0), ImageDraw.Draw(image), style)
    target = io.BytesIO()
    image.resize((round(width * scale), round(height * scale)), Image.Resampling.LANCZOS).save(target, "PNG")
    return target.getvalue()


def _draw(element: ElementTree.Element, frame: _Frame, pen: ImageDraw.ImageDraw, style: Style) -> None:
    for child in element:
        kind = child.tag.rsplit("}", 1)[-1]
        if kind in ("style", "clipPath", "title"):
            continue
        inner = frame
        if kind == "svg":
            left, top = frame.at(float(child.get("x", "0")), float(child.get("y", "0")))
            inner = _Frame(frame.scale, left, top)
        elif kind == "g" and "translate" in (child.get("transform") or ""):
            across, down = (float(word) for word in re.findall(r"-?[\d.]+", child.get("transform", ""))[:2])
            left, top = frame.at(across, down)
            inner = _Frame(frame.scale, left, top, "rotate" in child.get("transform", ""))
        elif kind == "path":
            _path(child, frame, pen, style)
        elif kind == "rect":
            _rectangle(child, frame, pen, style)
        elif kind == "text":
            _text(child, frame, pen, style)
            continue
        _draw(child, inner, pen, style)


def _classes(element: ElementTree.Element) -> set[str]:
    return {word.removeprefix("key-") for word in (element.get("class") or "").split()}


def _role(classes: set[str], style: Style, otherwise: str) -> str:
    return next((style.colours[role] for role in ROLES if role in classes), style.colours[otherwise])


def _rectangle(element: ElementTree.Element, frame: _Frame, pen: ImageDraw.ImageDraw, style: Style) -> None:
    x, y, w, h = (float(element.get(name, "0")) for name in ("x", "y", "width", "height"))
    fill = style.colours["area"] if "area" in _classes(element) else element.get("fill", "white")
    (left, top), (right, bottom) = sorted([frame.at(x, y), frame.at(x + w, y + h)])
    pen.rectangle((left, min(top, bottom), right, max(top, bottom)), fill=fill)


def _path(element: ElementTree.Element, frame: _Frame, pen: ImageDraw.ImageDraw, style: Style) -> None:
    classes = _classes(element)
    stretches, closed = _stretches(element.get("d", ""))
    own = dict(item.split(":", 1) for item in (element.get("style") or "").split(";") if ":" in item)
    if "dots" in classes:
        radius = 0.5 * float(own.get("stroke-width", "3")) * frame.scale
        for stretch in stretches:
            x, y = frame.at(*stretch[0])
            pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=_role(classes, style, "ink"))
        return
    stroke, width = _role(classes, style, "soft"), style.line
    if "grid" in classes:
        stroke, width = style.colours["grid"], 0.8
    elif "axis" in classes or "guide" in classes or "leader" in classes:
        stroke, width = style.colours["soft"], 0.9
    elif "thin" in classes:
        width = 1.0
    for stretch in stretches:
        points = [frame.at(*point) for point in stretch]
        if closed and "mark" in classes and "open" not in classes:
            pen.polygon(points, fill=_role(classes, style, "ink"))
        elif len(points) > 1:
            pen.line(points, fill=stroke, width=max(1, round(width * frame.scale)), joint="curve")


def _stretches(path: str) -> tuple[list[list[tuple[float, float]]], bool]:
    """Points of every stretch of a path of straight pieces, and whether one is closed; arcs are passed over."""
    tokens = _TOKEN.findall(path)
    found: list[list[tuple[float, float]]] = []
    x = y = 0.0
    closed, command, k = False, "M", 0
    while k < len(tokens):
        if tokens[k].isalpha():
            command = tokens[k]
            k += 1
        count = _COUNTS.get(command.lower(), 0)
        numbers = [float(token) for token in tokens[k : k + count]]
        k += count
        if command in "zZ":
            closed = True
            continue
        base = (x, y) if command.islower() else (0.0, 0.0)
        if command.lower() == "h":
            x = base[0] + numbers[0]
        elif command.lower() == "v":
            y = base[1] + numbers[0]
        else:
            x, y = base[0] + numbers[-2], base[1] + numbers[-1]
        if command in "mM":
            found.append([(x, y)])
            command = "l" if command == "m" else "L"
        elif found:
            found[-1].append((x, y))
    return found, closed


def _text(element: ElementTree.Element, frame: _Frame, pen: ImageDraw.ImageDraw, style: Style) -> None:
    classes = _classes(element)
    size = style.note if "note" in classes else style.letters
    font = ImageFont.load_default(size * frame.scale)
    words = "".join(element.itertext()).translate(_PLAIN)
    colour = style.colours["soft"] if classes & {"tick", "legend"} else _role(classes, style, "ink")
    anchor = {"middle": "ms", "end": "rs"}.get(element.get("text-anchor", ""), "ls")
    x, y = frame.at(float(element.get("x", "0")), float(element.get("y", "0")))
    if not frame.turned:
        pen.text((x, y), words, fill=colour, font=font, anchor=anchor)
        return
    # Pillow writes along x only: the words are written apart, turned and pasted.
    left, top, right, bottom = font.getbbox(words, anchor="ls")
    label = Image.new("L", (int(right - left) + 2, int(bottom - top) + 2), 0)
    ImageDraw.Draw(label).text((-left, -top), words, fill=255, font=font, anchor="ls")
    label = label.rotate(90, expand=True)
    pen.bitmap((round(x + top), round(y - 0.5 * label.height)), label, fill=colour)
