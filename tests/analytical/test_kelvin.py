"""The Kelvin pattern of a thin ship: its energy is Michell's resistance, its lengths are Kelvin's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from hpsop_core.case.case import load_case
from hpsop_core.errors import InputError
from hpsop_core.evaluation.shapes import design_hull
from hpsop_core.hydro.kelvin import KelvinWaves, WaveGrid, kelvin_waves
from hpsop_core.hydro.michell import spectrum_resistance, wave_coefficients
from hpsop_core.typing_aliases import Array
from tests.two_speeds import TWO_SPEEDS

FROUDE = (0.15, 0.18, 0.22, 0.27, 0.316, 0.4)
# Columns and rows close together across the wake, a ship's length astern, where waves down to a hundredth of the
# transverse ones are drawn, out to where Kelvin's wedge has ended.
CUT = WaveGrid(columns=41, rows=1001, upstream=-1.95, downstream=1.05, half_width=1.2)


@dataclass(frozen=True)
class Table:
    """Half-breadths, as Michell's integral takes them."""

    x: Array
    z: Array
    half_breadth: Array
    length: float
    waterline: Array

    def waves(self, froude: float, calibration: float = 1.0, grid: WaveGrid | None = None) -> KelvinWaves:
        arguments = self.x, self.z, self.half_breadth, self.length, froude, self.waterline
        return kelvin_waves(*arguments, calibration=calibration, grid=grid)

    def resistance(self, froude: float) -> float:
        """Rw/(1/2 rho U^2 Lpp^2)."""
        (value,) = wave_coefficients(self.x, self.z, self.half_breadth, self.length, self.length**2, (froude,))
        return float(value)


@pytest.fixture(scope="module")
def wigley() -> Table:
    x, z = np.linspace(0.0, 100.0, 161), np.linspace(0.0, 6.25, 41)
    y = 5.0 * (1.0 - ((x - 50.0) / 50.0)[:, None] ** 2) * (1.0 - ((z - 6.25) / 6.25)[None, :] ** 2)
    return Table(x, z, y, 100.0, np.column_stack([x, y[:, -1]]))


@pytest.fixture(scope="module")
def container_ship() -> Table:
    case = load_case(TWO_SPEEDS)
    hull = design_hull(case, case.initial.variables)
    table = hull.offset_table()
    return Table(table.x, table.z, table.y, hull.length, hull.waterline())


@pytest.fixture(scope="module", params=["wigley", "container_ship"])
def table(request: pytest.FixtureRequest) -> Table:
    found: Table = request.getfixturevalue(request.param)
    return found


@pytest.mark.parametrize("froude", FROUDE)
def test_the_spectrum_carries_michells_resistance(table: Table, froude: float) -> None:
    found = table.waves(froude, grid=WaveGrid(columns=8, rows=96, half_width=0.62, upstream=-1.0, downstream=0.05))
    # The same amplitudes at other tangents: what is left is the tail's last step, 0.08 % on the full ship at Fn 0.4.
    assert found.spectrum.wave_resistance == pytest.approx(table.resistance(froude), rel=1e-3)


@pytest.mark.parametrize("froude", [0.18, 0.22, 0.27, 0.4])
def test_the_surface_itself_carries_that_energy_astern(table: Table, froude: float) -> None:
    """Eggers' transverse cut: the energy read off the elevations, not off the spectrum they were made from.

    Heights and slopes along a cut give the two parts of each wave by a cosine transform over the half wake.
    """
    found = table.waves(froude, grid=CUT)
    middle, wave_number = CUT.columns // 2, 1.0 / froude**2
    aft, across = 1.0 - found.x[:, 0] / table.length, found.y[middle] / table.length
    height = found.elevation / table.length
    slope = np.gradient(height, aft, axis=0)[middle]
    spectrum = found.spectrum
    u = spectrum.tangent
    secant = np.sqrt(1.0 + u**2)
    waves = np.cos(wave_number * np.outer(secant * u, across))
    even = np.trapezoid(waves * height[middle], across, axis=1)
    odd = np.trapezoid(waves * slope, across, axis=1) / (wave_number * secant)
    # int zeta cos(k0 s u y) dy over the half wake is 2 s^2/(1 + 2 u^2) times the wave's part of that phase
    power = ((1.0 + 2.0 * u**2) / (2.0 * secant**2)) ** 2 * (even**2 + odd**2)
    power[spectrum.drawn == 0.0] = 0.0
    carried = spectrum_resistance(power, wave_number, u, float(u[1]))
    # Waves that the grid does not draw are missing, and the field says how many; beyond that 0.5 % for the finite cut
    # (the wedge's edge decays slowly) and for the slope by differences.
    assert carried == pytest.approx(spectrum.drawn_share * table.resistance(froude), rel=5e-3)
    # What this fine grid leaves out of the whole resistance: 1.6 % on the full ship at Fn 0.18, else less.
    assert carried == pytest.approx(table.resistance(froude), rel=2e-2)


