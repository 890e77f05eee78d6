"""Design variables and the space that they live in."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from hpsop_core.case.fields import FieldRule, checked_value, unknown_name
from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array

# What a variable may ever be, whatever the bounds of a case: outside, the parents' families mean nothing.
VARIABLE_RULES: dict[str, FieldRule] = {
    "length_to_breadth": FieldRule("number", "length over breadth, L/B", "", 3.0, 15.0),
    "breadth_to_draft": FieldRule("number", "breadth over draft, B/d", "", 1.5, 8.0),
    "draft": FieldRule("number", "draft, d", "m", 0.01, 40.0),
    "diameter": FieldRule("number", "propeller diameter, D", "m", 0.01, 20.0),
    "blade_count": FieldRule("integer", "number of blades, Z", "", 2, 7),
    "pitch_ratio": FieldRule("number", "multiplier on the parent propeller's pitch", "", 0.5, 1.5),
    "displacement_ratio": FieldRule("number", "displacement over the initial design's", "", 0.5, 1.5),
    "expanded_area_ratio": FieldRule("number", "expanded area ratio, EAR", "", 0.3, 1.2),
    "buoyancy_centre_shift": FieldRule("number", "shift of LCB forward, as a fraction of L", "", -0.05, 0.05),
}
VARIABLE_NAMES = tuple(VARIABLE_RULES)
_BLADE_COUNT = VARIABLE_NAMES.index("blade_count")


@dataclass(frozen=True)
class DesignVariables:
    """The nine numbers that name a design: the paper's six and the three of DESIGN section 3.

    Attributes:
        length_to_breadth, breadth_to_draft: hull proportions.
        draft: in m.
        diameter: of the propeller, in m.
        blade_count: Z.
        pitch_ratio: multiplier on the parent propeller's pitch.
        displacement_ratio: displacement over the initial design's.
        expanded_area_ratio: EAR.
        buoyancy_centre_shift: LCB's shift forward from the parent's place, as a fraction of L.
    """

    length_to_breadth: float
    breadth_to_draft: float
    draft: float
    diameter: float
    blade_count: int
    pitch_ratio: float
    displacement_ratio: float
    expanded_area_ratio: float
    buoyancy_centre_shift: float

    @property
    def breadth(self) -> float:
        """B in m."""
        return self.breadth_to_draft * self.draft

    @property
    def length(self) -> float:
        """Lpp in m."""
        return self.length_to_breadth * self.breadth

    def as_dict(self) -> dict[str, float | int]:
        """The variables by name, as in the contract's JSON."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def from_dict(cls, values: Mapping[str, object], where: str = "design variables") -> DesignVariables:
        """Checked variables from a mapping of all nine names.

        Raises:
            InputError: a name is unknown or missing, or a value is no number or out of every sensible range.
        """
        for name in values:
            if name not in VARIABLE_RULES:
                raise unknown_name(name, VARIABLE_NAMES, where)
        missing = [name for name in VARIABLE_NAMES if name not in values]
        if missing:
            raise InputError(f"{where}: '{missing[0]}' is missing; state all of {', '.join(VARIABLE_NAMES)}")
        return cls(
            **{name: checked_value(values[name], rule, f"{where}: {name}") for name, rule in VARIABLE_RULES.items()}
        )

    def replaced(self, changes: Mapping[str, object], where: str = "design variables") -> DesignVariables:
        """The same design with some variables changed; checked like ``from_dict``."""
        return DesignVariables.from_dict({**self.as_dict(), **changes}, where)

    def key(self) -> tuple[float, ...]:
        """The exact numbers in the fixed order: two designs are the same if their keys are."""
        return tuple(float(getattr(self, name)) for name in VARIABLE_NAMES)


