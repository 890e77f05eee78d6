"""Charts of hull and propeller together: open water over J, resistance and thrust over speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hpsop_core.case.case import KNOT
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.charts.axis import Axis, Limits, padded
from hpsop_core.charts.looks import Look, Published, Sheet, draw_published
from hpsop_core.charts.plot import Plot
from hpsop_core.evaluation.curves import ThrustCurves, smooth_open_water
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import fill
from hpsop_core.typing_aliases import Array
from hpsop_core.units import axis_unit, written

_EMPTY_RANGE = (0.16, 0.3)
_FEW_CONDITIONS = 3
_HIGHEST = 1.4
_FEW = 2
# px: closer together two names at the foot of their lines would lie on each other
_NAME_WIDTH = 24.0
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
Curves = tuple[Array, Array, Array, Array]
WAITING = "computing …"


def open_water_chart(
    designs: Sequence[tuple[Look, Evaluation]],
    sheet: Sheet,
    published: Sequence[Published] = (),
    required: bool = True,
) -> Plot:
    """KT, 10KQ and efficiency against J, the required KT of each condition, and the operating points.

    Args:
        designs: what is compared; the last is the main one, whose conditions are named.
        sheet: size and style.
        published: points to draw in.
        required: whether the conditions are drawn.
    """
    shown = [(look, smooth_open_water(item.open_water), item) for look, item in designs if item.ok]
    longest = max((float(curves[0][-1]) for _, curves, _ in shown), default=1.2)
    tops = [float(np.nanmax(values)) for _, (_, _, kq, eta), _ in shown for values in (kq, eta)]
    top = min(1.05 * max([0.8, *tops]), _HIGHEST)
    x = Axis("advance coefficient J [–]", (0.0, longest))
    y = Axis("K_T, 10K_Q, η₀ [–]", (0.0, top), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(48, 12, 8, 34), style=sheet.style)
    if not shown:
        plot.message("no open-water curves for this design")
    for index, (look, curves, evaluation) in enumerate(shown):
        j = curves[0]
        for number, (values, word) in enumerate(zip(curves[1:], ("KT", "10KQ", "η₀"), strict=True)):
            plot.line(j, values, look.css, name=f"{word}, {look.name}", key="" if number else look.name)
        if required:
            _conditions(plot, look, evaluation, j, index == len(shown) - 1)
    if required and shown:
        parabola = "required soft" if len(shown) > 1 else f"required {shown[0][0].role}"
        plot.line([], [], parabola, key="required K_T, a condition each")
    _name_curves(plot, [curves for _, curves, _ in shown])
    draw_published(plot, published)
    return plot


def _conditions(plot: Plot, look: Look, evaluation: Evaluation, j: Array, main: bool) -> None:
    places = [condition.advance_coefficient for condition in evaluation.conditions]
    for number, condition in enumerate(evaluation.conditions, start=1):
        at, thrust, efficiency = places[number - 1], condition.thrust_coefficient, condition.open_water_efficiency
        if not at > 0.0:
            continue
        needed = thrust / at**2 * j**2
        if main or look.role == "initial":
            visible = np.where(needed <= 1.6 * thrust, needed, np.nan)
            plot.line(j, visible, f"required {look.role}", name=f"required KT, condition {number}, {look.name}")
        label = f"{look.name}, {condition.speed / KNOT:.4g} kn: J{str(number).translate(_SUBSCRIPTS)} {at:.4f}"
        series = f"operating point, condition {number}, {look.name}"
        plot.mark(at, thrust, "circle", 3.6, look.role, title=f"{label}, KT {thrust:.4f}", name=f"KT, {series}")
        plot.mark(at, efficiency, "circle", 3.0, look.role, title=f"{label}, η₀ {efficiency:.4f}", name=f"η₀, {series}")
        if main:
            a, b, ground = (float(v) for v in (plot.px(at), plot.py(efficiency), plot.py(0.0)))
            plot.raw(fill('<path d="M{:.1f} {:.1f}V{:.1f}" class="guide"/>', a, b, ground))
    if main:
        _name_conditions(plot, places)


def _name_conditions(plot: Plot, places: Sequence[float]) -> None:
    """The conditions' names at their advance coefficients: where lines nearly coincide, one name for all of them."""
    numbered = sorted((at, number) for number, at in enumerate(places, start=1) if at > 0.0)
    groups: list[list[tuple[float, int]]] = []
    for at, number in numbered:
        if not groups or float(plot.px(at)) - float(plot.px(groups[-1][-1][0])) > _NAME_WIDTH:
            groups.append([])
        groups[-1].append((at, number))
    for group in groups:
        names = ", ".join(f"J_{number}" for number in sorted(number for _, number in group))
        # right of its line stands the last, where no other follows
        right = group is groups[-1]
        at = group[-1 if right else 0][0]
        plot.text(at, 0.0, names, "soft", "start" if right else "end", dx=3 if right else -3, dy=-5)


