"""Fits the shipped NURBS patches of the Duisburg Test Case from its offsets and its profile.

    python -m tools.fit_dtc --offsets OFFSETS.csv \\
        --profile PROFILE.csv --to assets/hulls/dtc.json

Division (all borders are shared control points, so that neighbours meet exactly):

    counter   x -0.8 .. 15.25 m   run .. design waterline, above the propeller aperture
    skeg      x  9.2 .. 15.25 m   sole .. aperture, with the stern boss; its open end at x = 9.2 m is a flat disc
    main      x 15.25 .. 355.1 m  keel .. design waterline
    bulb      x 355.1 .. 366.07 m bottom .. crown
    topsides_stern, topsides_aft, topsides_mid, topsides_bow: above them up to the deck at z = 34 m

The bulb's crown touches the design waterline (z = 14.527 m at x = 360 m). It is lowered smoothly to 14.385 m, so that
the bulb is a closed body below the surface; nothing below z = 14.2 m changes.
"""

from __future__ import annotations

import argparse
import csv
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from hpsop_core.geometry.hull.fit import (
    PatchFit,
    Section,
    StationMap,
    edge_segment,
    fit_patch,
    free_net,
    knots_at,
    tidy_section,
)
from hpsop_core.geometry.nurbs import NurbsSurface
from hpsop_core.typing_aliases import Array

WATERLINE, DECK = 14.5, 34.0
TRANSOM_X, COUNTER_X, BOSS_X, APERTURE_X, STEM_X, NOSE_X = -6.743, -0.829, 9.2, 15.25, 355.12, 366.07
SHAFT_HEIGHT, BOSS_RADIUS = 5.0, 0.40
CROWN_FROM, CROWN_ROOM = 14.2, 0.2

# Knots of x(u). No span is shorter than the spacing of the data: shorter ones would be free to wave between stations.
MAIN_STATIONS = [
    15.25, 15.9, 16.8, 17.9, 19.2, 20.8, 22.6, 24.6, 27.0, 29.8, 33.0, 36.5, 40.4, 44.8, 50.0, 56.0, 63.0,
    71.0, 80.0, 90.0, 101.0, 113.0, 126.0, 139.0, 152.0, 165.0, 178.0, 191.0, 204.0, 217.0, 230.0, 242.5, 254.5,
    266.0, 276.5, 286.0, 294.5, 302.0, 311.5, 319.5, 326.5, 332.5, 337.5, 341.7, 345.2, 348.2, 350.6, 352.5, 353.9,
    354.75, 355.12,
]  # fmt: skip
COUNTER_STATIONS = [COUNTER_X, 0.4, 1.9, 3.6, 5.4, 7.2, 9.0, 10.6, 12.0, 13.2, 14.2, 14.9, 15.25]
SKEG_STATIONS = [9.2, 9.5, 9.95, 10.5, 11.15, 11.9, 12.7, 13.5, 14.25, 14.85, 15.25]
BULB_STATIONS = [355.12, 355.55, 356.2, 357.1, 358.3, 359.7, 361.1, 362.4, 363.6, 364.6, 365.35, 365.85, 366.07]
STERN_STATIONS = [TRANSOM_X, -5.3, -3.8, -2.3, COUNTER_X]
BOW_STATIONS = [355.12, 355.65, 356.5, 357.7, 359.2, 360.7, 362.2, 363.6, 364.7, 365.55, 366.07]

MAIN_GIRTH = [0.05, 0.1, 0.15, 0.2, 0.3, 0.37, 0.43, 0.48, 0.53, 0.58, 0.63, 0.67, 0.71, 0.75, 0.79, 0.83, 0.87, 0.91,
              0.95]  # fmt: skip
TOPSIDES_GIRTH = [0.06, 0.12, 0.18, 0.25, 0.33, 0.41, 0.5, 0.6, 0.7, 0.8, 0.9]


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


