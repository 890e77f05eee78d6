"""The design of experiments: Latin hypercube samples over the free variables, and the seeds of a run."""

from __future__ import annotations

import numpy as np

from hpsop_core.case.variables import DesignSpace
from hpsop_core.typing_aliases import Array


def derived_seed(seed: int, *purpose: int) -> int:
    """An independent seed for one purpose of a run, the same on every machine.

    Args:
        seed: the run's seed.
        purpose: small integers that name the purpose, for example (level, 0) for a level's sample.
    """
    return int(np.random.SeedSequence(seed, spawn_key=purpose).generate_state(1, np.uint32)[0])


def latin_hypercube(space: DesignSpace, count: int, seed: int) -> Array:
    """A Latin hypercube with small centred discrepancy over the relaxed box of the free variables.

    The blade count is sampled on [Z_lower - 1/2, Z_upper + 1/2): rounding a sample on [3, 7] would give the two end
    values half of their share, this gives every value the same.

    Args:
        space: the design space.
        count: number of samples.
        seed: of the sample.

    Returns:
        Vectors over the free variables, shape (count, free).
    """
    from scipy.stats import qmc  # a slow import that only the beginning of a level needs

    free = len(space.free)
    if count == 0:
        return np.zeros((0, free))
    sampler = qmc.LatinHypercube(free, optimization="random-cd" if count > 1 else None, rng=np.random.default_rng(seed))
    lower, upper = space.relaxed_lower, space.relaxed_upper
    # lower + u (upper - lower) may round up to the open end of the blade count's interval; no sample may leave the box.
    sample: Array = np.clip(lower + sampler.random(count) * (upper - lower), lower, upper)
    return sample
