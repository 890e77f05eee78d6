"""Open-water characteristics of a propeller: what every propeller solver returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.geometry.propeller.propeller import Propeller
from hpsop_core.hydro.section_drag import SectionDrag
from hpsop_core.typing_aliases import Array

__all__ = ["OpenWater", "SectionDrag", "reynolds_number_07R"]


@dataclass(frozen=True, eq=False)
class OpenWater:
    """Open-water characteristics at some advance coefficients.

    Attributes:
        advance_coefficient: J = V/(n D), (nJ,).
        thrust_coefficient: KT = T/(rho n^2 D^4), (nJ,).
        torque_coefficient: KQ = Q/(rho n^2 D^5), (nJ,).
        reynolds_number_07R: c sqrt(V^2 + (0.7 pi n D)^2)/nu at 0.7 R, (nJ,); None where no rotation rate was stated.
        level: 1 lifting line, 2 panel method.
        solver: name and version of the solver.
        settings: the solver's settings as text.
    """

    advance_coefficient: Array
    thrust_coefficient: Array
    torque_coefficient: Array
    reynolds_number_07R: Array | None  # noqa: N815 - the discipline's own notation
    level: int
    solver: str
    settings: str

    @property
    def open_water_efficiency(self) -> Array:
        """eta0 = J KT/(2 pi KQ), (nJ,); zero where the torque is zero."""
        torque = self.torque_coefficient
        safe = np.where(torque == 0.0, 1.0, torque)
        ratio = self.advance_coefficient * self.thrust_coefficient / (2.0 * np.pi * safe)
        return np.asarray(np.where(torque == 0.0, 0.0, ratio))


def reynolds_number_07R(
    propeller: Propeller, advance_coefficient: Array, rotation_rate: float, viscosity: float
) -> Array:
    """Reynolds number of the section at 0.7 R on its chord and undisturbed relative speed.

    Args:
        propeller: with its diameter in m.
        advance_coefficient: J, any shape.
        rotation_rate: n in 1/s.
        viscosity: kinematic, in m2/s.
    """
    chord = float(propeller.table.at_07R.chord_ratio)
    speed = np.sqrt(np.asarray(advance_coefficient, dtype=np.float64) ** 2 + (0.7 * np.pi) ** 2)
    return np.asarray(rotation_rate * propeller.diameter**2 * chord * speed / viscosity)
