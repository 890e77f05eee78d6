"""What was understood of a hull and a propeller file, as tables and lines for the page."""

from __future__ import annotations

from collections.abc import Iterable

from explorer.views.chips import NOTHING, soft
from hpsop_core.geometry.hull.input import HullFile, UnderstoodHull
from hpsop_core.geometry.propeller.input import UnderstoodPropeller
from hpsop_core.markup import Markup, fill, joined


def hull_words(read: HullFile) -> Markup:
    """Figures, what was assumed, warnings, and the deviations patch by patch."""
    told = read.understood
    side = "forward" if told.buoyancy_centre_percent >= 0.0 else "aft"
    figures = (
        ("Lpp, B, T", f"{told.length:.6g}, {told.breadth:.5g}, {told.draft:.5g} m"),
        ("L/B, B/T", f"{told.length / told.breadth:.3f}, {told.breadth / told.draft:.3f}"),
        ("waterline", f"{told.waterline_length:.6g} m"),
        ("volume ∇, wetted surface S", f"{told.displaced_volume:,.6g} m³, {told.wetted_surface:,.6g} m²"),
        ("CB, CM", f"{told.block_coefficient:.4f}, {told.midship_coefficient:.4f}"),
        ("CP, CW", f"{told.prismatic_coefficient:.4f}, {told.waterplane_coefficient:.4f}"),
        ("LCB", f"{abs(told.buoyancy_centre_percent):.2f} % of Lpp {side} of midship"),
        ("shaft, hub", f"{told.shaft_height:.4g} m above the baseline, from x = {told.boss_end_x:.4g} m"),
    )
    return fill(
        '<h4>Understood: {}</h4><p>{}, lengths in {}; {}.</p>{}{}{}<p class="{}">{}</p>{}',
        told.name,
        told.layout,
        told.unit,
        told.axes,
        _warnings(told.warnings),
        _facts(figures),
        _assumed(told.assumed),
        "bad" if told.looks == "-x" else "soft",
        _bow(told),
        _deviations(told),
    )


def propeller_words(told: UnderstoodPropeller) -> Markup:
    """Figures, columns used, what was assumed, and warnings."""
    figures = (
        ("blades Z", told.blade_count),
        ("expanded area ratio", f"{told.expanded_area_ratio:.4f}"),
        ("P/D, c/D at 0.7 R", f"{told.pitch_ratio_07R:.4f}, {told.chord_ratio_07R:.4f}"),
        ("t/c, f/c at 0.7 R", f"{told.thickness_ratio_07R:.4f}, {told.camber_ratio_07R:.4f}"),
        ("hub ratio", f"{told.hub_ratio:.3f}"),
        ("skew, rake/D at the tip", f"{told.tip_skew_degrees:.2f}°, {told.tip_rake_ratio:.4f}"),
    )
    return fill(
        "<h4>Understood: {}</h4><p>Radial table of {} radii, columns {}.</p>{}{}{}",
        told.table.name,
        len(told.table.radius_ratio),
        ", ".join(told.columns),
        _warnings(told.warnings),
        _facts(figures),
        _assumed(told.assumed),
    )


def _facts(figures: Iterable[tuple[str, object]]) -> Markup:
    rows = (fill('<span class="soft">{}</span><span>{}</span>', name, value) for name, value in figures)
    return fill('<div class="facts">{}</div>', joined(rows))


def _warnings(lines: Iterable[str]) -> Markup:
    return joined(fill('<p class="bad">{}</p>', line) for line in lines)


def _assumed(lines: tuple[str, ...]) -> Markup:
    return (
        joined([soft("Assumed or read from the file:"), *(soft(f"· {line}") for line in lines)]) if lines else NOTHING
    )


def _bow(told: UnderstoodHull) -> str:
    if told.looks is None:
        return "The form itself does not tell bow from stern."
    if told.looks == "+x":
        return "The form, too, has its bow forward."
    return "The form looks as if its bow were aft: say where the bow is."


def _deviations(told: UnderstoodHull) -> Markup:
    if told.fit is None:
        return NOTHING
    row = "<tr><td>{}</td><td>{}</td><td>{:.2g}</td><td>{:.2g}</td><td>{:.5g}</td><td>{:.4g}</td></tr>"
    rows = (
        fill(row, patch.patch, patch.points, 1e3 * patch.rms_m, 1e3 * patch.max_m, patch.max_at_x_m, patch.max_at_z_m)
        for patch in told.fit.patches
    )
    change = 100.0 * (told.fit.fitted_volume / told.fit.table_volume - 1.0)
    return fill(
        '<h4>The surface beside the points</h4><table class="numbers"><tr><th>patch</th><th>points</th>'
        "<th>rms [mm]</th><th>largest [mm]</th><th>at x [m]</th><th>z [m]</th></tr>{}</table>{}",
        joined(rows),
        soft(f"Displaced volume {change:+.2f} % against the trapezoidal rule on the points."),
    )
