"""What an evaluation gives: one frozen value with everything that is known of a design at a level.

A failure is such a value too, with the stage and the reason; nothing here ever holds a NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from hpsop_core.case.variables import DesignVariables

FEASIBILITY_TOLERANCE = 1e-6
# Enters the algorithm in place of the constraints of a failed evaluation: worse than any real violation, yet finite.
FAILED_VIOLATION = 1e3


@dataclass(frozen=True)
class HullResult:
    """The hull's main figures, measured on its geometry.

    Attributes:
        length, breadth, draft: Lpp, B and d in m.
        block_coefficient: CB.
        displaced_volume: in m3.
        wetted_surface: static, in m2.
        longitudinal_centre_of_buoyancy: LCB forward of AP, in m.
        clipped: whether the asked displacement or LCB was more than the parent's form carries.
        booked_block_coefficient, booked_volume: affine form only: what the paper books, not what the geometry has.
    """

    length: float
    breadth: float
    draft: float
    block_coefficient: float
    displaced_volume: float
    wetted_surface: float
    longitudinal_centre_of_buoyancy: float
    clipped: bool = False
    booked_block_coefficient: float | None = None
    booked_volume: float | None = None


@dataclass(frozen=True)
class PropellerResult:
    """The propeller's main figures.

    Attributes:
        diameter: D in m.
        blade_count: Z.
        pitch_ratio: multiplier on the parent's pitch.
        pitch_diameter_ratio_07R: absolute P/D at 0.7 R.
        expanded_area_ratio: EAR.
        shaft_height: above the baseline, in m.
        tip_clearance: least distance of the blade tips' circle from the hull, in m; negative where it cuts the hull.
    """

    diameter: float
    blade_count: int
    pitch_ratio: float
    pitch_diameter_ratio_07R: float  # noqa: N815 - a name of the contract
    expanded_area_ratio: float
    shaft_height: float
    tip_clearance: float


@dataclass(frozen=True)
class ConditionResult:
    """One operating condition of a design.

    Attributes:
        froude_number: V/sqrt(g Lpp) of this design.
        weight: of the condition in the objectives.
        speed: V in m/s.
        friction_resistance: ITTC-57 without form factor, in N.
        wave_resistance: after calibration, in N.
        total_resistance: (1 + k) friction + wave, in N.
        wave_coefficient: wave resistance over 1/2 rho V^2 S.
        wake_fraction, thrust_deduction: w and t.
        advance_coefficient: J where required and available KT meet.
        rotation_rate_rpm: 1/min.
        thrust: T in N; torque: Q in N m.
        thrust_coefficient, torque_coefficient: KT and KQ at J.
        open_water_efficiency: J KT/(2 pi KQ).
        delivered_power: 2 pi n Q in W.
        required_expanded_area_ratio: Keller.
        wave_calibration: the factor on the solver's wave resistance.
        cavitation_number: (P0 + rho g h - Pv)/(1/2 rho (V_A^2 + (0.7 pi n D)^2)).
        reynolds_number_07R: chord Reynolds number at 0.7 R, full scale.
        blade_cavitation_margin: level 2: least Cp + sigma on the blades between hub and 0.9 R, both on the undisturbed
            speed of their radius, blade upwards; negative where the water would evaporate.
        blade_minimum_pressure_coefficient, blade_cavitation_radius_ratio: level 2: Cp and r/R there.
        blade_cavitating_share: level 2: share of the back's area under vapour pressure.
        wave_coefficient_pressure: level 2's cross-check by pressure integration, not calibrated.
        sinkage, trim: level 2: m (positive down) and rad (positive bow down), reported, not fed back.
    """

    froude_number: float
    weight: float
    speed: float
    friction_resistance: float
    wave_resistance: float
    total_resistance: float
    wave_coefficient: float
    wake_fraction: float
    thrust_deduction: float
    advance_coefficient: float
    rotation_rate_rpm: float
    thrust: float
    torque: float
    thrust_coefficient: float
    torque_coefficient: float
    open_water_efficiency: float
    delivered_power: float
    required_expanded_area_ratio: float
    wave_calibration: float = 1.0
    cavitation_number: float | None = None
    reynolds_number_07R: float | None = None  # noqa: N815 - a name of the contract's kind
    wave_coefficient_pressure: float | None = None
    blade_cavitation_margin: float | None = None
    blade_minimum_pressure_coefficient: float | None = None
    blade_cavitation_radius_ratio: float | None = None
    blade_cavitating_share: float | None = None
    sinkage: float | None = None
    trim: float | None = None


@dataclass(frozen=True)
class OpenWaterCurve:
    """Open-water curves at full scale; four tuples of the same length. The efficiency is 0 where there is no thrust."""

    advance_coefficient: tuple[float, ...]
    thrust_coefficient: tuple[float, ...]
    torque_coefficient: tuple[float, ...]
    open_water_efficiency: tuple[float, ...]


@dataclass(frozen=True)
class Evaluation:
    """A design at a level: results, or why there are none.

    Attributes:
        case: the case's name.
        level: 1 or 2.
        status: "ok" or "failed" (a number is missing).
        reason: why it failed, else "".
        stage: where it failed ("hull", "rankine", "lifting_line", "operating_point", ...), else "".
        variables: the design.
        hull, propeller, conditions, open_water: None or empty where the evaluation did not get that far.
        objectives: {"f1", "f2"}: the case's two, normalised by the initial design at this level; None if failed.
        all_objectives: every objective by its name.
        constraints: g <= 0 by name: "displacement" (g1), "diameter_to_draft" (g2), "cavitation" (g3; None where it is
            not applied), "form" (the form carries what is asked), "propeller_clearance" (the blades clear the hull).
        feasible: status ok and every g <= 1e-6.
        warnings: for people.
        elapsed: wall time in s; the only field that differs from run to run.
    """

    case: str
    level: int
    status: str
    reason: str
    variables: DesignVariables
    hull: HullResult | None = None
    propeller: PropellerResult | None = None
    conditions: tuple[ConditionResult, ...] = ()
    objectives: Mapping[str, float | None] = field(default_factory=lambda: {"f1": None, "f2": None})
    all_objectives: Mapping[str, float] = field(default_factory=dict)
    constraints: Mapping[str, float | None] = field(
        default_factory=lambda: {"displacement": None, "diameter_to_draft": None, "cavitation": None}
    )
    feasible: bool = False
    warnings: tuple[str, ...] = ()
    open_water: OpenWaterCurve | None = None
    elapsed: float = 0.0
    stage: str = ""

    @property
    def ok(self) -> bool:
        """Whether every number is there."""
        return self.status == "ok"

    @property
    def violations(self) -> tuple[float, ...]:
        """The constraints that apply, in their order; one large value for a failed evaluation."""
        if not self.ok:
            return (FAILED_VIOLATION,)
        return tuple(value for value in self.constraints.values() if value is not None)

    @property
    def total_violation(self) -> float:
        """sum max(0, g_j) over the constraints that apply."""
        return float(sum(max(0.0, value) for value in self.violations))

    def as_dict(self) -> dict[str, Any]:
        """The JSON of the contract (DESIGN section 4), with a few more keys."""
        result = asdict(self)
        result["variables"] = self.variables.as_dict()
        result["conditions"] = [asdict(condition) for condition in self.conditions]
        result["objectives"] = dict(self.objectives)
        result["all_objectives"] = dict(self.all_objectives)
        result["constraints"] = dict(self.constraints)
        result["warnings"] = list(self.warnings)
        if self.open_water is not None:
            result["open_water"] = {key: list(values) for key, values in asdict(self.open_water).items()}
        if self.hull is not None and self.hull.booked_volume is None:
            del result["hull"]["booked_block_coefficient"], result["hull"]["booked_volume"]
        return result

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Evaluation:
        """The evaluation that ``as_dict`` described, to the last bit; keys that this version does not know are left."""
        values = {item.name: data[item.name] for item in fields(cls) if item.name in data}
        values["variables"] = DesignVariables.from_dict(data["variables"])
        hull, propeller, curves = data.get("hull"), data.get("propeller"), data.get("open_water")
        values["hull"] = HullResult(**_known(HullResult, hull)) if hull else None
        values["propeller"] = PropellerResult(**_known(PropellerResult, propeller)) if propeller else None
        values["conditions"] = tuple(ConditionResult(**_known(ConditionResult, c)) for c in data.get("conditions", ()))
        columns = {key: tuple(column) for key, column in _known(OpenWaterCurve, curves or {}).items()}
        values["open_water"] = OpenWaterCurve(**columns) if columns else None
        values["warnings"] = tuple(data.get("warnings", ()))
        return cls(**values)


def _known(kind: type[Any], data: Mapping[str, Any]) -> dict[str, Any]:
    return {item.name: data[item.name] for item in fields(kind) if item.name in data}


def failed_evaluation(
    case_name: str, variables: DesignVariables, level: int, stage: str, reason: str, elapsed: float = 0.0
) -> Evaluation:
    """The record of an evaluation that could not be finished."""
    return Evaluation(
        case=case_name,
        level=level,
        status="failed",
        reason=reason,
        stage=stage,
        variables=variables,
        elapsed=elapsed,
    )
