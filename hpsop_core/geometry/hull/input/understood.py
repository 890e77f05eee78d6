"""What was understood of a hull file, for people and for programs."""

from __future__ import annotations

from dataclasses import dataclass

from hpsop_core.geometry.hull.hull import FitReport, ParentHull
from hpsop_core.geometry.hull.input.ship_table import ShipTable, bow_of
from hpsop_core.geometry.hull.input.surface_checks import worst_patch


@dataclass(frozen=True)
class UnderstoodHull:
    """What a reader made of a file: nothing is assumed in silence.

    Attributes:
        name, layout, unit, axes: of the file, in words.
        stations, waterlines: size of the table (of a mesh: of its slices).
        length, breadth, draft: m; ``waterline_length`` of the still water's waterline, m.
        displaced_volume, wetted_surface: m3, m2.
        block_coefficient, midship_coefficient, prismatic_coefficient, waterplane_coefficient: CB, CM, CP, CW.
        buoyancy_centre: LCB from AP, m; ``buoyancy_centre_percent`` from midship in % of the length, positive forward.
        shaft_height, boss_end_x: where the propeller will stand, m.
        looks: the end at which the form's bow seems to be in ship axes, "+x", "-x"; None where the form does not tell.
        assumed: what was assumed or read from the file, one line each.
        warnings: what to look at, one line each.
        fit: deviation of the surface from the points, patch by patch.
    """

    name: str
    layout: str
    unit: str
    axes: str
    stations: int
    waterlines: int
    length: float
    breadth: float
    draft: float
    waterline_length: float
    displaced_volume: float
    wetted_surface: float
    block_coefficient: float
    midship_coefficient: float
    prismatic_coefficient: float
    waterplane_coefficient: float
    buoyancy_centre: float
    buoyancy_centre_percent: float
    shaft_height: float
    boss_end_x: float
    looks: str | None
    assumed: tuple[str, ...]
    warnings: tuple[str, ...]
    fit: FitReport | None

    def __str__(self) -> str:
        side = "forward" if self.buoyancy_centre_percent >= 0.0 else "aft"
        lines = [
            f"{self.name}: {self.layout}, lengths in {self.unit}; {self.axes}",
            f"  Lpp {self.length:.6g} m, breadth {self.breadth:.6g} m, draft {self.draft:.6g} m, waterline "
            f"{self.waterline_length:.6g} m long; L/B {self.length / self.breadth:.3f}, B/T "
            f"{self.breadth / self.draft:.3f}",
            f"  volume {self.displaced_volume:,.6g} m3, wetted surface {self.wetted_surface:,.6g} m2, CB "
            f"{self.block_coefficient:.4f}, CM {self.midship_coefficient:.4f}, CP {self.prismatic_coefficient:.4f}, "
            f"CW {self.waterplane_coefficient:.4f}",
            f"  LCB {self.buoyancy_centre:.5g} m from AP: {abs(self.buoyancy_centre_percent):.2f} % of L {side} of "
            "midship; "
            + (
                "the form itself does not tell bow from stern"
                if self.looks is None
                else "the form, too, has its bow forward"
                if self.looks == "+x"
                else "but the form looks as if its bow were aft"
            ),
            f"  shaft {self.shaft_height:.4g} m above the baseline, hub from x = {self.boss_end_x:.4g} m",
        ]
        lines += [f"  {line}" for line in self.assumed if not line.startswith("warning: ")]
        if self.fit is not None:
            worst = max(self.fit.patches, key=lambda patch: patch.max_m)
            lines += str(self.fit).splitlines()
            lines.append(
                f"  largest deviation {1e3 * worst.max_m:.3g} mm on '{worst.patch}' at x {worst.max_at_x_m:.4g} m, "
                f"z {worst.max_at_z_m:.4g} m ({100.0 * worst.max_m / self.breadth:.2f} % of the breadth)"
            )
        lines += [f"warning: {line}" for line in self.warnings]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, object]:
        """The same as one JSON document."""
        fit = self.fit
        worst = None if fit is None else max(fit.patches, key=lambda patch: patch.max_m)
        names = (
            "name", "layout", "unit", "axes", "stations", "waterlines", "length", "breadth", "draft",
            "waterline_length", "displaced_volume", "wetted_surface", "block_coefficient", "midship_coefficient",
            "prismatic_coefficient", "waterplane_coefficient", "buoyancy_centre", "buoyancy_centre_percent",
            "shaft_height", "boss_end_x", "looks",
        )  # fmt: skip
        document: dict[str, object] = {name: getattr(self, name) for name in names}
        document["length_to_breadth"] = self.length / self.breadth
        document["breadth_to_draft"] = self.breadth / self.draft
        document["assumed"] = [line for line in self.assumed if not line.startswith("warning: ")]
        document["warnings"] = list(self.warnings)
        document["fit"] = None if fit is None or worst is None else {
            "table_volume": fit.table_volume,
            "fitted_volume": fit.fitted_volume,
            "largest_deviation": worst.max_m,
            "largest_deviation_patch": worst.patch,
            "largest_deviation_x": worst.max_at_x_m,
            "largest_deviation_z": worst.max_at_z_m,
            "patches": [
                {"patch": p.patch, "points": p.points, "rms": p.rms_m, "p99": p.p99_m, "max": p.max_m,
                 "max_at_x": p.max_at_x_m, "max_at_z": p.max_at_z_m}
                for p in fit.patches
            ],
        }  # fmt: skip
        return document


def understood(table: ShipTable, parent: ParentHull, unusual: tuple[str, ...] = ()) -> UnderstoodHull:
    """What was understood, from the table as it was read and the hull that was fitted to it."""
    measured = parent.hydrostatics
    hull = parent.transform(parent.length, parent.breadth, parent.draft)
    waterline = hull.waterline(201)
    own = [line.removeprefix("warning: ") for line in (*table.notes, *unusual) if line.startswith("warning: ")]
    return UnderstoodHull(
        name=table.name,
        layout=table.layout,
        unit=table.unit,
        axes=table.axes,
        stations=len(table.x),
        waterlines=len(table.z),
        length=parent.length,
        breadth=parent.breadth,
        draft=parent.draft,
        waterline_length=float(waterline[-1, 0] - waterline[0, 0]),
        displaced_volume=measured.displaced_volume,
        wetted_surface=measured.wetted_surface,
        block_coefficient=measured.block_coefficient,
        midship_coefficient=measured.midship_coefficient,
        prismatic_coefficient=measured.prismatic_coefficient,
        waterplane_coefficient=measured.waterplane_coefficient,
        buoyancy_centre=measured.longitudinal_centre_of_buoyancy,
        buoyancy_centre_percent=100.0 * (measured.longitudinal_centre_of_buoyancy / parent.length - 0.5),
        shaft_height=parent.shaft_height,
        boss_end_x=parent.boss_end_x,
        looks=bow_of(table.x, table.z, table.y, table.draft),
        assumed=tuple(line for line in (*table.notes, *unusual) if not line.startswith("warning: ")),
        warnings=(*own, *parent.warnings),
        fit=parent.fit_report,
    )


__all__ = ["UnderstoodHull", "understood", "worst_patch"]
