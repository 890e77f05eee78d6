"""Every number of a design that page and report show: its name as naval architects write it, its unit, its digits.

Tables, tooltips, parallel coordinates and correlations all draw from this one list, so a number looks the same wherever
it stands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from hpsop_core.case import constraints
from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.declared_variable import Variable
from hpsop_core.case.objectives import objective_named
from hpsop_core.case.variables import SEARCH_TABLE, VARIABLE_NAMES, DesignVariables, value_of
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.units import SHIP_SIZE, Size, number_text, size_of_ship

__all__ = ["number_text"]

CONSTRAINT_GROUP = "Constraints (feasible ≤ 0)"


_CONDITION_GROUP = "Condition"


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
        formula: from other quantities, as the discipline writes it, or words; "" where the label suffices.
        scale: of the shown value over the evaluation's own, whose error stands under ``key``.
    """

    key: str
    label: str
    symbol: str
    unit: str
    decimals: int
    value: Callable[[Evaluation], float | None]
    group: str
    better: int = 0
    formula: str = ""
    scale: float = 1.0

    def half_width(self, evaluation: Evaluation) -> float | None:
        """Of the 90 % interval, in ``unit``; None where no error is stated."""
        width = evaluation.errors.get(self.key)
        return None if width is None else self.scale * width

    def error_text(self, evaluation: Evaluation) -> str:
        """The half width with its sign, at least one digit of it; "" where no error is stated."""
        width = self.half_width(evaluation)
        if width is None or self.value(evaluation) is None:
            return ""
        decimals = self.decimals
        if 0.0 < width < 0.5 * 10.0**-decimals:
            decimals = -math.floor(math.log10(width))
        return f"± {number_text(width, decimals)}"

    def text(self, evaluation: Evaluation) -> str:
        """The number without unit, or a dash."""
        return number_text(self.value(evaluation), self.decimals)

    def title(self) -> str:
        """Symbol and unit, for an axis."""
        return f"{self.symbol} [{self.unit or '–'}]"

    @property
    def condition(self) -> str:
        """The operating condition it is of, in words ("20 kn"); "" for a number of the whole design."""
        return self.group.partition(": ")[2] if self.group.startswith(_CONDITION_GROUP) else ""

    @property
    def place(self) -> str:
        """The same after another word (" at 20 kn"), or ""."""
        return f" at {self.condition}" if self.condition else ""

    def sized(self, size: Size) -> Quantity:
        """The same number in the unit and with the digits of a ship of this size."""
        unit, plain = size.unit(self.unit, self.decimals), self.value
        if (unit.symbol, unit.decimals) == (self.unit, self.decimals):
            return self

        def value(evaluation: Evaluation) -> float | None:
            found = plain(evaluation)
            return None if found is None else unit.factor * found

        return replace(self, unit=unit.symbol, decimals=unit.decimals, value=value, scale=unit.factor * self.scale)


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


def _variable(item: Variable, initial: DesignVariables) -> Callable[[Evaluation], float | None]:
    return lambda evaluation: item.shown(float(value_of(item.name, evaluation.variables, initial)))


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


def _buoyancy_centre(evaluation: Evaluation) -> float | None:
    if not evaluation.ok:
        return None
    hull = evaluation.hull
    return 100.0 * (hull.longitudinal_centre_of_buoyancy / hull.length - 0.5)


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


def variable_quantity(name: str, initial: DesignVariables) -> Quantity:
    """A design variable as declared, a length with the digits that the initial's size asks for."""
    item = SEARCH_TABLE[name]
    return Quantity(
        name,
        item.label,
        item.symbol,
        item.unit,
        item.decimals_near(value_of(name, initial, initial)),
        _variable(item, initial),
        "Variables",
        formula=item.rule.meaning,
    )


def variable_quantities(case: Case) -> tuple[Quantity, ...]:
    """The variables that a case searches, then what follows from them."""
    names = dict.fromkeys((*case.bounds.names, *VARIABLE_NAMES))
    return tuple(variable_quantity(name, case.initial.variables) for name in names)


def free_variables(case: Case) -> list[Quantity]:
    """The variables that a case does not fix."""
    return [variable_quantity(case.bounds.names[index], case.initial.variables) for index in case.bounds.free]


