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
import json
from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.geometry.hull.fit import PatchFit, Section, knots_at
from hpsop_core.geometry.hull.fit_plan import (
    CLOSED_AFT,
    CLOSED_FORWARD,
    FIRST,
    LAST,
    LOWER_EDGE_ON_CENTREPLANE,
    UPPER_EDGE_ON_CENTREPLANE,
    Held,
    PatchPlan,
    Seam,
    Spans,
    columns_on,
    fit_patches,
    girths,
    open_ends,
    upper_edge_at,
)
from hpsop_core.geometry.nurbs import NurbsSurface
from tools.dtc_sections import (
    APERTURE_X,
    BOSS_X,
    COUNTER_X,
    DECK,
    NOSE_X,
    SHAFT_HEIGHT,
    STEM_X,
    TRANSOM_X,
    WATERLINE,
    DtcData,
    aperture_section,
    bulb_sections,
    counter_sections,
    main_sections,
    skeg_sections,
    topsides_sections,
)

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
SKEG_KNOTS = tuple(float(knot) for knot in np.linspace(0.1, 0.9, 9))


def underwater_plans(data: DtcData) -> list[PatchPlan]:
    """The four patches below the design waterline."""
    aperture, post_start, post_end = aperture_section(data)
    girth = sorted(
        [k for k in MAIN_GIRTH if abs(k - post_start) > 0.02 and not post_start <= k <= post_end + 0.02]
        + [post_start - 0.015, post_start, post_end, post_end + 0.02]
    )
    knots = knots_at(girth)
    nose = float(data.lines["keel"](NOSE_X))
    return [
        PatchPlan(
            "main", [aperture, *main_sections(data)], Spans(MAIN_STATIONS), knots,
            (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(WATERLINE), Held("y", 0.0, LAST, LAST),
             Held("y", 0.0, FIRST, columns_on(knots, post_start, post_end))),
        ),
        PatchPlan(
            "counter", counter_sections(data), Spans(COUNTER_STATIONS), None,
            (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(WATERLINE), CLOSED_AFT, Held("z", WATERLINE, FIRST)),
            Seam("main", "first", post_end, 1.0),
        ),
        PatchPlan(
            "skeg", skeg_sections(data), Spans(SKEG_STATIONS, flat_start=True), None,
            (LOWER_EDGE_ON_CENTREPLANE, UPPER_EDGE_ON_CENTREPLANE),
            Seam("main", "first", 0.0, post_start, SKEG_KNOTS), open_ends=("first",),
        ),
        PatchPlan(
            "bulb", bulb_sections(data), Spans(BULB_STATIONS, flat_end=True), None,
            (LOWER_EDGE_ON_CENTREPLANE, UPPER_EDGE_ON_CENTREPLANE, CLOSED_FORWARD, Held("z", nose, LAST)),
            Seam("main", "last"),
        ),
    ]  # fmt: skip


def topsides_plans(data: DtcData) -> list[PatchPlan]:
    """The four patches between the design waterline and the deck."""
    stem = float(
        (float(data.lines["stem"](STEM_X)) - WATERLINE) / np.hypot(DECK - WATERLINE, float(data.column(STEM_X)[-1]))
    )
    # The section opens at once where the stem leaves the centreplane: knots close above it let it.
    near = [stem + step for step in (0.0, 0.02, 0.045, 0.08)]
    knots = knots_at(sorted([k for k in TOPSIDES_GIRTH if not stem - 0.025 < k < stem + 0.1] + near))
    # The foremost section of the sides runs up the stem before it opens; one control point more is held for that.
    bow = topsides_sections(data, STEM_X, NOSE_X)[0]
    post = np.column_stack([np.zeros(4), np.linspace(WATERLINE, bow.points[0, 1], 5)[:-1]])
    on_stem = slice(0, int(np.searchsorted(knots, stem, side="right")))
    sides = [*topsides_sections(data, APERTURE_X, STEM_X), Section(STEM_X, np.vstack([post, bow.points]))]
    from_waterline = (Held("z", WATERLINE, columns=FIRST), upper_edge_at(DECK))
    return [
        PatchPlan(
            "topsides_mid", sides, None, knots, (*from_waterline, Held("y", 0.0, LAST, on_stem)), along="main",
        ),
        PatchPlan(
            "topsides_aft", topsides_sections(data, COUNTER_X, APERTURE_X), None, None, from_waterline,
            Seam("topsides_mid", "first"), along="counter",
        ),
        PatchPlan(
            "topsides_stern", topsides_sections(data, TRANSOM_X, COUNTER_X), Spans(STERN_STATIONS), None,
            (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(DECK)), Seam("topsides_aft", "first"), open_ends=("first",),
        ),
        PatchPlan(
            "topsides_bow", topsides_sections(data, STEM_X, NOSE_X)[1:], Spans(BOW_STATIONS, flat_end=True), None,
            (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(DECK), CLOSED_FORWARD, Held("z", DECK, LAST)),
            Seam("topsides_mid", "last", stem, 1.0),
        ),
    ]  # fmt: skip


def fitted_hull(data: DtcData) -> dict[str, Any]:
    """The whole hull as plain data for JSON, with the deviations of every patch."""
    under, above = underwater_plans(data), topsides_plans(data)
    plans = [*under, *above]
    patches = []
    for name, fit in fit_patches(plans).items():
        surface = fit.surface.to_geomdl()  # through geomdl, so that what is stored is what exchange files hold
        patches.append(
            {
                "name": name,
                "group": "underwater" if name in {plan.name for plan in under} else "topsides",
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
        "caps": [list(cap) for cap in open_ends(plans)],
        # Which stretch of another patch's v a patch's v is, and whose u it shares: meshes meet along these.
        "girth": {name: list(stretch) for name, stretch in girths(plans).items()},
        "along": {plan.name: plan.along for plan in plans if plan.along is not None},
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
