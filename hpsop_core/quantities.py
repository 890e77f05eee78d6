"""Every number of a design that page and report show: its name as naval architects write it, its unit, its digits.

Tables, tooltips, parallel coordinates and correlations all draw from this one list, so a number looks the same wherever
it stands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hpsop_core.case import constraints
from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.declared_variable import Variable
from hpsop_core.case.objectives import objective_named
from hpsop_core.case.variables import VARIABLE_TABLE, DesignVariables
from hpsop_core.evaluation.result import Evaluation

CONSTRAINT_GROUP = "Constraints (feasible ≤ 0)"


@dataclass(frozen=True)
class Quantity:
    """One number of a design.

    Attributes:
        key: unique, for state and events.
        label: what it is, short.
        symbol: what follows an underscore is its subscript.
        unit: of the shown value.
        decimals: digits after the point.
        value: from an evaluation, already in ``unit``; None where it does not exist.
        group: heading in tables.
        better: -1 when smaller is better, +1 when larger is, 0 when neither.
    """

    key: str
    label: str
    symbol: str
    unit: str
    decimals: int
    value: Callable[[Evaluation], float | None]
    group: str
    better: int = 0

    def text(self, evaluation: Evaluation) -> str:
        """The number without unit, or a dash."""
        return number_text(self.value(evaluation), self.decimals)

    def title(self) -> str:
        """Symbol and unit, for an axis."""
        return f"{self.symbol} [{self.unit or '–'}]"


def number_text(value: float | None, decimals: int) -> str:
    """Fixed decimals, a true minus, a space between thousands; a dash for nothing."""
    if value is None or not math.isfinite(value):
        return "–"
    text = f"{value:,.{decimals}f}".replace(",", " ").replace("-", "−")
    return text.replace("−", "", 1) if not text.strip("−0. ") else text


def change_text(initial: float | None, selected: float | None, decimals: int, relative: bool = True) -> str:
    """The change from the initial design: percent, or the plain difference where percent means nothing."""
    if initial is None or selected is None:
        return "–"
    difference = selected - initial
    if not relative or abs(initial) < 1e-12:
        text = number_text(difference, decimals)
        return text if difference <= 0 or text.strip("0.") == "" else f"+{text}"
    percent = 100.0 * difference / abs(initial)
    text = number_text(percent, 1)
    return f"{'+' if percent > 0 and text.strip('0.') else ''}{text} %"


def _variable(item: Variable) -> Callable[[Evaluation], float | None]:
    return lambda evaluation: item.shown(float(getattr(evaluation.variables, item.name)))


def _hull(name: str, scale: float = 1.0) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        value = getattr(evaluation.hull, name) if evaluation.ok else None
        return None if value is None else float(value) * scale

    return get


def _profile(name: str, scale: float) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        value = getattr(evaluation, name)
        return None if value is None else float(value) * scale

    return get


def _propeller(name: str) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        value = getattr(evaluation.propeller, name) if evaluation.ok else None
        return None if value is None else float(value)

    return get


def _condition(index: int, name: str, scale: float = 1.0) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        if index >= len(evaluation.conditions):
            return None
        value = getattr(evaluation.conditions[index], name)
        if value is None or (value == 0.0 and name in _PARTS):
            return None
        return float(value) * scale

    return get


def _objective(name: str) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        value = evaluation.objectives.get(name)
        return None if value is None else float(value)

    return get


def _constraint(name: str) -> Callable[[Evaluation], float | None]:
    def get(evaluation: Evaluation) -> float | None:
        value = evaluation.constraints.get(name)
        return None if value is None else float(value)

    return get


def _diameter_to_draft(evaluation: Evaluation) -> float | None:
    return evaluation.variables.diameter / evaluation.variables.draft


def variable_quantities(initial: DesignVariables) -> tuple[Quantity, ...]:
    """The design variables as declared, lengths with the digits that the initial's size asks for."""
    return tuple(
        Quantity(
            item.name,
            item.label,
            item.symbol,
            item.unit,
            item.decimals_near(value),
            _variable(item),
            "Variables",
        )
        for item, value in zip(VARIABLE_TABLE.values(), initial.key(), strict=True)
    )


def free_variables(case: Case) -> list[Quantity]:
    """The variables that a case does not fix."""
    quantities = variable_quantities(case.initial.variables)
    return [quantities[index] for index in case.bounds.free]


