"""What normalises a case's objectives at a level: the initial design's own numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.evaluation.physics import Basis, basis_for, compute
from hpsop_core.one_thread import one_blas_thread


@dataclass(frozen=True)
class Reference:
    """What a case's objectives are normalised with at a level; computed once, shipped to every worker.

    Attributes:
        level: 1 or 2.
        displaced_volume: V0, the initial design's displacement in m3 (booked with the affine form).
        speeds: the initial design's speeds at the case's Froude numbers, in m/s.
        froude_numbers: the case's.
        wave_calibration: factors on level 1's wave resistance at these Froude numbers; ones at level 2.
        total_resistance, efficiency, delivered_power: the initial design's, one a condition.
    """

    level: int
    displaced_volume: float
    speeds: tuple[float, ...]
    froude_numbers: tuple[float, ...]
    wave_calibration: tuple[float, ...]
    total_resistance: tuple[float, ...]
    efficiency: tuple[float, ...]
    delivered_power: tuple[float, ...]

    def as_dict(self) -> dict[str, Any]:
        """For the run file."""
        return {key: list(v) if isinstance(v, tuple) else v for key, v in asdict(self).items()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Reference:
        """The reference that ``as_dict`` described, to the last bit."""
        values: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in data.items()}
        return cls(**values)

    @property
    def basis(self) -> Basis:
        """The part that a design's physics takes from the initial design."""
        return Basis(self.displaced_volume, self.speeds, self.froude_numbers, self.wave_calibration)


@one_blas_thread()
def reference_for(case: Case, level: int) -> Reference:
    """The initial design's numbers at a level, and level 1's wave calibration.

    Raises:
        SolverFailure: the initial design itself cannot be computed at this level.
    """
    basis = basis_for(case, level)
    conditions = compute(case, case.initial.variables, level, basis).conditions
    return Reference(
        level=level,
        displaced_volume=basis.displaced_volume,
        speeds=basis.speeds,
        froude_numbers=basis.froude_numbers,
        wave_calibration=basis.wave_calibration,
        total_resistance=tuple(condition.total_resistance for condition in conditions),
        efficiency=tuple(condition.open_water_efficiency for condition in conditions),
        delivered_power=tuple(condition.delivered_power for condition in conditions),
    )
