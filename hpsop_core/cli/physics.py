"""The commands ``evaluate``, ``resistance``, ``open-water`` and ``validate``."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hpsop_core.assets import SHIPPED_PROPELLERS
from hpsop_core.case.case import KNOT
from hpsop_core.case.fields import FieldRule
from hpsop_core.cli.arguments import (
    add_json,
    add_level,
    add_set,
    case_and_design,
    checked_option,
    describe_variables,
    number_list,
    print_json,
    print_table,
)
from hpsop_core.cli.own_files import add_reading, read_options
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.geometry.hull.input.options import ReadOptions
from hpsop_core.model_test import MODEL_DIAMETER, MODEL_ROTATION_RATE, MODEL_VISCOSITY
from hpsop_core.quantities import SHIP, all_quantities, conditions_of, size_of_design, standing_on
from hpsop_core.units import Size, written

if TYPE_CHECKING:
    from hpsop_core.case.case import Case
    from hpsop_core.case.design_numbers import ConditionResult
    from hpsop_core.geometry.hull.hull import Hull
    from hpsop_core.geometry.propeller.input import UnderstoodPropeller
    from hpsop_core.geometry.propeller.propeller import Propeller


def add_parsers(commands: Any) -> None:
    """Add the four commands to the parser."""
    evaluate = commands.add_parser("evaluate", help="everything about one design of a case")
    evaluate.add_argument("case", metavar="CASE", help="a shipped case's name or a TOML file")
    add_level(evaluate)
    add_set(evaluate)
    evaluate.add_argument("--errors", action="store_true", help="level 2: solve finer too, to state its own errors")
    add_json(evaluate)
    evaluate.set_defaults(handler=_evaluate)

    resistance = commands.add_parser("resistance", help="resistance of a hull over Froude numbers")
    resistance.add_argument("case", metavar="CASE", nargs="?", help="a shipped case's name or a TOML file")
    resistance.add_argument("--offsets", metavar="FILE.csv", help="a table of offsets; as --hull")
    resistance.add_argument("--hull", metavar="FILE", help="table, STL, OBJ, PLY, OFF, GLB, 3dm, STEP or IGES")
    add_reading(resistance)
    resistance.add_argument("--froude", metavar="F[,F...]", required=True, help="Froude numbers V/sqrt(g Lpp)")
    resistance.add_argument("--form-factor", metavar="K", help="k on ITTC-57; the case's, or 0 with a file")
    resistance.add_argument("--water", metavar="salt|fresh|RHO,NU", help="the case's, or salt with a file")
    add_level(resistance)
    add_set(resistance)
    add_json(resistance)
    resistance.set_defaults(handler=_resistance)

    open_water = commands.add_parser("open-water", help="KT, KQ and efficiency of a propeller, at model scale")
    open_water.add_argument("case", metavar="CASE", nargs="?", help="a shipped case's name or a TOML file")
    open_water.add_argument("--geometry", metavar="FILE.csv", help="r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c")
    open_water.add_argument("--blades", metavar="Z", help="number of blades, with --geometry")
    open_water.add_argument("--advance", metavar="J[,J...]", required=True, help="advance coefficients")
    open_water.add_argument("--diameter", metavar="D", help=f"in m, {MODEL_DIAMETER} unless given")
    open_water.add_argument("--rotation-rate", metavar="N", help=f"in 1/s, {MODEL_ROTATION_RATE} unless given")
    open_water.add_argument("--viscosity", metavar="NU", help=f"in m2/s, {MODEL_VISCOSITY} unless given")
    open_water.add_argument(
        "--inviscid", action="store_true", help="without section drag and without the viscous factor on the lift"
    )
    add_level(open_water)
    add_set(open_water)
    add_json(open_water)
    open_water.set_defaults(handler=_open_water)

    validate = commands.add_parser(
        "validate",
        help="every validation case beside its published reference",
        description="Every check, with what it proves: fitted (a constant of ours was chosen on these data), "
        "held out (nobody here tuned to it) or self-consistency. Takes two to four minutes. Exit status 0 says that "
        "every line is within its tolerance, 1 that some miss: docs/validation.md says which to expect.",
    )
    add_json(validate)
    validate.set_defaults(handler=_validate)


def _evaluate(arguments: argparse.Namespace) -> int:
    from hpsop_core import evaluate

    case, variables = case_and_design(arguments.case, arguments.changes)
    if arguments.level == TRUTH.number:
        from hpsop_core.evaluation.first_start import compile_kernels

        compile_kernels(case, lambda line: print(f"hpsop: {line}", file=sys.stderr, flush=True))
    if arguments.errors:
        from hpsop_core.evaluation.errors import evaluate_with_errors

        if arguments.level != 2:
            raise InputError("evaluate: --errors solves on a finer mesh, which level 2 has; add --level 2")
        result = evaluate_with_errors(case, variables or case.initial.variables, arguments.level, None)
    else:
        from hpsop_core.evaluation.stated_errors import with_stated_errors

        result = with_stated_errors(case, evaluate(case, variables, arguments.level))
    _tell_own_hull(case)
    _tell_own_propeller(case)
    if arguments.json:
        print_json(result.as_dict())
    else:
        print_evaluation(result)
    return 0 if result.ok else 1


def _tell_own_hull(case: Case) -> None:
    """What was understood of the hull file that a case names, on standard error."""
    from hpsop_core.evaluation.hull_answer import own_hull

    if case.hull.own_file:
        print(own_hull(case.hull).understood, file=sys.stderr)


def _tell_own_propeller(case: Case) -> None:
    """What was understood of the radial table that a case names, on standard error."""
    from hpsop_core.evaluation.propeller_answer import own_propeller

    if case.propeller.geometry:
        _tell_table(own_propeller(case.propeller))


def _tell_table(told: UnderstoodPropeller) -> None:
    """What was assumed of a radial table and what is doubted of it; nothing of a plain one."""
    for line in (*told.assumed, *(f"warning: {doubt}" for doubt in told.warnings)):
        print(f"{told.table.name}: {line}", file=sys.stderr)


def print_evaluation(result: Evaluation) -> None:
    print(f"{result.case}, level {result.level}: {result.status}{' - ' + result.reason if result.reason else ''}")
    print("\n".join(describe_variables(result.variables)))
    if not result.ok:
        return
    hull, own, size = result.hull, result.propeller, size_of_design(result)
    metres, volume, surface = size.unit("m", 2).decimals, size.unit("m³", 0).decimals, size.unit("m²", 0).decimals
    print(
        f"hull: Lpp {hull.length:.{metres}f} m, B {hull.breadth:.{metres}f} m, d {hull.draft:.{metres}f} m, "
        f"CB {hull.block_coefficient:.4f}, volume {hull.displaced_volume:,.{volume}f} m3, "
        f"S {hull.wetted_surface:,.{surface}f} m2, "
        f"LCB {100.0 * (hull.longitudinal_centre_of_buoyancy / hull.length - 0.5):+.2f} % of Lpp from midship "
        f"({hull.longitudinal_centre_of_buoyancy:.{metres}f} m from AP)"
    )
    print(
        f"propeller: D {own.diameter:.{max(3, metres)}f} m, Z {own.blade_count}, "
        f"P/D {own.pitch_diameter_ratio_07R:.4f} at 0.7 R, EAR {own.expanded_area_ratio:.3f}, "
        f"D/d {own.diameter / hull.draft:.3f}, "
        f"tip clearance to the hull {own.tip_clearance:.{metres}f} m"
    )
    if hull.booked_volume is not None:
        print(f"booked (affine form): CB {hull.booked_block_coefficient:.4f}, volume {hull.booked_volume:,.0f} m3")
    ship = [(item, item.value(result)) for item in (item.sized(size) for item in SHIP)]
    print("ship: " + ", ".join(f"{item.symbol.replace('_', ' ')} {item.text(result)} {item.unit}"
                               for item, value in ship if value is not None))  # fmt: skip
    _print_conditions(result.conditions, size)
    for c in result.conditions:
        if c.engine_load is not None:
            fuel = "" if c.fuel_rate is None else f", fuel {written(3.6 * c.fuel_rate, 't/h', 3)}"
            print(f"engine at {c.speed / KNOT:.2f} kn: {100.0 * c.engine_load:.1f} % of its rating{fuel}")
    for c in result.conditions:
        if c.blade_cavitation_margin is not None:
            print(
                f"blades at Fn {c.froude_number:.4f}: least Cp + sigma {c.blade_cavitation_margin:+.3f} at "
                f"{c.blade_cavitation_radius_ratio:.2f} R (from hub to 0.9 R); "
                f"{100.0 * (c.blade_cavitating_share or 0.0):.1f} % of the back below vapour pressure"
            )
    print("objectives: " + ", ".join(f"{name} {value:.5f}" for name, value in result.objectives.items() if value))
    limits = ", ".join(
        f"{name} {'not applied' if value is None else format(value, '+.4f')}"
        for name, value in result.constraints.items()
    )
    print(f"constraints (g <= 0): {limits}; {'feasible' if result.feasible else 'NOT feasible'}")
    standing = standing_on(result)
    if standing:
        print(f"stands on: {'; '.join(standing)}")
    _print_errors(result)
    for warning in result.warnings:
        print(f"warning: {warning}")


def _print_errors(result: Evaluation) -> None:
    """Half widths of 90 % intervals: of what is asked first, and what they consist of."""
    if not result.errors:
        return
    asked = [
        quantity
        for quantity in all_quantities(conditions_of(result), size_of_design(result))
        if quantity.key in ("f1", "f2", "fuel_per_hour")
        or quantity.key.rpartition("_")[0] in ("total_resistance", "delivered_power", "rotation_rate_rpm")
    ]
    told = [
        f"{item.symbol.replace('_', ' ')} {item.text(result)} {item.error_text(result)} {item.unit}".strip()
        for item in asked
        if item.error_text(result)
    ]
    how = "solved" if result.errors_source == "solved" else "typical of level 2; hpsop evaluate --errors solves them"
    print(f"errors (half widths of 90 % intervals, {how}): {'; '.join(told)}")
    for term, widths in result.error_terms.items():
        parts = [f"{name} {width:.3g}" for name, width in widths.items()]
        print(f"  of these, {term.replace('_', ' ')}: {', '.join(parts)}")
    if result.comparison_errors:
        parts = [f"{name} {100.0 * result.comparison_errors[name]:.2g} %" for name in ("f1", "f2")]
        print(f"  in a comparison with another design: {', '.join(parts)}")


_RESISTANCE_PARTS = (
    ("Rf", "friction_resistance"),
    ("k Rf", "form_resistance"),
    ("Rw", "wave_resistance"),
    ("Ra", "correlation_resistance"),
    ("Raa", "air_resistance"),
    ("Rapp", "appendage_resistance"),
    ("Rt", "total_resistance"),
)
"""Symbol and name; all but the last add up to it."""


def _print_conditions(conditions: Sequence[ConditionResult], size: Size) -> None:
    """Resistance in its parts, which add up, and propulsion."""
    force, power = size.unit("kN", 1), size.unit("MW", 2)
    print_table(
        ["Fn", "V m/s", "V kn", *(f"{symbol} {force.symbol}" for symbol, _ in _RESISTANCE_PARTS)],
        [
            [f"{c.froude_number:.4f}", f"{c.speed:.3f}", f"{c.speed / KNOT:.2f}"]
            + [f"{1e-3 * force.factor * (getattr(c, name) or 0.0):.{force.decimals}f}" for _, name in _RESISTANCE_PARTS]
            for c in conditions
        ],
    )
    header = ["Fn", "w", "t", "J", "n rpm", "KT", "10KQ", "eta0", "etaH", "etaR", "etaD"]
    header += [f"{symbol} {power.symbol}" for symbol in ("PE", "PD", "PB")]
    rows = [
        [
            f"{c.froude_number:.4f}", f"{c.wake_fraction:.4f}", f"{c.thrust_deduction:.4f}",
            f"{c.advance_coefficient:.4f}", f"{c.rotation_rate_rpm:.2f}", f"{c.thrust_coefficient:.4f}",
            f"{10 * c.torque_coefficient:.4f}", f"{c.open_water_efficiency:.4f}", _digits(c.hull_efficiency),
            _digits(c.relative_rotative_efficiency), _digits(c.propulsive_efficiency),
            *(
                f"{1e-6 * power.factor * (own or 0.0):.{power.decimals}f}"
                for own in (c.effective_power, c.delivered_power, c.brake_power)
            ),
            f"{c.required_expanded_area_ratio:.3f}",
        ]
        for c in conditions
    ]  # fmt: skip
    print_table([*header, "EAR"], rows)


def _digits(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}"


def _water(word: str | None) -> tuple[float | None, float | None]:
    """Density and viscosity that --water names; None, None where it is absent."""
    from hpsop_core.evaluation.resistance import DENSITY_RULE, VISCOSITY_RULE, WATERS

    if word is None:
        return None, None
    if word in WATERS:
        return WATERS[word]
    parts = word.split(",")
    if len(parts) != 2:
        raise InputError(f"--water {word}: write salt, fresh or DENSITY,VISCOSITY, for example 998.8,1.09e-6")
    density = checked_option(parts[0], DENSITY_RULE, "--water density")
    return density, checked_option(parts[1], VISCOSITY_RULE, "--water viscosity")


def _resistance(arguments: argparse.Namespace) -> int:
    from hpsop_core import resistance
    from hpsop_core.case.case import Case
    from hpsop_core.evaluation.resistance import FORM_FACTOR_RULE, FROUDE_RULE
    from hpsop_core.geometry.from_files import read_own_hull

    froude_numbers = number_list(arguments.froude, FROUDE_RULE, "--froude")
    form_factor = checked_option(arguments.form_factor, FORM_FACTOR_RULE, "--form-factor")
    files = [word for word in (arguments.offsets, arguments.hull) if word is not None]
    if len(files) + (arguments.case is not None) != 1:
        raise InputError(
            "resistance: give either a CASE, or --hull FILE (or --offsets FILE.csv) with --length and --draft"
        )
    subject: Case | Hull
    variables = told = None
    options = read_options(arguments)
    if files:
        if options.length is None or options.draft is None:
            raise InputError("resistance: a hull file needs --length (Lpp) and --draft, in metres")
        if arguments.changes:
            raise InputError("resistance: --set changes a case's design; a hull file is taken as it is")
        file = read_own_hull(files[0], options)
        told = file.understood
        subject = file.hull
    else:
        if options != ReadOptions():
            raise InputError(
                "resistance: --length, --draft, --breadth, --unit and --axes go with a file; change a case by --set"
            )
        subject, variables = case_and_design(arguments.case, arguments.changes)
    density, viscosity = _water(arguments.water)
    result = resistance(
        subject, froude_numbers, arguments.level, variables,
        form_factor=form_factor, density=density, viscosity=viscosity,
    )  # fmt: skip
    if told is not None:
        print(told, file=sys.stderr)
    elif isinstance(subject, Case):
        _tell_own_hull(subject)
    if arguments.json:
        print_json(result.as_dict())
        return 0
    print(", ".join(f"{name} {value:.6g}" for name, value in result.as_dict()["hull"].items()))
    for warning in result.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    rows = [
        [
            f"{p.froude_number:.4f}", f"{p.speed:.4f}", f"{1e3 * p.friction_coefficient:.4f}",
            f"{1e3 * p.wave_coefficient:.4f}",
            "-" if p.wave_coefficient_pressure is None else f"{1e3 * p.wave_coefficient_pressure:.4f}",
            *(f"{getattr(p, name):.6g}" for _, name in _RESISTANCE_PARTS),
        ]
        for p in result.points
    ]  # fmt: skip
    parts = [f"{symbol} N" for symbol, _ in _RESISTANCE_PARTS]
    print_table(["Fn", "V m/s", "10^3 CF", "10^3 Cw", "10^3 Cw(p)", *parts], rows)
    return 0


def _open_water(arguments: argparse.Namespace) -> int:
    from hpsop_core import load_propeller, open_water
    from hpsop_core.case.case import Case
    from hpsop_core.evaluation import open_water as test
    from hpsop_core.geometry.from_files import FEWEST_BLADES, MOST_BLADES
    from hpsop_core.geometry.propeller.input import read_propeller

    advance = number_list(arguments.advance, test.ADVANCE_RULE, "--advance")
    diameter = checked_option(arguments.diameter, test.DIAMETER_RULE, "--diameter")
    rate = checked_option(arguments.rotation_rate, test.ROTATION_RATE_RULE, "--rotation-rate")
    viscosity = checked_option(arguments.viscosity, test.VISCOSITY_RULE, "--viscosity")
    if (arguments.case is None) == (arguments.geometry is None):
        raise InputError("open-water: give either a CASE or --geometry FILE.csv with --blades")
    subject: Case | Propeller
    variables = None
    own: UnderstoodPropeller | None = None
    if arguments.geometry is not None:
        if arguments.blades is None:
            raise InputError("open-water: --geometry needs --blades, the number of blades")
        if arguments.changes:
            raise InputError("open-water: --set changes a case's design; a radial table is taken as it is")
        blades = checked_option(arguments.blades, FieldRule("integer", "", "", FEWEST_BLADES, MOST_BLADES), "--blades")
        subject = load_propeller(arguments.geometry, int(blades or 0))
        if arguments.geometry not in SHIPPED_PROPELLERS:
            own = read_propeller(arguments.geometry, subject.blade_count)
    else:
        if arguments.blades is not None:
            raise InputError("open-water: --blades goes with --geometry; change a case by --set blade_count=Z")
        subject, variables = case_and_design(arguments.case, arguments.changes)
    result = open_water(
        subject, advance, arguments.level, variables, diameter=diameter,
        rotation_rate=MODEL_ROTATION_RATE if rate is None else rate,
        viscosity=MODEL_VISCOSITY if viscosity is None else viscosity, inviscid=arguments.inviscid,
    )  # fmt: skip
    if isinstance(subject, Case):
        _tell_own_propeller(subject)
    elif own is not None:
        _tell_table(own)
    if arguments.json:
        print_json(result.as_dict())
        return 0
    rows = [
        [
            f"{p.advance_coefficient:.4f}", f"{p.thrust_coefficient:.5f}", f"{10 * p.torque_coefficient:.5f}",
            "-" if p.open_water_efficiency is None else f"{p.open_water_efficiency:.4f}",
        ]
        for p in result.points
    ]  # fmt: skip
    print_table(["J", "KT", "10KQ", "eta0"], rows)
    propeller, reynolds = result.propeller, result.reynolds_number_07R
    print(
        f"{result.solver}; D {propeller.diameter:g} m, Z {propeller.blade_count}, EAR "
        f"{propeller.expanded_area_ratio:.3f}, "
        + ("no viscosity" if result.inviscid else f"Re at 0.7 R {min(reynolds):.2e} to {max(reynolds):.2e}")
    )
    return 0


def _validate(arguments: argparse.Namespace) -> int:
    from hpsop_core.validation import all_checks
    from hpsop_core.validation.check import LABELS

    results = []
    for check in all_checks():
        results.append(check)
        if not arguments.json:
            mark = "pass" if check.passed else "MISS"
            print(
                f"{mark}  [{check.label}] {check.group}: {check.quantity}: computed {check.computed:.6g}, reference "
                f"{check.reference:.6g} ({check.source}; {check.tolerance})",
                flush=True,
            )
    if arguments.json:
        print_json({"checks": [dataclasses.asdict(check) for check in results]})
    missed = sum(not check.passed for check in results)
    for label in LABELS:
        kind = [check for check in results if check.label == label]
        print(f"{label}: {sum(check.passed for check in kind)} of {len(kind)} within their tolerance", file=sys.stderr)
    print(f"{len(results) - missed} of {len(results)} checks within their tolerance", file=sys.stderr)
    return 0 if missed == 0 else 1
