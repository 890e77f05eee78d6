"""The propeller panel method's pictures in docs/pictures.

python -m tools.pictures.blade_panels --to docs/pictures
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.geometry.propeller.surface import rotate_blade
from hpsop_core.hydro.blade_panels.forces import OMEGA
from hpsop_core.hydro.blade_panels.grid import helical_wake, to_propeller_axes
from hpsop_core.hydro.blade_panels.settings import BladePanelSettings, HubSettings
from hpsop_core.hydro.blade_panels.solver import BladePanelResult, forces_of, solve
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array
from hpsop_core.validation.propeller_level1 import reference_rows
from hpsop_core.validation.propeller_level2 import fine_rigid_wake
from hpsop_core.validation.propeller_studies import GRIDS, MODEL_SCALE, experiment, model_propeller
from tools.pictures.command import write_pictures
from tools.pictures.plotting import pyplot

_DPI = 100
_BLUE, _RED, _GREEN, _BRONZE, _GREY = "#1f4e9c", "#b03020", "#207040", "#d9b36a", "#9aa0a6"


def _quadrilaterals(axes: Any, quads: Array, faces: Any, edges: Any, width: float) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    axes.add_collection3d(Poly3DCollection(quads, facecolors=faces, edgecolors=edges, linewidths=width))


def _frame(axes: Any, low: Sequence[float], high: Sequence[float], elevation: float, azimuth: float) -> None:
    for name, a, b in zip("xyz", low, high, strict=True):
        getattr(axes, f"set_{name}lim")(a, b)
    axes.set_box_aspect(np.subtract(high, low), zoom=1.3)
    axes.set_axis_off()
    axes.view_init(elevation, azimuth)


def panels_picture(file: Path) -> None:
    """The optimiser's panels: the key blade with its share of hub and wake, and the whole without the wakes."""
    plt = pyplot()
    from matplotlib.transforms import Bbox

    propeller = propeller_family(load_propeller(), 2.0, 3)
    result = solve(propeller, [0.7], SectionDrag.inviscid())
    model = result.model
    figure = plt.figure(figsize=(11.5, 4.6))
    left = figure.add_axes((0.0, 0.0, 0.58, 0.95), projection="3d", proj_type="ortho")
    wake, _ = helical_wake(model.grid, np.full(11, 2.0 * result.wake_pitch_ratio[0]), model.settings.wake_grid)
    near = wake.corners[wake.corners[..., 0].max(axis=1) < 2.2]
    for corners, colour, width in (
        (near, "#dfe8f5", 0.4),
        (model.hub.panels.corners, _GREY, 0.4),
        (model.grid.surface.panels.corners, _BRONZE, 0.5),
    ):
        _quadrilaterals(left, to_propeller_axes(corners), colour, "#303030", width)
    _frame(left, (-0.7, -1.0, -1.0), (2.2, 1.0, 1.0), 18.0, -128.0)
    left.set_title(
        f"what is solved: {model.onset_points.shape[0]} panels of blade and hub sector, "
        f"{wake.count} of the wake (part)",
        fontsize=10,
    )
    right = figure.add_axes((0.56, 0.0, 0.44, 0.95), projection="3d", proj_type="ortho")
    for blade in range(3):
        for corners, colour in ((model.hub.panels.corners, _GREY), (model.grid.surface.panels.corners, _BRONZE)):
            points = rotate_blade(to_propeller_axes(corners).reshape(-1, 3), blade, 3).reshape(-1, 4, 3)
            _quadrilaterals(right, points, colour, "#303030", 0.35)
    _frame(right, (-0.8, -1.0, -1.0), (0.9, 1.0, 1.0), 18.0, -158.0)
    right.set_title("with its images", fontsize=10)
    # 3D axes keep wide margins: store the part of the sheet that holds something
    figure.savefig(file, dpi=_DPI, bbox_inches=Bbox([[0.3, 0.55], [10.6, 4.6]]))
    plt.close(figure)


