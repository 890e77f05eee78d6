"""A computed curve beside a measured one: lines of ``hpsop validate`` and plots of docs/validation.md."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hpsop_core.typing_aliases import Array
from hpsop_core.validation.check import Check


@dataclass(frozen=True, eq=False)
class Comparison:
    """Numbers at several speeds or advance coefficients.

    Attributes:
        group: the study, as ``hpsop validate`` names it.
        quantity: what is compared, with its unit.
        abscissa: name of ``at``.
        at, computed, measured: (n,).
        lower, upper: (n,) the bounds within which the computed value is to lie, fixed before it was computed.
        tolerance: where these bounds come from.
        source: who measured.
        label: one of ``check.LABELS``.
    """

    group: str
    quantity: str
    abscissa: str
    at: Array
    computed: Array
    measured: Array
    lower: Array
    upper: Array
    tolerance: str
    source: str
    label: str

    def checks(self) -> Iterator[Check]:
        """One line for each point."""
        points = zip(self.at, self.computed, self.measured, self.lower, self.upper, strict=True)
        for at, computed, measured, lower, upper in points:
            yield Check(
                self.group,
                f"{self.quantity} at {self.abscissa} {at:g}",
                computed,
                measured,
                self.source,
                f"within {lower:.4g} to {upper:.4g}: {self.tolerance}",
                lower <= computed <= upper,
                self.label,
            )