HULL: tuple[Quantity, ...] = (
    Quantity("length", "length between perpendiculars", "L_PP", "m", 2, _hull("length"), "Hull"),
    Quantity("breadth", "breadth", "B", "m", 2, _hull("breadth"), "Hull"),
    Quantity("hull_draft", "draft", "d", "m", 2, _hull("draft"), "Hull"),
    Quantity(
        "block_coefficient",
        "block coefficient",
        "C_B",
        "",
        4,
        _hull("block_coefficient"),
        "Hull",
        formula="∇/(L_PP B d)",
    ),
    Quantity(
        "displaced_volume",
        "displaced volume",
        "∇",
        "m³",
        0,
        _hull("displaced_volume"),
        "Hull",
        formula="moulded, below the draft",
    ),
    Quantity(
        "wetted_surface",
        "wetted surface",
        "S",
        "m²",
        0,
        _hull("wetted_surface"),
        "Hull",
        formula="hull at rest, without appendages",
    ),
    Quantity(
        "lcb",
        "LCB from midship, forward +",
        "LCB",
        "% Lpp",
        2,
        _buoyancy_centre,
        "Hull",
        formula="centre of ∇, in parts of L_PP from its middle",
    ),
    Quantity(
        "booked_cb",
        "booked block coefficient",
        "C_B booked",
        "",
        4,
        _hull("booked_block_coefficient"),
        "Hull",
        formula="affine form only: the block coefficient that is counted",
    ),
    Quantity(
        "midship_coefficient",
        "midship coefficient",
        "C_M",
        "",
        4,
        _hull("midship_coefficient"),
        "Hull",
        formula="A_M / (B d)",
    ),
    Quantity(
        "prismatic_coefficient",
        "prismatic coefficient",
        "C_P",
        "",
        4,
        _hull("prismatic_coefficient"),
        "Hull",
        formula="C_B / C_M",
    ),
    Quantity(
        "waterplane_coefficient",
        "waterplane coefficient",
        "C_WP",
        "",
        4,
        _hull("waterplane_coefficient"),
        "Hull",
        formula="A_WP / (L_PP B)",
    ),
)

SHIP: tuple[Quantity, ...] = (
    Quantity("displacement_mass", "displacement", "Δ", "t", 0, _hull("displacement_mass", 1e-3), "Ship", formula="ρ ∇"),
    Quantity(
        "lightship_mass",
        "lightship",
        "Δ_light",
        "t",
        0,
        _hull("lightship_mass", 1e-3),
        "Ship",
        formula="the case's own, in proportion to L B depth",
    ),
    Quantity("deadweight", "deadweight", "DWT", "t", 0, _hull("deadweight", 1e-3), "Ship", 1, formula="Δ − Δ_light"),
    Quantity(
        "kb",
        "centre of buoyancy above baseline",
        "KB",
        "m",
        2,
        _hull("centre_of_buoyancy_height"),
        "Ship",
        formula="centre of ∇ over the baseline",
    ),
    Quantity("bm", "metacentric radius", "BM", "m", 2, _hull("metacentric_radius"), "Ship", formula="I_T / ∇"),
    Quantity("km", "metacentre above baseline", "KM", "m", 2, _hull("metacentre_height"), "Ship", formula="KB + BM"),
    Quantity(
        "kg",
        "centre of gravity above baseline",
        "KG",
        "m",
        2,
        _hull("centre_of_gravity_height"),
        "Ship",
        formula="the case's own, in proportion to depth",
    ),
    Quantity("gm", "metacentric height", "GM", "m", 2, _hull("metacentric_height"), "Ship", formula="KM − KG"),
    Quantity(
        "fuel_per_hour",
        "fuel over the profile",
        "ṁ",
        "t/h",
        3,
        _profile("fuel_per_hour", 1e-3),
        "Ship",
        -1,
        formula="Σ w ṁ_i over the conditions",
        scale=1e-3,
    ),
    Quantity(
        "carbon_dioxide_per_hour",
        "CO₂ over the profile",
        "ṁ_CO2",
        "t/h",
        3,
        _profile("carbon_dioxide_per_hour", 1e-3),
        "Ship",
        -1,
        formula="C_F ṁ",
        scale=1e-3,
    ),
    Quantity(
        "attained_eedi",
        "attained EEDI",
        "EEDI",
        "g/(t nm)",
        2,
        _profile("attained_eedi_g_per_tonne_mile", 1.0),
        "Ship",
        -1,
        formula="CO2 of main and auxiliary engines at 75 % MCR over capacity × speed",
    ),
)

PROPELLER: tuple[Quantity, ...] = (
    Quantity("propeller_diameter", "diameter", "D", "m", 2, _propeller("diameter"), "Propeller"),
    Quantity("blades", "blades", "Z", "", 0, _propeller("blade_count"), "Propeller"),
    Quantity(
        "pitch_07",
        "P/D at 0.7 R",
        "P/D",
        "",
        4,
        _propeller("pitch_diameter_ratio_07R"),
        "Propeller",
        formula="P_0.7 / D",
    ),
    Quantity(
        "area_ratio",
        "expanded area ratio",
        "EAR",
        "",
        3,
        _propeller("expanded_area_ratio"),
        "Propeller",
        formula="A_E / A_0, A_0 = π D²/4",
    ),
    Quantity("diameter_to_draft", "diameter / draft", "D/d", "", 3, _diameter_to_draft, "Propeller", formula="D/d"),
    Quantity(
        "tip_clearance",
        "tip clearance to the hull",
        "c_tip",
        "m",
        2,
        _propeller("tip_clearance"),
        "Propeller",
        formula="least distance of the tips' circle to the hull",
    ),
)

