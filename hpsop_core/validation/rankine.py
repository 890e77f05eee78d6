"""The Rankine solver beside closed forms, thin-ship theory and towing tanks; the studies of the objective come last."""

from __future__ import annotations

import csv
from collections.abc import Iterator

import numpy as np
from scipy.integrate import quad

from hpsop_core.assets import read_asset_text
from hpsop_core.geometry.analytic_bodies import ellipsoid_quads, wigley_half_breadth, wigley_panels
from hpsop_core.geometry.hull.fit_table import parent_from_table
from hpsop_core.geometry.hull.table_stations import HalfBreadths
from hpsop_core.hydro.rankine.resistance import pressure_force
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.rankine.solver import double_body, solve, solve_panels, solver_axes
from hpsop_core.hydro.singularities.source_panels import SourcePanels, flat_panels, panel_velocities
from hpsop_core.typing_aliases import Array
from hpsop_core.validation import rankine_studies as studies
from hpsop_core.validation.check import HELD_OUT, Check, labelled, range_check, relative_check

GROUP = "Rankine panels"
# Largest surface speed over the stream's, from Lamb's integrals.
ELLIPSOIDS = (
    ((1.0, 1.0, 1.0), 1.5),
    ((1.0, 0.2, 0.1), 1.03423),
    ((1.0, 0.4, 0.2), 1.09327),
    ((1.0, 0.14, 0.08), 1.02221),
)
WIGLEY_SWEEP = (0.25, 0.266, 0.29, 0.313, 0.35, 0.38, 0.408)
WIGLEY_SOURCE = "experiments 1.4 to 1.9e-3, mean 1.70e-3 (Chen, Noblesse 1983)"


def checks() -> Iterator[Check]:
    """Kernels and bodies, waves, ships, and the objective; the last take minutes."""
    yield from labelled(HELD_OUT, _bodies())
    yield from labelled(HELD_OUT, _waves())
    yield from labelled(HELD_OUT, _wigley())
    yield from _ahead()
    yield from _objective()
    yield from _block()
    yield from _mesh()


def _brute_force(panel: SourcePanels, point: Array, order: int = 80) -> Array:
    """A panel's velocity with all images by a Gauss product rule."""
    node, weight = np.polynomial.legendre.leggauss(order)
    s, t = np.meshgrid(0.5 * (node + 1.0), 0.5 * (node + 1.0), indexing="ij")
    a, b, c, d = panel.corners[0]
    at = ((1 - s) * (1 - t))[..., None] * a + (s * (1 - t))[..., None] * b
    at = at + (s * t)[..., None] * c + ((1 - s) * t)[..., None] * d
    along = (1 - t)[..., None] * (b - a) + t[..., None] * (c - d)
    across = (1 - s)[..., None] * (d - a) + s[..., None] * (c - b)
    area = np.linalg.norm(np.cross(along, across), axis=-1) * np.outer(weight, weight) / 4.0
    total = np.zeros(3)
    for mirror_y in (1.0, -1.0):
        for mirror_z in (1.0, -1.0):
            away = point - at * np.array([1.0, mirror_y, mirror_z])
            total += np.sum(area[..., None] * away / np.linalg.norm(away, axis=-1)[..., None] ** 3, axis=(0, 1))
    return total / (4.0 * np.pi)


def _bodies() -> Iterator[Check]:
    panel = flat_panels(np.array([[[0.0, 0.1, -0.3], [0.9, 0.2, -0.35], [1.1, 0.8, -0.2], [-0.1, 0.7, -0.25]]]))
    worst = 0.0
    for point in ((0.4, 0.5, -0.8), (1.5, 0.3, -0.1), (-0.6, 0.9, -0.6), (0.5, 1.4, 0.0)):
        exact = _brute_force(panel, np.array(point))
        ours = panel_velocities(np.array([point]), panel, image_z=True, far_diagonals=1e9)
        gap = np.array([component[0, 0] for component in ours]) - exact
        worst = max(worst, float(np.linalg.norm(gap) / np.linalg.norm(exact)))
    source = "80 x 80 Gauss points"
    yield range_check(GROUP, "source panel with images, relative error of velocity", worst, 0.0, 1e-6, 0.0, source)
    for axes, largest in ELLIPSOIDS:
        body = double_body(flat_panels(ellipsoid_quads(40, 14, axes)))
        speed = float(np.max(np.linalg.norm(body.flow, axis=1)))
        name = f"ellipsoid {axes[0]:g}:{axes[1]:g}:{axes[2]:g}, largest surface speed / U"
        yield relative_check(GROUP, name, speed, largest, "Lamb, Hydrodynamics, art. 114", 0.01)
    settings = RankineSettings()
    wigley = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise)
    panels, _ = solver_axes(wigley)
    drag = 2.0 * float(pressure_force(double_body(panels).pressure_coefficient, panels)[0]) / wigley.wetted_surface
    yield range_check(GROUP, "Wigley hull, drag coefficient of the double body", drag, -1e-8, 1e-8, 0.0, "d'Alembert")
    drag = solve(studies.parent_hull_itself(), [0.22]).double_body_drag
    yield range_check(GROUP, "DTC, drag coefficient of the double body", drag, -1e-4, 1e-4, 0.0, "d'Alembert")


