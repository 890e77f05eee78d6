"""A case: everything that the user states, read from TOML, checked, frozen, and written back without loss."""

from __future__ import annotations

import dataclasses
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hpsop_core.assets import asset_path
from hpsop_core.case.fields import checked_value, read_section, rules, section_table, toml_text, unknown_name
from hpsop_core.case.objectives import objective_named
from hpsop_core.case.own_hull import own_dimensions
from hpsop_core.case.sections import (
    OWN_FILES,
    ConditionsSection,
    ConstantsSection,
    ConstraintsSection,
    HullSection,
    InitialSection,
    ObjectivesSection,
    OptimizationSection,
    PropellerSection,
)
from hpsop_core.case.ship import EngineSection, LoadingSection
from hpsop_core.case.variables import SEARCH_TABLE, STANDS_FOR, DesignSpace, DesignVariables, searched, value_of
from hpsop_core.errors import InputError
from hpsop_core.reading import LARGEST_CASE, file_name, read_bytes

SHIPPED_CASES = ("dtc-p4119", "dtc-p4119-paper", "dtc-p4119-power")
DEFAULT_CASE = SHIPPED_CASES[0]

SECTIONS: dict[str, type[Any]] = {
    "hull": HullSection,
    "propeller": PropellerSection,
    "initial": InitialSection,
    "conditions": ConditionsSection,
    "objectives": ObjectivesSection,
    "constraints": ConstraintsSection,
    "constants": ConstantsSection,
    "loading": LoadingSection,
    "engine": EngineSection,
    "optimization": OptimizationSection,
}
_TEXTS = ("name", "title", "description")

KNOT = 1852.0 / 3600.0
"""In m/s."""


