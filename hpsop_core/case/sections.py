"""The sections of a case: every field with its limits, unit and meaning."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

from hpsop_core.assets import SHIPPED_HULLS, SHIPPED_PROPELLERS
from hpsop_core.case.fields import choice, flag, integer, number, numbers, optional_number, text
from hpsop_core.case.objectives import OBJECTIVE_NAMES
from hpsop_core.case.variables import DesignVariables, StatedVariables
from hpsop_core.errors import InputError


@dataclass(frozen=True)
class HullSection:
    """Which parent hull, and how a design is made from it."""

    parent: str = choice("dtc", SHIPPED_HULLS, "a shipped hull's name; leave it when offsets or stl names a file")
    offsets: str = text("", "an offsets table (station_x_m,waterline_z_m,half_breadth_m) instead of a shipped hull")
    stl: str = text("", "a closed STL of the hull instead of a shipped hull")
    stl_unit: str = choice(
        "unstated", ("unstated", "m", "mm", "cm", "ft", "in"), "the STL's unit of length; to be stated with stl"
    )
    length: float | None = optional_number(0.1, 600.0, "Lpp of the offsets or STL", "m")
    draft: float | None = optional_number(0.005, 40.0, "waterline of the offsets or STL above z = 0", "m")
    form: str = choice(
        "shift",
        ("shift", "affine"),
        "shift: the block coefficient is reached by moving sections; affine: scaling alone, displacement is booked",
    )

    def __post_init__(self) -> None:
        if self.offsets and self.stl:
            raise InputError("hull: both offsets and stl are given; keep one of them")
        if (self.offsets or self.stl) and (self.length is None or self.draft is None):
            raise InputError("hull: a hull from a file needs length (Lpp) and draft, in metres")
        if self.stl and self.stl_unit == "unstated":
            raise InputError('hull: an STL carries no unit; add stl_unit = "m" (or mm, cm, ft, in)')


@dataclass(frozen=True)
class PropellerSection:
    """Which parent propeller."""

    parent: str = choice(
        "p4119", tuple(SHIPPED_PROPELLERS), "a shipped propeller's name; leave it when geometry names a file"
    )
    geometry: str = text("", "a radial table (r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c) instead of a shipped propeller")
    geometry_blade_count: int = integer(3, 2, 7, "blades that the radial table was designed for")


@dataclass(frozen=True, kw_only=True)
class MainDimensions:
    """What an initial design states instead of its proportions."""

    length: float = number(355.0, 0.1, 600.0, "Lpp", "m")
    breadth: float = number(51.0, 0.02, 100.0, "breadth", "m")


# A dataclass takes the fields of its last base first: the main dimensions lead.
@dataclass(frozen=True, kw_only=True)
class InitialSection(StatedVariables, MainDimensions):
    """The initial design: it normalises the objectives and defines V0, inside the bounds or not."""

    @property
    def variables(self) -> DesignVariables:
        """The initial design's variables.

        Raises:
            InputError: its proportions are outside what a design variable may be.
        """
        proportions = {
            "length_to_breadth": self.length / self.breadth,
            "breadth_to_draft": self.breadth / self.draft,
        }
        stated = {field.name: getattr(self, field.name) for field in dataclasses.fields(StatedVariables)}
        return DesignVariables.from_dict({**proportions, **stated}, "initial")


@dataclass(frozen=True)
class ConditionsSection:
    """The operating conditions and their weights."""

    speed: str = choice(
        "fixed",
        ("fixed", "froude"),
        "fixed: the initial design's speeds at these Froude numbers; froude: each design's length decides its speed",
    )
    froude_numbers: tuple[float, ...] = numbers((0.22, 0.27), 0.1, 0.5, "Froude numbers V/sqrt(g Lpp), ascending")
    weights: tuple[float, ...] = numbers((0.65, 0.35), 0.0, 1.0, "weights of the conditions; their sum is 1")

    def __post_init__(self) -> None:
        if not 1 <= len(self.froude_numbers) <= 4:
            raise InputError(f"conditions: froude_numbers has {len(self.froude_numbers)} entries; give one to four")
        if len(self.weights) != len(self.froude_numbers):
            raise InputError(
                f"conditions: {len(self.weights)} weights for {len(self.froude_numbers)} Froude numbers; give one each"
            )
        if any(b <= a for a, b in zip(self.froude_numbers, self.froude_numbers[1:], strict=False)):
            raise InputError("conditions: froude_numbers must ascend; sort them together with their weights")
        if abs(math.fsum(self.weights) - 1.0) > 1e-9:
            raise InputError(f"conditions: weights sum to {math.fsum(self.weights):g}; they must sum to 1")


@dataclass(frozen=True)
class ObjectivesSection:
    """The two objectives; both are minimised and normalised by the initial design at the same level."""

    first: str = choice("resistance", OBJECTIVE_NAMES, "f1")
    second: str = choice("efficiency", OBJECTIVE_NAMES, "f2")

    def __post_init__(self) -> None:
        if self.first == self.second:
            raise InputError(f"objectives: first and second are both {self.first}; choose two different ones")


@dataclass(frozen=True)
class ConstraintsSection:
    """Limits of the constraints."""

    displacement_tolerance: float = number(0.05, 0.0, 0.5, "g1: allowed relative change of displacement")
    diameter_to_draft_lower: float = number(0.55, 0.0, 2.0, "g2: least D/d")
    diameter_to_draft_upper: float = number(0.75, 0.0, 2.0, "g2: greatest D/d")
    g3_level: int = integer(1, 1, 2, "the level from which Keller's criterion (g3) applies")
    keller_k: float = number(0.0, 0.0, 0.2, "Keller's K: 0 for fast twin-screw ships to 0.2 for single-screw ships")
    booked_block_coefficient_lower: float = number(0.50, 0.3, 1.0, "affine form: least booked CB")
    booked_block_coefficient_upper: float = number(0.80, 0.3, 1.0, "affine form: greatest booked CB")


@dataclass(frozen=True)
class ConstantsSection:
    """Water, friction, wake and what else the physics takes as given."""

    gravity: float = number(9.80665, 9.7, 9.9, "acceleration of gravity", "m/s2")
    density: float = number(1025.0, 900.0, 1100.0, "density of the water", "kg/m3")
    viscosity: float = number(1.188e-6, 5e-7, 3e-6, "kinematic viscosity of the water", "m2/s")
    atmospheric_pressure: float = number(101325.0, 8e4, 1.1e5, "pressure at the water surface", "Pa")
    vapour_pressure: float = number(1700.0, 0.0, 1e4, "vapour pressure", "Pa")
    form_factor: float = number(0.094, 0.0, 1.0, "k on ITTC-57 friction")
    wake_formula: str = choice(
        "taylor_quadratic",
        ("taylor_quadratic", "linear"),
        "taylor_quadratic: least-squares fit of Taylor's single-screw table; linear: 0.5 CB - 0.05",
    )
    thrust_deduction_factor: float = number(0.6, 0.0, 1.2, "Schoenherr: t over w")
    relative_rotative_efficiency: float = number(1.0, 0.8, 1.2, "eta_R")
    propeller_roughness: float = number(30e-6, 1e-6, 1e-3, "roughness of the blades (ITTC-78)", "m")
    wave_calibration: str = choice(
        "level2",
        ("level2", "stated", "none"),
        "level 1's wave resistance: scaled so that the initial design has its level-2 or the stated value, or not",
    )
    stated_wave_coefficients: tuple[float, ...] = numbers(
        (), 0.0, 0.02, "the initial design's wave coefficients, one a condition, for wave_calibration = stated"
    )


@dataclass(frozen=True)
class OptimizationSection:
    """NSGA-II over two levels."""

    population: int = integer(50, 4, 1000, "designs a generation")
    generations: int = integer(150, 1, 100000, "generations of both levels, the initial sample included")
    level1_generations: int = integer(100, 0, 100000, "of these, at level 1")
    crossover_probability: float = number(0.9, 0.0, 1.0, "probability of simulated binary crossover")
    crossover_eta: float = number(15.0, 1.0, 100.0, "distribution index of the crossover")
    mutation_probability: float = number(0.05, 0.0, 1.0, "probability of polynomial mutation, per gene")
    mutation_eta: float = number(20.0, 1.0, 100.0, "distribution index of the mutation")
    seed: int = integer(1, 0, 2**31 - 1, "seed: the same case and seed give the same bits")
    constraint_handling: str = choice(
        "penalty", ("penalty", "feasibility_first"), "penalty: F = f + factor sum max(0, g), as the paper"
    )
    penalty_factor: float = number(10.0, 0.0, 1e6, "factor of the penalty")
    handover_margin: float = number(
        0.02, 0.0, 0.5, "before level 2 comes the search keeps Keller's criterion by this much expanded area ratio"
    )
    reseed_share: float = number(0.2, 0.0, 1.0, "share of the population sampled anew when level 2 begins")
    keep_initial: bool = flag(True, "the initial design's projection is always in the sample of either level")
    stagnation_window: int = integer(30, 2, 100000, "generations over which level 1's hypervolume must still grow")
    stagnation_tolerance: float = number(
        0.0, 0.0, 1.0, "relative growth of the hypervolume over the window below which level 2 begins; 0: never"
    )
    evaluation_time_limit: float = number(120.0, 0.1, 1e5, "an evaluation that takes longer is recorded as failed", "s")

    def __post_init__(self) -> None:
        if self.level1_generations > self.generations:
            raise InputError(
                f"optimization: level1_generations {self.level1_generations} exceeds generations {self.generations}; "
                "lower it or raise generations"
            )
