"""What the blade panels cannot represent fails with the reason, never with a wild number."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.geometry.propeller import Propeller, load_propeller, propeller_family
from hpsop_core.hydro.blade_panels import BladePanelSettings, solve
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
        (thick_roots(3.0, 4), "hub folds"),
        (propeller_family(PARENT, 9.0, 7, 0.3, 1.3), "roots of neighbouring blades meet"),
        (crossing_tips(), "row sums"),
    ],
)
def test_impossible_blades(propeller: Propeller, reason: str) -> None:
    with pytest.raises(SolverFailure, match=reason) as failure:
        solve(propeller, [0.5, 0.7], INVISCID)
    assert failure.value.stage == "blade_panels"


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
    result = solve(propeller_family(PARENT, 9.0, 3), [0.0, 0.05, 1.6], SectionDrag.full_scale()).open_water
    assert np.all(np.isfinite(result.thrust_coefficient))
    assert np.all(np.diff(result.thrust_coefficient) < 0.0)
    assert result.thrust_coefficient[0] < 0.6