@dataclass(frozen=True)
class Case:
    """What is to be optimised, from which parents, under which conditions and with which constants.

    Attributes:
        name: one word; stands in every result.
        title, description: for people; the description says what the case assumes.
        hull, propeller, initial, conditions, objectives, constraints, constants, optimization: see sections.py.
        loading, engine: see ship.py.
        bounds: the design space.
    """

    name: str
    title: str
    description: str
    hull: HullSection
    propeller: PropellerSection
    initial: InitialSection
    bounds: DesignSpace
    conditions: ConditionsSection
    objectives: ObjectivesSection = field(default_factory=ObjectivesSection)
    constraints: ConstraintsSection = field(default_factory=ConstraintsSection)
    constants: ConstantsSection = field(default_factory=ConstantsSection)
    loading: LoadingSection = field(default_factory=LoadingSection)
    engine: EngineSection = field(default_factory=EngineSection)
    optimization: OptimizationSection = field(default_factory=OptimizationSection)

    def __post_init__(self) -> None:
        constants, count = self.constants, len(self.conditions.weights)
        if constants.wave_calibration == "stated" and len(constants.stated_wave_coefficients) != count:
            raise InputError(
                f"constants: wave_calibration = stated needs {count} stated_wave_coefficients, one a condition; "
                f"{len(constants.stated_wave_coefficients)} given"
            )
        _check_speeds(self.conditions.speeds_knots, self._wave_speed)
        limits = self.constraints
        if limits.diameter_to_draft_lower > limits.diameter_to_draft_upper:
            raise InputError("constraints: diameter_to_draft_lower exceeds diameter_to_draft_upper; swap them")
        # refuses proportions that no design may have
        object.__setattr__(self, "bounds", self.bounds.about(self.initial.variables))
        for name in (self.objectives.first, self.objectives.second):
            self._check_objective(name)

    def _check_objective(self, name: str) -> None:
        """Refuse an objective for which the case does not state what it needs."""
        for needed in objective_named(name).needs:
            section, _, item = needed.partition(".")
            if getattr(getattr(self, section), item) in (None, ()):
                raise InputError(f"objectives: {name} needs [{section}] {item}; state it or choose another objective")

    @property
    def froude_numbers(self) -> tuple[float, ...]:
        """V/sqrt(g Lpp) of the initial design at each condition."""
        if not self.conditions.speeds_knots:
            return self.conditions.froude_numbers
        return tuple(speed / self._wave_speed for speed in self.speeds)

    @property
    def speeds(self) -> tuple[float, ...]:
        """Of the initial design at each condition, in m/s."""
        conditions = self.conditions
        if conditions.speeds_knots:
            return tuple(speed * KNOT for speed in conditions.speeds_knots)
        return tuple(number * self._wave_speed for number in conditions.froude_numbers)

    @property
    def _wave_speed(self) -> float:
        """sqrt(g Lpp) of the initial design in m/s."""
        speed: float = (self.constants.gravity * self.initial.length) ** 0.5
        return speed

    def to_toml(self) -> str:
        """The case as TOML, every field stated; ``case_from_toml`` gives the same case again."""
        tables: dict[str, object] = {name: getattr(self, name) for name in _TEXTS}
        for name in SECTIONS:
            tables[name] = section_table(getattr(self, name))
            if name == "initial":
                tables["bounds"] = self.bounds.as_dict()
        return toml_text(tables)

    def replaced(self, section: str, **changes: object) -> Case:
        """The same case with fields of one section changed, each checked against its rule.

        Raises:
            InputError: an unknown field or a refused value.
        """
        return self.changed({section: changes})

    def changed(self, changes: Mapping[str, Mapping[str, object]]) -> Case:
        """The same case with fields of several sections changed at once: what belongs together is judged together.

        Args:
            changes: new values by section and field.

        Raises:
            InputError: an unknown field or a refused value.
        """
        sections: dict[str, Any] = {}
        for section, fields in changes.items():
            known = rules(SECTIONS[section])
            checked: dict[str, Any] = {}
            for name, value in fields.items():
                if name not in known:
                    raise unknown_name(name, list(known), section)
                checked[name] = checked_value(value, known[name], f"{section}: {name}")
            if section == "conditions":
                # Speeds are stated in one way: whoever states them in the other one takes the first away.
                for stated, other in (("froude_numbers", "speeds_knots"), ("speeds_knots", "froude_numbers")):
                    if checked.get(stated) and other not in checked:
                        checked[other] = ()
            sections[section] = dataclasses.replace(getattr(self, section), **checked)
        return dataclasses.replace(self, **sections)

    def with_bounds(self, bounds: Mapping[str, tuple[float, float]]) -> Case:
        """The same case with some bounds changed; the others stay (``DesignSpace.changed``).

        Raises:
            InputError: as ``DesignSpace.from_bounds``.
        """
        return dataclasses.replace(self, bounds=self.bounds.changed(bounds))

    def design(self, changes: Mapping[str, object], where: str = "design") -> DesignVariables:
        """The initial design with some variables changed.

        The others stay as the case searches them: where its bounds name block_coefficient_ratio that one stays, and
        the displacement follows the main dimensions. Either of the two may be among the changes, in any case.

        Raises:
            InputError: an unknown name, a refused value, or both of them.
        """
        initial = self.initial.variables
        for name in changes:
            if name not in SEARCH_TABLE:
                raise unknown_name(name, list(SEARCH_TABLE), where)
        names = self.bounds.names_with(changes, where)
        plain = {name: value for name, value in changes.items() if name not in STANDS_FOR}
        design = initial.replaced(plain, where)
        for name, other in STANDS_FOR.items():
            if name in names:
                asked = changes.get(name, value_of(name, initial, initial))
                ratio = checked_value(asked, SEARCH_TABLE[name].rule, f"{where}: {name}")
                design = design.replaced({other: ratio * (design.box / initial.box)}, where)
        return design


def _check_speeds(speeds_knots: tuple[float, ...], wave_speed: float) -> None:
    rule = rules(ConditionsSection)["froude_numbers"]
    for knots in speeds_knots:
        froude = knots * KNOT / wave_speed
        if not rule.lower <= froude <= rule.upper:
            low, high = (limit * wave_speed / KNOT for limit in (rule.lower, rule.upper))
            raise InputError(
                f"conditions: speeds_knots {knots:g} is Froude number {froude:.3f} on the initial design's length, "
                f"outside {rule.lower:g} to {rule.upper:g}; give speeds from {low:.1f} to {high:.1f} kn"
            )


