"""Plans of patches: neighbours share their edge to the bit, and a plan that cannot be fitted says so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import lsq_linear

from hpsop_core import load_hull
from hpsop_core.geometry.hull.fit import Section, bounded_least_squares, knots_at
from hpsop_core.geometry.hull.fit_plan import (
    FIRST,
    LOWER_EDGE_ON_CENTREPLANE,
    Held,
    PatchPlan,
    Seam,
    Spans,
    StraightEdge,
    columns_on,
    fit_patches,
    girths,
    knots_with,
    open_ends,
    upper_edge_at,
)
from hpsop_core.geometry.hull.hull import load_parent_hull

DRAFT = 2.0
KNOTS = knots_at([0.2, 0.4, 0.6, 0.8])


def sections(low: float, high: float) -> list[Section]:
    """Sections of a body y = (1 + x/20) sqrt(z), flat at no point."""
    z = DRAFT * np.linspace(0.0, 1.0, 15) ** 2
    return [Section(float(x), np.column_stack([(1.0 + x / 20.0) * np.sqrt(z), z])) for x in np.linspace(low, high, 7)]


MAIN = PatchPlan(
    "main", sections(0.0, 10.0), Spans(np.linspace(0.0, 10.0, 6)), KNOTS,
    (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(DRAFT)), open_ends=("last",),
)  # fmt: skip
AFT = PatchPlan(
    "aft", sections(-6.0, -0.5), Spans(np.linspace(-6.0, 0.0, 5)), None,
    (LOWER_EDGE_ON_CENTREPLANE, upper_edge_at(DRAFT)), Seam("main", "first"),
)  # fmt: skip
# From a fifth of the girth to the waterline only.
FORE = replace(
    AFT, name="fore", sections=sections(10.5, 14.0), spans=Spans(np.linspace(10.0, 14.0, 5)),
    held=(upper_edge_at(DRAFT),), seam=Seam("main", "last", 0.2, 1.0),
)  # fmt: skip
SIDES = PatchPlan(
    "sides", [Section(s.x, s.points[-1] + np.array([[0.0, 0.0], [0.1, 1.0]])) for s in sections(0.0, 10.0)], None,
    knots_at([0.5]), (Held("z", StraightEdge(DRAFT, DRAFT + 1.0)),), along="main",
)  # fmt: skip


def test_neighbours_share_their_edge() -> None:
    fits = fit_patches([MAIN, AFT, FORE, SIDES])
    net = {name: fit.surface.control_points for name, fit in fits.items()}
    assert np.array_equal(net["aft"][-1, :, 1:], net["main"][0, :, 1:])
    assert np.array_equal(net["sides"][:, 0, 1], net["main"][:, -1, 1])
    assert np.array_equal(fits["sides"].surface.knots_u, fits["main"].surface.knots_u)
    # A stretch of the edge, cut out by knot insertion: the same curve to rounding.
    v = np.linspace(0.0, 1.0, 21)
    stretch = fits["main"].surface.evaluate(np.array([1.0]), 0.2 + 0.8 * v)[0]
    assert fits["fore"].surface.evaluate(np.array([0.0]), v)[0] == pytest.approx(stretch, abs=1e-12)


def test_one_patch_after_another_is_the_same_as_all_at_once() -> None:
    together = fit_patches([MAIN, AFT])
    first = fit_patches([MAIN])
    second = fit_patches([AFT], first)
    assert list(second) == ["aft"]
    assert np.array_equal(second["aft"].surface.control_points, together["aft"].surface.control_points)


def test_girths_count_in_the_first_patch_of_a_chain() -> None:
    beyond = replace(FORE, name="beyond", seam=Seam("fore", "last", 0.5, 1.0))
    found = girths([MAIN, AFT, FORE, beyond])
    assert found["main"] == ("main", 0.0, 1.0) and found["aft"] == ("main", 0.0, 1.0)
    assert found["fore"] == ("main", 0.2, 1.0)
    assert found["beyond"] == pytest.approx(("main", 0.6, 1.0))
    assert open_ends([MAIN, AFT]) == [("main", "last")]


@pytest.mark.parametrize(("low", "high"), [(0.0, 0.4), (0.4, 0.6), (0.6, 1.0)])
def test_held_columns_put_exactly_that_stretch_on_the_centreplane(low: float, high: float) -> None:
    knots = knots_at([k for k in (0.2, 0.4, 0.6, 0.8) if not low < k < high])
    plan = replace(MAIN, knots=knots, held=(*MAIN.held, Held("y", 0.0, FIRST, columns_on(knots, low, high))))
    surface = fit_patches([plan])["main"].surface
    y = surface.evaluate(np.array([0.0]), np.linspace(0.0, 1.0, 201))[0, :, 1]
    on = (np.linspace(0.0, 1.0, 201) >= low) & (np.linspace(0.0, 1.0, 201) <= high)
    assert np.all(y[on] == 0.0)
    assert np.max(np.abs(y[~on])) > 0.1


def test_knots_make_room_for_a_post() -> None:
    assert knots_with([0.2, 0.3, 0.41, 0.5, 0.8], 0.29, 0.4) == [0.2, 0.29, 0.4, 0.5, 0.8]
    assert knots_with([0.2, 0.8], 0.5, 0.5) == [0.2, 0.5, 0.8]


@pytest.mark.parametrize(
    ("plans", "words"),
    [
        ([AFT], "'aft' joins 'main', which is not fitted"),
        ([SIDES, MAIN], "'sides' joins 'main', which is not fitted"),
        ([replace(MAIN, knots=None)], "'main' has neither knots nor a seam"),
        ([replace(MAIN, spans=None)], "'main' has neither spans nor a patch below"),
        ([replace(MAIN, spans=Spans([0.0, 5.0, 5.01, 5.02, 10.0]))], "not rising"),
    ],
)
def test_a_plan_that_cannot_be_fitted_says_why(plans: list[PatchPlan], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        fit_patches(plans)


@pytest.mark.parametrize("seed", [1, 9, 11])
def test_control_points_between_limits_are_the_best_that_there_are(seed: int) -> None:
    """As scipy's bounded solver finds them. With 9 and 11 all that is wrong, turned at once, goes round for ever."""
    dice = np.random.default_rng(seed)
    left, _, right = np.linalg.svd(dice.normal(size=(30, 24)), full_matrices=False)
    design = sparse.csr_matrix(left @ np.diag(np.logspace(0.0, -3.0, 24)) @ right)
    target = design @ (4.0 * dice.normal(size=24))
    rough = sparse.csr_matrix(1e-4 * np.diff(np.eye(24), n=2, axis=0))
    fixed = np.full((4, 6), np.nan)
    fixed[0, :2] = 7.0
    found = bounded_least_squares(design, target, rough, fixed, (-2.0, 3.0))
    free = np.isnan(fixed.ravel())
    whole = np.vstack([design.toarray(), rough.toarray()])
    wanted = np.append(target, np.zeros(22)) - whole[:, ~free] @ np.full(2, 7.0)
    best = lsq_linear(whole[:, free], wanted, (-2.0, 3.0), method="bvls", tol=1e-14).x
    assert np.any(best < -1.999) and np.any(best > 2.999) and np.any((best > -1.9) & (best < 2.9))
    assert np.all(found.ravel()[~free] == 7.0)
    assert found.ravel()[free] == pytest.approx(best, abs=1e-6)


def test_a_bulb_of_a_few_stations_has_no_fin_in_the_centreplane() -> None:
    """The DTC read at six stations of its bulb: control points that were held at a limit once and never let go again
    threw the crown 5.7 m down and gmsh off the solid. Waterlines are 0.75 to 1 m apart there."""
    read = load_hull(Path(__file__).parents[1] / "data" / "hulls" / "dtc_boss_tip.csv", length=355.0, draft=14.5)
    u = np.linspace(0.0, 1.0, 401)
    crowns = [hull.underwater["bulb"].evaluate(u, np.array([1.0]))[:, 0] for hull in (read.parent, load_parent_hull())]
    x = np.linspace(361.0, 366.0, 51)
    own, ship = (np.interp(x, crown[:, 0], crown[:, 2]) for crown in crowns)
    assert float(np.max(np.abs(own - ship))) < 1.0
