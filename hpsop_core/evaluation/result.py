"""What an evaluation gives: one frozen value with everything that is known of a design at a level.

It is ``Ok``, with every number, or ``Failed``, with the stage and the reason; nothing here ever holds a NaN. Type
checkers know which it is after ``if evaluation.ok:``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Literal, TypeAlias

from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.design_numbers import ConditionResult, HullResult, PropellerResult
from hpsop_core.case.variables import DesignSpace, DesignVariables


@dataclass(frozen=True)
class OpenWaterCurve:
    """Open-water curves at full scale; four tuples of the same length. The efficiency is 0 where there is no thrust."""

    advance_coefficient: tuple[float, ...]
    thrust_coefficient: tuple[float, ...]
    torque_coefficient: tuple[float, ...]
    open_water_efficiency: tuple[float, ...]


@dataclass(frozen=True)
class Ok:
    """A design at a level, computed.

    Attributes:
        case: the case's name.
        level: 1 or 2.
        variables: the design.
        hull, propeller, open_water: its main figures and curves.
        conditions: one an operating condition.
        objectives: {"f1", "f2"}: the case's two, normalised by the initial design at this level.
        all_objectives: every objective by its name (see ``case.objectives``).
        constraints: g <= 0 by name (see ``case.constraints``), None where it is not applied.
        feasible: every constraint is kept.
        warnings: for people.
        active_bounds: "lower" or "upper" by the name of each variable that stands on a bound of the case.
        fuel_per_hour, carbon_dioxide_per_hour: over the operating profile, in kg/h; None without an engine's
            consumption.
        attained_eedi_g_per_tonne_mile: grams of CO2 per tonne and nautical mile; None where it is not known.
        errors: half width of the 90 % interval by the name of a quantity, where it is known.
        comparison_errors: the same for the quantity's ratio to the initial design's, as a fraction of it, without what
            all designs share: what decides whether two designs can be told apart.
        error_terms: what ``errors`` consists of, for the main quantities: half widths by quantity, by term.
        errors_source: "solved": from this design's own solutions (``evaluation.errors``); "stated": typical ones
            (``evaluation.stated_errors``); "" where there are none.
        elapsed: wall time in s; the only field that differs from run to run.
        predicted: waves and open-water curve are a learnt surface's (``evaluation.surface``), not the solvers'.
        propeller_tabulated: the open-water curve comes from a search's table (``evaluation.propeller_tables``).
    """

    ok: ClassVar[Literal[True]] = True
    status: ClassVar[str] = "ok"
    stage: ClassVar[str] = ""
    reason: ClassVar[str] = ""

    case: str
    level: int
    variables: DesignVariables
    hull: HullResult
    propeller: PropellerResult
    conditions: tuple[ConditionResult, ...]
    objectives: Mapping[str, float]
    all_objectives: Mapping[str, float]
    constraints: Mapping[str, float | None]
    feasible: bool
    warnings: tuple[str, ...]
    open_water: OpenWaterCurve
    active_bounds: Mapping[str, str] = field(default_factory=dict)
    fuel_per_hour: float | None = None
    carbon_dioxide_per_hour: float | None = None
    attained_eedi_g_per_tonne_mile: float | None = None
    errors: Mapping[str, float] = field(default_factory=dict)
    comparison_errors: Mapping[str, float] = field(default_factory=dict)
    error_terms: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    errors_source: str = ""
    elapsed: float = 0.0
    predicted: bool = False
    propeller_tabulated: bool = False

    def as_dict(self) -> dict[str, Any]:
        """The JSON document of ``hpsop evaluate --json``."""
        hull = _flat(self.hull)
        if self.hull.booked_volume is None:
            del hull["booked_block_coefficient"], hull["booked_volume"]
        return {
            "case": self.case,
            "level": self.level,
            "status": self.status,
            "reason": self.reason,
            "variables": self.variables.as_dict(),
            "hull": hull,
            "propeller": _flat(self.propeller),
            "conditions": [_flat(condition) for condition in self.conditions],
            "objectives": dict(self.objectives),
            "all_objectives": dict(self.all_objectives),
            "constraints": dict(self.constraints),
            "feasible": self.feasible,
            "warnings": list(self.warnings),
            "open_water": {key: list(values) for key, values in _flat(self.open_water).items()},
            "active_bounds": dict(self.active_bounds),
            **{name: getattr(self, name) for name in _PROFILE},
            "errors": dict(self.errors),
            "comparison_errors": dict(self.comparison_errors),
            "error_terms": {term: dict(widths) for term, widths in self.error_terms.items()},
            "errors_source": self.errors_source,
            "elapsed": self.elapsed,
            "stage": self.stage,
            "predicted": self.predicted,
            "propeller_tabulated": self.propeller_tabulated,
        }


def _flat(value: Any) -> dict[str, Any]:
    """As ``dataclasses.asdict`` of a dataclass of plain values, in a tenth of its time: it copies nothing."""
    return {name: getattr(value, name) for name in _NAMES[type(value)]}


_FLAT: tuple[type[Any], ...] = (HullResult, PropellerResult, ConditionResult, OpenWaterCurve)
_NAMES = {kind: tuple(item.name for item in fields(kind)) for kind in _FLAT}
_NAME_SETS = {kind: frozenset(names) for kind, names in _NAMES.items()}


_PROFILE = ("fuel_per_hour", "carbon_dioxide_per_hour", "attained_eedi_g_per_tonne_mile")


@dataclass(frozen=True)
class Failed:
    """A design at a level that could not be computed.

    Attributes:
        case: the case's name.
        level: 1 or 2.
        variables: the design.
        stage: where it failed ("hull", "rankine", "lifting_line", "operating_point", ...).
        reason: why it failed.
        elapsed: wall time in s.

    It has no objectives (None), no constraints that apply, no conditions, and is never feasible.
    """

    ok: ClassVar[Literal[False]] = False
    status: ClassVar[str] = "failed"
    feasible: ClassVar[bool] = False
    conditions: ClassVar[tuple[ConditionResult, ...]] = ()
    warnings: ClassVar[tuple[str, ...]] = ()
    predicted: ClassVar[bool] = False
    propeller_tabulated: ClassVar[bool] = False
    objectives: ClassVar[Mapping[str, float | None]] = {"f1": None, "f2": None}
    all_objectives: ClassVar[Mapping[str, float]] = {}
    constraints: ClassVar[Mapping[str, float | None]] = {constraint.name: None for constraint in CONSTRAINTS}
    active_bounds: ClassVar[Mapping[str, str]] = {}
    fuel_per_hour: ClassVar[None] = None
    carbon_dioxide_per_hour: ClassVar[None] = None
    attained_eedi_g_per_tonne_mile: ClassVar[None] = None
    errors: ClassVar[Mapping[str, float]] = {}
    comparison_errors: ClassVar[Mapping[str, float]] = {}
    error_terms: ClassVar[Mapping[str, Mapping[str, float]]] = {}
    errors_source: ClassVar[str] = ""

    case: str
    level: int
    variables: DesignVariables
    stage: str
    reason: str
    elapsed: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """The JSON document of ``hpsop evaluate --json``."""
        return {
            "case": self.case,
            "level": self.level,
            "status": self.status,
            "reason": self.reason,
            "variables": self.variables.as_dict(),
            "hull": None,
            "propeller": None,
            "conditions": [],
            "objectives": dict(self.objectives),
            "all_objectives": {},
            "constraints": dict(self.constraints),
            "feasible": self.feasible,
            "warnings": [],
            "open_water": None,
            "active_bounds": {},
            **dict.fromkeys(_PROFILE),
            "errors": {},
            "comparison_errors": {},
            "error_terms": {},
            "errors_source": "",
            "elapsed": self.elapsed,
            "stage": self.stage,
            "predicted": self.predicted,
            "propeller_tabulated": self.propeller_tabulated,
        }


Evaluation: TypeAlias = Ok | Failed


def evaluation_from_dict(data: Mapping[str, Any], bounds: DesignSpace | None = None) -> Evaluation:
    """The evaluation that ``as_dict`` described, to the last bit; keys that this version does not know are left.

    Args:
        data: the document.
        bounds: of the case; given, they say which of them the design stands on, whatever the document says.
    """
    variables = DesignVariables.from_dict(data["variables"])
    if data["status"] != "ok":
        stage = data.get("stage", "")
        return Failed(data["case"], data["level"], variables, stage, data["reason"], data.get("elapsed", 0.0))
    curves = {key: tuple(column) for key, column in _known(OpenWaterCurve, data["open_water"]).items()}
    return Ok(
        case=data["case"],
        level=data["level"],
        variables=variables,
        hull=HullResult(**_known(HullResult, data["hull"])),
        propeller=PropellerResult(**_known(PropellerResult, data["propeller"])),
        conditions=tuple(ConditionResult(**_known(ConditionResult, _lifted(item))) for item in data["conditions"]),
        objectives=data["objectives"],
        all_objectives=data.get("all_objectives", {}),
        constraints=data["constraints"],
        feasible=data["feasible"],
        warnings=tuple(data.get("warnings", ())),
        open_water=OpenWaterCurve(**curves),
        active_bounds=data.get("active_bounds", {}) if bounds is None else bounds.active(variables),
        **{name: data.get(name) for name in _PROFILE},
        errors=data.get("errors", {}),
        comparison_errors=data.get("comparison_errors", {}),
        error_terms=data.get("error_terms", {}),
        errors_source=data.get("errors_source", ""),
        elapsed=data.get("elapsed", 0.0),
        predicted=data.get("predicted", False),
        propeller_tabulated=data.get("propeller_tabulated", False),
    )


def _lifted(condition: Mapping[str, Any]) -> Mapping[str, Any]:
    """A condition with what earlier versions did not write down: they knew no allowances, margins or losses."""
    if "form_resistance" in condition:
        return condition
    total = condition["total_resistance"]
    effective = total * condition["speed"]
    return {
        "form_resistance": total - condition["friction_resistance"] - condition["wave_resistance"],
        "correlation_resistance": 0.0,
        "air_resistance": 0.0,
        "appendage_resistance": 0.0,
        "effective_power": effective,
        "hull_efficiency": (1.0 - condition["thrust_deduction"]) / (1.0 - condition["wake_fraction"]),
        "propulsive_efficiency": effective / condition["delivered_power"],
        "brake_power": condition["delivered_power"],
        **condition,
    }


def _known(kind: type[Any], data: Mapping[str, Any]) -> dict[str, Any]:
    known = _NAME_SETS[kind]
    return {name: value for name, value in data.items() if name in known}