def havelock(ratio: float, depth_froude: float) -> float:
    """R/(pi rho g a^3) of a dipole at ``ratio`` radii under the water, depth_froude = U/sqrt(g f) (Havelock 1917)."""
    depth_number = 1.0 / depth_froude**2

    def integrand(angle: float) -> float:
        return float(np.cos(angle) ** -5 * np.exp(-2.0 * depth_number / np.cos(angle) ** 2))

    return float(4.0 * (depth_number / ratio) ** 3 * quad(integrand, 0.0, 0.5 * np.pi - 1e-6)[0])


def _waves() -> Iterator[Check]:
    deep = studies.deep_body_settings()
    radius = 0.05
    sphere = studies.submerged_sphere(radius, 3.0 * radius)
    for number in (0.25, 0.31):
        fields = solve_panels(sphere, [number], deep, fields=True).conditions[0].fields
        if fields is None:
            continue
        length = 2.0 * np.pi / studies.track_wave_number(fields, 1.0, 0.5, (1.0, 2.1))
        name = f"transverse wave length / Lpp behind a sphere at Fn {number:g}"
        yield relative_check(GROUP, name, length, 2.0 * np.pi * number**2, "2 pi Fn^2, deep water", 0.05)
    for depth_froude in (0.6, 0.7, 0.8, 1.0):
        number = depth_froude * np.sqrt(3.0 * radius)
        condition = solve_panels(sphere, [number], deep).conditions[0]
        convert = 0.5 * number**2 * 4.0 / radius
        exact = havelock(3.0, depth_froude)
        for name, value in (
            ("plane", condition.wave_coefficient),
            ("pressure", condition.wave_coefficient_pressure),
        ):
            quantity = f"sphere 3 radii deep, U/sqrt(gf) {depth_froude:g}, R/(pi rho g a^3) by {name}"
            yield relative_check(GROUP, quantity, value * convert, exact, "Havelock 1917, dipole", 0.10)


def _ahead() -> Iterator[Check]:
    source = "double-body rise only; waves would give 1"
    hull = studies.parent_hull_itself()
    for condition in solve(hull, studies.FROUDE_NUMBERS, fields=True).conditions:
        if condition.fields is None:
            continue
        share = studies.upstream_share(condition.fields, hull.length, 0.2)
        name = f"DTC, elevation 0.2 Lpp ahead of FP / largest, Fn {condition.froude_number:g}"
        yield range_check(GROUP, name, share, 0.0, 0.10, 0.0, source)


def _wigley() -> Iterator[Check]:
    finer = RankineSettings().refined(1.3)
    thin = wigley_panels(finer.hull_lengthwise, finer.hull_girthwise, breadth=0.02)
    result = solve_panels(thin, (0.25, 0.313, 0.408), finer)
    expected = studies.wigley_michell(thin, 0.02, (0.25, 0.313, 0.408))
    for condition, value in zip(result.conditions, expected, strict=True):
        place = f"{result.unknowns} unknowns, Fn {condition.froude_number:g}"
        name = f"thin Wigley hull B/L 0.02, {place}: pressure / Michell"
        ratio = condition.wave_coefficient_pressure / float(value)
        yield range_check(GROUP, name, ratio, 0.90, 1.0, 1.0, "Michell 1898, the limit of B/L -> 0")
    for settings in (RankineSettings(), RankineSettings().refined(1.4)):
        hull = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise)
        result = solve_panels(hull, [0.313], settings)
        for name, value in (
            ("plane", result.conditions[0].wave_coefficient),
            ("pressure", result.conditions[0].wave_coefficient_pressure),
        ):
            quantity = f"Wigley hull B/L 0.1, {result.unknowns} unknowns, Cw at Fn 0.313 by {name}"
            yield range_check(GROUP, quantity, value, 1.4e-3, 1.9e-3, 1.70e-3, WIGLEY_SOURCE)
    x, z = np.linspace(0.0, 100.0, 41), np.linspace(0.0, 6.25, 11)
    table = wigley_half_breadth(x[:, None], z[None, :], 100.0, 10.0, 6.25)
    own = parent_from_table(HalfBreadths("wigley", x, z, table), 100.0, 6.25).transform(100.0, 10.0, 6.25)
    value = solve(own, [0.313]).conditions[0].wave_coefficient
    name = "Wigley hull from a user's 41 x 11 table, Cw at Fn 0.313 by plane"
    yield range_check(GROUP, name, value, 1.4e-3, 1.9e-3, 1.70e-3, WIGLEY_SOURCE)
    settings = RankineSettings()
    hull = wigley_panels(settings.hull_lengthwise, settings.hull_girthwise)
    expected = studies.wigley_michell(hull, 0.1, WIGLEY_SWEEP)
    for condition, value in zip(solve_panels(hull, WIGLEY_SWEEP, settings).conditions, expected, strict=True):
        # Thin-ship theory is the limit of small B/L; finite breadth lowers it, most at the main hump.
        name = f"Wigley hull B/L 0.1, Cw at Fn {condition.froude_number:g} by plane, beside Michell"
        lower, upper = 0.6 * float(value), 1.1 * float(value)
        yield range_check(GROUP, name, condition.wave_coefficient, lower, upper, float(value), "Michell 1898")


