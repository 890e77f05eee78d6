"""The design space: decoding, encoding, equal shares of the blade counts, a block coefficient searched, round trips."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from scipy.stats import qmc

from hpsop_core.case.case import SHIPPED_CASES, Case, case_from_toml, load_case
from hpsop_core.case.variables import VARIABLE_NAMES, DesignSpace, DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.shapes import design_hull
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)
RECOMMENDED = load_case("dtc-p4119").with_bounds({"block_coefficient_ratio": (0.9, 1.1)})
BY_BLOCK = CASE.with_bounds({"block_coefficient_ratio": (0.9, 1.1)})


@pytest.mark.parametrize("name", SHIPPED_CASES)
def test_a_case_survives_its_own_toml(name: str) -> None:
    case = load_case(name)
    assert case_from_toml(case.to_toml(), "again.toml") == case
    changed = case.replaced("optimization", seed=7, population=8).with_bounds({"draft": (14.1, 14.1)})
    assert case_from_toml(changed.to_toml(), "again.toml") == changed != case


@pytest.mark.parametrize("case", [CASE, BY_BLOCK, RECOMMENDED], ids=["displacement", "block", "recommended"])
def test_decode_and_encode_are_inverse(case: Case) -> None:
    space = case.bounds
    assert space.project(case.initial.variables) == case.initial.variables
    rng = np.random.default_rng(3)
    for _ in range(400):
        design = space.decode(rng.uniform(space.relaxed_lower, space.relaxed_upper))
        assert space.project(design) == design
        assert space.decode(space.encode(design)) == design
        assert DesignVariables.from_dict(design.as_dict()) == design


def test_equal_bounds_fix_a_variable() -> None:
    space = CASE.with_bounds({"draft": (14.2, 14.2), "blade_count": (5, 5)}).bounds
    assert len(space.free) == len(CASE.bounds.free) - 2
    assert space.blade_count_position is None
    design = space.decode(space.relaxed_upper)
    assert design.draft == 14.2
    assert design.blade_count == 5


def test_every_blade_count_has_an_equal_share() -> None:
    space = CASE.bounds
    position = space.blade_count_position
    assert position is not None
    vector = 0.5 * (space.relaxed_lower + space.relaxed_upper)
    counts: Counter[int] = Counter()
    for value in np.linspace(space.relaxed_lower[position], space.relaxed_upper[position], 1000, endpoint=False):
        vector[position] = value
        counts[space.decode(vector).blade_count] += 1
    assert set(counts) == {3, 4, 5, 6, 7}
    assert all(abs(count - 200) <= 1 for count in counts.values())  # 1000 equal steps over five counts


def test_projection_moves_only_what_is_outside() -> None:
    initial = CASE.initial.variables
    space = CASE.with_bounds({"diameter": (8.0, 8.8), "blade_count": (4, 6)}).bounds
    projected = space.project(initial)
    assert (projected.diameter, projected.blade_count) == (8.8, 4)
    assert projected.draft == initial.draft
    assert CASE.bounds.project(initial) == initial


@pytest.mark.parametrize(
    "bounds", [{"draft": (14.5, 14.0)}, {"draft": (float("nan"), 14.0)}, {"blade_count": (3, 4.5)}, {"drafft": (1, 2)}]
)
def test_bad_bounds_are_refused(bounds: dict[str, tuple[float, float]]) -> None:
    with pytest.raises(InputError):
        DesignSpace.from_bounds({**CASE.bounds.as_dict(), **bounds})


def test_a_vector_that_is_no_design_is_refused() -> None:
    space = CASE.bounds
    with pytest.raises(ValueError, match="free variables"):
        space.decode([1.0])
    with pytest.raises(ValueError, match="finite"):
        space.decode(np.full(len(space.free), np.nan))
    assert len(VARIABLE_NAMES) == len(space.lower) == 9


def test_a_block_coefficient_that_is_searched_is_the_hull_s_own() -> None:
    """Held against the volume of the hull that is made, which knows nothing of the ratio."""
    space = RECOMMENDED.bounds
    own = design_hull(RECOMMENDED, RECOMMENDED.initial.variables).hydrostatics.block_coefficient
    middle = 0.5 * (space.relaxed_lower + space.relaxed_upper)
    for ratio, length, draft in ((0.93, 6.6, 13.6), (1.0, 7.5, 14.9), (1.07, 6.9, 14.2)):
        asked = {"block_coefficient_ratio": ratio, "length_to_breadth": length, "draft": draft}
        design = space.decode([asked.get(space.names[i], value) for i, value in zip(space.free, middle, strict=True)])
        hull = design_hull(RECOMMENDED, design)
        assert hull.hydrostatics.block_coefficient / own == pytest.approx(ratio, rel=1e-9)
        assert space.values(design)["block_coefficient_ratio"] == pytest.approx(ratio, rel=1e-15)
        assert (hull.length / hull.breadth, hull.draft) == (pytest.approx(length), draft)
    assert space.active(space.decode(space.relaxed_lower))["block_coefficient_ratio"] == "lower"


@pytest.mark.parametrize("name", ["dtc-p4119", "dtc-p4119-power"])
def test_the_form_carries_what_the_recommended_cases_sample(name: str) -> None:
    case = load_case(name)
    lower, upper = case.bounds.relaxed_lower, case.bounds.relaxed_upper
    points = qmc.Sobol(len(case.bounds.free), scramble=False).random(128)
    designs = [case.bounds.decode(lower + point * (upper - lower)) for point in points]
    assert sum(design_hull(case, design).clipped for design in designs) <= 2


def test_bounds_of_a_block_coefficient_take_the_place_of_the_displacement_s() -> None:
    assert "displacement_ratio" not in BY_BLOCK.bounds.as_dict()
    assert BY_BLOCK.bounds.free == CASE.bounds.free
    assert BY_BLOCK.with_bounds({"draft": (14.1, 14.4)}).bounds.names == BY_BLOCK.bounds.names
    assert BY_BLOCK.with_bounds({"displacement_ratio": (0.95, 1.05)}) == CASE
    assert case_from_toml(BY_BLOCK.to_toml(), "again.toml") == BY_BLOCK
    both = CASE.to_toml().replace("[bounds]", "[bounds]\nblock_coefficient_ratio = [0.9, 1.1]")
    with pytest.raises(InputError, match="displacement_ratio and block_coefficient_ratio are both given; keep one"):
        case_from_toml(both, "both.toml")
    # another initial design is what the ratio then refers to
    longer = BY_BLOCK.replaced("initial", length=360.0)
    assert longer.bounds.values(longer.initial.variables)["block_coefficient_ratio"] == 1.0


def test_what_a_case_searches_stays_where_a_design_is_changed() -> None:
    initial = CASE.initial.variables
    assert CASE.design({}) == BY_BLOCK.design({}) == initial
    longer = 1.05 * initial.length_to_breadth
    # at this CB 5 % of length are 5 % of displacement
    assert CASE.design({"length_to_breadth": longer}).displacement_ratio == 1.0
    assert BY_BLOCK.design({"length_to_breadth": longer}).displacement_ratio == pytest.approx(1.05)
    for case in (CASE, BY_BLOCK):
        either = case.design({"length_to_breadth": longer, "block_coefficient_ratio": 1.02})
        assert either.displacement_ratio == pytest.approx(1.05 * 1.02)
        assert case.design({"length_to_breadth": longer, "displacement_ratio": 1.01}).displacement_ratio == 1.01
        with pytest.raises(InputError, match="both given"):
            case.design({"block_coefficient_ratio": 1.0, "displacement_ratio": 1.0})
    with pytest.raises(InputError, match="did you mean 'block_coefficient_ratio'"):
        CASE.design({"block_coeficient_ratio": 1.0})
    with pytest.raises(InputError, match=r"block_coefficient_ratio: 2 is outside its limits"):
        CASE.design({"block_coefficient_ratio": 2})


def test_dimensions_far_from_the_initial_ones_still_name_a_design() -> None:
    """A displacement that follows is a number that a run file takes back: it ends at the variable's own limits."""
    far = BY_BLOCK.with_bounds({"breadth_to_draft": (1.5, 8.0), "length_to_breadth": (3.0, 15.0), "draft": (3.0, 40.0)})
    for vector in (far.bounds.relaxed_lower, far.bounds.relaxed_upper):
        design = far.bounds.decode(vector)
        assert DesignVariables.from_dict(design.as_dict()) == design
        assert far.bounds.decode(far.bounds.encode(design)) == design
