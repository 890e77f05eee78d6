"""The paper's figures with our curves and its printed points in red."""

from __future__ import annotations

from dataclasses import dataclass

from hpsop_core.charts.looks import Look, Published
from hpsop_core.charts.plot import Plot
from hpsop_core.evaluation.curves import resistance_points
from hpsop_core.evaluation.levels import FAST, TRUTH, level_of
from hpsop_core.markup import Markup
from hpsop_core.report.data import CHART_ABOVE
from hpsop_core.report.html_page import chart_html
from hpsop_core.report.paper_figures import (
    ResistanceLine,
    evolution_figure,
    open_water_figure,
    resistance_figure,
    thrust_figure,
)
from hpsop_core.reproduction import paper
from hpsop_core.reproduction.comparison import Reproduction, wave_part


@dataclass(frozen=True, eq=False)
class Figure:
    """A figure of the paper with both.

    Attributes:
        number: the paper's.
        plot: ours with the paper's points.
        caption: what is what.
    """

    number: int
    plot: Plot
    caption: str

    def html(self) -> Markup:
        """As it stands on a page."""
        return chart_html(self.plot, f"figure-{self.number}", self.caption)


def figures(data: Reproduction) -> dict[int, Figure]:
    """Figures 5 to 9 by their numbers.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    return {made.number: made for made in (figure5(data), *figures67(data), figure8(data), figure9(data))}


def figure5(data: Reproduction) -> Figure:
    """Evolution of the fronts, with the designs of Table 3."""
    published = Published(
        "paper, Table 3",
        [design.f1 for design in paper.table3()],
        [design.f2 for design in paper.table3()],
        notes=[design.name for design in paper.table3()],
    )
    return Figure(
        5,
        evolution_figure(data.report, [published]),
        "Our fronts of several generations (blue: level 1, orange: level 2, green: the last) and the designs of the "
        "paper's Table 3. Each level is normalised by the initial design at that level.",
    )


def _michell(data: Reproduction) -> list[ResistanceLine]:
    """The initial design by plain Michell, beside a level 2 that does not have it."""
    if level_of(data.level) is not TRUTH:
        return []
    evaluation = data.run.initial(FAST.number).evaluation
    if level_of(evaluation.level) is not FAST or not evaluation.ok:
        return []
    points = resistance_points(data.case, evaluation, data.reference(FAST.number), CHART_ABOVE)
    return [(Look("initial, plain Michell (level 1)", "soft", "dot"), points, evaluation)]


def figures67(data: Reproduction) -> tuple[Figure, Figure]:
    """Wave and total resistance over Froude number.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    michell = _michell(data)

    def published(which: str) -> list[Published]:
        made = []
        for name, marker in ((paper.INITIAL, "square"), (paper.COMPROMISE, "cross")):
            points = paper.points_of(name)
            force = [wave_part(data, p)[0] if which == "wave" else p.total_resistance for p in points]
            label = f"paper {name}, Table 4" + (" less ITTC-57 friction" if which == "wave" else "")
            made.append(Published(label, [p.froude_number for p in points], [1e-6 * f for f in force], marker))
        return made

    return (
        Figure(
            6,
            resistance_figure(data.report, "wave", published("wave"), michell),
            f"Wave resistance, level {data.level}. The paper prints no wave resistance: red is what its total leaves.",
        ),
        Figure(
            7,
            resistance_figure(data.report, "total", published("total"), michell),
            f"Total resistance, level {data.level}, and the paper's Table 4.",
        ),
    )


def figure8(data: Reproduction) -> Figure:
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
    return Figure(
        8,
        open_water_figure(data.report, published),
        f"Open water of our initial and chosen designs, level {data.level}, full scale; the paper's KT, 10KQ and "
        "efficiency at its operating points.",
    )


def figure9(data: Reproduction) -> Figure:
    """Thrust required and available.

    Raises:
        SolverFailure: a curve cannot be computed.
    """
    density = data.case.constants.density
    published = []
    for name, markers in ((paper.INITIAL, ("square", "diamond")), (paper.COMPROMISE, ("cross", "plus"))):
        points_of = paper.points_of(name)
        froude = [p.froude_number for p in points_of]
        resistance = [1e-6 * p.total_resistance for p in points_of]
        thrust = [1e-6 * p.thrust(density) for p in points_of]
        published.append(Published(f"paper {name}: R_T", froude, resistance, markers[0]))
        published.append(Published(f"paper {name}: T", froude, thrust, markers[1]))
    return Figure(
        9,
        thrust_figure(data.report, published),
        f"Thrust required and available, level {data.level}. The paper's thrust lies below its resistance.",
    )