def tank_points() -> list[dict[str, float]]:
    """The rows of the Duisburg Test Case's towing tests."""
    lines = [line for line in read_asset_text("reference", "dtc_resistance.csv").splitlines() if line[:1] != "#"]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def _objective() -> Iterator[Check]:
    source = "what an optimiser can feel"
    for name, low, high in (("length_to_breadth", 6.5, 8.5), ("breadth_to_draft", 3.0, 4.5)):
        at = np.linspace(low, high, 21)
        areas = studies.sweep_ratio(name, at)
        residual = studies.cubic_residual(at, areas) if np.all(areas > 0.0) else np.inf
        label = f"wave resistance over {name} {low:g} to {high:g}, residual about a cubic"
        yield range_check(GROUP, label, residual, 0.0, 2e-3, 0.0, source)
    at = np.linspace(0.95, 1.05, 31)
    _, areas = studies.sweep_displacement(at)
    residual = studies.local_cubic_residual(at, areas) if np.all(areas > 0.0) else np.inf
    label = "wave resistance over displacement ratio 0.95 to 1.05, residual about local cubics"
    yield range_check(GROUP, label, residual, 0.0, 2e-3, 0.0, source)
    for kind, designs in (
        ("40 designs inside the paper's bounds", studies.affine_designs(40, seed=1)),
        ("40 designs with displacement and LCB varied too", studies.form_designs(40, seed=3)),
    ):
        sample, count = studies.robustness(designs), len(designs)
        label = f"{kind}: solved, or refused with a reason"
        explained = sample.solved + sample.refused - sample.unexplained
        yield range_check(GROUP, label, explained, count, count, count, "none may vanish")
        label = f"lowest wave coefficient of the {sample.solved} solved ones"
        yield range_check(GROUP, label, sample.lowest, 1e-6, 1.0, 0.0, "none may be negative")


def _block() -> Iterator[Check]:
    """Hump, hollow and wall over CB .60 to .75, and where the hollow is."""
    ratios = np.linspace(0.905, 1.14, 16)
    blocks, areas = studies.sweep_displacement(ratios)
    shoulder = studies.shoulder_at(ratios)
    source = "a shoulder's trough on a crest of the bow's waves"
    for k, number in enumerate(studies.FROUDE_NUMBERS):
        hollow = int(np.argmin(areas[:, k]))
        place = f"CB {blocks[hollow]:.3f}, Fn {number:g}"
        name = f"hollow of the wave resistance over CB ({place}): fore shoulder aft of FP / wave length"
        waves = float(shoulder[hollow]) / (2.0 * np.pi * number**2 * 355.0)
        yield range_check(GROUP, name, waves, 0.8, 1.1, 1.0, source)
        name = f"the wall: wave resistance at CB {blocks[-1]:.3f} / least, Fn {number:g}"
        rise = float(areas[-1, k] / areas[hollow, k])
        yield range_check(GROUP, name, rise, 2.0, 6.0, 3.0, "earlier versions of this solver")


def _mesh() -> Iterator[Check]:
    study = studies.mesh_study(studies.affine_designs(30, seed=7))
    finest = study.unknowns[-1]
    for mesh in range(len(study.factors) - 1):
        for condition, number in enumerate(studies.FROUDE_NUMBERS):
            place = f"{study.unknowns[mesh]} unknowns, Fn {number:g}"
            ratio = float(study.bias(mesh)[condition])
            spread = 100.0 * float(study.scatter(mesh)[condition])
            label = f"{place}: mean wave resistance / that with {finest} unknowns (scatter {spread:.1f} %)"
            yield range_check(GROUP, label, ratio, 0.75, 1.25, 1.0, "30 designs on our finest mesh")
            correlation = float(study.rank_correlation(mesh)[condition])
            label = f"{place}: rank correlation of 30 designs with {finest} unknowns"
            yield range_check(GROUP, label, correlation, 0.97, 1.0, 1.0, "the finest mesh's ranking")
    study = studies.mesh_study(studies.form_designs(30, seed=7), (1.0, 1.5))
    label = (
        f"{study.unknowns[0]} unknowns, displacement and LCB varied too: rank correlation of 30 total resistances with "
        f"{study.unknowns[1]} unknowns"
    )
    value = study.total_rank_correlation(0)
    yield range_check(GROUP, label, value, 0.97, 1.0, 1.0, "the finest mesh's ranking of f1")
