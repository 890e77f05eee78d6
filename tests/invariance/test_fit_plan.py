"""Plans of patches: neighbours share their edge to the bit, and a plan that cannot be fitted says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core.geometry.hull.fit import Section, knots_at
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
