"""The even Latin hypercube is SciPy's to the bit, sample after sample."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from hpsop_core.optimization.sampling import _CentredDiscrepancy, _even_cube


@pytest.mark.parametrize(("count", "dimension"), [(1, 9), (2, 2), (3, 2), (10, 1), (10, 9), (16, 5)])
def test_the_same_sample_as_scipy_optimised(count: int, dimension: int) -> None:
    for seed in (1, 20261127):
        optimization = "random-cd" if count > 1 else None
        engine = qmc.LatinHypercube(dimension, optimization=optimization, rng=np.random.default_rng(seed))
        assert np.array_equal(_even_cube(count, dimension, seed), engine.random(count))


def test_the_discrepancy_that_it_minds_is_scipys() -> None:
    sample = np.random.default_rng(3).uniform(size=(30, 6))
    spread = _CentredDiscrepancy(sample)
    assert spread._value == pytest.approx(qmc.discrepancy(sample), rel=1e-13)
    done = sum(spread.exchange(one, one + 7, one % 6) for one in range(23))
    # What one exchange after the other is said to gain is what the whole sample gains.
    assert done > 3
    assert spread._value == pytest.approx(qmc.discrepancy(spread.sample), rel=1e-12)
    assert qmc.discrepancy(spread.sample) < qmc.discrepancy(sample)
