"""Answers about designs of the run on display: numbers, curves, shapes, waves and pressures, each remembered."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explorer.scene.geometry import SceneGeometry, ghost_segments, scene_geometry
from explorer.scene.pressure import PressureMap, blade_map, hull_map
from explorer.services.answers import Answers
from explorer.services.display import Display
from explorer.services.remembered import Remembered
from explorer.state.link import LinkedDesign
from explorer.state.shown import Shown
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import HpsopError
from hpsop_core.evaluation.curves import DesignCurves, HullLines
from hpsop_core.evaluation.fields import WaveField, blade_pressure, hull_pressure, waves
from hpsop_core.evaluation.levels import TRUTH
from hpsop_core.evaluation.reference import Reference
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.evaluation.stated_errors import with_stated_errors
from hpsop_core.geometry.hull.lines import HullLine
from hpsop_core.runs.records import ERROR_FIELDS


class DesignSource(Protocol):
    """Where the designs of a run are read from."""

    @property
    def opening(self) -> int:
        """Which opening of the run (``RunPicture.opening``)."""

    def evaluation(self, design_id: int) -> Evaluation | None:
        """A design's numbers."""

    def reference(self, level: int) -> Reference | None:
        """What normalises at a level."""

    def initial(self, level: int) -> Evaluation | None:
        """The initial design's at a level."""

    def prepare(self, design_ids: Sequence[int]) -> None:
        """Several designs are about to be asked for: read them at once."""


