"""Guards of the Rankine solver: what can give no trustworthy number is refused with the reason.

The bounds are far outside what sound hulls give (their values stand beside each): no sound design sits near one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.hull.panels import HullPanels
from hpsop_core.hydro.singularities.source_panels import SourcePanels
from hpsop_core.typing_aliases import Array

LEAST_FROUDE, LARGEST_FROUDE = 0.1, 0.5
# A port-side hull of single-valued half-breadths has normals to port: the parent's least is -2e-4.
LEAST_NORMAL = -0.05
STEEPEST_BOTTOM = -0.8
# Flat panels lose volume by their chords: 0.7 % on the parent at the default mesh.
VOLUME_MISMATCH = 0.06
# Strengths of a sphere reach 1.5; of the parent's counter and boss about 3.
LARGEST_STRENGTH = 12.0
LARGEST_SPEED_SQUARE = 12.0
# Double-body drag: 1e-4 on the parent.
LARGEST_DOUBLE_BODY_DRAG = 2e-3
# The Wigley hull at its main hump gives 5e-3, full parents at Froude number 0.5 a few times that.
LARGEST_WAVE_COEFFICIENT = 0.06
# Cells a transverse wave from which there are waves: five hulls had them with 6.3 to 8.1, one of six with 3.8 to 4.9.
CELLS_WITH_WAVES = 7.0


def check_froude_numbers(froude_numbers: Sequence[float]) -> tuple[float, ...]:
    """The Froude numbers as floats.

    Raises:
        InputError: one of them is outside the range for which the solver is made.
    """
    numbers = tuple(float(number) for number in froude_numbers)
    for number in numbers:
        if not LEAST_FROUDE <= number <= LARGEST_FROUDE:
            raise InputError(
                f"Froude number {number:g} is outside {LEAST_FROUDE} to {LARGEST_FROUDE}, the range of the Rankine "
                "solver; choose a speed within it"
            )
    return numbers


def _place(body: HullPanels, index: int) -> str:
    start = 0
    for name, along, across in body.blocks:
        if index < start + along * across:
            x, _, z = body.quads[index].mean(axis=0)
            return f"patch '{name}' at x = {x:.4g} m, z = {z:.4g} m"
        start += along * across
    return f"panel {index}"


def check_panels(body: HullPanels, panels: SourcePanels) -> None:
    """Refuse panels that are not a hull.

    Raises:
        SolverFailure: not finite, out of the water, collapsed, folded, or not enclosing the stated volume.
    """
    for name, value in (
        ("length", body.length),
        ("draft", body.draft),
        ("wetted surface", body.wetted_surface),
        ("displaced volume", body.displaced_volume),
    ):
        if not (np.isfinite(value) and value > 0.0):
            raise SolverFailure("rankine", f"the hull's {name} is {value}: it does not float in the water")
    if not (np.all(np.isfinite(body.quads)) and np.all(np.isfinite(body.waterline))):
        raise SolverFailure("rankine", "the hull's panels are not finite")
    above = body.quads[:, :, 2] - body.draft
    if float(np.max(above)) > 1e-6 * body.length:
        worst = int(np.argmax(np.max(above, axis=1)))
        raise SolverFailure("rankine", f"{_place(body, worst)} is above the waterline")
    if float(np.min(body.quads[:, :, 1])) < -1e-6 * body.length:
        worst = int(np.argmin(np.min(body.quads[:, :, 1], axis=1)))
        raise SolverFailure("rankine", f"{_place(body, worst)} crosses the centreplane: the form crosses itself")
    thin = panels.area <= 1e-6 * panels.diagonal**2
    if bool(np.any(thin)) or bool(np.any(panels.area <= 1e-12)):
        worst = int(np.argmin(panels.area / np.maximum(panels.diagonal, 1e-12) ** 2))
        raise SolverFailure(
            "rankine", f"a panel collapses ({_place(body, worst)}): two stations or lines of the hull meet"
        )
    # A bottom may be hollow; a side may not look inward.
    inward = np.where(panels.normal[:, 2] < STEEPEST_BOTTOM, 0.0, panels.normal[:, 1])
    if float(np.min(inward)) < LEAST_NORMAL:
        worst = int(np.argmin(inward))
        raise SolverFailure(
            "rankine",
            f"the form is folded: a panel faces inward ({_place(body, worst)}, "
            f"normal {panels.normal[worst, 1]:.2f} to port); smooth it, or give stations and waterlines closer "
            "together there",
        )
    own = slice(0, panels.count - body.tail_panels)
    # The flux of (0, y, 0) needs no closed ends.
    flux = panels.centre[own, 1] * panels.normal[own, 1] * panels.area[own]
    volume = 2.0 * float(np.sum(flux)) * body.length**3
    if abs(volume / body.displaced_volume - 1.0) > VOLUME_MISMATCH:
        raise SolverFailure(
            "rankine",
            f"the panels enclose {volume:.6g} m3 but the hull displaces {body.displaced_volume:.6g} m3: "
            "the form is open, folded or too coarsely panelled",
        )


def check_base_flow(strengths: Array, flow: Array, drag: float) -> None:
    """Refuse a double-body flow that cannot be one of a sound form.

    Raises:
        SolverFailure: strengths, speeds or drag far out of range.
    """
    strength = float(np.max(np.abs(strengths))) if np.all(np.isfinite(strengths)) else np.inf
    speed_square = float(np.max(np.sum(flow**2, axis=1))) if np.all(np.isfinite(flow)) else np.inf
    if strength > LARGEST_STRENGTH or speed_square > LARGEST_SPEED_SQUARE:
        raise SolverFailure(
            "rankine",
            f"the double-body flow is not of a sound form (source strength {strength:.3g}, "
            f"speed {np.sqrt(speed_square):.3g} U)",
        )
    if abs(drag) > LARGEST_DOUBLE_BODY_DRAG:
        raise SolverFailure("rankine", f"the double body has a drag coefficient of {drag:.2e}, which should be zero")


def check_answer(froude_number: float, by_plane: float, by_pressure: float, elevation: Array, step: float) -> None:
    """Refuse a wave resistance that is none; ``step`` is the length of the surface's cells along the hull in Lpp.

    Raises:
        SolverFailure: not finite, not positive, or beyond linear theory.
    """
    if not (np.isfinite(by_plane) and np.isfinite(by_pressure) and np.all(np.isfinite(elevation))):
        raise SolverFailure("rankine", f"the solution at Froude number {froude_number:g} is not finite")
    if by_plane <= 0.0:
        cells = 2.0 * np.pi * froude_number**2 / step
        enough = np.ceil(200.0 * np.sqrt(CELLS_WITH_WAVES * step / (2.0 * np.pi))) / 200.0
        speed = f"Froude number {enough:g} or more" if froude_number < enough else "a higher speed"
        raise SolverFailure(
            "rankine",
            f"wave coefficient {by_plane:.2e} at Froude number {froude_number:g} is not positive; a transverse "
            f"wave has {cells:.1f} cells of the surface grid: take {speed}, or level 1 alone with the waves stated "
            '(constants.wave_calibration = "stated")',
        )
    if by_plane > LARGEST_WAVE_COEFFICIENT:
        raise SolverFailure(
            "rankine",
            f"wave coefficient {by_plane:.2e} at Froude number {froude_number:g} is beyond {LARGEST_WAVE_COEFFICIENT}: "
            "the form is outside of linear theory",
        )
