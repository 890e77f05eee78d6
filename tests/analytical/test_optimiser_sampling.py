"""The initial sample: a Latin hypercube in the strict sense, fair to every blade count."""

from __future__ import annotations

import numpy as np
import pytest

from hpsop_core.case.case import load_case
from hpsop_core.optimization.sampling import derived_seed, latin_hypercube


@pytest.fixture(scope="module")
def space():
    return load_case("dtc-p4119-paper").bounds


def test_every_interval_of_every_variable_holds_one_sample(space) -> None:
    count = 50
    sample = latin_hypercube(space, count, 4)
    lower, upper = space.relaxed_lower, space.relaxed_upper
    strata = np.floor((sample - lower) / (upper - lower) * count).astype(int)
    for column in strata.T:
        assert sorted(column) == list(range(count))


def test_every_blade_count_has_its_equal_share(space) -> None:
    designs = [space.decode(vector) for vector in latin_hypercube(space, 50, 11)]
    counts = {blades: sum(design.blade_count == blades for design in designs) for blades in range(3, 8)}
    assert counts == {3: 10, 4: 10, 5: 10, 6: 10, 7: 10}


def test_samples_stay_inside_and_depend_on_the_seed_alone(space) -> None:
    sample = latin_hypercube(space, 30, 1)
    assert np.all(sample >= space.relaxed_lower) and np.all(sample <= space.relaxed_upper)
    np.random.seed(5)  # the global generator must not matter
    assert np.array_equal(sample, latin_hypercube(space, 30, 1))
    assert not np.array_equal(sample, latin_hypercube(space, 30, 2))
    assert latin_hypercube(space, 0, 1).shape == (0, len(space.free))
    assert latin_hypercube(space, 1, 1).shape == (1, len(space.free))


def test_seeds_for_different_purposes_differ() -> None:
    seeds = {derived_seed(seed, level, purpose) for seed in range(20) for level in (1, 2) for purpose in (0, 1)}
    assert len(seeds) == 80
