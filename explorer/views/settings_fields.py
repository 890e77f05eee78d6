"""Which fields of a case the page sets, in which folder, and in which steps."""

from __future__ import annotations

import re
from decimal import Decimal

from hpsop_core.case.declared_variable import Variable, declared_variables
from hpsop_core.case.variables import SEARCH_TABLE, StatedVariables


def variable_label(variable: Variable) -> str:
    """A slider's label: the symbol and, as its thumbs stand at SI numbers, the SI unit."""
    return f"{variable.symbol} [{variable.rule.unit}]" if variable.rule.unit else variable.symbol


def standing_label(variable: Variable, side: str | None) -> str:
    """A design's slider: the unit of shown numbers, and an arrow where the design stands on a bound."""
    unit = f" [{variable.unit}]" if variable.unit else ""
    return variable.symbol + unit + {None: "", "lower": " ↓", "upper": " ↑"}[side]


def standing_hint(variable: Variable, side: str | None) -> str:
    """What a slider's hint says, also of the bound that the design stands on."""
    unit = "" if variable.unit == variable.rule.unit else f", here in {variable.unit}"
    return variable.rule.meaning + unit + ("" if side is None else f"; this design stands on its {side} bound")


def slider_decimals(variable: Variable, value: float) -> int:
    """Digits after the point of a slider's numbers around an initial design's value."""
    return _digits(variable.step_near(value))


def shown_decimals(variable: Variable, value: float) -> int:
    """The same of a slider that stands at shown numbers."""
    return _digits(round(variable.shown(variable.step_near(value)), 12))


def _digits(step: float) -> int:
    return max(0, -int(Decimal(repr(step)).normalize().as_tuple().exponent))


