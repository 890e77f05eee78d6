"""The longitudinal shift of sections that changes block coefficient and centre of buoyancy.

In the parent's frame x' = x + a_f phi((x - xm)/(xf - xm)) - a_a phi((xm - x)/(xm - xa)); the sections themselves stay.
phi' is a trapezoid of unit area over (0, p) less one over (p, 1), both with cosine ramps, so that phi is C2 and phi and
phi' vanish at both ends: nothing outside (xa, xf) moves. The shoulder p slides with the amplitude: a long parallel body
is stretched near midships, while shrinking needs the whole half body, else it folds.
Departs from Lackenby (1950), whose linear shift of the prismatic curve folds the parallel body for fine forms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from hpsop_core.errors import SolverFailure
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


def _shoulder(amplitude: float, length: float) -> float:
    """Sliding shoulder p(a), between .17 (stretched) and .5 (shrunk)."""
    width = SHOULDER_WIDTH * length
    return SHOULDER_FULL + SHOULDER_RANGE / (1.0 + float(np.exp(np.clip(amplitude / width, -50.0, 50.0))))


def _lobe(t: Array, shoulder: float) -> tuple[Array, Array]:
    """phi and phi' at t within [0, 1]: up to one at the shoulder, down to zero at the end."""
    rising = t < shoulder
    span = np.where(rising, shoulder, 1.0 - shoulder)
    s = np.where(rising, t, t - shoulder) / span
    nearest = np.minimum(s, 1.0 - s)
    angle = np.pi / RAMP * np.minimum(nearest, RAMP)
    step = 0.5 - 0.5 * np.cos(angle)
    # The integral of the trapezoid from its nearer end, by its symmetry about the middle.
    part = 0.5 * RAMP / np.pi * (angle - np.sin(angle)) + np.maximum(nearest - RAMP, 0.0)
    area = 1.0 - RAMP
    rise = np.where(s > 0.5, area - part, part) / area
    return np.where(rising, rise, 1.0 - rise), np.where(rising, step, -step) / (area * span)


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
        moved, stretch = x.copy(), np.ones_like(x)
        for amplitude, span, direction in (
            (self.forward_amplitude, frame.forward - frame.middle, 1.0),
            (self.aft_amplitude, frame.middle - frame.aft, -1.0),
        ):
            if amplitude == 0.0:
                continue
            t = direction * (x - frame.middle) / span
            inside = (t > 0.0) & (t < 1.0)
            value, slope = _lobe(t[inside], _shoulder(amplitude, frame.length))
            moved[inside] += direction * amplitude * value
            stretch[inside] += amplitude / span * slope
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


TABLE_POINTS = 97
# Amplitudes end just inside the least stretch, so that a clipped form still passes the check.
STRETCH_MARGIN = 1e-6


# A parent whose volume can change by less than this at its own centre of buoyancy gives the centre up instead.
LEAST_RANGE = 0.04


@dataclass(frozen=True)
class FormSolution:
    """The shift found, whether it had to stop short of what was asked, and whether the centre is the asked one."""

    shift: LongitudinalShift
    clipped: bool
    centre_held: bool = True


class _HalfBody:
    """Volume and moment of the sections of one half body as functions of its amplitude."""

    def __init__(self, frame: ShiftFrame, forward: bool, x: Array, slices: Array) -> None:
        self._frame, self._forward, self._x, self._slices = frame, forward, x, slices
        self.low, self.high = self._limit(-1.0), self._limit(1.0)
        grid = np.linspace(self.low, self.high, TABLE_POINTS)
        table = CubicSpline(grid, np.array([self.exact(float(a)) for a in grid]))
        self._spline, self._slope = table, table.derivative()

    def shift(self, amplitude: float) -> LongitudinalShift:
        pair = (amplitude, 0.0) if self._forward else (0.0, amplitude)
        return LongitudinalShift(self._frame, *pair)

    def exact(self, amplitude: float) -> Array:
        """Volume and moment about AP, (2,)."""
        moved, stretch = self.shift(amplitude).evaluate(self._x)
        slices = self._slices * stretch
        return np.array([np.sum(slices), slices @ moved])

    def table(self, amplitude: float) -> tuple[Array, Array]:
        """Interpolated volume and moment with their derivatives, (2,) each."""
        return np.asarray(self._spline(amplitude)), np.asarray(self._slope(amplitude))

    def _limit(self, sign: float) -> float:
        low, high = 0.0, self._frame.length
        for _ in range(60):
            middle = 0.5 * (low + high)
            if self.shift(sign * middle).least_stretch() > LEAST_STRETCH + STRETCH_MARGIN:
                low = middle
            else:
                high = middle
        return sign * low


