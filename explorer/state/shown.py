"""A design on display."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hpsop_core.evaluation.result import Evaluation


@dataclass(frozen=True)
class Shown:
    """A design on display.

    Attributes:
        label: for people: "Design 1234", "Initial design", "What-if".
        evaluation: its numbers.
        design_id: in the run, or None.
        generation: it was born in, or None.
        kind: "run", "initial" or "whatif".
        opening: of the run that it belongs to (``RunPicture.opening``).
    """

    label: str
    evaluation: Evaluation
    design_id: int | None = None
    generation: int | None = None
    kind: str = "run"
    opening: int = 0

    @property
    def key(self) -> tuple[object, ...]:
        """Two shown designs of equal keys have the same geometry and curves."""
        return (self.evaluation.level, *self.evaluation.variables.key())

    @property
    def name(self) -> str:
        """The key as text."""
        return " ".join(str(part) for part in self.key)

    def saved(self) -> dict[str, Any]:
        """By what a reload finds it again, as JSON."""
        return {
            "id": self.design_id,
            "kind": self.kind,
            "level": self.evaluation.level,
            "variables": self.evaluation.variables.as_dict(),
        }


def file_name(shown: Shown | None) -> str:
    """How files of a design begin."""
    return f"hpsop-{shown.design_id if shown and shown.design_id is not None else 'design'}"