def _chordwise(result: BladePanelResult, advance: float, radius: float) -> tuple[float, Array, Array, Array]:
    """(r/R of the strip next to it, x/c of the panels of a side, Cp of back and face from the leading edge)."""
    model = result.model
    strip = int(np.argmin(np.abs(model.grid.radius_middle - radius)))
    there = float(model.grid.radius_middle[strip])
    pressure = model.blade_pressure(model.condition(advance))[:, strip]
    cp = pressure / (0.5 * (4.0 * advance**2 + (OMEGA * there) ** 2))
    half = cp.size // 2
    angle = np.pi * np.arange(half + 1) / half
    edge = 0.5 * (1.0 - np.cos(angle))
    return there, 0.5 * (edge[1:] + edge[:-1]), cp[half:], cp[:half][::-1]


def pressure_picture(file: Path) -> None:
    """Cp on both sides of P4119, and along the chord on three radii."""
    plt = pyplot()
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    advance = 0.833
    settings = BladePanelSettings(60, 20, hub=HubSettings(5, 6, 36))
    result = solve(propeller_family(load_propeller(), 2.0, 3), [advance], SectionDrag.inviscid(), settings)
    surface = result.surface_pressure(advance)
    scale = Normalize(-0.3, 0.3)
    colours = plt.get_cmap("RdBu_r")(scale(surface.pressure_coefficient))
    # the pressures of the blades are the subject; on the hub they are rough where wakes cross its panels
    colours[surface.blade < 0] = (0.62, 0.63, 0.65, 1.0)
    quads = surface.points[surface.quads]
    figure = plt.figure(figsize=(12.0, 7.6))
    for left, azimuth, title in ((0.0, 180.0, "back, from upstream"), (0.44, 0.0, "face, from downstream")):
        axes = figure.add_axes((left, 0.40, 0.46, 0.56), projection="3d", proj_type="ortho")
        _quadrilaterals(axes, quads, colours, colours, 0.2)
        _frame(axes, (-0.9, -0.95, -0.75), (0.9, 0.95, 1.0), 0.0, azimuth)
        axes.set_title(title, fontsize=11, y=0.98)
    bar = figure.add_axes((0.91, 0.47, 0.013, 0.42))
    figure.colorbar(ScalarMappable(scale, "RdBu_r"), cax=bar, extend="both")
    bar.set_title("Cp", fontsize=10)
    for place, radius in enumerate((0.3, 0.7, 0.9)):
        axes = figure.add_axes((0.06 + 0.32 * place, 0.07, 0.26, 0.29))
        for j, colour in ((0.7, _GREEN), (advance, _BLUE), (0.9, _RED)):
            there, along, back, face = _chordwise(result, j, radius)
            axes.plot(along, back, color=colour, label=f"J = {j:g}")
            axes.plot(along, face, "--", color=colour)
        axes.set_ylim(0.4, -0.7)
        axes.set_xlabel("x/c from the leading edge")
        axes.set_title(f"r/R = {there:.2f} (dashed: face)", fontsize=10)
        axes.grid(alpha=0.3)
        if place == 0:
            axes.set_ylabel("Cp")
        if place == 2:
            axes.legend(frameon=False, fontsize=9)
    figure.savefig(file, dpi=85)
    plt.close(figure)


