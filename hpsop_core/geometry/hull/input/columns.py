"""What the columns of an offsets table are called, and what comments say about the ship."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hpsop_core.geometry.delimited_text import Line

_UNIT_WORDS = {
    "m": "m", "metre": "m", "metres": "m", "meter": "m", "meters": "m", "mm": "mm", "cm": "cm", "ft": "ft",
    "feet": "ft", "foot": "ft", "in": "in", "inch": "in", "inches": "in", "ft-in-8": "ft-in-8",
    "feet-inches-eighths": "ft-in-8", "ft-in-eighths": "ft-in-8",
}  # fmt: skip
_STATIONS = (
    "x", "station_x", "x_station", "stationx", "station_position", "x_position", "xpos", "x_pos", "x_coordinate",
    "longitudinal", "long_position", "x_from_ap", "x_from_fp", "x_from_midship", "distance_from_ap",
    "distance_from_fp", "frame_x", "section_x", "x_section", "x_ap", "x_fp",
)  # fmt: skip
_STATION_NUMBERS = (
    "station", "station_no", "station_nr", "station_number", "stations", "sta", "stn", "st", "ordinate", "section",
    "frame", "spant", "station_index",
)  # fmt: skip
_HEIGHTS = (
    "z", "waterline_z", "z_waterline", "waterlinez", "waterline", "waterline_height", "height", "wl", "wl_z", "z_wl",
    "z_coordinate", "vertical", "draft", "wl_height", "height_above_baseline", "z_above_baseline", "z_pos",
)  # fmt: skip
_HALF_BREADTHS = (
    "y", "half_breadth", "halfbreadth", "half_breadth_y", "y_half_breadth", "half_beam", "halfbeam", "half_width",
    "offset", "offsets", "halfbreite", "y_coordinate", "transverse", "hb", "b_2", "half_b", "semi_breadth",
    "semibreadth",
)  # fmt: skip
_FULL_BREADTHS = ("breadth", "full_breadth", "beam", "full_beam", "width", "b")
_ROLES = (
    ("station", _STATIONS),
    ("number", _STATION_NUMBERS),
    ("height", _HEIGHTS),
    ("half", _HALF_BREADTHS),
    ("full", _FULL_BREADTHS),
)
_VALUE = r"\s*(?:=|:|is)?\s*([0-9]+(?:[.,][0-9]+)?)"
_STATED = {
    "length_to_breadth": re.compile(r"\bL\s*/\s*B" + _VALUE),
    "breadth_to_draft": re.compile(r"\bB\s*/\s*[TdH]\b" + _VALUE),
    "spacing": re.compile(r"\bspacing" + _VALUE + r"(?!\s*L)\s*(mm|cm|m|ft)?\b", re.IGNORECASE),
}
_LENGTHS = {
    "length": re.compile(r"\b(?:Lpp|LBP|Lbp|length)\s*(?:=|:)\s*([0-9]+(?:[.,][0-9]+)?)\s*(mm|cm|m|ft)?\b"),
    "breadth": re.compile(r"(?<!/)\b(?:B|breadth|beam)\s*(?:=|:)\s*([0-9]+(?:[.,][0-9]+)?)\s*(mm|cm|m|ft)?\b"),
    "draft": re.compile(r"(?<!/)\b(?:T|d|draft|draught)\s*(?:=|:)\s*([0-9]+(?:[.,][0-9]+)?)\s*(mm|cm|m|ft)?\b"),
}
_STATION_ZERO = re.compile(r"\b(?:stations?\s*|sta?\s*)?0\s*(?:=|\(|is|at|:)?\s*(?:at\s*)?\(?\b(FP|AP)\b")
_X_FROM = re.compile(
    r"\bx\s*(?:=\s*0\s*|is\s*|counted\s*|measured\s*|forward\s*|aft\s*)*(?:from|at)\s*(FP|AP|midship)", re.I
)
_FACTOR = {"mm": 0.001, "cm": 0.01, "m": 1.0, "ft": 0.3048}


def split_unit(title: str) -> tuple[str, str | None]:
    """A column's name in lower case with underscores, and the unit that it states.

    "half_breadth_m", "Half-breadth [mm]", "Y (ft)" and "x / m" are understood.
    """
    name = title.strip().lower().replace("½", "half").replace("halb", "half")
    unit: str | None = None
    bracket = re.search(r"[\[(]\s*([a-z0-9\- ]+?)\s*[\])]\s*$", name)
    if bracket is not None and bracket.group(1) in _UNIT_WORDS:
        unit = _UNIT_WORDS[bracket.group(1)]
        name = name[: bracket.start()]
    else:
        slash = re.search(r"(?:\s*/\s*|[_\s,]+(?:in\s+)?)([a-z][a-z0-9\-]*)$", name)
        if slash is not None and slash.group(1) in _UNIT_WORDS and name[: slash.start()].strip():
            unit = _UNIT_WORDS[slash.group(1)]
            name = name[: slash.start()]
    return re.sub(r"[^a-z0-9]+", "_", name).strip("_"), unit


def role_of(title: str) -> tuple[str | None, str | None]:
    """What a column holds ("station", "number", "height", "half", "full" or None) and its unit."""
    name, unit = split_unit(title)
    if name == "waterline_no" or name == "waterline_index" or name == "wl_no":
        return None, unit
    for role, names in _ROLES:
        if name in names:
            return role, unit
    return None, unit


def origin_of(title: str) -> str | None:
    """The origin that a station column's name states, such as x_from_fp."""
    name, _ = split_unit(title)
    for word, origin in (("fp", "fp"), ("ap", "ap"), ("midship", "midship")):
        if name.endswith(("_" + word, "from_" + word)):
            return origin
    return None


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def stated_in(comments: Sequence[Line]) -> tuple[dict[str, float | str], tuple[str, ...]]:
    """What comment lines say about the ship: dimensions, proportions, spacing, and where station or x = 0 is.

    Returns:
        The values by name (metres) and a note for each of them.
    """
    found: dict[str, float | str] = {}
    notes = []
    for line in comments:
        text = line.cells[0]
        for name, pattern in {**_LENGTHS, **_STATED}.items():
            match = pattern.search(text)
            if match is not None and name not in found:
                unit = match.group(2) if (match.lastindex or 0) > 1 else None
                found[name] = _number(match.group(1)) * _FACTOR.get(unit or "m", 1.0)
                notes.append(f"{name.replace('_', ' ')} {found[name]:g} read from the comment in row {line.number}")
        for pattern in (_STATION_ZERO, _X_FROM):
            match = pattern.search(text)
            if match is not None and "origin" not in found:
                found["origin"] = match.group(1).lower()
                notes.append(f"x = 0 at {match.group(1).upper()}, read from the comment in row {line.number}")
    return found, tuple(notes)
