"""The objectives: every one is minimised and normalised by the initial design at the same level."""

from __future__ import annotations

import math

from hpsop_core.evaluation.physics import Physics
from hpsop_core.evaluation.reference import Reference


def objective_values(basis: Reference, physics: Physics) -> dict[str, float]:
    """Every objective, all minimised, 1 for the initial design (the cavitation margin aside)."""
    conditions = physics.conditions
    first = conditions[0]
    area_ratio = physics.propeller.expanded_area_ratio
    return {
        "resistance": math.fsum(
            c.weight * c.total_resistance / r for c, r in zip(conditions, basis.total_resistance, strict=True)
        ),
        "efficiency": math.fsum(
            c.weight * e / c.open_water_efficiency for c, e in zip(conditions, basis.efficiency, strict=True)
        ),
        "delivered_power": math.fsum(
            c.weight * c.delivered_power / p for c, p in zip(conditions, basis.delivered_power, strict=True)
        ),
        "displacement": basis.displaced_volume / physics.effective_volume,
        "cavitation_margin": 1.0 - (area_ratio - first.required_expanded_area_ratio) / area_ratio,
    }
