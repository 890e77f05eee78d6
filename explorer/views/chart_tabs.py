"""Which charts there are, and what each draws from the state."""

from __future__ import annotations

from collections.abc import Sequence

from explorer.charts.colour_ramp import finite_limits, ramp
from explorer.charts.designs_table import known_columns
from explorer.charts.drivers import drivers_table
from explorer.charts.parallel import parallel_chart
from explorer.charts.scatter import choices
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.charts_view import ChartTab
from explorer.views.chips import soft
from explorer.views.families import families
from explorer.views.on_display import overlaid
from explorer.views.saving import Figure
from hpsop_core.charts.engine import engine_chart
from hpsop_core.charts.hulls import body_plan_chart, sectional_area_chart
from hpsop_core.charts.lines_plan import lines_csv, lines_plan_chart
from hpsop_core.charts.looks import Look, Sheet
from hpsop_core.charts.powering import power_chart
from hpsop_core.charts.propulsion import open_water_chart, resistance_chart, thrust_chart
from hpsop_core.charts.search import best_chart, convergence_chart
from hpsop_core.evaluation.curves import DesignCurves, HullLines
from hpsop_core.evaluation.power_curves import power_curves
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.ship import engine_of
from hpsop_core.markup import Markup, fill, joined

Drawing = Sequence[Figure | Markup]
# px, of the lines plan's whole sheet
_PLAN_WIDTH = 2000.0


def _sheet(session: Session, share: float, least: float = 215.0, most: float = 330.0) -> Sheet:
    """As wide as the panel; as high as a share of the window within limits."""
    return Sheet(session.chart_width, min(max(share * session.size[1], least), most))


def _open_water(session: Session, designs: Designs) -> Drawing:
    curves = [(look, shown.evaluation) for look, shown in overlaid(session, designs)]
    return [Figure("open_water", open_water_chart(curves, _sheet(session, 0.30)))]


def _with_curves(session: Session, designs: Designs) -> list[tuple[Look, Evaluation, DesignCurves]]:
    found = []
    missing = False
    for look, shown in overlaid(session, designs):
        curves = designs.known_curves(shown.evaluation)
        if curves is not None:
            found.append((look, shown.evaluation, curves))
        else:
            missing = missing or shown.evaluation.ok
    if missing:
        # one waiting task, however many designs are walked through meanwhile
        session.slow.latest("curves", lambda: _compute_curves(session, designs))
    return found


def _compute_curves(session: Session, designs: Designs) -> None:
    """The first curves that are missing of what is on display now, the selected design's before the others'."""
    for _, shown in reversed(overlaid(session, designs)):
        if shown.evaluation.ok and designs.known_curves(shown.evaluation) is None:
            designs.curves(shown.evaluation)
            # drawing them asks for the next ones
            session.curves_ready()
            return


def _resistance(session: Session, designs: Designs) -> Drawing:
    curves = _with_curves(session, designs)
    sheet = _sheet(session, 0.24, 190.0, 260.0)
    selected = session.selected
    level = selected.evaluation.level if selected else 1
    complete = len(curves) == len(overlaid(session, designs))
    waiting = "" if complete else " The other designs' curves are being computed …"
    points = [(look, found.points, evaluation) for look, evaluation, found in curves]
    knots = session.picture.case.conditions.speeds_are_fixed
    speeds = "all at the same speeds" if knots else "each at its own Froude number"
    return [
        Figure("resistance_total", resistance_chart(points, "total", sheet, knots=knots)),
        Figure("resistance_wave", resistance_chart(points, "wave", sheet, knots=knots)),
        soft(f"Level {level}, {speeds}; marks are the conditions.{waiting}"),
    ]


def _thrust(session: Session, designs: Designs) -> Drawing:
    curves = [(look, found.thrust, evaluation) for look, evaluation, found in _with_curves(session, designs)]
    knots = session.picture.case.conditions.speeds_are_fixed
    return [Figure("thrust", thrust_chart(curves, _sheet(session, 0.30), knots=knots))]


def _engine(session: Session, designs: Designs) -> Drawing:
    case = session.picture.case
    engine = engine_of(case.engine)
    shown = [(look, item.evaluation) for look, item in overlaid(session, designs)]
    powers = [
        (look, power_curves(case, evaluation, found.points), evaluation)
        for look, evaluation, found in _with_curves(session, designs)
    ]
    margin = case.constants.sea_margin
    words = "" if engine is not None else " The case states no engine: set its MCR under Loading and engine."
    return [
        Figure("power", power_chart(engine, powers, margin, _sheet(session, 0.30))),
        Figure("engine", engine_chart(engine, shown, _sheet(session, 0.30), [(a, b) for a, b, _ in powers])),
        soft(f"Brake power: delivered power over the shaft's efficiency, {_margin_words(margin)}.{words}"),
    ]


def _margin_words(margin: float) -> str:
    return f"with the case's sea margin of {100.0 * margin:.3g} %" if margin else "in calm water (no sea margin stated)"


def _with_lines(session: Session, designs: Designs) -> list[tuple[Look, HullLines]]:
    return [
        (look, designs.lines(shown.evaluation.variables))
        for look, shown in overlaid(session, designs)
        if shown.evaluation.ok
    ]


def _lines(session: Session, designs: Designs) -> Drawing:
    lines = _with_lines(session, designs)
    return [
        Figure("body_plan", body_plan_chart(lines, _sheet(session, 0.31, 220.0, 330.0))),
        Figure("sectional_area", sectional_area_chart(lines, _sheet(session, 0.24, 180.0, 240.0))),
    ]


