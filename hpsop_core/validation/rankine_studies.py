"""Sweeps of the Rankine solver that validation, pictures and docs share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import qmc, spearmanr

from hpsop_core.errors import SolverFailure
from hpsop_core.geometry.analytic_bodies import ellipsoid_quads, wigley_half_breadth
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull
from hpsop_core.geometry.hull.panels import HullPanels
from hpsop_core.hydro.friction import ittc57_coefficient
from hpsop_core.hydro.michell import wave_coefficients
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.hydro.rankine.solver import RankineFields, solve
from hpsop_core.typing_aliases import Array

FROUDE_NUMBERS, WEIGHTS = (0.22, 0.27), (0.65, 0.35)
FORM_FACTOR, GRAVITY, VISCOSITY = 0.094, 9.80665, 1.188e-6
# The bounds of the paper's table 2 on L/B, B/d and d.
PAPER_BOUNDS = ((6.5, 3.0, 14.0), (8.5, 4.5, 14.5))


def parent_hull_itself() -> Hull:
    """The parent, unscaled."""
    parent = load_parent_hull()
    return parent.transform(parent.length, parent.breadth, parent.draft)


def affine_hull(length_to_breadth: float, breadth_to_draft: float, draft: float) -> Hull:
    """The parent scaled to these ratios."""
    breadth = breadth_to_draft * draft
    return load_parent_hull().transform(length_to_breadth * breadth, breadth, draft)


def latin_hypercube(count: int, seed: int) -> Array:
    """(count, 3) designs L/B, B/d, d inside the paper's bounds."""
    return np.asarray(qmc.scale(qmc.LatinHypercube(3, seed=seed).random(count), *PAPER_BOUNDS), dtype=np.float64)


def form_designs(count: int, seed: int) -> list[Hull]:
    """A Latin hypercube in which the form changes too: displacement by 5 % and LCB by 1 % of the length, each way."""
    parent = load_parent_hull()
    block = parent.hydrostatics.block_coefficient
    lower, upper = ((*bounds, *more) for bounds, more in zip(PAPER_BOUNDS, ((0.95, -0.01), (1.05, 0.01)), strict=True))
    designs = []
    for row in qmc.scale(qmc.LatinHypercube(5, seed=seed).random(count), lower, upper):
        slenderness, flatness, draft, ratio, shift = (float(value) for value in row)
        breadth = flatness * draft
        length = slenderness * breadth
        volume = ratio * block * length * breadth * draft
        designs.append(parent.transform(length, breadth, draft, volume, shift * length))
    return designs


def affine_designs(count: int, seed: int) -> list[Hull]:
    """The parent scaled to a Latin hypercube of ratios and drafts."""
    return [affine_hull(*(float(value) for value in row)) for row in latin_hypercube(count, seed)]


def wave_areas(hull: Hull, settings: RankineSettings | None = None) -> Array:
    """Wave resistance over rho g at both conditions, m3: what an objective of fixed weights feels.

    Raises:
        SolverFailure: as the solver.
    """
    result = solve(hull, FROUDE_NUMBERS, settings)
    surface = hull.hydrostatics.wetted_surface
    return np.array([0.5 * c.wave_coefficient * c.froude_number**2 * hull.length * surface for c in result.conditions])


def cubic_residual(at: Array, values: Array) -> float:
    """Largest relative distance from the least-squares cubic, over all columns of ``values``."""
    place = (at - at.mean()) / np.ptp(at)
    worst = 0.0
    for column in values.T:
        fitted = np.polyval(np.polyfit(place, column, 3), place)
        worst = max(worst, float(np.max(np.abs(fitted / column - 1.0))))
    return worst


def local_cubic_residual(at: Array, values: Array, neighbours: int = 11) -> float:
    """The same about a cubic through every run of neighbours."""
    starts = range(len(at) - neighbours + 1)
    return max(cubic_residual(at[k : k + neighbours], values[k : k + neighbours]) for k in starts)


