"""Design variables, each declared once, and the space that they live in.

Fields of [initial] and [bounds], sliders, tables, charts, the report and docs/case.md are made from these entries.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from hpsop_core.case.declared_variable import declared_variables, variable
from hpsop_core.case.fields import checked_value, unknown_name
from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array


@dataclass(frozen=True, kw_only=True)
class Proportions:
    """The hull's proportions; an initial design states its main dimensions instead."""

    length_to_breadth: float = variable(
        "length / breadth",
        "L/B",
        "length over breadth, L/B",
        (2.0, 25.0),
        bounds=(0.93, 1.22),
        reach=(0.8, 1.36),
        initial=355.0 / 51.0,
        step=0.01,
        bounds_required=True,
    )
    breadth_to_draft: float = variable(
        "breadth / draft",
        "B/d",
        "breadth over draft, B/d",
        (0.9, 14.0),
        bounds=(0.85, 1.28),
        reach=(0.72, 1.42),
        initial=51.0 / 14.5,
        step=0.01,
        bounds_required=True,
    )


@dataclass(frozen=True, kw_only=True)
class StatedVariables:
    """The variables that an initial design states as they are: [initial] has these very fields.

    A new variable stands at the end: a run file names a design by its numbers in this order.
    """

    draft: float = variable(
        "draft",
        "d",
        "draft, d",
        (0.01, 40.0),
        unit="m",
        decimals=2,
        bounds=(0.965, 1.0),
        reach=(0.76, 1.17),
        initial=14.5,
        bounds_required=True,
    )
    diameter: float = variable(
        "propeller diameter",
        "D",
        "propeller diameter, D",
        (0.01, 20.0),
        unit="m",
        decimals=2,
        bounds=(0.945, 1.055),
        reach=(0.78, 1.22),
        initial=9.0,
        bounds_required=True,
    )
    blade_count: int = variable(
        "blades",
        "Z",
        "number of blades, Z",
        (2, 7),
        whole=True,
        decimals=0,
        spread="range",
        bounds=(3, 7),
        reach=(3, 7),
        initial=3,
        step=1,
        bounds_required=True,
    )
    pitch_ratio: float = variable(
        "pitch multiplier",
        "P/P₀",
        "multiplier on the parent propeller's pitch",
        (0.5, 1.5),
        bounds=(0.95, 1.05),
        reach=(0.7, 1.3),
        initial=1.0,
        step=0.001,
        bounds_required=True,
    )
    displacement_ratio: float = variable(
        "displacement ratio",
        "∇/∇₀",
        "displacement over the initial design's",
        (0.2, 5.0),
        initial_meaning="displacement over the parent form's at these dimensions",
        bounds=(0.95, 1.05),
        reach=(0.8, 1.2),
        initial=1.0,
        step=0.001,
    )
    expanded_area_ratio: float = variable(
        "expanded area ratio",
        "EAR",
        "expanded area ratio, EAR",
        (0.3, 1.2),
        bounds=(1.0, 1.0),
        reach=(0.58, 1.81),
        initial=0.607,
        step=0.001,
    )
    buoyancy_centre_shift: float = variable(
        "LCB shift / L",
        "ΔLCB/L",
        "shift of LCB forward, as a fraction of L",
        (-0.05, 0.05),
        shown_unit="%",
        scale=100.0,
        decimals=2,
        spread="shift",
        bounds=(0.0, 0.0),
        reach=(-0.025, 0.025),
        initial=0.0,
        step=0.0005,
    )


@dataclass(frozen=True, kw_only=True)
class StandIns:
    """What a case may search in the place of a variable that names designs, which then follows from it."""

    block_coefficient_ratio: float = variable(
        "block coefficient ratio",
        "CB/CB₀",
        "block coefficient over the initial design's",
        (0.5, 1.5),
        bounds=(0.95, 1.05),
        reach=(0.8, 1.2),
        initial=1.0,
        step=0.001,
    )


