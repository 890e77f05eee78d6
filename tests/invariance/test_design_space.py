"""The design space: decoding, encoding, equal shares of the blade counts, round trips of cases."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from hpsop_core.case.case import SHIPPED_CASES, case_from_toml, load_case
from hpsop_core.case.variables import VARIABLE_NAMES, DesignSpace, DesignVariables
from hpsop_core.errors import InputError
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)


@pytest.mark.parametrize("name", SHIPPED_CASES)
def test_a_case_survives_its_own_toml(name: str) -> None:
    case = load_case(name)
    assert case_from_toml(case.to_toml(), "again.toml") == case
    changed = case.replaced("optimization", seed=7, population=8).with_bounds({"draft": (14.1, 14.1)})
    assert case_from_toml(changed.to_toml(), "again.toml") == changed != case


def test_decode_and_encode_are_inverse() -> None:
    space = CASE.bounds
    rng = np.random.default_rng(3)
    for _ in range(100):
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
