"""What a Rankine solution is made of besides the hull: mesh, domain, plane. Frozen over an optimisation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from hpsop_core.errors import InputError


@dataclass(frozen=True)
class RankineSettings:
    """Mesh, domain and momentum planes of the Rankine solver; lengths in units of the length between perpendiculars.

    Attributes:
        hull_lengthwise: panels along a patch that spans most of the hull; short patches get their share.
        hull_girthwise: panels from keel to waterline.
        columns_along_hull: surface cells between the ends of the waterline.
        columns_upstream, columns_downstream: surface cells ahead of and behind the waterline, geometrically stretched.
        rows: surface cells from the waterline to the side border.
        upstream: distance from FP to the upstream border.
        downstream: distance from AP to the downstream border.
        half_width: distance from the centreplane to the side border.
        first_row: width of the row at the waterline in units of a column's length along the hull.
        source_height: height of the sources above the surface in units of sqrt(cell area).
        collocation_shift: how far the collocation point lies upstream of the cell's centre, in cells.
        planes: distances of the momentum planes aft of AP; the wave resistance is their mean.
        plane_depth: depth of the momentum planes.
        plane_layers: layers of the planes, with two Gauss points each.
        single_precision: the hull's elimination and the waves in single precision, neighbouring speeds from one
            factorisation: within 2e-5 of the waves for half the time. For solutions that are only compared.
    """

    hull_lengthwise: int = 44
    hull_girthwise: int = 9
    columns_along_hull: int = 40
    columns_upstream: int = 10
    columns_downstream: int = 27
    rows: int = 14
    upstream: float = 0.4
    downstream: float = 0.9
    half_width: float = 0.75
    first_row: float = 0.8
    source_height: float = 1.4
    collocation_shift: float = 0.25
    planes: tuple[float, ...] = (0.12, 0.16, 0.20)
    plane_depth: float = 0.5
    plane_layers: int = 8
    single_precision: bool = False

    def __post_init__(self) -> None:
        for name, fewest in (
            ("hull_lengthwise", 8),
            ("hull_girthwise", 4),
            ("columns_along_hull", 12),
            ("columns_upstream", 4),
            ("columns_downstream", 6),
            ("rows", 6),
            ("plane_layers", 4),
        ):
            if getattr(self, name) < fewest:
                raise InputError(f"Rankine settings: {name} must be at least {fewest}, not {getattr(self, name)}")
        for name in ("upstream", "downstream", "half_width", "first_row", "source_height", "plane_depth"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"Rankine settings: {name} must be positive, not {getattr(self, name)}")
        if not 0.0 <= self.collocation_shift <= 0.5:
            raise InputError(
                f"Rankine settings: collocation_shift must be within 0 and 0.5, not {self.collocation_shift}"
            )
        if not self.planes or not all(0.0 < plane < self.downstream for plane in self.planes):
            raise InputError("Rankine settings: planes must lie behind AP and inside the downstream border")

    def refined(self, factor: float) -> RankineSettings:
        """The same domain with all panel counts multiplied by ``factor`` and rounded."""

        def scaled(count: int) -> int:
            return round(count * factor)

        return replace(
            self,
            hull_lengthwise=scaled(self.hull_lengthwise),
            hull_girthwise=scaled(self.hull_girthwise),
            columns_along_hull=scaled(self.columns_along_hull),
            columns_upstream=scaled(self.columns_upstream),
            columns_downstream=scaled(self.columns_downstream),
            rows=scaled(self.rows),
        )

    def widened(self, factor: float) -> RankineSettings:
        """A domain ``factor`` times as large in every direction, with cells that go on stretching as they do.

        Along the hull and at it nothing changes, so that what comes out differently is the borders' doing.
        """
        column = 1.0 / self.columns_along_hull

        def counted(first: float, length: float, count: int) -> int:
            return _continued(first, length, count, factor * length)

        return replace(
            self,
            upstream=factor * self.upstream,
            downstream=factor * self.downstream,
            half_width=factor * self.half_width,
            columns_upstream=counted(column, self.upstream, self.columns_upstream),
            columns_downstream=counted(column, self.downstream, self.columns_downstream),
            rows=counted(self.first_row * column, self.half_width, self.rows),
        )


def _continued(first: float, length: float, count: int, wanted: float) -> int:
    """Steps that reach ``wanted`` with the ratio by which ``count`` steps from ``first`` on reach ``length``."""

    def total(ratio: float) -> float:
        return first * sum(ratio**step for step in range(count))

    low, high = 0.2, 5.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if total(middle) < length else (low, middle)
    # Cells that shrink outwards, or hardly grow, go on evenly.
    growth = max(0.5 * (low + high), 1.001)
    return max(count, round(math.log1p(wanted * (growth - 1.0) / first) / math.log(growth)))