def fit_underwater(data: DtcData) -> tuple[dict[str, PatchFit], dict[str, list[Any]]]:
    """The four patches below the design waterline, and which stretch of the main patch's v each one's v is."""
    fits: dict[str, PatchFit] = {}
    aperture, post_start, post_end = aperture_section(data)
    stations = StationMap.through(MAIN_STATIONS, False, False)
    girth = sorted(
        [k for k in MAIN_GIRTH if abs(k - post_start) > 0.02 and not post_start <= k <= post_end + 0.02]
        + [post_start - 0.015, post_start, post_end, post_end + 0.02]
    )
    knots = knots_at(girth)
    fixed_y, fixed_z = free_net(stations, knots)
    fixed_y[:, 0] = 0.0
    fixed_z[:, -1] = WATERLINE
    fixed_y[-1, -1] = 0.0
    # All basis functions that live on the post are zero in y: the edge lies in the centreplane there, exactly.
    first = int(np.searchsorted(knots, post_start, side="right")) - 1
    fixed_y[0, first - 3 : first + 1] = 0.0
    fits["main"] = fit_patch([aperture, *main_sections(data)], stations, knots, fixed_y, fixed_z)
    net = fits["main"].surface.control_points

    stations = StationMap.through(COUNTER_STATIONS, False, False)
    knots_c, edge = edge_segment(knots, net[0], post_end, 1.0, np.array([]))
    fixed_y, fixed_z = free_net(stations, knots_c)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, WATERLINE
    fixed_y[0], fixed_z[0] = 0.0, WATERLINE
    fixed_y[-1], fixed_z[-1] = edge[:, 1], edge[:, 2]
    fits["counter"] = fit_patch(counter_sections(data), stations, knots_c, fixed_y, fixed_z, edge=edge)

    stations = StationMap.through(SKEG_STATIONS, True, False)
    knots_s, edge = edge_segment(knots, net[0], 0.0, post_start, np.linspace(0.1, 0.9, 9))
    fixed_y, fixed_z = free_net(stations, knots_s)
    fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
    fixed_y[-1], fixed_z[-1] = edge[:, 1], edge[:, 2]
    fits["skeg"] = fit_patch(skeg_sections(data), stations, knots_s, fixed_y, fixed_z, edge=edge)

    stations = StationMap.through(BULB_STATIONS, False, True)
    fixed_y, fixed_z = free_net(stations, knots)
    fixed_y[:, 0], fixed_y[:, -1] = 0.0, 0.0
    fixed_y[0], fixed_z[0] = net[-1, :, 1], net[-1, :, 2]
    fixed_y[-1], fixed_z[-1] = 0.0, float(data.lines["keel"](NOSE_X))
    fits["bulb"] = fit_patch(bulb_sections(data), stations, knots, fixed_y, fixed_z, edge=net[-1])
    girth_of = {
        "main": ["main", 0.0, 1.0],
        "counter": ["main", post_end, 1.0],
        "skeg": ["main", 0.0, post_start],
        "bulb": ["main", 0.0, 1.0],
    }
    return fits, girth_of


def fit_topsides(data: DtcData, under: dict[str, PatchFit]) -> tuple[dict[str, PatchFit], dict[str, list[Any]]]:
    """The four patches between the design waterline and the deck, and whose v each one's v is."""
    fits: dict[str, PatchFit] = {}
    stem = (float(data.lines["stem"](STEM_X)) - WATERLINE) / np.hypot(DECK - WATERLINE, float(data.column(STEM_X)[-1]))
    # The section opens at once where the stem leaves the centreplane: knots close above it let it.
    near = [float(stem) + step for step in (0.0, 0.02, 0.045, 0.08)]
    girth = sorted([k for k in TOPSIDES_GIRTH if not stem - 0.025 < k < stem + 0.1] + near)
    knots = knots_at(girth)
    main, counter = under["main"].surface, under["counter"].surface

    stations = StationMap(main.knots_u, main.control_points[:, 0, 0])
    fixed_y, fixed_z = free_net(stations, knots)
    fixed_y[:, 0], fixed_z[:, 0] = main.control_points[:, -1, 1], WATERLINE
    fixed_z[:, -1] = DECK
    fixed_y[-1, : int(np.searchsorted(knots, stem, side="right"))] = 0.0
    # Its foremost section runs up the stem before it opens.
    bow = topsides_sections(data, STEM_X, NOSE_X)[0]
    post = np.column_stack([np.zeros(4), np.linspace(WATERLINE, bow.points[0, 1], 5)[:-1]])
    sections = [*topsides_sections(data, APERTURE_X, STEM_X), Section(STEM_X, np.vstack([post, bow.points]))]
    fits["topsides_mid"] = fit_patch(sections, stations, knots, fixed_y, fixed_z)
    mid = fits["topsides_mid"].surface.control_points

    stations = StationMap(counter.knots_u, counter.control_points[:, 0, 0])
    fixed_y, fixed_z = free_net(stations, knots)
    fixed_y[:, 0], fixed_z[:, 0] = counter.control_points[:, -1, 1], WATERLINE
    fixed_z[:, -1] = DECK
    fixed_y[-1], fixed_z[-1] = mid[0, :, 1], mid[0, :, 2]
    sections = topsides_sections(data, COUNTER_X, APERTURE_X)
    fits["topsides_aft"] = fit_patch(sections, stations, knots, fixed_y, fixed_z, edge=mid[0])
    aft = fits["topsides_aft"].surface.control_points

    stations = StationMap.through(STERN_STATIONS, False, False)
    fixed_y, fixed_z = free_net(stations, knots)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, DECK
    fixed_y[-1], fixed_z[-1] = aft[0, :, 1], aft[0, :, 2]
    sections = topsides_sections(data, TRANSOM_X, COUNTER_X)
    fits["topsides_stern"] = fit_patch(sections, stations, knots, fixed_y, fixed_z, edge=aft[0])

    stations = StationMap.through(BOW_STATIONS, False, True)
    knots_b, edge = edge_segment(knots, mid[-1], float(stem), 1.0, np.array([]))
    fixed_y, fixed_z = free_net(stations, knots_b)
    fixed_y[:, 0], fixed_z[:, -1] = 0.0, DECK
    fixed_y[0], fixed_z[0] = edge[:, 1], edge[:, 2]
    fixed_y[-1], fixed_z[-1] = 0.0, DECK
    sections = topsides_sections(data, STEM_X, NOSE_X)[1:]
    fits["topsides_bow"] = fit_patch(sections, stations, knots_b, fixed_y, fixed_z, edge=edge)
    girth_of: dict[str, list[Any]] = {name: ["topsides_mid", 0.0, 1.0] for name in fits}
    girth_of["topsides_bow"] = ["topsides_mid", float(stem), 1.0]
    return fits, girth_of


