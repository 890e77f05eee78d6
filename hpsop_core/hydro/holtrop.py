"""Holtrop and Mennen's method: form factor, appendages, allowance, wake, thrust deduction, eta_R of a single screw.

J. Holtrop, G. G. J. Mennen: An approximate power prediction method. International Shipbuilding Progress 29 (1982), pp.
166-170; symbols as there. Wave resistance is not taken from it: the project's own solvers know the hull's shape.
A regression over model tests and trials, so it holds for ships like those of its sample: see ``outside``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from hpsop_core.errors import SolverFailure

STAGE = "holtrop"


@dataclass(frozen=True)
class HoltropHull:
    """What the method knows of a hull.

    Attributes:
        length: L on the waterline, in m.
        breadth: B in m.
        draft: T in m, on even keel.
        displaced_volume: moulded, in m3.
        midship_coefficient: C_M.
        buoyancy_centre: lcb, forward of L/2, in per cent of L.
        wetted_surface: S of the bare hull, in m2.
        bulb_area: A_BT, transverse area of the bulb where the still water meets the stem, in m2.
        bulb_centre_height: h_B, of its centroid above the keel, in m.
        stern_shape: C_stern: -25 pram with gondola, -10 V sections, 0 normal, +10 U sections with Hogner stern.
        appendage_area: wetted, in m2.
        appendage_form_factor: 1 + k2; 1.5 for a rudder behind a stern.

    Raises:
        SolverFailure: C_P, lcb or C_B lie where the formulas have no value.
    """

    length: float
    breadth: float
    draft: float
    displaced_volume: float
    midship_coefficient: float
    buoyancy_centre: float
    wetted_surface: float
    bulb_area: float = 0.0
    bulb_centre_height: float = 0.0
    stern_shape: float = 0.0
    appendage_area: float = 0.0
    appendage_form_factor: float = 1.0

    def __post_init__(self) -> None:
        prismatic, block = self.prismatic_coefficient, self.block_coefficient
        for name, value, lower, upper in (
            ("C_P", prismatic, 0.3, 0.94),
            ("C_B", block, 0.2, 0.94),
            ("1 - C_P + 0.0225 lcb", 1.0 - prismatic + 0.0225 * self.buoyancy_centre, 0.0, 1.0),
            ("1 - C_P1", 1.0 - self.stern_prismatic_coefficient, 0.02, 2.0),
        ):
            if not lower < value < upper:
                raise SolverFailure(
                    STAGE,
                    f"Holtrop's formulas have no value at {name} {value:.3f}, which must lie between {lower:g} and "
                    f"{upper:g}; state form factor, wake and thrust deduction instead",
                )

    @property
    def block_coefficient(self) -> float:
        """C_B on the waterline length."""
        return self.displaced_volume / (self.length * self.breadth * self.draft)

    @property
    def prismatic_coefficient(self) -> float:
        """C_P on the waterline length."""
        return self.block_coefficient / self.midship_coefficient

    @property
    def stern_prismatic_coefficient(self) -> float:
        """C_P1 = 1.45 C_P - 0.315 - 0.0225 lcb."""
        return 1.45 * self.prismatic_coefficient - 0.315 - 0.0225 * self.buoyancy_centre

    @property
    def total_wetted_surface(self) -> float:
        """Hull and appendages, in m2; allowance and wake refer to it, as the published example does."""
        return self.wetted_surface + self.appendage_area


def run_length(hull: HoltropHull) -> float:
    """L_R = L (1 - C_P + 0.06 C_P lcb/(4 C_P - 1)), the length of the run in m."""
    prismatic = hull.prismatic_coefficient
    return hull.length * (1.0 - prismatic + 0.06 * prismatic * hull.buoyancy_centre / (4.0 * prismatic - 1.0))


def form_factor(hull: HoltropHull) -> float:
    """k1 on the friction of ITTC-57.

    1 + k1 = c13 (0.93 + c12 (B/L_R)^0.92497 (0.95 - C_P)^-0.521448 (1 - C_P + 0.0225 lcb)^0.6906).
    """
    prismatic = hull.prismatic_coefficient
    slender = hull.draft / hull.length
    if slender > 0.05:
        c12 = slender**0.2228446
    elif slender > 0.02:
        c12 = 48.20 * (slender - 0.02) ** 2.078 + 0.479948
    else:
        c12 = 0.479948
    c13: float = 1.0 + 0.003 * hull.stern_shape
    run: float = (hull.breadth / run_length(hull)) ** 0.92497
    ends: float = (0.95 - prismatic) ** -0.521448 * (1.0 - prismatic + 0.0225 * hull.buoyancy_centre) ** 0.6906
    factor: float = c13 * (0.93 + c12 * run * ends) - 1.0
    return factor


def total_form_factor(hull: HoltropHull) -> float:
    """k of hull and appendages together: 1 + k1 + (k2 - k1) S_APP/S_tot, less 1."""
    bare = form_factor(hull)
    share = hull.appendage_area / hull.total_wetted_surface
    return bare + (hull.appendage_form_factor - 1.0 - bare) * share


def correlation_allowance(hull: HoltropHull) -> float:
    """C_A for a hull roughness of 150 micrometres.

    C_A = 0.006 (L + 100)^-0.16 - 0.00205 + 0.003 sqrt(L/7.5) C_B^4 c2 (0.04 - c4), c4 = min(T_F/L, 0.04).
    """
    length, block = hull.length, hull.block_coefficient
    c4 = min(hull.draft / length, 0.04)
    slender = 0.003 * math.sqrt(length / 7.5) * block**4 * bulb_factor(hull) * (0.04 - c4)
    allowance: float = 0.006 * (length + 100.0) ** -0.16 - 0.00205 + slender
    return allowance


def bulb_factor(hull: HoltropHull) -> float:
    """c2 = exp(-1.89 sqrt(c3)), c3 = 0.56 A_BT^1.5/(B T (0.31 sqrt(A_BT) + T_F - h_B)); 1 without a bulb."""
    if hull.bulb_area <= 0.0:
        return 1.0
    depth = 0.31 * math.sqrt(hull.bulb_area) + hull.draft - hull.bulb_centre_height
    return math.exp(-1.89 * math.sqrt(0.56 * hull.bulb_area**1.5 / (hull.breadth * hull.draft * depth)))


def viscous_coefficient(form_factor_on_friction: float, friction_coefficient: float, allowance: float) -> float:
    """C_V = (1 + k) C_F + C_A, on which the wake depends."""
    return (1.0 + form_factor_on_friction) * friction_coefficient + allowance


def wake_fraction(hull: HoltropHull, viscous: float, diameter: float) -> float:
    """Effective wake fraction w of a single-screw ship.

    w = c9 C_V L/T_A (0.0661875 + 1.21756 c11 C_V/(1 - C_P1)) + 0.24558 sqrt(B/(L (1 - C_P1))) - 0.09726/(0.95 - C_P)
        + 0.11434/(0.95 - C_B) + 0.75 C_stern C_V + 0.002 C_stern.

    Args:
        hull: of the ship.
        viscous: C_V, see ``viscous_coefficient``.
        diameter: D in m.

    Raises:
        SolverFailure: the formula leaves 0 to 0.6.
    """
    length, breadth, draft, stern = hull.length, hull.breadth, hull.draft, hull.stern_shape
    run = 1.0 - hull.stern_prismatic_coefficient
    surface = hull.total_wetted_surface
    if breadth / draft < 5.0:
        c8 = breadth * surface / (length * diameter * draft)
    else:
        c8 = surface * (7.0 * breadth / draft - 25.0) / (length * diameter * (breadth / draft - 3.0))
    c9 = c8 if c8 < 28.0 else 32.0 - 16.0 / (c8 - 24.0)
    submergence = draft / diameter
    c11 = submergence if submergence < 2.0 else 0.0833333 * submergence**3 + 1.33333
    wake = (
        c9 * viscous * length / draft * (0.0661875 + 1.21756 * c11 * viscous / run)
        + 0.24558 * math.sqrt(breadth / (length * run))
        - 0.09726 / (0.95 - hull.prismatic_coefficient)
        + 0.11434 / (0.95 - hull.block_coefficient)
        + 0.75 * stern * viscous
        + 0.002 * stern
    )
    return _within("w", wake)


def thrust_deduction(hull: HoltropHull, diameter: float) -> float:
    """Thrust deduction t of a single-screw ship.

    t = 0.001979 L/(B - B C_P1) + 1.0585 c10 - 0.00524 - 0.1418 D^2/(B T) + 0.0015 C_stern.

    Args:
        hull: of the ship.
        diameter: D in m.

    Raises:
        SolverFailure: the formula leaves 0 to 0.6.
    """
    length, breadth = hull.length, hull.breadth
    if length / breadth > 5.2:
        c10 = breadth / length
    else:
        c10 = 0.25 - 0.003328402 / (breadth / length - 0.134615385)
    deduction = (
        0.001979 * length / (breadth * (1.0 - hull.stern_prismatic_coefficient))
        + 1.0585 * c10
        - 0.00524
        - 0.1418 * diameter**2 / (breadth * hull.draft)
        + 0.0015 * hull.stern_shape
    )
    return _within("t", deduction)


def relative_rotative_efficiency(hull: HoltropHull, expanded_area_ratio: float) -> float:
    """eta_R = 0.9922 - 0.05908 A_E/A_0 + 0.07424 (C_P - 0.0225 lcb) of a single-screw ship."""
    return (
        0.9922 - 0.05908 * expanded_area_ratio + 0.07424 * (hull.prismatic_coefficient - 0.0225 * hull.buoyancy_centre)
    )


def _within(name: str, value: float) -> float:
    if not 0.0 <= value <= 0.6:
        raise SolverFailure(STAGE, f"Holtrop's {name} {value:.3f} is outside 0 to 0.6; state it instead")
    return value


# The span of the ship types that the authors list for their regression (1978, carried on by 1982): full tankers to slim
# container ships and frigates.
RANGES = {"C_P": (0.55, 0.85), "L/B": (3.9, 9.5), "B/T": (2.1, 4.0)}
GREATEST_FROUDE_NUMBER = 0.45


def outside(hull: HoltropHull, froude_number: float) -> tuple[str, ...]:
    """Which of the hull's numbers lie outside the ships of the regression, in words; empty where none does.

    Args:
        hull: of the ship.
        froude_number: V/sqrt(g L), the greatest that is asked.
    """
    values = {
        "C_P": hull.prismatic_coefficient,
        "L/B": hull.length / hull.breadth,
        "B/T": hull.breadth / hull.draft,
    }
    found = [
        f"{name} {values[name]:.2f} ({low:g} to {high:g})"
        for name, (low, high) in RANGES.items()
        if not low <= values[name] <= high
    ]
    if froude_number > GREATEST_FROUDE_NUMBER:
        found.append(f"Fn {froude_number:.3f} (up to {GREATEST_FROUDE_NUMBER:g})")
    return tuple(found)
