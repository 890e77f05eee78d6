"""A second, short calculation of a design from its case: every field of the case enters here by its published formula.

It shares with hpsop_core what is no question of the case: the parent's surface, Michell's integral of a given hull, and
KT and KQ of a given propeller at a given J. All else is written out anew, from the sources that the lines name.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from hpsop_core.assets import read_asset_text
from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.geometry.hull.hull import Hull, load_parent_hull
from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.hydro import michell
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag

BASE = case_from_toml(
    """
name = "by-hand"
[initial]
length = 340.0
breadth = 50.0
draft = 14.0
diameter = 8.8
blade_count = 4
expanded_area_ratio = 0.7
[bounds]
length_to_breadth = [6.4, 7.6]
breadth_to_draft = [3.2, 4.2]
draft = [13.5, 14.5]
diameter = [8.4, 9.2]
blade_count = [3, 6]
pitch_ratio = [0.9, 1.1]
displacement_ratio = [0.9, 1.1]
expanded_area_ratio = [0.5, 1.0]
[conditions]
froude_numbers = [0.2, 0.25]
weights = [0.7, 0.3]
[constants]
form_factor = 0.1
wave_calibration = "stated"
stated_wave_coefficients = [2.0e-4, 6.0e-4]
""",
    "by-hand.toml",
)
"""A ship of these tests alone. Level 1 without a look at level 2; each number is another one than a default."""

OTHER = DesignVariables.from_dict(
    {
        "length_to_breadth": 7.1,
        "breadth_to_draft": 3.5,
        "draft": 14.2,
        "diameter": 9.0,
        "blade_count": 5,
        "pitch_ratio": 1.04,
        "displacement_ratio": 0.97,
        "expanded_area_ratio": 0.85,
        "buoyancy_centre_shift": 0.004,
    }
)
"""A design that differs from the initial one in everything."""

# P4119 as published (Jessup 1989): c/D at 0.7 R of three blades, and their expanded area ratio as our table integrates.
CHORD_07 = 0.4622
AIR_DENSITY = 1.226  # kg/m3 at 15 C, ITTC


@dataclass(frozen=True)
class Point:
    """A condition by hand; J is taken from the answer under test, and KT there must then be what is required."""

    froude_number: float
    speed: float
    friction_resistance: float
    form_resistance: float
    wave_resistance: float
    correlation_resistance: float
    air_resistance: float
    appendage_resistance: float
    total_resistance: float
    wake_fraction: float
    thrust_deduction: float
    thrust: float
    rotation_rate_rpm: float
    thrust_coefficient: float
    torque: float
    open_water_efficiency: float
    delivered_power: float
    brake_power: float
    cavitation_number: float
    reynolds_number_07R: float  # noqa: N815 - the name under test
    required_expanded_area_ratio: float


def scaled_volume(case: Case) -> float:
    """The parent's displacement at the initial dimensions: a scaled body's volume goes with the product of scales."""
    parent, initial = load_parent_hull("dtc"), case.initial
    scale = initial.length * initial.breadth * initial.draft / (parent.length * parent.breadth * parent.draft)
    return parent.hydrostatics.displaced_volume * scale


def shape(case: Case, design: DesignVariables) -> tuple[Hull, float]:
    """The hull, and the volume that the case counts."""
    breadth = design.breadth_to_draft * design.draft
    length = design.length_to_breadth * breadth
    asked = scaled_volume(case) * case.initial.displacement_ratio * design.displacement_ratio
    affine = case.hull.form == "affine"
    hull = load_parent_hull("dtc").transform(
        length, breadth, design.draft, None if affine else asked, design.buoyancy_centre_shift * length
    )
    return hull, asked if affine else hull.hydrostatics.displaced_volume


def wave_coefficients(hull: Hull, froude_numbers: list[float]) -> list[float]:
    """Michell's."""
    table = hull.offset_table()
    surface = hull.hydrostatics.wetted_surface
    found = michell.wave_coefficients(table.x, table.z, table.y, hull.length, surface, froude_numbers)
    return [float(value) for value in found]


def taylor(block: float) -> float:
    """Taylor's single-screw table by a parabola of least squares, constant below its minimum."""
    lines = [line.split(",") for line in read_asset_text("reference", "taylor_wake.csv").splitlines()]
    table = np.array([[float(word) for word in line] for line in lines if line[0][:1].isdigit()])
    a, b, c = np.linalg.lstsq(np.vander(table[:, 0], 3), table[:, 1], rcond=None)[0]
    at = max(block, -b / (2.0 * a))
    return float(a * at**2 + b * at + c)


