"""Offsets and profile of the Duisburg Test Case, and the cross-sections of its patches read from them."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from hpsop_core.geometry.hull.fit import Section, tidy_section
from hpsop_core.typing_aliases import Array

WATERLINE, DECK = 14.5, 34.0
TRANSOM_X, COUNTER_X, BOSS_X, APERTURE_X, STEM_X, NOSE_X = -6.743, -0.829, 9.2, 15.25, 355.12, 366.07
SHAFT_HEIGHT, BOSS_RADIUS = 5.0, 0.40
CROWN_FROM, CROWN_ROOM = 14.2, 0.2


@dataclass
class DtcData:
    """The offsets table and the profile lines of the reference hull, metres."""

    x: Array
    z: Array
    half_breadth: Array
    profile: dict[str, Array]
    lines: dict[str, PchipInterpolator] = field(default_factory=dict)

    @staticmethod
    def read(offsets: Path, profile: Path) -> DtcData:
        """Reads both files.

        Raises:
            OSError, ValueError: a file is missing or not a table.
        """
        rows = np.loadtxt(
            [line for line in offsets.read_text().splitlines() if line[:1].isdigit() or line[:1] == "-"], delimiter=","
        )
        x, z = np.unique(rows[:, 0]), np.unique(rows[:, 1])
        table = np.zeros((len(x), len(z)))
        table[np.searchsorted(x, rows[:, 0]), np.searchsorted(z, rows[:, 1])] = rows[:, 2]
        parts: dict[str, list[tuple[float, float]]] = {}
        with profile.open(newline="", encoding="utf-8") as handle:
            for row in csv.DictReader(line for line in handle if not line.startswith("#")):
                parts.setdefault(row["part"], []).append((float(row["x_m"]), float(row["z_m"])))
        # The lowest row stands for the flat of bottom.
        z[0] = 0.0
        return DtcData(x, z, table, {name: np.array(sorted(points)) for name, points in parts.items()})._with_lines()

    def _with_lines(self) -> DtcData:
        p = self.profile
        joined = {
            "run": p["run"],
            "boss_top": np.vstack([[9.2, 5.4], p["boss_top"]]),
            "boss_bottom": np.vstack([[9.2, 4.6], p["boss_bottom"]]),
            "keel": np.vstack([p["boss_bottom"][-1:], p["keel"], p["bulb_bottom"], [[NOSE_X, 10.85]]]),
            "crown": np.vstack([[[STEM_X, WATERLINE]], p["bulb_top"][p["bulb_top"][:, 0] > STEM_X], [[NOSE_X, 10.85]]]),
            "stem": np.vstack([[[STEM_X, 16.75]], p["stem"][p["stem"][:, 0] > STEM_X], [[NOSE_X, DECK]]]),
        }
        for name, points in joined.items():
            _, first = np.unique(points[:, 0], return_index=True)
            self.lines[name] = PchipInterpolator(points[first, 0], points[first, 1])
        return self

    def column(self, x: float) -> Array:
        """Half-breadths over z at station x, linear between the two neighbouring stations of the table."""
        k = int(np.clip(np.searchsorted(self.x, x) - 1, 0, len(self.x) - 2))
        t = (x - self.x[k]) / (self.x[k + 1] - self.x[k])
        return np.asarray((1.0 - t) * self.half_breadth[k] + t * self.half_breadth[k + 1])

    def stations(self, low: float, high: float) -> list[float]:
        """Stations of the table inside an interval."""
        return [float(value) for value in self.x if low + 0.02 < value < high - 0.02]

    def at_height(self, x: float, height: float) -> float:
        """Half-breadth at one height of a station of the table."""
        column = self.column(x)
        near = slice(int(np.searchsorted(self.z, height)) - 3, int(np.searchsorted(self.z, height)) + 3)
        return float(PchipInterpolator(self.z[near], column[near])(height))


def _section(data: DtcData, x: float, column: Array, low: tuple[float, float], high: tuple[float, float]) -> Section:
    """The section from point ``low`` to point ``high``, each (y, z), with the table's points between."""
    inside = (data.z > low[1] + 1e-6) & (data.z < high[1] - 1e-6) & (column > 0.0)
    if low[1] <= 0.0:  # flat of bottom: the row z = 0 is part of the section
        inside |= (data.z == 0.0) & (column > 0.0)
    middle = np.column_stack([column[inside], data.z[inside]])
    return tidy_section(x, np.vstack([low, middle, high]))


