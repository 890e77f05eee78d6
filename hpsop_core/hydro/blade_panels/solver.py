"""Open-water characteristics by a potential-based panel method (level 2): problem in, result out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.blade_panels.grid import STAGE
from hpsop_core.hydro.blade_panels.model import BladePanelModel, FlowCondition, blade_panel_model
from hpsop_core.hydro.blade_panels.pressure import BladePressureTable, SurfacePressure, surface_pressure
from hpsop_core.hydro.blade_panels.settings import SOLVER, BladePanelSettings
from hpsop_core.hydro.open_water import OpenWater, reynolds_number_07R
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array


@dataclass(frozen=True)
class BladePanelResult:
    """What the panel method found.

    Attributes:
        open_water: KT, KQ, eta0 over J.
        radius_ratio: (m,) r/R of the strips.
        circulation: (nJ, m) Gamma/(n D^2) of the strips.
        wake_pitch_ratio: (nJ,) P/D of the aligned wake (nan-free; 0 for "geometric_pitch").
        conditions: (nJ,) the flow at each J.
        model: the factorised flow, for pressures at any J.
        drag: the section drag.
    """

    open_water: OpenWater
    radius_ratio: Array
    circulation: Array
    wake_pitch_ratio: Array
    conditions: tuple[FlowCondition, ...]
    model: BladePanelModel
    drag: SectionDrag

    def surface_pressure(self, advance_coefficient: float, all_blades: bool = True) -> SurfacePressure:
        """Cp on blades and hub at any J; see ``pressure.surface_pressure``."""
        return surface_pressure(self.model, advance_coefficient, all_blades)

    def pressure_table(self) -> BladePressureTable:
        """The blades' pressures at the result's J; their margin against cavitation is a method of the table."""
        return BladePressureTable.of(self.model, self.conditions)


def forces_of(result: BladePanelResult, forces: Literal["circulation", "pressure"]) -> tuple[Array, Array]:
    """(KT, KQ) at the J of ``result``, computed from circulations or pressures whatever its settings say."""
    model = replace(result.model, settings=replace(result.model.settings, forces=forces))
    values = [model.forces(condition, result.drag) for condition in result.conditions]
    thrust, torque = np.array(values).reshape(-1, 2).T
    return thrust, torque


def solve(
    propeller: Propeller,
    advance_coefficients: Array | Sequence[float],
    drag: SectionDrag,
    settings: BladePanelSettings | None = None,
) -> BladePanelResult:
    """Open-water characteristics by the panel method.

    Where the panels do not enclose the blade (row sums), the grid is refined once.

    Args:
        propeller: the propeller.
        advance_coefficients: J >= 0, (nJ,).
        drag: section drag; ``SectionDrag.inviscid()`` for potential flow alone.
        settings: None takes the optimiser's.

    Raises:
        InputError: a J is negative or not finite.
        SolverFailure: the panels cannot represent the geometry, or a condition does not converge (it names the J).
    """
    settings = BladePanelSettings() if settings is None else settings
    chord_07 = float(propeller.table.at_07R.chord_ratio)
    camber = settings.camber_effectiveness * drag.camber_gain(propeller.diameter, chord_07)
    settings = replace(settings, camber_effectiveness=camber)
    advance = np.atleast_1d(np.asarray(advance_coefficients, dtype=np.float64))
    if advance.ndim != 1 or not np.all(np.isfinite(advance)) or np.any(advance < 0.0):
        raise InputError("advance coefficients must be finite numbers of at least 0")
    # One thread: the matrix is small, and the same bits must come out whatever runs beside.
    with one_blas_thread():
        try:
            model = blade_panel_model(propeller, settings, drag.viscous)
        except SolverFailure:
            if settings.chordwise_panels >= 40:
                raise
            finer = replace(settings, chordwise_panels=40, radial_panels=15)
            model = blade_panel_model(propeller, finer, drag.viscous)
        conditions = [model.condition(float(j)) for j in advance]
        forces = np.array([model.forces(condition, drag) for condition in conditions]).reshape(-1, 2)
    if not np.all(np.isfinite(forces)):
        bad = advance[~np.all(np.isfinite(forces), axis=1)][0]
        raise SolverFailure(STAGE, f"the forces at J = {bad:g} are not finite")
    reynolds = None
    if drag.rotation_rate is not None and drag.viscosity is not None:
        reynolds = reynolds_number_07R(propeller, advance, drag.rotation_rate, drag.viscosity)
    open_water = OpenWater(advance, forces[:, 0], forces[:, 1], reynolds, 2, SOLVER, model.settings.text)
    return BladePanelResult(
        open_water,
        model.strips.radius,
        np.array([c.jump for c in conditions]).reshape(advance.size, -1) / 4.0,
        np.array([0.5 * c.wake_pitch for c in conditions]),
        tuple(conditions),
        model,
        drag,
    )
