"""Which charts there are, and what each draws from the state."""

from __future__ import annotations

from explorer.charts.curves import (
    DesignCurves,
    Series,
    best_chart,
    body_plan,
    convergence_chart,
    open_water_chart,
    resistance_chart,
    sectional_area_chart,
    thrust_chart,
)
from explorer.charts.drivers import drivers_table
from explorer.charts.parallel import parallel_chart
from explorer.services.designs import Designs
from explorer.state.session import Session
from explorer.views.charts_view import ChartTab
from explorer.views.on_display import overlaid
from hpsop_core.evaluation.curves import HullLines
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import escape


def _height(session: Session, share: float, least: float = 215.0, most: float = 330.0) -> float:
    return min(max(share * session.size[1], least), most)


def _open_water(session: Session, designs: Designs) -> str:
    curves = [(series, shown.evaluation) for series, shown in overlaid(session, designs)]
    return open_water_chart(curves, session.chart_width, _height(session, 0.30))


def _with_curves(session: Session, designs: Designs) -> list[tuple[Series, Evaluation, DesignCurves]]:
    found = []
    missing = False
    for series, shown in overlaid(session, designs):
        curves = designs.known_curves(shown.evaluation)
        if curves is not None:
            found.append((series, shown.evaluation, curves))
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


def _resistance(session: Session, designs: Designs) -> str:
    curves = _with_curves(session, designs)
    height = _height(session, 0.24, 190.0, 260.0)
    level = session.selected.evaluation.level if session.selected else 1
    complete = len(curves) == len(overlaid(session, designs))
    waiting = "" if complete else " The other designs' curves are being computed …"
    note = f'<p class="soft">Level {level}, each at its own Froude number; marks are the conditions.{waiting}</p>'
    return (
        resistance_chart(curves, "total", session.chart_width, height)
        + resistance_chart(curves, "wave", session.chart_width, height)
        + note
    )


def _thrust(session: Session, designs: Designs) -> str:
    return thrust_chart(_with_curves(session, designs), session.chart_width, _height(session, 0.30))


def _with_lines(session: Session, designs: Designs) -> list[tuple[Series, HullLines]]:
    return [
        (series, designs.lines(shown.evaluation.variables))
        for series, shown in overlaid(session, designs)
        if shown.evaluation.hull is not None
    ]


def _lines(session: Session, designs: Designs) -> str:
    lines = _with_lines(session, designs)
    return body_plan(lines, session.chart_width, _height(session, 0.31, 220.0, 330.0)) + sectional_area_chart(
        lines, session.chart_width, _height(session, 0.24, 180.0, 240.0)
    )


def _parallel(session: Session, _designs: Designs) -> str:
    return parallel_chart(
        session.picture,
        session.filters,
        session.selected.design_id if session.selected else None,
        session.scrubbed,
        session.chart_width,
        _height(session, 0.36, 240.0, 360.0),
    )


def _drivers(session: Session, _designs: Designs) -> str:
    return drivers_table(session.picture)


def _convergence(session: Session, _designs: Designs) -> str:
    picture = session.picture
    numbers = [item.number for item in picture.generations]
    levels = [item.level for item in picture.generations]
    values = [item.hypervolume for item in picture.generations]
    best = []
    for item in picture.generations:
        rows = picture.rows(item.front)
        best.append(tuple(picture.objectives[rows].min(axis=0)) if len(rows) else (float("nan"), float("nan")))
    height = _height(session, 0.26, 190.0, 270.0)
    note = '<p class="soft">Hypervolume of the feasible front against (1.2, 1.2); each level has its own series.</p>'
    return (
        convergence_chart(numbers, levels, values, picture.total_generations, session.chart_width, height)
        + best_chart(numbers, levels, best, picture.total_generations, session.chart_width, height)
        + note
    )


def _failures(session: Session, designs: Designs) -> str:
    picture = session.picture
    ids = [int(value) for value in picture.ids[picture.failed]]
    if not ids:
        done = len(picture.ids)
        return f'<p class="soft">{"No evaluation failed" if done else "Nothing evaluated yet"}' + (
            f" among {done}.</p>" if done else ".</p>"
        )
    rows = ["<tr><th>design</th><th>level</th><th>gen.</th><th>stage</th><th>reason</th></tr>"]
    for design_id in ids[-100:][::-1]:
        shown = designs.shown(design_id)
        if shown is None:
            continue
        evaluation = shown.evaluation
        variables = ", ".join(f"{key} {value:g}" for key, value in evaluation.variables.as_dict().items())
        rows.append(
            f'<tr title="{escape(variables)}"><td>{design_id}</td><td>{evaluation.level}</td>'
            f"<td>{shown.generation}</td><td>{escape(evaluation.stage)}</td>"
            f'<td class="name" style="text-align:left">{escape(evaluation.reason)}</td></tr>'
        )
    more = f'<p class="soft">the latest 100 of {len(ids)}</p>' if len(ids) > 100 else ""
    return f'<table class="numbers">{"".join(rows)}</table>{more}'


_DESIGN = frozenset({"selection", "pins"})
_TABS = (
    ChartTab("open_water", "Open water", "design", _DESIGN, _open_water),
    ChartTab("resistance", "Resistance", "design", _DESIGN | {"curves"}, _resistance),
    ChartTab("thrust", "Thrust", "design", _DESIGN | {"curves"}, _thrust),
    ChartTab("lines", "Lines", "design", _DESIGN, _lines),
    ChartTab("parallel", "Parallel coordinates", "run", frozenset({"run", "filter", "selection", "scrub"}), _parallel),
    ChartTab("drivers", "Drivers", "run", frozenset({"run"}), _drivers),
    ChartTab("convergence", "Convergence", "run", frozenset({"run"}), _convergence),
    ChartTab("failures", "Failures", "run", frozenset({"run"}), _failures),
)


def chart_tabs() -> dict[str, ChartTab]:
    """All charts by name, in order."""
    return {tab.name: tab for tab in _TABS}