def _name_curves(plot: Plot, drawn: Sequence[Curves]) -> None:
    """KT, 10KQ and eta0 where the three are apart: at low J, at the peak, and where the thrust has nearly gone."""
    if not drawn:
        return
    j, _, _, eta = drawn[-1]
    late, peak = int(0.76 * len(j)), int(np.nanargmax(eta))
    for place, height, word, dx, dy in (
        (1, max(float(kq[1]) for _, _, kq, _ in drawn), "10K_Q", 5, -5),
        (peak, max(float(np.nanmax(eta)) for *_, eta in drawn), "η₀", -4, -5),
        (late, min((float(kt[late]) for _, kt, _, _ in drawn if kt[late] > 0.0), default=0.0), "K_T", -20, 12),
    ):
        plot.text(float(j[place]), height, word, dx=dx, dy=dy)


def _force_unit(forces: Sequence[float], published: Sequence[Published]) -> tuple[str, float]:
    """The unit of an axis of forces (N), and what a newton is in it; published points stand in MN."""
    finite = [abs(force) for force in forces if np.isfinite(force)]
    return axis_unit("force", math.inf if published or not finite else max(finite))


def resistance_chart(
    designs: Sequence[tuple[Look, Sequence[ResistancePoint], Evaluation]],
    which: str,
    sheet: Sheet,
    published: Sequence[Published] = (),
    knots: bool = False,
) -> Plot:
    """Wave ("wave") or total ("total") resistance over speed, the conditions marked.

    Args:
        designs: what is compared.
        which: "wave" or "total".
        sheet: size and style.
        published: points to draw in, over Froude number.
        knots: over the speed in knots, where all designs sail at the same speeds, instead of each one's Froude number;
            the legend then has the Froude numbers.
    """
    name = f"{which}_resistance"
    # both charts, which stand above each other, in the unit of the total
    unit, scale = _force_unit([point.total_resistance for _, points, _ in designs for point in points], published)
    curves = [
        (
            np.array([point.speed / KNOT if knots else point.froude_number for point in points]),
            np.array([scale * getattr(point, name) for point in points]),
        )
        for _, points, _ in designs
    ]
    top = padded([*(v for _, force in curves for v in force), *(v for item in published for v in item.y), 0.0])[1]
    word = f"wave resistance R_W [{unit}]" if which == "wave" else f"total resistance R_T [{unit}]"
    x = _speed_axis([speed for speed, _ in curves], knots)
    plot = Plot(sheet.width, sheet.height, x, Axis(word, (0.0, top), 5), margins=(48, 12, 8, 34), style=sheet.style)
    if not designs:
        plot.message(WAITING)
    for (look, _, evaluation), (speed, force) in zip(designs, curves, strict=True):
        key = f"{look.name}{_froude_words(evaluation)}" if knots else look.name
        plot.line(speed, force, look.css, name=look.name, key=key, curved=True)
        for condition in evaluation.conditions:
            value = getattr(condition, name)
            title = f"{look.name}, {_condition_words(condition)}: {written(1e-3 * value, 'kN', 0)}"
            plot.mark(_place(condition, knots), scale * value, "circle", 3.6, look.role, title=title)
    draw_published(plot, published)
    return plot


