"""A case made for a hull that was read: its own dimensions, speeds that suit its fullness, bounds round both."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hpsop_core.case.case import Case
from hpsop_core.case.sections import (
    ConditionsSection,
    ConstraintsSection,
    HullSection,
    InitialSection,
    OptimizationSection,
    PropellerSection,
)
from hpsop_core.case.variables import VARIABLE_NAMES, DesignSpace
from hpsop_core.geometry.hull.hull import ParentHull
from hpsop_core.geometry.hull.input import HullFile, ReadOptions
from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family
from hpsop_core.geometry.room_for_propeller import PropellerRoom, room_for_propeller

# The greatest propeller: this part of the draft, and its tip this part of the draft above the baseline.
DIAMETER_TO_DRAFT, LEAST_DIAMETER_TO_DRAFT, BASELINE_CLEARANCE = 0.62, 0.3, 0.03
# The second, slower condition, as a part of the service speed.
SLOW = 0.9
# What the solvers are made for; below the third number level 2's waves pass through zero, and level 1 alone is far too
# high on full forms.
FROUDE_LIMITS = (0.12, 0.34)
LEAST_TRUSTED = 0.18
_CHECK = " Check the speeds (Froude numbers that suit CB {1:.3f}), the propeller and the bounds."
_CHECK_SLOW = (
    " Check the propeller and the bounds. At the Froude number of {0:.3f} that suits CB {1:.3f} level 2 gives no "
    "waves: the speeds here are higher, the slowest that can be computed."
)
_OPEN_SHAFT = (
    " The run rises over the shaft: the hub was put {0:.4g} m from AP, on an open shaft {1:.3g} m above the "
    "baseline, where the blades clear the hull; state hull.boss_x and hull.shaft_height."
)


def usual_froude_number(block_coefficient: float) -> float:
    """The service Froude number that suits a block coefficient, CB = 1.08 - 1.68 Fn (Alexander's formula)."""
    return float(np.clip((1.08 - block_coefficient) / 1.68, *FROUDE_LIMITS))


def _propeller_place(parent: ParentHull) -> tuple[PropellerRoom | None, float]:
    """Where the propeller stands (None: where the hull has it), and the diameter of one that fits, m.

    Above the baseline, within the usual share of the draft, clear of the hull; the shipped blade stands for any.
    """
    above_baseline = 2.0 * (parent.shaft_height - BASELINE_CLEARANCE * parent.draft)
    least = LEAST_DIAMETER_TO_DRAFT * parent.draft
    greatest = max(min(DIAMETER_TO_DRAFT * parent.draft, above_baseline), least)
    blade = load_propeller()
    room = room_for_propeller(
        parent,
        lambda diameter: propeller_family(blade, diameter, 4),
        greatest,
        least,
        BASELINE_CLEARANCE * parent.draft,
    )
    return room, greatest if room is None else room.diameter


def ready_case(
    file: HullFile,
    path: str,
    options: ReadOptions,
    propeller: str = "",
    blade_count: int | None = None,
    made: str = "",
) -> Case:
    """A case for a hull of one's own.

    Args:
        file: as it was read.
        path: of the file, as the case is to name it (relative to the case's folder, or absolute).
        options: with which it was read; what was assumed is stated in the case.
        propeller: file of a radial table; "" takes the shipped one.
        blade_count: of that table.
        made: the description's first sentence, how the case was made; "": by ``hpsop hull``.
    """
    parent, told = file.parent, file.understood
    axes = options.axes
    room, diameter = _propeller_place(parent)
    hull = HullSection(
        file=path,
        length=round(parent.length, 6),
        draft=round(parent.draft, 6),
        breadth=options.breadth,
        unit=_unit(options, told.unit),
        bow=axes.bow,
        origin=axes.origin,
        waterline=axes.waterline,
        up=axes.up,
        boss_x=None if room is None else round(room.boss_x, 6),
        shaft_height=None if room is None else round(room.shaft_height, 6),
    )
    diameter = float(f"{diameter:.3g}")
    initial = InitialSection(
        length=hull.length or parent.length,
        breadth=round(parent.breadth, 6),
        draft=hull.draft or parent.draft,
        diameter=diameter,
        blade_count=blade_count or 4,
        pitch_ratio=1.0,
        displacement_ratio=1.0,
        expanded_area_ratio=0.65,
        buoyancy_centre_shift=0.0,
    )
    froude = usual_froude_number(told.block_coefficient)
    slow = max(SLOW * froude, LEAST_TRUSTED)
    speeds = (round(slow, 3), round(max(froude, slow / SLOW), 3))
    space = DesignSpace.around(initial.variables).as_dict()
    # Whatever is asked of the propeller, its area must be able to grow.
    space["expanded_area_ratio"] = (0.45, 1.0)
    ratio = diameter / parent.draft
    limits = ConstraintsSection(
        diameter_to_draft_lower=min(ConstraintsSection.diameter_to_draft_lower, round(0.88 * ratio, 3)),
        diameter_to_draft_upper=max(ConstraintsSection.diameter_to_draft_upper, round(1.12 * ratio, 3)),
    )
    name = Path(path).stem.replace(" ", "-") or "own-hull"
    return Case(
        name=name,
        title=f"{Path(path).name}, L {parent.length:.4g} m, B {parent.breadth:.4g} m, T {parent.draft:.4g} m",
        description=(
            (made or f"Made by 'hpsop hull' for {Path(path).name}.")
            + (_CHECK_SLOW if speeds[1] > froude + 1e-3 else _CHECK).format(froude, told.block_coefficient)
            + (_OPEN_SHAFT.format(room.boss_x, room.shaft_height) if room is not None else "")
        ),
        hull=hull,
        propeller=PropellerSection(geometry=propeller, geometry_blade_count=blade_count or 3)
        if propeller
        else PropellerSection(),
        initial=initial,
        bounds=DesignSpace.from_bounds(space),
        conditions=ConditionsSection(froude_numbers=speeds, weights=(0.65, 0.35)),
        constraints=limits,
        # One gene of each design, on average: fronts of several seeds then end closer together. And level 2 by a learnt
        # surface, without which a front takes minutes.
        optimization=OptimizationSection(mutation_probability=round(1.0 / len(VARIABLE_NAMES), 2), surface=True),
    )


def _unit(options: ReadOptions, understood: str) -> str:
    """The stated unit, or the one that a mesh was taken for; a table's own headers keep speaking for themselves."""
    if options.unit is not None:
        return options.unit
    return understood if understood in ("m", "mm", "cm", "ft", "in") else "auto"
