"""Viscous drag of blade sections, after the ITTC-78 performance prediction method."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array

OFF_DESIGN_FACTOR = 6.7
"""k in Cd = Cd0 (1 + k (CL - CLi)^2), fitted on the open-water test of P4119 alone (docs/theory-lifting-line.md)."""

_FLATTEST_REYNOLDS_NUMBER = (20.0 / 0.044) ** 2
"""Below it the ITTC line falls again, which no blade does; there the line is held at its greatest value."""

CAMBER_SCALINGS = ("model", "reynolds")

CAMBER_KEPT = 0.935
"""Share of its camber that a blade with a boundary layer keeps at model scale: the one viscous lift factor of the panel
method, fitted on the open-water test of P4119 alone (docs/theory-propeller-panels.md)."""

FITTED_REYNOLDS_NUMBER = 9.9098e5
"""Of the section at 0.7 R in that test: D 0.3048 m, 10 1/s, J 0.7."""


@dataclass(frozen=True)
class SectionDrag:
    """How much drag blade sections have. Make one with ``inviscid``, ``model_scale`` or ``full_scale``.

    The drag coefficient at the ideal angle of attack is ITTC-78's
        model scale  Cd0 = 2 (1 + 2 t/c) (0.044 Re^(-1/6) - 5 Re^(-2/3)),
        full scale   Cd0 = 2 (1 + 2 t/c) (1.89 + 1.62 log10(c/kp))^(-2.5),
    which the prediction method writes for the section at 0.75 R; here each section has its own. Away from the ideal
    lift coefficient it grows as Cd = Cd0 (1 + k (CL - CLi)^2), see ``coefficient``.

    Attributes:
        scale: "inviscid", "model" or "full".
        rotation_rate: n in 1/s (model scale).
        viscosity: kinematic, m2/s (model scale).
        roughness: kp in m (full scale).
        off_design_factor: k.
        camber_scaling: what of its camber a full-scale blade loses: as much as the "model" did, or in proportion to the
            friction ("reynolds"), see ``camber_gain``.
    """

    scale: str
    rotation_rate: float | None = None
    viscosity: float | None = None
    roughness: float | None = None
    off_design_factor: float = OFF_DESIGN_FACTOR
    camber_scaling: str = "model"

    @staticmethod
    def inviscid() -> SectionDrag:
        """No drag and no viscous effect on the lift."""
        return SectionDrag("inviscid")

    @staticmethod
    def model_scale(
        rotation_rate: float = 10.0, viscosity: float = 1.0e-6, off_design_factor: float = OFF_DESIGN_FACTOR
    ) -> SectionDrag:
        """A smooth model blade at ``rotation_rate`` (1/s) in water of kinematic ``viscosity`` (m2/s)."""
        _check_positive("rotation_rate", rotation_rate)
        _check_positive("viscosity", viscosity)
        return SectionDrag("model", float(rotation_rate), float(viscosity), None, float(off_design_factor))

    @staticmethod
    def full_scale(
        roughness: float = 30.0e-6, off_design_factor: float = OFF_DESIGN_FACTOR, camber_scaling: str = "model"
    ) -> SectionDrag:
        """A rough full-scale blade of ``roughness`` kp in m (30e-6 is ITTC-78's standard)."""
        _check_positive("roughness", roughness)
        if camber_scaling not in CAMBER_SCALINGS:
            raise InputError(f"section drag: camber_scaling '{camber_scaling}' must be model or reynolds")
        return SectionDrag("full", None, None, float(roughness), float(off_design_factor), camber_scaling)

    @property
    def viscous(self) -> bool:
        """Whether there is any drag."""
        return self.scale != "inviscid"

    def ideal_coefficient(
        self, diameter: float, chord_ratio: Array, thickness_ratio: Array, speed_ratio: Array
    ) -> Array:
        """Cd0 at the ideal angle of attack.

        Args:
            diameter: D in m.
            chord_ratio: c/D.
            thickness_ratio: t/c.
            speed_ratio: undisturbed relative speed over n D, sqrt(J^2 + (pi r/R)^2). All arguments broadcast.
        """
        chord_ratio, thickness_ratio, speed_ratio = np.broadcast_arrays(chord_ratio, thickness_ratio, speed_ratio)
        form = 2.0 * (1.0 + 2.0 * thickness_ratio)
        if self.scale == "model" and self.rotation_rate is not None and self.viscosity is not None:
            reynolds = self.rotation_rate * diameter**2 / self.viscosity * speed_ratio * chord_ratio
            reynolds = np.maximum(reynolds, _FLATTEST_REYNOLDS_NUMBER)
            return np.asarray(form * (0.044 * reynolds ** (-1.0 / 6.0) - 5.0 * reynolds ** (-2.0 / 3.0)))
        if self.scale == "full" and self.roughness is not None:
            # The line is meant for c/kp of 1e4 and more; a blade thinner than 100 roughness heights has no line at all.
            relative = np.maximum(chord_ratio * diameter / self.roughness, 100.0)
            return np.asarray(form * (1.89 + 1.62 * np.log10(relative)) ** -2.5)
        return np.zeros_like(form)

    def camber_gain(self, diameter: float, chord_ratio: float) -> float:
        """Camber that a blade keeps over what it keeps on the model of the fit; 1 unless scaled by "reynolds".

        The boundary layers of back and face take camber from a section in proportion to their displacement thickness at
        the trailing edge, and that goes with the friction (Spence 1954, Journal of the Aeronautical Sciences 21). So
        the loss, 1 - ``CAMBER_KEPT``, is scaled by the friction of ITTC-78's rough line over that of its model line
        where it was fitted, both for the section at 0.7 R without thickness.

        Args:
            diameter: D in m.
            chord_ratio: c/D at 0.7 R.
        """
        if self.camber_scaling == "model":
            return 1.0
        one, none = np.array(1.0), np.array(0.0)
        tested = SectionDrag.model_scale(FITTED_REYNOLDS_NUMBER, 1.0).ideal_coefficient(1.0, one, none, one)
        own = self.ideal_coefficient(diameter, np.array(chord_ratio), none, one)
        return (1.0 - (1.0 - CAMBER_KEPT) * float(own / tested)) / CAMBER_KEPT

    def coefficient(self, ideal_coefficient: Array, lift_excess: Array) -> Array:
        """Cd = Cd0 (1 + k (CL - CLi)^2), with Cd0 from ``ideal_coefficient``; both arguments broadcast.

        ``lift_excess`` is 2 pi (alpha - alpha_i): alpha between the section and its own inflow (the hydrodynamic pitch
        angle at the lifting line), alpha_i the mean line's ideal angle. In two dimensions this is CL - CLi. On a wide
        blade it is not: the flow is curved along the chord, a section lifts less than CLi where it is free of shock,
        and with the plain CL the drag of P4119 would be least at J = 0.5 instead of at its design point.
        """
        return np.asarray(ideal_coefficient * (1.0 + self.off_design_factor * lift_excess**2))


def _check_positive(name: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(f"section drag: {name} {value} must be a positive finite number")
