"""What normalises a case's objectives at a level: the initial design's own numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.case.design_numbers import ConditionResult, DesignNumbers, InitialNumbers
from hpsop_core.evaluation.hull_propulsion import HoltropNumbers
from hpsop_core.evaluation.levels import FAST
from hpsop_core.evaluation.physics import Basis, basis_for, compute
from hpsop_core.evaluation.propeller_tables import PropellerTables, tables_for
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.evaluation.ship import check_engine, check_loading
from hpsop_core.evaluation.surface import Surface, learn
from hpsop_core.evaluation.wave_correction import WaveCorrection
from hpsop_core.one_thread import one_blas_thread


@dataclass(frozen=True)
class Reference:
    """What a case's objectives are normalised with at a level; computed once, shipped to every worker.

    Attributes:
        level: 1 or 2.
        basis: what every design's physics takes from the initial design.
        initial: the initial design's numbers.
        surface: what has been learnt, to be asked before the solvers; never part of ``as_dict``.
        propellers: likewise at level 1, to be asked before the lifting line.
    """

    level: int
    basis: Basis
    initial: InitialNumbers
    surface: Surface | None = None
    propellers: PropellerTables | None = None

    def as_dict(self) -> dict[str, Any]:
        """For the run file."""
        basis = {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self.basis).items()}
        conditions = {name: list(values) for name, values in self.initial.conditions.items()}
        return {"level": self.level, **basis, "conditions": conditions, "hull": dict(self.initial.hull)}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Reference:
        """The reference that ``as_dict`` described, to the last bit.

        A file of schema 2 kept three of the numbers; an objective that needs another one has no value there.
        """
        columns = data.get("conditions")
        if columns is None:
            columns = {name: data[old] for old, name in _SCHEMA_2.items()}
        stored = {item.name: data[item.name] for item in fields(Basis) if item.name in data}
        if stored.get("holtrop") is not None:
            holtrop = stored["holtrop"]
            stored["holtrop"] = HoltropNumbers(**{**holtrop, "wake_fractions": tuple(holtrop["wake_fractions"])})
        if stored.get("correction") is not None:
            stored["correction"] = WaveCorrection.from_dict(stored["correction"])
        basis: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in stored.items()}
        return cls(
            level=data["level"],
            basis=Basis(**basis),
            initial=InitialNumbers(
                displaced_volume=data["displaced_volume"],
                conditions={name: tuple(values) for name, values in columns.items()},
                hull=dict(data.get("hull", {})),
            ),
        )


_SCHEMA_2 = {
    "total_resistance": "total_resistance",
    "efficiency": "open_water_efficiency",
    "delivered_power": "delivered_power",
}


@one_blas_thread()
def reference_for(case: Case, level: int) -> Reference:
    """The initial design's numbers at a level, and level 1's wave calibration.

    Raises:
        SolverFailure: the initial design itself cannot be computed at this level.
        InputError: it would not float upright, or the engine is smaller than any design needs.
    """
    check_loading(case, design_hull(case, case.initial.variables))
    basis = basis_for(case, level)
    numbers = compute(case, case.initial.variables, level, basis).numbers
    check_engine(case, numbers)
    return Reference(level, basis, initial_numbers(basis.displaced_volume, numbers))


def searching(case: Case, reference: Reference) -> Reference:
    """A reference as a search uses it: at level 1 with tables of the propellers, where they are worth making."""
    return replace(reference, propellers=tables_for(case)) if reference.level == FAST.number else reference


def learnt(
    case: Case, reference: Reference, evaluations: Sequence[Mapping[str, Any]], fast: Reference | None = None
) -> tuple[Reference, Mapping[str, float]]:
    """The reference with a surface learnt from solved designs, and the surface's error; without where they are too few.

    Args:
        case: what is optimised.
        reference: of the true level.
        evaluations: as ``surface.learn`` takes them.
        fast: level 1's, where there is one: the hulls that taught it are learnt from too.
    """
    correction = None if fast is None else fast.basis.correction
    surface = learn(case, evaluations, () if correction is None else correction.solved_hulls())
    if surface is None:
        return replace(reference, surface=None), {}
    return replace(reference, surface=surface), asdict(surface.held_out)


def initial_numbers(volume: float, design: DesignNumbers) -> InitialNumbers:
    """What of the initial design normalises others; ``volume``: V0 in m3."""
    columns = {
        item.name: tuple(getattr(condition, item.name) for condition in design.conditions)
        for item in fields(ConditionResult)
    }
    return InitialNumbers(
        displaced_volume=volume,
        conditions={name: values for name, values in columns.items() if None not in values},
        hull={
            name: value
            for name, value in asdict(design.hull).items()
            if value is not None and not isinstance(value, bool)
        },
    )
