"""Public ships from tables as they are published: volumes, centres and forms beside what their authors give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hpsop_core.case.ready_case import ready_case
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.propeller_tables import tables_for
from hpsop_core.geometry.hull.input import ReadOptions, read_hull
from tools.hull_campaign import LARGEST_ERROR, Variant, gunnerus, variants

DATA = Path(__file__).parents[1] / "data" / "hulls"
# A few of each kind; `python -m tools.hull_campaign` reads them all.
QUICK = (
    "Series 60, draft 5.2019", "Series 60, every second station", "Series 60, from FP in mm", "KVLCC2, draft 22.88",
    "KVLCC2, the others", "DTC, boss told once", "DTC, every second station and waterline", "blunt Wigley, draft 6.25",
)  # fmt: skip


def test_series_60_as_todd_published_it() -> None:
    """The table as it stands in DTMB report 1712: fractions, station numbers from FP; Todd's own form coefficients."""
    told = read_hull(DATA / "s60_cb060.csv", ReadOptions(length=121.92)).understood
    assert (told.breadth, told.draft) == pytest.approx((16.256, 6.5024))
    # CB 0.600 counts the counter aft of AP, 0.0168 L of waterline, which the table does not tell.
    assert told.block_coefficient == pytest.approx(0.600, abs=0.003)
    assert told.midship_coefficient == pytest.approx(0.977, abs=0.004)
    assert told.prismatic_coefficient == pytest.approx(0.614, abs=0.002)
    assert told.waterplane_coefficient == pytest.approx(0.706, abs=0.004)
    assert told.buoyancy_centre_percent == pytest.approx(-1.5, abs=0.05)
    assert "bow at -x, x = 0 at FP" in told.axes and told.looks == "+x"


def test_kvlcc2() -> None:
    """SIMMAN 2008: 312,622 m3, LCB 3.48 % of L forward of midship, CM 0.998; the boss stands at 5.8 m."""
    told = read_hull(DATA / "kvlcc2.csv", ReadOptions(length=320.0, draft=20.8)).understood
    assert told.displaced_volume == pytest.approx(312622.0, rel=1e-3)
    assert told.buoyancy_centre_percent == pytest.approx(3.48, abs=0.05)
    assert told.midship_coefficient == pytest.approx(0.998, abs=0.002)
    # Waterlines 1 m apart.
    assert told.shaft_height == pytest.approx(5.8, abs=0.5)
    assert "shaft height found from the boss" in told.assumed


@pytest.mark.parametrize("draft", [2.787, 3.0657])
def test_gunnerus(draft: float) -> None:
    """A research vessel of L/B 3.6 with a bulb that ends under the still water, a raked flat run and a wet transom."""
    told = read_hull(DATA / "gunnerus.csv", ReadOptions(length=34.9, draft=draft)).understood
    # Waterlines 0.5 m apart under a flat run leave its profile open by as much: the table's own integrals, linear and
    # smooth, differ by 1 %, and the surface may stand as far from the smooth one again.
    assert told.displaced_volume == pytest.approx(gunnerus().volume(draft), rel=0.02)
    assert told.fit is not None
    # Between bulb and stem the waterline ends 1 m short of the bulb: there it is rounded by 31 mm at the larger draft.
    assert told.as_dict()["fit"]["largest_deviation"] < 0.004 * told.breadth  # type: ignore[index]
    assert any("flat face" in line for line in told.warnings)


@pytest.fixture(scope="module")
def campaign() -> dict[str, Variant]:
    return {variant.name: variant for variant in variants()}


def test_the_campaign_is_large_enough(campaign: dict[str, Variant]) -> None:
    assert len(campaign) >= 28
    assert set(QUICK) <= set(campaign)


@pytest.mark.parametrize("name", QUICK)
def test_a_variant_comes_in(tmp_path: Path, campaign: dict[str, Variant], name: str) -> None:
    told = campaign[name].read(tmp_path).understood
    assert np.isclose(told.displaced_volume, campaign[name].volume, rtol=LARGEST_ERROR)


@pytest.mark.parametrize(
    ("file", "options"),
    [("s60_cb060.csv", ReadOptions(length=121.92)), ("kvlcc2.csv", ReadOptions(length=320.0, draft=20.8))],
)
def test_the_ready_case_is_computed_at_both_levels(file: str, options: ReadOptions) -> None:
    """From a file to feasible designs without a word more: a ship of CB 0.60 and one of 0.81."""
    path = DATA / file
    case = ready_case(read_hull(path, options), str(path), options)
    for level in (1, 2):
        result = evaluate(case, case.initial.variables, level)
        assert result.ok, result.reason
        assert result.feasible, result.constraints
    assert case.bounds.project(case.initial.variables) == case.initial.variables
    # and its search learns: in less than half the time, see docs/bring-your-ship.md
    assert case.optimization.surface
    assert tables_for(case) is not None
