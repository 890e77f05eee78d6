"""The engine diagram: brake power over the rate of revolutions, the layout's limits, the designs' points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.case.case import KNOT
from hpsop_core.charts.axis import Axis
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.plot import Plot
from hpsop_core.evaluation.power_curves import PowerCurves
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.machinery.engine import GREATEST_RATE, Engine
from hpsop_core.units import axis_unit, written

_LEAST_RATE = 0.35


def engine_chart(
    engine: Engine | None,
    designs: Sequence[tuple[Look, Evaluation]],
    sheet: Sheet,
    demands: Sequence[tuple[Look, PowerCurves]] = (),
) -> Plot:
    """Brake power over the shaft's rate in rpm, each condition of each design a point.

    Args:
        engine: its layout is drawn; None draws the designs alone.
        designs: what is compared; the last is the main one, whose conditions are named.
        sheet: size and style.
        demands: power over speed of the same designs, where it is known: drawn as the propeller's demand in service
            (calm water's for the main design too) instead of straight lines between the conditions.
    """
    shown = [(look, item) for look, item in designs if item.ok]
    rates = [c.rotation_rate_rpm for _, item in shown for c in item.conditions]
    powers = [c.brake_power or c.delivered_power for _, item in shown for c in item.conditions]
    if engine is not None:
        powers.append(engine.maximum_continuous_rating)
        if engine.rated_rotation_rate is not None:
            rates.append(60.0 * GREATEST_RATE * engine.rated_rotation_rate)
    greatest = max(powers, default=1e6)
    unit, scale = axis_unit("power", greatest)
    right, top = 1.08 * max(rates, default=100.0), 1.12 * scale * greatest
    left = 0.85 * min([_LEAST_RATE * right, *rates])
    x, y = Axis("rate of revolutions n [rpm]", (left, right)), Axis(f"brake power P_B [{unit}]", (0.0, top), 5)
    plot = Plot(sheet.width, sheet.height, x, y, margins=(48, 12, 8, 34), style=sheet.style)
    if not shown:
        plot.message("no operating points for this design")
    if engine is not None:
        _layout(plot, engine, left, right, scale)
    curved = {look.name for look, _ in demands}
    for index, (look, curves) in enumerate(demands):
        rate = curves.rotation_rate_rpm
        plot.line(rate, scale * curves.service, look.css, name=f"{look.name}, service", key=look.name, curved=True)
        if index == len(demands) - 1:
            words = f"{look.name}, calm water"
            plot.line(rate, scale * curves.calm, f"{look.role} dot thin", name=words, key=words, curved=True)
    for index, (look, item) in enumerate(shown):
        n = np.array([c.rotation_rate_rpm for c in item.conditions])
        power = np.array([scale * (c.brake_power or c.delivered_power) for c in item.conditions])
        order = np.argsort(n)
        if look.name not in curved:
            plot.line(n[order], power[order], look.css, name=look.name, key=look.name)
        for condition, at, value in zip(item.conditions, n, power, strict=True):
            speed = f"{condition.speed / KNOT:.4g} kn"
            outside = condition.engine_excess is not None and condition.engine_excess > 0.0
            shape = "cross" if outside else "circle"
            power_words = written(1e-6 * value / scale, "MW", 2)
            title = f"{look.name}, {speed}: {power_words} at {at:.1f} rpm{', outside the layout' if outside else ''}"
            plot.mark(float(at), float(value), shape, 3.8, look.role, title=title)
            if index == len(shown) - 1:
                plot.text(float(at), float(value), speed, "soft", "end", dx=-6, dy=-4)
    return plot


def _layout(plot: Plot, engine: Engine, left: float, right: float, scale: float) -> None:
    """Torque limit, rating, greatest rate of revolutions."""
    rating, rated = scale * engine.maximum_continuous_rating, engine.rated_rotation_rate
    if rated is None:
        plot.line([left, right], [rating, rating], "soft dash", name="rating", key="engine's rating")
        return
    rpm = 60.0 * rated
    words = written(1e-6 * engine.maximum_continuous_rating, "MW", 2)
    rate = np.array([left, rpm, GREATEST_RATE * rpm, GREATEST_RATE * rpm])
    limit = np.array([rating * left / rpm, rating, rating, 0.0])
    plot.line(rate, limit, "soft dash", name="engine's layout", key="engine's layout: torque, rating, 105 % rpm")
    plot.mark(rpm, rating, "square", 3.4, "soft", title=f"rating: {words} at {rpm:.1f} rpm")