# A dataclass takes the fields of its last base first: the proportions lead.
@dataclass(frozen=True, kw_only=True)
class DesignVariables(StatedVariables, Proportions):
    """The numbers that name a design, as its two bases declare them."""

    @property
    def breadth(self) -> float:
        """B in m."""
        return self.breadth_to_draft * self.draft

    @property
    def length(self) -> float:
        """Lpp in m."""
        return self.length_to_breadth * self.breadth

    @property
    def box(self) -> float:
        """L B d in m3: displacement over block coefficient."""
        return self.length * self.breadth * self.draft

    def block_coefficient_ratio(self, initial: DesignVariables) -> float:
        """CB over the initial design's, without a hull: both displacements are over the same one."""
        return self.displacement_ratio / (self.box / initial.box)

    def as_dict(self) -> dict[str, float | int]:
        """The variables by name, as in the contract's JSON."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def from_dict(cls, values: Mapping[str, object], where: str = "design variables") -> DesignVariables:
        """Checked variables from a mapping of all names.

        Raises:
            InputError: a name is unknown or missing, or a value is no number or out of every sensible range.
        """
        for name in values:
            if name not in VARIABLE_TABLE:
                raise unknown_name(name, VARIABLE_NAMES, where)
        missing = [name for name in VARIABLE_NAMES if name not in values]
        if missing:
            raise InputError(f"{where}: '{missing[0]}' is missing; state all of {', '.join(VARIABLE_NAMES)}")
        return cls(
            **{
                name: checked_value(values[name], item.rule, f"{where}: {name}")
                for name, item in VARIABLE_TABLE.items()
            }
        )

    @classmethod
    def from_key(cls, key: Sequence[float]) -> DesignVariables:
        """The design of a ``key``; variables declared since the key was stored stand at [initial]'s defaults."""
        if len(key) < len(VARIABLE_NAMES):
            key = [*key, *(VARIABLE_TABLE[name].initial for name in VARIABLE_NAMES[len(key) :])]
        named: dict[str, Any] = dict(zip(VARIABLE_NAMES, map(float, key), strict=True))
        for name in _COUNTED:
            named[name] = VARIABLE_TABLE[name].typed(named[name])
        return cls(**named)

    def replaced(self, changes: Mapping[str, object], where: str = "design variables") -> DesignVariables:
        """The same design with some variables changed; checked like ``from_dict``."""
        return DesignVariables.from_dict({**self.as_dict(), **changes}, where)

    def key(self) -> tuple[float, ...]:
        """The exact numbers in the fixed order: two designs are the same if their keys are."""
        return tuple(float(getattr(self, name)) for name in VARIABLE_NAMES)


VARIABLE_TABLE = declared_variables(DesignVariables)
"""The variables that name a design."""
VARIABLE_NAMES = tuple(VARIABLE_TABLE)
SEARCH_TABLE = VARIABLE_TABLE | declared_variables(StandIns)
"""The variables that a case may search: these, and what may stand in for one of them."""
STANDS_FOR = {"block_coefficient_ratio": "displacement_ratio"}
"""The variable in whose place each stand-in is searched."""
ON_BOUND = 0.01
"""A variable within this part of its range of a bound stands on it."""
_COUNTED = tuple(name for name, item in VARIABLE_TABLE.items() if item.whole)
_BLADE_COUNT = VARIABLE_NAMES.index("blade_count")
_FULLNESS = VARIABLE_NAMES.index("displacement_ratio")


