"""The longitudinal shift of sections that changes block coefficient and centre of buoyancy.

In the parent's frame x' = x + a_f phi((x - xm)/(xf - xm)) - a_a phi((xm - x)/(xm - xa)); the sections themselves stay.
phi' is a trapezoid of unit area over (0, p) less one over (p, 1), both with cosine ramps, so that phi is C2 and phi and
phi' vanish at both ends: nothing outside (xa, xf) moves. The shoulder p slides with the amplitude: a long parallel body
is stretched near midships, while shrinking needs the whole half body, else it folds.
Departs from Lackenby (1950), whose linear shift of the prismatic curve folds the parallel body for fine forms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hpsop_core.typing_aliases import Array

RAMP = 0.2
LEAST_STRETCH = 0.3
SHOULDER_FULL, SHOULDER_RANGE = 0.17, 0.33
# The amplitude over which the shoulder slides, as a fraction of the parent's length (8 m of 355 m).
SHOULDER_WIDTH = 8.0 / 355.0


@dataclass(frozen=True)
class ShiftFrame:
    """Where sections may move in the parent, metres: aft end, middle and forward end of the shift."""

    aft: float
    middle: float
    forward: float
    length: float


def _ramped_step(s: Array) -> Array:
    """Trapezoid with cosine ramps on [0, 1], height 1, area 1 - RAMP."""
    edge = np.clip(np.minimum(s, 1.0 - s), 0.0, RAMP)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi / RAMP * edge))


def _ramped_step_integral(s: Array) -> Array:
    """Integral of `_ramped_step` from 0 to s."""
    s = np.clip(s, 0.0, 1.0)
    mirrored = np.minimum(s, 1.0 - s)
    edge = np.minimum(mirrored, RAMP)
    half = 0.5 * (edge - RAMP / np.pi * np.sin(np.pi / RAMP * edge)) + np.maximum(mirrored - RAMP, 0.0)
    return np.asarray(np.where(s > 0.5, 1.0 - RAMP - half, half))


def _shoulder(amplitude: float, length: float) -> float:
    """Sliding shoulder p(a), between .17 (stretched) and .5 (shrunk)."""
    width = SHOULDER_WIDTH * length
    return SHOULDER_FULL + SHOULDER_RANGE / (1.0 + float(np.exp(np.clip(amplitude / width, -50.0, 50.0))))


def _lobe(t: Array, shoulder: float) -> tuple[Array, Array]:
    """phi and phi' at t (0 outside [0, 1])."""
    rise, fall = t / shoulder, (t - shoulder) / (1.0 - shoulder)
    area = 1.0 - RAMP
    inside = (t > 0.0) & (t < 1.0)
    value = np.where(inside, (_ramped_step_integral(rise) - _ramped_step_integral(fall)) / area, 0.0)
    slope = np.where(
        inside,
        (
            np.where(rise < 1.0, _ramped_step(rise), 0.0) / shoulder
            - np.where(fall > 0.0, _ramped_step(fall), 0.0) / (1.0 - shoulder)
        )
        / area,
        0.0,
    )
    return value, slope


@dataclass(frozen=True)
class LongitudinalShift:
    """A shift with its amplitudes in the parent's metres; both zero is the identity."""

    frame: ShiftFrame
    forward_amplitude: float
    aft_amplitude: float

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """Shifted positions and dx'/dx at the parent's positions x, same shape."""
        frame = self.frame
        x = np.asarray(x, dtype=np.float64)
        if self.forward_amplitude == 0.0 and self.aft_amplitude == 0.0:
            return x, np.ones_like(x)
        forward, aft = frame.forward - frame.middle, frame.middle - frame.aft
        phi_f, slope_f = _lobe((x - frame.middle) / forward, _shoulder(self.forward_amplitude, frame.length))
        phi_a, slope_a = _lobe((frame.middle - x) / aft, _shoulder(self.aft_amplitude, frame.length))
        moved = x + self.forward_amplitude * phi_f - self.aft_amplitude * phi_a
        stretch = 1.0 + self.forward_amplitude / forward * slope_f + self.aft_amplitude / aft * slope_a
        return moved, stretch

    def least_stretch(self) -> float:
        """The smallest dx'/dx anywhere, from the plateaus of phi' in closed form."""
        least = 1.0
        for amplitude, span in (
            (self.forward_amplitude, self.frame.forward - self.frame.middle),
            (self.aft_amplitude, self.frame.middle - self.frame.aft),
        ):
            shoulder = _shoulder(amplitude, self.frame.length)
            rise, fall = 1.0 / (shoulder * (1.0 - RAMP)), -1.0 / ((1.0 - shoulder) * (1.0 - RAMP))
            least = min(least, 1.0 + amplitude / span * rise, 1.0 + amplitude / span * fall)
        return least