def lowered_crown(x: float, z: Array) -> Array:
    """Heights of the bulb with the crown lowered below the design waterline, blended in over x 355.3 to 356.3 m."""
    blend = float(np.clip((x - 355.3) / 1.0, 0.0, 1.0))
    above = np.maximum(z - CROWN_FROM, 0.0)
    return np.asarray(z - blend * (above - CROWN_ROOM * np.tanh(above / CROWN_ROOM)))


def counter_sections(data: DtcData) -> list[Section]:
    """Counter between the run and the design waterline."""
    result = []
    for x in data.stations(COUNTER_X, APERTURE_X):
        run = float(data.lines["run"](x))
        column = np.where(data.z > run + 0.01, data.column(x), 0.0)
        result.append(_section(data, x, column, (0.0, run), (data.at_height(x, WATERLINE), WATERLINE)))
    return result


def skeg_sections(data: DtcData) -> list[Section]:
    """Skeg and boss below the aperture; the open end is a circle about the shaft."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)
    circle = np.column_stack([BOSS_RADIUS * np.cos(angle), SHAFT_HEIGHT + BOSS_RADIUS * np.sin(angle)])
    circle[[0, -1], 0] = 0.0
    result = [Section(BOSS_X, circle)]
    for x in data.stations(BOSS_X, APERTURE_X):
        sole, top = float(data.lines["boss_bottom"](x)), float(data.lines["boss_top"](x))
        result.append(_section(data, x, data.column(x), (0.0, sole), (0.0, top)))
    return result


def aperture_section(data: DtcData) -> tuple[Section, float, float]:
    """The section at the forward end of the aperture with the chord fractions at which its post begins and ends."""
    sole, top, run = (float(data.lines[name](APERTURE_X)) for name in ("boss_bottom", "boss_top", "run"))
    column = data.column(APERTURE_X)
    column[(data.z > top) & (data.z < run)] = 0.0
    low = _section(data, APERTURE_X, column, (0.0, sole), (0.0, top))
    end = (data.at_height(APERTURE_X, WATERLINE), WATERLINE)
    high = _section(data, APERTURE_X, column * (data.z > run), (0.0, run), end)
    post = np.column_stack([np.zeros(9), np.linspace(top, run, 11)[1:-1]])
    whole = Section(APERTURE_X, np.vstack([low.points, post, high.points]))
    fractions = whole.chord_fractions()
    first = len(low.points) - 1
    return whole, float(fractions[first]), float(fractions[first + 10])


def main_sections(data: DtcData) -> list[Section]:
    """Main hull from keel to design waterline."""
    result = []
    for x in data.stations(APERTURE_X, STEM_X):
        keel = max(float(data.lines["keel"](x)), 0.0)
        half_breadth = data.at_height(x, WATERLINE)
        result.append(_section(data, x, data.column(x), (0.0, keel), (half_breadth, WATERLINE)))
    end = STEM_X
    column = data.column(end)
    column[data.z > 14.45] = 0.0
    result.append(_section(data, end, column, (0.0, float(data.lines["keel"](end))), (0.0, WATERLINE)))
    return result


def bulb_sections(data: DtcData) -> list[Section]:
    """Bulb from its bottom to its lowered crown."""
    result = []
    for x in data.stations(STEM_X, NOSE_X):
        bottom, crown = float(data.lines["keel"](x)), float(data.lines["crown"](x))
        section = _section(data, x, data.column(x), (0.0, bottom), (0.0, crown))
        section.points[:, 1] = lowered_crown(x, section.points[:, 1])
        result.append(section)
    return result


def topsides_sections(data: DtcData, start: float, end: float) -> list[Section]:
    """Above the design waterline, the dry run or the stem, up to the deck."""
    result = []
    for x in [start, *data.stations(start, end)]:
        column = data.column(max(x, float(data.x[0])))
        top = (float(column[-1]), DECK)
        if x < COUNTER_X + 0.01:
            run = float(data.lines["run"](max(x, -6.74)))
            low = (0.0, max(run, WATERLINE))
            column = np.where(data.z > low[1] + 0.01, column, 0.0)
        elif x > STEM_X - 0.01:
            low = (0.0, float(data.lines["stem"](x)))
        else:
            low = (data.at_height(x, WATERLINE), WATERLINE)
        result.append(_section(data, x, column, low, top))
    return result
