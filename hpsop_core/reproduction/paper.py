"""The paper's printed tables, and what follows from them alone (its speeds, wake, thrust and power)."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cache

from hpsop_core.assets import read_asset_text
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.hydro.interaction import wake_fraction

CASE_NAME = "dtc-p4119-paper"
TITLE = (
    "Hydrodynamic multidisciplinary optimization of a container ship and its propeller using comprehensive HPSOP code"
)
INITIAL, COMPROMISE = "IS", "OP3"
# The paper's g: its speeds follow with the ordinary 9.81, not with the standard value.
PAPER_GRAVITY = 9.81


@dataclass(frozen=True)
class PaperDesign:
    """A row of Table 3.

    Attributes:
        name: IS, or OP1 to OP5.
        length, breadth, draft, diameter: in m.
        block_coefficient: as printed (booked: the hull's sections cannot have changed with it).
        blade_count: Z.
        pitch_ratio: P/D of the table: a multiplier on P4119's pitch.
        f1, f2: as printed.
    """

    name: str
    length: float
    breadth: float
    draft: float
    block_coefficient: float
    blade_count: int
    diameter: float
    pitch_ratio: float
    f1: float
    f2: float

    @property
    def displaced_volume(self) -> float:
        """CB L B d in m3."""
        return self.block_coefficient * self.length * self.breadth * self.draft

    def variables(self, case: Case, initial_volume: float) -> DesignVariables:
        """The design in our variables.

        Args:
            case: gives what the table does not: EAR and LCB stay the initial design's.
            initial_volume: V0 in m3, which the displacement ratio refers to.
        """
        return case.initial.variables.replaced(
            {
                "length_to_breadth": self.length / self.breadth,
                "breadth_to_draft": self.breadth / self.draft,
                "draft": self.draft,
                "diameter": self.diameter,
                "blade_count": self.blade_count,
                "pitch_ratio": self.pitch_ratio,
                "displacement_ratio": self.displaced_volume / initial_volume,
            },
            f"the paper's {self.name}",
        )


@dataclass(frozen=True)
class PaperPoint:
    """A column of Table 4: a design at a Froude number.

    Attributes:
        design: its row of Table 3.
        froude_number: on its own length.
        total_resistance: in N.
        advance_coefficient, thrust_coefficient, ten_torque_coefficient, open_water_efficiency: as printed.
        rotation_rate_rpm: 1/min.
    """

    design: PaperDesign
    froude_number: float
    total_resistance: float
    advance_coefficient: float
    rotation_rate_rpm: float
    thrust_coefficient: float
    ten_torque_coefficient: float
    open_water_efficiency: float

    @property
    def speed(self) -> float:
        """V in m/s."""
        return self.froude_number * math.sqrt(PAPER_GRAVITY * self.design.length)

    @property
    def implied_wake(self) -> float:
        """w = 1 - J n D/V: the wake fraction that the printed numbers imply."""
        advance_speed = self.advance_coefficient * self.rotation_rate_rpm / 60.0 * self.design.diameter
        return 1.0 - advance_speed / self.speed

    @property
    def fitted_wake(self) -> float:
        """w at the printed CB by the quadratic fit of Taylor's table."""
        return wake_fraction(self.design.block_coefficient)

    def thrust(self, density: float) -> float:
        """T = KT rho n^2 D^4 in N."""
        rate = self.rotation_rate_rpm / 60.0
        return self.thrust_coefficient * density * rate**2 * self.design.diameter**4

    def delivered_power(self, density: float) -> float:
        """2 pi n Q in W."""
        rate = self.rotation_rate_rpm / 60.0
        return 2.0 * math.pi * rate**3 * 0.1 * self.ten_torque_coefficient * density * self.design.diameter**5

    @property
    def effective_power(self) -> float:
        """Rt V in W."""
        return self.total_resistance * self.speed

    def implied_deduction(self, density: float) -> float:
        """t = 1 - Rt/T: negative where the thrust is less than the resistance."""
        return 1.0 - self.total_resistance / self.thrust(density)

    @property
    def recomputed_efficiency(self) -> float:
        """J KT/(2 pi KQ) from the printed numbers."""
        return self.advance_coefficient * self.thrust_coefficient / (0.2 * math.pi * self.ten_torque_coefficient)


def _rows(name: str) -> list[dict[str, str]]:
    lines = [line for line in read_asset_text("reference", name).splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


@cache
def table1() -> tuple[tuple[float, float], ...]:
    """(Froude number, weight) of each condition."""
    return tuple((float(row["froude_number"]), float(row["weight"])) for row in _rows("paper_table1.csv"))


@cache
def table2() -> dict[str, tuple[float, float]]:
    """Bounds by variable."""
    return {row["variable"]: (float(row["lower"]), float(row["upper"])) for row in _rows("paper_table2.csv")}


@cache
def table3() -> tuple[PaperDesign, ...]:
    """The initial and the optimal designs."""
    return tuple(
        PaperDesign(
            name=row["design"],
            blade_count=int(row["blade_count"]),
            **{key: float(value) for key, value in row.items() if key not in ("design", "blade_count")},
        )
        for row in _rows("paper_table3.csv")
    )


@cache
def table4() -> tuple[PaperPoint, ...]:
    """The operating points of the initial and the compromise design."""
    designs = {design.name: design for design in table3()}
    return tuple(
        PaperPoint(
            design=designs[row["design"]], **{key: float(value) for key, value in row.items() if key != "design"}
        )
        for row in _rows("paper_table4.csv")
    )


def points_of(name: str) -> tuple[PaperPoint, ...]:
    """Table 4's points of a design, in the order of the conditions."""
    return tuple(point for point in table4() if point.design.name == name)


def objectives_from_table4() -> tuple[float, float]:
    """f1 and f2 of the compromise design, recomputed from Table 4 with the weights of Table 1."""
    weights = [weight for _, weight in table1()]
    before, after = points_of(INITIAL), points_of(COMPROMISE)
    f1 = sum(w * b.total_resistance / a.total_resistance for w, a, b in zip(weights, before, after, strict=True))
    f2 = sum(
        w * a.open_water_efficiency / b.open_water_efficiency for w, a, b in zip(weights, before, after, strict=True)
    )
    return f1, f2