HULL: tuple[Quantity, ...] = (
    Quantity("length", "length between perpendiculars", "L_PP", "m", 2, _hull("length"), "Hull"),
    Quantity("breadth", "breadth", "B", "m", 2, _hull("breadth"), "Hull"),
    Quantity("hull_draft", "draft", "d", "m", 2, _hull("draft"), "Hull"),
    Quantity("block_coefficient", "block coefficient", "C_B", "", 4, _hull("block_coefficient"), "Hull"),
    Quantity("displaced_volume", "displaced volume", "∇", "m³", 0, _hull("displaced_volume"), "Hull"),
    Quantity("wetted_surface", "wetted surface", "S", "m²", 0, _hull("wetted_surface"), "Hull"),
    Quantity("lcb", "LCB forward of AP", "LCB", "m", 2, _hull("longitudinal_centre_of_buoyancy"), "Hull"),
    Quantity("booked_cb", "booked block coefficient", "C_B booked", "", 4, _hull("booked_block_coefficient"), "Hull"),
    Quantity("midship_coefficient", "midship coefficient", "C_M", "", 4, _hull("midship_coefficient"), "Hull"),
    Quantity("prismatic_coefficient", "prismatic coefficient", "C_P", "", 4, _hull("prismatic_coefficient"), "Hull"),
    Quantity(
        "waterplane_coefficient", "waterplane coefficient", "C_WP", "", 4, _hull("waterplane_coefficient"), "Hull"
    ),
)

SHIP: tuple[Quantity, ...] = (
    Quantity("displacement_mass", "displacement", "Δ", "t", 0, _hull("displacement_mass", 1e-3), "Ship"),
    Quantity("lightship_mass", "lightship", "Δ_light", "t", 0, _hull("lightship_mass", 1e-3), "Ship"),
    Quantity("deadweight", "deadweight", "DWT", "t", 0, _hull("deadweight", 1e-3), "Ship", 1),
    Quantity("kb", "centre of buoyancy above baseline", "KB", "m", 2, _hull("centre_of_buoyancy_height"), "Ship"),
    Quantity("bm", "metacentric radius", "BM", "m", 2, _hull("metacentric_radius"), "Ship"),
    Quantity("km", "metacentre above baseline", "KM", "m", 2, _hull("metacentre_height"), "Ship"),
    Quantity("kg", "centre of gravity above baseline", "KG", "m", 2, _hull("centre_of_gravity_height"), "Ship"),
    Quantity("gm", "metacentric height", "GM", "m", 2, _hull("metacentric_height"), "Ship"),
    Quantity("fuel_per_hour", "fuel over the profile", "ṁ", "t/h", 3, _profile("fuel_per_hour", 1e-3), "Ship", -1),
    Quantity("carbon_dioxide_per_hour", "CO2 over the profile", "ṁ_CO2", "t/h", 3,
             _profile("carbon_dioxide_per_hour", 1e-3), "Ship", -1),
    Quantity("attained_eedi", "attained EEDI", "EEDI", "g/(t nm)", 2,
             _profile("attained_eedi_g_per_tonne_mile", 1.0), "Ship", -1),
)  # fmt: skip

PROPELLER: tuple[Quantity, ...] = (
    Quantity("propeller_diameter", "diameter", "D", "m", 2, _propeller("diameter"), "Propeller"),
    Quantity("blades", "blades", "Z", "", 0, _propeller("blade_count"), "Propeller"),
    Quantity("pitch_07", "P/D at 0.7 R", "P/D", "", 4, _propeller("pitch_diameter_ratio_07R"), "Propeller"),
    Quantity("area_ratio", "expanded area ratio", "EAR", "", 3, _propeller("expanded_area_ratio"), "Propeller"),
    Quantity("diameter_to_draft", "diameter / draft", "D/d", "", 3, _diameter_to_draft, "Propeller"),
    Quantity("tip_clearance", "tip clearance to the hull", "c_tip", "m", 2, _propeller("tip_clearance"), "Propeller"),
)

OBJECTIVES: tuple[Quantity, ...] = (
    Quantity("f1", "first objective", "f₁", "", 4, _objective("f1"), "Objectives", -1),
    Quantity("f2", "second objective", "f₂", "", 4, _objective("f2"), "Objectives", -1),
)

CONSTRAINTS: tuple[Quantity, ...] = tuple(
    Quantity(f"g_{item.name}", item.label, item.symbol, "", 4, _constraint(item.name), CONSTRAINT_GROUP)
    for item in constraints.CONSTRAINTS
)

# Parts of the resistance that a case does not have would only fill the tables with zeros.
_PARTS = ("form_resistance", "correlation_resistance", "air_resistance", "appendage_resistance")