def _lines_plan(session: Session, designs: Designs) -> Drawing:
    shown = session.selected
    if shown is None or not shown.evaluation.ok:
        return [soft("A design that failed has no lines.")]
    variables, hull = shown.evaluation.variables, shown.evaluation.hull
    lines = designs.known_plan(variables)
    if lines is None:
        session.slow.latest("plan", lambda: _cut_plan(session, designs))
        return [soft(f"Cutting the lines of {shown.label} …")]
    # at the width of the panel a ship's depth would be a finger's: the drawing scrolls along the ship
    plot = lines_plan_chart(lines, hull.length, hull.breadth, hull.draft, max(_PLAN_WIDTH, session.chart_width))
    words = (
        f"{shown.label}: stations of ten from AP, waterlines by their height and buttocks by their distance from the "
        "centreplane in m. Scroll along the ship; SVG saves the whole sheet."
    )
    return [Figure("lines_plan", plot, lambda: lines_csv(lines, hull.length), wide=True), soft(words)]


def _cut_plan(session: Session, designs: Designs) -> None:
    shown = session.selected
    if shown is not None and shown.evaluation.ok:
        designs.plan(shown.evaluation.variables)
        session.curves_ready()


def _parallel(session: Session, _designs: Designs) -> Drawing:
    shown = session.selected
    selected = shown.design_id if shown else None
    sheet = _sheet(session, 0.36, 240.0, 360.0)
    picture, options = session.picture, session.charts
    colour = known_columns(picture).get(options.axis_colour)
    values = picture.column(colour.key) if colour is not None else None
    chart = parallel_chart(
        picture, session.filters, selected, session.scrubbed, sheet.width, sheet.height, options.axes, colour
    )
    if colour is None or values is None:
        return [chart]
    return [chart, ramp(colour, finite_limits(values[picture.feasible & ~picture.failed]))]


def _parallel_controls(session: Session) -> Markup:
    return choices("axis_colour", session.picture, session.charts.axis_colour, "colour of the lines", True)


def _drivers(session: Session, _designs: Designs) -> Drawing:
    return [drivers_table(session.picture)]


def _convergence(session: Session, _designs: Designs) -> Drawing:
    picture = session.picture
    numbers = [item.number for item in picture.generations]
    levels = [item.level for item in picture.generations]
    values = [item.hypervolume for item in picture.generations]
    best = []
    for item in picture.generations:
        rows = picture.rows(item.front)
        best.append(tuple(picture.objectives[rows].min(axis=0)) if len(rows) else (float("nan"), float("nan")))
    sheet, total = _sheet(session, 0.26, 190.0, 270.0), picture.total_generations
    return [
        Figure("convergence", convergence_chart(numbers, levels, values, total, sheet)),
        Figure("best", best_chart(numbers, levels, best, total, sheet)),
        soft("Hypervolume of the feasible front against (1.2, 1.2); each level has its own series."),
    ]


def _failures(session: Session, designs: Designs) -> Drawing:
    picture = session.picture
    ids = [int(value) for value in picture.ids[picture.failed]]
    if not ids:
        done = len(picture.ids)
        return [soft(f"No evaluation failed among {done}." if done else "Nothing evaluated yet.")]
    rows = [Markup("<tr><th>design</th><th>level</th><th>gen.</th><th>stage</th><th>reason</th></tr>")]
    designs.prepare(ids[-100:])
    for design_id in ids[-100:][::-1]:
        shown = designs.shown(design_id)
        if shown is None:
            continue
        evaluation = shown.evaluation
        row = (
            '<tr title="{}"><td>{}</td><td>{}</td><td>{}</td><td>{}</td>'
            '<td class="name" style="text-align:left">{}</td></tr>'
        )
        variables = ", ".join(f"{key} {value:g}" for key, value in evaluation.variables.as_dict().items())
        cells = (design_id, evaluation.level, shown.generation, evaluation.stage, evaluation.reason)
        rows.append(fill(row, variables, *cells))
    more = [soft(f"the latest 100 of {len(ids)}")] if len(ids) > 100 else []
    return [fill('<table class="numbers">{}</table>', joined(rows)), *more]


_DESIGN = frozenset({"selection", "pins"})
_PARALLEL = frozenset({"run", "filter", "selection", "scrub", "charts"})
_TABS = (
    ChartTab("open_water", "Open water", "design", _DESIGN, _open_water),
    ChartTab("resistance", "Resistance", "design", _DESIGN | {"curves"}, _resistance),
    ChartTab("thrust", "Thrust", "design", _DESIGN | {"curves"}, _thrust),
    ChartTab("engine", "Power", "design", _DESIGN | {"curves"}, _engine),
    ChartTab("lines", "Lines", "design", _DESIGN, _lines),
    ChartTab("lines_plan", "Lines plan", "design", frozenset({"selection", "curves"}), _lines_plan),
    ChartTab("parallel", "Parallel", "run", _PARALLEL, _parallel, _parallel_controls, below=True),
    ChartTab("families", "Families", "run", frozenset({"run", "scrub", "selection", "curves"}), families),
    ChartTab("drivers", "Drivers", "run", frozenset({"run"}), _drivers),
    ChartTab("convergence", "Convergence", "run", frozenset({"run"}), _convergence),
    ChartTab("failures", "Failures", "run", frozenset({"run"}), _failures),
)


def chart_tabs(*more: ChartTab) -> dict[str, ChartTab]:
    """All charts by name, in order; ``more``, which answer gestures of their own, before the others of their row."""
    return {tab.name: tab for tab in (*more, *_TABS)}
