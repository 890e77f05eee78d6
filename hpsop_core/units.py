"""Units that follow the size of the ship: a tanker's power reads in MW, a six metre model's in W, each with its digits.

Numbers are declared once in a ship's units; a ``Size`` says in which unit and with how many digits they are written for
a ship of that size, so that all designs of one case share their units. Nothing here changes a number that is computed
or stored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

_LADDERS: dict[str, tuple[tuple[str, float], ...]] = {
    "MW": (("MW", 1.0), ("kW", 1e3), ("W", 1e6)),
    "kN": (("kN", 1.0), ("N", 1e3)),
    "kN m": (("kN m", 1.0), ("N m", 1e3)),
    "t": (("t", 1.0), ("kg", 1e3)),
    "t/h": (("t/h", 1.0), ("kg/h", 1e3), ("g/h", 1e6)),
    "m²": (("m²", 1.0),),
    "m³": (("m³", 1.0),),
}
"""A ship's unit, and the smaller ones in its place, each so many to the ship's."""
_AXES: dict[str, tuple[tuple[str, float, float], ...]] = {
    "force": (("MN", 1e-6, 1e5), ("kN", 1e-3, 1e2), ("N", 1.0, 0.0)),
    "power": (("MW", 1e-6, 1e6), ("kW", 1e-3, 1e3), ("W", 1.0, 0.0)),
}
"""Units of axes: name, of one SI unit, and the least greatest value in SI units that asks for it."""
_DIGITS = 4
# What follows is only to choose units: a frictional resistance with a little more, ITTC-57's 0.0015 to 0.004 of a
# ship's and a model's Reynolds numbers; Mumford's wetted surface; and usual efficiencies and consumptions.
_RESISTANCE_COEFFICIENT = 0.0025
_BLOCK_COEFFICIENT = 0.7
_PROPULSIVE_EFFICIENCY = 0.7
_TONNES_PER_JOULE = 200e-6 / 3.6e6
_TORQUE_PER_THRUST_AND_DRAFT = 0.1
_STEPS_TO_DRAFT = 500.0


@dataclass(frozen=True)
class Unit:
    """How a number is written that is declared in a ship's unit.

    Attributes:
        symbol: of the unit.
        factor: the written number over the declared one.
        decimals: digits after the point.
    """

    symbol: str
    factor: float
    decimals: int


@dataclass(frozen=True)
class Size:
    """What a ship's numbers are of the order of, by a ship's unit: MW, kN, kN m, t, t/h, m², m³; and its draft in m."""

    orders: tuple[tuple[str, float], ...] = ()
    draft: float = math.inf

    def unit(self, declared: str, decimals: int, digits: int = _DIGITS) -> Unit:
        """The unit of a number that is declared in a ship's.

        Args:
            declared: the ship's unit.
            decimals: digits after the point of a ship's numbers, which remain where the unit does, or more.
            digits: that a number of the usual order shall have.
        """
        if declared == "m":
            # as a variable's: a length is told to a five-hundredth of the draft
            fine = 0 if math.isinf(self.draft) else -math.floor(math.log10(self.draft / _STEPS_TO_DRAFT))
            return Unit(declared, 1.0, max(decimals, fine))
        order = dict(self.orders).get(declared)
        if order is None:
            return Unit(declared, 1.0, decimals)
        ladder = _LADDERS[declared]
        symbol, factor = next(((word, of) for word, of in ladder if order * of >= 1.0), ladder[-1])
        wanted = digits - 1 - math.floor(math.log10(order * factor))
        return Unit(symbol, factor, max(decimals if factor == 1.0 else 0, wanted))


SHIP_SIZE = Size()
"""Of a ship: every number in the unit in which it is declared."""


def size_of_ship(length: float, breadth: float, draft: float, speed: float, density: float = 1025.0) -> Size:
    """The size of a ship of these dimensions (m) at this speed (m/s) in water of this density (kg/m³)."""
    surface = length * (1.7 * draft + _BLOCK_COEFFICIENT * breadth)
    volume = _BLOCK_COEFFICIENT * length * breadth * draft
    force = 0.5 * density * speed**2 * surface * _RESISTANCE_COEFFICIENT
    power = force * speed / _PROPULSIVE_EFFICIENCY
    found = {
        "MW": 1e-6 * power,
        "kN": 1e-3 * force,
        "kN m": 1e-3 * force * draft * _TORQUE_PER_THRUST_AND_DRAFT,
        "t": 1e-3 * density * volume,
        "t/h": power * _TONNES_PER_JOULE * 3600.0,
        "m²": surface,
        "m³": volume,
    }
    return Size(tuple((unit, order) for unit, order in found.items() if 0.0 < order < math.inf), draft)


def axis_unit(kind: str, greatest: float) -> tuple[str, float]:
    """The unit of an axis of "force" or "power" whose greatest value (N, W) is known, and what one SI unit is in it."""
    return next((word, of) for word, of, least in _AXES[kind] if greatest >= least or least == 0.0)


def written(value: float, declared: str, decimals: int) -> str:
    """One number that stands alone, declared in a ship's unit, in the unit of its own size: "84.51 W"."""
    unit = (Size(((declared, abs(value)),)) if value else SHIP_SIZE).unit(declared, decimals)
    return f"{number_text(unit.factor * value, unit.decimals)} {unit.symbol}"


def number_text(value: float | None, decimals: int) -> str:
    """Fixed decimals, a true minus, a space between thousands; a dash for nothing."""
    if value is None or not math.isfinite(value):
        return "–"
    text = f"{value:,.{decimals}f}".replace(",", " ").replace("-", "−")
    return text.replace("−", "", 1) if not text.strip("−0. ") else text
