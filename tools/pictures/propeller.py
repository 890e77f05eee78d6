"""The propeller's pictures in docs/pictures.

python -m tools.pictures.propeller --to docs/pictures
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hpsop_core.geometry.clearance import baseline_clearance, propeller_clearance, propeller_placement
from hpsop_core.geometry.hull.hull import load_parent_hull
from hpsop_core.geometry.hull.mesh import hull_view_parts
from hpsop_core.geometry.propeller.mesh import propeller_view_parts
from hpsop_core.geometry.propeller.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.geometry.propeller.sections import cosine_chord_fractions
from hpsop_core.geometry.propeller.surface import section_points
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.propeller_level1 import MODEL_DIAMETER, reference_rows
from tools.pictures.command import write_pictures
from tools.pictures.plotting import pyplot
from tools.pictures.shading import ShadedPart, render

_BRONZE = (0.83, 0.62, 0.28)
_PAINT = (0.62, 0.28, 0.25)
_ABOVE = (0.36, 0.52, 0.70)
_DPI = 110


def _parts(propeller: Propeller, placement: Array | None = None) -> list[ShadedPart]:
    """Blades and hub of a propeller for the renderer, where wanted in ship axes."""
    parts = []
    for vertices, faces in propeller_view_parts(propeller).values():
        placed = vertices if placement is None else vertices @ placement[:3, :3].T + placement[:3, 3]
        parts.append(ShadedPart(placed, faces, _BRONZE))
    return parts


def family_picture(file: Path) -> None:
    """Members of the family, seen from astern and to one side."""
    plt = pyplot()
    parent = load_propeller()
    members = [
        ("parent: Z 3, EAR 0.607", propeller_family(parent, 2.0, 3)),
        ("Z 4, EAR 0.607", propeller_family(parent, 2.0, 4)),
        ("Z 5, EAR 0.607", propeller_family(parent, 2.0, 5)),
        ("Z 7, EAR 0.607", propeller_family(parent, 2.0, 7)),
        ("Z 3, EAR 1.0", propeller_family(parent, 2.0, 3, 1.0, 1.0)),
        ("Z 5, EAR 1.0, pitch x 1.05", propeller_family(parent, 2.0, 5, 1.05, 1.0)),
    ]
    figure, axes = plt.subplots(2, 3, figsize=(11.0, 7.6))
    for (title, propeller), place in zip(members, axes.flat, strict=True):
        place.imshow(render(_parts(propeller), 38.0, 18.0, ((0.0, 0.0, 0.0), 1.12), 340, 340))
        place.set_title(title, fontsize=11)
        place.set_axis_off()
    figure.tight_layout()
    figure.savefig(file, dpi=90)
    plt.close(figure)


def sections_picture(file: Path) -> None:
    """Expanded outline of P4119 with its sections, and what the rows of the table hold."""
    plt = pyplot()
    parent = load_propeller()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 5.2), width_ratios=[1.5, 1.0])
    radii = np.linspace(0.2, 1.0, 400)
    chord = 2.0 * parent.at(radii).chord_ratio
    left.plot(-0.5 * chord, radii, "k", lw=1.0)
    left.plot(0.5 * chord, radii, "k", lw=1.0)
    shown = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95])
    sections = parent.at(shown)
    fractions = cosine_chord_fractions(80)
    for side in (True, False):
        along, across = section_points(sections, fractions, side)
        for k, radius in enumerate(shown):
            left.plot(along[k], radius + across[k], color="#a06010", lw=0.9)
    left.set_aspect("equal")
    left.set_xlabel("from mid-chord towards the trailing edge, in R")
    left.set_ylabel("r/R (sections stand on their radius)")
    left.set_title("P4119: expanded outline and sections", fontsize=11)
    table = parent.at(radii)
    for values, name in (
        (table.chord_ratio, "c/D"),
        (table.pitch_ratio / 2.0, "P/D / 2"),
        (5.0 * table.camber_ratio, "5 f/c"),
        (table.thickness_ratio, "t/c"),
    ):
        right.plot(radii, values, label=name)
    right.plot(parent.radius_ratio, parent.chord_ratio, "k.", ms=4)
    right.set_xlabel("r/R")
    right.legend(frameon=False)
    right.grid(alpha=0.3)
    right.set_title("between the rows (dots: rows of c/D)", fontsize=11)
    figure.tight_layout()
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def open_water_picture(file: Path) -> None:
    """Level 1 beside the experiment and PROPAN, at model scale."""
    plt = pyplot()
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    advance = np.linspace(0.1, 1.15, 85)
    prepared = lifting_line.prepare(model)
    viscous = prepared.solve(advance, SectionDrag.model_scale(10.0, 1e-6))
    inviscid = prepared.solve(advance, SectionDrag.inviscid())
    figure, axes = plt.subplots(figsize=(8.0, 5.6))
    colours = {"KT": "#1f4e9c", "10KQ": "#b03020", "eta": "#207040"}
    efficiency = viscous.open_water_efficiency
    axes.plot(advance, viscous.thrust_coefficient, color=colours["KT"], label="KT, level 1")
    axes.plot(advance, 10.0 * viscous.torque_coefficient, color=colours["10KQ"], label="10 KQ, level 1")
    axes.plot(
        advance, np.where(efficiency > 0.0, efficiency, np.nan), color=colours["eta"], label="efficiency, level 1"
    )
    axes.plot(
        advance, inviscid.thrust_coefficient, ":", color=colours["KT"], lw=1.0, label="KT, 10 KQ without viscosity"
    )
    axes.plot(advance, 10.0 * inviscid.torque_coefficient, ":", color=colours["10KQ"], lw=1.0)
    for name, marker in (("A", "o"), ("B", "s")):
        rows = [row for row in reference_rows("p4119_openwater.csv") if row["set"] == name]
        j, kt, kq = (np.array([float(row[key]) for row in rows]) for key in ("J", "KT", "10KQ"))
        fill = "none" if name == "B" else None
        axes.plot(j, kt, marker, color=colours["KT"], mfc=fill, ls="", label=f"experiment, set {name}")
        axes.plot(j, kq, marker, color=colours["10KQ"], mfc=fill, ls="")
        axes.plot(j, j * kt / (2.0 * np.pi * 0.1 * kq), marker, color=colours["eta"], mfc=fill, ls="")
    rows = list(reference_rows("p4119_propan.csv"))
    j, kt, kq = (np.array([float(row[key]) for row in rows]) for key in ("J", "KT_blade_inv", "10KQ_blade_inv"))
    axes.plot(j, kt, "+", color=colours["KT"], label="PROPAN without viscosity")
    axes.plot(j, kq, "+", color=colours["10KQ"])
    axes.set_xlim(0.1, 1.15)
    axes.set_ylim(0.0, 0.85)
    axes.set_xlabel("advance coefficient J")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, fontsize=9, ncols=2, loc="upper left")
    axes.set_title("P4119 in open water, D = 0.3048 m, n = 10 1/s", fontsize=11)
    figure.tight_layout()
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def loading_picture(file: Path) -> None:
    """Circulation, inflow and the drag's excess along the blade at four advance coefficients."""
    plt = pyplot()
    model = propeller_family(load_propeller(), MODEL_DIAMETER, 3)
    advance = np.array([0.5, 0.7, 0.833, 0.9])
    state = lifting_line.prepare(model).state(advance, SectionDrag.model_scale(10.0, 1e-6))
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 4.2))
    hydrodynamic = (2.0 * advance[:, None] + state.axial_velocity) / (
        2.0 * np.pi * state.radius_ratio - state.tangential_velocity
    )
    pitch = np.pi * state.radius_ratio * hydrodynamic
    for k, j in enumerate(advance):
        (line,) = axes[0].plot(
            state.radius_ratio,
            state.circulation[k] / (2.0 * np.pi * np.hypot(2.0 * j, 0.7 * 2.0 * np.pi)),
            ".-",
            label=f"J = {j:g}",
        )
        axes[1].plot(state.radius_ratio, pitch[k], ".-", color=line.get_color())
        axes[1].axhline(
            state.wake_pitch_ratio[k] * model.pitch_diameter_ratio_07R, color=line.get_color(), lw=0.7, ls="--"
        )
        axes[2].plot(state.radius_ratio, state.lift_excess[k], ".-", color=line.get_color())
    axes[0].set_title("circulation / (2 pi R V at 0.7 R)", fontsize=10)
    axes[0].legend(frameon=False)
    axes[1].set_title("hydrodynamic pitch/D (dashed: the wake's)", fontsize=10)
    axes[2].set_title("2 pi (alpha - alpha ideal)", fontsize=10)
    for one in axes:
        one.set_xlabel("r/R")
        one.grid(alpha=0.3)
        one.set_ylim(bottom=min(0.0, one.get_ylim()[0]))
    axes[1].set_ylim(0.6, 1.2)
    figure.tight_layout()
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def aperture_picture(file: Path) -> None:
    """The parent propeller in the aperture, from the side and from astern."""
    plt = pyplot()
    propeller = propeller_family(load_propeller(), 9.0, 3)
    hull = load_parent_hull().transform(355.0, 51.0, 14.5)
    ship = hull_view_parts(hull, "export")
    parts = [ShadedPart(*ship[name], colour) for name, colour in (("underwater", _PAINT), ("topsides", _ABOVE))]
    parts += _parts(propeller, propeller_placement(hull, propeller))
    clearance = propeller_clearance(hull, propeller)
    figure, axes = plt.subplots(1, 2, figsize=(12.0, 5.0))
    for place, title, azimuth, elevation, focus in (
        (axes[0], "from port", 90.0, 0.0, ((11.0, 0.0, 8.2), 14.5)),
        (axes[1], "from astern and port", 148.0, -8.0, ((6.0, 0.0, 8.2), 14.5)),
    ):
        place.imshow(render(parts, azimuth, elevation, focus, 580, 400))
        place.set_title(title, fontsize=10)
        place.set_axis_off()
    figure.suptitle(
        f"D {propeller.diameter:g} m, D/d {propeller.diameter / hull.draft:.3f}; tip clearance {clearance:.2f} m to "
        f"the hull, {baseline_clearance(hull, propeller):.2f} m to the baseline",
        fontsize=11,
    )
    figure.tight_layout()
    figure.savefig(file, dpi=90)
    plt.close(figure)


PICTURES = {
    "propeller-family.png": family_picture,
    "propeller-sections.png": sections_picture,
    "propeller-open-water.png": open_water_picture,
    "propeller-loading.png": loading_picture,
    "propeller-aperture.png": aperture_picture,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write every picture into a folder."""
    return write_pictures("Write the propeller's pictures.", PICTURES, arguments)


if __name__ == "__main__":
    sys.exit(main())
