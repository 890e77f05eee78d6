"""A hull of one's own from a table of offsets: what was understood, its hydrostatics, its resistance at both levels.

    python examples/own_hull_from_a_table.py [TABLE.csv LPP DRAFT]

Without a table it writes one: Wigley's hull, whose volume is known exactly (4/9 L B d).
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

from hpsop_core import hydrostatics, load_hull, resistance

LENGTH, BREADTH, DRAFT = 100.0, 10.0, 6.25


def wigley(path: Path) -> None:
    """y = B/2 (1 - (2x/L)^2) (1 - (z/d)^2) below the waterline, wall-sided above it."""
    rows = ["station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, LENGTH, 41):
        for z in np.linspace(0.0, 1.2 * DRAFT, 13):
            depth = max(0.0, 1.0 - z / DRAFT)
            half_breadth = 0.5 * BREADTH * (1.0 - (2.0 * x / LENGTH - 1.0) ** 2) * (1.0 - depth**2)
            rows.append(f"{x:.6g},{z:.6g},{half_breadth:.6g}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) == 4:
            path, length, draft = Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
        else:
            path, length, draft = Path(folder) / "wigley.csv", LENGTH, DRAFT
            wigley(path)
        hull = load_hull(path, length, draft)
    print(hull.parent.fit_report)
    own = hydrostatics(hull)
    print(
        f"volume {own.displaced_volume:.1f} m3, wetted surface {own.wetted_surface:.1f} m2, "
        f"CB {own.block_coefficient:.4f}, LCB {own.longitudinal_centre_of_buoyancy:.2f} m from AP, "
        f"BM {own.transverse_metacentric_radius:.2f} m"
    )
    for level in (1, 2):
        answer = resistance(hull, (0.25, 0.30, 0.35), level, form_factor=0.1)
        for warning in answer.warnings:
            print(f"level {level}: {warning}")
        for point in answer.points:
            print(
                f"level {level}, Fn {point.froude_number:.2f}: {point.speed:.2f} m/s, "
                f"10^3 Cw {1e3 * point.wave_coefficient:.3f}, Rt {point.total_resistance / 1e3:.1f} kN"
            )


if __name__ == "__main__":
    main()