def load_case(name_or_path: str | Path) -> Case:
    """A shipped case by its name, or a case from a TOML file.

    Args:
        name_or_path: "dtc-p4119", "dtc-p4119-power", "dtc-p4119-paper", or a file (docs/case.md).

    Returns:
        The case, frozen; ``replaced("section", field=value)`` gives a changed one, checked in the same way.

    Raises:
        InputError: no such case or file, no TOML, an unknown field or a refused value; one line that says where.
    """
    name = str(name_or_path)
    if name in SHIPPED_CASES:
        return case_from_toml(asset_path("cases", f"{name}.toml").read_text(encoding="utf-8"), f"{name}.toml")
    path = Path(name_or_path)
    if "\0" in name or not os.path.lexists(path):
        raise InputError(f"{file_name(path)}: no such case; give a TOML file or one of {', '.join(SHIPPED_CASES)}")
    try:
        # "sig": an editor may have put a byte-order mark before the first letter
        content = read_bytes(path, LARGEST_CASE, "a case in TOML").decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{name}: cannot be read as a UTF-8 text ({error.reason}); give a TOML file") from error
    return case_from_toml(content, name, path.resolve().parent)


def case_from_toml(content: str, where: str, folder: Path | None = None) -> Case:
    """A case from TOML text.

    Args:
        content: the text.
        where: the name of the file, for errors.
        folder: files that the case names are relative to this folder.

    Raises:
        InputError: as ``load_case``.
    """
    try:
        tables = tomllib.loads(content)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{where}: not valid TOML: {error}; mend that line") from error
    except (ValueError, RecursionError) as error:
        # a number of thousands of digits, tables in tables in tables
        why = "too deep" if isinstance(error, RecursionError) else "a number is too long"
        raise InputError(f"{where}: not a case: {why}; compare it with docs/case.md") from error
    known = [*_TEXTS, "bounds", *SECTIONS]
    values: dict[str, Any] = {}
    for key, value in tables.items():
        if key not in known:
            raise unknown_name(key, known, where)
        if key in _TEXTS:
            if not isinstance(value, str):
                raise InputError(f"{where}: {key} must be a text; put it in quotes")
            values[key] = value
        elif not isinstance(value, dict):
            raise InputError(f"{where}: {key} must be a table; write [{key}]")
    for required in ("initial", "bounds"):
        if required not in tables:
            raise InputError(f"{where}: the table [{required}] is missing; copy it from a shipped case")
    stem = Path(where).stem
    return _assembled(tables, values, where, stem, folder)


def _assembled(tables: Mapping[str, Any], texts: Mapping[str, Any], where: str, stem: str, folder: Path | None) -> Case:
    try:
        stated = {**tables, "conditions": ConditionsSection.completed(tables.get("conditions", {}))}
        sections = {name: read_section(section, stated.get(name, {}), name) for name, section in SECTIONS.items()}
        if folder is not None:
            sections["hull"] = _absolute(sections["hull"], "hull", OWN_FILES, folder)
            sections["propeller"] = _absolute(sections["propeller"], "propeller", ("geometry",), folder)
        sections["initial"] = _own_dimensions(sections["hull"], sections["initial"], tables["initial"])
        bounds = dict(tables["bounds"])
        for name in searched(bounds, "bounds"):
            if not SEARCH_TABLE[name].bounds_required:
                bounds.setdefault(name, (getattr(sections["initial"].variables, name),) * 2)
        return Case(
            name=texts.get("name", stem),
            title=texts.get("title", texts.get("name", stem)),
            description=texts.get("description", ""),
            bounds=DesignSpace.from_bounds(bounds),
            **sections,
        )
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _own_dimensions(hull: HullSection, initial: InitialSection, stated: Mapping[str, Any]) -> InitialSection:
    """An initial design without length, breadth or draft has those of the hull of one's own."""
    missing = [name for name in ("length", "breadth", "draft") if name not in stated]
    if not hull.own_file or not missing:
        return initial
    own: dict[str, Any] = {name: value for name, value in own_dimensions(hull).items() if name in missing}
    return dataclasses.replace(initial, **own)


def _absolute(section: Any, where: str, names: tuple[str, ...], folder: Path) -> Any:
    """The section with absolute paths to the files that it names.

    Raises:
        InputError: there is no such file.
    """
    changes = {}
    for name in names:
        if getattr(section, name):
            path = folder / getattr(section, name)
            if "\0" in str(path) or not os.path.isfile(path):
                raise InputError(
                    f"{where}: {name}: there is no file {file_name(path)}; give a path from the case file's folder"
                )
            changes[name] = str(path.resolve())
    return dataclasses.replace(section, **changes)
