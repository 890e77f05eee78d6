"""The paper's Figures 5 to 9 for any run: fronts by generation, resistance, open water, thrust.

Each takes published points to draw in, and designs beyond those of the run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.charts.looks import Look, Published
from hpsop_core.charts.plot import Plot
from hpsop_core.charts.propulsion import open_water_chart, resistance_chart, thrust_chart
from hpsop_core.charts.search import Front, evolution_chart
from hpsop_core.evaluation.curves import thrust_curves
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.levels import LEVEL_NUMBERS
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.quantities import objective_title
from hpsop_core.report.data import ReportData
from hpsop_core.report.looks import SHEET

_GENERATIONS_SHOWN = 4

ResistanceLine = tuple[Look, tuple[ResistancePoint, ...], Evaluation]


def evolution_figure(data: ReportData, published: Sequence[Published] = ()) -> Plot:
    """Figure 5: the fronts of several generations of each level, the last one as "front"."""
    fronts: list[Front] = []
    generations = [item for item in data.run.known_fronts() if item.ids]
    for level in LEVEL_NUMBERS:
        own = [item for item in generations if item.level == level]
        if not own:
            continue
        places = sorted({round((len(own) - 1) * part / (_GENERATIONS_SHOWN - 1)) for part in range(_GENERATIONS_SHOWN)})
        for place in places:
            item = own[place]
            points = [
                (float(record.evaluation.objectives["f1"] or 0.0), float(record.evaluation.objectives["f2"] or 0.0))
                for record in data.run.designs(item.ids)
            ]
            last = item is generations[-1]
            # earlier generations are paler
            opacity = 1.0 if last or place == places[-1] else 0.5 + 0.4 * place / max(1, len(own) - 1)
            css, style = "front" if last else f"level{level}", f"opacity:{opacity:.2f}"
            key = f"generation {item.number}, level {level}"
            fronts.append(Front(np.array(points), css, 2.2, style, key=key))
    names = data.case.objectives
    titles = (objective_title(names.first, "f_1"), objective_title(names.second, "f_2"))
    return evolution_chart(fronts, titles, SHEET, published)


def resistance_figure(
    data: ReportData, which: str, published: Sequence[Published] = (), more: Sequence[ResistanceLine] = ()
) -> Plot:
    """Figures 6 ("wave") and 7 ("total"): resistance over speed.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    knots = data.case.conditions.speeds_are_fixed
    return resistance_chart([*data.resistance, *more], which, SHEET, published, knots=knots)


def open_water_figure(data: ReportData, published: Sequence[Published] = ()) -> Plot:
    """Figure 8: open water at full scale."""
    designs = [(look, evaluation) for look, evaluation in data.spread_drawn() if evaluation.ok]
    return open_water_chart(designs, SHEET, published, required=False)


def thrust_figure(data: ReportData, published: Sequence[Published] = ()) -> Plot:
    """Figure 9: thrust that the hull requires and the propeller gives, of the initial and the compromise design.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    own = {id(evaluation): look for look, evaluation in data.drawn()}
    curves = [
        (own[id(evaluation)], thrust_curves(data.case, evaluation, points), evaluation)
        for _, points, evaluation in data.resistance
        if id(evaluation) in own
    ]
    return thrust_chart(curves, SHEET, published, knots=data.case.conditions.speeds_are_fixed)
