"""Public ships as tables of every kind, read and measured: which come in, and how far their volumes are off.

``python -m tools.hull_campaign`` prints a line a variant. Series 60 is Todd's own table (DTMB report 1712), KVLCC2 was
read from a public mesh of the SIMMAN 2008 geometry, Gunnerus is the table of a research vessel in vesseljs, the blunt
Wigley hull is a formula (Journée, Delft, 1992), the DTC is the shipped hull read at stations and waterlines as tables
have them. Volumes are compared with the published one at the published draft, else with a smooth integral of the full
table; of Gunnerus, whose waterlines stand 0.5 m apart under a flat run, that is itself no better than 1 to 2 %.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from hpsop_core.errors import InputError
from hpsop_core.export.offsets import half_breadths
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.input import Axes, HullFile, ReadOptions, read_hull, read_table
from hpsop_core.typing_aliases import Array

DATA = Path(__file__).resolve().parents[1] / "tests" / "data" / "hulls"
LARGEST_ERROR = 0.005


@dataclass(frozen=True, eq=False)
class Variant:
    """One table of one ship.

    Attributes:
        name: of ship and variant.
        text: of the file.
        options: with which it is read.
        volume: the right displaced volume, m3.
    """

    name: str
    text: str
    options: ReadOptions
    volume: float

    def read(self, folder: Path) -> HullFile:
        """The hull.

        Raises:
            InputError: it is refused.
        """
        path = folder / f"{self.name.replace(' ', '-').replace(',', '')}.csv"
        path.write_text(self.text, encoding="utf-8")
        return read_hull(path, self.options)


@dataclass(frozen=True, eq=False)
class Ship:
    """A full table in ship axes, m."""

    name: str
    length: float
    draft: float
    x: Array
    z: Array
    y: Array
    published: float | None

    def volume(self, draft: float) -> float:
        """The published volume at the published draft, else a smooth integral."""
        if self.published is not None and draft == self.draft:
            return self.published
        fine_z = np.linspace(self.z[0], draft, 801)
        areas = [float(np.trapezoid(np.maximum(PchipInterpolator(self.z, row)(fine_z), 0.0), fine_z)) for row in self.y]
        fine_x = np.linspace(self.x[0], self.x[-1], 4001)
        return float(2.0 * np.trapezoid(PchipInterpolator(self.x, areas)(fine_x), fine_x))

    def table(self, stations: slice = slice(None), levels: slice = slice(None)) -> str:
        """The long form of some of its stations and waterlines."""
        lines = ["station_x_m,waterline_z_m,half_breadth_m"]
        for x, row in zip(self.x[stations], self.y[stations], strict=True):
            lines += [f"{x:.6g},{z:.6g},{y:.6g}" for z, y in zip(self.z[levels], row[levels], strict=True)]
        return "\n".join(lines) + "\n"


def duisburg_test_case() -> Ship:
    """The shipped hull on 59 stations and 33 waterlines; published at 14.5 m: 173,467 m3, its surface 173,392 m3."""
    parent = load_parent_hull()
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    x = np.concatenate(
        [[-6.7, -4.0, -2.0], np.arange(0.0, 17.0, 2.0), np.arange(18.0, 60.0, 6.0), np.arange(66.0, 300.0, 18.0),
         np.arange(300.0, 348.0, 8.0), np.arange(348.0, 354.0, 2.0), np.arange(354.0, 366.1, 0.75)]
    )  # fmt: skip
    z = np.concatenate([[0.0, 0.15, 0.4, 0.75, 1.2], np.arange(2.0, 14.4, 0.75), [14.5], np.arange(15.5, 30.0, 2.0)])
    return Ship("DTC", parent.length, parent.draft, x, z, half_breadths(hull, x, z), hull.hydrostatics.displaced_volume)


def series_60() -> Ship:
    """Series 60, CB 0.60, at 121.92 m."""
    table = read_table(DATA / "s60_cb060.csv", ReadOptions(length=121.92))
    return Ship("Series 60", table.length, table.draft, table.x, table.z, table.y, None)


def kvlcc2() -> Ship:
    """KVLCC2; published at 20.8 m: 312,622 m3."""
    table = read_table(DATA / "kvlcc2.csv", ReadOptions(length=320.0, draft=20.8))
    return Ship("KVLCC2", 320.0, 20.8, table.x, table.z, table.y, 312622.0)


def gunnerus() -> Ship:
    """R/V Gunnerus: L/B 3.6, a bulb that ends under the still water, a raked run and a wet transom."""
    table = read_table(DATA / "gunnerus.csv", ReadOptions(length=34.9, draft=2.787))
    return Ship("Gunnerus", 34.9, 2.787, table.x, table.z, table.y, None)


def blunt_wigley() -> Ship:
    """Journée's modified Wigley hull, 100 x 10 x 6.25 m, on 41 x 13 readings; sides upright above the draft."""
    s, t = np.linspace(-1.0, 1.0, 41)[:, None], np.concatenate([np.linspace(1.0, 0.0, 13), np.zeros(2)])
    y = 5.0 * ((1 - t**2) * (1 - s**2) * (1 + 0.2 * s**2) + t**2 * (1 - t**8) * (1 - s**2) ** 4)
    z = np.concatenate([np.linspace(0.0, 6.25, 13), [7.5, 9.0]])
    return Ship("blunt Wigley", 100.0, 6.25, 50.0 * (s[:, 0] + 1.0), z, y, _wigley_volume())


