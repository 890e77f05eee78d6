"""The grid on the undisturbed water surface: rows that follow the waterline, columns square to the ship.

Solver axes: lengths in units of Lpp, x aft from FP, y to port, z up from the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import SolverFailure
from hpsop_core.hydro.rankine.settings import RankineSettings
from hpsop_core.typing_aliases import Array


@dataclass(frozen=True, eq=False)
class SurfaceGrid:
    """Cells of the free surface, nx columns (upstream first) by ny rows (at the hull first).

    Attributes:
        nodes: (nx + 1, ny + 1, 2) corners.
        sources: (nx ny, 3) raised point sources; row index fastest.
        area: (nx ny,) cell areas, the sources' weights.
        points: (nx ny, 3) collocation points on z = 0.
        row_middle, row_width: (ny,) of the last column, for quadrature across the wake.
    """

    nodes: Array
    sources: Array
    area: Array
    points: Array
    row_middle: Array
    row_width: Array

    @property
    def shape(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.nodes.shape[0] - 1, self.nodes.shape[1] - 1


def geometric(first: float, length: float, count: int) -> Array:
    """count + 1 values from 0 to ``length`` with a constant ratio of steps, the first step being ``first``."""
    target = length / first

    def total(ratio: float) -> float:
        return float(np.sum(ratio ** np.arange(count)))

    low, high = 0.2, 5.0
    # Sixty halvings reach the last bit: the same steps for the same input, without a tolerance.
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if total(middle) < target else (low, middle)
    values = np.concatenate([[0.0], np.cumsum((0.5 * (low + high)) ** np.arange(count))])
    scaled: Array = values * (length / values[-1])
    return scaled


def surface_grid(waterline: Array, settings: RankineSettings) -> SurfaceGrid:
    """The grid around a waterline.

    Args:
        waterline: (n, 2) x and half-breadth from bow to stern, ascending in x, in solver axes.
        settings: counts and domain.

    Raises:
        SolverFailure: the waterline reaches the domain's borders or is not ascending.
    """
    bow, stern = float(waterline[0, 0]), float(waterline[-1, 0])
    if not np.all(np.diff(waterline[:, 0]) > 0.0):
        raise SolverFailure("rankine", "the waterline folds: its stations do not follow each other from bow to stern")
    behind = 1.0 + settings.downstream - stern
    ahead = settings.upstream + bow
    if min(behind, ahead) < 0.1 or stern - bow < 0.3 or float(np.max(waterline[:, 1])) > 0.5 * settings.half_width:
        raise SolverFailure(
            "rankine",
            f"waterline from x/L = {1 - stern:.3f} to {1 - bow:.3f} and {2 * np.max(waterline[:, 1]):.3f} L wide "
            "does not fit the domain of the water surface",
        )
    along = np.linspace(bow, stern, settings.columns_along_hull + 1)
    step = (stern - bow) / settings.columns_along_hull
    upstream = bow - geometric(step, ahead, settings.columns_upstream)[::-1]
    downstream = stern + geometric(step, behind, settings.columns_downstream)
    x = np.concatenate([upstream[:-1], along, downstream[1:]])
    offsets = geometric(settings.first_row * step, settings.half_width, settings.rows)
    breadth = np.interp(x, waterline[:, 0], waterline[:, 1], left=0.0, right=0.0)
    # Offsets shrink in proportion, so that the outermost row is straight.
    y = breadth[:, None] + offsets[None, :] * (1.0 - breadth[:, None] / settings.half_width)
    nodes = np.stack(np.broadcast_arrays(x[:, None], y), axis=2)

    middle = 0.25 * (nodes[1:, 1:] + nodes[1:, :-1] + nodes[:-1, 1:] + nodes[:-1, :-1])
    length = np.diff(x)[:, None]
    width = np.diff(y, axis=1)
    width = 0.5 * (width[1:] + width[:-1])
    area = length * width
    row = 0.5 * (y[:, 1:] + y[:, :-1])
    rise = np.diff(row, axis=0)
    shift = settings.collocation_shift
    points = np.stack(
        [middle[:, :, 0] - shift * length, middle[:, :, 1] - shift * rise, np.zeros_like(area)], axis=2
    ).reshape(-1, 3)
    sources = np.stack([middle[:, :, 0], middle[:, :, 1], settings.source_height * np.sqrt(area)], axis=2).reshape(
        -1, 3
    )
    return SurfaceGrid(
        nodes=nodes,
        sources=sources,
        area=area.reshape(-1),
        points=points,
        row_middle=row[-1],
        row_width=np.diff(y[-1]),
    )
