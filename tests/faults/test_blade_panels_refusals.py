"""What the blade panels cannot represent fails with the reason, never with a wild number."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.propeller.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels.settings import BladePanelSettings
from hpsop_core.hydro.blade_panels.solver import solve
from hpsop_core.hydro.lifting_line import solver as lifting_line
from hpsop_core.hydro.section_drag import SectionDrag

PARENT = load_propeller()
INVISCID = SectionDrag.inviscid()


def thick_roots(factor: float, blades: int) -> Propeller:
    thickness = PARENT.thickness_ratio * np.where(PARENT.radius_ratio < 0.4, factor, 1.0)
    return propeller_family(replace(PARENT, thickness_ratio=thickness), 9.0, blades)


def crossing_tips() -> Propeller:
    """Highly skewed wide tips that run into the next blade."""
    beyond = np.where(PARENT.radius_ratio > 0.7, (PARENT.radius_ratio - 0.7) / 0.3, 0.0)
    table = replace(PARENT, skew=np.radians(200.0) * beyond, pitch_ratio=1.08 * (1.0 - 0.66 * beyond))
    return propeller_family(table, 9.0, 4, 1.0, 1.1)


@pytest.mark.parametrize(
    ("propeller", "reason"),
    [
        (thick_roots(3.0, 7), "roots of neighbouring blades meet"),
        # by hand: roots 0.326 R thick on chords 0.273 R apart
        (thick_roots(3.0, 4), "roots of neighbouring blades meet .* 0.273 R apart, of which 0.000 R"),
        (propeller_family(PARENT, 9.0, 7, 0.3, 1.3), "hub folds"),
        (crossing_tips(), "row sums"),
    ],
)
def test_impossible_blades(propeller: Propeller, reason: str) -> None:
    with pytest.raises(SolverFailure, match=reason) as failure:
        solve(propeller, [0.5, 0.7], INVISCID)
    assert failure.value.stage == "blade_panels"


@pytest.mark.parametrize(("hub", "pitch"), [(0.15, 1.3), (0.2, 0.45), (0.3, 0.7), (0.4, 1.0)])
def test_large_hubs_and_low_pitches_are_no_reason_to_refuse(hub: float, pitch: float) -> None:
    """Controllable-pitch hubs and tugs' propellers; level 1, which has no hub to panel, says what comes out."""
    table = replace(PARENT, radius_ratio=hub + (1.0 - hub) * (PARENT.radius_ratio - 0.2) / 0.8)
    for blades in (3, 5):
        propeller = propeller_family(table, 1.0, blades, pitch, 0.6)
        advance = np.array([0.7 * pitch])
        panels = solve(propeller, advance, INVISCID).open_water.thrust_coefficient[0]
        line = lifting_line.solve(propeller, advance, INVISCID).thrust_coefficient[0]
        # Level 1's hub is an image without displacement: 12 % at 0.4 R, where a boss is a third of the disc.
        assert panels == pytest.approx(line, rel=0.15)


@pytest.mark.parametrize("advance", [[-0.1], [np.nan], [0.5, np.inf]])
def test_bad_advance_coefficients(advance: list[float]) -> None:
    with pytest.raises(InputError, match="advance coefficients"):
        solve(propeller_family(PARENT, 9.0, 3), advance, INVISCID)


@pytest.mark.parametrize(
    "bad",
    [
        {"chordwise_panels": 21},
        {"radial_panels": 2},
        {"wake": "free"},
        {"forces": "x"},
        {"camber_effectiveness": 2},
    ],
)
def test_bad_settings(bad: dict[str, object]) -> None:
    with pytest.raises(InputError, match=f"blade panels: {next(iter(bad))}"):
        BladePanelSettings(**bad)  # type: ignore[arg-type]


def test_bad_pressure_requests() -> None:
    result = solve(propeller_family(PARENT, 9.0, 3), [0.7], INVISCID)
    with pytest.raises(InputError, match="advance coefficient"):
        result.surface_pressure(float("nan"))
    table = result.pressure_table()
    with pytest.raises(InputError, match="cavitation margin: diameter, rotation_rate and density"):
        table.margin(0.7, 9.0, 0.0, 1025.0, 1e5)
    with pytest.raises(InputError, match=r"cavitation margin: J = 0\.8 lies outside"):
        table.margin(0.8, 9.0, 1.0, 1025.0, 1e5)


def test_extreme_loadings_stay_finite() -> None:
    """Far outside the tabulated wakes the pitch is held at their ends."""
    result = solve(propeller_family(PARENT, 9.0, 3), [0.0, 0.05, 1.6, 2.0], SectionDrag.full_scale()).open_water
    assert np.all(np.isfinite(result.thrust_coefficient))
    assert np.all(np.diff(result.thrust_coefficient) < 0.0)
    assert result.thrust_coefficient[0] < 0.6
