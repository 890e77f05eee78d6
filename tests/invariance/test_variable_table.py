"""Each design variable is declared once: everything that is shown or set of it follows from that entry."""

from __future__ import annotations

import dataclasses
import json
import math
import re
from pathlib import Path

import pytest

from explorer.state.draft import Draft
from explorer.views.settings_fields import CASE_FIELDS, slider_decimals
from hpsop_core.case.case import SHIPPED_CASES, Case, load_case
from hpsop_core.case.fields import rules
from hpsop_core.case.sections import InitialSection
from hpsop_core.case.variables import VARIABLE_NAMES, VARIABLE_TABLE, DesignSpace, DesignVariables, interchangeable
from hpsop_core.quantities import free_variables, variable_quantities
from hpsop_core.runs.records import named_variables, variables_text
from tests.two_speeds import TWO_SPEEDS

ROOT = Path(__file__).resolve().parents[2]
SHIP = load_case(TWO_SPEEDS)
# A towing-tank model, a hydrofoil's tender and a tanker: 6 m, 25 m and 380 m.
MODEL = SHIP.replaced("initial", length=6.0, breadth=0.86, draft=0.25, diameter=0.15)
BOAT = SHIP.replaced("initial", length=25.0, breadth=6.0, draft=1.8, diameter=1.1)
TANKER = SHIP.replaced("initial", length=380.0, breadth=68.0, draft=24.5, diameter=10.5)
SIZES = pytest.mark.parametrize("case", [SHIP, MODEL, BOAT, TANKER], ids=["ship", "model", "boat", "tanker"])


def steps(case: Case, name: str) -> tuple[float, float, float, float]:
    """(initial value, slider's lower end, upper end, step)."""
    value = getattr(case.initial.variables, name)
    return value, *VARIABLE_TABLE[name].reach_near(value), VARIABLE_TABLE[name].step_near(value)


@SIZES
@pytest.mark.parametrize("name", VARIABLE_NAMES)
def test_a_slider_fits_the_ship(case: Case, name: str) -> None:
    variable = VARIABLE_TABLE[name]
    value, low, high, step = steps(case, name)
    assert variable.rule.lower <= low <= value <= high <= variable.rule.upper
    if variable.whole:
        assert (low, high, step) == (3, 7, 1)
        return
    # Fine enough to search by hand, never so fine that the arrow keys do not get anywhere: a length has 500 to 5000
    # steps to its own value (a power of ten each), 0.41 to 0.44 of them within reach; LCB has the fewest, 100.
    assert 80 <= (high - low) / step <= 2200
    digits = slider_decimals(variable, value)
    assert round(step, digits) == step > 0.0
    for end in (low, high):
        assert math.isclose(end / step, round(end / step), abs_tol=1e-6)
    # neighbours on the slider read differently wherever the number is written
    decimals = variable.decimals_near(value)
    assert f"{variable.shown(value):.{decimals}f}" != f"{variable.shown(value + step):.{decimals}f}"


@SIZES
def test_default_bounds_lie_around_the_initial_design(case: Case) -> None:
    initial = case.initial.variables
    space = DesignSpace.around(initial)
    assert DesignSpace.from_bounds(space.as_dict()) == space
    assert space.project(initial) == initial
    for name, (low, high) in space.as_dict().items():
        _, least, most, _ = steps(case, name)
        assert least <= low <= high <= most
    assert [VARIABLE_NAMES[index] for index in space.free] == list(VARIABLE_NAMES[:7])


def test_default_bounds_of_the_shipped_ship_are_its_case_s() -> None:
    """The paper's Table 2 for the first six; a step of the slider is what rounding may add."""
    for name, pair in DesignSpace.around(SHIP.initial.variables).as_dict().items():
        step = steps(SHIP, name)[-1]
        assert pair == pytest.approx(SHIP.bounds.as_dict()[name], abs=3.1 * step)


def test_a_model_is_shown_with_digits() -> None:
    by_key = {quantity.key: quantity for quantity in variable_quantities(MODEL)}
    assert (by_key["draft"].decimals, by_key["diameter"].decimals) == (4, 4)
    by_key = {quantity.key: quantity for quantity in variable_quantities(SHIP)}
    assert (by_key["draft"].decimals, by_key["diameter"].decimals) == (2, 2)


def test_quantities_are_the_table_s() -> None:
    quantities = variable_quantities(SHIP)
    assert [quantity.key for quantity in quantities] == list(VARIABLE_NAMES)
    for quantity, variable in zip(quantities, VARIABLE_TABLE.values(), strict=True):
        assert (quantity.label, quantity.symbol, quantity.unit) == (variable.label, variable.symbol, variable.unit)
    assert [quantity.key for quantity in free_variables(SHIP)] == list(VARIABLE_NAMES[:7])