def accuracy_picture(file: Path) -> None:
    """P4119 in open water: level 2, level 1, experiments and PROPAN."""
    plt = pyplot()
    model = model_propeller()
    advance = np.linspace(0.3, 1.1, 33)
    second = solve(model, advance, MODEL_SCALE).open_water
    first = lifting_line.solve(model, advance, MODEL_SCALE)
    rigid = fine_rigid_wake().open_water
    figure, (left, right) = plt.subplots(1, 2, figsize=(12.0, 5.0), layout="constrained")
    left.plot(advance, second.thrust_coefficient, color=_BLUE, label="KT, level 2")
    left.plot(advance, 10.0 * second.torque_coefficient, color=_RED, label="10 KQ, level 2")
    left.plot(advance, second.open_water_efficiency, color=_GREEN, label="efficiency, level 2")
    left.plot(advance, first.thrust_coefficient, "--", color="k", lw=0.8, label="level 1")
    left.plot(advance, 10.0 * first.torque_coefficient, "--", color="k", lw=0.8)
    left.plot(advance, first.open_water_efficiency, "--", color="k", lw=0.8)
    for name, marker, fill in (("A", "o", None), ("B", "s", "none")):
        j, kt, kq = experiment(name)
        for values, colour in ((kt, _BLUE), (kq, _RED), (j * kt / (0.2 * np.pi * kq), _GREEN)):
            label = f"test, set {name}" if colour == _BLUE else None
            left.plot(j, values, marker, color=colour, mfc=fill or colour, ls="", label=label)
    left.set_title("model scale, D = 0.3048 m, n = 10 1/s", fontsize=11)
    left.set_ylim(0.0, 0.85)
    rows = reference_rows("p4119_propan.csv")
    j, kt, kq = (np.array([float(row[key]) for row in rows]) for key in ("J", "KT_blade_inv", "10KQ_blade_inv"))
    right.plot(j, rigid.thrust_coefficient, color=_BLUE, label="KT, level 2 (80 x 24, pressures)")
    right.plot(j, 10.0 * rigid.torque_coefficient, color=_RED, label="10 KQ, level 2 (80 x 24, pressures)")
    right.plot(j, kt, "+", color=_BLUE, ms=9, label="KT, PROPAN (80 x 40)")
    right.plot(j, kq, "+", color=_RED, ms=9, label="10 KQ, PROPAN (80 x 40)")
    right.set_title("without viscosity, rigid wake at the geometric pitch", fontsize=11)
    right.set_ylim(0.0, 0.45)
    for axes in (left, right):
        axes.set_xlabel("advance coefficient J")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize=9)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


def grid_picture(file: Path) -> None:
    """KT and KQ of P4119 by both force formulas on ever finer grids."""
    plt = pyplot()
    advance = [0.5, 0.833]
    found = []
    for chordwise, radial in GRIDS:
        hub = HubSettings(5, 6, 36) if chordwise >= 60 else HubSettings()
        result = solve(model_propeller(), advance, MODEL_SCALE, BladePanelSettings(chordwise, radial, hub=hub))
        found.append((*forces_of(result, "circulation"), *forces_of(result, "pressure")))
    values = np.array(found)
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 4.0), layout="constrained")
    for i, one in enumerate(axes):
        reference = values[-1, :2, i]
        for k, (label, colour, style) in enumerate(
            (
                ("KT, circulation", _BLUE, "o-"),
                ("KQ, circulation", _RED, "o-"),
                ("KT, pressures", _BLUE, "s--"),
                ("KQ, pressures", _RED, "s--"),
            )
        ):
            one.plot(100.0 * (values[:, k, i] / reference[k % 2] - 1.0), style, color=colour, label=label)
        one.axhline(0.0, color="k", lw=0.6)
        one.set_xticks(range(len(GRIDS)), [f"{a}x{b}" for a, b in GRIDS])
        one.set_xlabel("panels on a blade, round the sections x along the radius")
        one.set_ylabel("over circulation on 80x24, in %")
        one.set_ylim(-4.0, 4.0)
        one.grid(alpha=0.3)
        one.set_title(f"P4119, J = {advance[i]:g}", fontsize=11)
    axes[1].legend(frameon=False, fontsize=9, ncols=2)
    figure.savefig(file, dpi=_DPI)
    plt.close(figure)


PICTURES = {
    "propeller-panels.png": panels_picture,
    "propeller-pressure.png": pressure_picture,
    "propeller-panels-accuracy.png": accuracy_picture,
    "propeller-panels-grid.png": grid_picture,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write every picture into a folder."""
    return write_pictures("Write the propeller panel method's pictures.", PICTURES, arguments)


if __name__ == "__main__":
    sys.exit(main())
