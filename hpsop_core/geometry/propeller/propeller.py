"""Propellers and the family that grows from a parent blade."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from hpsop_core.assets import SHIPPED_PROPELLERS, asset_path
from hpsop_core.errors import InputError
from hpsop_core.geometry.propeller.input import radial_table_from_csv, radial_table_from_text
from hpsop_core.geometry.propeller.radial_table import BladeSections, RadialTable

__all__ = [
    "BladeSections",
    "Propeller",
    "RadialTable",
    "load_propeller",
    "propeller_family",
    "radial_table_from_csv",
]

BLADE_COUNT_RANGE = (2, 9)
_THICKNESS_EXPONENT = 2.0 / 3.0


@dataclass(frozen=True, eq=False)
class Propeller:
    """A propeller: a blade's own radial table, how many of it, and how large.

    Attributes:
        diameter: D in m.
        blade_count: Z.
        pitch_ratio: multiplier m on the parent's pitch distribution (1 is the parent).
        expanded_area_ratio: expanded blade area over disc area, integrated from the table.
        hub_ratio: hub radius over tip radius.
        table: the propeller's own scaled table.
    """

    diameter: float
    blade_count: int
    pitch_ratio: float
    expanded_area_ratio: float
    hub_ratio: float
    table: RadialTable

    @property
    def pitch_diameter_ratio_07R(self) -> float:
        """Absolute P/D at 0.7 R."""
        return float(self.table.at_07R.pitch_ratio)

    def with_diameter(self, diameter: float) -> Propeller:
        """The geometrically similar propeller of another diameter (a model of it, for example), D in m."""
        _check_positive("diameter", diameter)
        return replace(self, diameter=float(diameter))


def _check_positive(name: str, value: float) -> None:
    if not (isinstance(value, int | float | np.floating | np.integer) and math.isfinite(value) and value > 0.0):
        raise InputError(f"propeller {name} {value} is not a positive finite number")


@lru_cache(maxsize=8)
def load_propeller(name: str = "p4119") -> RadialTable:
    """The shipped radial table ``name``.

    Raises:
        InputError: there is no such shipped propeller.
    """
    if name not in SHIPPED_PROPELLERS:
        choice = ", ".join(sorted(SHIPPED_PROPELLERS))
        raise InputError(f"propeller '{name}' is not shipped; choose one of {choice} or give a CSV file")
    text = asset_path("propellers", f"{name}.csv").read_text(encoding="utf-8")
    return radial_table_from_text(text, f"{name}.csv", name, SHIPPED_PROPELLERS[name])


def propeller_family(
    parent: RadialTable,
    diameter: float,
    blade_count: int,
    pitch_ratio: float = 1.0,
    expanded_area_ratio: float | None = None,
) -> Propeller:
    """A member of the family of ``parent``.

    The rules (docs/geometry-propeller.md): the chords are scaled by one factor, so that the expanded area ratio is
    reached at every number of blades; t/D is scaled by (Z_parent/Z)^(2/3), whatever the chords do; the pitch is
    multiplied by ``pitch_ratio``; f/c, skew, rake and the hub ratio are kept.

    Args:
        parent: the parent's table.
        diameter: D in m.
        blade_count: Z, 2 to 9.
        pitch_ratio: multiplier on the parent's pitch, 0.3 to 2.
        expanded_area_ratio: 0.15 to 1.3; None takes the parent's own with its own number of blades, so that the
            parent's number of blades and multiplier 1 give back the parent's table.

    Raises:
        InputError: a value is not finite or outside what the family can be.
    """
    _check_positive("diameter", diameter)
    _check_positive("blade_count", blade_count)
    low, high = BLADE_COUNT_RANGE
    if int(blade_count) != blade_count or not low <= blade_count <= high:
        raise InputError(f"propeller blade_count {blade_count} must be a whole number from {low} to {high}")
    blade_count = int(blade_count)
    _check_positive("pitch_ratio", pitch_ratio)
    if not 0.3 <= pitch_ratio <= 2.0:
        raise InputError(f"propeller pitch_ratio {pitch_ratio:g} multiplies the parent's pitch and must be 0.3 to 2")
    per_blade = parent.expanded_area_ratio_per_blade
    target = parent.blade_count * per_blade if expanded_area_ratio is None else expanded_area_ratio
    _check_positive("expanded_area_ratio", target)
    if not 0.15 <= target <= 1.3:
        raise InputError(f"propeller expanded_area_ratio {target:g} must be 0.15 to 1.3")
    chord_factor = target / (blade_count * per_blade)
    thickness_factor = (parent.blade_count / blade_count) ** _THICKNESS_EXPONENT
    table = replace(
        parent,
        name=parent.name,
        chord_ratio=parent.chord_ratio * chord_factor,
        pitch_ratio=parent.pitch_ratio * float(pitch_ratio),
        thickness_ratio=parent.thickness_ratio * (thickness_factor / chord_factor),
        blade_count=blade_count,
    )
    return Propeller(
        diameter=float(diameter),
        blade_count=blade_count,
        pitch_ratio=float(pitch_ratio),
        expanded_area_ratio=float(target),
        hub_ratio=table.hub_ratio,
        table=table,
    )
