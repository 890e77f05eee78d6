"""The sections of a case: every field with its limits, unit and meaning."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

from hpsop_core.assets import SHIPPED_HULLS, SHIPPED_PROPELLERS
from hpsop_core.case.fields import choice, flag, integer, number, numbers, optional_number, text
from hpsop_core.case.objectives import OBJECTIVE_NAMES
from hpsop_core.case.variables import DesignVariables, StatedVariables
from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input.options import BOWS, ORIGINS, UNITS, UPS, WATERLINES, Axes, ReadOptions

# Fields of [hull] that name a file.
OWN_FILES = ("file", "offsets", "stl")


@dataclass(frozen=True)
class HullSection:
    """Which parent hull, and how a design is made from it. Fields from `unit` to `up` say how a file is to be read."""

    parent: str = choice("dtc", SHIPPED_HULLS, "a shipped hull's name; leave it when file, offsets or stl names a file")
    file: str = text("", "a hull of one's own: table, mesh, 3dm, STEP or IGES (docs/bring-your-ship.md)")
    offsets: str = text("", "earlier name of file, for a table of offsets")
    stl: str = text("", "earlier name of file, for a mesh")
    stl_unit: str = choice(
        "unstated", ("unstated", "m", "mm", "cm", "ft", "in"), "earlier name of unit; to be stated with stl"
    )
    length: float | None = optional_number(0.1, 600.0, "Lpp of the hull in the file", "m")
    draft: float | None = optional_number(0.005, 40.0, "still water of the hull in the file, above the baseline", "m")
    breadth: float | None = optional_number(0.02, 100.0, "breadth of a table in fractions of B/2", "m")
    unit: str = choice("auto", ("auto", *UNITS), "the file's unit of length; auto: what it states, else metres")
    bow: str = choice("auto", BOWS, "the end of x at which the file has the bow; auto: what it states, else +x")
    origin: str = choice("auto", ORIGINS, "where the file has x = 0; auto: what it states, else ap")
    waterline: str = choice("auto", WATERLINES, "z = 0 of the file: the baseline (draft), or the still water (z0)")
    up: str = choice("auto", UPS, "the axis of a mesh that points up; auto: found from the form")
    shaft_height: float | None = optional_number(
        0.0, 40.0, "the shaft above the baseline at the hull's own draft; else found from the boss, or assumed", "m"
    )
    boss_x: float | None = optional_number(
        -50.0, 600.0, "where the propeller's hub begins, from AP; else found from boss or stern profile", "m"
    )
    form: str = choice(
        "shift",
        ("shift", "affine"),
        "shift: the block coefficient is reached by moving sections; affine: scaling alone, displacement is booked",
    )

    def __post_init__(self) -> None:
        given = [name for name in OWN_FILES if getattr(self, name)]
        if len(given) > 1:
            raise InputError(f"hull: both {given[0]} and {given[1]} are given; keep one of them")
        if given and (self.length is None or self.draft is None):
            raise InputError("hull: a hull from a file needs length (Lpp) and draft, in metres")
        if self.shaft_height is not None and self.draft is not None and self.shaft_height >= self.draft:
            raise InputError(
                f"hull: shaft_height {self.shaft_height:g} m is not under the draft of {self.draft:g} m; both are "
                "counted from the baseline"
            )
        if self.boss_x is not None and self.length is not None and not abs(self.boss_x) < 0.5 * self.length:
            raise InputError(
                f"hull: boss_x {self.boss_x:g} m is not in the after half of {self.length:g} m; it is counted from AP"
            )
        if self.stl and self.stl_unit == "unstated" and self.unit == "auto":
            raise InputError('hull: an STL carries no unit; add unit = "m" (or mm, cm, ft, in)')

    @property
    def own_file(self) -> str:
        """The file of a hull of one's own, or "" for a shipped one."""
        return self.file or self.offsets or self.stl

    @property
    def read_options(self) -> ReadOptions:
        """How the file is to be read."""
        unit = self.unit if self.unit != "auto" else self.stl_unit if self.stl and self.stl_unit != "unstated" else None
        axes = Axes(self.bow, self.origin, self.waterline, self.up)
        return ReadOptions(self.length, self.draft, self.breadth, unit, axes)


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

        Its displacement ratio as a design variable is 1 whatever is stated here: a variable's ratio is to the initial
        design's own displacement V0, in which the stated one has its place already.

        Raises:
            InputError: its proportions are outside what a design variable may be.
        """
        own = {
            "length_to_breadth": self.length / self.breadth,
            "breadth_to_draft": self.breadth / self.draft,
            "displacement_ratio": 1.0,
        }
        stated = {field.name: getattr(self, field.name) for field in dataclasses.fields(StatedVariables)}
        return DesignVariables.from_dict({**stated, **own}, "initial")


@dataclass(frozen=True)
class ConditionsSection:
    """The operating conditions and their weights."""

    speed: str = choice(
        "fixed",
        ("fixed", "froude"),
        "fixed: the initial design's speeds at these Froude numbers; froude: each design's length decides its speed",
    )
    froude_numbers: tuple[float, ...] = numbers(
        (0.22, 0.27), 0.1, 0.5, "Froude numbers V/sqrt(g Lpp), ascending; empty with speeds_knots"
    )
    speeds_knots: tuple[float, ...] = numbers((), 0.1, 80.0, "speeds instead of Froude numbers, ascending", "kn")
    weights: tuple[float, ...] = numbers((0.65, 0.35), 0.0, 1.0, "shares of time of the conditions; their sum is 1")

    def __post_init__(self) -> None:
        if self.froude_numbers and self.speeds_knots:
            raise InputError("conditions: froude_numbers and speeds_knots are both given; keep one of them")
        if self.speeds_knots and self.speed == "froude":
            raise InputError(
                'conditions: speeds_knots mean nothing with speed = "froude", where each design\'s length decides; '
                'write speed = "fixed" or give froude_numbers'
            )
        name = "speeds_knots" if self.speeds_knots else "froude_numbers"
        stated: tuple[float, ...] = getattr(self, name)
        if not stated:
            raise InputError("conditions: none is given; give froude_numbers or speeds_knots, for example [20, 24]")
        if len(self.weights) != len(stated):
            raise InputError(
                f"conditions: {len(self.weights)} weights for {len(stated)} {name}; give one each, their sum is 1"
            )
        if any(b <= a for a, b in itertools.pairwise(stated)):
            by_speed = dict.fromkeys(sorted(stated), 0.0)
            for value, weight in zip(stated, self.weights, strict=True):
                by_speed[value] += weight
            ordered, weights = (", ".join(f"{one:g}" for one in row) for row in (by_speed, by_speed.values()))
            raise InputError(f"conditions: {name} must ascend; write {name} = [{ordered}] and weights = [{weights}]")
        total = math.fsum(self.weights)
        if abs(total - 1.0) > 1e-9:
            shares = ", ".join(_shares(self.weights if total > 0.0 else (1.0,) * len(stated)))
            raise InputError(
                f"conditions: weights sum to {total:.10g}; they must sum to 1; write for example [{shares}]"
            )

    @property
    def speeds_are_fixed(self) -> bool:
        """Whether every design sails at the same speeds: knots then say more than each design's own Froude number."""
        return self.speed == "fixed"

    @classmethod
    def completed(cls, table: Mapping[str, object]) -> dict[str, object]:
        """A case file's table with what follows from it: whoever states speeds in knots gives no Froude numbers."""
        return {"froude_numbers": [], **table} if table.get("speeds_knots") else dict(table)