OPEN_FOLDERS = ("Operating conditions", "Form and objectives")
CASE_FIELDS: tuple[tuple[str, tuple[tuple[str, str, str], ...]], ...] = (
    (
        "Operating conditions",
        (
            ("conditions", "froude_numbers", "Froude numbers"),
            ("conditions", "speeds_knots", "or speeds [kn]"),
            ("conditions", "weights", "Shares of time"),
            ("conditions", "speed", "Speed"),
        ),
    ),
    (
        "Form and objectives",
        (
            ("hull", "form", "Hull form"),
            ("objectives", "first", "Objective f₁"),
            ("objectives", "second", "Objective f₂"),
        ),
    ),
    (
        "Constraints",
        (
            ("constraints", "displacement_tolerance", "g₁ tolerance"),
            ("constraints", "diameter_to_draft_lower", "g₂ D/d from"),
            ("constraints", "diameter_to_draft_upper", "g₂ D/d to"),
            ("constraints", "g3_level", "g₃ from level"),
            ("constraints", "keller_k", "Keller's K"),
            ("constraints", "cavitation_criterion", "g₃ criterion"),
            ("constraints", "cavitation_conditions", "Cavitation at"),
            ("constraints", "booked_block_coefficient_lower", "Booked C_B from"),
            ("constraints", "booked_block_coefficient_upper", "Booked C_B to"),
            ("constraints", "back_cavitation_limit", "g₆ back, share"),
            ("constraints", "least_tip_clearance", "g₇ tip / D from"),
            ("constraints", "greatest_length", "g₈ L to [m]"),
            ("constraints", "greatest_breadth", "g₉ B to [m]"),
            ("loading", "least_metacentric_height", "g₁₀ GM from [m]"),
        ),
    ),
    (
        "Loading and engine",
        (
            ("loading", "centre_of_gravity_height", "KG [m]"),
            ("loading", "lightship_mass", "Lightship [kg]"),
            ("loading", "capacity_share", "EEDI capacity"),
            ("engine", "maximum_continuous_rating", "MCR [W]"),
            ("engine", "rated_rotation_rate_rpm", "Rated rpm"),
            ("engine", "load_fractions", "Load points"),
            ("engine", "specific_fuel_consumptions", "SFOC [g/kWh]"),
            ("engine", "fuel_carbon_factor", "C_F, CO₂ / fuel"),
        ),
    ),
    (
        "Physics",
        (
            ("constants", "form_factor", "Form factor k"),
            ("constants", "form_factor_formula", "k's formula"),
            ("constants", "wave_calibration", "R_W calibration"),
            ("constants", "stated_wave_coefficients", "Stated C_W"),
            ("constants", "correlation_allowance", "Allowance C_A"),
            ("constants", "correlation_allowance_formula", "C_A's formula"),
            ("constants", "air_drag_coefficient", "Air drag C_DA"),
            ("constants", "frontal_area", "Frontal area [m²]"),
            ("constants", "appendage_factor", "Appendages / R_F"),
            ("constants", "wake_formula", "Wake"),
            ("constants", "stated_wake_fraction", "Stated w"),
            ("constants", "thrust_deduction_formula", "Thrust deduction"),
            ("constants", "thrust_deduction_factor", "t / w"),
            ("constants", "stated_thrust_deduction", "Stated t"),
            ("constants", "relative_rotative_efficiency", "η_R"),
            ("constants", "relative_rotative_efficiency_formula", "η_R's formula"),
            ("constants", "stern_shape", "Stern C_stern"),
            ("constants", "sea_margin", "Sea margin"),
            ("constants", "shaft_efficiency", "Shaft η_S"),
            ("constants", "density", "ρ [kg/m³]"),
            ("constants", "viscosity", "ν [m²/s]"),
            ("constants", "gravity", "g [m/s²]"),
            ("constants", "atmospheric_pressure", "P₀ [Pa]"),
            ("constants", "vapour_pressure", "Pᵥ [Pa]"),
            ("constants", "propeller_roughness", "Roughness [m]"),
            ("constants", "camber_scaling", "Blade camber"),
        ),
    ),
    (
        "Initial design",
        (
            ("initial", "length", "Lpp [m]"),
            ("initial", "breadth", "B [m]"),
            *(
                ("initial", name, variable_label(variable) if variable.rule.unit else variable.label)
                for name, variable in declared_variables(StatedVariables).items()
            ),
        ),
    ),
    (
        "Search",
        (
            ("optimization", "crossover_probability", "Crossover"),
            ("optimization", "crossover_eta", "Crossover index"),
            ("optimization", "mutation_probability", "Mutation"),
            ("optimization", "mutation_eta", "Mutation index"),
            ("optimization", "constraint_handling", "Constraints"),
            ("optimization", "penalty_factor", "Penalty factor"),
            ("optimization", "handover_margin", "Hand-over margin"),
            ("optimization", "reseed_share", "Re-seeded"),
            ("optimization", "keep_initial", "Keep initial"),
            ("optimization", "stagnation_window", "Stagnation over"),
            ("optimization", "stagnation_tolerance", "its tolerance"),
            ("optimization", "evaluation_time_limit", "Time limit [s]"),
        ),
    ),
)
# A number widget shows no more digits than its step has.
STEPS = {
    "viscosity": 1e-9,
    "propeller_roughness": 1e-6,
    "gravity": 1e-5,
    "density": 0.1,
    "atmospheric_pressure": 1.0,
    "vapour_pressure": 1.0,
    "penalty_factor": 0.1,
    "crossover_eta": 0.1,
    "mutation_eta": 0.1,
    "evaluation_time_limit": 0.1,
    "handover_margin": 0.001,
    "stagnation_tolerance": 1e-4,
    # a model's dimensions are typed in tenths of a millimetre
    **dict.fromkeys(("length", "breadth", "draft", "diameter"), 1e-4),
    **{name: 0.1 * variable.step for name, variable in SEARCH_TABLE.items() if variable.step},
}
SEARCH_FIELDS: tuple[tuple[str, str, str], ...] = (
    ("optimization", "population", "Population"),
    ("optimization", "generations", "Generations"),
    ("optimization", "level1_generations", "of these level 1"),
    ("optimization", "seed", "Seed"),
)
_LABELS = {(section, name): label for _, fields in CASE_FIELDS for section, name, label in fields}
_LABELS |= {(section, name): label for section, name, label in SEARCH_FIELDS}
_LABELS |= {("bounds", name): variable.symbol for name, variable in SEARCH_TABLE.items()}


_SPOKEN = {name: label for (_, name), label in _LABELS.items() if "_" in name}


def with_labels(text: str) -> str:
    """Words that name fields of the case, with these called as on the page: beyond “g₂ D/d from”."""

    def label(name: re.Match[str]) -> str:
        return f"“{_SPOKEN[name[0]]}”" if name[0] in _SPOKEN else name[0]

    return re.sub(r"\b[a-z0-9]+(?:_[a-z0-9]+)+\b", label, text)


def in_words(message: str) -> str:
    """A message of the case with its fields called as on the page: "Population: 2 is outside its limits"."""
    found = re.match(r"(\w+): (\w+)", message)
    label = _LABELS.get((found[1], found[2])) if found else None
    begin, rest = (label, message[found.end() :]) if found and label else ("", message)
    return begin + re.sub(r"\b[a-z0-9]+(?:_[a-z0-9]+)+\b", lambda name: _SPOKEN.get(name[0], name[0]), rest)