def fitted_hull(data: DtcData) -> dict[str, Any]:
    """The whole hull as plain data for JSON, with the deviations of every patch."""
    under, girth_under = fit_underwater(data)
    above, girth_above = fit_topsides(data, under)
    patches = []
    for group, fits in (("underwater", under), ("topsides", above)):
        for name, fit in fits.items():
            surface = fit.surface.to_geomdl()  # through geomdl, so that what is stored is what exchange files hold
            patches.append(
                {
                    "name": name,
                    "group": group,
                    "deviation": _rounded_summary(fit),
                    **_rounded(NurbsSurface.from_geomdl(surface).to_dict()),
                }
            )
    return {
        "name": "dtc",
        "description": "Duisburg Test Case, full scale, design draught 14.5 m",
        "source": "El Moctar, Shigunov, Zorn: Duisburg Test Case: Post-Panamax Container Ship for Benchmarking, "
        "Ship Technology Research 59(3), 2012; offsets sampled from the public hull geometry (scale 1:59.407)",
        "notes": "axes: x forward from AP, y to port, z up from the baseline, metres, port side; bulb crown lowered "
        "from 14.527 to 14.385 m so that the bulb is closed below the design waterline; fitted by "
        "tools.fit_dtc",
        "length": 355.0,
        "breadth": 51.0,
        "draft": WATERLINE,
        "deck_height": DECK,
        "shaft_height": SHAFT_HEIGHT,
        "boss_end_x": BOSS_X,
        "shift": {"aft": 18.0, "middle": 168.0, "forward": 348.0},
        # Flat faces: from an end (first or last u) of a patch straight to the centreplane.
        "caps": [["skeg", "first"], ["topsides_stern", "first"]],
        # Which stretch of another patch's v a patch's v is, and whose u it shares: meshes meet along these.
        "girth": girth_under | girth_above,
        "along": {"topsides_mid": "main", "topsides_aft": "counter"},
        "patches": patches,
    }


def _rounded_summary(fit: PatchFit) -> dict[str, float]:
    """Deviations to a thousandth of a millimetre, their places to a millimetre: the same file on every machine."""
    summary = fit.summary()
    return {
        "points": summary["points"],
        "rms_m": round(summary["rms_m"], 6),
        "p99_m": round(summary["p99_m"], 6),
        "max_m": round(summary["max_m"], 6),
        "max_at_x_m": round(summary["max_at_x_m"], 3),
        "max_at_z_m": round(summary["max_at_z_m"], 3),
    }


def _rounded(data: dict[str, Any]) -> dict[str, Any]:
    """Control points to 1e-6 m; knots stay exact, since neighbours share them."""
    data["control_points"] = np.round(np.array(data["control_points"]), 6).tolist()
    return data


def main() -> None:
    """Command line of the fit."""
    parser = argparse.ArgumentParser(description="Fit the shipped DTC hull.")
    parser.add_argument("--offsets", type=Path, required=True)
    parser.add_argument("--profile", type=Path, required=True)
    parser.add_argument("--to", type=Path, required=True)
    arguments = parser.parse_args()
    hull = fitted_hull(DtcData.read(arguments.offsets, arguments.profile))
    arguments.to.write_text(json.dumps(hull, separators=(",", ":")) + "\n", encoding="utf-8")
    for patch in hull["patches"]:
        deviation = patch["deviation"]
        net = f"{len(patch['control_points'])}x{len(patch['control_points'][0])}"
        parser._print_message(
            f"{patch['name']:15s} {net:6s} rms {1e3 * deviation['rms_m']:6.1f} mm, "
            f"p99 {1e3 * deviation['p99_m']:6.1f} mm, max {1e3 * deviation['max_m']:6.1f} mm "
            f"at x {deviation['max_at_x_m']:.2f}, z {deviation['max_at_z_m']:.2f} m\n"
        )


if __name__ == "__main__":
    main()
