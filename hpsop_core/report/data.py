"""What a report draws from: a run at one moment, with the designs that stand out."""

from __future__ import annotations

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
from hpsop_core.report.looks import COMPROMISE_LOOK, INITIAL_LOOK
from hpsop_core.runs.reader import RunReader
from hpsop_core.runs.records import DesignRecord

CHART_ABOVE = 0.03
"""Resistance is drawn this far above the greatest Froude number: beyond, the curve would dwarf the working range."""


@dataclass(frozen=True, eq=False)
class ReportData:
    """What a report draws from, at one moment of a run.

    Attributes:
        run: the run.
        generations: finished ones.
        initial: at the last generation's level; None while it is not evaluated.
        front: of the last generation, ascending in f1.
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
        last = generations[-1] if generations else None
        front = run.designs(last.front) if last is not None else ()
        by_id = {record.id: record for record in front}
        try:
            initial = run.initial(1 if last is None else last.level)
        except InputError:
            initial = None
        return cls(
            run=run,
            generations=generations,
            initial=initial,
            front=front,
            compromise=None if last is None or last.compromise is None else by_id[last.compromise],
            knee=None if last is None or last.knee is None else by_id[last.knee],
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
    def resistance(self) -> list[tuple[Look, tuple[ResistancePoint, ...], Evaluation]]:
        """Resistance over Froude number of the drawn designs.

        Raises:
            SolverFailure: one cannot be computed.
        """
        return [
            (look, resistance_points(self.case, evaluation, self.reference(evaluation.level), CHART_ABOVE), evaluation)
            for look, evaluation in self.drawn()
        ]

    def reference(self, level: int) -> Reference:
        """What normalises and calibrates at a level.

        Raises:
            SolverFailure: it is not in the file and cannot be computed.
        """
        stored = self.run.reference(level)
        return reference_for(self.case, level) if stored is None else Reference.from_dict(stored)
