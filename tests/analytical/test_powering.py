"""Powering as practised: the parts of the resistance, stated numbers and powers, each from its definition."""

from __future__ import annotations

import dataclasses
import functools
import math

import pytest

from hpsop_core import evaluate, load_case, resistance
from hpsop_core.case.case import KNOT, Case, case_from_toml
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.curves import froude_range, resistance_points, thrust_curves
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Ok, evaluation_from_dict
from hpsop_core.quantities import condition_names, condition_quantities
from tests.two_speeds import TWO_SPEEDS

PAPER = load_case("dtc-p4119-paper")
# Nothing here depends on the waves' calibration, and level 2 is not asked.
CASE = load_case(TWO_SPEEDS).replaced("constants", wave_calibration="none")
PARTS = (
    "friction_resistance",
    "form_resistance",
    "wave_resistance",
    "correlation_resistance",
    "air_resistance",
    "appendage_resistance",
)
STATED = {
    "correlation_allowance": 0.00015,
    "air_drag_coefficient": 0.8,
    "frontal_area": 1500.0,
    "appendage_factor": 0.03,
    "wake_formula": "stated",
    "stated_wake_fraction": 0.21,
    "thrust_deduction_formula": "stated",
    "stated_thrust_deduction": 0.13,
    "relative_rotative_efficiency": 1.01,
    "sea_margin": 0.15,
    "shaft_efficiency": 0.98,
}


@functools.cache
def stated_case() -> Case:
    return CASE.replaced("constants", **STATED)


def computed(case: Case, variables: DesignVariables | None = None) -> Ok:
    result = evaluate(case, variables)
    assert result.ok, result
    return result


def total(condition: ConditionResult) -> float:
    return math.fsum(getattr(condition, name) for name in PARTS)


def test_the_parts_add_up() -> None:
    for condition in computed(stated_case()).conditions:
        assert total(condition) == pytest.approx(condition.total_resistance, rel=1e-14)


def test_each_part_is_its_definition() -> None:
    result = computed(stated_case())
    for condition in result.conditions:
        dynamic = 0.5 * 1025.0 * condition.speed**2 * result.hull.wetted_surface
        assert condition.form_resistance == pytest.approx(0.094 * condition.friction_resistance, rel=1e-14)
        assert condition.correlation_resistance == pytest.approx(0.00015 * dynamic, rel=1e-14)
        assert condition.appendage_resistance == pytest.approx(0.03 * condition.friction_resistance, rel=1e-14)
        # 1.226 kg/m3: air at 15 C, ITTC.
        assert condition.air_resistance == pytest.approx(0.5 * 1.226 * condition.speed**2 * 1500.0 * 0.8, rel=1e-14)


def test_the_powers_follow_each_other() -> None:
    for condition in computed(stated_case()).conditions:
        assert condition.wake_fraction == 0.21
        assert condition.thrust_deduction == 0.13
        assert condition.thrust * (1.0 - 0.13) == pytest.approx(condition.total_resistance, rel=1e-9)
        assert condition.effective_power == pytest.approx(condition.total_resistance * condition.speed, rel=1e-14)
        assert condition.hull_efficiency == pytest.approx(0.87 / 0.79, rel=1e-14)
        chain = condition.open_water_efficiency * condition.hull_efficiency * 1.01
        # The operating point is met to the tolerance of its root finder.
        assert condition.propulsive_efficiency == pytest.approx(chain, rel=1e-9)
        assert condition.brake_power == pytest.approx(1.15 * condition.delivered_power / 0.98, rel=1e-14)


def test_without_allowances_nothing_is_added() -> None:
    for condition in computed(PAPER).conditions:
        assert condition.total_resistance == condition.friction_resistance + condition.wave_resistance
        assert condition.brake_power == condition.delivered_power
        assert condition.wake_fraction * 0.6 == condition.thrust_deduction


def test_the_frontal_area_goes_with_the_breadth() -> None:
    initial = CASE.initial.variables
    wider = initial.replaced({"breadth_to_draft": 1.1 * initial.breadth_to_draft, "length_to_breadth": 6.4})
    ratios = [
        own.air_resistance / first.air_resistance
        for own, first in zip(
            computed(stated_case(), wider).conditions, computed(stated_case()).conditions, strict=True
        )
    ]
    assert ratios == pytest.approx([1.1, 1.1], rel=1e-12)


OTHER = CASE.initial.variables.replaced({"draft": 14.1, "diameter": 8.6, "length_to_breadth": 7.4})


