"""How the panel method works: panelling of blade, hub and wake, and the constants that its accuracy rests on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.hydro.section_drag import CAMBER_KEPT
from hpsop_core.typing_aliases import Array

SOLVER = "blade panels 1.2"
WAKE_PITCH_RANGE = (0.52, 1.3)
WAKE_PITCH_COUNT = 4
"""Tabulated wakes and the range of their pitch over the blade's pitch at 0.7 R. They lie at Chebyshev points of the
pitch's logarithm, and between them goes the polynomial in it: induced velocities go like the inverse of the pitch, and
three of them evenly spaced in the pitch would put KT 0.7 % off at J = 0.3 and 0.6 % at 1.1, these less than 0.1 %."""

HUB_WAKE_PITCH = 0.9
"""Pitch over the blade's pitch at 0.7 R of the helix along which the hub is panelled behind the blades; KT moves by
3e-4 from 0.75 to 1.05."""

CROSS_FLOW_DISTANCE = (0.03, 0.08)
"""Distance from hub or tip, in local chords, between which the pressures of the Kutta condition come to include the
flow across the chord (KuttaProblem); the first and the last strip take the linear condition."""


@dataclass(frozen=True)
class HubSettings:
    """How the hub is panelled; lengths in tip radii.

    Attributes:
        rows_cylinder: panels on the cylinder before and behind the root, each.
        rows_end: panels on each rounded end.
        panels_round: panels round the whole hub, shared by the blades (at least four a sector).
        cylinder_ahead, cylinder_behind: the cylinder beyond the lines that lean out from the root. A boss of 3 R
            each way would raise KT of P4119 by 1.8 % at J = 0.7; end_length: of the rounded ends.
        lean: how far the lines from the root's edges lean forward and aft, over what lines square to the chord lean;
            above one, or the lines would run into the round leading edge.
    """

    rows_cylinder: int = 3
    rows_end: int = 4
    panels_round: int = 18
    cylinder_ahead: float = 0.1
    cylinder_behind: float = 0.2
    end_length: float = 0.4
    lean: float = 1.3


@dataclass(frozen=True)
class WakeSettings:
    """The helical wake: `revolutions` turns, steps of `first_step_degrees` that grow by `growth` each.

    For KT of P4119 at J = 0.7 a first step of 10 degrees counts -0.6 %, an end after two turns 0.4 %.
    """

    revolutions: float = 3.0
    first_step_degrees: float = 4.0
    growth: float = 1.08


@dataclass(frozen=True)
class BladePanelSettings:
    """How the panel method works.

    Attributes:
        chordwise_panels: round a section, even, at least 12.
        radial_panels: strips from hub to tip, at least 5.
        wake: "aligned" gives the wake one pitch that follows the loading; "geometric_pitch" leaves each strip at the
            blade's own pitch whatever the loading (PROPAN's setting in the stored comparison).
        forces: "circulation" (Kutta-Joukowski) or "pressure" (integration; needs some 80 x 24 panels).
        hub_in_forces: add the pressure force on the hub.
        camber_effectiveness: share of the camber that a blade with a boundary layer keeps; not used where the drag is
            inviscid. The one viscous correction, fitted on P4119's open-water test alone.
        hub: panelling of the hub.
        wake_grid: panelling of the wake.
        wake_pitch_count: tabulated wakes, at least 2.
    """

    chordwise_panels: int = 24
    radial_panels: int = 10
    wake: Literal["aligned", "geometric_pitch"] = "aligned"
    forces: Literal["circulation", "pressure"] = "circulation"
    hub_in_forces: bool = False
    camber_effectiveness: float = CAMBER_KEPT
    hub: HubSettings = field(default_factory=HubSettings)
    wake_grid: WakeSettings = field(default_factory=WakeSettings)
    wake_pitch_count: int = WAKE_PITCH_COUNT

    def __post_init__(self) -> None:
        if self.chordwise_panels < 12 or self.chordwise_panels % 2:
            raise InputError(f"blade panels: chordwise_panels {self.chordwise_panels} must be even and at least 12")
        if self.radial_panels < 5:
            raise InputError(f"blade panels: radial_panels {self.radial_panels} must be at least 5")
        if self.wake_pitch_count < 2:
            raise InputError(f"blade panels: wake_pitch_count {self.wake_pitch_count} must be at least 2")
        if not 0.0 < self.camber_effectiveness <= 1.0:
            raise InputError(f"blade panels: camber_effectiveness {self.camber_effectiveness} must be in (0, 1]")
        if self.wake not in ("aligned", "geometric_pitch"):
            raise InputError(f"blade panels: wake '{self.wake}' must be aligned or geometric_pitch")
        if self.forces not in ("circulation", "pressure"):
            raise InputError(f"blade panels: forces '{self.forces}' must be circulation or pressure")

    @classmethod
    def fine(cls) -> BladePanelSettings:
        """80 x 24 panels with pressure integration: the audit."""
        return cls(80, 24, forces="pressure", hub=HubSettings(5, 6, 36))

    def refined(self, factor: float) -> BladePanelSettings:
        """The same with ``factor`` times as many panels in each direction on blades and hub, round a section even."""

        def scaled(count: int) -> int:
            return round(count * factor)

        hub = replace(
            self.hub,
            rows_cylinder=scaled(self.hub.rows_cylinder),
            rows_end=scaled(self.hub.rows_end),
            panels_round=scaled(self.hub.panels_round),
        )
        chordwise = 2 * scaled(self.chordwise_panels // 2)
        return replace(self, chordwise_panels=chordwise, radial_panels=scaled(self.radial_panels), hub=hub)

    @property
    def text(self) -> str:
        return (
            f"{self.chordwise_panels}x{self.radial_panels} panels, wake {self.wake}, forces by {self.forces}"
            f"{', hub included' if self.hub_in_forces else ''}"
        )

    def wake_pitch_nodes(self) -> Array:
        """(wake_pitch_count,) pitch of the tabulated wakes over the blade's pitch at 0.7 R, ascending."""
        low, high = np.log(WAKE_PITCH_RANGE)
        place = -np.cos(np.pi * np.arange(self.wake_pitch_count) / (self.wake_pitch_count - 1))
        return np.asarray(np.exp(0.5 * (low + high) + 0.5 * (high - low) * place))