def test_initial_has_the_variables_and_the_main_dimensions() -> None:
    names = ["length", "breadth", *VARIABLE_NAMES[2:]]
    assert list(rules(InitialSection)) == names
    assert [name for title, fields in CASE_FIELDS for _, name, _ in fields if title == "Initial design"] == names
    for name in VARIABLE_NAMES[2:]:
        own, declared = rules(InitialSection)[name], VARIABLE_TABLE[name].rule
        assert (own.kind, own.unit, own.lower, own.upper) == (
            declared.kind,
            declared.unit,
            declared.lower,
            declared.upper,
        )
        assert own.default == VARIABLE_TABLE[name].initial


@pytest.mark.parametrize("name", SHIPPED_CASES)
def test_the_initial_design_s_numbers_are_the_case_s(name: str) -> None:
    initial = load_case(name).initial
    design = initial.variables
    assert list(design.as_dict()) == list(VARIABLE_NAMES)
    assert design.length_to_breadth == initial.length / initial.breadth
    assert design.breadth_to_draft == initial.breadth / initial.draft
    assert all(getattr(design, key) == getattr(initial, key) for key in VARIABLE_NAMES[2:])


def test_a_run_from_before_a_variable_was_declared_still_reads() -> None:
    """Run files name a design by its numbers: one that came later stands at what the case file's default says."""
    design = dataclasses.replace(SHIP.initial.variables, draft=14.2, blade_count=5)
    stored = json.loads(variables_text(design))
    assert DesignVariables.from_key(stored) == design
    assert named_variables(json.dumps(stored[:-1])) == {**design.as_dict(), "buoyancy_centre_shift": 0.0}
    assert type(named_variables(json.dumps(stored))["blade_count"]) is int
    with pytest.raises(ValueError, match="zip"):
        DesignVariables.from_key([*stored, 1.0])


def test_the_page_searches_a_stand_in_and_comes_back() -> None:
    draft = Draft(SHIP)
    draft.set("bounds", "displacement_ratio", (0.9, 1.0))
    draft.search_by("block_coefficient_ratio")
    assert draft.searched()[6] == "block_coefficient_ratio" and "displacement_ratio" not in draft.searched()
    draft.widen("block_coefficient_ratio", "upper")
    draft.set_bound("block_coefficient_ratio", "lower", 0.9)
    case = draft.case()
    assert case.bounds.as_dict()["block_coefficient_ratio"] == pytest.approx((0.9, 1.075))
    assert [quantity.key for quantity in free_variables(case)][-1] == "block_coefficient_ratio"
    assert [quantity.key for quantity in variable_quantities(case)] == [*case.bounds.names, "displacement_ratio"]
    # a server that starts again, and a run whose case descends from a preset that searches the other one
    began = Draft(SHIP)
    began.restore(draft.saved())
    assert began.case() == case
    preset = load_case("dtc-p4119")
    (own,) = set(interchangeable("displacement_ratio")) & set(preset.bounds.names)
    (other,) = set(interchangeable("displacement_ratio")) - {own}
    descended = preset.with_bounds({other: (0.9, 1.1)})
    draft.begin(descended)
    assert draft.base == preset and draft.case() == descended
    draft.search_by(own)
    assert draft.case() == draft.base and not draft.count()


def test_no_second_declaration_stands_anywhere() -> None:
    """A list or a table that names many variables is a copy that the next variable would be missing from."""
    for path in sorted([*ROOT.glob("hpsop_core/**/*.py"), *ROOT.glob("explorer/**/*.py")]):
        source = path.read_text(encoding="utf-8")
        named = [name for name in VARIABLE_NAMES if re.search(rf'"{name}"', source)]
        assert len(named) < 6 or path.name == "paper.py", f"{path}: {named}"


def test_the_page_sets_usual_bounds_around_a_changed_initial_design() -> None:
    draft = Draft(load_case(TWO_SPEEDS).with_bounds({"expanded_area_ratio": (0.55, 1.0)}))
    for name, value in (("length", 6.0), ("breadth", 0.86), ("draft", 0.25), ("diameter", 0.15)):
        draft.set("initial", name, value)
    draft.search_around_initial()
    case = draft.case()
    assert case.bounds.free == draft.base.bounds.free
    assert case.bounds.project(case.initial.variables) == case.initial.variables
    assert case.bounds.as_dict()["draft"] == (0.2412, 0.25)
    # freed by this case, though cases usually fix it: as far as its slider goes
    assert case.bounds.as_dict()["expanded_area_ratio"] == (0.35, 1.1)
    assert case.bounds.as_dict()["buoyancy_centre_shift"] == (0.0, 0.0)
    draft.search_by("block_coefficient_ratio")
    draft.search_around_initial()
    assert draft.case().bounds.as_dict()["block_coefficient_ratio"] == (0.95, 1.05)
    # while the fields make no design, the preset's counts
    draft.set("initial", "draft", 40.0)
    assert draft.initial() == draft.base.initial.variables
