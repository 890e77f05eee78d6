"""What a case assumes, and how far its numbers can be trusted, in sentences."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.case.case import KNOT, Case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.objectives import objective_named
from hpsop_core.case.sections import ConstantsSection
from hpsop_core.case.ship import kilograms_per_joule
from hpsop_core.case.variables import SEARCH_TABLE
from hpsop_core.evaluation.levels import FAST, TRUTH, level_of
from hpsop_core.markup import Markup, fill, joined, one_line, symbol_html
from hpsop_core.quantities import number_text, variable_quantity
from hpsop_core.report.html_page import Words, bullets, facts, table, unit_html
from hpsop_core.units import written

_FORM: dict[str, Words] = {
    "shift": "Length, breadth and draft scale the parent hull; the displacement asked for is then reached by moving "
    "its sections along the ship (a true change of block coefficient), as far as the parent's form carries it.",
    "affine": Markup(
        "Length, breadth and draft scale the parent hull and nothing else: the block coefficient of the geometry "
        "stays the parent's. Displacement and block coefficient are only <em>booked</em>: they enter wake, thrust "
        "deduction and the displacement constraint, not the hull's shape."
    ),
}
_SPEED = {
    "fixed": "Every design runs at the same speeds, those below.",
    "froude": "Every design runs at the Froude numbers below on its own length, so a shorter ship is judged at a lower "
    "speed.",
}
_CALIBRATION = {
    "level2": "scaled by one factor a condition, so that the initial design has its level-2 value",
    "learnt": "corrected towards level 2 by a smooth function of the form, learnt on a few dozen hulls of the design "
    "space",
    "stated": "scaled by one factor a condition, so that the initial design has the wave coefficients stated in the "
    "case",
    "none": "used as Michell's integral gives it, which on a flat stern like the DTC's is several times too high",
}
_CAMBER = {
    "model": "as much at full scale as on the model that it was fitted on",
    "reynolds": "scaled from the model that it was fitted on in proportion to the friction",
}


def objective_lines(case: Case) -> list[Markup]:
    """The two objectives in words."""
    names = (case.objectives.first, case.objectives.second)
    line = "{}: {} <span class=unit>({})</span>"
    return [
        fill(line, symbol_html(f"f_{number}"), objective.words, objective.title)
        for number, objective in enumerate(map(objective_named, names), start=1)
    ]


def constraint_clauses(case: Case) -> list[Markup]:
    """What the case asks by each constraint."""
    clauses = [(item.symbol, item.asked(case)) for item in CONSTRAINTS]
    return [fill("{}: {}", symbol_html(symbol), asked) for symbol, asked in clauses if asked]


def assumptions(case: Case) -> Markup:
    """Form, speed, conditions, objectives, constraints with their level, calibration and constants."""
    hull, propeller, constants = case.hull, case.propeller, case.constants
    hull_file = hull.own_file
    own_hull = f"own hull from {Path(hull_file).name}" if hull_file else f"parent hull {hull.parent}"
    own_blades = (
        f"own propeller from {Path(propeller.geometry).name}"
        if propeller.geometry
        else f"parent propeller {propeller.parent}"
    )
    lines: list[Words] = [
        fill("<strong>Parents</strong>: {}, {}.", one_line(own_hull), one_line(own_blades)),
        fill("<strong>Hull form</strong> ({}): {}", hull.form, _FORM[hull.form]),
        fill("<strong>Speed</strong> ({}): {}", case.conditions.speed, _SPEED[case.conditions.speed]),
        fill(
            "<strong>Level {}</strong> (fast): {}. <strong>Level {}</strong> (slow, better): {}. Friction by ITTC-57 "
            "at both.",
            FAST.number,
            FAST.words,
            TRUTH.number,
            TRUTH.words,
        ),
        fill(
            "<strong>Calibration</strong>: level 1's wave resistance is {}.", _CALIBRATION[constants.wave_calibration]
        ),
        fill("<strong>Constraints</strong>: {}.", joined(constraint_clauses(case), "; ")),
    ]
    conditions = table(
        ["condition", "initial design's Froude number Fn", "its speed [kn]", "share of time"],
        [
            [str(number), number_text(froude, 3), number_text(speed / KNOT, 2), number_text(weight, 3)]
            for number, (froude, speed, weight) in enumerate(
                zip(case.froude_numbers, case.speeds, case.conditions.weights, strict=True), start=1
            )
        ],
        caption="Operating conditions",
    )
    return fill(
        "{}<h3>Objectives, both minimised</h3>{}{}{}<h3>Constants</h3>{}",
        bullets(lines),
        bullets(objective_lines(case)),
        conditions,
        _design_space(case),
        _constants(case),
    )


def _design_space(case: Case) -> Markup:
    initial = case.bounds.values(case.initial.variables)
    rows: list[list[Words]] = []
    for key, (lower, upper) in case.bounds.as_dict().items():
        quantity, shown = variable_quantity(key, case.initial.variables), SEARCH_TABLE[key].shown
        numbers = [number_text(shown(value), quantity.decimals) for value in (initial[key], lower, upper)]
        name = fill("{} {} {}", quantity.label, symbol_html(quantity.symbol), unit_html(quantity.unit))
        spread = numbers[1:] if lower < upper else [numbers[1], "fixed"]
        rows.append([name, numbers[0], *spread])
    return table(["variable", "initial design", "lower bound", "upper bound"], rows, caption="Design space")


def _constants(case: Case) -> Markup:
    c = case.constants
    left_out = [
        words
        for words, value in (
            ("correlation allowance", c.correlation_allowance or c.correlation_allowance_formula != "stated"),
            ("air drag", c.frontal_area * c.air_drag_coefficient),
            ("appendages", c.appendage_factor),
            ("sea margin", c.sea_margin),
        )
        if not value
    ]
    return facts(
        [
            (
                "water",
                fill(
                    "ρ {} kg/m³, ν {:.4g} · 10<sup>−6</sup> m²/s", number_text(c.density, 1), float(c.viscosity * 1e6)
                ),
            ),
            ("gravity", f"{c.gravity:.6g} m/s²"),
            (
                "pressure",
                f"atmosphere {number_text(1e-3 * c.atmospheric_pressure, 1)} kPa, "
                f"vapour {number_text(1e-3 * c.vapour_pressure, 2)} kPa",
            ),
            ("form factor k on friction", _stated(c.form_factor_formula, number_text(c.form_factor, 3))),
            (
                "correlation allowance",
                _stated(c.correlation_allowance_formula, number_text(c.correlation_allowance, 6)),
            ),
            (
                "air drag",
                f"coefficient {number_text(c.air_drag_coefficient, 2)} on {number_text(c.frontal_area, 0)} m² of the "
                "initial design, in proportion to the breadth",
            ),
            ("appendages", f"{number_text(100.0 * c.appendage_factor, 1)} % of the flat-plate friction"),
            ("wake fraction w", _wake(c)),
            ("thrust deduction t", _thrust_deduction(c)),
            (
                "relative rotative efficiency",
                _stated(c.relative_rotative_efficiency_formula, number_text(c.relative_rotative_efficiency, 3)),
            ),
            ("sea margin", f"{number_text(100.0 * c.sea_margin, 1)} % on the brake power"),
            ("shaft efficiency", number_text(c.shaft_efficiency, 3)),
            ("blade roughness", f"{number_text(1e6 * c.propeller_roughness, 0)} µm"),
            ("camber lost on the blades", _CAMBER[c.camber_scaling]),
            *_ship(case),
            ("not included", ", ".join([*left_out, "added resistance in waves and wind", "shallow water"])),
        ]
    )


def _ship(case: Case) -> list[tuple[str, Words]]:
    """What the case states of loading and engine."""
    loading, engine = case.loading, case.engine
    found: list[tuple[str, Words]] = []
    if loading.centre_of_gravity_height is not None:
        height = number_text(loading.centre_of_gravity_height, 2)
        found.append(("centre of gravity", f"{height} m above the baseline, in proportion to depth"))
    if loading.lightship_mass is not None:
        mass = written(1e-3 * loading.lightship_mass, "t", 0)
        found.append(("lightship", f"{mass}, in proportion to L B depth"))
    if engine.maximum_continuous_rating is not None:
        rate = engine.rated_rotation_rate_rpm
        at = "" if rate is None else f" at {number_text(rate, 1)} rpm"
        found.append(("engine", f"{written(1e-6 * engine.maximum_continuous_rating, 'MW', 2)}{at}"))
    if engine.load_fractions:
        grams = [3.6e9 * kilograms_per_joule(value) for value in engine.specific_fuel_consumptions]
        pairs = zip(engine.load_fractions, grams, strict=True)
        words = ", ".join(f"{number_text(value, 0)} at {number_text(100.0 * load, 0)} %" for load, value in pairs)
        found.append(("specific fuel consumption", f"{words} load [g/kWh]"))
    return found


_CHANGE = "for the initial design, the others by the change of Holtrop and Mennen's"


def _stated(formula: str, number: str) -> str:
    return {"stated": number, "scaled": f"{number} {_CHANGE}", "holtrop": "Holtrop and Mennen"}[formula]


def _wake(c: ConstantsSection) -> Words:
    if c.wake_formula == "stated":
        return f"{number_text(c.stated_wake_fraction, 3)} {_CHANGE}"
    return {
        "taylor_quadratic": "Taylor's table for single-screw ships, quadratic fit",
        "linear": Markup("0.5 C<sub>B</sub> − 0.05"),
        "holtrop": "Holtrop and Mennen",
    }[c.wake_formula]


def _thrust_deduction(c: ConstantsSection) -> str:
    if c.thrust_deduction_formula == "stated":
        return f"{number_text(c.stated_thrust_deduction, 3)} {_CHANGE}"
    if c.thrust_deduction_formula == "holtrop":
        return "Holtrop and Mennen"
    return f"{number_text(c.thrust_deduction_factor, 2)} w (Schoenherr)"


def trust(case: Case, level: int | None) -> Markup:
    """How far the numbers can be trusted; short, and true of this case."""
    lines: list[Words] = []
    caution = "" if level is None else level_of(level).caution
    if caution:
        lines.append(fill("<strong>All results here are of level {}.</strong> {}", level, caution))
    if case.hull.form == "affine":
        lines.append(
            Markup(
                "<strong>The block coefficient is only booked.</strong> A change of fullness costs no resistance here, "
                "as it would on a real ship: gains that come with a higher booked block coefficient are not to be "
                "believed."
            )
        )
    if case.constants.wave_calibration == "none":
        lines.append(
            "Plain Michell gives about seven times the wave resistance measured in the towing tank on the DTC's wide "
            "flat stern, so level 1 exaggerates what slenderness gains."
        )
    if case.conditions.speed == "froude":
        lines.append(
            "Designs of different lengths are compared at different speeds; at one contract speed the order may differ."
        )
    if case.hull.own_file or case.propeller.geometry:
        lines.append(
            Markup(
                "<strong>Own geometry.</strong> The checks below were made with the DTC and P4119; none was made with "
                "the hull or propeller of this case."
            )
        )
    lines += [
        Markup(
            "<strong>Resistance, level 2.</strong> On the DTC model the total resistance coefficient is within 2 % of "
            "the towing tank at Froude numbers 0.174 to 0.218 (wave part at 0.218: 3.8 against 3.4 · "
            "10<sup>−4</sup>). No test exists above 0.218: what stands here at 0.27 is extrapolation. Linear "
            "potential flow: no viscous stern, no breaking waves, hull fixed in its static position."
        ),
        Markup(
            "<strong>Propeller.</strong> Against the open-water test of P4119, thrust and torque of level 2 are "
            "within 4 %, between J 0.5 and 0.9. Full scale, other blade counts and other areas rest on theory."
        ),
        Markup(
            "<strong>Hull and propeller together.</strong> Wake and thrust deduction are regressions on the block "
            "coefficient, not computed flow: absolute power can be off by more than all differences in these tables. "
            "Differences between similar designs are worth more than the absolute numbers."
        ),
        Markup(
            "<strong>Not looked at</strong>: strength of hull and blades, damage stability, cargo space, "
            "seakeeping, manoeuvring, vibration, cost. The form is fitted, not faired by hand."
        ),
        Markup(
            "<strong>Efficiency is not power.</strong> A propeller of better open-water efficiency can need more power "
            "on a worse hull; read delivered power."
        ),
    ]
    return bullets(lines) + Markup(
        '<p class="soft">Every check with its source: <code>hpsop validate</code>; what each theory neglects stands in '
        "hpsop's documentation.</p>"
    )
