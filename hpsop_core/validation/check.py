"""One line of ``hpsop validate``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

FITTED = "fitted"
"""A constant or a shape of ours was chosen on these very data: agreement proves nothing but that the fit is kept."""
HELD_OUT = "held out"
"""Somebody else's measurement, code or closed form that no constant of ours was chosen on."""
SELF_CONSISTENCY = "self-consistency"
"""Our numbers beside our own, or beside a bound that they must keep."""
LABELS = (FITTED, HELD_OUT, SELF_CONSISTENCY)


@dataclass(frozen=True)
class Check:
    """A computed number beside one that nobody here wrote.

    Attributes:
        group: the discipline, for example "hull hydrostatics".
        quantity: what is compared, with its unit.
        computed: our value.
        reference: the published or closed-form value, or the bound that must hold.
        source: where the reference comes from.
        tolerance: the tolerance in words, with its kind, for example "0.5 % relative" or "within 2.5 to 4.0e-4".
        passed: whether the tolerance holds.
        label: one of ``LABELS``; the weakest claim unless more is said.

    numpy's scalars become Python's own, which every JSON writer knows.
    """

    group: str
    quantity: str
    computed: float
    reference: float
    source: str
    tolerance: str
    passed: bool
    label: str = SELF_CONSISTENCY

    def __post_init__(self) -> None:
        for name, kind in (("computed", float), ("reference", float), ("passed", bool)):
            object.__setattr__(self, name, kind(getattr(self, name)))
        if self.label not in LABELS:
            raise ValueError(f"a check is one of {', '.join(LABELS)}, not {self.label}")


def labelled(label: str, checks: Iterable[Check]) -> Iterator[Check]:
    """The same checks with this label."""
    for check in checks:
        yield replace(check, label=label)


def relative_check(
    group: str, quantity: str, computed: float, reference: float, source: str, relative_tolerance: float
) -> Check:
    """A check of ``computed`` against ``reference`` within a relative tolerance."""
    passed = abs(computed - reference) <= relative_tolerance * abs(reference)
    return Check(group, quantity, computed, reference, source, f"{100 * relative_tolerance:g} % relative", passed)


def absolute_check(
    group: str, quantity: str, computed: float, reference: float, source: str, absolute_tolerance: float
) -> Check:
    """A check of ``computed`` against ``reference`` within an absolute tolerance, in the quantity's unit."""
    passed = abs(computed - reference) <= absolute_tolerance
    return Check(group, quantity, computed, reference, source, f"{absolute_tolerance:g} absolute", passed)


def range_check(
    group: str, quantity: str, computed: float, lower: float, upper: float, reference: float, source: str
) -> Check:
    """A check that ``computed`` lies within ``lower`` and ``upper``; ``reference`` is what it is compared with."""
    return Check(
        group, quantity, computed, reference, source, f"within {lower:g} to {upper:g}", lower <= computed <= upper
    )