def test_a_finer_grid_draws_more_of_the_resistance(container_ship: Table) -> None:
    shares = [
        container_ship.waves(0.22, grid=WaveGrid(columns=4 * rows, rows=rows)).spectrum.drawn_share
        for rows in (24, 48, 96)
    ]
    assert 0.5 < shares[0] < shares[1] < shares[2] < 1.0


def test_the_pattern_does_not_depend_on_the_grid(container_ship: Table) -> None:
    # Every other point of a grid that draws shorter waves, against the waves that both draw: at Fn 0.4 the short ones
    # carry 3 % of the energy, so heights differ by less than their root.
    coarse = container_ship.waves(0.4, grid=WaveGrid(columns=133, rows=97)).elevation
    fine = container_ship.waves(0.4, grid=WaveGrid(columns=265, rows=193)).elevation[::2, ::2]
    assert np.sqrt(np.mean((fine - coarse) ** 2)) < 0.17 * np.sqrt(np.mean(fine**2))


@pytest.mark.parametrize("froude", [0.22, 0.27])
def test_transverse_waves_astern_have_kelvins_length(container_ship: Table, froude: float) -> None:
    found = container_ship.waves(froude)
    x, elevation = found.x[:, 0], found.elevation[:, 0]
    astern = x < -0.45 * container_ship.length
    x, elevation = x[astern][::-1], elevation[astern][::-1]
    # the longest wave of the track: its share of the record is transformed, so that short waves do not count
    wanted = 2.0 * np.pi * froude**2 * container_ship.length
    lengths = np.linspace(0.5, 2.0, 301) * wanted
    window = np.hanning(len(x)) * elevation
    strength = np.abs(np.exp(-2j * np.pi * np.outer(1.0 / lengths, x)) @ window)
    # on the track the spectrum around theta = 0 rules, but not alone: a few per cent shorter than 2 pi Fn2 L
    assert 0.9 < lengths[np.argmax(strength)] / wanted < 1.03


def test_no_waves_run_ahead_of_the_ship(table: Table) -> None:
    found = table.waves(0.27)
    ahead = found.x > table.x[-1]
    assert ahead.any()
    assert (found.elevation[ahead] == 0.0).all()


def test_heights_take_the_root_of_the_calibration(container_ship: Table) -> None:
    plain, scaled = container_ship.waves(0.22), container_ship.waves(0.22, 0.25)
    assert np.allclose(scaled.elevation, 0.5 * plain.elevation)
    assert scaled.spectrum.wave_resistance == pytest.approx(0.25 * plain.spectrum.wave_resistance, rel=1e-12)


def test_what_cannot_be_drawn_is_refused(wigley: Table) -> None:
    with pytest.raises(InputError, match="must be a positive number"):
        wigley.waves(0.0)
    with pytest.raises(InputError, match="at least 0"):
        wigley.waves(0.2, -1.0)
    with pytest.raises(InputError, match="take more columns and rows"):
        wigley.waves(0.1, grid=WaveGrid(columns=20))
    with pytest.raises(InputError, match="at least 2"):
        WaveGrid(rows=1)