def _wigley_volume() -> float:
    s, t = np.linspace(0.0, 1.0, 2001)[:, None], np.linspace(0.0, 1.0, 2001)
    y = (1 - t**2) * (1 - s**2) * (1 + 0.2 * s**2) + t**2 * (1 - t**8) * (1 - s**2) ** 4
    return float(2.0 * 5.0 * 100.0 * 6.25 * np.trapezoid(np.trapezoid(y, t, axis=1), s[:, 0]))


def variants() -> Iterator[Variant]:
    """Five draughts of each ship, tables thinned in stations and waterlines, and tables as others lay them out."""
    every = slice(None)
    thin = {"every second station": (slice(None, None, 2), every), "the others": (slice(1, None, 2), every),
            "every second waterline": (every, slice(None, None, 2))}  # fmt: skip
    for ship in (duisburg_test_case(), series_60(), kvlcc2(), gunnerus(), blunt_wigley()):
        for part in (0.7, 0.8, 0.9, 1.0, 1.1):
            draft = ship.draft * part
            options = ReadOptions(length=ship.length, draft=draft)
            yield Variant(f"{ship.name}, draft {draft:.5g}", ship.table(), options, ship.volume(draft))
        options = ReadOptions(length=ship.length, draft=ship.draft)
        for words, (stations, levels) in thin.items():
            if ship.name == "Series 60" and words != "every second station":
                continue  # Todd gives six waterlines up to the draft, and the other stations have no ends
            yield Variant(f"{ship.name}, {words}", ship.table(stations, levels), options, ship.volume(ship.draft))
    tanker, container, sixty = kvlcc2(), duisburg_test_case(), series_60()
    both = slice(None, None, 2)
    for ship in (tanker, container):
        options = ReadOptions(length=ship.length, draft=ship.draft)
        name = f"{ship.name}, every second station and waterline"
        yield Variant(name, ship.table(both, both), options, ship.volume(ship.draft))
    from_fp = ReadOptions(length=sixty.length, draft=sixty.draft, axes=Axes(origin="fp"))
    for name, text, options, ship in (
        ("Series 60, as published", _file("s60_cb060.csv"), ReadOptions(length=121.92), sixty),
        ("KVLCC2, as a matrix", _file("kvlcc2.csv"), ReadOptions(length=320.0, draft=20.8), tanker),
        ("DTC, boss told once", _file("dtc_boss_tip.csv"), ReadOptions(length=355.0, draft=14.5), container),
        ("Series 60, from FP in mm", _from_fp_in_mm(sixty), from_fp, sixty),
    ):
        yield Variant(name, text, options, ship.volume(ship.draft))


def _file(name: str) -> str:
    return (DATA / name).read_text(encoding="utf-8")


def _from_fp_in_mm(ship: Ship) -> str:
    lines = ["x;z;y [mm]".replace("x;z", "x [mm];z [mm]")]
    for x, row in zip(ship.x[::-1], ship.y[::-1], strict=True):
        lines += [f"{1e3 * (ship.length - x):.1f};{1e3 * z:.1f};{1e3 * y:.1f}".replace(".", ",") for z, y in
                  zip(ship.z, row, strict=True)]  # fmt: skip
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a variant; 0 where all but two are in and within the error."""
    parser = argparse.ArgumentParser(description="Read public ships as tables of every kind and measure them.")
    parser.add_argument("--only", metavar="WORDS", default="", help="variants whose name holds these words")
    chosen = parser.parse_args(arguments).only
    good = count = 0
    with tempfile.TemporaryDirectory() as folder:
        for variant in (one for one in variants() if chosen in one.name):
            count += 1
            start = time.perf_counter()
            try:
                told = variant.read(Path(folder)).understood
            except InputError as refusal:
                print(f"{variant.name:46s} REFUSED: {refusal}", flush=True)
                continue
            error = told.displaced_volume / variant.volume - 1.0
            good += abs(error) <= LARGEST_ERROR
            worst = 0.0 if told.fit is None else max(patch.max_m for patch in told.fit.patches)
            print(
                f"{variant.name:46s} volume {told.displaced_volume:10.6g} m3 {100.0 * error:+6.2f} %  S "
                f"{told.wetted_surface:8.6g} m2  LCB {told.buoyancy_centre_percent:+5.2f} %  worst "
                f"{100.0 * worst / told.breadth:4.2f} % of B  {time.perf_counter() - start:4.1f} s",
                flush=True,
            )
    print(f"{good} of {count} in, volume within {100.0 * LARGEST_ERROR:g} %")
    return 0 if good >= count - 2 else 1


if __name__ == "__main__":
    sys.exit(main())