@dataclass(frozen=True)
class DesignSpace:
    """Lower and upper bounds of the nine variables; a variable with equal bounds is fixed.

    The optimiser works on a real vector over the free variables in which Z is relaxed to [Z_lower - 1/2, Z_upper +
    1/2) and decoded by floor(z + 1/2), so that a uniform sample gives every blade count an equal share.

    Attributes:
        lower, upper: nine bounds each, in the order of ``VARIABLE_NAMES``.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @classmethod
    def from_bounds(cls, bounds: Mapping[str, Sequence[float]], where: str = "bounds") -> DesignSpace:
        """A checked space from (lower, upper) by variable name.

        Raises:
            InputError: an unknown or missing name, a value that is no finite number or out of range, a half blade, or
                reversed bounds.
        """
        for name in bounds:
            if name not in VARIABLE_RULES:
                raise unknown_name(name, VARIABLE_NAMES, where)
        lower, upper = [], []
        for name, rule in VARIABLE_RULES.items():
            if name not in bounds:
                raise InputError(f"{where}: '{name}' is missing; write {name} = [lower, upper]")
            pair = bounds[name]
            if isinstance(pair, str) or not isinstance(pair, Sequence) or len(pair) != 2:
                raise InputError(f"{where}: {name} needs two numbers; write {name} = [lower, upper]")
            low, high = (checked_value(value, rule, f"{where}: {name}") for value in pair)
            if low > high:
                raise InputError(f"{where}: {name} has reversed bounds {low:g} > {high:g}; write the smaller one first")
            lower.append(float(low))
            upper.append(float(high))
        return cls(tuple(lower), tuple(upper))

    def as_dict(self) -> dict[str, tuple[float, float]]:
        """(lower, upper) by variable name."""
        return {name: (self.lower[i], self.upper[i]) for i, name in enumerate(VARIABLE_NAMES)}

    @property
    def free(self) -> tuple[int, ...]:
        """Indices into ``VARIABLE_NAMES`` of the variables that are not fixed."""
        return tuple(i for i, (low, high) in enumerate(zip(self.lower, self.upper, strict=True)) if low < high)

    @property
    def blade_count_position(self) -> int | None:
        """Where in the free vector the relaxed blade count stands, or None when it is fixed."""
        return self.free.index(_BLADE_COUNT) if _BLADE_COUNT in self.free else None

    @property
    def relaxed_lower(self) -> Array:
        """Lower bounds of the free vector, shape (free,)."""
        return np.array([self.lower[i] - (0.5 if i == _BLADE_COUNT else 0.0) for i in self.free])

    @property
    def relaxed_upper(self) -> Array:
        """Upper bounds of the free vector, shape (free,); the relaxed blade count stays below its half."""
        return np.array(
            [np.nextafter(self.upper[i] + 0.5, 0.0) if i == _BLADE_COUNT else self.upper[i] for i in self.free]
        )

    def decode(self, vector: Sequence[float] | Array) -> DesignVariables:
        """The design that a free vector, shape (free,), stands for; values beyond the bounds are clamped to them.

        Raises:
            ValueError: the vector has the wrong length or holds a number that is not finite.
        """
        if len(vector) != len(self.free):
            raise ValueError(f"a vector of {len(vector)} numbers for {len(self.free)} free variables")
        values = list(self.lower)
        for value, i in zip(vector, self.free, strict=True):
            if not math.isfinite(value):
                raise ValueError(f"{VARIABLE_NAMES[i]} is not a finite number")
            decoded = math.floor(float(value) + 0.5) if i == _BLADE_COUNT else float(value)
            values[i] = min(max(float(decoded), self.lower[i]), self.upper[i])
        named = dict(zip(VARIABLE_NAMES, values, strict=True))
        blade_count = round(named.pop("blade_count"))
        return DesignVariables(blade_count=blade_count, **named)

    def encode(self, variables: DesignVariables) -> Array:
        """The free vector, shape (free,), that decodes to ``variables`` if they lie inside the bounds."""
        key = variables.key()
        return np.array([key[i] for i in self.free])

    def project(self, variables: DesignVariables) -> DesignVariables:
        """The nearest design inside the bounds, variable by variable."""
        clamped = {
            name: min(max(value, low), high)
            for name, value, low, high in zip(VARIABLE_NAMES, variables.key(), self.lower, self.upper, strict=True)
        }
        blade_count = round(clamped.pop("blade_count"))
        return DesignVariables(blade_count=blade_count, **clamped)

    def contains(self, variables: DesignVariables) -> bool:
        """Whether a design lies inside the bounds."""
        return all(
            low <= value <= high for value, low, high in zip(variables.key(), self.lower, self.upper, strict=True)
        )
