"""What a report draws from: a run at one moment, with the designs that stand out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from hpsop_core.case.case import Case
from hpsop_core.charts.looks import Look
from hpsop_core.errors import InputError
from hpsop_core.evaluation.curves import resistance_points
from hpsop_core.evaluation.hull_answer import ResistancePoint
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.optimization.generation import Generation
from hpsop_core.report.looks import COMPROMISE_LOOK, INITIAL_LOOK, SPREAD_ROLES
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord, with_errors

CHART_ABOVE = 0.03
"""Resistance is drawn this far above the greatest Froude number: beyond, the curve would dwarf the working range."""

SPREAD = 5
"""Designs of the front that stand for all of it, as in the paper."""


def spread_over(front: Sequence[DesignRecord], compromise: DesignRecord | None) -> tuple[tuple[str, DesignRecord], ...]:
    """At most SPREAD designs evenly over the front's ranks, both ends and the compromise among them: R1, R2, ..."""
    if not front:
        return ()
    last = len(front) - 1
    places = {round(last * part / (SPREAD - 1)) for part in range(SPREAD)}
    if compromise is not None:
        at = next(place for place, record in enumerate(front) if record.id == compromise.id)
        if at not in places:
            # The nearest inner place gives way.
            inner = places - {0, last}
            if inner:
                places.remove(min(inner, key=lambda place: abs(place - at)))
            places.add(at)
    return tuple((f"R{number}", front[place]) for number, place in enumerate(sorted(places), start=1))


@dataclass(frozen=True, eq=False)
class ReportData:
    """What a report draws from, at one moment of a run.

    Attributes:
        run: the run.
        generations: finished ones.
        initial: at the last generation's level; None while it is not evaluated.
        front: of everything that the last generation's level has solved, ascending in f1.
        compromise, knee: None where the front is empty.
    """

    run: RunReader
    generations: tuple[Generation, ...]
    initial: DesignRecord | None
    front: tuple[DesignRecord, ...]
    compromise: DesignRecord | None
    knee: DesignRecord | None

    @classmethod
    def of(cls, run: RunReader) -> ReportData:
        """The run as it is now."""
        generations = run.generations()
        last, known = (generations[-1] if generations else None), run.known_front()
        front = tuple(with_errors(run.case, record) for record in run.designs(known.ids if known is not None else ()))
        by_id = {record.id: record for record in front}
        try:
            initial = with_errors(run.case, run.initial(1 if last is None else last.level))
        except InputError:
            initial = None
        return cls(
            run=run,
            generations=generations,
            initial=initial,
            front=front,
            compromise=None if known is None or known.compromise is None else by_id[known.compromise],
            knee=None if known is None or known.knee is None else by_id[known.knee],
        )

    @property
    def case(self) -> Case:
        """The run's."""
        return self.run.case

    @property
    def level(self) -> int | None:
        """Of the last generation."""
        return self.generations[-1].level if self.generations else None

    def chosen(self) -> list[tuple[str, DesignRecord]]:
        """Compromise, knee and both ends of the front; a design that is several of these comes once, with all names."""
        if not self.front:
            return []
        named = [("compromise", self.compromise), ("knee", self.knee)]
        named += [("best f₁", self.front[0]), ("best f₂", self.front[-1])]
        names: dict[int, str] = {}
        for name, record in named:
            if record is not None:
                names[record.id] = f"{names[record.id]}, {name}" if record.id in names else name
        records = {record.id: record for record in self.front}
        return [(words, records[number]) for number, words in names.items()]

    def marks(self) -> dict[int, str]:
        """What the front's table calls the chosen ones."""
        return {record.id: name for name, record in self.chosen()}

    def drawn(self) -> list[tuple[Look, Evaluation]]:
        """The designs of the comparing charts."""
        pairs = [(INITIAL_LOOK, self.initial), (COMPROMISE_LOOK, self.compromise)]
        return [(look, record.evaluation) for look, record in pairs if record is not None and record.evaluation.ok]

    @cached_property
    def spread(self) -> tuple[tuple[str, DesignRecord], ...]:
        """Designs spread along the front, as ``spread_over`` names them."""
        return spread_over(self.front, self.compromise)

    def compared(self) -> list[tuple[str, DesignRecord]]:
        """The initial design and those spread along the front, each with its name."""
        found = [] if self.initial is None else [(INITIAL_LOOK.name, self.initial)]
        return found + [(self._spread_name(name, record), record) for name, record in self.spread]

    def _spread_name(self, name: str, record: DesignRecord) -> str:
        return f"{name}, compromise" if record is self.compromise else name

    def spread_drawn(self) -> list[tuple[Look, Evaluation]]:
        """The designs of the charts that show the front: the initial one and those spread along it."""
        roles = iter(SPREAD_ROLES)
        found: list[tuple[Look, Evaluation]] = []
        for name, record in self.compared():
            if record is self.initial:
                look = INITIAL_LOOK
            elif record is self.compromise:
                look = Look(name, COMPROMISE_LOOK.role)
            else:
                look = Look(name, next(roles))
            found.append((look, record.evaluation))
        return [(look, evaluation) for look, evaluation in found if evaluation.ok]

    @cached_property
    def resistance(self) -> list[tuple[Look, tuple[ResistancePoint, ...], Evaluation]]:
        """Resistance over speed of the initial design and of those spread along the front.

        Raises:
            SolverFailure: one cannot be computed.
        """
        return [
            (look, resistance_points(self.case, evaluation, self.reference(evaluation.level), CHART_ABOVE), evaluation)
            for look, evaluation in self.spread_drawn()
        ]

    def reference(self, level: int) -> Reference:
        """What normalises and calibrates at a level.

        Raises:
            SolverFailure: it is not in the file and cannot be computed.
        """
        if level not in self._references:
            stored = self.run.reference(level)
            self._references[level] = reference_for(self.case, level) if stored is None else Reference.from_dict(stored)
        return self._references[level]

    @cached_property
    def _references(self) -> dict[int, Reference]:
        return {}
