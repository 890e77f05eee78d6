"""What was understood of a propeller's file, for people and for programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hpsop_core.geometry.propeller.input.radial_csv import RadialFile, read_radial_table
from hpsop_core.geometry.propeller.radial_table import RadialTable

# What screw propellers of ships have; outside, a unit or the number of blades may be wrong.
_USUAL = {
    "expanded area ratio": (0.3, 1.2),
    "P/D at 0.7 R": (0.4, 1.8),
    "hub ratio": (0.12, 0.35),
    "t/c at 0.7 R": (0.015, 0.12),
}
# Chord at the tip over that at 0.7 R: nothing or little of open propellers, about 1 of Kaplan blades in a nozzle.
BROAD_TIP = 0.6
# Tip against hub, in degrees: blades lean back, and a balanced one ends at about 0 or behind.
FORWARD_SKEW = -5.0
# Blades are skewed by some degrees or not at all; the largest skews, 2 rad, would be 2 degrees.
LEAST_SKEW = 2.1


@dataclass(frozen=True, eq=False)
class UnderstoodPropeller:
    """What a reader made of a radial table: nothing is assumed in silence.

    Attributes:
        table: the blade.
        columns: titles of the columns that were used.
        blade_count: as stated.
        expanded_area_ratio, pitch_ratio_07R, chord_ratio_07R, thickness_ratio_07R, camber_ratio_07R, hub_ratio: pure
            numbers; tip_skew_degrees, tip_rake_ratio at the tip.
        assumed, warnings: one line each.
    """

    table: RadialTable
    columns: tuple[str, ...]
    blade_count: int
    expanded_area_ratio: float
    pitch_ratio_07R: float  # noqa: N815 - 0.7 R is how the field writes it
    chord_ratio_07R: float  # noqa: N815
    thickness_ratio_07R: float  # noqa: N815
    camber_ratio_07R: float  # noqa: N815
    hub_ratio: float
    tip_skew_degrees: float
    tip_rake_ratio: float
    assumed: tuple[str, ...]
    warnings: tuple[str, ...]

    def __str__(self) -> str:
        lines = [
            f"{self.table.name}: radial table of {len(self.table.radius_ratio)} radii, columns "
            f"{', '.join(self.columns)}",
            f"  Z {self.blade_count}, expanded area ratio {self.expanded_area_ratio:.4f}, hub ratio "
            f"{self.hub_ratio:.3f}",
            f"  at 0.7 R: P/D {self.pitch_ratio_07R:.4f}, c/D {self.chord_ratio_07R:.4f}, t/c "
            f"{self.thickness_ratio_07R:.4f}, f/c {self.camber_ratio_07R:.4f}",
            f"  at the tip: skew {self.tip_skew_degrees:.2f} degrees, rake/D {self.tip_rake_ratio:.4f}",
        ]
        return "\n".join([*lines, *(f"  {line}" for line in self.assumed), *(f"warning: {w}" for w in self.warnings)])

    def as_dict(self) -> dict[str, object]:
        """The same as one JSON document."""
        table = self.table
        return {
            "name": table.name,
            "columns": list(self.columns),
            "blade_count": self.blade_count,
            "expanded_area_ratio": self.expanded_area_ratio,
            "pitch_ratio_07R": self.pitch_ratio_07R,
            "chord_ratio_07R": self.chord_ratio_07R,
            "thickness_ratio_07R": self.thickness_ratio_07R,
            "camber_ratio_07R": self.camber_ratio_07R,
            "hub_ratio": self.hub_ratio,
            "tip_skew_degrees": self.tip_skew_degrees,
            "tip_rake_ratio": self.tip_rake_ratio,
            "radius_ratio": table.radius_ratio.tolist(),
            "chord_ratio": table.chord_ratio.tolist(),
            "pitch_ratio": table.pitch_ratio.tolist(),
            "skew_degrees": np.degrees(table.skew).tolist(),
            "rake_ratio": table.rake_ratio.tolist(),
            "thickness_ratio": table.thickness_ratio.tolist(),
            "camber_ratio": table.camber_ratio.tolist(),
            "assumed": list(self.assumed),
            "warnings": list(self.warnings),
        }


def understood(file: RadialFile) -> UnderstoodPropeller:
    """What was understood of a radial table."""
    table = file.table
    at = table.at(np.array([0.7]))
    area = table.expanded_area_ratio_per_blade * table.blade_count
    figures = {
        "expanded area ratio": area,
        "P/D at 0.7 R": float(at.pitch_ratio[0]),
        "hub ratio": table.hub_ratio,
        "t/c at 0.7 R": float(at.thickness_ratio[0]),
    }
    return UnderstoodPropeller(
        table=table,
        columns=file.columns,
        blade_count=table.blade_count,
        expanded_area_ratio=area,
        pitch_ratio_07R=figures["P/D at 0.7 R"],
        chord_ratio_07R=float(at.chord_ratio[0]),
        thickness_ratio_07R=figures["t/c at 0.7 R"],
        camber_ratio_07R=float(at.camber_ratio[0]),
        hub_ratio=table.hub_ratio,
        tip_skew_degrees=float(np.degrees(table.skew[-1])),
        tip_rake_ratio=float(table.rake_ratio[-1]),
        assumed=file.notes,
        warnings=(*_blade_doubts(table, file.columns), *_unusual(figures)),
    )


def _unusual(figures: dict[str, float]) -> tuple[str, ...]:
    """The figures that lie outside what ships' propellers have."""
    return tuple(
        f"{name} {value:.3g} is outside what ships' propellers have ({low:g} to {high:g}): are unit and Z right?"
        for name, value in figures.items()
        for low, high in (_USUAL[name],)
        if not low <= value <= high
    )


def _blade_doubts(table: RadialTable, columns: tuple[str, ...]) -> tuple[str, ...]:
    """What the limits of a single number let pass and no open propeller is likely to have."""
    lines = []
    tip, at = float(table.chord_ratio[-1]), float(table.at(np.array([0.7])).chord_ratio[0])
    if tip > BROAD_TIP * at:
        lines.append(
            f"the chord at the tip is {tip / at:.2f} of that at 0.7 R, as blades in a duct have it: ducts are not "
            "computed, the blade is taken as an open propeller's"
        )
    lead = float(np.degrees(table.skew[-1] - table.skew[0]))
    if lead < FORWARD_SKEW:
        lines.append(
            f"the tip runs {-lead:.3g} degrees ahead of the hub section, into the rotation; if the blade is skewed "
            "back, turn the sign of the column of skew (here positive is aft along the helix)"
        )
    skew = float(np.degrees(np.max(np.abs(table.skew))))
    if 0.0 < skew < LEAST_SKEW and not any("deg" in title.lower() or "rad" in title.lower() for title in columns):
        lines.append(f"the greatest skew is {skew:.3g} degrees; if the column is in radians, call it skew_rad")
    return tuple(lines)


def read_propeller(path: str | Path, blade_count: int) -> UnderstoodPropeller:
    """A propeller from a file, with what was understood.

    Raises:
        InputError: one line that names the file, the line and the remedy.
    """
    return understood(read_radial_table(path, blade_count))