Measure = Callable[[LongitudinalShift], tuple[float, float]]


def _solved(frame: ShiftFrame, measure: Measure, volume: float, centre: float, start: tuple[float, float]) -> (
    LongitudinalShift | None
):
    """The shift that reaches (volume, centre of buoyancy), or None where Newton's method leaves the valid range."""
    length = frame.length
    a = np.array(start)
    target = np.array([volume, centre])
    scale = np.array([volume, length])
    step = 1e-4 * length
    limit = 0.25 * length
    for _ in range(25):
        shift = LongitudinalShift(frame, float(a[0]), float(a[1]))
        residual = (np.array(measure(shift)) - target) / scale
        if float(np.max(np.abs(residual))) < 1e-12:
            return shift
        jacobian = np.zeros((2, 2))
        for k in range(2):
            moved = a.copy()
            moved[k] += step
            ahead = np.array(measure(LongitudinalShift(frame, float(moved[0]), float(moved[1]))))
            moved[k] -= 2.0 * step
            behind = np.array(measure(LongitudinalShift(frame, float(moved[0]), float(moved[1]))))
            jacobian[:, k] = (ahead - behind) / (2.0 * step) / scale
        if abs(np.linalg.det(jacobian)) < 1e-14:
            return None
        change = -np.linalg.solve(jacobian, residual)
        size = float(np.max(np.abs(change)))
        a = a + change * min(1.0, 0.06 * length / max(size, 1e-12))
        if float(np.max(np.abs(a))) > limit:
            return None
    return None


@dataclass(frozen=True)
class FormSolution:
    """The shift found and whether it had to stop short of what was asked."""

    shift: LongitudinalShift
    clipped: bool


def solve_form(frame: ShiftFrame, measure: Measure, volume: float, centre: float) -> FormSolution:
    """The shift for a volume and a centre of buoyancy in the parent's frame, clipped to what the form carries.

    Where the asked pair would compress sections below dx'/dx = 0.3, the volume is taken back towards the parent's at
    the asked centre; where the centre alone is too far, both are taken back along a straight line.

    Args:
        frame: where sections may move.
        measure: volume (m3) and centre of buoyancy (m) of a shift.
        volume, centre: asked values in the parent's frame.
    """
    identity = LongitudinalShift(frame, 0.0, 0.0)
    own_volume, own_centre = measure(identity)
    if abs(volume / own_volume - 1.0) < 1e-13 and abs(centre - own_centre) < 1e-13 * frame.length:
        return FormSolution(identity, False)

    def attempt(v: float, c: float, near: LongitudinalShift) -> LongitudinalShift | None:
        found = _solved(frame, measure, v, c, (near.forward_amplitude, near.aft_amplitude))
        return found if found is not None and found.least_stretch() > LEAST_STRETCH else None

    direct = attempt(volume, centre, identity)
    if direct is not None:
        return FormSolution(direct, False)
    base = attempt(own_volume, centre, identity)
    start_centre = centre if base is not None else own_centre
    best = base if base is not None else identity
    low, high = 0.0, 1.0
    for _ in range(30):
        part = 0.5 * (low + high)
        found = attempt(
            own_volume + part * (volume - own_volume), start_centre + part * (centre - start_centre), best
        )
        if found is not None:
            best, low = found, part
        else:
            high = part
    return FormSolution(best, True)