OBJECTIVES: tuple[Quantity, ...] = (
    Quantity(
        "f1",
        "first objective",
        "f₁",
        "",
        4,
        _objective("f1"),
        "Objectives",
        -1,
        formula="the case's first objective, less is better",
    ),
    Quantity(
        "f2",
        "second objective",
        "f₂",
        "",
        4,
        _objective("f2"),
        "Objectives",
        -1,
        formula="the case's second objective, less is better",
    ),
)

CONSTRAINTS: tuple[Quantity, ...] = tuple(
    Quantity(
        f"g_{item.name}",
        item.label,
        item.symbol,
        "",
        4,
        _constraint(item.name),
        CONSTRAINT_GROUP,
        formula=f"{item.meaning} ({item.applies})".replace("_", " "),
    )
    for item in constraints.CONSTRAINTS
)

# Parts of the resistance that a case does not have would only fill the tables with zeros.
_PARTS = ("form_resistance", "correlation_resistance", "air_resistance", "appendage_resistance")

_CONDITION = (
    ("froude_number", "Froude number", "Fn_", "", 4, 1.0, 0, "V/√(g L_PP)"),
    ("speed", "speed", "V_", "kn", 2, 1.0 / KNOT, 0, "of the ship through calm water"),
    ("total_resistance", "total resistance", "R_T", "kN", 0, 1e-3, -1, "(1 + k) R_F + R_W + R_A + R_AA + R_APP"),
    ("friction_resistance", "friction (ITTC-57)", "R_F", "kN", 0, 1e-3, -1, "½ρV²S · 0.075/(log₁₀Re − 2)²"),
    ("form_resistance", "form, k × friction", "R_form", "kN", 0, 1e-3, -1, "k R_F"),
    (
        "wave_resistance",
        "wave resistance",
        "R_W",
        "kN",
        0,
        1e-3,
        -1,
        "level 1: Michell's integral; level 2: Rankine panels",
    ),
    ("correlation_resistance", "correlation allowance", "R_A", "kN", 0, 1e-3, -1, "½ρV²S C_A"),
    ("air_resistance", "air resistance", "R_AA", "kN", 0, 1e-3, -1, "½ρ_air V² A_front C_DA"),
    ("appendage_resistance", "appendages", "R_APP", "kN", 0, 1e-3, -1, "the case's share of R_F"),
    ("effective_power", "effective power", "P_E", "MW", 2, 1e-6, -1, "R_T V"),
    ("thrust", "thrust", "T_", "kN", 0, 1e-3, 0, "R_T / (1 − t)"),
    ("torque", "torque", "Q_", "kN m", 0, 1e-3, 0, "K_Q ρ n² D⁵"),
    ("wake_fraction", "wake fraction", "w_", "", 3, 1.0, 0, "1 − V_A / V"),
    ("thrust_deduction", "thrust deduction", "t_", "", 3, 1.0, 0, "1 − R_T / T"),
    ("advance_coefficient", "advance coefficient", "J_", "", 4, 1.0, 0, "V_A / (n D)"),
    ("rotation_rate_rpm", "rotation rate", "n_", "rpm", 1, 1.0, 0, "where K_T = T/(ρ n² D⁴) on the open-water curve"),
    ("thrust_coefficient", "thrust coefficient", "K_T", "", 4, 1.0, 0, "T/(ρ n² D⁴)"),
    ("torque_coefficient", "torque coefficient × 10", "10K_Q", "", 4, 10.0, 0, "10 Q/(ρ n² D⁵)"),
    ("open_water_efficiency", "open-water efficiency", "η_0", "", 4, 1.0, 1, "J K_T / (2π K_Q)"),
    ("hull_efficiency", "hull efficiency", "η_H", "", 4, 1.0, 1, "(1 − t)/(1 − w)"),
    (
        "relative_rotative_efficiency",
        "relative rotative efficiency",
        "η_R",
        "",
        4,
        1.0,
        1,
        "η behind the hull over η_0",
    ),
    ("propulsive_efficiency", "propulsive efficiency", "η_D", "", 4, 1.0, 1, "η_0 η_H η_R"),
    ("delivered_power", "delivered power", "P_D", "MW", 2, 1e-6, -1, "P_E / η_D"),
    ("brake_power", "brake power, with sea margin", "P_B", "MW", 2, 1e-6, -1, "P_D (1 + sea margin)/η_S"),
    ("engine_load", "engine load", "P_B/MCR", "%", 1, 100.0, 0, "P_B over the engine's rating"),
    ("fuel_rate", "fuel", "ṁ_", "t/h", 3, 3.6, -1, "P_B × specific consumption at that load"),
    ("required_expanded_area_ratio", "required EAR", "EAR_req", "", 3, 1.0, 0, "by Keller's or Burrill's criterion"),
    ("cavitation_number", "cavitation number", "σ_", "", 3, 1.0, 0, "(P_0 + ρ g h − P_V)/(½ρ((V_A)² + (0.7π n D)²))"),
    (
        "blade_cavitation_margin",
        "least Cp + σ on the blades (level 2)",
        "Cp+σ",
        "",
        3,
        1.0,
        0,
        "blade upwards, to 0.9 R",
    ),
    (
        "blade_cavitating_share",
        "back below vapour pressure (level 2)",
        "A_cav",
        "%",
        1,
        100.0,
        0,
        "area with Cp < −σ over the back's",
    ),
)


