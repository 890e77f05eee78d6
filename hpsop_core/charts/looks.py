"""How a design and how published points appear in every chart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hpsop_core.charts.plot import Plot
from hpsop_core.charts.style import SCREEN, Style


@dataclass(frozen=True)
class Look:
    """A design on a chart: its name, the role that gives its colour, and its stroke ("", "dash", "dot", "dashdot")."""

    name: str
    role: str
    stroke: str = ""

    @property
    def css(self) -> str:
        """Classes of its lines."""
        return f"{self.role} {self.stroke}".strip()


@dataclass(frozen=True)
class Sheet:
    """What a chart is drawn on.

    Attributes:
        width, height: px.
        style: colours and letters.
    """

    width: float
    height: float
    style: Style = SCREEN


@dataclass(frozen=True)
class Published:
    """Published points to draw in.

    Attributes:
        name: what they are.
        x, y: (n,) in the chart's units.
        shape: of their marks.
        notes: a word beside each.
        x_error, y_error: half widths (n,), or none.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    shape: str = "cross"
    notes: Sequence[str] = ()
    x_error: Sequence[float] | None = None
    y_error: Sequence[float] | None = None


def draw_published(plot: Plot, points: Sequence[Published]) -> None:
    """Published points into a chart, in one colour that nothing of ours has, outlined so that ours stay in sight."""
    for item in points:
        css = "published" if item.shape in ("cross", "plus") else "published open"
        plot.points(item.x, item.y, item.shape, 3.6, css, item.name, item.name, item.x_error, item.y_error)
        for x, y, note in zip(item.x, item.y, item.notes, strict=False):
            plot.text(x, y, note, "published", dx=5, dy=-4)