class Designs:
    """Designs of the case on display: those of its run, its initial one, and those of the user's own making.

    Args:
        display: says which case that is.
    """

    def __init__(self, display: Display) -> None:
        self._display = display
        self._source: DesignSource | None = None
        self._answers = Answers()
        self._geometry: Remembered[SceneGeometry] = Remembered(24)
        self._waves: Remembered[WaveField] = Remembered(6)
        self._pressure: Remembered[PressureMap] = Remembered(8)

    def read_from(self, source: DesignSource | None) -> None:
        """Read a run's designs from here from now on."""
        self._source = source

    @property
    def case(self) -> Case:
        """Of the run on display, or as set up while there is none."""
        return self._display.picture.case

    # ---- numbers ---------------------------------------------------------------------------------------------------
    def shown(self, design_id: int) -> Shown | None:
        """A design of the run on display."""
        source = self._source
        evaluation = source.evaluation(design_id) if source is not None else None
        if evaluation is None:
            return None
        opening = source.opening if source is not None else 0
        picture = self._display.picture
        # the picture may still be, or be again, that of another run
        row = picture.row(design_id) if picture.opening == opening else None
        generation = int(picture.generation[row]) if row is not None else None
        hand = row is not None and bool(picture.by_hand[row])
        label = f"Design {design_id}" + (" (by hand)" if hand else "")
        return self.with_errors(Shown(label, evaluation, design_id, generation, opening=opening))

    def prepare(self, design_ids: Sequence[int]) -> None:
        """These designs are about to be shown: read at once they cost a tenth of what they cost one after another."""
        if self._source is not None:
            self._source.prepare(design_ids)

    def initial(self, level: int) -> Shown:
        """The initial design at a level: from the run where it has it, else computed."""
        picture, source = self._display.picture, self._source
        case = picture.case
        evaluation = source.initial(level) if source is not None and source.opening == picture.opening else None
        if evaluation is None or evaluation.variables != case.initial.variables:
            evaluation = self._answers.initial(case, level)
        return self.with_errors(Shown("Initial design", evaluation, kind="initial", opening=picture.opening))

    def first(self) -> Shown:
        """The initial design at the level that the run has reached."""
        return self.initial(self._display.picture.current_level)

    def best(self) -> Shown:
        """What a run is opened at: its compromise, or the initial design before there is one."""
        chosen = self._display.picture.compromise
        shown = self.shown(chosen) if chosen is not None else None
        return shown if shown is not None and shown.evaluation.ok else self.first()

    def whatif(self, variables: DesignVariables, level: int = 1) -> Shown:
        """A design of the user's own making, evaluated now."""
        picture = self._display.picture
        self._take_run(level)
        evaluation = self._answers.evaluate(picture.case, variables, level)
        return self.with_errors(Shown("What-if", evaluation, kind="whatif", opening=picture.opening))

    def with_errors(self, shown: Shown) -> Shown:
        """The design with what is known of its errors now: its own where it was solved finer, else typical ones."""
        evaluation = shown.evaluation
        if not evaluation.ok or evaluation.level != TRUTH.number or evaluation.comparison_errors:
            return shown
        own = self._answers.known_refined(self.case, evaluation.variables)
        if own is None or not own.ok:
            return dataclasses.replace(shown, evaluation=with_stated_errors(self.case, evaluation))
        known = {name: getattr(own, name) for name in (*ERROR_FIELDS, "errors_source")}
        return dataclasses.replace(shown, evaluation=dataclasses.replace(evaluation, **known))

    def refine(self, variables: DesignVariables) -> Evaluation:
        """A design at level 2 with its own errors; a few seconds, then remembered."""
        self._take_run(TRUTH.number)
        return self._answers.refined(self.case, variables)

    def linked(self, named: LinkedDesign) -> Shown | None:
        """The design that a link names, or None where the run has none such."""
        if named.design_id is not None:
            shown = self.shown(named.design_id)
            return shown if shown is not None and shown.evaluation.ok else None
        return self.first() if named.variables is None else self.whatif(named.variables, named.level)

    def again(self, saved: object) -> Shown | None:
        """The design that ``Shown.saved`` described, or None where it no longer exists."""
        if not isinstance(saved, dict):
            return None
        if isinstance(saved.get("id"), int):
            return self.shown(saved["id"])
        level = saved["level"] if saved.get("level") in (1, 2) else 1
        if saved.get("kind") == "initial":
            return self.initial(level)
        try:
            return self.whatif(DesignVariables.from_dict(saved.get("variables") or {}), level)
        except (HpsopError, TypeError, AttributeError):
            return None

    def reference(self, level: int) -> Reference:
        """What normalises at a level."""
        self._take_run(level)
        return self._answers.reference(self.case, level)

    def _take_run(self, level: int) -> None:
        """What normalises is the run's own, where it has it: it may have taken dozens of hulls to find."""
        picture, source = self._display.picture, self._source
        if source is not None and source.opening == picture.opening:
            self._answers.take(picture.case, level, lambda: source.reference(level))

    # ---- curves and lines ------------------------------------------------------------------------------------------
    def curves(self, evaluation: Evaluation) -> DesignCurves:
        """Resistance and thrust against Froude number."""
        self._take_run(evaluation.level)
        return self._answers.curves(self.case, evaluation)

    def known_curves(self, evaluation: Evaluation) -> DesignCurves | None:
        """The same where it has been computed."""
        return self._answers.known_curves(self.case, evaluation)

    def lines(self, variables: DesignVariables) -> HullLines:
        """Sections and areas."""
        return self._answers.lines(self.case, variables)

    def known_lines(self, variables: DesignVariables) -> HullLines | None:
        """The same where they have been cut."""
        return self._answers.known_lines(self.case, variables)

    def plan(self, variables: DesignVariables) -> tuple[HullLine, ...]:
        """Lines of the lines plan."""
        return self._answers.plan(self.case, variables)

    def known_plan(self, variables: DesignVariables) -> tuple[HullLine, ...] | None:
        """The same where they have been cut."""
        return self._answers.known_plan(self.case, variables)

    # ---- the 3D view -----------------------------------------------------------------------------------------------
    def geometry(self, variables: DesignVariables, near: bool = True) -> SceneGeometry:
        """Meshes for the 3D view, for a ship that is looked at closely or as a whole."""
        case = self.case
        key = (case.hull, case.propeller, case.initial, variables.key(), near)
        return self._geometry.get(key, lambda: scene_geometry(case, variables, near))

    def ghost(self, variables: DesignVariables, near: bool = True) -> NDArray[np.float64]:
        """A hull as a lines drawing in space: (n, 2, 3) segments of its sections and its waterline, both sides.

        Args:
            variables: of the design.
            near: which of its meshes are at hand; the lines are the same.
        """
        lines, geometry = self.lines(variables), self.geometry(variables, near)
        return ghost_segments(lines, geometry.waterline)

    def waves(self, evaluation: Evaluation, index: int) -> WaveField:
        """The water surface at a condition, by the evaluation's own level.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, condition = self.case, evaluation.conditions[index]
        key = (case, evaluation.level, evaluation.variables.key(), condition.froude_number, "waves")
        return self._waves.get(key, lambda: waves(case, evaluation, condition=index))

    def hull_pressure(self, evaluation: Evaluation, index: int) -> PressureMap:
        """Pressure on the hull at a condition, always by level 2.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, froude = self.case, evaluation.conditions[index].froude_number
        key = (case.hull, case.initial, evaluation.variables.key(), froude, "hull")

        def compute() -> PressureMap:
            return hull_map(hull_pressure(case, evaluation, condition=index), self.geometry(evaluation.variables))

        return self._pressure.get(key, compute)

    def blade_pressure(self, evaluation: Evaluation, index: int) -> PressureMap:
        """Pressure on the blades at a condition's advance coefficient, always by level 2.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, condition = self.case, evaluation.conditions[index]
        key = (case.propeller, evaluation.variables.key(), condition.advance_coefficient, "blades")

        def compute() -> PressureMap:
            return blade_map(blade_pressure(case, evaluation, condition=index), self.geometry(evaluation.variables))

        return self._pressure.get(key, compute)