def condition_names(case: Case) -> tuple[str, ...]:
    """What each operating condition is called: by its speed, or by its Froude number where the length decides."""
    if case.conditions.speed == "froude":
        return tuple(f"Fn {froude:g}" for froude in case.froude_numbers)
    return tuple(f"{speed / KNOT:.4g} kn" for speed in case.speeds)


def conditions_of(evaluation: Evaluation) -> tuple[str, ...]:
    """The same for one design: its own speeds."""
    return tuple(f"{condition.speed / KNOT:.4g} kn" for condition in evaluation.conditions)


def size_of_case(case: Case) -> Size:
    """The size of a case's initial design, by which all designs of the case are written in the same units."""
    initial = case.initial
    return size_of_ship(initial.length, initial.breadth, initial.draft, max(case.speeds), case.constants.density)


def size_of_design(evaluation: Evaluation) -> Size:
    """The size of one design that stands alone; a ship's where it has no numbers."""
    if not evaluation.ok or not evaluation.conditions:
        return SHIP_SIZE
    hull = evaluation.hull
    return size_of_ship(hull.length, hull.breadth, hull.draft, max(item.speed for item in evaluation.conditions))


def quantity_of(evaluation: Evaluation, key: str, size: Size) -> str:
    """One number with its unit: "31.25 MW"; ``key`` as of ``all_quantities``."""
    found = next(item for item in all_quantities(("",) * len(evaluation.conditions), size) if item.key == key)
    return f"{found.text(evaluation)} {found.unit}".strip()


def condition_quantities(names: Sequence[str], size: Size = SHIP_SIZE) -> tuple[Quantity, ...]:
    """The numbers of each operating condition, under its name (see ``condition_names``)."""
    made = []
    for index, words in enumerate(names):
        for name, label, symbol, unit, decimals, scale, better, formula in _CONDITION:
            made.append(
                Quantity(
                    f"{name}_{index + 1}",
                    label,
                    f"{symbol}{index + 1}" if "_" in symbol else f"{symbol}_{index + 1}",
                    unit,
                    decimals,
                    _condition(index, name, scale),
                    f"{_CONDITION_GROUP} {index + 1}: {words}",
                    better,
                    formula,
                    scale,
                ).sized(size)
            )
    return tuple(made)


def all_quantities(names: Sequence[str], size: Size = SHIP_SIZE) -> tuple[Quantity, ...]:
    """Everything there is, in the order of the tables; ``names`` of the conditions, in the units of a ship's size."""
    return _everything(tuple(names), size)


@lru_cache(maxsize=32)
def _everything(names: tuple[str, ...], size: Size) -> tuple[Quantity, ...]:
    ship = (item.sized(size) for item in (*HULL, *SHIP, *PROPELLER))
    return (*OBJECTIVES, *ship, *condition_quantities(names, size), *CONSTRAINTS)


def quantities_of_case(case: Case) -> tuple[Quantity, ...]:
    """Everything there is of a case's designs, in its units; its objectives under their own names."""
    chosen = zip(OBJECTIVES, (case.objectives.first, case.objectives.second), strict=True)
    named = {item.key: replace(item, label=objective_named(name).title) for item, name in chosen}
    everything = all_quantities(condition_names(case), size_of_case(case))
    return tuple(named.get(item.key, item) for item in everything)


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
    lines = [f"{SEARCH_TABLE[name].symbol} on its {side} bound" for name, side in evaluation.active_bounds.items()]
    values = evaluation.constraints
    lines += [
        f"{item.label} ({item.symbol}) at its limit"
        for item in constraints.CONSTRAINTS
        if item.is_active(values.get(item.name)) and not item.is_violated(values.get(item.name))
    ]
    return lines