def by_hand(case: Case, design: DesignVariables, advance: list[float]) -> list[Point]:
    """Every condition of a design; ``advance`` are the J under test."""
    own, (hull, volume) = case.constants, shape(case, design)
    length, breadth, draft = hull.length, hull.breadth, hull.draft
    surface = hull.hydrostatics.wetted_surface
    initial_length = case.initial.length
    if case.conditions.speeds_knots:
        speeds = [knots * 1852.0 / 3600.0 for knots in case.conditions.speeds_knots]
        stated = [speed / math.sqrt(own.gravity * initial_length) for speed in speeds]
    else:
        stated = list(case.conditions.froude_numbers)
        speeds = [number * math.sqrt(own.gravity * initial_length) for number in stated]
    if case.conditions.speed == "froude":
        speeds = [number * math.sqrt(own.gravity * length) for number in stated]
    froude = [speed / math.sqrt(own.gravity * length) for speed in speeds]
    waves = wave_coefficients(hull, froude)
    if own.wave_calibration == "stated":
        initial_hull, _ = shape(case, case.initial.variables)
        initial_waves = wave_coefficients(initial_hull, stated)
        factors = [a / b for a, b in zip(own.stated_wave_coefficients, initial_waves, strict=True)]
        # Between the conditions the factor is linear in the Froude number, beyond them constant.
        waves = [wave * float(np.interp(at, stated, factors)) for wave, at in zip(waves, froude, strict=True)]
    block = volume / (length * breadth * draft)
    wake = 0.5 * block - 0.05 if own.wake_formula == "linear" else taylor(block)
    deduction = own.thrust_deduction_factor * wake
    blades = propeller_family(
        load_propeller("p4119"), design.diameter, design.blade_count, design.pitch_ratio, design.expanded_area_ratio
    )
    three = load_propeller("p4119")
    parent_area = three.expanded_area_ratio_per_blade * three.blade_count
    # The family keeps the outline: chords go with the area of one blade.
    chord = CHORD_07 * design.expanded_area_ratio / parent_area * 3.0 / design.blade_count * design.diameter
    settings = lifting_line.LiftingLineSettings(camber_effectiveness=0.846)
    if own.camber_scaling == "reynolds":
        # The panels' blade loses 6.5 % of its camber on P4119's model, chord 0.141 m at 7.03 m/s in 1e-6 m2/s.
        reynolds = CHORD_07 * 0.3048 * 10.0 * 0.3048 * math.hypot(0.7, 0.7 * math.pi) / 1e-6
        model = 0.044 * reynolds ** (-1 / 6) - 5.0 * reynolds ** (-2 / 3)
        rough = (1.89 + 1.62 * math.log10(chord / own.propeller_roughness)) ** -2.5
        settings = replace(settings, camber_effectiveness=0.846 * (1.0 - 0.065 * rough / model) / 0.935)
    drag = SectionDrag.full_scale(own.propeller_roughness)
    curve = lifting_line.solve(blades, np.array(advance), drag, settings)
    shaft = load_parent_hull("dtc").shaft_height * draft / load_parent_hull("dtc").draft
    margin = own.atmospheric_pressure + own.density * own.gravity * (draft - shaft) - own.vapour_pressure
    points = []
    for index, (number, speed) in enumerate(zip(froude, speeds, strict=True)):
        dynamic = 0.5 * own.density * speed**2 * surface
        friction = 0.075 / (math.log10(speed * length / own.viscosity) - 2.0) ** 2 * dynamic
        parts = {
            "friction_resistance": friction,
            "form_resistance": own.form_factor * friction,
            "wave_resistance": waves[index] * dynamic,
            "correlation_resistance": own.correlation_allowance * dynamic,
            "air_resistance": 0.5
            * AIR_DENSITY
            * speed**2
            * own.air_drag_coefficient
            * own.frontal_area
            * breadth
            / case.initial.breadth,
            "appendage_resistance": own.appendage_factor * friction,
        }
        total = math.fsum(parts.values())
        thrust = total / (1.0 - deduction)
        inflow = (1.0 - wake) * speed
        rate = inflow / (advance[index] * design.diameter)
        kt, kq = float(curve.thrust_coefficient[index]), float(curve.torque_coefficient[index])
        torque = kq * own.density * rate**2 * design.diameter**5 / own.relative_rotative_efficiency
        power = 2.0 * math.pi * rate * torque
        section = math.hypot(inflow, 0.7 * math.pi * rate * design.diameter)
        keller = (1.3 + 0.3 * design.blade_count) * thrust / (margin * design.diameter**2) + case.constraints.keller_k
        points.append(
            Point(
                froude_number=number,
                speed=speed,
                **parts,
                total_resistance=total,
                wake_fraction=wake,
                thrust_deduction=deduction,
                thrust=thrust,
                rotation_rate_rpm=60.0 * rate,
                thrust_coefficient=thrust / (own.density * rate**2 * design.diameter**4),
                torque=torque,
                open_water_efficiency=advance[index] * kt / (2.0 * math.pi * kq),
                delivered_power=power,
                brake_power=power * (1.0 + own.sea_margin) / own.shaft_efficiency,
                cavitation_number=margin / (0.5 * own.density * section**2),
                reynolds_number_07R=chord * section / own.viscosity,
                required_expanded_area_ratio=keller,
            )
        )
        # Where they meet, the propeller gives what is required: 5e-4 is the error of the curve between its nodes.
        assert abs(points[-1].thrust_coefficient / kt - 1.0) < 5e-4, "KT required and available at J"
    return points