class FormSolver:
    """Finds shifts of one parent: volume and centre of buoyancy in, amplitudes out.

    Both half bodies' volumes and moments are tabulated once over their amplitudes; a design is then a 2x2 Newton on
    splines, polished on the exact integrals to rounding.

    Args:
        frame: where sections may move.
        x: positions of sections, m.
        slices: their volumes (sectional area times dx weight), m3.
    """

    def __init__(self, frame: ShiftFrame, x: Array, slices: Array) -> None:
        self.frame = frame
        forward = (x > frame.middle) & (x < frame.forward)
        aft = (x <= frame.middle) & (x > frame.aft)
        rest = ~(forward | aft)
        self._fixed = np.array([np.sum(slices[rest]), slices[rest] @ x[rest]])
        self._bodies = (
            _HalfBody(frame, True, x[forward], slices[forward]),
            _HalfBody(frame, False, x[aft], slices[aft]),
        )
        own = self._fixed + self._bodies[0].exact(0.0) + self._bodies[1].exact(0.0)
        self.volume, self.centre = float(own[0]), float(own[1] / own[0])
        self.holds_centre = all(
            self._newton(self.volume * (1.0 + sign * LEAST_RANGE), self.centre, np.zeros(2)) is not None
            for sign in (-1.0, 1.0)
        )

    def _newton(self, volume: float, centre: float, start: Array) -> Array | None:
        """Amplitudes on the splines, or None where no pair within the limits reaches the target."""
        target = np.array([volume, volume * centre])
        scale = np.array([volume, volume * self.frame.length])
        low = np.array([body.low for body in self._bodies])
        high = np.array([body.high for body in self._bodies])
        a = start
        for _ in range(40):
            values = [body.table(float(amplitude)) for body, amplitude in zip(self._bodies, a, strict=True)]
            residual = (self._fixed + values[0][0] + values[1][0] - target) / scale
            if float(np.max(np.abs(residual))) < 1e-10:
                return a
            jacobian = np.column_stack([values[0][1], values[1][1]]) / scale[:, None]
            if abs(float(np.linalg.det(jacobian))) < 1e-18:
                return None
            moved = np.clip(a - np.linalg.solve(jacobian, residual), low, high)
            if float(np.max(np.abs(moved - a))) < 1e-12 * self.frame.length:
                return None
            a = moved
        return None

    def _polished(self, volume: float, centre: float, a: Array) -> LongitudinalShift:
        target = np.array([volume, volume * centre])
        for _ in range(4):
            exact = self._fixed + sum(b.exact(float(v)) for b, v in zip(self._bodies, a, strict=True))
            residual = exact - target
            if abs(residual[0]) < 1e-13 * volume and abs(residual[1]) < 1e-13 * volume * self.frame.length:
                break
            slopes = [body.table(float(v))[1] for body, v in zip(self._bodies, a, strict=True)]
            a = a - np.linalg.solve(np.column_stack(slopes), residual)
        return LongitudinalShift(self.frame, float(a[0]), float(a[1]))

    def _at_limit(self, volume: float, centre: float) -> Array:
        """Amplitudes where, at the centre, the volume is nearest to the asked one: one half body is at its limit."""
        sign = 1.0 if volume > self.volume else -1.0
        best: tuple[float, Array] | None = None
        for held, other in ((0, 1), (1, 0)):
            body, free = self._bodies[held], self._bodies[other]
            limit = body.high if sign > 0.0 else body.low
            base = self._fixed + body.table(limit)[0]

            def off(amplitude: float, base: Array = base, free: _HalfBody = free) -> float:
                total = base + free.table(amplitude)[0]
                return float(total[1] / total[0]) - centre

            low, high = free.low, free.high
            at_low, at_high = off(low), off(high)
            if at_low * at_high > 0.0:
                continue
            for _ in range(60):
                middle = 0.5 * (low + high)
                if off(middle) * at_low > 0.0:
                    low = middle
                else:
                    high = middle
            reached = float((base + free.table(low)[0])[0])
            pair = np.array([limit, low]) if held == 0 else np.array([low, limit])
            # Along the curve of this centre both limits may be met; the first one counts.
            if best is None or sign * reached < sign * best[0]:
                best = (reached, pair)
        return best[1] if best is not None else np.zeros(2)

    def solve(self, volume: float, centre: float) -> FormSolution:
        """The shift for a volume and a centre of buoyancy in the parent's frame, clipped to what the form carries.

        Where the asked pair would compress sections to dx'/dx = 0.3, the volume is taken back towards the parent's at
        the asked centre; where the centre alone is too far, it is taken back first. A parent that can hardly change
        its volume at its own centre (``holds_centre`` is false: one half body has nothing to give) reaches the volume
        and gives the centre up.

        Args:
            volume, centre: m3 and m from AP, in the parent's frame.
        """
        identity = LongitudinalShift(self.frame, 0.0, 0.0)
        if not self.holds_centre:
            return self._solve_volume(volume, centre)
        if abs(volume / self.volume - 1.0) < 1e-13 and abs(centre - self.centre) < 1e-13 * self.frame.length:
            return FormSolution(identity, False)
        zero = np.zeros(2)
        found = self._newton(volume, centre, zero)
        if found is not None:
            return FormSolution(self._checked(self._polished(volume, centre, found)), False)
        part = 1.0
        if self._newton(self.volume, centre, zero) is None:
            low, high = 0.0, 1.0
            for _ in range(40):
                part = 0.5 * (low + high)
                reachable = self._newton(self.volume, self.centre + part * (centre - self.centre), zero) is not None
                low, high = (part, high) if reachable else (low, part)
            part = low
        pair = self._at_limit(volume, self.centre + part * (centre - self.centre))
        return FormSolution(self._checked(LongitudinalShift(self.frame, float(pair[0]), float(pair[1]))), True)

    def _solve_volume(self, volume: float, centre: float) -> FormSolution:
        """Both half bodies together, in a fixed ratio, until the volume is right; the centre falls where it falls."""
        reach = np.array([min(-body.low, body.high) for body in self._bodies])

        def at(part: float) -> float:
            tables = [b.exact(float(a)) for b, a in zip(self._bodies, part * reach, strict=True)]
            return float((self._fixed + tables[0] + tables[1])[0])

        low, high = -1.0, 1.0
        clipped = not at(low) <= volume <= at(high)
        if clipped:
            low = high = low if volume < at(low) else high
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if at(middle) < volume else (low, middle)
        if abs(volume / self.volume - 1.0) < 1e-13:
            low = high = 0.0
        amplitudes = 0.5 * (low + high) * reach
        shift = self._checked(LongitudinalShift(self.frame, float(amplitudes[0]), float(amplitudes[1])))
        totals = [b.exact(float(a)) for b, a in zip(self._bodies, amplitudes, strict=True)]
        total = self._fixed + totals[0] + totals[1]
        held = abs(float(total[1] / total[0]) - centre) < 1e-9 * self.frame.length
        return FormSolution(shift, clipped, held)

    @staticmethod
    def _checked(shift: LongitudinalShift) -> LongitudinalShift:
        """The same shift; a folded form must never leave this module.

        Raises:
            SolverFailure: dx'/dx is not above the least stretch.
        """
        least = shift.least_stretch()
        if not least > LEAST_STRETCH:
            raise SolverFailure("form", f"sections compressed to dx'/dx = {least:.3f}, not above {LEAST_STRETCH}")
        return shift