@pytest.mark.parametrize(
    ("stated", "holtrop", "name"),
    [
        (
            {"wake_formula": "stated", "stated_wake_fraction": 0.25},
            {"wake_formula": "holtrop"},
            "wake_fraction",
        ),
        (
            {"thrust_deduction_formula": "stated", "stated_thrust_deduction": 0.15},
            {"thrust_deduction_formula": "holtrop"},
            "thrust_deduction",
        ),
        ({"form_factor_formula": "scaled"}, {"form_factor_formula": "holtrop"}, "form_factor"),
        (
            {"relative_rotative_efficiency_formula": "scaled"},
            {"relative_rotative_efficiency_formula": "holtrop"},
            "relative_rotative_efficiency",
        ),
        (
            {"correlation_allowance_formula": "scaled"},
            {"correlation_allowance_formula": "holtrop"},
            "correlation_allowance",
        ),
    ],
)
def test_what_is_stated_changes_by_the_formula(
    stated: dict[str, object], holtrop: dict[str, object], name: str
) -> None:
    def number(constants: dict[str, object], design: DesignVariables | None) -> float:
        result = computed(CASE.replaced("constants", **constants), design)
        condition = result.conditions[0]
        if name == "correlation_allowance":
            dynamic = 0.5 * CASE.constants.density * condition.speed**2 * result.hull.wetted_surface
            return condition.correlation_resistance / dynamic
        if name == "form_factor":
            return condition.form_resistance / condition.friction_resistance
        return float(getattr(condition, name))

    given = stated.get(f"stated_{name}", getattr(CASE.constants, name, None))
    assert number(stated, None) == pytest.approx(given, abs=1e-14)
    change = number(holtrop, OTHER) - number(holtrop, None)
    assert number(stated, OTHER) - number(stated, None) == pytest.approx(change, abs=1e-12)
    assert abs(change) > (1e-6 if name == "correlation_allowance" else 1e-4)


def test_the_initial_formulas_come_back_from_a_run_file() -> None:
    reference = reference_for(stated_case(), 1)
    assert reference.basis.holtrop is not None
    assert Reference.from_dict(reference.as_dict()) == reference
    old = reference_for(CASE, 1).as_dict()
    del old["holtrop"]
    assert Reference.from_dict(old).basis.holtrop is None


def test_resistance_has_the_parts_of_the_evaluation() -> None:
    result = computed(stated_case())
    points = resistance(stated_case(), [condition.froude_number for condition in result.conditions]).points
    for point, condition in zip(points, result.conditions, strict=True):
        for name in (*PARTS, "total_resistance"):
            assert getattr(point, name) == pytest.approx(getattr(condition, name), rel=1e-12), name


def test_holtrop_outside_its_ships_is_said() -> None:
    case = CASE.replaced("constants", wake_formula="holtrop")
    assert not [line for line in computed(case).warnings if "Holtrop" in line]
    flat = CASE.initial.variables.replaced({"breadth_to_draft": 4.4})
    lines = [line for line in computed(case, flat).warnings if "Holtrop" in line]
    assert len(lines) == 1
    assert "B/T 4.40 (2.1 to 4)" in lines[0]
    assert not [line for line in computed(CASE, flat).warnings if "Holtrop" in line]


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"stated_wake_fraction": 0.25}, 'wake_formula is taylor_quadratic; write wake_formula = "stated"'),
        ({"stated_thrust_deduction": 0.15}, "thrust_deduction_formula is schoenherr"),
        (
            {"correlation_allowance": 2e-4, "correlation_allowance_formula": "holtrop"},
            "correlation_allowance_formula is holtrop",
        ),
        ({"air_drag_coefficient": 0.9}, "no frontal_area"),
    ],
)
def test_a_stated_number_that_is_not_used_is_said(changes: dict[str, object], word: str) -> None:
    lines = [line for line in computed(CASE.replaced("constants", **changes)).warnings if "is not used" in line]
    assert len(lines) == 1
    assert word in lines[0]
    assert not [line for line in computed(stated_case()).warnings if "is not used" in line]


# ---- speeds ----------------------------------------------------------------------------------------------------------
def test_speeds_in_knots_are_the_same_as_their_froude_numbers() -> None:
    knots = [speed / KNOT for speed in CASE.speeds]
    case = CASE.replaced("conditions", speeds_knots=knots)
    assert case.conditions.froude_numbers == ()
    assert case.froude_numbers == pytest.approx(CASE.froude_numbers, rel=1e-14)
    for own, other in zip(computed(case).conditions, computed(CASE).conditions, strict=True):
        assert own.delivered_power == pytest.approx(other.delivered_power, rel=1e-9)


