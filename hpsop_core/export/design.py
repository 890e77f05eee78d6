"""A design that leaves: everything that any format's writer needs of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Ok
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller


@dataclass(frozen=True, eq=False)
class LeavingDesign:
    """A design with its shapes.

    Attributes:
        case: that it belongs to.
        evaluation: its numbers.
        label: its name in the files, for example "design 12".
        document: the JSON document of everything that is known of it.
        reference: of the case at the evaluation's level.
        hull, propeller: its shapes.
    """

    case: Case
    evaluation: Ok
    label: str
    document: dict[str, Any]
    reference: Reference
    hull: Hull
    propeller: Propeller

    @property
    def title(self) -> str:
        """One line: case, design, level and main dimensions."""
        h, p = self.hull, self.propeller
        return (
            f"{self.case.name}, {self.label} (level {self.evaluation.level}): "
            f"L {h.length:.2f} m, B {h.breadth:.2f} m, d {h.draft:.2f} m, CB {h.hydrostatics.block_coefficient:.4f}; "
            f"propeller D {p.diameter:.3f} m, Z {p.blade_count}, P/D at 0.7 R {p.pitch_diameter_ratio_07R:.4f}, "
            f"EAR {p.expanded_area_ratio:.3f}"
        )


def leaving_design(
    case: Case, evaluation: Ok, label: str, document: dict[str, Any], reference: Reference
) -> LeavingDesign:
    """The design with its shapes built."""
    hull, propeller = design_hull(case, evaluation.variables), design_propeller(case, evaluation.variables)
    return LeavingDesign(case, evaluation, label, document, reference, hull, propeller)