@dataclass(frozen=True)
class DesignSpace:
    """Lower and upper bounds of the variables; a variable with equal bounds is fixed.

    The optimiser works on a real vector over the free variables in which Z is relaxed to [Z_lower - 1/2, Z_upper +
    1/2) and decoded by floor(z + 1/2), so that a uniform sample gives every blade count an equal share.

    With a block coefficient of its own (``names`` says so) the displacement of a design follows from it and the main
    dimensions: dimensions that are varied independently then ask for no fullness that the form does not carry.

    Attributes:
        lower, upper: a bound each, in the order of ``names``.
        names: ``VARIABLE_NAMES``, or these with a stand-in at the place of what it stands for.
        initial: the initial design, which a stand-in refers to: a case states it (``about``).
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    names: tuple[str, ...] = VARIABLE_NAMES
    initial: DesignVariables | None = None

    @classmethod
    def from_bounds(cls, bounds: Mapping[str, Sequence[float]], where: str = "bounds") -> DesignSpace:
        """A checked space from (lower, upper) by variable name.

        Raises:
            InputError: an unknown or missing name, a value that is no finite number or out of range, a half blade,
                reversed bounds, or a variable and its stand-in together.
        """
        for name in bounds:
            if name not in SEARCH_TABLE:
                raise unknown_name(name, list(SEARCH_TABLE), where)
        names = searched(bounds, where)
        lower, upper = [], []
        for name in names:
            item = SEARCH_TABLE[name]
            if name not in bounds:
                raise InputError(f"{where}: '{name}' is missing; write {name} = [lower, upper]")
            pair = bounds[name]
            if isinstance(pair, str) or not isinstance(pair, Sequence) or len(pair) != 2:
                raise InputError(f"{where}: {name} needs two numbers; write {name} = [lower, upper]")
            low, high = (checked_value(value, item.rule, f"{where}: {name}") for value in pair)
            if low > high:
                raise InputError(f"{where}: {name} has reversed bounds {low:g} > {high:g}; write the smaller one first")
            lower.append(float(low))
            upper.append(float(high))
        return cls(tuple(lower), tuple(upper), names)

    @classmethod
    def around(cls, initial: DesignVariables, names: tuple[str, ...] = VARIABLE_NAMES) -> DesignSpace:
        """The default bounds around an initial design."""
        pairs = [SEARCH_TABLE[name].bounds_near(value_of(name, initial, initial)) for name in names]
        return cls(tuple(low for low, _ in pairs), tuple(high for _, high in pairs), names).about(initial)

    def about(self, initial: DesignVariables) -> DesignSpace:
        """The same bounds; stand-ins refer to this initial design."""
        return self if self.names == VARIABLE_NAMES else replace(self, initial=initial)

    def changed(self, bounds: Mapping[str, Sequence[float]]) -> DesignSpace:
        """The same space with some bounds changed: those of a stand-in take the place of what it stands for.

        Raises:
            InputError: as ``from_bounds``.
        """
        names = self.names_with(bounds)
        kept = {name: pair for name, pair in self.as_dict().items() if name in names}
        return DesignSpace.from_bounds({**kept, **bounds})

    def names_with(self, given: Collection[str], where: str = "bounds") -> tuple[str, ...]:
        """``names`` where these are given: of a variable and its stand-in, the one among them.

        Raises:
            InputError: a variable and its stand-in are among them.
        """
        kept = {name for name in self.names if not set(interchangeable(name)) & set(given)}
        return searched(kept | set(given), where)

    def as_dict(self) -> dict[str, tuple[float, float]]:
        """(lower, upper) by name."""
        return {name: (self.lower[i], self.upper[i]) for i, name in enumerate(self.names)}

    def values(self, variables: DesignVariables) -> dict[str, float]:
        """A design's numbers by name, as the space searches them."""
        return dict(zip(self.names, self._numbers(variables), strict=True))

    def design(self, values: Sequence[float]) -> DesignVariables:
        """The design of numbers in the order of ``names``, bounds or not.

        A displacement that follows ends at what the variable may ever be: no such design is feasible.
        """
        numbers = list(values)
        if self.names != VARIABLE_NAMES:
            shape = DesignVariables.from_key(numbers)
            numbers[_FULLNESS] = _following(shape, self._initial, numbers[_FULLNESS])
        return DesignVariables.from_key(numbers)

    def _numbers(self, variables: DesignVariables) -> tuple[float, ...]:
        key = variables.key()
        if self.names == VARIABLE_NAMES:
            return key
        ratio = variables.block_coefficient_ratio(self._initial)
        # One of the numbers next to it gave this displacement to the last digit: a design that is known stays itself.
        for near in (ratio, math.nextafter(ratio, 0.0), math.nextafter(ratio, math.inf)):
            if _following(variables, self._initial, near) == variables.displacement_ratio:
                ratio = near
                break
        return (*key[:_FULLNESS], ratio, *key[_FULLNESS + 1 :])

    @property
    def _initial(self) -> DesignVariables:
        if self.initial is None:
            raise ValueError("a stand-in means nothing without an initial design; take a case's bounds")
        return self.initial

    @cached_property
    def free(self) -> tuple[int, ...]:
        """Indices into ``names`` of the variables that are not fixed."""
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
                raise ValueError(f"{self.names[i]} is not a finite number")
            decoded = math.floor(float(value) + 0.5) if i == _BLADE_COUNT else float(value)
            values[i] = min(max(float(decoded), self.lower[i]), self.upper[i])
        return self.design(values)

    def encode(self, variables: DesignVariables) -> Array:
        """The free vector, shape (free,), that decodes to ``variables`` if they lie inside the bounds."""
        numbers = self._numbers(variables)
        return np.array([numbers[i] for i in self.free])

    def active(self, variables: DesignVariables) -> dict[str, str]:
        """Which free variables stand on a bound: "lower" or "upper" by name.

        On a bound means within 1 % of the range: what an optimiser of finite population presses against a bound ends
        there and not on its last digit.
        """
        found = {}
        for i, value in enumerate(self._numbers(variables)):
            low, high = self.lower[i], self.upper[i]
            if low < high:
                near = ON_BOUND * (high - low)
                if value <= low + near:
                    found[self.names[i]] = "lower"
                elif value >= high - near:
                    found[self.names[i]] = "upper"
        return found

    def project(self, variables: DesignVariables) -> DesignVariables:
        """The nearest design inside the bounds, variable by variable."""
        return self.design(
            [
                min(max(value, low), high)
                for value, low, high in zip(self._numbers(variables), self.lower, self.upper, strict=True)
            ]
        )


def searched(names: Collection[str], where: str) -> tuple[str, ...]:
    """The variables of a space in their order, of which a stand-in among ``names`` is one.

    Raises:
        InputError: it is there together with what it stands for.
    """
    found = list(VARIABLE_NAMES)
    for name, other in STANDS_FOR.items():
        if name in names:
            if other in names:
                raise InputError(f"{where}: {other} and {name} are both given; keep one, the other follows from it")
            found[found.index(other)] = name
    return tuple(found)


def value_of(name: str, variables: DesignVariables, initial: DesignVariables) -> float | int:
    """A variable or stand-in of a design."""
    if name in STANDS_FOR:
        return variables.block_coefficient_ratio(initial)
    value: float | int = getattr(variables, name)
    return value


def _following(shape: DesignVariables, initial: DesignVariables, block_coefficient_ratio: float) -> float:
    """The displacement ratio that follows from a block coefficient and the main dimensions."""
    rule = SEARCH_TABLE["displacement_ratio"].rule
    return min(max(block_coefficient_ratio * (shape.box / initial.box), rule.lower), rule.upper)


def interchangeable(name: str) -> tuple[str, ...]:
    """A variable and its stand-ins, of which one is searched; none where nothing stands in."""
    place = STANDS_FOR.get(name, name)
    others = tuple(other for other, stood_for in STANDS_FOR.items() if stood_for == place)
    return (place, *others) if others else ()