def sweep_ratio(name: str, values: Array) -> Array:
    """Wave areas (n, 2) over L/B or B/d, the other ratio and the draft being the parent's."""
    ratios = {"length_to_breadth": 355.0 / 51.0, "breadth_to_draft": 51.0 / 14.5, "draft": 14.5}
    return np.array([wave_areas(affine_hull(**{**ratios, name: float(value)})) for value in values])


def sweep_displacement(ratios: Array, buoyancy_centre_shift: float = 0.0) -> tuple[Array, Array]:
    """Block coefficients (n,) and wave areas (n, 2) over the displacement ratio at the parent's L, B, d."""
    parent = load_parent_hull()
    volume = parent.hydrostatics.displaced_volume
    blocks, areas = [], []
    for ratio in ratios:
        hull = parent.transform(
            parent.length, parent.breadth, parent.draft, float(ratio) * volume, buoyancy_centre_shift * parent.length
        )
        blocks.append(hull.hydrostatics.block_coefficient)
        areas.append(wave_areas(hull))
    return np.array(blocks), np.array(areas)


def fore_shoulder(hull: Hull, share: float = 0.95) -> float:
    """Distance aft of FP, m, where the sectional area first reaches this share of its largest value."""
    measured = hull.hydrostatics
    order = np.argsort(measured.sectional_area_x)
    x, area = measured.sectional_area_x[order], measured.sectional_area[order] / np.max(measured.sectional_area)
    ahead = x > 0.5 * hull.length
    return hull.length - float(np.interp(-share, -area[ahead], x[ahead]))


def shoulder_at(ratios: Array) -> Array:
    """``fore_shoulder`` (n,) over the displacement ratio at the parent's L, B, d and LCB."""
    parent = load_parent_hull()
    volume = parent.hydrostatics.displaced_volume
    dimensions = parent.length, parent.breadth, parent.draft
    return np.array([fore_shoulder(parent.transform(*dimensions, float(ratio) * volume)) for ratio in ratios])


@dataclass(frozen=True)
class Robustness:
    """What became of a sample of designs: solved, refused with a reason, lowest wave coefficient."""

    solved: int
    refused: int
    unexplained: int
    lowest: float


def robustness(designs: Sequence[Hull]) -> Robustness:
    """Solve designs at both conditions."""
    solved = refused = unexplained = 0
    lowest = np.inf
    for design in designs:
        try:
            result = solve(design, FROUDE_NUMBERS)
        except SolverFailure as failure:
            refused += 1
            unexplained += not failure.reason
            continue
        solved += 1
        lowest = min(lowest, *(c.wave_coefficient for c in result.conditions))
    return Robustness(solved, refused, unexplained, float(lowest))


@dataclass(frozen=True, eq=False)
class MeshStudy:
    """Wave areas of the same designs on meshes of rising fineness.

    Attributes:
        factors: refinement against the default; the last is the reference.
        unknowns: of each mesh.
        areas: (meshes, designs, 2) wave resistance over rho g.
        totals: (meshes, designs) resistance over rho g as f1 weighs it, with the paper's weights.
    """

    factors: tuple[float, ...]
    unknowns: tuple[int, ...]
    areas: Array
    totals: Array

    def bias(self, mesh: int) -> Array:
        """Mean ratio to the finest mesh at both conditions."""
        return np.asarray(np.mean(self.areas[mesh] / self.areas[-1], axis=0))

    def scatter(self, mesh: int) -> Array:
        """Standard deviation of that ratio over the designs."""
        return np.asarray(np.std(self.areas[mesh] / self.areas[-1], axis=0))

    def rank_correlation(self, mesh: int) -> Array:
        """Spearman's coefficient against the finest mesh at both conditions."""
        return np.array([float(spearmanr(self.areas[mesh][:, k], self.areas[-1][:, k])[0]) for k in range(2)])

    def total_rank_correlation(self, mesh: int) -> float:
        """The same for the weighted total resistance."""
        return float(spearmanr(self.totals[mesh], self.totals[-1])[0])