def test_six_conditions_with_names_and_a_file() -> None:
    speeds, weights = [16, 18, 20, 22, 24, 25], [0.05, 0.15, 0.25, 0.3, 0.2, 0.05]
    case = CASE.replaced("conditions", speeds_knots=speeds, weights=weights)
    again = case_from_toml(case.to_toml(), "again.toml")
    assert dataclasses.replace(again, name=case.name) == case
    assert condition_names(case) == ("16 kn", "18 kn", "20 kn", "22 kn", "24 kn", "25 kn")
    groups = dict.fromkeys(quantity.group for quantity in condition_quantities(condition_names(case)))
    assert list(groups)[4] == "Condition 5: 24 kn"
    result = computed(case)
    assert [condition.speed / KNOT for condition in result.conditions] == pytest.approx(speeds, rel=1e-12)
    other = computed(case, OTHER)
    assert [condition.speed / KNOT for condition in other.conditions] == pytest.approx(speeds, rel=1e-12)
    pairs = zip(weights, other.conditions, result.conditions, strict=True)
    wanted = sum(weight * own.total_resistance / first.total_resistance for weight, own, first in pairs)
    assert other.objectives["f1"] == pytest.approx(wanted, rel=1e-12)


def test_a_file_with_speeds_alone() -> None:
    text = (
        CASE.to_toml()
        .replace("froude_numbers = [0.22, 0.27]\n", "")
        .replace("speeds_knots = []", "speeds_knots = [18, 24]")
    )
    case = case_from_toml(text, "speeds.toml")
    assert case.conditions.speeds_knots == (18.0, 24.0)
    assert case.conditions.froude_numbers == ()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"speeds_knots": [24, 20], "weights": [0.65, 0.35]},
            r"speeds_knots must ascend; write speeds_knots = \[20, 24\] and weights = \[0.35, 0.65\]",
        ),
        ({"speeds_knots": [20, 20]}, r"write speeds_knots = \[20\] and weights = \[1\]"),
        ({"weights": [0, 0]}, r"weights sum to 0; they must sum to 1; write for example \[0.5, 0.5\]"),
        ({"weights": [0.3333333, 0.6666666]}, "weights sum to 0.9999999; they"),
        (
            {"speeds_knots": [20, 24], "weights": [0.5, 0.4]},
            r"weights sum to 0.9; .* write for example \[0.5556, 0.4444\]",
        ),
        ({"speeds_knots": [20, 22, 24]}, "2 weights for 3 speeds_knots; give one each"),
        ({"speeds_knots": [5, 24]}, r"speeds_knots 5 is Froude number 0.044 .* give speeds from 11.5 to 57.3 kn"),
        ({"speeds_knots": [20, 24], "froude_numbers": [0.2, 0.25]}, "both given; keep one"),
        ({"speeds_knots": [20, 24], "speed": "froude"}, 'write speed = "fixed"'),
        ({"froude_numbers": []}, "none is given; give froude_numbers or speeds_knots"),
    ],
)
def test_conditions_that_are_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        CASE.replaced("conditions", **changes)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wake_formula": "stated"}, "needs stated_wake_fraction; add it"),
        ({"thrust_deduction_formula": "stated"}, "needs stated_thrust_deduction; add it"),
        ({"wake_formula": "taylor"}, "is no option; use one of"),
        ({"shaft_efficiency": 1.2}, "outside its limits"),
    ],
)
def test_constants_that_are_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        CASE.replaced("constants", **changes)


# ---- files of an earlier version -------------------------------------------------------------------------------------
def test_parts_of_an_earlier_versions_file_add_up() -> None:
    document = computed(CASE).as_dict()
    kept = ("friction_resistance", "wave_resistance", "total_resistance")
    for condition in document["conditions"]:
        for name in {*PARTS, "effective_power", "hull_efficiency", "propulsive_efficiency", "brake_power"} - set(kept):
            del condition[name]
    old, new = evaluation_from_dict(document), computed(CASE)
    for own, other in zip(old.conditions, new.conditions, strict=True):
        assert total(own) == pytest.approx(own.total_resistance, rel=1e-14)
        assert own.form_resistance == pytest.approx(other.form_resistance, rel=1e-12)
        assert own.brake_power == own.delivered_power
        assert own.propulsive_efficiency == other.propulsive_efficiency


def test_each_condition_lies_on_the_thrust_curve_whatever_the_formulas() -> None:
    # Holtrop's w changes with the speed, and Schoenherr's t with it.
    case = CASE.replaced("constants", wake_formula="holtrop")
    result = computed(case)
    points = resistance_points(case, result, reference_for(case, 1))
    curves = thrust_curves(case, result, points)
    assert result.conditions[0].thrust_deduction != result.conditions[1].thrust_deduction
    for condition in result.conditions:
        place = curves.froude_number.tolist().index(condition.froude_number)
        assert curves.required[place] == pytest.approx(condition.thrust, rel=1e-9)


def test_curves_of_a_slow_profile_begin_where_level_2_has_waves() -> None:
    slow = CASE.replaced("conditions", speeds_knots=[17, 21, 25], weights=[0.3, 0.4, 0.3])
    result = computed(slow)
    # At 17 kn the Froude number is 0.148; level 2 has no waves of this hull at 0.1, and the whole curve would fail.
    assert min(froude_range(result)) == result.conditions[0].froude_number
    assert min(froude_range(computed(CASE))) == pytest.approx(0.17, abs=1e-12)
