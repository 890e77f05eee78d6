"""Power against speed: calm water and service, the engine's rating, and how the ship's time is shared."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.case.case import KNOT
from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.charts.axis import Axis, padded
from hpsop_core.charts.frame import Key
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.marks import smooth
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.propulsion import WAITING
from hpsop_core.evaluation.power_curves import PowerCurves
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.machinery.engine import Engine
from hpsop_core.units import axis_unit, written

_PROFILE = 0.14
"""Height of the greatest share of time, in parts of the chart's."""


def power_chart(
    engine: Engine | None,
    designs: Sequence[tuple[Look, PowerCurves, Evaluation]],
    sea_margin: float,
    sheet: Sheet,
) -> Plot:
    """Brake power against speed in knots, with and without the sea margin, each condition a mark.

    Args:
        engine: its rating is drawn, where there is one.
        designs: what is compared; the last is the main one, whose operating profile and gain on the first are told.
        sea_margin: part of the power in calm water that service takes more.
        sheet: size and style.
    """
    powers = [power for _, curves, _ in designs for power in (*curves.service, *curves.calm)]
    powers += [power for _, _, item in designs for _, power in _known(item)]
    if engine is not None:
        powers.append(engine.maximum_continuous_rating)
    greatest = max((value for value in powers if np.isfinite(value)), default=1e6)
    unit, scale = axis_unit("power", greatest)
    top = 1.06 * scale * greatest
    x = Axis("speed V [kn]", padded([value / KNOT for _, curves, _ in designs for value in curves.speed], 0.01))
    y = Axis(f"brake power P_B [{unit}]", (0.0, top), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(48, 12, 8, 34), style=sheet.style)
    if not designs:
        plot.message(WAITING)
        return plot
    _profile(plot, designs[-1][0], designs[-1][2], top)
    for index, (look, curves, evaluation) in enumerate(designs):
        main = index == len(designs) - 1
        knots = curves.speed / KNOT
        service = f"{look.name}, with {100.0 * sea_margin:.3g} % sea margin" if sea_margin else look.name
        plot.line(knots, scale * curves.service, look.css, name=service, key=service, curved=True)
        if sea_margin:
            words = f"{look.name}, calm water"
            plot.line(knots, scale * curves.calm, f"{look.role} dot thin", name=words, key=words, curved=True)
            if main:
                # as smooth as the lines that bound it
                fine, low = smooth(knots, scale * curves.calm)
                plot.band(fine, low, (1.0 + sea_margin) * low, look.role, key="its sea margin")
        for number, (condition, power) in enumerate(_known(evaluation)):
            at = condition.speed / KNOT
            title = (
                f"{look.name}, {at:.4g} kn: {written(1e-6 * power, 'MW', 2)} at {condition.rotation_rate_rpm:.1f} rpm"
            )
            plot.mark(
                at, scale * power, "circle", 3.6, look.role, title=title, name=f"condition {number + 1}, {look.name}"
            )
            if main and index:
                _gain(plot, look, condition.speed, power, designs[0][2], number, scale)
    if engine is not None:
        rating = scale * engine.maximum_continuous_rating
        plot.line(x.limits, [rating, rating], "soft dash", name="rating", key="engine's rating (MCR)")
    return plot


def _known(evaluation: Evaluation) -> list[tuple[ConditionResult, float]]:
    """Conditions with their brake power in W, where it is known."""
    return [(item, item.brake_power) for item in evaluation.conditions if item.brake_power is not None]


def _profile(plot: Plot, look: Look, evaluation: Evaluation, top: float) -> None:
    """The share of time at each condition as a bar on the speed axis."""
    total = sum(condition.weight for condition in evaluation.conditions) or 1.0
    greatest = max((condition.weight for condition in evaluation.conditions), default=1.0) / total or 1.0
    low, high = plot.x.limits
    half = 0.012 * (high - low)
    for condition in evaluation.conditions:
        at, share = condition.speed / KNOT, condition.weight / total
        height = _PROFILE * top * share / greatest
        plot.rectangle(at - half, at + half, 0.0, height, f"band {look.role}", "fill-opacity:.35")
        plot.text(at, height, f"{100.0 * share:.3g} %", "soft", "middle", dy=-3)
    plot.keys.append(Key("band", look.role, "share of time", "fill-opacity:.35"))


def _gain(plot: Plot, look: Look, speed: float, power: float, first: Evaluation, number: int, scale: float) -> None:
    """What the main design saves against the first at the same speed."""
    before = _known(first)
    if number < len(before) and abs(before[number][0].speed - speed) < 1e-6 * speed:
        change = power / before[number][1] - 1.0
        words = f"{100.0 * change:+.1f} %".replace("-", "−")
        plot.text(speed / KNOT, scale * power, words, look.role, dx=7, dy=12)
