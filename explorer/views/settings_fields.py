"""Which fields of a case the page sets, in which folder, and how far the sliders reach."""

from __future__ import annotations

# How far the sliders reach: wider than the paper's Table 2, narrower than what the parents' families carry.
SLIDER_RANGES: dict[str, tuple[float, float, float]] = {
    "length_to_breadth": (6.0, 9.0, 0.01),
    "breadth_to_draft": (2.6, 4.8, 0.01),
    "draft": (12.0, 16.0, 0.01),
    "diameter": (7.5, 10.5, 0.01),
    "blade_count": (3, 7, 1),
    "pitch_ratio": (0.8, 1.2, 0.001),
    "displacement_ratio": (0.85, 1.15, 0.001),
    "expanded_area_ratio": (0.4, 1.05, 0.001),
    "buoyancy_centre_shift": (-0.02, 0.02, 0.0005),
}
OPEN_FOLDERS = ("Operating conditions", "Form and objectives")
CASE_FIELDS: tuple[tuple[str, tuple[tuple[str, str, str], ...]], ...] = (
    (
        "Operating conditions",
        (
            ("conditions", "froude_numbers", "Froude numbers"),
            ("conditions", "weights", "Weights"),
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
            ("constraints", "booked_block_coefficient_lower", "booked CB from"),
            ("constraints", "booked_block_coefficient_upper", "booked CB to"),
        ),
    ),
    (
        "Physics",
        (
            ("constants", "form_factor", "Form factor k"),
            ("constants", "wave_calibration", "Calibration"),
            ("constants", "stated_wave_coefficients", "Stated Cw"),
            ("constants", "wake_formula", "Wake"),
            ("constants", "thrust_deduction_factor", "t / w"),
            ("constants", "relative_rotative_efficiency", "η_R"),
            ("constants", "density", "ρ [kg/m³]"),
            ("constants", "viscosity", "ν [m²/s]"),
            ("constants", "gravity", "g [m/s²]"),
            ("constants", "atmospheric_pressure", "P₀ [Pa]"),
            ("constants", "vapour_pressure", "Pᵥ [Pa]"),
            ("constants", "propeller_roughness", "Roughness [m]"),
        ),
    ),
    (
        "Initial design",
        (
            ("initial", "length", "Lpp [m]"),
            ("initial", "breadth", "B [m]"),
            ("initial", "draft", "d [m]"),
            ("initial", "diameter", "D [m]"),
            ("initial", "blade_count", "Z"),
            ("initial", "pitch_ratio", "pitch ratio"),
            ("initial", "displacement_ratio", "∇ / parent ∇"),
            ("initial", "expanded_area_ratio", "EAR"),
            ("initial", "buoyancy_centre_shift", "LCB shift / L"),
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
    "buoyancy_centre_shift": 1e-4,
}
SEARCH_FIELDS: tuple[tuple[str, str, str], ...] = (
    ("optimization", "population", "Population"),
    ("optimization", "generations", "Generations"),
    ("optimization", "level1_generations", "of these level 1"),
    ("optimization", "seed", "Seed"),
)