def friction_areas(hull: Hull) -> Array:
    """Friction with form factor over rho g at both conditions, m3, full scale in salt water."""
    areas = []
    for number in FROUDE_NUMBERS:
        speed = number * (GRAVITY * hull.length) ** 0.5
        coefficient = (1.0 + FORM_FACTOR) * ittc57_coefficient(speed * hull.length / VISCOSITY)
        areas.append(0.5 * coefficient * number**2 * hull.length * hull.hydrostatics.wetted_surface)
    return np.array(areas)


def mesh_study(designs: Sequence[Hull], factors: tuple[float, ...] = (0.75, 1.0, 1.5)) -> MeshStudy:
    """Rank designs on several meshes."""
    unknowns, areas = [], []
    for factor in factors:
        settings = RankineSettings().refined(factor)
        unknowns.append(solve(designs[0], FROUDE_NUMBERS[:1], settings).unknowns)
        areas.append([wave_areas(hull, settings) for hull in designs])
    friction = np.array([friction_areas(hull) for hull in designs])
    return MeshStudy(factors, tuple(unknowns), np.array(areas), (np.array(areas) + friction) @ np.array(WEIGHTS))


def wigley_michell(hull: HullPanels, breadth: float, froude_numbers: Sequence[float]) -> Array:
    """Michell's wave coefficients of the Wigley hull with the panels' wetted surface."""
    x, z = np.linspace(0.0, hull.length, 161), np.linspace(0.0, hull.draft, 41)
    table = wigley_half_breadth(x[:, None], z[None, :], hull.length, breadth, hull.draft)
    return wave_coefficients(x, z, table, hull.length, hull.wetted_surface, froude_numbers)


def submerged_sphere(radius: float, immersion: float) -> HullPanels:
    """A sphere amidships under the water, its centre at ``immersion``, in units of the length; no waterline breadth."""
    quads = ellipsoid_quads(16, 12, (radius, radius, radius), whole=True) + np.array([0.5, 0.0, 0.0])
    return HullPanels(
        quads=quads,
        blocks=(("sphere", 16, 12),),
        waterline=np.stack([np.linspace(0.0, 1.0, 11), np.zeros(11)], axis=1),
        length=1.0,
        draft=immersion,
        wetted_surface=4.0 * np.pi * radius**2,
        displaced_volume=4.0 / 3.0 * np.pi * radius**3,
        vertical_centre_of_buoyancy=0.0,
    )


def deep_body_settings() -> RankineSettings:
    """Rows as fine as a small body on the centreplane needs, and water well ahead of it and behind."""
    return replace(
        RankineSettings(),
        upstream=0.8,
        columns_upstream=18,
        downstream=1.5,
        columns_downstream=52,
        half_width=1.0,
        rows=18,
        first_row=0.5,
    )


def track_wave_number(fields: RankineFields, length: float, source: float, window: tuple[float, float]) -> float:
    """Wave number (per length) of the innermost row's track: best cosine decaying with the root of the distance.

    Args:
        fields: elevations.
        length: Lpp, m.
        source: where the waves come from, lengths aft of FP.
        window: which part of the track, lengths aft of FP.
    """
    behind = 1.0 - fields.x[:, 0] / length
    chosen = (behind > window[0]) & (behind < window[1])
    distance, elevation = behind[chosen] - source, fields.elevation[chosen, 0] / length
    envelope = 1.0 / np.sqrt(distance)
    trials = np.geomspace(2.0, 120.0, 4001)
    misfits = []
    for trial in trials:
        phase = trial * distance
        basis = np.stack([envelope * np.cos(phase), envelope * np.sin(phase), np.ones_like(distance)], axis=1)
        misfits.append(float(np.sum((basis @ np.linalg.lstsq(basis, elevation, rcond=None)[0] - elevation) ** 2)))
    return float(trials[int(np.argmin(misfits))])


def upstream_share(fields: RankineFields, length: float, ahead: float) -> float:
    """Largest elevation more than ``ahead`` lengths before FP over the largest anywhere."""
    before = fields.x / length > 1.0 + ahead
    return float(np.max(np.abs(fields.elevation[before])) / np.max(np.abs(fields.elevation)))