def thrust_chart(
    designs: Sequence[tuple[Look, ThrustCurves, Evaluation]],
    sheet: Sheet,
    published: Sequence[Published] = (),
    knots: bool = False,
) -> Plot:
    """Thrust required by the hull, and given by the propeller at each condition's rate of rotation, over speed.

    Arguments as of ``resistance_chart``.
    """
    # high enough for the operating points with air above; the steep ends of the curves may leave the chart
    points = [condition.thrust for _, _, evaluation in designs for condition in evaluation.conditions]
    unit, scale = _force_unit(points, published)
    top = 1.5 * max(
        [*(scale * force for force in points), *(value for item in published for value in item.y)], default=1.0
    )
    speeds = [curves.speed / KNOT if knots else curves.froude_number for _, curves, _ in designs]
    x = _speed_axis(speeds, knots)
    y = Axis(f"thrust T [{unit}]", (0.0, top), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(48, 12, 8, 34), style=sheet.style)
    if not designs:
        plot.message(WAITING)
    for index, (look, curves, evaluation) in enumerate(designs):
        speed, main = speeds[index], index == len(designs) - 1
        words = f"required, {look.name}"
        key = f"{words}{_froude_words(evaluation)}" if knots else words
        plot.line(speed, scale * curves.required, look.css, name=words, key=key, curved=True)
        # the published thrust of a run may have fewer conditions than its curves
        for number, (condition, available) in enumerate(zip(evaluation.conditions, curves.available, strict=False), 1):
            rate = f"{condition.rotation_rate_rpm:.1f} rpm"
            force = scale * available
            name = f"available at {rate}, {look.name}"
            plot.line(speed, force, f"{look.role} dot thin", name=name, curved=True)
            title = (
                f"{look.name}, {_condition_words(condition)}: T {written(1e-3 * condition.thrust, 'kN', 0)} at {rate}"
            )
            plot.mark(_place(condition, knots), scale * condition.thrust, "circle", 3.6, look.role, title=title)
            within = np.flatnonzero(np.isfinite(force) & (force < 0.93 * top))
            if main and within.size:
                # below its falling end it crosses nothing of its own
                last = within[-1]
                at = (float(speed[last]), float(force[last]))
                plot.text(*at, f"n_{number} = {rate}", look.role, "end", dy=1.3 * sheet.style.note)
    if len(designs) > _FEW:
        plot.line([], [], "soft dot thin", key="available at each condition's n")
    else:
        for look, _, evaluation in designs:
            rates = ", ".join(f"{condition.rotation_rate_rpm:.1f}" for condition in evaluation.conditions)
            plot.line([], [], f"{look.role} dot thin", key=f"available at {rates} rpm, {look.name}")
    draw_published(plot, published)
    return plot


def _speed_axis(found: Sequence[Array], knots: bool) -> Axis:
    """A speed axis, in knots or Froude numbers, over the points (n,) of every curve."""
    limits: Limits = padded(np.concatenate(found), 0.0) if found else _EMPTY_RANGE
    return Axis("speed V [kn]" if knots else "Froude number Fn [–]", limits)


def _place(condition: ConditionResult, knots: bool) -> float:
    return condition.speed / KNOT if knots else condition.froude_number


def _condition_words(condition: ConditionResult) -> str:
    return f"{condition.speed / KNOT:.4g} kn (Fn {condition.froude_number:.3f})"


def _froude_words(evaluation: Evaluation) -> str:
    """A design's own Froude numbers at the conditions, for a legend."""
    numbers = [f"{condition.froude_number:.3f}" for condition in evaluation.conditions]
    if not numbers:
        return ""
    return f" (Fn {', '.join(numbers) if len(numbers) <= _FEW_CONDITIONS else f'{numbers[0]}–{numbers[-1]}'})"
