"""The paper's figures with our curves and its printed points in red."""

from __future__ import annotations

import numpy as np

from hpsop_core.charts.looks import Look, Published
from hpsop_core.charts.propulsion import open_water_chart, resistance_chart, thrust_chart
from hpsop_core.charts.search import Front, evolution_chart
from hpsop_core.evaluation.curves import resistance_points, thrust_curves
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.levels import FAST, LEVEL_NUMBERS, TRUTH, level_of
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.markup import Markup
from hpsop_core.quantities import objective_title
from hpsop_core.report.html_page import chart_html, pair
from hpsop_core.report.looks import COMPROMISE_LOOK, INITIAL_LOOK, SHEET
from hpsop_core.reproduction import paper
from hpsop_core.reproduction.comparison import Reproduction, wave_part

_ABOVE = 0.03
"""Resistance is drawn this far above the greatest Froude number."""

_GENERATIONS_SHOWN = 4


def _looks(data: Reproduction) -> list[tuple[Look, Evaluation]]:
    found = []
    for number, (name, evaluation) in enumerate(data.designs()):
        if name == "initial":
            found.append((INITIAL_LOOK, evaluation))
            continue
        mark = data.compromise is not None and evaluation is data.compromise.evaluation
        found.append((Look(f"{name}, compromise" if mark else name, f"chosen{number}"), evaluation))
    return [(look, evaluation) for look, evaluation in found if evaluation.ok]


def figure5(data: Reproduction) -> Markup:
    """Evolution of the fronts, with the designs of Table 3."""
    fronts: list[Front] = []
    generations = [item for item in data.run.generations() if item.front]
    for level in LEVEL_NUMBERS:
        own = [item for item in generations if item.level == level]
        if not own:
            continue
        places = sorted({round((len(own) - 1) * part / (_GENERATIONS_SHOWN - 1)) for part in range(_GENERATIONS_SHOWN)})
        for place in places:
            item = own[place]
            points = [
                (float(record.evaluation.objectives["f1"] or 0.0), float(record.evaluation.objectives["f2"] or 0.0))
                for record in data.run.designs(item.front)
            ]
            last = item is generations[-1]
            # earlier generations are paler
            opacity = 1.0 if last or place == places[-1] else 0.5 + 0.4 * place / max(1, len(own) - 1)
            css, style = "front" if last else f"level{level}", f"opacity:{opacity:.2f}"
            key = f"generation {item.number}, level {level}"
            fronts.append(Front(np.array(points), css, 2.2, style, key=key))
    published = Published(
        "paper, Table 3",
        [design.f1 for design in paper.table3()],
        [design.f2 for design in paper.table3()],
        notes=[design.name for design in paper.table3()],
    )
    titles = (objective_title("resistance", "f_1"), objective_title("efficiency", "f_2"))
    return chart_html(
        evolution_chart(fronts, titles, SHEET, [published]),
        "figure-5",
        "Our fronts of several generations (blue: level 1, orange: level 2, green: the last) and the designs of the "
        "paper's Table 3. Each level is normalised by the initial design at that level.",
    )


def _resistance(data: Reproduction) -> list[tuple[Look, tuple[ResistancePoint, ...], Evaluation]]:
    reference = data.references[data.level]
    lines = [
        (look, resistance_points(data.case, evaluation, reference, _ABOVE), evaluation)
        for look, evaluation in _looks(data)
    ]
    if level_of(data.level) is TRUTH:
        evaluation = data.run.initial(FAST.number).evaluation
        if level_of(evaluation.level) is FAST and evaluation.ok:
            points = resistance_points(data.case, evaluation, data.references[FAST.number], _ABOVE)
            lines.append((Look("initial, plain Michell (level 1)", "soft", "dot"), points, evaluation))
    return lines


def figures67(data: Reproduction) -> Markup:
    """Wave and total resistance over Froude number.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    lines = _resistance(data)

    def published(which: str) -> list[Published]:
        made = []
        for name, marker in ((paper.INITIAL, "square"), (paper.COMPROMISE, "cross")):
            points = paper.points_of(name)
            force = [wave_part(data, p)[0] if which == "wave" else p.total_resistance for p in points]
            label = f"paper {name}, Table 4" + (" less ITTC-57 friction" if which == "wave" else "")
            made.append(Published(label, [p.froude_number for p in points], [1e-6 * f for f in force], marker))
        return made

    return pair(
        chart_html(
            resistance_chart(lines, "wave", SHEET, published("wave")),
            "figure-6",
            f"Wave resistance, level {data.level}. The paper prints no wave resistance: red is what its total leaves.",
        ),
        chart_html(
            resistance_chart(lines, "total", SHEET, published("total")),
            "figure-7",
            f"Total resistance, level {data.level}, and the paper's Table 4.",
        ),
    )


def figure8(data: Reproduction) -> Markup:
    """Open water."""
    published = [
        Published(
            f"paper {name}, Table 4",
            [p.advance_coefficient for p in paper.points_of(name)] * 3,
            [
                value
                for key in ("thrust_coefficient", "ten_torque_coefficient", "open_water_efficiency")
                for value in (getattr(p, key) for p in paper.points_of(name))
            ],
            marker,
        )
        for name, marker in ((paper.INITIAL, "square"), (paper.COMPROMISE, "cross"))
    ]
    designs = [(look, evaluation) for look, evaluation in _looks(data) if evaluation.ok]
    return chart_html(
        open_water_chart(designs, SHEET, published, required=False),
        "figure-8",
        f"Open water of our initial and chosen designs, level {data.level}, full scale; the paper's KT, 10KQ and "
        "efficiency at its operating points.",
    )


def figure9(data: Reproduction) -> Markup:
    """Thrust required and available.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    drawn = [(INITIAL_LOOK, data.initial.evaluation)]
    if data.compromise is not None:
        drawn.append((COMPROMISE_LOOK, data.compromise.evaluation))
    reference = data.references[data.level]
    curves = []
    for look, evaluation in drawn:
        points = resistance_points(data.case, evaluation, reference, _ABOVE)
        curves.append((look, thrust_curves(data.case, evaluation, points), evaluation))
    density = data.case.constants.density
    published = []
    for name, markers in ((paper.INITIAL, ("square", "diamond")), (paper.COMPROMISE, ("cross", "plus"))):
        points_of = paper.points_of(name)
        froude = [p.froude_number for p in points_of]
        resistance = [1e-6 * p.total_resistance for p in points_of]
        thrust = [1e-6 * p.thrust(density) for p in points_of]
        published.append(Published(f"paper {name}: R_T", froude, resistance, markers[0]))
        published.append(Published(f"paper {name}: T", froude, thrust, markers[1]))
    return chart_html(
        thrust_chart(curves, SHEET, published),
        "figure-9",
        f"Thrust required and available, level {data.level}. The paper's thrust lies below its resistance.",
    )