_CONDITION = (
    ("froude_number", "Froude number", "Fn_", "", 4, 1.0, 0),
    ("speed", "speed", "V_", "kn", 2, 1.0 / KNOT, 0),
    ("total_resistance", "total resistance", "R_T", "kN", 0, 1e-3, -1),
    ("friction_resistance", "friction (ITTC-57)", "R_F", "kN", 0, 1e-3, -1),
    ("form_resistance", "form, k × friction", "R_form", "kN", 0, 1e-3, -1),
    ("wave_resistance", "wave resistance", "R_W", "kN", 0, 1e-3, -1),
    ("correlation_resistance", "correlation allowance", "R_A", "kN", 0, 1e-3, -1),
    ("air_resistance", "air resistance", "R_AA", "kN", 0, 1e-3, -1),
    ("appendage_resistance", "appendages", "R_APP", "kN", 0, 1e-3, -1),
    ("effective_power", "effective power", "P_E", "MW", 2, 1e-6, -1),
    ("thrust", "thrust", "T_", "kN", 0, 1e-3, 0),
    ("torque", "torque", "Q_", "kN m", 0, 1e-3, 0),
    ("wake_fraction", "wake fraction", "w_", "", 3, 1.0, 0),
    ("thrust_deduction", "thrust deduction", "t_", "", 3, 1.0, 0),
    ("advance_coefficient", "advance coefficient", "J_", "", 4, 1.0, 0),
    ("rotation_rate_rpm", "rotation rate", "n_", "rpm", 1, 1.0, 0),
    ("thrust_coefficient", "thrust coefficient", "K_T", "", 4, 1.0, 0),
    ("torque_coefficient", "torque coefficient × 10", "10K_Q", "", 4, 10.0, 0),
    ("open_water_efficiency", "open-water efficiency", "η_0", "", 4, 1.0, 1),
    ("hull_efficiency", "hull efficiency", "η_H", "", 4, 1.0, 1),
    ("relative_rotative_efficiency", "relative rotative efficiency", "η_R", "", 4, 1.0, 1),
    ("propulsive_efficiency", "propulsive efficiency", "η_D", "", 4, 1.0, 1),
    ("delivered_power", "delivered power", "P_D", "MW", 2, 1e-6, -1),
    ("brake_power", "brake power, with sea margin", "P_B", "MW", 2, 1e-6, -1),
    ("engine_load", "engine load", "P_B/MCR", "%", 1, 100.0, 0),
    ("fuel_rate", "fuel", "ṁ_", "t/h", 3, 3.6, -1),
    ("required_expanded_area_ratio", "required EAR", "EAR_req", "", 3, 1.0, 0),
    ("cavitation_number", "cavitation number", "σ_", "", 3, 1.0, 0),
    ("blade_cavitation_margin", "least Cp + σ on the blades (level 2)", "Cp+σ", "", 3, 1.0, 0),
    ("blade_cavitating_share", "back below vapour pressure (level 2)", "A_cav", "%", 1, 100.0, 0),
)


def condition_names(case: Case) -> tuple[str, ...]:
    """What each operating condition is called: by its speed, or by its Froude number where the length decides."""
    if case.conditions.speed == "froude":
        return tuple(f"Fn {froude:g}" for froude in case.froude_numbers)
    return tuple(f"{speed / KNOT:.4g} kn" for speed in case.speeds)


def conditions_of(evaluation: Evaluation) -> tuple[str, ...]:
    """The same for one design: its own speeds."""
    return tuple(f"{condition.speed / KNOT:.4g} kn" for condition in evaluation.conditions)


def condition_quantities(names: Sequence[str]) -> tuple[Quantity, ...]:
    """The numbers of each operating condition, under its name (see ``condition_names``)."""
    made = []
    for index, words in enumerate(names):
        for name, label, symbol, unit, decimals, scale, better in _CONDITION:
            made.append(
                Quantity(
                    f"{name}_{index + 1}",
                    label,
                    f"{symbol}{index + 1}" if "_" in symbol else f"{symbol}_{index + 1}",
                    unit,
                    decimals,
                    _condition(index, name, scale),
                    f"Condition {index + 1}: {words}",
                    better,
                )
            )
    return tuple(made)


def all_quantities(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Everything there is, in the order of the tables; ``names`` of the conditions."""
    return (*OBJECTIVES, *HULL, *SHIP, *PROPELLER, *condition_quantities(names), *CONSTRAINTS)


def objective_title(name: str, symbol: str) -> str:
    """An objective's axis title: f₁ = resistance, Σ w R/R₀ [–]."""
    return f"{symbol} = {objective_named(name).title} [–]"


def violated(evaluation: Evaluation) -> list[str]:
    """Violated constraints in words with their amounts."""
    values = evaluation.constraints
    return [
        f"{item.violated} ({item.symbol}) by {number_text(values[item.name], 4)}"
        for item in constraints.CONSTRAINTS
        if item.is_violated(values.get(item.name))
    ]


def standing_on(evaluation: Evaluation) -> list[str]:
    """Which bounds and limits a design stands on, in words."""
    lines = [f"{VARIABLE_TABLE[name].symbol} on its {side} bound" for name, side in evaluation.active_bounds.items()]
    values = evaluation.constraints
    lines += [
        f"{item.label} ({item.symbol}) at its limit"
        for item in constraints.CONSTRAINTS
        if item.is_active(values.get(item.name)) and not item.is_violated(values.get(item.name))
    ]
    return lines