def _shares(weights: tuple[float, ...]) -> list[str]:
    """The weights over their sum in four digits, the greatest one taking what rounding leaves."""
    total = math.fsum(weights)
    parts = [round(1e4 * weight / total) for weight in weights]
    parts[parts.index(max(parts))] += 10000 - sum(parts)
    return [f"{1e-4 * part:.4g}" for part in parts]


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
    cavitation_conditions: str = choice(
        "first", ("first", "all"), "where g3 and the share of the back apply: at the first condition or at each"
    )
    cavitation_criterion: str = choice(
        "keller", ("keller", "burrill"), "g3: Keller's least blade area, or Burrill's for 5 % back cavitation"
    )
    back_cavitation_limit: float | None = optional_number(
        0.0, 1.0, "greatest share of the blades' back below vapour pressure; level 2 alone knows it"
    )
    least_tip_clearance: float | None = optional_number(
        0.0, 1.0, "least distance of the blade tips from the hull, as a fraction of D"
    )
    greatest_length: float | None = optional_number(0.1, 1000.0, "of Lpp", "m")
    greatest_breadth: float | None = optional_number(0.02, 200.0, "of B", "m")


@dataclass(frozen=True)
class ConstantsSection:
    """Water, friction, wake and what else the physics takes as given."""

    gravity: float = number(9.80665, 9.7, 9.9, "acceleration of gravity", "m/s2")
    density: float = number(1025.0, 900.0, 1100.0, "density of the water", "kg/m3")
    viscosity: float = number(1.188e-6, 5e-7, 3e-6, "kinematic viscosity of the water", "m2/s")
    atmospheric_pressure: float = number(101325.0, 8e4, 1.1e5, "pressure at the water surface", "Pa")
    vapour_pressure: float = number(1700.0, 0.0, 1e4, "vapour pressure", "Pa")
    form_factor: float = number(0.094, 0.0, 1.0, "k on ITTC-57 friction")
    form_factor_uncertainty: float | None = optional_number(
        0.0, 0.5, "half width of k's 90 % interval, for the errors; unstated: that of the formula, none for a stated k"
    )
    form_factor_formula: str = choice(
        "stated",
        ("stated", "scaled", "holtrop"),
        "stated: form_factor for every design; scaled: form_factor for the initial design, the others by the change of "
        "Holtrop's; holtrop: Holtrop's",
    )
    correlation_allowance: float = number(0.0, -0.001, 0.002, "C_A, model-ship correlation allowance")
    correlation_allowance_formula: str = choice(
        "stated",
        ("stated", "scaled", "holtrop"),
        "stated: correlation_allowance for every design; scaled: for the initial design, the others by the change of "
        "Holtrop's; holtrop: Holtrop's, for 150e-6 m of roughness",
    )
    air_drag_coefficient: float = number(0.8, 0.0, 2.0, "drag coefficient of the ship above water, ahead in still air")
    frontal_area: float = number(
        0.0, 0.0, 10000.0, "frontal area of the initial design above water; the others' goes with their breadth", "m2"
    )
    appendage_factor: float = number(
        0.0, 0.0, 1.0, "resistance of the appendages over the hull's flat-plate friction: sum of (1 + k2) S_app over S"
    )
    wake_formula: str = choice(
        "taylor_quadratic",
        ("taylor_quadratic", "linear", "holtrop", "stated"),
        "taylor_quadratic: least-squares fit of Taylor's single-screw table; linear: 0.5 CB - 0.05; holtrop: "
        "Holtrop's; stated: stated_wake_fraction for the initial design, the others by the change of Holtrop's",
    )
    wake_fraction_uncertainty: float | None = optional_number(
        0.0, 0.3, "half width of w's 90 % interval, for the errors; unstated: that of the formula, none for a stated w"
    )
    stated_wake_fraction: float | None = optional_number(0.0, 0.6, "w of the initial design, for wake_formula = stated")
    thrust_deduction_formula: str = choice(
        "schoenherr",
        ("schoenherr", "holtrop", "stated"),
        "schoenherr: thrust_deduction_factor times w; holtrop: Holtrop's; stated: stated_thrust_deduction for the "
        "initial design, the others by the change of Holtrop's",
    )
    thrust_deduction_factor: float = number(0.6, 0.0, 1.2, "Schoenherr: t over w")
    stated_thrust_deduction: float | None = optional_number(
        0.0, 0.6, "t of the initial design, for thrust_deduction_formula = stated"
    )
    relative_rotative_efficiency: float = number(1.0, 0.8, 1.2, "eta_R")
    relative_rotative_efficiency_formula: str = choice(
        "stated",
        ("stated", "scaled", "holtrop"),
        "stated: relative_rotative_efficiency for every design; scaled: for the initial design, the others by the "
        "change of Holtrop's; holtrop: Holtrop's",
    )
    stern_shape: float = number(
        0.0, -25.0, 10.0, "Holtrop's C_stern: -25 pram with gondola, -10 V sections, 0 normal, 10 U with Hogner stern"
    )
    sea_margin: float = number(0.0, 0.0, 1.0, "on the brake power, for wind, waves and fouling: 0.15 is 15 %")
    shaft_efficiency: float = number(1.0, 0.8, 1.0, "delivered power over brake power, in calm water")
    propeller_roughness: float = number(30e-6, 1e-6, 1e-3, "roughness of the blades (ITTC-78)", "m")
    camber_scaling: str = choice(
        "model",
        ("model", "reynolds"),
        "camber that the blades' boundary layer takes at full scale: as much as on the model that it was fitted on, or "
        "in proportion to the friction",
    )
    wave_calibration: str = choice(
        "level2",
        ("level2", "learnt", "stated", "none"),
        "level 1's wave resistance: scaled so that the initial design has its level-2 or the stated value; learnt: "
        "each form by a factor of its own, from a few dozen hulls solved at level 2; or as it is",
    )
    wave_calibration_hulls: int = integer(
        32, 8, 512, "hulls of the space solved at level 2 for wave_calibration = learnt, a third of a second each"
    )
    stated_wave_coefficients: tuple[float, ...] = numbers(
        (), 0.0, 0.02, "the initial design's wave coefficients, one a condition, for wave_calibration = stated"
    )

    def __post_init__(self) -> None:
        for formula, value in (
            ("wake_formula", "stated_wake_fraction"),
            ("thrust_deduction_formula", "stated_thrust_deduction"),
        ):
            if getattr(self, formula) == "stated" and getattr(self, value) is None:
                raise InputError(f"constants: {formula} = stated needs {value}; add it or choose another formula")


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
    surface: bool = flag(
        False,
        "level 2 answers from a surface learnt from solved designs, where it is not in doubt, and level 1's propellers "
        "come from a table; the last front is solved",
    )
    surface_sample: int = integer(
        30, 0, 1000, "designs spread over the space that are solved for the surface when level 2 begins"
    )
    surface_checks: int = integer(12, 1, 1000, "designs of the front that are solved before the surface is learnt anew")
    surface_generations: int = integer(12, 2, 100000, "generations of level 2 after which the surface is learnt anew")
    final_errors: bool = flag(
        False, "at the run's end its front and the initial design are solved on a finer mesh, to state their errors"
    )
    evaluation_time_limit: float = number(120.0, 0.1, 1e5, "an evaluation that takes longer is recorded as failed", "s")

    def __post_init__(self) -> None:
        if self.level1_generations > self.generations:
            raise InputError(
                f"optimization: level1_generations {self.level1_generations} exceeds generations {self.generations}; "
                "lower it or raise generations"
            )
